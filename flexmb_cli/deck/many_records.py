"""The records of a large deck, each made when it is looked at: kept, they would take many times the deck."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

from .lazy import Chained, Lazy
from .number_table import NumberTable
from .record import Record

MANY_NUMBERS = 100_000  # numbers; fewer are kept as records, which studies share


@dataclass(frozen=True)
class Block(Lazy):
    """All records of one section, which `made` makes of their places in it; `changed` ones are kept.

    `table`: their numbers, where all of them have the same ones.
    """

    section: str
    size: int
    made: Callable[[int], Record]
    changed: Mapping[int, Record] = field(default_factory=dict)
    table: NumberTable | None = None

    def __len__(self) -> int:
        return self.size

    def numbered(self, number: int) -> Record | None:
        """Return the record of this number; those of most sections are numbered in their order."""
        neighbours = (self[k] for k in (number - 1, number) if 0 <= k < self.size)
        found = next((record for record in neighbours if record.number == number), None)
        if found is None and number in self._places:
            found = self[self._places[number]]
        return found

    @cached_property
    def _places(self) -> dict[int, int]:
        """Places of the records by their numbers, the first of each."""
        places: dict[int, int] = {}
        for k, record in enumerate(self):
            places.setdefault(record.number, k)
        return places

    def _item(self, index: int) -> Record:
        return self.changed[index] if index in self.changed else self.made(index)


class ManyRecords(Chained):
    """Records by sections, in the deck's order."""

    def __init__(self, blocks: Sequence[Block]):
        super().__init__(blocks)
        self.blocks = tuple(blocks)

    def section(self, name: str) -> Sequence[Record]:
        """Return the records of one section."""
        return next((block for block in self.blocks if block.section == name), ())

    def with_changed(self, changed: Mapping[int, Record]) -> "ManyRecords":
        """Return the records with others at some places."""
        blocks, first = [], 0
        for block in self.blocks:
            own = {k - first: record for k, record in changed.items() if first <= k < first + len(block)}
            blocks.append(replace(block, changed={**block.changed, **own}))
            first += len(block)
        return ManyRecords(blocks)


def blocks_of(records: Sequence[Record]) -> list[Block]:
    """Return the blocks of records that are kept, or of many ones."""
    if isinstance(records, ManyRecords):
        return list(records.blocks)
    found: dict[str, list[Record]] = {}
    for record in records:
        found.setdefault(record.section, []).append(record)
    return [Block(section, len(group), group.__getitem__) for section, group in found.items()]
