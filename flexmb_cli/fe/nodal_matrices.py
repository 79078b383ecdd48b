"""M and K in the order of the node table, x y z node by node, internal freedoms of elements eliminated.

Elements with incompatible modes may bring freedoms of pseudo-nodes that no node table has.  They are
condensed statically in K, and dropped in M: condensing M as well (Guyan) would couple directions, so that
S^ij = m_ij E no longer held, of which the equations of motion make use.
"""

from dataclasses import dataclass

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import splu

from ..read.fe_files.matrix_file import FEFileFault, MatrixFile

SYMMETRY = 1e-6


@dataclass(frozen=True)
class NodalMatrix:
    """A symmetric matrix (3 n, 3 n) in the order of the node table, and how many freedoms it lost."""

    matrix: sparse.csc_matrix
    internal: int


def nodal_part(name: str, file: MatrixFile, numbers: np.ndarray) -> NodalMatrix:
    """The rows and columns of the nodes `numbers` (n,); internal ones are dropped.  Raises FEFileFault."""
    full, nodal, internal = _ordered(name, file, numbers)
    return NodalMatrix(full[nodal][:, nodal].tocsc(), len(internal))


def condensed(name: str, file: MatrixFile, numbers: np.ndarray) -> NodalMatrix:
    """The matrix of the nodes `numbers` (n,), internal freedoms condensed.  Raises FEFileFault."""
    full, nodal, internal = _ordered(name, file, numbers)
    outer = full[nodal][:, nodal].tocsc()
    if not len(internal):
        return NodalMatrix(outer, 0)
    coupling = full[internal][:, nodal].tocsc()
    try:
        inner = splu(full[internal][:, internal].tocsc())
    except RuntimeError:
        raise FEFileFault(
            f"{name}: the {len(internal)} internal freedoms have no stiffness of their own"
        ) from None
    active = np.flatnonzero(np.diff(coupling.indptr))
    solved = sparse.lil_matrix(coupling.shape)
    solved[:, active] = inner.solve(coupling[:, active].toarray())
    reduced = outer - coupling.T @ solved.tocsc()
    return NodalMatrix(((reduced + reduced.T) / 2).tocsc(), len(internal))


def _ordered(name, file, numbers):
    """The full matrix, the rows of the nodes in the order of the table, and the internal rows."""
    _check_finite(name, file)
    full = _symmetric(name, file)
    size = 3 * len(numbers)
    if file.equations is None:
        if file.size != size:
            raise FEFileFault(
                f"{name} has {file.size} rows; the {len(numbers)} nodes of the table need {size}, three each"
            )
        return full, np.arange(size), np.arange(0)
    return full, *_rows_of_nodes(name, file.equations, numbers)


def _check_finite(name, file):
    if not len(file.values):
        raise FEFileFault(f"{name} holds no entries")
    if not np.isfinite(file.values).all():
        raise FEFileFault(f"{name} holds a number that is not finite")


def _symmetric(name, file):
    matrix = sparse.coo_matrix((file.values, (file.rows, file.columns)), (file.size, file.size)).tocsc()
    if file.one_triangle:
        return matrix + matrix.T - sparse.diags(matrix.diagonal()).tocsc()
    largest = abs(matrix).max()
    skew = abs(matrix - matrix.T)
    if skew.max() > SYMMETRY * largest:
        row, column = np.unravel_index(int(skew.argmax()), skew.shape)
        raise FEFileFault(
            f"{name} is not symmetric: entries ({row + 1}, {column + 1}) and ({column + 1}, {row + 1}) are "
            f"{matrix[row, column]:.6g} and {matrix[column, row]:.6g}"
        )
    return ((matrix + matrix.T) / 2).tocsc()


def _rows_of_nodes(name, equations, numbers):
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


def _refuse_missing(name, missing, numbers, internal):
    node, direction = numbers[missing[0] // 3], missing[0] % 3 + 1
    if missing.size == 3 * len(numbers):
        raise FEFileFault(f"{name}: none of its {internal} rows belongs to a node of the node table")
    raise FEFileFault(
        f"{name} has no row for direction {direction} of node {node}, and lacks {missing.size} in all: is "
        "the node held by a boundary condition, or in no element? export the body unsupported, with the "
        "nodes of its elements only"
    )
