"""Nastran matrices as OP4 binary: Fortran records, either byte order, words of four or eight bytes.

MSC Nastran DMAP Programmer's Guide, OUTPUT4.  A record of columns, rows, form, type and name heads a matrix,
one for every column that is not zero follows, and one behind the last column closes it.
"""

import struct
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from .matrix_choice import NamedMatrix
from .matrix_file import FEFileFault, MatrixFile, of_strings

REAL = (1, 2)
_COMPLEX = (3, 4)
# The first row of a string is packed with its length: row + 65536 (length + 1).
PACKED = 65536
# Four integers and a name of two words.
_HEADING_WORDS = 6


@dataclass(frozen=True)
class _Layout:
    """Name of the file, byte order ("<" or ">"), and bytes of a word."""

    file: str
    order: str
    word: int

    def integers(self, record: memoryview, first: int, count: int) -> tuple[int, ...]:
        """`count` integers from word `first` on."""
        kind = "i" if self.word == 4 else "q"
        try:
            return struct.unpack_from(f"{self.order}{count}{kind}", record, first * self.word)
        except struct.error:
            message = f"{self.file}: a record of {len(record)} bytes is too short"
            raise FEFileFault(message, id="FE-045") from None

    def value(self, kind: int) -> np.dtype:
        """A real number of type 1 (single, which in words of eight bytes is double) or 2 (double)."""
        return np.dtype(f"{self.order}f{self.word if kind == 1 else 8}")


def binary_matrices(file: str, raw: bytes) -> list[NamedMatrix]:
    """The matrices of the file `file`; only what is chosen is read.  Raises FEFileFault."""
    layout = _layout(file, raw)
    records, found = _records(layout, memoryview(raw)), []
    for heading in records:
        columns, rows, _, kind = shape = layout.integers(heading, 0, 4)
        name = bytes(heading[4 * layout.word : _HEADING_WORDS * layout.word]).decode("latin-1")
        name = name.strip().upper()
        strings = list(_columns(layout, columns, records))
        usable = kind in REAL and abs(rows) == columns
        found.append(NamedMatrix(name, usable, partial(_read_one, layout, name, shape, strings)))
    return found


def _layout(file: str, raw: bytes) -> _Layout:
    """Recognised by the length of the first record."""
    for order in "<>":
        length = struct.unpack(f"{order}i", raw[:4])[0] if len(raw) >= 4 else 0
        if length in (4 * _HEADING_WORDS, 8 * _HEADING_WORDS):
            return _Layout(file, order, length // _HEADING_WORDS)
    raise FEFileFault(
        f"{file} is a binary file, but no OP4: its first record is not of 24 or 48 bytes (an OP2? write "
        "OP4 by OUTPUT4, binary or as text)",
        id="FE-046",
    )


def _records(layout: _Layout, raw: memoryview) -> Iterator[memoryview]:
    """Records between their lengths, which stand before and behind."""
    at = 0
    while at < len(raw):
        length = struct.unpack_from(f"{layout.order}i", raw, at)[0] if at + 4 <= len(raw) else -1
        end = at + 4 + length
        if length < 0 or raw[end : end + 4] != raw[at : at + 4]:
            message = f"the record at byte {at} has no end where its length says; was the file cut off?"
            raise FEFileFault(f"{layout.file}: {message}", id="FE-047")
        yield raw[at + 4 : end]
        at = end + 4


def _columns(layout: _Layout, columns: int, records: Iterator[memoryview]) -> Iterator[memoryview]:
    """The records of a matrix: of its columns, and the one of a column behind the last that closes it."""
    for record in records:
        yield record
        if layout.integers(record, 0, 1)[0] > columns:
            return


def _read_one(
    layout: _Layout, name: str, shape: tuple[int, ...], records: Sequence[memoryview]
) -> MatrixFile:
    columns, rows, _, kind = shape
    _check(layout, name, columns, rows, kind)
    strings: list[Any] = []
    for record in records:
        column, row, words = layout.integers(record, 0, 3)
        if column > columns:
            return of_strings(f"{layout.file}, matrix {name}", columns, strings)
        held = len(record) // layout.word - 3
        if column < 1 or words > held:
            message = f"matrix {name}, column {column}: the record claims {words} words and holds {held}"
            raise FEFileFault(f"{layout.file}: {message}", id="FE-048")
        strings += _column(layout, record, (column, row, words), rows < 0, layout.value(kind))
    message = f"{layout.file}: matrix {name} of {columns} columns does not end; is the file cut off?"
    raise FEFileFault(message, id="FE-049")


def _check(layout: _Layout, name: str, columns: int, rows: int, kind: int) -> None:
    if kind not in REAL:
        what = "is complex" if kind in _COMPLEX else f"has type {kind}"
        raise FEFileFault(f"{layout.file}: matrix {name} {what}; a real one wanted, type 1 or 2", id="FE-050")
    if abs(rows) != columns or columns < 1:
        message = f"matrix {name} must be square; it has {abs(rows)} rows, {columns} columns"
        raise FEFileFault(f"{layout.file}: {message}", id="FE-051")


def _column(
    layout: _Layout, record: memoryview, head: tuple[int, int, int], big: bool, value: np.dtype
) -> Iterator[tuple[int, int, np.ndarray]]:
    """The strings of a column: one when it has a first row, else each with its own."""
    column, row, words = head
    at, end = 3, 3 + words
    while at < end:
        if row:
            first, length = row, words
        elif big:
            length, first = layout.integers(record, at, 2)
            at, length = at + 2, length - 1
        else:
            (packed,) = layout.integers(record, at, 1)
            at, length, first = at + 1, packed // PACKED - 1, packed % PACKED
        if length < 1 or at + length > end:
            raise FEFileFault(f"{layout.file}: column {column} has a string of {length} words", id="FE-052")
        values = np.frombuffer(record, value, length * layout.word // value.itemsize, at * layout.word)
        yield first - 1, column - 1, values
        at += length
