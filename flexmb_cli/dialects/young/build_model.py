"""YOUNG deck to the model that it describes: a mechanism, or one with masses and loads."""

from dataclasses import replace
from pathlib import Path
from typing import Any

from ...deck.record import Deck
from ...errors import Fault, ModelError
from ...model.mechanism import Mechanism
from .build import build_young
from .dynamic_cards import analysis_of


def build_model(deck: Deck, folder: Path) -> tuple[object, list[Fault]]:
    """Return a Mechanism or a DynamicModel, and the warnings about it.  Raises ModelError."""
    if analysis_of(deck) is None:
        mechanism, warnings = build_young(deck)
        return (_shaped(mechanism, deck, folder) if _has_shapes(deck) else mechanism), warnings
    # Kinematics need no arrays of masses.
    from .build_dynamics import build_young_dynamics

    model, warnings = build_young_dynamics(deck, folder)
    if _has_shapes(deck):
        model = replace(model, mechanism=_shaped(model.mechanism, deck, folder))
    return model, warnings


def _has_shapes(deck: Deck) -> bool:
    return bool(deck.section("shape") or deck.section("shape_file"))


def _shaped(mechanism: Mechanism, deck: Deck, folder: Path) -> Any:
    """The mechanism with its shapes; raises ModelError.  Few decks have any."""
    from ...model.diagnostics import Findings
    from ..body_shapes import build_shapes

    findings = Findings()
    shapes = build_shapes(deck, [True] * len(mechanism.bodies), folder, findings)
    if findings.faults:
        raise ModelError((*deck.warnings, *findings.in_order))
    return replace(mechanism, shapes=shapes)
