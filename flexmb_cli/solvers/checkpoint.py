"""State of an analysis, as arrays by name, so that a stopped run continues with the same steps."""

import json
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import Fault
from ..kernels.constrained.system import Work
from ..kernels.linalg.sparse_rows import BEHIND_BLOCK, BELOW_PIVOT

if TYPE_CHECKING:
    from ..kernels.constrained.system import Work
    from ..kernels.integrators.constrained_dop853 import Integration
    from ..kernels.integrators.generalised_alpha import AlphaIntegration


def arrays_in(**records: Any) -> dict[str, np.ndarray]:
    """Return the arrays of named tuples, and of those in them, by their paths; a shared one once."""
    found, seen = {}, set()
    for path, array in (pair for name, record in records.items() for pair in _walk(record, name)):
        if id(array) not in seen:
            seen.add(id(array))
            found[path] = array
    return found


class OtherRun(ValueError):
    """Checkpoint that does not fit the analysis that is to continue from it."""


def fill_arrays(stored: Mapping[str, np.ndarray], **records: Any) -> None:
    """Fill the arrays of named tuples with what `arrays_in` gave of such ones.

    Raises OtherRun, also for a number that leads a kernel out of an array.
    """
    from .stored_places import misplaced, works_in

    for path, array in arrays_in(**records).items():
        array[...] = taken(stored, path, array.shape, array.dtype)
    for path, work in works_in(records).items():
        if name := misplaced(work):
            raise OtherRun(f"{path}/{name}")


def taken_clock(
    stored: Mapping[str, np.ndarray], name: str, own: np.ndarray, components: int, equations: int
) -> np.ndarray:
    """Return the clock (1,) of a checkpoint, which may replace `own`; see `stored_places.clock_fits`.

    Raises OtherRun.
    """
    from .stored_places import clock_fits

    clock = taken(stored, name, own.shape, own.dtype)
    if not clock_fits(clock, own, components, equations):
        raise OtherRun(name)
    return clock


def taken(
    stored: Mapping[str, np.ndarray],
    name: str,
    shape: tuple[Any, ...],
    dtype: np.dtype | type | None = np.float64,
) -> np.ndarray:
    """Return the array `name` of a checkpoint, of a shape (None: any length) and a type (None: numbers).

    Raises OtherRun: numpy would spread a shorter array over a longer one without a word.
    """
    array = stored.get(name)
    if array is None or array.ndim != len(shape):
        raise OtherRun(name)
    fits = array.dtype.kind in "iuf" if dtype is None else array.dtype == dtype
    if not fits or any(wanted not in (None, found) for wanted, found in zip(shape, array.shape, strict=True)):
        raise OtherRun(name)
    return array


def row_of(stored: Mapping[str, np.ndarray]) -> int:
    """Return how many report rows lie before a checkpoint.  Raises OtherRun."""
    return int(taken(stored, "row", (), np.int64))


def _walk(record: "Work | Integration | AlphaIntegration", prefix: str) -> Iterator[tuple[str, np.ndarray]]:
    for name, value in record._asdict().items():
        path = f"{prefix}/{name}"
        if hasattr(value, "_asdict"):
            yield from _walk(value, path)
        else:
            yield path, value


def reported(warnings: list[Fault]) -> np.ndarray:
    """Return faults as an array () of one text."""
    return np.array(json.dumps([fault.as_record() for fault in warnings]))


def faults_reported(stored: Mapping[str, np.ndarray]) -> list[Fault]:
    """Return the faults that `reported` was given as the `warnings` of a checkpoint.  Raises OtherRun."""
    try:
        return [Fault.of_record(record) for record in json.loads(str(stored["warnings"]))]
    except (ValueError, TypeError, KeyError, RecursionError) as fault:
        raise OtherRun("warnings") from fault


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
    found: dict[str, Work] = {}
    for path, record in records.items():
        if isinstance(record, Work):
            found[path] = record
        elif hasattr(record, "_asdict"):
            parts = {f"{path}/{name}": part for name, part in record._asdict().items()}
            found |= works_in(parts)
    return found


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
