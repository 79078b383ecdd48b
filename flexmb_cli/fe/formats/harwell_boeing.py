"""Harwell-Boeing matrices as ANSYS HBMAT writes them, and the mapping file of their equations.

Duff, Grimes, Lewis, Users' Guide for the Harwell-Boeing Sparse Matrix Collection (1992); ANSYS
command HBMAT.  Fields are cut by the FORTRAN formats of line 4, as they may touch; where blanks part as many
numbers as the heading announces, these count: scipy.io.hb_write has other widths than its format line.
"""

import re
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from .file_text import filled, integer, line_fault, lines_of, real
from .matrix_file import FEFileFault, MatrixFile, check_labels, has_both_triangles
from .matrix_market import BANNER, read_node_vector

# Of (1P,4E20.12) or (8I10) only letter and width matter: cells are cut to the end of each line.
_FORMAT = re.compile(r"([IDEFG])([1-9]\d{0,2})(?!\d)", re.IGNORECASE)
_EQUATION = re.compile(r"\s*(\d{1,15})\s+(\d{1,15})\s+([A-Za-z]\w*)\s*", re.ASCII)
# Components 1 to 6 by their labels.
_LABELS = {
    f"{kind}{axis}": 1 + 3 * k + i for k, kind in enumerate(("U", "ROT")) for i, axis in enumerate("XYZ")
}


def read_harwell_boeing(path: Path) -> MatrixFile:
    """The matrix at `path`.  Raises FEFileFault."""
    name, lines = path.name, lines_of(path)
    # A title may be blank; further on a blank line is none of those that the heading counts.
    body, numbers = filled(lines[1:], before=1)
    lines, numbers = [*lines[:1], *body], [1, *numbers]
    if len(lines) < 4:
        raise FEFileFault(f"{name} ends before the fourth line of a Harwell-Boeing heading", id="FE-032")
    _, pointers, indices, values, right_sides = _integers(name, lines[1], 2, 0, 5)
    kind = lines[2][:3].upper()
    size, columns, count, _ = _integers(name, lines[2], 3, 14, 4)
    _check_kind(name, kind, size, columns)
    formats = [_format(name, lines[3], first, 16 if first < 32 else 20) for first in (0, 16, 32)]
    start = 5 if right_sides else 4
    sections = []
    for lengths, form, section in zip(
        (pointers, indices, values), formats, (size + 1, count, count), strict=True
    ):
        sections.append(_numbers(name, lines, numbers[start:], lengths, form, section))
        start += lengths
    pointers_, rows_, values_ = sections
    return _matrix(name, kind, size, pointers_, rows_, values_)


def read_mapping(path: Path) -> np.ndarray:
    """Node and component (1 to 6) of every equation, (size, 2), from a mapping file of HBMAT.

    Or from a vector of node numbers in Matrix Market format.
    """
    lines = lines_of(path)
    if lines and lines[0].lower().startswith(BANNER):
        return read_node_vector(path)
    labels = {}
    for number, line in enumerate(lines, start=1):
        match = _EQUATION.fullmatch(line)
        if match is None:
            continue
        label = match[3].upper()
        if label not in _LABELS:
            named = f"degree of freedom {label} of node {match[2]}"
            message = (
                f"{named}: only UX to ROTZ can be used. How mappings label modal coordinates of "
                "substructures is not published: condense without modes, or export the full model"
            )
            raise line_fault(path.name, number, message, id="FE-253")
        labels[int(match[1])] = int(match[2]), _LABELS[label]
    if not labels:
        message = f"{path.name} holds no line 'equation node UX|...|ROTZ'; is it the mapping file?"
        raise FEFileFault(message, id="FE-033")
    if sorted(labels) != list(range(1, len(labels) + 1)):
        gap = next(i for i in range(1, len(labels) + 1) if i not in labels)
        raise FEFileFault(f"{path.name} maps {len(labels)} equations, but not equation {gap}", id="FE-034")
    equations = np.array([labels[i] for i in range(1, len(labels) + 1)], dtype=np.int64)
    check_labels(path.name, equations, "; each has one equation")
    return equations


def _integers(name: str, line: str, number: int, first: int, count: int) -> list[int]:
    """`count` integers of 14 columns; blank ones are 0."""
    cells = [line[first + 14 * i : first + 14 * (i + 1)].strip() or "0" for i in range(count)]
    try:
        numbers_of_line = [integer(cell) for cell in cells]
    except ValueError:
        message = "expected integers of 14 columns; is it a Harwell-Boeing file?"
        raise line_fault(name, number, message, id="FE-108") from None
    if min(numbers_of_line) < 0:
        raise line_fault(name, number, "counts of lines and entries are not negative", id="FE-109")
    return numbers_of_line


def _check_kind(name: str, kind: str, size: int, columns: int) -> None:
    if kind not in ("RSA", "RUA"):
        message = f"the matrix is of type {kind}; expected RSA (symmetric) or RUA, assembled and real"
        raise line_fault(name, 3, message, id="FE-110")
    if size != columns:
        message = f"the matrix must be square; it has {size} rows, {columns} columns"
        raise line_fault(name, 3, message, id="FE-111")


def _format(name: str, line: str, first: int, width: int) -> tuple[str, int]:
    """Letter and width of the fields that a FORTRAN format prescribes."""
    match = _FORMAT.search(line[first : first + width])
    if match is None:
        message = f"no FORTRAN format in '{line[first : first + width].strip()}'"
        raise line_fault(name, 4, message, id="FE-112")
    return match[1].upper(), int(match[2])


def _numbers(
    name: str, lines: list[str], numbers: Sequence[int], count: int, form: tuple[str, int], total: int
) -> np.ndarray:
    """`total` numbers from `count` lines, separated by blanks or cut by the width of their format.

    `numbers`: of these and all later lines.
    """
    letter, width = form
    start = len(lines) - len(numbers)
    section = lines[start : start + count]
    if len(section) < count:
        message = f"{name} ends at line {len(lines)}, {count - len(section)} lines too early"
        raise FEFileFault(message, id="FE-036")
    read = integer if letter == "I" else real
    split = _split(section, read, total)
    return _cut(name, section, numbers, width, read, total) if split is None else split


def _split(section: list[str], read: Callable[..., Any], total: int) -> np.ndarray | None:
    """The numbers between blanks, None where they are not `total` ones."""
    words = " ".join(section).split()
    if len(words) != total:
        return None
    try:
        return np.array([read(word) for word in words])
    except ValueError:
        return None


def _cut(
    name: str, section: list[str], numbers: Sequence[int], width: int, read: Callable[..., Any], total: int
) -> np.ndarray:
    """The numbers in fields of `width` columns."""
    cells = [
        (line[i : i + width], number)
        for line, number in zip(section, numbers, strict=False)
        for i in range(0, len(line.rstrip()), width)
    ]
    if len(cells) < total:
        message = f"expected {total} numbers, read {len(cells)} in fields of {width} columns (line 4)"
        raise FEFileFault(f"{name}, lines {numbers[0]}-{numbers[len(section) - 1]}: {message}", id="FE-037")
    values = []
    for cell, number in cells[:total]:
        try:
            values.append(read(cell))
        except ValueError:
            message = (
                f"'{cell.strip()}' is not a number; fields are {width} columns wide by the format of line 4: "
                "are they wider or narrower here?"
            )
            raise line_fault(name, number, message, id="FE-113") from None
    return np.array(values)


def _matrix(
    name: str, kind: str, size: int, pointers: np.ndarray, rows: np.ndarray, values: np.ndarray
) -> MatrixFile:
    """ANSYS 9 declared RSA and wrote full columns with wrong pointers: those are not mirrored."""
    full = len(values) == size * size
    if full:
        columns = np.repeat(np.arange(size), size)
    else:
        lengths = np.diff(pointers)
        if pointers[0] != 1 or (lengths < 0).any() or lengths.sum() != len(values):
            message = f"{name}: the column pointers do not add up to {len(values)} entries"
            raise FEFileFault(message, id="FE-038")
        columns = np.repeat(np.arange(size), lengths)
    rows = rows - 1
    if (rows < 0).any() or (rows >= size).any():
        raise FEFileFault(f"{name}: a row index lies outside 1..{size}", id="FE-039")
    one_triangle = kind == "RSA" and not full and not has_both_triangles(rows, columns, size)
    return MatrixFile(size, rows, columns, values, one_triangle)
