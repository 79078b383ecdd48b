"""Card behind DYNAMICS: a keyword, and the columns of its numbers."""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from .sections import Column

MOST_NUMBERS = 200_000  # of a card
_REPEATED = re.compile(r"(.*?)([1-9][0-9]*)")  # a key and the number of its repetition


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

    def columns_of(self, count: int) -> Sequence[Column] | None:
        """The columns of a card with so many numbers; None where it takes another count."""
        rest = count - len(self.columns)
        if not self.repeated:
            return self.columns if -self.optional <= rest <= 0 else None
        times, over = divmod(rest, len(self.repeated))
        if over or times < self.least or count > MOST_NUMBERS:
            return None
        return RepeatedColumns(self, count)

    @property
    def begins_with_text(self) -> bool:
        """Return whether a word follows its keyword."""
        return bool(self.columns) and self.columns[0].is_text

    @property
    def numbers(self) -> str:
        """Return how many numbers the card takes, and what they are called."""
        keys = " ".join(column.key for column in self.columns)
        most = len(self.columns)
        if self.repeated:
            again = " ".join(f"{column.key}{{n}}" for column in self.repeated)
            first = f"{keys} and, " if keys else ""
            return f"{first}{self.least} times or more, {again}"
        asked = f"{most}" if not self.optional else f"{most - self.optional} to {most}"
        return f"{asked} {'words' if self.begins_with_text else 'numbers'} ({keys})"


class RepeatedColumns(Sequence[Column]):
    """The columns of a card with `count` numbers: kept, they would take many times the deck."""

    def __init__(self, card: Card, count: int):
        self.card, self.size = card, count

    def __len__(self) -> int:
        return self.size

    def __getitem__(self, index: int | slice) -> Any:
        if isinstance(index, slice):
            return tuple(self[k] for k in range(self.size)[index])
        first = len(self.card.columns)
        k = range(self.size)[index] - first
        if k < 0:
            return self.card.columns[k]
        time, which = divmod(k, len(self.card.repeated))
        column = self.card.repeated[which]
        return replace(column, key=f"{column.key}{time + 1}")

    def __iter__(self) -> Iterator[Column]:
        return map(self.__getitem__, range(self.size))


class Positions(Mapping[str, int]):
    """Index of each key among the columns of a card with numbers that repeat."""

    def __init__(self, columns: RepeatedColumns):
        self.columns = columns
        self._first = [column.key for column in columns.card.columns]
        self._repeated = [column.key for column in columns.card.repeated]

    def __getitem__(self, key: str) -> int:
        if key in self._first:
            return self._first.index(key)
        found = _REPEATED.fullmatch(key)
        if found is None or found[1] not in self._repeated:
            raise KeyError(key)
        k = len(self._first) + (int(found[2]) - 1) * len(self._repeated) + self._repeated.index(found[1])
        if k >= len(self.columns):
            raise KeyError(key)
        return k

    def __len__(self) -> int:
        return len(self.columns)

    def __iter__(self) -> Iterator[str]:
        return (column.key for column in self.columns)


def whole(key: str, meaning: str) -> Column:
    """A column of integers."""
    return Column(key, meaning, is_integer=True)


def vector(key: str, meaning: str, unit: str) -> tuple[Column, ...]:
    """The columns of three components."""
    return tuple(Column(f"{key}.{axis}", f"{axis} of {meaning}", unit) for axis in "xyz")
