"""Rank, free motions and conditioning of large sparse Jacobians, by elimination in place of singular values.

Singular values of a chain of 300 bodies take seconds and 300 MB, with the cube and the square of the number.
"""

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING

import numpy as np

from ...kernels.linalg.local_order import choose_local
from ...model.by_size import by_size
from ...model.joints import Equation
from ..projection import saddle_point
from .conditioning import Conditioning
from .mobility import NAMED, Mobility

if TYPE_CHECKING:
    from scipy.sparse import csc_matrix, csr_matrix
    from scipy.sparse.linalg import SuperLU

MOST_KEPT = 32  # motions that are kept, so that the mechanism can be moved along them
AT_ONCE = 64  # null vectors solved for together
NAMES_OF_GROUP = 20  # names of a group: every free motion of a chain may move all its bodies
INVERSE_ITERATIONS = 40  # each gains the square of the ratio of the two smallest singular values
POWER_ITERATIONS = 300  # for the largest singular value, near which others lie


def order_of_pivots(matrix: "csr_matrix") -> tuple[np.ndarray, int]:
    """Return rows, then columns (m + n,) of a sparse matrix in the order of pivots, and its rank."""
    matrix = matrix.tocsr(copy=True)
    matrix.sum_duplicates()
    m, n = matrix.shape
    counts = np.diff(matrix.indptr).astype(np.int64)
    rows = np.repeat(np.arange(m), counts)
    own = np.arange(matrix.nnz) - np.repeat(matrix.indptr[:-1], counts)
    columns, values = (np.zeros((m, int(counts.max(initial=1))), kind) for kind in (np.int64, float))
    columns[rows, own], values[rows, own] = matrix.indices, matrix.data
    order = np.zeros(m + n, np.int64)
    return order, choose_local(counts, columns, values, order, min(m, n))


def sparse_mobility(
    matrix: "csr_matrix",
    order: np.ndarray,
    rank: int,
    equations: tuple[Equation, ...],
    name: Callable[[int], str],
) -> Mobility:
    """Return the mobility of a scaled Jacobian (m, n) whose pivots are in this order.

    `name`: that of a coordinate.  Groups end after `NAMES_OF_GROUP` names, `motions` after `MOST_KEPT`.
    """
    from scipy.sparse.linalg import splu

    m, n = matrix.shape
    rows, columns = order[:m], order[m:]
    repeated, pivots = np.sort(rows[rank:]), np.sort(columns[rank:])
    leading = matrix[rows[:rank]][:, columns[:rank]]
    factors = splu(leading.tocsc()) if rank else None
    free, motions = [], np.zeros((min(pivots.size, MOST_KEPT), n))
    # What the dependent coordinates do where a free one changes by 1.
    shares = _shares(factors, matrix[rows[:rank]][:, pivots].tocsc(), "N")
    for row, (x, k) in enumerate(zip(shares, pivots, strict=True)):
        free.append(_largest(columns[:rank], x, k))
        if row < MOST_KEPT:
            motions[row, columns[:rank]], motions[row, k] = x, 1.0
            motions[row] /= np.linalg.norm(motions[row])
    shares = _shares(factors, matrix[repeated][:, columns[:rank]].T.tocsc(), "T")
    redundant = [_largest(rows[:rank], x, k) for x, k in zip(shares, repeated, strict=True)]
    return Mobility(
        equations=m,
        coordinates=n,
        rank=rank,
        smallest=1.0 / sparse_conditioning(matrix).condition if rank == min(m, n) and rank else 0.0,
        redundant=tuple(tuple(equations[k] for k in group) for group in redundant),
        free=tuple(tuple(name(k) for k in group) for group in free),
        motions=motions,
        pivots=tuple(pivots.tolist()),
        repeated=tuple(repeated.tolist()),
    )


def _shares(factors: "SuperLU | None", right_sides: "csc_matrix", transposed: str) -> Iterator[np.ndarray]:
    """Yield minus the solution (rank,) for each column of sparse right-hand sides, some at a time."""
    for first in range(0, right_sides.shape[1], AT_ONCE):
        some = right_sides[:, first : first + AT_ONCE].toarray()
        yield from -(factors.solve(some, transposed) if factors else some).T


def _largest(places: np.ndarray, shares: np.ndarray, own: int) -> list[int]:
    """Return the places with the largest shares of a null vector, whose own place has a share of 1."""
    size = np.append(np.abs(shares), 1.0)
    everywhere = np.append(places, own)
    some = np.flatnonzero(size > NAMED * size.max())
    some = some[np.argsort(everywhere[some])]
    return everywhere[some[by_size(size[some])[:NAMES_OF_GROUP]]].tolist()


def sparse_conditioning(matrix: "csr_matrix", rows: np.ndarray | None = None) -> Conditioning:
    """Return the conditioning of a sparse Jacobian (m, n) of full rank, or of its independent `rows`.

    By inverse iteration with J Jᵀ, or Jᵀ J where that is smaller.
    """
    part = matrix if rows is None else matrix[rows]
    wide = part.shape[0] <= part.shape[1]
    J = (part if wide else part.T).tocsr()
    count, n = J.shape
    factors = saddle_point(J, None)
    low = high = np.random.default_rng(1996).standard_normal(count)
    for _ in range(INVERSE_ITERATIONS):
        low = -factors.solve(np.append(np.zeros(n), low / np.linalg.norm(low)))[n:]
    for _ in range(POWER_ITERATIONS):
        high = J @ (J.T @ (high / np.linalg.norm(high)))
    condition = float(np.sqrt(np.linalg.norm(high) * np.linalg.norm(low)))
    low = low / np.linalg.norm(low)
    other = J.T @ low
    other = other / (np.linalg.norm(other) or 1.0)
    motion, combination = (other, low) if wide else (low, other)
    if rows is not None:
        spread = np.zeros(matrix.shape[0])
        spread[rows] = combination
        combination = spread
    return Conditioning(condition, motion, combination)
