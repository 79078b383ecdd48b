"""Long lists of numbers in fixed columns, each with its name and place made when it is looked at."""

from array import array
from collections.abc import Callable, Mapping, Sequence
from copy import copy
from functools import cached_property
from typing import Any

from ..errors import Place
from .fortran_card import Format, cut
from .lazy import Chained, Lazy
from .record import Number, Record

LONG = 1000  # numbers; shorter lists are kept as they are


class NumberList(Lazy):
    """Numbers that fill records of `fmt` from line `first` of `lines` on.

    `labelled(i)` gives the i-th number's key, meaning and unit, counted from 0.
    """

    def __init__(
        self, lines: Sequence[str], fmt: Format, first: int, labelled: Callable[[int], tuple[Any, ...]]
    ):
        self.lines, self.fmt, self.first, self.labelled = lines, fmt, first, labelled
        self.values = array("q" if fmt.edits[0].letter == "I" else "d")
        self.changed: dict[int, Number] = {}

    def __len__(self) -> int:
        return len(self.values)

    def with_changed(self, index: int, number: Number) -> "NumberList":
        """Return the list with another number at `index`."""
        other = copy(self)
        other.values = self.values[:]
        other.values[index] = number.value
        other.changed = self.changed | {index: number}
        return other

    def _item(self, k: int) -> Number:
        if k in self.changed:
            return self.changed[k]
        line, field = divmod(k, len(self.fmt.edits))
        field_text = cut(self.lines[self.first + line - 1], self.fmt.edits[field])
        place = Place(self.first + line, field_text.column, len(field_text.spelled) or 1)
        key, meaning, unit = self.labelled(k)
        return Number(key, self.values[k], meaning, unit, place, field_text.spelled)


class _Positions(Mapping[str, int]):
    """Index of each key among the numbers, found by looking through them."""

    def __init__(self, numbers: Sequence[Number]):
        self.numbers = numbers

    def __getitem__(self, key: str) -> Any:
        for k, number in enumerate(self.numbers):
            if number.key == key:
                return k
        raise KeyError(key)

    def __len__(self) -> int:
        return len(self.numbers)

    def __iter__(self) -> Any:
        return (number.key for number in self.numbers)


class LongRecord(Record):
    """A record whose last numbers are a `NumberList`."""

    head: tuple[Number, ...]
    rest: NumberList

    def __init__(self, section: str, number: int, subject: str, head: Sequence[Number], rest: NumberList):
        vars(self).update(section=section, number=number, subject=subject, made={}, rest=rest)
        vars(self).update(head=tuple(head), numbers=Chained([tuple(head), rest]) if head else rest)

    @cached_property
    def values(self) -> Sequence[float]:
        """Values of the numbers."""
        head = [number.value for number in self.head]
        return [*head, *self.rest.values] if head else self.rest.values

    @property
    def positions(self) -> Mapping[str, int]:
        """Return where among the numbers each key stands."""
        return _Positions(self.numbers)

    def __getitem__(self, key: str) -> Any:
        return self.numbers[self.positions[key]].value

    def with_number(self, index: int, number: Number) -> Record:
        """Return the record with another number at `index`."""
        count, head = len(self.head), list(self.head)
        rest = self.rest if index < count else self.rest.with_changed(index - count, number)
        head[index : index + 1] = [number] if index < count else []
        return LongRecord(self.section, self.number, self.subject, head, rest)


def record_of(
    section: str, number: int, subject: str, head: Sequence[Number], rest: Sequence[Number]
) -> Record:
    """Return the record of a head and a list that may be long."""
    if isinstance(rest, NumberList):
        return LongRecord(section, number, subject, head, rest)
    return Record(section, number, subject, (*head, *rest))
