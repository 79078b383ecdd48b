"""Node tables: plain text, ANSYS NLIST and archives, Abaqus and CalculiX input, Nastran GRID cards.

Programs give positions in rectangular, cylindrical and spherical coordinate systems.
"""

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from .file_text import Line, integer, lines_of, real
from .matrix_file import FEFileFault

# Products of such lengths with masses and stiffnesses stay finite.
FARTHEST = 1e30  # m
# "module:function" of this folder: number, position and line of every node; a run imports those it needs.
READERS = {
    "TXT": "node_table:plain_nodes",
    "CDB": "ansys_cdb:cdb_nodes",
    "INP": "abaqus_nodes:abaqus_nodes",
    "BDF": "nastran:grids",
    "FEM": "mbdyn_fem:modal_nodes",
}
_LISTED = re.compile(r"\bDSYS\s*=\s*([1-9]\d*)", re.IGNORECASE)
_HEADING = re.compile(r"[^\d+\-.]")


# Number, position, m, the line that gives it, and displacement axes (3, 3) in columns if they are turned.
Node = tuple[int, Any, Line] | tuple[int, Any, Line, Any]


@dataclass(frozen=True)
class NodeTable:
    """Numbers (n,) and positions (n, 3), m, of the nodes in the file's order.

    `axes` (n, 3, 3): displacement axes of the nodes, in columns, by which rows of matrices are; None where
    all are those of the table.
    """

    numbers: np.ndarray
    positions: np.ndarray
    axes: np.ndarray | None = None


def read_node_table(path: Path, form: str) -> NodeTable:
    """The node table at `path` in the format TXT, CDB, INP, BDF or FEM.  Raises FEFileFault."""
    module, name = READERS[form].split(":")
    reader = getattr(import_module(f"{__package__}.{module}"), name)
    with np.errstate(all="ignore"):  # what is not finite is refused below
        nodes = list(reader(path))
    if not nodes:
        raise FEFileFault(f"{path.name} holds no nodes in format {form}", id="FE-053")
    numbers = np.array([node[0] for node in nodes], dtype=np.int64)
    check_twice(path.name, "node", ((node[0], node[2]) for node in nodes))
    positions = np.array([node[1] for node in nodes], dtype=float)
    turned = any(len(node) > 3 for node in nodes)
    far = np.flatnonzero(~(np.abs(positions) <= FARTHEST).all(axis=1))
    if far.size:
        node, position, line = nodes[far[0]][:3]
        if not np.isfinite(position).all():
            raise line.fault(f"the position of node {node} is not finite", id="FE-129")
        message = f"node {node} lies farther off than {FARTHEST:g} m; was a digit of an exponent lost?"
        raise line.fault(message, id="FE-130")
    axes = np.array([node[3] if len(node) > 3 else np.eye(3) for node in nodes]) if turned else None
    return NodeTable(numbers, positions, axes)


def check_twice(name: str, what: str, lines: Iterable[tuple[int, Line]]) -> None:
    """Refuse nodes or elements (`what`) of the file `name` of which a number stands on two lines."""
    first: dict[int, Line] = {}
    for number, line in lines:
        if (other := first.setdefault(number, line)) is not line:
            where = (f"{one.number}{f' of {one.name}' * (one.name != name)}" for one in (other, line))
            raise FEFileFault(f"{name}: {what} {number} stands on lines {' and '.join(where)}", id="FE-054")


def plain_nodes(path: Path) -> Iterator[Node]:
    """Lines `id x y z`; # and headings are passed over, as are rotated axes of NLIST when they are 0."""
    for number, text in enumerate(lines_of(path), start=1):
        line = Line(path.name, number, text)
        if system := _LISTED.search(text):
            message = f"the list is in the coordinates of system {system[1]}; list the nodes after DSYS,0"
            raise line.fault(message, id="FE-166")
        words = text.split("#", 1)[0].split()
        if words and not _HEADING.match(words[0]):
            yield *node_of(line, words), line


def node_of(line: Line, words: list[str]) -> tuple[int, list[float]]:
    """Return the node that `words` give: its number, coordinates and rotations."""
    try:
        node, values = integer(words[0]), [real(word) for word in words[1:]]
    except ValueError:
        read = " ".join(words)[:40]
        comma = "; write decimals with points, and no commas" if "," in read else ""
        raise line.fault(f"expected id x y z; read '{read}'{comma}", id="FE-131") from None
    return placed(line, node, values)


def placed(line: Line, node: int, values: list[float]) -> tuple[int, list[float]]:
    """Return a node's number and position; trailing coordinates that are left out are 0."""
    if any(values[3:]):
        message = f"the axes of node {node} are rotated; matrices in rotated nodal axes cannot be used"
        raise line.fault(message, id="FE-093")
    return node, (values + [0.0] * 3)[:3]


# Sine of the least angle between two directions that span a system.
LEAST_SPAN = 1e-9


class CoordinateSystem(NamedTuple):
    """A system of coordinates x y z (R), R theta z (C) or R theta phi (S), theta from the z axis."""

    type: str  # R, C or S
    origin: Any  # (3,), m
    axes: Any  # (3, 3), x y z in columns

    def basic(self, values: Any) -> Any:
        """Return the position (3,), m, of the point at `values`, angles in degrees."""
        r, theta, last = values
        if self.type != "R":
            around = np.radians(theta if self.type == "C" else last)
            across = r if self.type == "C" else r * np.sin(np.radians(theta))
            height = last if self.type == "C" else r * np.cos(np.radians(theta))
            r, theta, last = across * np.cos(around), across * np.sin(around), height
        return self.origin + self.axes @ (r, theta, last)

    def axes_at(self, point: Any) -> Any:
        """Return the directions (3, 3) of the coordinates at `point` (3,), in columns.

        Those of a cylinder or a sphere are radial, then along theta; on its axis theta counts as 0.
        """
        x, y, z = self.axes.T @ (point - self.origin)
        across = np.hypot(x, y)
        around = np.arctan2(y, x) if across > LEAST_SPAN * abs(z) else 0.0
        turn = rotation(np.array([0.0, 0.0, 1.0]), np.degrees(around))
        if self.type == "S":  # r, theta from the z axis, phi
            r = np.hypot(across, z) or 1.0
            s, c = (across / r, z / r) if across or z else (1.0, 0.0)
            turn = turn @ np.array([[s, c, 0.0], [0.0, 0.0, 1.0], [c, -s, 0.0]])
        return self.axes if self.type == "R" else self.axes @ turn


BASIC = CoordinateSystem("R", np.zeros(3), np.eye(3))


def spanned(first: Any, second: Any) -> Any:
    """Return axes in columns: along `first` (3,), towards `second` (3,), across both; None on one line."""
    across = np.cross(first, second)
    size = np.linalg.norm(across)
    if not size > LEAST_SPAN * np.linalg.norm(first) * np.linalg.norm(second):
        return None
    a, c = first / np.linalg.norm(first), across / size
    return np.column_stack([a, np.cross(c, a), c])


def rotation(axis: Any, degrees: float) -> Any:
    """Return the matrix (3, 3) of a turn about `axis` (3,)."""
    axis, angle = axis / np.linalg.norm(axis), np.radians(degrees)
    crossed = np.cross(np.eye(3), axis)
    return np.eye(3) + np.sin(angle) * crossed + (1.0 - np.cos(angle)) * (crossed @ crossed)
