"""Conversion of Python values into the words that compiled code takes, and back.

A parameter is "i", "f" or "b" for a number, an Array or a Fields.  An array is handed over as address and
shape.
"""

import ctypes
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

_NUMBERS = {int: "i", np.int64: "i", float: "f", np.float64: "f", bool: "b", np.bool_: "b"}
_ACCEPTED = {
    "i": frozenset({int, np.int64}),
    "f": frozenset({float, np.float64, int, np.int64}),
    "b": frozenset({bool, np.bool_}),
}


class Array(NamedTuple):
    """An array in C's order."""

    dimensions: int  # count of axes
    dtype: np.dtype  # of its entries


class Fields(NamedTuple):
    """A tuple."""

    kind: type  # its class: `tuple`, or one of named tuples
    parts: list  # parameters, one for each field


def describe(value: object) -> Any:
    """Return the parameter that takes `value`; raises TypeError where none does."""
    if type(value) is np.ndarray and value.flags.carray:
        return Array(value.ndim, value.dtype)
    if isinstance(value, tuple):
        return Fields(type(value), [describe(one) for one in value])
    if type(value) not in _NUMBERS:
        raise TypeError(type(value).__name__)
    return _NUMBERS[type(value)]


def key_of(parameter: Any) -> str:
    """Return a text that equal parameters have in common, and no others."""
    if isinstance(parameter, Array):
        return f"{parameter.dimensions} {parameter.dtype.descr}"
    if isinstance(parameter, Fields):
        kind = parameter.kind
        names = getattr(kind, "_fields", ())
        return f"{kind.__module__}.{kind.__qualname__}{names}[{', '.join(map(key_of, parameter.parts))}]"
    return str(parameter)


def size_of(parameter: Any) -> int:
    """Return how many words a parameter takes."""
    if isinstance(parameter, Fields):
        return sum(map(size_of, parameter.parts))
    return 1 + parameter.dimensions if isinstance(parameter, Array) else 1


class Words:
    """Words of a list of parameters.

    A tuple stays what it is: where the same one comes again, its words are still there.
    """

    def __init__(self, parameters: list):
        count = max(1, sum(map(size_of, parameters)))
        words = (ctypes.c_int64 * count)()
        self._room = words, (ctypes.c_double * count).from_buffer(words)
        self.address = ctypes.addressof(words)
        self._packers, first = [], 0
        for parameter in parameters:
            self._packers.append(self._packer(parameter, first))
            first += size_of(parameter)

    def pack(self, values: tuple) -> bool:
        """Fill the words; whether the values are what the parameters describe."""
        if len(values) != len(self._packers):
            raise TypeError(f"{len(values)} arguments, where {len(self._packers)} are taken")
        return all(put(value) for put, value in zip(self._packers, values, strict=True))

    def _packer(self, parameter: Any, first: Any) -> Callable[..., Any]:
        """Return the function that fills the words of a parameter from `first` on."""
        if isinstance(parameter, Array):
            return _array_packer(self._room[0], first, *parameter)
        if isinstance(parameter, Fields):
            parts = []
            for part in parameter.parts:
                parts.append(self._packer(part, first))
                first += size_of(part)
            return _tuple_packer(parts, parameter.kind)
        room = self._room[parameter == "f"]
        return _number_packer(room, first, _ACCEPTED[parameter])


def _array_packer(words: Any, first: int, dimensions: Any, dtype: np.dtype) -> Callable[..., Any]:
    end = first + 1 + dimensions

    def put(array: float | list[float] | np.ndarray) -> bool:
        nonlocal dtype
        if type(array) is not np.ndarray or array.ndim != dimensions or not array.flags.carray:
            return False
        if array.dtype is not dtype:
            if array.dtype != dtype:
                return False
            dtype = array.dtype  # comparing records takes longer than all the rest
        words[first] = array.ctypes.data
        words[first + 1 : end] = array.shape
        return True

    return put


def _tuple_packer(parts: list[Callable[..., Any]], kind: type) -> Callable[..., Any]:
    packed_last = None

    def put(values: tuple[int | np.ndarray, ...]) -> bool:
        nonlocal packed_last
        if values is packed_last:
            return True
        packed_last = None
        if type(values) is not kind or len(values) != len(parts):
            return False
        if not all(put_part(value) for put_part, value in zip(parts, values, strict=True)):
            return False
        # A list inside could change; arrays and tuples hold on to what was packed.
        packed_last = values
        return True

    return put


def _number_packer(words: Any, place: int, accepted: frozenset[type]) -> Callable[..., Any]:
    def put(value: float) -> bool:
        if type(value) not in accepted:
            return False
        words[place] = value
        return True

    return put


class Results:
    """Words that compiled code leaves: nothing, a number, or a tuple, "(" before its numbers' letters."""

    def __init__(self, result: str):
        self._is_tuple, self._kinds = result.startswith("("), result.removeprefix("(")
        self._words = (ctypes.c_int64 * max(1, len(self._kinds)))()
        self._floats = (ctypes.c_double * len(self._words)).from_buffer(self._words)
        self.address = ctypes.addressof(self._words)

    def value(self) -> object:
        """Return the value that was left."""
        fitting = [
            self._floats[k] if kind == "f" else bool(self._words[k]) if kind == "b" else self._words[k]
            for k, kind in enumerate(self._kinds)
        ]
        if self._is_tuple:
            return tuple(fitting)
        return fitting[0] if fitting else None
