"""Checks of a stored state: numbers that kernels use as places and counts lie within their arrays.

Kernels check no bounds.  A checksum can be made anew, so a resume file may hold any number.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np

from ..kernels.constrained.system import Work
from ..kernels.linalg.rank_revealing_lu import BEHIND_BLOCK, BELOW_PIVOT

# Fields of a clock that a run has from its deck and that no step changes.
GIVEN = ("rtol", "atol", "counted")
# Fields that are places in the state or among the equations, 0 or more.
PLACES = ("worst", "equation")


def clock_fits(stored: Any, own: Any, components: int, equations: int) -> bool:
    """Return whether a stored clock (1,) may take the place of the run's `own`.

    `components` of the state, `equations` of the system: what `PLACES` count.
    """
    if any(stored[name][0] != own[name][0] for name in GIVEN):
        return False
    ends = (max(1, components), max(1, equations))
    return all(0 <= stored[name][0] < end for name, end in zip(PLACES, ends, strict=True))


def works_in(records: Mapping[str, Any]) -> dict[str, Work]:
    """Return the `Work` of named tuples, and of those in them, by their paths."""
    works: dict[str, Work] = {}
    for path, record in records.items():
        if isinstance(record, Work):
            works[path] = record
        elif hasattr(record, "_asdict"):
            parts = {f"{path}/{name}": part for name, part in record._asdict().items()}
            works |= works_in(parts)
    return works


def misplaced(work: Work) -> str:
    """Return the first array of `work` with a number that leads out of an array, "" if all lead into one."""
    m, n = len(work.jacobian), len(work.motions)
    rank = int(work.rank[0])
    if not 0 <= rank <= min(m, n):
        return "rank"
    if not (_is_permutation(work.order[:m]) and _is_permutation(work.order[m:])):
        return "order"
    if not _rows_fit(work.columns[:, 1:], work.columns[:, 0], n):
        return "columns"
    if np.any((work.entries < 0) | (work.entries >= n)):
        return "entries"
    return "" if _ends_fit(work.ends, work.entries, rank) else "ends"


def _is_permutation(order: np.ndarray) -> bool:
    return np.array_equal(np.sort(order), np.arange(order.size))


def _rows_fit(places: np.ndarray, counts: np.ndarray, n: int) -> bool:
    """Return whether each row has `counts` places, all of them in 0 … n - 1."""
    if np.any(counts < 0) or np.any(counts > places.shape[1]):
        return False
    used = np.arange(places.shape[1]) < counts[:, None]
    return bool(np.all((places >= 0) & (places < n) | ~used))


def _ends_fit(ends: np.ndarray, entries: np.ndarray, rank: int) -> bool:
    """Return whether `ends` (m, 4) are those of `factorise`: the parts of rows follow each other.

    Places in the first two parts are places of the leading block, (rank, rank).
    """
    if np.any(ends < 0) or np.any(ends > entries.size) or np.any(np.diff(ends[:rank]) < 0):
        return False
    return all(np.all(entries[first:last] < rank) for first, last in ends[:rank, [BELOW_PIVOT, BEHIND_BLOCK]])
