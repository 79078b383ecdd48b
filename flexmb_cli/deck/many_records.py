"""The records of a large deck, each made when it is looked at: kept, they would take many times the deck."""

from array import array
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, cast

from ..errors import Place
from .lazy import BySection, Lazy, Made
from .record import Deck, Number, Record

if TYPE_CHECKING:
    import numpy as np

MANY_RECORDS = 10_000


class NumberTable:
    """Rows of numbers `rows` under `defaults` by their keys; nan: an empty field, which has its default."""

    def __init__(self, defaults: Mapping[str, float | None], rows: "array[float]"):
        self.defaults, self._rows = defaults, rows

    def column(self, key: str) -> "np.ndarray":
        """Return the numbers (record,) under a key."""
        import numpy as np

        given = self._given[:, self._places[key]]
        # A field without a default is never empty; None would make an array of objects.
        default = self.defaults[key]
        return given.copy() if default is None else np.where(np.isnan(given), default, given)

    def filled(self, key: str) -> "np.ndarray":
        """Return which records (record,) have a number under a key."""
        import numpy as np

        return ~np.isnan(self._given[:, self._places[key]])

    @cached_property
    def _given(self) -> "np.ndarray":
        import numpy as np

        return np.frombuffer(self._rows, float).reshape(-1, len(self.defaults))

    @cached_property
    def _places(self) -> dict[str, int]:
        return {key: k for k, key in enumerate(self.defaults)}


def column(records: Sequence[Record], key: str) -> "np.ndarray":
    """Return the numbers (record,) that the records have under a key."""
    import numpy as np

    in_columns = _in_columns(records)
    if in_columns is None:
        return np.array([record[key] for record in records])
    table, changed = in_columns
    values = table.column(key)
    for k, record in changed.items():
        values[k] = record[key]
    return values


def places_by(records: Sequence[Record], key: str) -> Mapping[int, "array[int]"]:
    """Return where the records with each integer under a key stand, by the integers as they come first."""
    if len(records) > MANY_RECORDS:
        return ManyPlaces(column(records, key))
    places: dict[int, array[int]] = {}
    for k, value in enumerate(column(records, key).tolist()):
        places.setdefault(int(value), array("i")).append(k)
    return places


class ManyPlaces(Mapping[int, "array[int]"]):
    """Places of many integers (record,), sorted: an array for each integer would take 200 bytes."""

    def __init__(self, given: "np.ndarray"):
        import numpy as np

        self._order = np.argsort(given, kind="stable")
        ordered = given[self._order]
        self._first = np.flatnonzero(np.diff(ordered, prepend=np.nan))
        self._integers = ordered[self._first].astype(np.int64)

    def __len__(self) -> int:
        return len(self._integers)

    def __iter__(self) -> "Iterator[int]":
        ordered = self._order[self._first].argsort()
        return iter(self._integers[ordered].tolist())

    def __getitem__(self, integer: int) -> "array[int]":
        group = int(self._integers.searchsorted(integer))
        if group == len(self) or self._integers[group] != integer:
            raise KeyError(integer)
        end = self._first[group + 1] if group + 1 < len(self) else len(self._order)
        return array("q", self._order[self._first[group] : end].tobytes())


def without_any(records: Sequence[Record], keys: Sequence[str]) -> Iterable[Record]:
    """Return the records in which the fields of all `keys` are empty."""
    import numpy as np

    in_columns = _in_columns(records)
    if in_columns is None:
        return (record for record in records if not any(record.at(key).text for key in keys))
    table, changed = in_columns
    filled = np.any([table.filled(key) for key in keys], axis=0)
    filled[list(changed)] = True
    return (records[k] for k in np.flatnonzero(~filled).tolist())


def outside(records: Sequence[Record], key: str, lowest: float, highest: float) -> Iterable[Record]:
    """Return the records whose number under a key is below `lowest` or above `highest`."""
    import numpy as np

    if _in_columns(records) is None:
        return (record for record in records if not lowest <= record[key] <= highest)
    values = column(records, key)
    return (records[k] for k in np.flatnonzero((values < lowest) | (values > highest)).tolist())


def _in_columns(records: Sequence[Record]) -> tuple[NumberTable, Mapping[int, Record]] | None:
    """Return the numbers of a block of records, and its changed records; None for other records."""
    table: NumberTable | None = getattr(records, "table", None)
    return None if table is None else (table, cast("Block", records).changed)


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
        nearest = next((record for record in neighbours if record.number == number), None)
        if nearest is None and number in self._places:
            nearest = self[self._places[number]]
        return nearest

    @cached_property
    def _places(self) -> dict[int, int]:
        """Places of the records by their numbers, the first of each."""
        places: dict[int, int] = {}
        for k, record in enumerate(self):
            places.setdefault(record.number, k)
        return places

    def _item(self, index: int) -> Record:
        return self.changed[index] if index in self.changed else self.made(index)


class ManyRecords(BySection):
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
    groups: dict[str, list[Record]] = {}
    for record in records:
        groups.setdefault(record.section, []).append(record)
    return [Block(section, len(group), group.__getitem__) for section, group in groups.items()]


class DeckValues:
    """Look-up of a deck's records; a card that is not given leaves its defaults."""

    def __init__(self, deck: Deck):
        self.deck = deck
        self.many = not isinstance(deck.records, tuple)
        self._records: dict[str, dict[int, Record]] = {}
        for record in () if self.many else deck.records:
            self._records.setdefault(record.section, {})[record.number] = record
        self._of_bodies: dict[str, Mapping[int, array[int]]] = {}
        self._columns: dict[tuple[str, str], np.ndarray] = {}

    def section(self, name: str) -> Sequence[Record]:
        """All records of a section in the deck's order; empty when its card is not given."""
        if self.many:
            return self.deck.section(name)
        return list(self._records.get(name, {}).values())

    def record(self, section: str, number: int = 0) -> Record | None:
        """One record, None when its card is not given."""
        if self.many:
            block = self.deck.section(section)
            return cast("Block", block).numbered(number) if block else None
        return self._records.get(section, {}).get(number)

    def of_body(self, section: str, body: int) -> Sequence[Record]:
        """Return the records of a section whose first number is that of a body."""
        places = self.places_of_body(section, body)
        records = self.section(section) if len(places) else ()
        return Made(places, records.__getitem__) if self.many else [records[k] for k in places]

    def places_of_body(self, section: str, body: int) -> Sequence[int]:
        """Return where among the records of a section those of a body stand."""
        if section not in self._of_bodies:
            self._of_bodies[section] = places_by(self.section(section), "body")
        return self._of_bodies[section].get(body, ())

    def column(self, section: str, key: str) -> "np.ndarray":
        """Return the numbers (record,) that the records of a section have under a key."""
        if (section, key) not in self._columns:
            self._columns[section, key] = column(self.section(section), key)
        return self._columns[section, key]

    def number(self, section: str, number: int, key: str) -> Number:
        """One number of a card that must be there."""
        record = self.record(section, number)
        assert record is not None, f"{section} {number} must be there"
        return record.at(key)

    def values(self, section: str, number: int, default: tuple[Any, ...]) -> tuple[Any, ...]:
        """All values of a record, or `default`."""
        record = self.record(section, number)
        return default if record is None else tuple(record.values)

    def place(self, section: str, number: int = 0) -> Place | None:
        """Return where a record stands, None when it does not."""
        record = self.record(section, number)
        return record.place if record else None
