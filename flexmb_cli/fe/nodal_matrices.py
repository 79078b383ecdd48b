"""M and K in the order of the node table, x y z node by node, internal degrees of freedom of elements
eliminated.

Elements with incompatible modes may bring degrees of freedom of pseudo-nodes that no node table has.  They
are condensed statically in K, and dropped in M: condensing M as well (Guyan) would couple directions, so that
S^ij = m_ij E no longer held, of which the equations of motion make use.

A translation of the nodes strains no element, so that internal rows do not resist it.  Rows of nodes that the
table lacks do, by the stiffness of what joins them to the nodes: these are refused.
"""

from collections.abc import Callable, Collection
from dataclasses import dataclass

import numpy as np

from .formats.matrix_file import TRANSLATIONS, FEFileFault, MatrixFile, size_hint
from .linear_algebra import Matrix, Singular, condensed_on, solver, stored, summed, without_diagonal

SYMMETRY = 1e-6
# Force of an internal row in a translation, relative to the sum of the row's entries, which rounding to few
# digits leaves; and relative to the largest entry of K, below which a row is round-off.
RESISTED, ROUND_OFF_ROW = 1e-3, 1e-12
# Labels that a message names.
MOST_LABELS = 6


@dataclass(frozen=True)
class NodalMatrix:
    """A symmetric matrix (3 n, 3 n) in the order of the node table, made of `file`.

    `nodal` (3 n,) and `internal`: the rows of the file that are those of the nodes, and those condensed or
    dropped; `following` (internal, 3 n): how these move with the nodes, None where they rest; `coupled`:
    nodes and directions of those with a stiffness to the nodes.  Matrices whose rows are not x y z node by
    node have `nodal` -1 for rows that the file lacks, and their own translations, `shifts`.
    """

    matrix: Matrix
    file: MatrixFile
    nodal: np.ndarray
    internal: np.ndarray
    following: Callable[[np.ndarray], np.ndarray] | None = None
    coupled: Collection[tuple[int, int]] = ()
    shifts: np.ndarray | None = None

    @property
    def translations(self) -> np.ndarray:
        """Rows (size, 3) of unit translations of the nodes."""
        if self.shifts is not None:
            return self.shifts
        return np.tile(np.eye(3), (self.matrix.shape[0] // 3, 1))

    def extended(self, shapes: np.ndarray) -> np.ndarray:
        """Return the displacements (size, k) of all rows of the file for those of the nodes, (3 n, k)."""
        full, there = np.zeros((self.file.size, shapes.shape[1])), self.nodal >= 0
        full[self.nodal[there]] = shapes[there]
        if self.following is not None:
            full[self.internal] = self.following(shapes)
        return full


def nodal_part(
    name: str, file: MatrixFile, numbers: np.ndarray, stiffness: NodalMatrix | None = None
) -> NodalMatrix:
    """The rows and columns of the nodes `numbers` (n,); internal ones are dropped.  Raises FEFileFault.

    They must be internal ones of `stiffness`, too, as in the files of programs that give them masses.
    """
    full, nodal, internal = _ordered(name, file, numbers)
    if stiffness:
        filled = internal[np.isin(internal, file.rows[file.values != 0.0])]
        foreign = [label not in stiffness.coupled for label in _labels(file, filled)]
        _refuse_nodes(name, file, filled[np.array(foreign, dtype=bool)])
    return NodalMatrix(stored(full[nodal][:, nodal]), file, nodal, internal)


def condensed(name: str, file: MatrixFile, numbers: np.ndarray) -> NodalMatrix:
    """The matrix of the nodes `numbers` (n,), internal degrees of freedom condensed.  Raises FEFileFault."""
    full, nodal, internal = _ordered(name, file, numbers)
    outer = full[nodal][:, nodal]
    if not len(internal):
        return NodalMatrix(stored(outer), file, nodal, internal)
    inner, coupling = full[internal][:, internal], full[internal][:, nodal]
    _refuse_nodes(name, file, internal[_resists_translation(coupling, abs(full).max())])
    try:
        matrix, solve = stored(condensed_on(outer, coupling, inner)), solver(inner)
    except Singular:
        message = f"{name}: the {len(internal)} internal degrees of freedom have no stiffness of their own"
        raise FEFileFault(message, id="FE-061") from None
    coupled = _labels(file, internal[abs(coupling) @ np.ones(len(nodal)) > 0.0])
    return NodalMatrix(matrix, file, nodal, internal, lambda shapes: -solve(coupling @ shapes), {*coupled})


def _resists_translation(coupling: Matrix, largest: float) -> np.ndarray:
    """Return which rows (k,) of `coupling` (k, 3 n) to the nodes give a force when these translate."""
    size = coupling.shape[1]
    forces = np.abs(coupling @ np.tile(np.eye(3), (size // 3, 1))).max(axis=1)
    least = np.maximum(RESISTED * (abs(coupling) @ np.ones(size)), ROUND_OFF_ROW * largest)
    return forces > least


def _labels(file: MatrixFile, rows: np.ndarray) -> list[tuple[int, int]]:
    """Return node and direction of `rows`, which only files with labels have beside those of the nodes."""
    return [] if file.equations is None else [(node, axis) for node, axis in file.equations[rows].tolist()]


def _refuse_nodes(name: str, file: MatrixFile, rows: np.ndarray) -> None:
    """Refuse `rows` of nodes that the table lacks."""
    nodes = sorted({node for node, _ in _labels(file, rows)})
    if nodes:
        more = ", …" if len(nodes) > MOST_LABELS else ""
        raise FEFileFault(
            f"{name} has rows with stiffness or mass of nodes that the node table lacks: "
            f"{', '.join(map(str, nodes[:MOST_LABELS]))}{more}; was the table cut short, or written of "
            "selected nodes only? give one of all nodes",
            id="FE-184",
        )


def _ordered(name: str, file: MatrixFile, numbers: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The full matrix, the rows of the nodes in the order of the table, and the internal rows."""
    check_finite(name, file)
    full = full_matrix(name, file)
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


def check_finite(name: str, file: MatrixFile) -> None:
    """Refuse a file without entries, and one with numbers that are not finite."""
    if not len(file.values):
        raise FEFileFault(f"{name} holds no entries", id="FE-063")
    if not np.isfinite(file.values).all():
        raise FEFileFault(f"{name} holds a number that is not finite", id="FE-064")


def full_matrix(name: str, file: MatrixFile) -> Matrix:
    """Return the whole matrix (size, size) of a file.  Raises FEFileFault for one that is not symmetric."""
    matrix = summed(file.values, file.rows, file.columns, file.size)
    if file.one_triangle:
        return matrix + without_diagonal(matrix).T
    largest = abs(matrix).max()
    skew = abs(matrix - matrix.T)
    if skew.max() > SYMMETRY * largest:
        row, column = np.unravel_index(int(skew.argmax()), skew.shape)
        raise FEFileFault(
            f"{name} is not symmetric: entries ({row + 1}, {column + 1}) and ({column + 1}, {row + 1}) are "
            f"{matrix[row, column]:.6g} and {matrix[column, row]:.6g}",
            id="FE-065",
        )
    return (matrix + matrix.T) / 2


def _rows_of_nodes(name: str, equations: np.ndarray, numbers: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    order = np.argsort(numbers)
    place = order[np.searchsorted(numbers, equations[:, 0], sorter=order).clip(max=len(order) - 1)]
    known = (numbers[place] == equations[:, 0]) & np.isin(equations[:, 1], TRANSLATIONS)
    rows = np.full(3 * len(numbers), -1, dtype=np.int64)
    rows[3 * place[known] + equations[known, 1] - 1] = np.flatnonzero(known)
    internal = np.flatnonzero(~known)
    missing = np.flatnonzero(rows < 0)
    if missing.size:
        _refuse_missing(name, missing, numbers, len(internal))
    return rows, internal


def _refuse_missing(name: str, missing: np.ndarray, numbers: np.ndarray, internal: int) -> None:
    node, direction = numbers[missing[0] // 3], missing[0] % 3 + 1
    if missing.size == 3 * len(numbers):
        message = f"{name}: none of its {internal} rows belongs to a node of the node table"
        raise FEFileFault(message, id="FE-066")
    raise FEFileFault(
        f"{name} has no row for direction {direction} of node {node}, and lacks {missing.size} in all: is "
        "the node held by a boundary condition, tied to others (*RIGID BODY, *EQUATION, *MPC; RBE2, MPC; CE, "
        "CERIG), or in no element? export the body unsupported, without ties, with the nodes of its elements "
        "only",
        id="FE-067",
    )
