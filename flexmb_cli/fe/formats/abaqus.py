"""Abaqus matrices (*MATRIX OUTPUT): FORMAT=MATRIX INPUT, by node and direction, and FORMAT=COORDINATE; those
of substructures (*SUBSTRUCTURE MATRIX OUTPUT) in abaqus_substructure.py.

Abaqus Analysis User's Guide, "Generating matrices"; coordinates come with blanks or commas.  The suffix .mtx
is also Matrix Market's: the deck names the format.  Nodes with negative labels are internal degrees of
freedom of elements.
"""

from functools import partial
from itertools import pairwise
from pathlib import Path

import numpy as np

from .abaqus_substructure import UserElement, element_matrix, user_element
from .file_text import filled, line_fault, lines_of, table, whole
from .matrix_choice import NamedMatrix, chosen
from .matrix_file import FEFileFault, MatrixFile, has_both_triangles, labelled

# Abaqus puts 1e36 on the diagonal where a degree of freedom is held.
LARGEST_STIFFNESS = 1e30
# Keywords that head a matrix, and their parameters.
_WORDS, _READ = ("*MATRIX", "*MATRIX INPUT"), ("NAME", "TYPE")


def read_abaqus(path: Path, letter: str = "K", wanted: str = "") -> MatrixFile:
    """The matrix `wanted` at `path`, or the one that `letter` (M K G) means.  Raises FEFileFault."""
    name, lines = path.name, lines_of(path)
    if lines and lines[0].lower().startswith("%%matrixmarket"):
        raise line_fault(name, 1, "this is a Matrix Market file: the format is MM", id="FE-087")
    sections, element = _sections(name, lines)
    matrices = [
        NamedMatrix(label, True, partial(_read_one, name, element, *filled(body, comment="*", before=before)))
        for label, before, body in sections
        if label or filled(body, comment="*")[0]
    ]
    if not matrices:
        raise FEFileFault(f"{name} holds no entries", id="FE-013")
    return chosen(name, matrices, letter, wanted)


def _sections(name: str, lines: list[str]) -> tuple[list[tuple[str, int, list[str]]], UserElement | None]:
    """Name, lines before and lines of every matrix; the element whose nodes and directions their rows are."""
    keywords = [i for i, line in enumerate(lines) if line.startswith("*") and line[1:2] not in ("*", "")]
    sections, element = [("", 0, lines[: keywords[0]] if keywords else lines)], None
    for i, end in pairwise([*keywords, len(lines)]):
        word, *parameters = [part.strip() for part in lines[i].upper().rstrip(", ").split(",")]
        values = {key.strip(): value.strip() for key, _, value in (part.partition("=") for part in parameters)}
        if word == "*USER ELEMENT":
            element = user_element(name, i + 1, values, lines[i + 1 : end])
            continue
        unread = [key for key in values if key not in _READ] if word in _WORDS else [word]
        if unread:
            raise line_fault(name, i + 1, f"{unread[0]} is not read; export the matrices without it")
        sections.append((values.get("NAME") or values.get("TYPE") or word[1:], i + 1, lines[i + 1 : end]))
    return sections, element


def _read_one(name: str, element: UserElement | None, body: list[str], numbers: list[int]) -> MatrixFile:
    if element is not None:
        return element_matrix(name, element, body, numbers)
    if not body:
        raise FEFileFault(f"{name} holds no entries", id="FE-013")
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


def _by_rows(_name: str, where: np.ndarray, values: np.ndarray) -> MatrixFile:
    rows, columns = where.T - 1
    size = int(where.max())
    return MatrixFile(size, rows, columns, values, not has_both_triangles(rows, columns, size))


def _by_nodes(name: str, where: np.ndarray, values: np.ndarray) -> MatrixFile:
    turning = (where[:, 1::2] > 3).any(axis=1)
    if (values[turning] != 0.0).any():
        node = where[turning, 0][0]
        raise FEFileFault(
            f"{name}: node {node} has rotations (direction 4 to 6); mesh with solid elements", id="FE-014"
        )
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
