"""Nastran matrices as OP4 (module OUTPUT4): dense, sparse and BIGMAT; rows follow the node table.

Binary files are read by `nastran_op4_binary`.  In text every line with a point holds
values; a line of integers only heads a column, or a string of values in it.
"""

from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from .file_text import bytes_of, integer, is_binary, line_fault, lines_of, real
from .matrix_choice import NamedMatrix, chosen
from .matrix_file import FEFileFault, MatrixFile, of_strings
from .nastran_op4_binary import PACKED, REAL, binary_matrices


def read_op4(path: Path, letter: str, wanted: str = "") -> MatrixFile:
    """The matrix `wanted` at `path`, or the one that `letter` (M K G) means.  Raises FEFileFault."""
    raw = bytes_of(path)
    found = binary_matrices(path.name, raw) if is_binary(raw) else _text_matrices(path)
    if not found:
        raise FEFileFault(f"{path.name} is empty", id="FE-044")
    return chosen(path.name, found, letter, wanted)


def _text_matrices(path: Path) -> list[NamedMatrix]:
    """The matrices by their headings; only what is chosen is read."""
    lines, found = lines_of(path), []
    at = _filled(lines, 0)
    while at < len(lines):
        columns, rows, kind, label, _ = _heading(path.name, lines, at)
        usable = abs(rows) == columns and kind in REAL
        found.append(NamedMatrix(label, usable, partial(_read_one, path.name, lines, at)))
        at = _filled(lines, _end(lines, at, columns))
    return found


def _filled(lines: list[str], at: int) -> int:
    """The number of the first line from `at` on that is not blank."""
    while at < len(lines) and not lines[at].strip():
        at += 1
    return at


def _end(lines: list[str], at: int, columns: int) -> int:
    """The line behind a matrix: a column behind the last one closes it, with a value of no meaning."""
    for number in range(at + 1, len(lines)):
        words = lines[number].split()
        if len(words) == 3 and words[0].isdecimal() and int(words[0][:16]) > columns:
            return _filled(lines, number + 1) + 1
    return len(lines)


def _read_one(name: str, lines: list[str], at: int) -> MatrixFile:
    columns, rows, kind, _, width = _heading(name, lines, at)
    if kind not in REAL:
        raise line_fault(name, at + 1, "the matrix is complex; real wanted", id="FE-124")
    if abs(rows) != columns:
        message = f"the matrix must be square; it has {abs(rows)} rows, {columns} columns"
        raise line_fault(name, at + 1, message, id="FE-111")
    parts: list[Any] = []
    while True:
        at = _filled(lines, at + 1)
        column, row, words = _column(name, lines, at)
        if column > columns:
            return of_strings(name, columns, parts)
        if row:
            first, at = at, _read_string(name, lines, at, (row, column, width), parts)
            _check_words(name, first, words, len(parts[-1][2]))
            continue
        while (at_next := _filled(lines, at + 1)) < len(lines):
            if len(lines[at_next].split()) > 2 or "." in lines[at_next]:
                break
            row = _string_row(name, lines, at_next)
            at = _read_string(name, lines, at_next, (row, column, width), parts)


def _heading(name: str, lines: list[str], at: int) -> tuple[int, int, int, str, int]:
    """Columns, rows, type and name of a matrix, and the width of a value."""
    head = lines[at]
    try:
        columns, rows, _, kind = (integer(head[8 * i : 8 * i + 8]) for i in range(4))
        return columns, rows, kind, head[32:40].strip().upper(), _width(head[40:])
    except ValueError:
        message = "columns, rows, form, type, name and format of an OP4 text matrix wanted"
        raise line_fault(name, at + 1, message, id="FE-123") from None


def _width(form: str) -> int:
    """Columns of a value in a format such as 1P,3E23.16; ValueError when there is none."""
    width = integer(form.upper().split("E")[-1].split(".")[0])
    if not 1 <= width <= 999:
        raise ValueError(form)
    return width


def _check_words(name: str, head: int, words: int, found: int) -> None:
    """Refuse a column of other values than its heading announces, each one word or two (double precision)."""
    if words not in (found, 2 * found):
        message = f"the column announces {words} words and holds {found} values; was it cut off, or edited?"
        raise line_fault(name, head + 1, message, id="FE-125")


def _column(name: str, lines: list[str], at: int) -> tuple[int, int, int]:
    """Number of a column, its first row, 0 when strings follow, and how many words it announces."""
    try:
        column, row, words = map(integer, lines[at].split())
    except (ValueError, IndexError):
        message = "column, first row and words wanted; was the file cut off?"
        raise line_fault(name, at + 1, message, id="FE-126") from None
    return column, row, words


def _string_row(name: str, lines: list[str], at: int) -> int:
    try:
        *length, row = map(integer, lines[at].split())
    except ValueError:
        raise line_fault(name, at + 1, "the heading of a string of values wanted", id="FE-127") from None
    return row if length else row % PACKED


def _read_string(
    name: str,
    lines: list[str],
    at: int,
    layout: tuple[int, int, int],
    parts: list[tuple[int, int, np.ndarray]],
) -> int:
    """Values of one string; the number of its last line."""
    row, column, width = layout
    values = []
    while (at_next := _filled(lines, at + 1)) < len(lines) and "." in lines[at_next]:
        at = at_next
        line = lines[at].rstrip()
        for first in range(0, len(line), width):
            cell = line[first : first + width]
            try:
                values.append(real(cell))
            except ValueError:
                message = f"a value wanted; read '{cell.strip()[:40]}'"
                raise line_fault(name, at + 1, message, id="FE-128") from None
    parts.append((row - 1, column - 1, np.array(values)))
    return at
