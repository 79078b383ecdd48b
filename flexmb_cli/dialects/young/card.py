"""What a card behind DYNAMICS is: a keyword, and the columns of its numbers."""

from collections.abc import Iterator

from ...quick_dataclass import dataclass, replace
from .sections import Column

MOST_NUMBERS = 2_000_000  # of a card


@dataclass(frozen=True)
class Card:
    """A card: its keyword, the section its records form, and its columns.

    The last `optional` columns may be left out and are then 0.  Behind them `repeated` columns may stand any
    number of times, at least `least` times; their keys get the number of the repetition.
    """

    keyword: str
    section: str
    columns: tuple[Column, ...]
    optional: int = 0
    repeated: tuple[Column, ...] = ()
    least: int = 0

    def columns_of(self, count: int) -> tuple[Column, ...] | None:
        """The columns of a card with so many numbers; None where it takes another count."""
        rest = count - len(self.columns)
        if not self.repeated:
            return self.columns if -self.optional <= rest <= 0 else None
        times, over = divmod(rest, len(self.repeated))
        if over or times < self.least or count > MOST_NUMBERS:
            return None
        return (*self.columns, *self._repetitions(times))

    def _repetitions(self, times) -> Iterator[Column]:
        for k in range(1, times + 1):
            yield from (replace(column, key=f"{column.key}{k}") for column in self.repeated)

    @property
    def begins_with_text(self) -> bool:
        """Whether a word follows its keyword."""
        return bool(self.columns) and self.columns[0].is_text

    @property
    def numbers(self) -> str:
        """How many numbers the card takes, and what they are called."""
        keys = " ".join(column.key for column in self.columns)
        most = len(self.columns)
        if self.repeated:
            again = " ".join(f"{column.key}{{n}}" for column in self.repeated)
            first = f"{keys} and, " if keys else ""
            return f"{first}{self.least} times or more, {again}"
        asked = f"{most}" if not self.optional else f"{most - self.optional} to {most}"
        return f"{asked} {'words' if self.begins_with_text else 'numbers'} ({keys})"


def whole(key: str, meaning: str) -> Column:
    """A column of integers."""
    return Column(key, meaning, is_integer=True)


def vector(key: str, meaning: str, unit: str) -> tuple[Column, ...]:
    """The columns of three components."""
    return tuple(Column(f"{key}.{axis}", f"{axis} of {meaning}", unit) for axis in "xyz")
