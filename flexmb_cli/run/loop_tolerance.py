"""Tolerance of closed loops: as the digits of the deck allow, or as `--loop-tolerance` says."""

import re
from dataclasses import replace
from functools import lru_cache
from typing import TYPE_CHECKING, Any

from ..deck.number import MOST_DIGITS

if TYPE_CHECKING:
    from ..deck.record import Deck


LOOP_TOLERANCE = "loop-tolerance"
LARGEST_TOLERANCE = 0.02  # of the size, or rad: what is farther from closing is no loop
CHARACTERS_LOOKED_AT = 100_000  # characters of a deck
NUMBER = re.compile(r"(?<![\w.])-?(\d*)\.(\d*)(?:[EeDd][-+]?\d+)?(?![\w.])")
FEWEST_DIGITS, USUAL_DIGITS = 6, 8  # fewer may be exact; where no number has so many
UNITS_OFF = 5.0  # of the last digit: the roundings of a loop add up


def typed_precision(deck: "Deck") -> float:
    """Return how well loops of a deck can close, by the number with the fewest digits that looks rounded."""
    return _precision_of(deck.source.text[:CHARACTERS_LOOKED_AT])


@lru_cache(maxsize=1)  # all variants of a study have the text of one deck
def _precision_of(text: str) -> float:
    texts = NUMBER.finditer(text)
    counts = {len((match[1] + match[2]).lstrip("0")) for match in texts}
    digits = min((n for n in counts if n >= FEWEST_DIGITS), default=USUAL_DIGITS)
    return UNITS_OFF * 10.0 ** -min(digits, MOST_DIGITS)


def with_loop_tolerance(model: Any, deck: "Deck", given: float | None) -> Any:
    """Return the model with the tolerance of its loops: the one given, or that of the digits typed."""
    tolerance = typed_precision(deck) if given is None else given
    if hasattr(model, "mechanism"):
        return replace(model, mechanism=replace(model.mechanism, loop_tolerance=tolerance))
    return replace(model, loop_tolerance=tolerance)
