"""Abaqus matrices (*MATRIX OUTPUT): FORMAT=MATRIX INPUT, by node and direction, and FORMAT=COORDINATE; those
of substructures (*SUBSTRUCTURE MATRIX OUTPUT) in abaqus_substructure.py.

Abaqus Analysis User's Guide, "Generating matrices"; coordinates come with blanks or commas.  The suffix .mtx
is also Matrix Market's: the deck names the format.  Nodes with negative labels are internal degrees of
freedom of elements.  FORMAT=LABELS writes PART-1-1.7 for node 7 of an instance, the only one here.
"""

import re
from collections.abc import Iterator, Sequence
from functools import partial
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from .abaqus_input import keyword_of
from .abaqus_substructure import element_matrix, element_rows
from .file_text import filled, line_fault, lines_of, table, whole
from .matrix_file import FEFileFault, MatrixFile, NamedMatrix, chosen, has_both_triangles, labelled

# Abaqus puts 1e36 on the diagonal where a degree of freedom is held.
LARGEST_STIFFNESS = 1e30
_LABEL = re.compile(r"""(^|,)\s*(["']?[A-Za-z][^,]*?)\.(-?\d+)["']?\s*(?=,)""")
# Keywords of substructures and matrices, and their parameters.
_ELEMENT, _PARAMETERS = "USER ELEMENT", ("NODES", "LINEAR", "UNSYMM", "TYPE", "COORDINATES")
_READ = {_ELEMENT: _PARAMETERS, "MATRIX": ("TYPE",), "MATRIX INPUT": ("NAME", "TYPE")}


def read_abaqus(path: Path, letter: str = "K", wanted: str = "") -> MatrixFile:
    """The matrix `wanted` at `path`, or the one that `letter` (M K G) means.  Raises FEFileFault."""
    name, lines = path.name, lines_of(path)
    if lines and lines[0].lower().startswith("%%matrixmarket"):
        raise line_fault(name, 1, "this is a Matrix Market file: the format is MM", id="FE-087")
    matrices = [
        NamedMatrix(label, True, partial(_read_one, name, rows, body, numbers))
        for label, rows, (body, numbers) in _sections(name, lines)
        if body
    ]
    if not matrices:
        raise FEFileFault(f"{name} holds no entries", id="FE-013")
    return chosen(name, matrices, letter, wanted)


def _sections(name: str, lines: list[str]) -> Iterator[tuple[str, Any, tuple[Any, Any]]]:
    """Name, rows of a substructure, and filled lines with their numbers, of every matrix."""
    keywords = [i for i, line in enumerate(lines) if line[:1] == "*" and line[1:2] not in ("*", "")]
    yield "", None, filled(lines[: keywords[0]] if keywords else lines, comment="*")
    element = None
    for i, end in pairwise([*keywords, len(lines)]):
        word, values = keyword_of(lines[i])
        unread = [key for key in values if key not in _READ[word]] if word in _READ else [f"*{word}"]
        if unread:
            message = f"{unread[0]} is not read; export the matrices without it"
            raise line_fault(name, i + 1, message, id="FE-190")
        if word == _ELEMENT:
            element = element_rows(name, i + 1, values.get("NODES", ""), lines[i + 1 : end])
        else:
            body = filled(lines[i + 1 : end], comment="*", before=i + 1)
            yield values.get("NAME") or values.get("TYPE", ""), element, body


def _read_one(name: str, rows: np.ndarray | None, body: list[str], numbers: Sequence[int]) -> MatrixFile:
    if rows is not None:
        return element_matrix(name, rows, body, numbers)
    if _LABEL.match(body[0]):
        body = _without_instance(name, body, numbers)
    comma = "," in body[0]
    width = len(body[0].split("," if comma else None))
    if width not in (3, 5):
        message = (
            "row node, row direction, column node, column direction, value wanted, or row, column, value, "
            "by commas or blanks"
        )
        raise line_fault(name, numbers[0], message, id="FE-088")
    meaning = "row, column, value" if width == 3 else "row node, direction, column node, direction, value"
    entries = table(name, body, numbers, width, meaning, comma)
    where = whole(name, entries[:, :-1], numbers, "nodes and directions")
    # Rows, columns and directions count from 1; nodes of elements' own degrees of freedom are negative.
    wrong = np.flatnonzero((where[:, slice(None) if width == 3 else slice(1, None, 2)] < 1).any(axis=1))
    if wrong.size:
        raise line_fault(name, numbers[wrong[0]], "rows, columns and directions count from 1", id="FE-089")
    return (_by_rows if width == 3 else _by_nodes)(name, where, entries[:, -1])


def _without_instance(name: str, body: list[str], numbers: Sequence[int]) -> list[str]:
    """Return lines with the numbers of nodes alone, all of them of one instance."""
    instance = _LABEL.findall(body[0])[0][1]
    for number, line in zip(numbers, body, strict=True):
        if [found[1] for found in _LABEL.findall(line)] != 2 * [instance]:
            message = f"no two nodes of instance {instance}; write the matrices with FORMAT=MATRIX INPUT"
            raise line_fault(name, number, message, id="FE-183")
    return [_LABEL.sub(r"\1\3", line) for line in body]


def _by_rows(_name: str, where: np.ndarray, values: np.ndarray) -> MatrixFile:
    rows, columns = where.T - 1
    size = int(where.max())
    return MatrixFile(size, rows, columns, values, not has_both_triangles(rows, columns, size))


def _by_nodes(name: str, where: np.ndarray, values: np.ndarray) -> MatrixFile:
    turning = (where[:, 1::2] > 3).any(axis=1)
    if (values[turning] != 0.0).any():
        node = where[turning, 0][0]
        message = f"{name}: node {node} has rotations (direction 4 to 6); mesh with solid elements"
        raise FEFileFault(message, id="FE-014")
    where, values = where[~turning], values[~turning]
    held = np.flatnonzero(np.abs(values) > LARGEST_STIFFNESS)
    if held.size:
        node, direction = where[held[0], :2]
        raise FEFileFault(
            f"{name}: {values[held[0]]:.0e} at node {node}, direction {direction}, is a boundary condition; "
            "generate the matrices without *BOUNDARY",
            id="FE-015",
        )
    return labelled(where, values)
