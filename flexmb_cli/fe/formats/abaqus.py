"""Abaqus matrices (*MATRIX OUTPUT): FORMAT=MATRIX INPUT, by node and direction, and FORMAT=COORDINATE.

Abaqus Analysis User's Guide, "Generating matrices"; coordinates come with blanks or commas.  The suffix .mtx
is also Matrix Market's: the deck names the format.  Nodes with negative labels are internal degrees of
freedom of elements.  FORMAT=LABELS writes PART-1-1.7 for node 7 of an instance, the only one here.

Matrices of *SUBSTRUCTURE MATRIX OUTPUT: a *USER ELEMENT with its nodes and directions, then *MATRIX cards.
Abaqus Keywords Reference Guide, *USER ELEMENT, LINEAR and *MATRIX: the lower triangle row by row, a row on as
many lines as it needs; the whole matrix if it is unsymmetric.  The nodes stand in a comment.
"""

import re
from collections.abc import Iterator, Sequence
from functools import partial
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from .abaqus_input import keyword_of
from .file_text import filled, line_fault, lines_of, real, table, whole
from .matrix_file import (
    FEFileFault,
    MatrixFile,
    NamedMatrix,
    check_labels,
    chosen,
    has_both_triangles,
    labelled,
)

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


_NODES = re.compile(r"ELEMENT NODES[^\n]*((?:\n\*\*[ \d,]*)+)", re.IGNORECASE | re.ASCII)


def element_rows(name: str, line: int, count: str, body: list[str]) -> np.ndarray:
    """Node and direction of the rows (size, 2) of the *USER ELEMENT on `line` with `count` nodes."""
    data = [re.findall(r"\w+", text) for text in body if text.strip() and text[0] != "*"]
    if data != [["1", "2", "3"]]:
        message = (
            "*USER ELEMENT must have directions 1, 2, 3 at all nodes alike, without rotations (4 to 6) and "
            f"retained modes; read {data[:4]}"
        )
        raise line_fault(name, line, message, id="FE-191")
    match = _NODES.search("\n".join(body))
    nodes = [int(node) for node in re.findall(r"\d{1,15}", match[1])] if match else []
    if not nodes or count not in ("", str(len(nodes))):
        message = f"*USER ELEMENT has {count} nodes, and its comment 'ELEMENT NODES' names {len(nodes)}"
        raise line_fault(name, line, message, id="FE-192")
    rows = np.column_stack([np.repeat(nodes, 3), np.tile([1, 2, 3], len(nodes))])
    check_labels(name, rows, "; each node of an element stands once")
    return rows


def element_matrix(name: str, equations: np.ndarray, body: list[str], numbers: Sequence[int]) -> MatrixFile:
    """The matrix whose lower triangle, or all of it, the lines `body` hold row by row."""
    values, size = [], len(equations)
    for text, number in zip(body, numbers, strict=True):
        try:
            values += [real(word) for word in text.split(",") if word.strip()]
        except ValueError:
            message = f"values by commas wanted; read '{text.strip()[:40]}'"
            raise line_fault(name, number, message, id="FE-193") from None
    triangle = size * (size + 1) // 2
    if len(values) not in (triangle, size * size):
        raise FEFileFault(
            f"{name}: a matrix of a *USER ELEMENT of {size // 3} nodes has {triangle} values; this one has "
            f"{len(values)}",
            id="FE-194",
        )
    half = len(values) == triangle
    rows, columns = np.tril_indices(size) if half else np.indices((size, size)).reshape(2, -1)
    return MatrixFile(size, rows, columns, np.array(values), half, equations)
