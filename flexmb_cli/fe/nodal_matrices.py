"""M and K in the order of the node table, x y z node by node, internal degrees of freedom of elements
eliminated.

Elements with incompatible modes may bring degrees of freedom of pseudo-nodes that no node table has.  They
are condensed statically in K, and dropped in M: condensing M as well (Guyan) would couple directions, so that
S^ij = m_ij E no longer held, of which the equations of motion make use.
"""

from collections.abc import Callable

import numpy as np

from ..quick_dataclass import dataclass
from .formats.matrix_file import FEFileFault, MatrixFile, size_hint
from .linear_algebra import Matrix, Singular, condensed_on, solver, stored, summed, without_diagonal

SYMMETRY = 1e-6


@dataclass(frozen=True)
class NodalMatrix:
    """A symmetric matrix (3 n, 3 n) in the order of the node table, made of `file`.

    `nodal` (3 n,) and `internal`: the rows of the file that are those of the nodes, and those condensed or
    dropped; `following` (internal, 3 n): how these move with the nodes, None where they rest.
    """

    matrix: Matrix
    file: MatrixFile
    nodal: np.ndarray
    internal: np.ndarray
    following: Callable[[np.ndarray], np.ndarray] | None = None

    def extended(self, shapes: np.ndarray) -> np.ndarray:
        """Return the displacements (size, k) of all rows of the file for those of the nodes, (3 n, k)."""
        full = np.zeros((self.file.size, shapes.shape[1]))
        full[self.nodal] = shapes
        if self.following is not None:
            full[self.internal] = self.following(shapes)
        return full


def nodal_part(name: str, file: MatrixFile, numbers: np.ndarray) -> NodalMatrix:
    """The rows and columns of the nodes `numbers` (n,); internal ones are dropped.  Raises FEFileFault."""
    full, nodal, internal = _ordered(name, file, numbers)
    return NodalMatrix(stored(full[nodal][:, nodal]), file, nodal, internal)


def condensed(name: str, file: MatrixFile, numbers: np.ndarray) -> NodalMatrix:
    """The matrix of the nodes `numbers` (n,), internal degrees of freedom condensed.  Raises FEFileFault."""
    full, nodal, internal = _ordered(name, file, numbers)
    outer = full[nodal][:, nodal]
    if not len(internal):
        return NodalMatrix(stored(outer), file, nodal, internal)
    inner, coupling = full[internal][:, internal], full[internal][:, nodal]
    try:
        matrix, solve = stored(condensed_on(outer, coupling, inner)), solver(inner)
    except Singular:
        raise FEFileFault(
            f"{name}: the {len(internal)} internal degrees of freedom have no stiffness of their own",
            id="FE-061",
        ) from None
    return NodalMatrix(matrix, file, nodal, internal, lambda shapes: -solve(coupling @ shapes))


def _ordered(name: str, file: MatrixFile, numbers: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The full matrix, the rows of the nodes in the order of the table, and the internal rows."""
    _check_finite(name, file)
    full = _symmetric(name, file)
    size = 3 * len(numbers)
    if file.equations is None:
        if file.size != size:
            raise FEFileFault(
                f"{name} has {file.size} rows; the {len(numbers)} nodes of the table need {size}, three each"
                f"{size_hint(file.size, len(numbers))}",
                id="FE-062",
            )
        return full, np.arange(size), np.arange(0)
    return full, *_rows_of_nodes(name, file.equations, numbers)


def _check_finite(name: str, file: MatrixFile) -> None:
    if not len(file.values):
        raise FEFileFault(f"{name} holds no entries", id="FE-063")
    if not np.isfinite(file.values).all():
        raise FEFileFault(f"{name} holds a number that is not finite", id="FE-064")


def _symmetric(name: str, file: MatrixFile) -> np.ndarray:
    matrix = summed(file.values, file.rows, file.columns, file.size)
    if file.one_triangle:
        found: np.ndarray = matrix + without_diagonal(matrix).T
        return found
    largest = abs(matrix).max()
    skew = abs(matrix - matrix.T)
    if skew.max() > SYMMETRY * largest:
        row, column = np.unravel_index(int(skew.argmax()), skew.shape)
        raise FEFileFault(
            f"{name} is not symmetric: entries ({row + 1}, {column + 1}) and ({column + 1}, {row + 1}) are "
            f"{matrix[row, column]:.6g} and {matrix[column, row]:.6g}",
            id="FE-065",
        )
    mean: np.ndarray = (matrix + matrix.T) / 2
    return mean


def _rows_of_nodes(name: str, equations: np.ndarray, numbers: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    place = {int(node): i for i, node in enumerate(numbers)}
    rows = np.full(3 * len(numbers), -1, dtype=np.int64)
    internal = []
    for equation, (node, direction) in enumerate(equations):
        if int(node) in place:
            rows[3 * place[int(node)] + direction - 1] = equation
        else:
            internal.append(equation)
    missing = np.flatnonzero(rows < 0)
    if missing.size:
        _refuse_missing(name, missing, numbers, len(internal))
    return rows, np.array(internal, dtype=np.int64)


def _refuse_missing(name: str, missing: np.ndarray, numbers: np.ndarray, internal: int) -> None:
    node, direction = numbers[missing[0] // 3], missing[0] % 3 + 1
    if missing.size == 3 * len(numbers):
        raise FEFileFault(
            f"{name}: none of its {internal} rows belongs to a node of the node table", id="FE-066"
        )
    raise FEFileFault(
        f"{name} has no row for direction {direction} of node {node}, and lacks {missing.size} in all: is "
        "the node held by a boundary condition, tied to others (*RIGID BODY, *EQUATION, *MPC; RBE2, MPC; CE, "
        "CERIG), or in no element? export the body unsupported, without ties, with the nodes of its elements "
        "only",
        id="FE-067",
    )
