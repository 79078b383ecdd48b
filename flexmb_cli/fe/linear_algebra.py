"""Matrices of a body: numpy arrays while they are small, so that no check waits for scipy; sparse beyond.

Both types have `@`, `.T`, `.diagonal()`, `abs`, `.max()` and `A[rows][:, columns]`; what differs is here.
"""

from collections.abc import Callable
from contextlib import suppress
from itertools import pairwise
from typing import Any

import numpy as np

Matrix = Any  # np.ndarray or scipy.sparse.csc_matrix
# At so many rows all eigenvectors at once (numpy) take about what importing scipy and iterating for a few do.
DENSE = 900
# Rows of an uncoupled block that is inverted at once, as those inside an element (9 of C3D8I).
LARGEST_BLOCK = 60
# Right-hand sides that are solved for, and dense, at a time.
COLUMNS_AT_ONCE = 256
# Relative to the largest entry of a column; of a stiffness the diagonal is taken for a pivot.
LEAST_PIVOT = 1e-3
# Vectors of a block, residual at which it has converged, and length below which a vector depends on others,
# both relative.
VECTORS_AT_ONCE, LEAST_RESIDUAL, LEAST_LENGTH = 8, 1e-12, 1e-13


class Singular(Exception):
    """A linear system has no single solution."""


def summed(values: np.ndarray, rows: np.ndarray, columns: np.ndarray, size: int) -> Matrix:
    """The matrix (size, size) of `values` at `rows`, `columns`, those at one place added up."""
    if size <= DENSE:
        places = np.asarray(rows, dtype=np.int64) * size + columns
        return np.bincount(places, values, size * size).reshape(size, size)
    from scipy import sparse

    return sparse.coo_matrix((values, (rows, columns)), (size, size)).tocsc()


def all_but(size: int, chosen: np.ndarray) -> np.ndarray:
    """Return the numbers below `size` that are not `chosen`; numpy's sets import masked arrays, for 15 ms."""
    left = np.ones(size, dtype=bool)
    left[np.asarray(chosen, dtype=np.int64)] = False
    return np.flatnonzero(left)


def distinct(values: np.ndarray) -> np.ndarray:
    """Return the different ones of some numbers, in order."""
    values = np.sort(values, axis=None)
    return values[np.concatenate([[True], values[1:] != values[:-1]])[: len(values)]]


def as_array(A: np.ndarray) -> np.ndarray:
    """`A` as an array."""
    return A if isinstance(A, np.ndarray) else A.toarray()


def stored(A: np.ndarray) -> Matrix:
    """A matrix that its neighbours need as an array where these are small, else as it is."""
    return as_array(A) if A.shape[0] <= DENSE else A


def without_diagonal(A: np.ndarray) -> Matrix:
    """`A` with zeros on its diagonal."""
    if isinstance(A, np.ndarray):
        return A - np.diag(A.diagonal())
    from scipy import sparse

    return A - sparse.diags(A.diagonal()).tocsc()


def is_small(size: int, count: int) -> bool:
    """Return whether to find all eigenvectors of a matrix at once rather than few by iteration."""
    return size <= DENSE or count > size // 3


def in_three_directions(scalar: np.ndarray) -> Matrix:
    """The matrix (3 n, 3 n) with m_ij E for every m_ij of `scalar` (n, n); stored as bodies of that size."""
    size = 3 * scalar.shape[0]
    if size <= DENSE:
        return np.kron(as_array(scalar), np.eye(3))
    from scipy import sparse

    return sparse.kron(scalar, sparse.identity(3)).tocsc()


def turned(K: np.ndarray, axes: np.ndarray) -> Matrix:
    """`K` (3 n, 3 n) in the axes that are the columns of `axes` (3, 3)."""
    n = K.shape[0] // 3
    if isinstance(K, np.ndarray):
        blocks = K.reshape(n, 3, n, 3)
        return np.einsum("ai,manb,bj->minj", axes, blocks, axes, optimize=True).reshape(K.shape)
    from scipy import sparse

    # Products of sparse matrices drop exact zeros, and of an irregular pattern the factors fill up.
    blocks = sparse.bsr_matrix(K, blocksize=(3, 3))
    data = np.einsum("ai,mab,bj->mij", axes, blocks.data, axes, optimize=True)
    return sparse.bsr_matrix((data, blocks.indices, blocks.indptr), shape=K.shape).tocsc()


def solver(A: np.ndarray, places: np.ndarray | None = None) -> Callable[[np.ndarray], np.ndarray]:
    """The function b → x of A x = b, b (size,) or (size, k), A symmetric.  Raises Singular, then or now.

    `places` (size, 3): where its rows are, node by node.
    """
    if isinstance(A, np.ndarray):
        return lambda b: _solved(A, b)
    from scipy.sparse.linalg import splu

    from .multifrontal import solver_by_fronts

    with suppress(np.linalg.LinAlgError):  # not positive definite: pivots are sought
        if places is not None:
            return solver_by_fronts(A, places)
    symmetric = {"diag_pivot_thresh": LEAST_PIVOT, "options": {"SymmetricMode": True}}
    try:
        return splu(A.tocsc(), permc_spec="MMD_AT_PLUS_A", **symmetric).solve
    except RuntimeError:
        raise Singular from None


def _solved(A: np.ndarray, b: np.ndarray) -> np.ndarray:
    try:
        return np.linalg.solve(A, b)
    except np.linalg.LinAlgError:
        raise Singular from None


def of_mass(S: Any, b: np.ndarray) -> np.ndarray:
    """A solution x (size, k) of S x = b, for a sparse positive semidefinite S and b (size, k) in its range.

    Shapes without mass make S singular, which conjugate gradients do not mind.  A column they do not
    converge for is 0.
    """
    from scipy.sparse import diags
    from scipy.sparse.linalg import cg

    scale = diags(1.0 / S.diagonal())
    columns = [cg(S, column, rtol=1e-13, maxiter=1000, M=scale) for column in b.T]
    return np.column_stack([x if converged == 0 else np.zeros(x.size) for x, converged in columns])


def condensed_on(outer: Any, coupling: Any, inner: Any) -> Matrix:
    """outer - coupling' inner^-1 coupling, of (n, n), (k, n) and (k, k).  Raises Singular."""
    if isinstance(outer, np.ndarray):
        reduced = outer - coupling.T @ solver(inner)(coupling)
        return (reduced + reduced.T) / 2
    from scipy import sparse
    from scipy.sparse.csgraph import connected_components

    coupling, labels = coupling.tocsc(), connected_components(inner, directed=False)[1]
    if np.bincount(labels).max() <= LARGEST_BLOCK:
        reduced = outer - coupling.T @ (_inverse_by_blocks(inner, labels) @ coupling)
        return ((reduced + reduced.T) / 2).tocsc()
    solve, active = solver(inner), np.flatnonzero(np.diff(coupling.indptr))
    parts = np.split(active, range(COLUMNS_AT_ONCE, len(active), COLUMNS_AT_ONCE))
    products = [sparse.csc_matrix(coupling.T @ solve(coupling[:, part].toarray())) for part in parts]
    reduced = outer - sparse.hstack(products) @ sparse.identity(outer.shape[0], format="csr")[active]
    return ((reduced + reduced.T) / 2).tocsc()


def _inverse_by_blocks(A: Any, labels: np.ndarray) -> Matrix:
    """The inverse of a sparse matrix whose rows fall into blocks by `labels` that nothing couples.

    Raises Singular.
    """
    from scipy import sparse

    order, ends = np.argsort(labels, kind="stable"), np.cumsum(np.bincount(labels))
    mixed, undo = A[order][:, order].tocsr(), np.argsort(order)
    try:
        blocks = [np.linalg.inv(mixed[a:b, a:b].toarray()) for a, b in pairwise([0, *ends])]
    except np.linalg.LinAlgError:
        raise Singular from None
    return sparse.block_diag(blocks, format="csc")[undo][:, undo]


def pencil(A: np.ndarray, B: np.ndarray, count: int, largest: bool = False) -> tuple[np.ndarray, np.ndarray]:
    """`count` eigenvalues of A x = mu B x from one end, ascending, and vectors with x' B x = 1.

    Both (size, size) and symmetric.  Raises numpy's LinAlgError when B is not positive definite.
    """
    L = np.linalg.cholesky(B)
    reduced = np.linalg.solve(L, np.linalg.solve(L, A).T)
    values, vectors = np.linalg.eigh((reduced + reduced.T) / 2)
    chosen = slice(len(A) - count, None) if largest else slice(count)
    return values[chosen], np.linalg.solve(L.T, vectors[:, chosen])


def lowest_by_iteration(S: Any, count: int, solve: Callable[..., Any]) -> tuple[np.ndarray, np.ndarray]:
    """Lowest eigenvalues, `count` or as many as S has, and S-orthonormal vectors of large matrices.

    `solve` applies the inverse of K.  Block Lanczos with full reorthogonalisation (Grimes, Lewis and Simon,
    SIAM J. Matrix Anal. Appl. 15 (1994), 228-272): the factors are read once for all vectors of a block.
    """
    vectors: list[np.ndarray] = []
    forces: list[np.ndarray] = []
    T = np.zeros((0, 0))
    answer = solve(S @ np.random.default_rng(1).uniform(-1.0, 1.0, (S.shape[0], VECTORS_AT_ONCE)))
    while True:
        block, coupling = _orthonormal(S, answer, vectors, forces)
        inverse, amplitudes = np.linalg.eigh(T)
        chosen = np.argsort(-np.abs(inverse), kind="stable")[:count]
        residual = (
            np.linalg.norm(coupling @ amplitudes[-coupling.shape[1] :, chosen], axis=0) if len(T) else 1.0
        )
        if not block.size or (
            len(T) >= count and (residual < LEAST_RESIDUAL * np.abs(inverse[chosen])).all()
        ):
            chosen = chosen[np.argsort(1.0 / inverse[chosen])]
            return 1.0 / inverse[chosen], np.hstack(vectors) @ amplitudes[:, chosen]
        vectors.append(block)
        forces.append(S @ block)
        answer = solve(forces[-1])
        T = np.pad(T, (0, block.shape[1]))
        T[-block.shape[1] :] = np.vstack([part.T @ answer for part in forces]).T


def _orthonormal(
    S: Any, block: np.ndarray, vectors: list[np.ndarray], forces: list[np.ndarray]
) -> tuple[np.ndarray, np.ndarray]:
    """S-orthonormal vectors X (size, k) that span what `block` has beside `vectors`, and its part B in X B.

    `forces` are S times `vectors`; k is smaller where the columns of `block` depend on them.
    """
    coupling = np.eye(block.shape[1])
    least = LEAST_LENGTH**2 * float(np.max(np.einsum("ij,ij->j", block, S @ block)))
    for _ in range(2):  # what the first time leaves of dependent vectors is not orthogonal
        for part, force in zip(vectors, forces, strict=True):
            block = block - part @ (force.T @ block)
        squares, axes = np.linalg.eigh(block.T @ (S @ block))
        axes, lengths = axes[:, squares > least], np.sqrt(squares[squares > least])
        block, coupling, least = block @ (axes / lengths), lengths[:, None] * axes.T @ coupling, 0.01
    return block, coupling
