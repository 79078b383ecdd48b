"""A kinematic YOUNG deck in other units of length: its own text, with every length in it written anew."""

from collections import defaultdict
from dataclasses import dataclass
from decimal import Decimal

from ....deck.record import Deck, Number
from ....deck.units import Units
from .. import DIALECT
from ..dynamic_cards import analysis_of

DOUBLE_DIGITS = 17  # of a double
LENGTHS = ("m", "m/s", "m/s^2", "m/rad")


@dataclass(frozen=True)
class _Word:
    """A number of a line from column `start`, counted from 0, to `end`, and what is to stand there."""

    start: int
    end: int
    text: str


def in_other_units(deck: Deck, old: Units, new: Units, title: str) -> str | None:
    """Return the text of a deck with lengths in `new` units, None where it has masses and loads.

    Comments, order and the numbers without length stay as they are.
    """
    if analysis_of(deck) is not None:
        return None
    factor = Decimal(str(old.length)) / Decimal(str(new.length))
    words = defaultdict(list)
    # A number that --set has changed has no place: the deck is read once more.
    for (_, read), (_, number) in zip(DIALECT.read(deck.source).numbers(), deck.numbers(), strict=True):
        text = _written(read, number, factor)
        if read.place and text != read.text:
            start = read.place.column - 1
            words[read.place.line - 1].append(_Word(start, start + len(read.text), text))
    lines = [_replaced(line, words[k]) for k, line in enumerate(deck.source.lines)]
    unit = new.reported.partition(",")[0]
    text = "\n".join([f"{{ {title} }}", f"{{ Units: {unit}, s }}", *lines])
    return text.rstrip("\n") + "\n"


def _written(read: Number, number: Number, factor: Decimal) -> str:
    """Return the spelling of a number: as it was read, unless it is a length or was changed by `--set`."""
    if number.unit in LENGTHS:
        return _shortest(float(Decimal(repr(number.value)) * factor))
    return read.text if read.value == number.value else _shortest(number.value)


def _shortest(value: float) -> str:
    """Return the fewest digits that give a double, without an exponent where it is of moderate size."""
    exact = Decimal(repr(value)).normalize()
    return "0" if not exact else f"{exact:f}" if -7 < exact.adjusted() < DOUBLE_DIGITS else f"{exact:e}"


def _replaced(line: str, words: list[_Word]) -> str:
    for word in sorted(words, key=lambda word: -word.start):
        line = line[: word.start] + word.text + line[word.end :]
    return line
