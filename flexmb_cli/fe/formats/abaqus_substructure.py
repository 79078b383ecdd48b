"""Matrices of *SUBSTRUCTURE MATRIX OUTPUT: a *USER ELEMENT with its nodes and directions, then *MATRIX cards.

Abaqus Keywords Reference Guide, *USER ELEMENT, LINEAR and *MATRIX: the lower triangle row by row, a row on as
many lines as it needs; the whole matrix if it is unsymmetric.  The nodes stand in a comment.
"""

import re
from collections.abc import Sequence

import numpy as np

from .file_text import line_fault, real
from .matrix_file import FEFileFault, MatrixFile, check_labels

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
