"""The numbers of many records of one type, by columns: a record takes a hundred times as long to make."""

from array import array
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, cast

from .record import Record

if TYPE_CHECKING:
    import numpy as np

    from .many_records import Block


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

        found: np.ndarray = ~np.isnan(self._given[:, self._places[key]])
        return found

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
    found = table.column(key)
    for k, record in changed.items():
        found[k] = record[key]
    return found


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
    found = column(records, key)
    return (records[k] for k in np.flatnonzero((found < lowest) | (found > highest)).tolist())


def _in_columns(records: Sequence[Record]) -> tuple[NumberTable, Mapping[int, Record]] | None:
    """Return the numbers of a block of records, and its changed records; None for other records."""
    table: NumberTable | None = getattr(records, "table", None)
    return None if table is None else (table, cast("Block", records).changed)
