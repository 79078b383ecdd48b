"""A result as a MATLAB file (version 5), which MATLAB, Octave and scipy read; and its reader.

The Level 5 format is MathWorks' "MAT-File Format" (2024), chapter 1.  Every length is compared with what is
there: scipy's reader is for files that one trusts, since damaged ones end the process, and a length alone
makes it allocate gigabytes.
"""

import io
import math
import re
import struct
from collections.abc import Iterator
from typing import Any

import h5py
import numpy as np

from ...deck.listing import read_bytes
from ..hdf5.stored_result import attribute
from ..quantities.quantities import ResultError

# Bytes of the header's text, of a variable, and of a name.
HEADER, LARGEST_VARIABLE, LONGEST_NAME = 116, 2**31 - 1, 63


def matlab_bytes(result: h5py.File) -> bytes:
    """The file's bytes: one struct `flexmb`, a field for every group and dataset, `info` for the attributes.

    Names are those of the result, with _ for what MATLAB does not take: body 1 is body_1.  Raises
    `ResultError` for a result that is too large for the format.
    """
    content = _content(result)
    if _size(content) > LARGEST_VARIABLE:
        limit = "larger than the 2 GB of a MATLAB 5 file; MATLAB reads the result itself (h5read)"
        raise ResultError(result.filename, limit, id="RESULT-012")
    return variable_bytes("flexmb", content)


def matlab_fields(result: h5py.File) -> dict[str, np.ndarray]:
    """Return what the file of `result` would hold, by the paths of the fields: `body/position`."""
    return dict(_flat(_content(result)))


def read_matlab(path: str) -> dict[str, np.ndarray]:
    """Return the fields of a file that `flexmb export --to mat` wrote, by their paths.

    Raises TableError when it cannot be read, ValueError when it is another file.
    """
    return dict(_flat(read_variable(read_bytes(path), "flexmb")))


def _flat(content: dict[Any, Any], prefix: str = "") -> Iterator[Any]:
    for name, value in content.items():
        if isinstance(value, dict):
            yield from _flat(value, f"{prefix}{name}/")
        else:
            yield f"{prefix}{name}", np.asarray(value)


def _content(result: h5py.File) -> dict[Any, Any]:
    return _struct(result) | {
        "info": {name: attribute(result, name) for name in result.attrs if name[:1] != "_"}
    }


def variable_bytes(name: str, content: dict[Any, Any]) -> bytes:
    """Return the bytes of a file with one variable; a dictionary is a struct."""
    from scipy.io import savemat

    stream = io.BytesIO()
    savemat(stream, {name: content}, long_field_names=True, oned_as="column")
    # scipy writes the time of the day here; the same result shall give the same bytes.
    text = b"MATLAB 5.0 MAT-file, written by flexmb"
    return text.ljust(HEADER) + stream.getvalue()[HEADER:]


def _struct(group: h5py.File | h5py.Group) -> dict[Any, Any]:
    fields: dict[Any, Any] = {}
    for name, item in group.items():
        fields[_field(name, fields)] = _struct(item) if isinstance(item, h5py.Group) else _values(item)
    return fields


def _field(name: str, taken: dict[Any, Any]) -> str:
    field = re.sub(r"\W", "_", name, flags=re.ASCII)
    field = (field if field[:1].isalpha() else f"x{field}")[:LONGEST_NAME]
    count = 1
    while field in taken:
        count += 1
        field = f"{field[: LONGEST_NAME - 4]}_{count}"
    return field


def _values(dataset: h5py.Dataset) -> np.ndarray | str:
    if h5py.check_string_dtype(dataset.dtype) is None:
        return dataset[()]
    texts = dataset.asstr(errors="replace")[()]
    return texts if isinstance(texts, str) else np.array(texts, dtype=object)


def _size(content: dict[Any, Any]) -> int:
    return sum(
        _size(item) if isinstance(item, dict) else getattr(item, "nbytes", 0) for item in content.values()
    )


_HEADER = 128
_ENDIAN = {b"IM": "<", b"MI": ">"}
_MATRIX = 14
_NUMBERS = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 9: "f8", 12: "i8", 13: "u8"}
_TEXTS = {1: "latin-1", 2: "latin-1", 4: "utf-16", 16: "utf-8", 17: "utf-16", 18: "utf-32"}
_CELL, _STRUCT, _CHAR = 1, 2, 4
_CLASSES = {6: "f8", 7: "f4", 8: "i1", 9: "u1", 10: "i2", 11: "u2", 12: "i4", 13: "u4", 14: "i8", 15: "u8"}
_COMPLEX = 0x0800
_DEEPEST = 32  # structs in structs

Content = dict[str, Any]


def read_variable(raw: bytes, name: str) -> Content:
    """Return the struct `name` of a file's bytes: fields are arrays, texts, lists of texts, or dictionaries.

    Raises ValueError for anything but such a file.
    """
    order = _ENDIAN.get(raw[126:_HEADER])
    if order is None:
        raise ValueError("it has no header of a MATLAB 5 file")
    elements = _Elements(raw, _HEADER, len(raw), order)
    while elements.left:
        variable, content = _matrix(elements, 0)
        if variable == name and isinstance(content, dict):
            return content
    raise ValueError(f"it has no struct {name}")


class _Elements:
    """The data elements between two places of a file, one after the other."""

    def __init__(self, raw: bytes, start: int, end: int, order: str):
        self.raw, self.at, self.end, self.order = raw, start, end, order

    @property
    def left(self) -> bool:
        """Return whether there is another element."""
        return self.at < self.end

    def next(self) -> tuple[int, int, int]:
        """Return the type of the next element, and where its content begins and ends."""
        if self.at + 8 > self.end:
            raise ValueError("it ends within an element")
        kind, length = struct.unpack_from(f"{self.order}II", self.raw, self.at)
        start = self.at + 8
        if kind >> 16:  # a small element: both counts in the first four bytes, the content in the next
            kind, length, start = kind & 0xFFFF, kind >> 16, self.at + 4
            if length > 4:
                raise ValueError("a small element is larger than four bytes")
        if start + length > self.end:
            raise ValueError("an element is longer than what holds it")
        # Elements begin at multiples of eight bytes; the last may end short of one.
        self.at = min(self.end, start + length + (-(start + length) % 8))
        return kind, start, start + length

    def numbers(self) -> np.ndarray:
        """Return the numbers of the next element."""
        kind, start, end = self.next()
        if kind not in _NUMBERS:
            raise ValueError(f"an element of type {kind} stands where numbers are expected")
        dtype = np.dtype(self.order + _NUMBERS[kind])
        return np.frombuffer(self.raw, dtype, (end - start) // dtype.itemsize, start)

    def text(self) -> str:
        """Return the characters of the next element."""
        kind, start, end = self.next()
        if kind not in _TEXTS:
            raise ValueError(f"an element of type {kind} stands where a text is expected")
        code = _TEXTS[kind]
        if code in ("utf-16", "utf-32"):
            code += "-le" if self.order == "<" else "-be"
        return self.raw[start:end].decode(code, "replace")

    def within(self) -> "_Elements":
        """Return the elements of the next one, which is a matrix."""
        kind, start, end = self.next()
        if kind != _MATRIX:
            raise ValueError(f"an element of type {kind} stands where an array is expected")
        return _Elements(self.raw, start, end, self.order)


def _matrix(outer: _Elements, depth: int) -> tuple[str, Any]:
    """Return name and content of the array that comes next."""
    if depth > _DEEPEST:
        raise ValueError(f"its structs are nested deeper than {_DEEPEST}")
    elements = outer.within()
    if not elements.left:
        return "", np.zeros((0, 0))
    flags = elements.numbers()
    shape = tuple(int(length) for length in elements.numbers())
    name = elements.text()
    if not flags.size or not shape or min(shape) < 0:
        raise ValueError("an array has no type or no size")
    kind, count = int(flags[0]) & 0xFF, math.prod(shape)
    if kind == _STRUCT and count == 1:
        return name, _fields(elements, depth)
    if kind == _CELL:
        return name, _cells(elements, count, depth)
    if kind == _CHAR:
        return name, elements.text() if elements.left else ""
    if kind not in _CLASSES or int(flags[0]) & _COMPLEX:
        raise ValueError(f"an array of class {kind} is none that flexmb writes")
    values = elements.numbers()
    if values.size != count:
        raise ValueError(f"an array of {count} numbers has {values.size}")
    return name, values.astype(_CLASSES[kind]).reshape(shape, order="F")


def _fields(elements: _Elements, depth: int) -> Content:
    """Return the fields of a struct by name."""
    width = elements.numbers()
    names = elements.text()
    if width.size != 1 or width[0] < 1:
        raise ValueError("the names of a struct have no length")
    step = int(width[0])
    keys = [names[k : k + step].partition("\0")[0] for k in range(0, len(names), step)]
    return {key: _matrix(elements, depth + 1)[1] for key in keys}


def _cells(elements: _Elements, count: int, depth: int) -> list[str]:
    """Return texts; a cell of anything else is none that flexmb writes."""
    texts = []
    for _ in range(count):
        content = _matrix(elements, depth + 1)[1]
        if not isinstance(content, str) and np.size(content):
            raise ValueError("a cell holds something else than a text")
        texts.append(content if isinstance(content, str) else "")
    return texts
