"""Conversion of Python values into the words that compiled code takes, and back.

A parameter is described by what JSON can hold: "i", "f", "b" for numbers, ["a", dimensions, type] for an
array and ["t", class, parameters, names of fields] for a tuple.  An array is handed over as address and
shape.
"""

import ctypes
import json
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable


_NUMBERS = {int: "i", np.int64: "i", float: "f", np.float64: "f", bool: "b", np.bool_: "b"}
_ACCEPTED = {
    "i": frozenset({int, np.int64}),
    "f": frozenset({float, np.float64, int, np.int64}),
    "b": frozenset({bool, np.bool_}),
}


class NotDescribedError(Exception):
    """A value that no object takes: numba has to see it itself."""


def describe(value: object) -> "str | list":
    """Return the parameter that takes `value`; raises NotDescribedError."""
    if type(value) is np.ndarray and value.flags.carray:
        return ["a", value.ndim, _described_type(value.dtype)]
    if isinstance(value, tuple):
        return tuple_parameter(type(value), [describe(one) for one in value])
    if type(value) not in _NUMBERS:
        raise NotDescribedError(type(value).__name__)
    return _NUMBERS[type(value)]


def tuple_parameter(kind: type, parameters: list) -> list:
    """Return the parameter of a tuple of a class; plain tuples have no names."""
    return ["t", class_name(kind), parameters, list(getattr(kind, "_fields", ()))]


def class_name(kind: type) -> str:
    """Return the place and name of a class of named tuples, nothing for plain tuples."""
    return "" if kind is tuple else f"{kind.__module__}:{kind.__qualname__}"


def key_of(parameters: list) -> str:
    """Return a text that equal lists of parameters have in common, and no others."""
    return json.dumps(parameters, separators=(",", ":"))


def _described_type(dtype: np.dtype) -> Any:
    return dtype.descr if dtype.names else dtype.str


def described_dtype(text: "str | list") -> np.dtype:
    """Return the type of an array's numbers from its description."""
    if isinstance(text, str):
        return np.dtype(text)
    fields = [(name, described_dtype(kind), *map(tuple, shape)) for name, kind, *shape in text]
    return np.dtype(fields)


def flat(parameter: "str | list") -> list:
    """Return the numbers and arrays of which a parameter consists."""
    if parameter[0] != "t":
        return [parameter]
    return [one for part in parameter[2] for one in flat(part)]


def size_of(parameter: "list[Any] | str") -> int:
    """Return how many words a parameter takes."""
    return sum(1 + one[1] if one[0] == "a" else 1 for one in flat(parameter))


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

    def _packer(self, parameter: Any, first: Any) -> "Callable[..., Any]":
        """Return the function that fills the words of a parameter from `first` on."""
        if parameter[0] == "a":
            return _array_packer(self._room[0], first, parameter[1], described_dtype(parameter[2]))
        if parameter[0] == "t":
            parts = []
            for part in parameter[2]:
                parts.append(self._packer(part, first))
                first += size_of(part)
            return _tuple_packer(parts, parameter[1])
        room = self._room[parameter == "f"]
        return _number_packer(room, first, _ACCEPTED[parameter])


def _array_packer(words: Any, first: int, dimensions: Any, dtype: np.dtype) -> "Callable[..., Any]":
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


def _tuple_packer(parts: "list[Callable[..., Any]]", name: str) -> "Callable[..., Any]":
    kept, known = None, None

    def put(values: tuple[int | np.ndarray, ...]) -> bool:
        nonlocal kept, known
        if values is kept:
            return True
        kept = None
        if type(values) is not known:
            if not isinstance(values, tuple) or class_name(type(values)) != name or len(values) != len(parts):
                return False
            known = type(values)
        if not all(put_part(value) for put_part, value in zip(parts, values, strict=True)):
            return False
        # A list inside could change; arrays and tuples hold on to what was packed.
        kept = values
        return True

    return put


def _number_packer(words: Any, place: int, accepted: frozenset[type]) -> "Callable[..., Any]":
    def put(value: float) -> bool:
        if type(value) not in accepted:
            return False
        words[place] = value
        return True

    return put


class Results:
    """Words that compiled code leaves, and the value they are: nothing, a number, or a tuple of numbers.

    A tuple is described by "(" before the letters of its numbers.
    """

    def __init__(self, result: str):
        self._is_tuple, self._kinds = result.startswith("("), result.removeprefix("(")
        count = max(1, len(self._kinds))
        words = (ctypes.c_int64 * count)()
        self._room = {"i": words, "b": words, "f": (ctypes.c_double * count).from_buffer(words)}
        self.address = ctypes.addressof(words)

    def value(self) -> object:
        """Return the value that was left."""
        found = [self._room[kind][k] for k, kind in enumerate(self._kinds)]  # type: ignore[index]
        found = [bool(x) if kind == "b" else x for kind, x in zip(self._kinds, found, strict=True)]
        if self._is_tuple:
            return tuple(found)
        return found[0] if found else None
