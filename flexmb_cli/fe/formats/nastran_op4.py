"""Nastran matrices as OP4 (module OUTPUT4): dense, sparse and BIGMAT; rows follow the node table.

MSC Nastran DMAP Programmer's Guide, OUTPUT4.  A heading of columns, rows, form, type and name begins a
matrix, a record for every column that is not zero follows, and one after the last column closes it.  Binary
files are Fortran records, of either byte order, with words of four or eight bytes.  In text every line with
a point holds values; a line of integers only heads a column, or a string of values in it.
"""

import struct
from collections.abc import Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from .file_text import bytes_of, filled, integer, is_binary, line_fault, lines_of, real
from .matrix_file import FEFileFault, MatrixFile, NamedMatrix, chosen, of_strings

_REAL, _COMPLEX = (1, 2), (3, 4)
# The first row of a string is packed with its length: row + 65536 (length + 1).
_PACKED = 65536
# Four integers and a name of two words.
_HEADING_WORDS = 6


def read_op4(path: Path, letter: str, title: str = "") -> MatrixFile:
    """The matrix `title` at `path`, or the one that `letter` (M K G) means.  Raises FEFileFault."""
    raw = bytes_of(path)
    matrices = _binary_matrices(path.name, raw) if is_binary(raw) else _text_matrices(path)
    if not matrices:
        raise FEFileFault(f"{path.name} is empty", id="FE-044")
    return chosen(path.name, matrices, letter, title)


class _Text(NamedTuple):
    """The lines of a text file that are not blank, with their numbers in it."""

    name: str  # of the file
    lines: list[str]  # that are not blank
    numbers: Sequence[int]  # of these lines in the file

    def fault(self, at: int, message: str, *, id: str) -> FEFileFault:
        """Return the fault of line `at`, or after the last one."""
        number = self.numbers[at] if at < len(self.lines) else self.numbers[-1] + 1
        return line_fault(self.name, number, message, id=id)

    def holds_values(self, at: int) -> bool:
        """Return whether line `at` is there and holds values."""
        return at < len(self.lines) and "." in self.lines[at]

    def integers(self, at: int, counts: tuple[int, ...], message: str, *, id: str) -> list[int]:
        """Return the integers of line `at`, as many as one of `counts`.  Raises FEFileFault."""
        try:
            numbers = [integer(word) for word in self.lines[at].split()]
        except (ValueError, IndexError):
            numbers = []
        if len(numbers) not in counts:
            raise self.fault(at, message, id=id)
        return numbers


def _text_matrices(path: Path) -> list[NamedMatrix]:
    """The matrices by their headings; only what is chosen is read."""
    text, matrices, at = _Text(path.name, *filled(lines_of(path))), [], 0
    while at < len(text.lines):
        columns, rows, kind, label, _ = _heading(text, at)
        usable = abs(rows) == columns and kind in _REAL
        matrices.append(NamedMatrix(label, usable, partial(_read_text, text, at)))
        at = _end(text.lines, at, columns)
    return matrices


def _end(lines: list[str], at: int, columns: int) -> int:
    """The line after a matrix: a column after the last one closes it, with a value of no meaning."""
    for number in range(at + 1, len(lines)):
        words = lines[number].split()
        if len(words) == 3 and words[0].isdecimal() and int(words[0][:16]) > columns:
            return number + 2
    return len(lines)


def _read_text(text: _Text, at: int) -> MatrixFile:
    columns, rows, kind, _, width = _heading(text, at)
    if kind not in _REAL:
        raise text.fault(at, "the matrix is complex; it must be real", id="FE-124")
    if abs(rows) != columns:
        message = f"the matrix must be square; it has {abs(rows)} rows, {columns} columns"
        raise text.fault(at, message, id="FE-111")
    strings: list[Any] = []
    at += 1
    while True:
        cut = "expected column, first row and words; was the file cut off?"
        head, (column, row, words) = at, text.integers(at, (3,), cut, id="FE-126")
        if column > columns:
            return of_strings(text.name, columns, strings)
        at += 1
        if row:
            values, at = _values(text, at, width)
            strings.append((row - 1, column - 1, values))
            if words not in (len(values), 2 * len(values)):  # one word each, or two (double precision)
                held = f"{words} words and holds {len(values)} values"
                message = f"the column announces {held}; was it cut off, or edited?"
                raise text.fault(head, message, id="FE-125")
            continue
        while at < len(text.lines) and len(text.lines[at].split()) <= 2 and not text.holds_values(at):
            *length, row = text.integers(at, (1, 2), "expected the head of a string of values", id="FE-127")
            values, at = _values(text, at + 1, width)
            strings.append(((row if length else row % _PACKED) - 1, column - 1, values))


def _heading(text: _Text, at: int) -> tuple[int, int, int, str, int]:
    """Columns, rows, type and name of a matrix, and the columns of a value in a format such as 1P,3E23.16."""
    head = text.lines[at]
    try:
        columns, rows, _, kind = (integer(head[8 * i : 8 * i + 8]) for i in range(4))
        width = integer(head[40:].upper().split("E")[-1].split(".")[0])
    except ValueError:
        width = 0
    if not 1 <= width <= 999:
        message = "expected columns, rows, form, type, name and format of an OP4 text matrix"
        raise text.fault(at, message, id="FE-123")
    return columns, rows, kind, head[32:40].strip().upper(), width


def _values(text: _Text, at: int, width: int) -> tuple[np.ndarray, int]:
    """Values of one string, which begins at line `at`, and the line after it."""
    values = []
    while text.holds_values(at):
        line = text.lines[at].rstrip()
        for first in range(0, len(line), width):
            cell = line[first : first + width]
            try:
                values.append(real(cell))
            except ValueError:
                raise text.fault(at, f"expected a value; read '{cell.strip()[:40]}'", id="FE-128") from None
        at += 1
    return np.array(values), at


class _Layout(NamedTuple):
    """Order of bytes and widths of words of a binary file."""

    file: str  # its name
    order: str  # of bytes, "<" or ">"
    word: int  # bytes

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


def _binary_matrices(file: str, raw: bytes) -> list[NamedMatrix]:
    """The matrices of the file `file`; only what is chosen is read.  Raises FEFileFault."""
    layout = _layout(file, raw)
    records, matrices = _records(layout, memoryview(raw)), []
    for heading in records:
        columns, rows, _, kind = shape = layout.integers(heading, 0, 4)
        name = bytes(heading[4 * layout.word : _HEADING_WORDS * layout.word]).decode("latin-1")
        name = name.strip().upper()
        strings = list(_columns(layout, columns, records))
        usable = kind in _REAL and abs(rows) == columns
        matrices.append(NamedMatrix(name, usable, partial(_read_binary, layout, name, shape, strings)))
    return matrices


def _layout(file: str, raw: bytes) -> _Layout:
    """Recognised by the length of the first record."""
    for order in "<>":
        length = struct.unpack(f"{order}i", raw[:4])[0] if len(raw) >= 4 else 0
        if length in (4 * _HEADING_WORDS, 8 * _HEADING_WORDS):
            return _Layout(file, order, length // _HEADING_WORDS)
    raise FEFileFault(
        f"{file} is a binary file, but not an OP4: its first record is not of 24 or 48 bytes (an OP2? write "
        "OP4 by OUTPUT4, binary or as text)",
        id="FE-046",
    )


def _records(layout: _Layout, raw: memoryview) -> Iterator[memoryview]:
    """Records between their lengths, which stand before and after."""
    at = 0
    while at < len(raw):
        length = struct.unpack_from(f"{layout.order}i", raw, at)[0] if at + 4 <= len(raw) else -1
        end = at + 4 + length
        if length < 0 or raw[end : end + 4] != raw[at : at + 4]:
            message = f"the record at byte {at} does not end where its length says; was the file cut off?"
            raise FEFileFault(f"{layout.file}: {message}", id="FE-047")
        yield raw[at + 4 : end]
        at = end + 4


def _columns(layout: _Layout, columns: int, records: Iterator[memoryview]) -> Iterator[memoryview]:
    """The records of a matrix: of its columns, and the one of a column after the last that closes it."""
    for record in records:
        yield record
        if layout.integers(record, 0, 1)[0] > columns:
            return


def _read_binary(
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
    if kind not in _REAL:
        what = "is complex" if kind in _COMPLEX else f"has type {kind}"
        raise FEFileFault(f"{layout.file}: matrix {name} {what}; it must be real, type 1 or 2", id="FE-050")
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
            at, length, first = at + 1, packed // _PACKED - 1, packed % _PACKED
        if length < 1 or at + length > end:
            raise FEFileFault(f"{layout.file}: column {column} has a string of {length} words", id="FE-052")
        values = np.frombuffer(record, value, length * layout.word // value.itemsize, at * layout.word)
        yield first - 1, column - 1, values
        at += length
