"""A line of the block ELEMENTS as a record of the deck."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import cast

from ...deck.record import Deck, Number, Record
from ...errors import Place

SECTION = "elements"
MOST_ELEMENTS = 20_000  # of a deck; one takes up to 6 kB
OUTPUT = "OUTPUT"  # word of quantities that results have besides
EQUILIBRIUM = "equilibrium"  # name of a line START without keys: the motion begins at rest
UNITS = "UNITS"  # word of the consistent system in which the deck's numbers are
MASS = "MASS"  # word of masses that are added to bodies
# Words that bring in equations, or take those of the deck away.
CONSTRAINING = ("DRIVE", "SUPPORT", "COUPLING", "CURVE", "ROLL", "JOINT")


@dataclass(frozen=True)
class ElementLine(Record):
    """A line `WORD name key=value ...`: its numbers under their keys, its name in `subject` and in `--set`.

    `kind`: what FUNCTION and JOINT say after the name; keys that are not given and have no default are not
    there.
    """

    word: str = ""
    kind: str = ""
    begins: Place | None = None

    @property
    def prefix(self) -> str:
        """Name in `--set` and in echoes: that of the element."""
        return self.subject

    @property
    def place(self) -> Place | None:
        """Place of its word."""
        return self.begins

    @property
    def begins_at_rest(self) -> bool:
        """Return whether it is `START equilibrium`."""
        return self.word == "START" and self.subject.lower() == EQUILIBRIUM and not self.numbers

    def place_of(self, key: str) -> Place | None:
        """Place of a number; that of the line where the number was set."""
        return self.at(key).place or self.begins

    def with_numbers(self, numbers: Iterable[Number]) -> "ElementLine":
        """Return the line with other numbers."""
        return ElementLine(
            self.section, self.number, self.subject, tuple(numbers), self.word, self.kind, self.begins
        )


def lines_of(deck: Deck) -> Sequence[ElementLine]:
    """Return the lines of the blocks of a deck."""
    return cast("Sequence[ElementLine]", deck.section(SECTION))


def has_outputs(deck: Deck) -> bool:
    """Return whether a deck has lines OUTPUT."""
    return any(line.word == OUTPUT for line in lines_of(deck))


def system_of(deck: Deck) -> str:
    """Return the name of the consistent system in which a deck says its numbers are; "" if it does not."""
    return next((line.subject.lower() for line in lines_of(deck) if line.word == UNITS), "")


def mass_lines(lines: Iterable[ElementLine]) -> list[ElementLine]:
    """Return the lines MASS among those of a deck."""
    return [line for line in lines if line.word == MASS]
