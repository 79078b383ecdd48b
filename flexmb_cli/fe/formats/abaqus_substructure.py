"""Matrices of *SUBSTRUCTURE MATRIX OUTPUT: a *USER ELEMENT with its nodes and directions, then *MATRIX cards.

Abaqus Keywords Reference Guide, *USER ELEMENT, LINEAR and *MATRIX: the lower triangle row by row, a row on as
many lines as it needs; with UNSYMM the whole matrix.  The nodes stand in a comment.
"""

import numpy as np

from ...quick_dataclass import dataclass
from .file_text import filled, integer, line_fault, real
from .matrix_file import FEFileFault, MatrixFile, check_labels

_NODES = "ELEMENT NODES"


@dataclass(frozen=True)
class UserElement:
    """Rows of the matrices: `equations` (size, 2), node and direction; None: x y z of the table's nodes."""

    size: int
    equations: np.ndarray | None
    unsymmetric: bool


def user_element(name: str, line: int, parameters: dict[str, str], body: list[str]) -> UserElement:
    """The element that *USER ELEMENT on `line` and the lines after it, `body`, describe."""
    unread = [key for key in parameters if key not in ("NODES", "LINEAR", "UNSYMM", "TYPE", "COORDINATES")]
    if unread:
        raise line_fault(name, line, f"{unread[0]} of *USER ELEMENT is not read")
    data, numbers = filled(body, comment="*", before=line)
    directions = [_integers(name, number, text) for text, number in zip(data, numbers, strict=True)]
    if directions != [[1, 2, 3]]:
        message = (
            "*USER ELEMENT must have directions 1, 2, 3 at all nodes alike, without rotations (4 to 6) and "
            f"retained modes; read {directions[:4]}"
        )
        raise line_fault(name, numbers[0] if numbers else line, message)
    nodes = _nodes(name, line, body)
    count = _integers(name, line, parameters.get("NODES") or str(len(nodes)))[0]
    if not nodes:
        return UserElement(3 * count, None, "UNSYMM" in parameters)
    if count != len(nodes):
        raise line_fault(name, line, f"*USER ELEMENT has {count} nodes, and its comment names {len(nodes)}")
    equations = np.column_stack([np.repeat(nodes, 3), np.tile([1, 2, 3], count)])
    check_labels(name, equations, "; each node of an element stands once")
    return UserElement(3 * count, equations, "UNSYMM" in parameters)


def _nodes(name: str, line: int, body: list[str]) -> list[int]:
    """The nodes in the comment lines after the one that announces them."""
    found: list[int] = []
    announced = False
    for number, text in enumerate(body, start=line + 1):
        if not text.startswith("**"):
            announced = False
        elif _NODES in text.upper():
            announced = True
        elif announced:
            found += _integers(name, number, text[2:])
    return found


def _integers(name: str, number: int, text: str) -> list[int]:
    try:
        return [integer(word) for word in text.strip().rstrip(",").split(",") if word.strip()]
    except ValueError:
        raise line_fault(name, number, f"whole numbers wanted; read '{text.strip()[:40]}'") from None


def element_matrix(name: str, element: UserElement, body: list[str], numbers: list[int]) -> MatrixFile:
    """The matrix whose triangle, or all of it, the lines `body` hold row by row."""
    values = []
    for text, number in zip(body, numbers, strict=True):
        try:
            values += [real(word) for word in text.split(",") if word.strip()]
        except ValueError:
            raise line_fault(name, number, f"values by commas wanted; read '{text.strip()[:40]}'") from None
    size = element.size
    count = size * size if element.unsymmetric else size * (size + 1) // 2
    if len(values) != count or not count:
        raise FEFileFault(
            f"{name}: a matrix of a *USER ELEMENT of {size // 3} nodes has {count} values; this one has "
            f"{len(values)}"
        )
    full = np.indices((size, size)).reshape(2, -1) if element.unsymmetric else np.tril_indices(size)
    return MatrixFile(size, *full, np.array(values), not element.unsymmetric, element.equations)
