"""YOUNG deck to the model that it describes: a mechanism, or one with masses and loads."""

from pathlib import Path

from ...deck.record import Deck
from ...errors import Fault
from .build import build_young
from .dynamic_cards import analysis_of


def build_model(deck: Deck, folder: Path) -> tuple[object, list[Fault]]:
    """Return a Mechanism or a DynamicModel, and the doubts about it.  Raises ModelError."""
    if analysis_of(deck) is None:
        return build_young(deck)
    # Kinematics need no arrays of masses.
    from .build_dynamics import build_young_dynamics

    return build_young_dynamics(deck)
