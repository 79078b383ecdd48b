"""Matrix storage of CalculiX (*FREQUENCY, SOLVER=MATRIXSTORAGE): .sti, .mas and .dof.

Dhondt, CalculiX CrunchiX manual, *FREQUENCY; layout as version 2.20 writes it: one triangle with zeros,
and a line `node.direction` for every equation, which is text and no decimal fraction.
"""

import re
from pathlib import Path

import numpy as np

from .file_text import check_range, filled, line_fault, lines_of, table, whole
from .matrix_file import FEFileFault, MatrixFile, check_labels

_DOF = re.compile(r"\s*(\d{1,15})\.(\d)\s*", re.ASCII)


def read_calculix(path: Path) -> MatrixFile:
    """The matrix at `path`.  Raises FEFileFault."""
    lines, numbers = filled(lines_of(path))
    if not lines:
        raise FEFileFault(f"{path.name} is empty", id="FE-016")
    entries = table(path.name, lines, numbers, 3, "row, column and value")
    where = whole(path.name, entries[:, :2], numbers, "row and column")
    size = int(where.max())
    check_range(path.name, where, numbers, size)
    nonzero = entries[:, 2] != 0.0
    rows, columns = where[nonzero].T - 1
    one_triangle = not ((rows < columns).any() and (rows > columns).any())
    return MatrixFile(size, rows, columns, entries[nonzero, 2], one_triangle)


def read_dofs(path: Path) -> np.ndarray:
    """Node and direction (1 2 3) of every equation, (size, 2), from a .dof file."""
    pairs = []
    for number, line in enumerate(lines_of(path), start=1):
        if not line.strip():
            continue
        match = _DOF.fullmatch(line)
        if match is None:
            message = f"expected node.direction, such as 12.3; read '{line.strip()[:40]}'"
            raise line_fault(path.name, number, message, id="FE-095")
        if match[2] not in "123":
            message = f"direction {match[2]} of node {match[1]}: only 1, 2, 3 can be used, no rotations"
            raise line_fault(path.name, number, message, id="FE-096")
        pairs.append((int(match[1]), int(match[2])))
    if not pairs:
        raise FEFileFault(f"{path.name} is empty", id="FE-018")
    equations = np.array(pairs, dtype=np.int64)
    causes = ", as of shells and beams that CalculiX expanded into solids; mesh with solid elements"
    check_labels(path.name, equations, causes)
    return equations
