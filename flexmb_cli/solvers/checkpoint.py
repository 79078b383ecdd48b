"""State of an analysis, as arrays by name, so that a stopped run continues with the same steps."""

import json
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import Fault

if TYPE_CHECKING:
    from ..kernels.constrained.system import Work
    from ..kernels.integrators.integrations import AlphaIntegration, Integration
    from ..model.arrays.contacts import Contacts


def arrays_in(**records: Any) -> dict[str, np.ndarray]:
    """Return the arrays of named tuples, and of those in them, by their paths; a shared one once."""
    arrays, seen = {}, set()
    for path, array in (pair for name, record in records.items() for pair in _walk(record, name)):
        if id(array) not in seen:
            seen.add(id(array))
            arrays[path] = array
    return arrays


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


_OF_SETS = ("count", "begun", "changed", "stepping", "full", "searches")


def contacts_in(contacts: "Contacts", at_start: bool = False) -> dict[str, np.ndarray]:
    """Return what contacts keep of the motion before; `at_start`: as a run needs it that makes the last step
    again.
    """
    if not contacts.sets.size:
        return {}
    pairs = np.zeros(contacts.kept.shape, contacts.kept.dtype)
    for name in pairs.dtype.fields or ():
        pairs[name] = contacts.touches[name]
    if at_start:
        pairs["at_end"], pairs["end_rate"] = pairs["at_start"], pairs["start_rate"]
    return {
        "contact_pairs": pairs,
        "contact_places": contacts.ends["reference"].copy(),
        **{f"contact_{name}": contacts.sets[name].copy() for name in _OF_SETS},
    }


def restore_contacts(stored: Mapping[str, np.ndarray], contacts: "Contacts") -> None:
    """Fill contacts with what `contacts_in` gave of such ones; raises OtherRun."""
    sets, own = contacts.sets, contacts_in(contacts)
    fresh = {name: taken(stored, name, values.shape, values.dtype) for name, values in own.items()}
    if not fresh:
        return
    if np.any((fresh["contact_count"] < 0) | (fresh["contact_count"] > sets["most"])):
        raise OtherRun("contact_count")
    pairs = fresh["contact_pairs"]
    for k, end in enumerate(sets["first_end"] + sets["ends"]):
        own_pairs = pairs[sets["first"][k] :][: fresh["contact_count"][k]]
        ends = np.array([own_pairs["end_i"], own_pairs["end_j"]])
        if np.any((ends < sets["first_end"][k]) | (ends >= end)):
            raise OtherRun("contact_pairs")
    for name in pairs.dtype.fields or ():
        contacts.touches[name] = pairs[name]
    contacts.ends["reference"] = fresh["contact_places"]
    for name in _OF_SETS:
        sets[name] = fresh[f"contact_{name}"]


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
    if not fits or any(expected not in (None, n) for expected, n in zip(shape, array.shape, strict=True)):
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
