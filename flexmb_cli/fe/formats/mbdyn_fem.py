"""Modal bodies of MBDyn (.fem): nodes, mode shapes, modal mass and stiffness, masses of the nodes.

MBDyn Input File Format, "Modal joint", FEM file: record groups, each with a heading `** RECORD GROUP n,` and
numbers separated by blanks; a line of a star begins each shape in group 8.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ...model.diagnostics import LARGEST_NUMBER
from .file_text import Line, integer, lines_of, real
from .matrix_file import MODAL, FEFileFault, MatrixFile
from .node_table import Node

_HEADING = re.compile(r"\*\*\s*RECORD GROUP\s+(\d{1,2})\s*(,.*)?", re.IGNORECASE)
_NODES, _SHAPES, _MASS, _STIFFNESS, _LUMPS, _RIGID = 2, 8, 9, 10, 11, 12
_POSITIONS = (5, 6, 7)
_NAMES = {2: "node numbers", 5: "x", 6: "y", 7: "z", 8: "shapes", 9: "modal mass", 10: "modal stiffness"}


@dataclass(frozen=True)
class ModalFile:
    """Content of a .fem file of n nodes and N modes; SI units, axes of the file.

    `nodal_masses`: masses along and inertias about three axes of each node; `rigid`: mass, centre and
    inertia of the undeformed body (13,), empty where the file has none.
    """

    numbers: np.ndarray  # (n,)
    positions: np.ndarray  # (n, 3)
    shapes: np.ndarray  # (N, n, 6) displacements and rotations
    mass: np.ndarray  # (N, N)
    stiffness: np.ndarray  # (N, N)
    nodal_masses: np.ndarray  # (n, 6)
    rigid: np.ndarray  # (13,) or (0,)


def read_modal_file(path: Path) -> ModalFile:
    """Return the content of the .fem file at `path`.  Raises FEFileFault."""
    groups = _groups(path)
    n, N = _sizes(path, groups)
    for number, name in _NAMES.items():
        if number not in groups:
            raise FEFileFault(f"{path.name} has no record group {number}, {name}", id="FE-280")
    if _LUMPS not in groups:
        message = "has no record group 11, the masses of the nodes, from which the inertia of a deformed body"
        raise FEFileFault(f"{path.name} {message} follows; write it, too", id="FE-281")
    for group in (3, 4):
        if group in groups and any(_numbers(path, groups, group, N)):
            message = f"the modes of record group {group} start deformed or in motion; write zeros there"
            raise groups[group][0].fault(f"{message}: bodies start undeformed", id="FE-301")
    return ModalFile(
        np.array(_numbers(path, groups, _NODES, n, whole=True), dtype=np.int64),
        np.column_stack([_numbers(path, groups, group, n) for group in _POSITIONS]),
        np.reshape(_numbers(path, groups, _SHAPES, 6 * n * N), (N, n, 6)),
        np.reshape(_numbers(path, groups, _MASS, N * N), (N, N)),
        np.reshape(_numbers(path, groups, _STIFFNESS, N * N), (N, N)),
        np.reshape(_numbers(path, groups, _LUMPS, 6 * n), (n, 6)),
        np.array(_numbers(path, groups, _RIGID, 13) if _RIGID in groups else [], dtype=float),
    )


def modal_nodes(path: Path) -> Iterator[Node]:
    """Yield number, position and line of every node.  Raises FEFileFault."""
    groups = _groups(path)
    file = read_modal_file(path)
    for number, position in zip(file.numbers.tolist(), file.positions, strict=True):
        yield number, position, groups[_NODES][0]


def read_modal_matrix(path: Path, letter: str, _wanted: str = "") -> MatrixFile:
    """Return the modal mass or stiffness (`letter` M, K), its rows numbered as modes.  Raises FEFileFault."""
    file = read_modal_file(path)
    if letter not in "MK":
        raise FEFileFault(f"{path.name}: a .fem file has modal masses and stiffnesses only", id="FE-282")
    matrix = file.mass if letter == "M" else file.stiffness
    rows, columns = np.indices(matrix.shape).reshape(2, -1)
    equations = np.column_stack([np.arange(1, len(matrix) + 1), np.full(len(matrix), MODAL)])
    return MatrixFile(len(matrix), rows, columns, matrix.ravel(), False, equations)


def _groups(path: Path) -> dict[int, list[Line]]:
    """Return the lines of each record group without comments, its heading first.  Raises FEFileFault."""
    groups: dict[int, list[Line]] = {}
    current: list[Line] | None = None
    for number, text in enumerate(lines_of(path), start=1):
        line = Line(path.name, number, text)
        if heading := _HEADING.match(text.strip()):
            if int(heading[1]) in groups:
                raise line.fault(f"record group {heading[1]} stands twice", id="FE-283")
            current = groups[int(heading[1])] = [line]
        elif current is not None and text.strip() and not text.lstrip().startswith("**"):
            current.append(line)
    if 1 not in groups:
        message = "has no line ** RECORD GROUP 1, : is it a .fem file of MBDyn?"
        raise FEFileFault(f"{path.name} {message}", id="FE-284")
    return groups


def _sizes(path: Path, groups: dict[int, list[Line]]) -> tuple[int, int]:
    """Return the numbers of nodes and of modes."""
    lines = groups[1]
    words = " ".join(line.text for line in lines[1:]).split()[1:]  # after the revision
    try:
        nodes, normal, attachment, constraint, rejected = (integer(word) for word in words[:5])
    except ValueError:
        message = "expected a revision and the numbers of nodes and of four types of modes"
        raise lines[0].fault(message, id="FE-285") from None
    if rejected:
        raise lines[0].fault("rejected modes are not read; write the file without them", id="FE-286")
    modes = normal + attachment + constraint
    # Each takes a number somewhere in the file.
    if min(nodes, modes) < 1 or nodes * modes > sum(len(line.text) for line in groups.get(_SHAPES, [])):
        message = f"{nodes} nodes and {modes} modes are more than group 8 holds, or none"
        raise lines[0].fault(message, id="FE-287")
    return nodes, modes


def _numbers(
    path: Path, groups: dict[int, list[Line]], group: int, count: int, whole: bool = False
) -> list[float]:
    """Return the `count` numbers of a record group."""
    values: list[float] = []
    for line in groups[group][1:]:
        try:
            values += [integer(word) if whole else real(word) for word in line.text.split()]
        except ValueError:
            raise line.fault(f"expected numbers; read '{line.text.strip()[:40]}'", id="FE-288") from None
    if len(values) != count:
        message = f"record group {group} holds {len(values)} numbers; expected {count}"
        raise groups[group][0].fault(message, id="FE-289")
    if not all(abs(value) < LARGEST_NUMBER for value in values):
        message = f"record group {group} holds a number that is not finite, or above {LARGEST_NUMBER:g}"
        raise groups[group][0].fault(message, id="FE-331")
    return values
