"""The records of a large deck, each made when it is looked at: kept, they would take many times the deck."""

from collections.abc import Callable, Iterator, Sequence
from itertools import chain

from ..quick_dataclass import dataclass
from .record import Record

MANY = 300_000  # numbers; fewer are kept as records, which studies share


@dataclass(frozen=True)
class Block(Sequence[Record]):
    """All records of one section, which `made` makes of their places in it."""

    section: str
    size: int
    made: Callable[[int], Record]

    def __len__(self) -> int:
        return self.size

    def __getitem__(self, index):
        if isinstance(index, slice):
            return [self.made(k) for k in range(self.size)[index]]
        return self.made(range(self.size)[index])

    def __iter__(self) -> Iterator[Record]:
        return map(self.made, range(self.size))


class ManyRecords(Sequence[Record]):
    """Records by sections, in the deck's order."""

    def __init__(self, blocks: Sequence[Block]):
        self._blocks = tuple(blocks)

    def __len__(self) -> int:
        return sum(map(len, self._blocks))

    def __getitem__(self, index):
        if isinstance(index, slice):
            return [self[k] for k in range(*index.indices(len(self)))]
        index = range(len(self))[index]
        for block in self._blocks:
            if index < len(block):
                return block[index]
            index -= len(block)
        raise IndexError(index)

    def __iter__(self) -> Iterator[Record]:
        return chain.from_iterable(self._blocks)

    def section(self, name: str) -> Sequence[Record]:
        """Return the records of one section."""
        return next((block for block in self._blocks if block.section == name), ())
