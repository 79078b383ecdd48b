"""Sequences of which each item is made when it is looked at: kept, they would take many times the deck."""

from abc import abstractmethod
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import chain
from typing import Any


class Lazy(Sequence[Any]):
    """A sequence that makes its items by `_item`; a slice is a tuple."""

    def __getitem__(self, index: int | slice) -> Any:
        if isinstance(index, slice):
            return tuple(self._item(k) for k in range(len(self))[index])
        return self._item(range(len(self))[index])

    def __iter__(self) -> Iterator[Any]:
        return map(self._item, range(len(self)))

    @abstractmethod
    def _item(self, index: int) -> Any:
        """The item at an index that is not negative."""


@dataclass(frozen=True)
class Made(Lazy):
    """Parts that `make` builds of records, or of parts of a model."""

    records: Sequence[Any]
    make: Callable[[Any], object]

    def __len__(self) -> int:
        return len(self.records)

    def __iter__(self) -> Iterator[Any]:
        return map(self.make, self.records)

    def _item(self, index: int) -> Any:
        return self.make(self.records[index])


class Chained(Lazy):
    """Sequences one after the other."""

    def __init__(self, parts: Sequence[Sequence[Any]]):
        self.parts = tuple(part for part in parts if len(part))

    def __len__(self) -> int:
        return sum(map(len, self.parts))

    def __iter__(self) -> Iterator[Any]:
        return chain.from_iterable(self.parts)

    def _item(self, index: int) -> Any:
        for part in self.parts:
            if index < len(part):
                return part[index]
            index -= len(part)
        raise IndexError(index)


class BySection(Chained):
    """Records that stand by sections."""

    @abstractmethod
    def section(self, name: str) -> Sequence[Any]:
        """Return the records of one section."""
