"""VSDF deck to a mechanism whose flexible bodies are reduced."""

from pathlib import Path

from ...deck.record import Deck
from ...errors import Fault, ModelError
from ...fe.build_mechanism import flexible_mechanism
from ...model.flexible_mechanism import FlexibleMechanism
from .build import build_vsdf


def build_model(deck: Deck, folder: Path) -> tuple[FlexibleMechanism, list[Fault]]:
    """Return the mechanism and the warnings; file names are relative to `folder`.  Raises ModelError."""
    model, warnings = build_vsdf(deck, folder)
    try:
        mechanism, more = flexible_mechanism(model)
    except ModelError as failure:
        raise ModelError((*warnings, *failure.faults)) from failure
    return mechanism, [*warnings, *more]
