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


def read_abaqus(path: Path, letter: str = "K", title: str = "") -> MatrixFile:
    """The matrix `title` at `path`, or the one that `letter` (M K G) means.  Raises FEFileFault."""
    name, lines = path.name, lines_of(path)
    if lines and lines[0].lower().startswith("%%matrixmarket"):
        raise line_fault(name, 1, "this is a Matrix Market file: the format is MM", id="FE-087")
    sections = [section for section in _sections(name, lines) if section[2][0]]
    if not sections:
        raise FEFileFault(f"{name} holds no entries", id="FE-013")
    if letter == "M" and all(rows is not None and label == "STIFFNESS" for label, rows, _ in sections):
        message = "holds a stiffness only; *SUBSTRUCTURE MATRIX OUTPUT of Abaqus adds the mass by MASS=YES"
        remedy = "that of CalculiX cannot: let *FREQUENCY, SOLVER=MATRIXSTORAGE write both"
        raise FEFileFault(f"{name} {message}, {remedy}", id="FE-256")
    matrices = [
        NamedMatrix(label, True, partial(_read_one, name, rows, body, numbers))
        for label, rows, (body, numbers) in sections
    ]
    return chosen(name, matrices, letter, title)


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
            "expected row node, row direction, column node, column direction, value, or row, column, value, "
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
        if [label[1] for label in _LABEL.findall(line)] != 2 * [instance]:
            message = f"no two nodes of instance {instance}; write the matrices with FORMAT=MATRIX INPUT"
            raise line_fault(name, number, message, id="FE-183")
    return [_LABEL.sub(r"\1\3", line) for line in body]


def _by_rows(_name: str, where: np.ndarray, values: np.ndarray) -> MatrixFile:
    rows, columns = where.T - 1
    size = int(where.max())
    return MatrixFile(size, rows, columns, values, not has_both_triangles(rows, columns, size))


def _by_nodes(name: str, where: np.ndarray, values: np.ndarray) -> MatrixFile:
    others = (where[:, 1::2] > 6).any(axis=1)
    if (values[others] != 0.0).any():
        node, direction = where[others][0, :2] if where[others][0, 1] > 6 else where[others][0, 2:]
        message = f"direction {direction} of node {node} is neither a translation nor a rotation"
        raise FEFileFault(f"{name}: {message} (1 to 6): export a mechanical model", id="FE-252")
    where, values = where[~others], values[~others]
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
    """Node and direction of the rows (size, 2) of the *USER ELEMENT on `line` with `count` nodes.

    The first line of data has the directions of the first node, each of the others a position among the
    nodes and the directions of that node and those after it.  CalculiX names a node once for every row.
    """
    directions = _directions(name, line, body)
    match = _NODES.search("\n".join(body))
    nodes = [int(node) for node in re.findall(r"\d{1,15}", match[1])] if match else []
    if not nodes or count not in ("", str(len(nodes))):
        message = f"*USER ELEMENT has {count} nodes, and its comment 'ELEMENT NODES' names {len(nodes)}"
        raise line_fault(name, line, message, id="FE-192")
    rows: list[tuple[int, int]] = []
    current = directions[1]
    for position, node in enumerate(nodes, start=1):
        current = directions.get(position, current)
        rows += [(node, direction) for direction in current]
    equations = np.array(rows, dtype=np.int64)
    check_labels(name, equations, "; each node and direction of an element stands once")
    return equations


def _directions(name: str, line: int, body: list[str]) -> dict[int, list[int]]:
    """Return the directions from a position among the nodes on, by that position."""
    data = [re.findall(r"[^\s,]+", text) for text in body if text.strip() and text[0] != "*"]
    lines = [["1", *data[0]], *data[1:]] if data else []
    if (
        not lines
        or not all(word.isdecimal() and len(word) < 16 for words in lines for word in words)
        or not all(set(words[1:]) and set(words[1:]) <= set("123456") for words in lines)
    ):
        message = f"*USER ELEMENT must have directions 1 to 6, of mechanics; read {data[:4]}"
        raise line_fault(name, line, message, id="FE-191")
    return {int(position): [int(word) for word in words] for position, *words in lines}


def element_matrix(name: str, equations: np.ndarray, body: list[str], numbers: Sequence[int]) -> MatrixFile:
    """The matrix whose lower triangle, or all of it, the lines `body` hold row by row."""
    values, size = [], len(equations)
    for text, number in zip(body, numbers, strict=True):
        try:
            values += [real(word) for word in text.split(",") if word.strip()]
        except ValueError:
            message = f"expected values separated by commas; read '{text.strip()[:40]}'"
            raise line_fault(name, number, message, id="FE-193") from None
    triangle = size * (size + 1) // 2
    if len(values) not in (triangle, size * size):
        raise FEFileFault(
            f"{name}: the {size} directions of *USER ELEMENT make a matrix of {triangle} values; this one "
            f"has {len(values)}. How this file labels retained modes is not published: generate the "
            "substructure without *SELECT EIGENMODES",
            id="FE-194",
        )
    half = len(values) == triangle
    rows, columns = np.tril_indices(size) if half else np.indices((size, size)).reshape(2, -1)
    return MatrixFile(size, rows, columns, np.array(values), half, equations)
