"""Where an analysis stands, as arrays by name, so that a stopped run goes on with the same steps."""

import json
from collections.abc import Iterator, Mapping

import numpy as np

from ..errors import Fault


def arrays_in(**records) -> dict[str, np.ndarray]:
    """Return the arrays of named tuples, and of those in them, by their paths; a shared one once."""
    found, seen = {}, set()
    for path, array in (pair for name, record in records.items() for pair in _walk(record, name)):
        if id(array) not in seen:
            seen.add(id(array))
            found[path] = array
    return found


def fill_arrays(stored: Mapping, **records) -> None:
    """Fill the arrays of named tuples with what `arrays_in` gave of such ones."""
    for path, array in arrays_in(**records).items():
        array[...] = stored[path]


def _walk(record, prefix) -> Iterator[tuple[str, np.ndarray]]:
    for name, value in record._asdict().items():
        path = f"{prefix}/{name}"
        if hasattr(value, "_asdict"):
            yield from _walk(value, path)
        else:
            yield path, value


def reported(warnings: list[Fault]) -> np.ndarray:
    """Return faults as an array of one text."""
    return np.array(json.dumps([fault.as_record() for fault in warnings]))


def faults_reported(stored: np.ndarray) -> list[Fault]:
    """Return the faults that `reported` was given."""
    return [Fault.of_record(record) for record in json.loads(str(stored))]
