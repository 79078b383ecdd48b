"""YOUNG deck to the model that it describes: a mechanism, or one with masses and loads."""

from dataclasses import replace
from pathlib import Path

from ...deck.record import Deck
from ...errors import Fault, ModelError
from ...model.mechanism import Mechanism
from .build import build_young
from .dynamic_cards import analysis_of


def build_model(deck: Deck, folder: Path) -> tuple[object, list[Fault]]:
    """Return a Mechanism or a DynamicModel, and the warnings about it.  Raises ModelError."""
    if analysis_of(deck) is None:
        mechanism, warnings = build_young(deck)
        return _shaped(mechanism, deck, folder), warnings
    # Kinematics need no arrays of masses.
    from .build_dynamics import build_young_dynamics

    model, warnings = build_young_dynamics(deck, folder)
    return replace(model, mechanism=_shaped(model.mechanism, deck, folder)), warnings


def _shaped(mechanism: Mechanism, deck: Deck, folder: Path) -> Mechanism:
    """The mechanism with its shapes, which few decks have; raises ModelError."""
    if not (deck.section("shape") or deck.section("shape_file")):
        return mechanism
    from ...model.diagnostics import Findings
    from ..body_shapes import build_shapes

    findings = Findings()
    shapes = build_shapes(deck, [True] * len(mechanism.bodies), folder, findings)
    if findings.faults:
        raise ModelError((*deck.warnings, *findings.in_order))
    return replace(mechanism, shapes=shapes)
