"""Node tables: plain text, ANSYS NLIST and archives, Abaqus and CalculiX input, Nastran GRID cards."""

import math
import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ...quick_dataclass import dataclass
from .file_text import integer, line_fault, lines_of, real
from .matrix_file import FEFileFault

if TYPE_CHECKING:
    from collections.abc import Iterator


# Products of such lengths with masses and stiffnesses stay finite.
FARTHEST = 1e30  # m
_HEADING = re.compile(r"[^\d+\-.]")


@dataclass(frozen=True)
class NodeTable:
    """Numbers (n,) and positions (n, 3), m, of the nodes in the file's order."""

    numbers: np.ndarray
    positions: np.ndarray


def read_node_table(path: Path, form: str) -> NodeTable:
    """The node table at `path` in the format TXT, CDB, INP or BDF.  Raises FEFileFault."""
    readers = {"TXT": _plain_nodes, "CDB": _cdb_nodes, "INP": _inp_nodes, "BDF": _bdf_nodes}
    found = list(readers[form](path))
    if not found:
        raise FEFileFault(f"{path.name} holds no nodes in format {form}", id="FE-053")
    numbers = np.array([number for number, _, _ in found], dtype=np.int64)
    _check_twice(path.name, found, numbers)
    for node, position, line in found:
        if not all(map(math.isfinite, position)):
            raise line_fault(path.name, line, f"the position of node {node} is not finite", id="FE-129")
        if max(map(abs, position)) > FARTHEST:
            message = f"node {node} lies farther off than {FARTHEST:g} m; was a digit of an exponent lost?"
            raise line_fault(path.name, line, message, id="FE-130")
    return NodeTable(numbers, np.array([position for _, position, _ in found], dtype=float))


def _check_twice(name: str, found: list[tuple[int, list[float], int]], numbers: np.ndarray) -> None:
    values, counts = np.unique(numbers, return_counts=True)
    if (counts > 1).any():
        twice = int(values[counts > 1][0])
        lines = [str(line) for number, _, line in found if number == twice][:2]
        raise FEFileFault(f"{name}: node {twice} stands on lines {' and '.join(lines)}", id="FE-054")


def _plain_nodes(path: Path) -> "Iterator[tuple[int, list[float], int]]":
    """Lines `id x y z`; # and headings are passed over, as are rotated axes of NLIST when they are 0."""
    for number, line in enumerate(lines_of(path), start=1):
        words = line.split("#", 1)[0].split()
        if not words or _HEADING.match(words[0]):
            continue
        yield _node(path.name, number, words)


def _inp_nodes(path: Path) -> "Iterator[tuple[int, list[float], int]]":
    """Data lines of the *NODE cards; *NODE PRINT and *NODE FILE are other cards."""
    inside = False
    for number, line in enumerate(lines_of(path), start=1):
        if line.startswith("*"):
            if not line.startswith("**"):
                inside = line.split(",")[0].strip().upper() == "*NODE"
            continue
        if inside and line.strip():
            yield _node(path.name, number, [word.strip() for word in line.rstrip(" ,").split(",")])


def _node(name: str, number: int, words: list[str]) -> tuple[int, list[float], int]:
    """A node's number and position; trailing coordinates that are left out are 0."""
    try:
        node = integer(words[0])
        values = [real(word) for word in words[1:]]
    except ValueError:
        message = f"id x y z wanted; read '{' '.join(words)[:40]}'"
        raise line_fault(name, number, message, id="FE-131") from None
    if any(values[3:]):
        message = f"the axes of node {node} are rotated; matrices in rotated nodal axes cannot be used"
        raise line_fault(name, number, message, id="FE-093")
    position = (values + [0.0] * 3)[:3]
    return node, position, number


def _cdb_nodes(path: Path) -> Any:
    from .ansys_cdb import cdb_nodes

    return cdb_nodes(path)


def _bdf_nodes(path: Path) -> "Iterator[tuple[int, list[float], int]]":
    from .bulk_data import bulk_cards, integer_field, real_field

    for card in bulk_cards(path, ("GRID",)):
        node = integer_field(path, card, 0, "the number of the point")
        for index, what in ((1, "position"), (5, "displacement")):
            if integer_field(path, card, index, "a coordinate system", 0):
                message = f"GRID {node}: the {what} must be in basic coordinates"
                raise line_fault(path.name, card.line, message, id="FE-132")
        yield node, [real_field(path, card, i, "a coordinate") for i in (2, 3, 4)], card.line
