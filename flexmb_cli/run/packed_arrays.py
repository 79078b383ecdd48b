"""Named arrays as bytes of a resume file: a line of JSON that describes them, and what they hold."""

import json
import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.lib.format import descr_to_dtype, dtype_to_descr

# What JSON and numpy raise of a description that is none.
_UNDESCRIBED = (ValueError, TypeError, KeyError, SyntaxError, RecursionError)
# numpy refuses such shapes, of no numbers, too.
_TOO_BIG = 2**62
_LONGEST_DESCRIPTION = 2**22  # bytes, for 50,000 arrays: Python takes twenty times as many for them


def packed(arrays: dict[str, np.ndarray]) -> bytes:
    """An entry: a line that describes the arrays, and their bytes; files of numpy take ten times longer."""
    given = {name: np.asarray(array) for name, array in arrays.items()}
    reported = [[name, dtype_to_descr(array.dtype), array.shape] for name, array in given.items()]
    # Joined as they lie: a copy of each array would take a third of the time.
    parts = [np.ascontiguousarray(array).data for array in given.values()]
    return b"".join((json.dumps(reported).encode(), b"\n", *parts))


def is_whole(entry: bytes) -> Any:
    """Return whether an entry describes arrays, and holds as many bytes as they have."""
    try:
        size = sum(dtype.itemsize * math.prod(shape) for _, dtype, shape in _described(entry))
        return size == len(entry) - entry.index(b"\n") - 1
    except _UNDESCRIBED:
        return False


def _described(entry: bytes) -> Any:
    """Name, type and shape of the arrays of an entry.  Raises one of `_UNDESCRIBED`."""
    described = []
    end = entry.index(b"\n", 0, _LONGEST_DESCRIPTION)
    for name, reported, shape in json.loads(entry[:end]):
        dtype = descr_to_dtype(_with_tuples(reported))
        counted = all(type(length) is int and length >= 0 for length in shape)
        if not (isinstance(name, str) and counted and dtype.itemsize) or dtype.hasobject:
            raise ValueError(name)
        if math.prod(length or 1 for length in shape) * dtype.itemsize >= _TOO_BIG:
            raise ValueError(name)
        described.append((name, dtype, shape))
    return described


def names_of(entry: bytes) -> Any:
    """The names of the arrays of an entry."""
    return [name for name, _, _ in _described(entry)]


def arrays_of(entry: bytes, names: tuple[str, ...] | None = None) -> Any:
    """The arrays of an entry, or those of them that are called `names`."""
    found, start = {}, entry.index(b"\n") + 1
    for name, kind, shape in _described(entry):
        count = math.prod(shape)
        array = np.frombuffer(entry, kind, count, start) if count else np.empty(0, kind)
        array = array.reshape(shape)
        start += array.nbytes
        if names is None or name in names:
            found[name] = array.copy()
    return found


def _with_tuples(described: Sequence[Sequence[str]] | str) -> Any:
    """Return a dtype's description with tuples, as numpy needs it: JSON has lists only."""
    if isinstance(described, str):
        return described
    return [(name, _with_tuples(kind), *map(tuple, shape)) for name, kind, *shape in described]
