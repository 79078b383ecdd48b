"""Factors of Φ_q of which only entries other than zero are kept, for mechanisms of many bodies.

The order of elimination is chosen once, and anew where its pivots have become small; the sign of the
determinant is that of the pivots and of the order as two permutations.
"""

from typing import NamedTuple

import numpy as np

from ...memory import paged_zeros
from .._jit import allocating, kernel, plain
from ..linalg.local_order import choose_local
from ..linalg.rank_revealing_lu import WORN, dependent_speeds, factorise, smallest_pivot
from ..linalg.rotation import A
from ..linalg.sparse_rows import Factors
from . import constraints as equations
from .newton import BODY_I, BODY_J, OF_COORDINATE, PER_ROW, PIVOT, RANK, SCALED, UNKNOWN, LinearSolver, System

ORDER_QUALITY, PARITY = 0, 1


class SparseWork(NamedTuple):
    """Arrays reused in every step, of n coordinates; the first three as in `newton.Work`."""

    rotations: np.ndarray  # (3, bodies, 3, 3) A, dA/dt, 1/s, and the remainder of d²A/dt², 1/s²
    vectors: np.ndarray  # (6, n) in units of equations or coordinates; rows PHI … REST
    phi_q: np.ndarray  # (n, 14) derivatives by the coordinates of both bodies, in units of both
    jacobian: np.ndarray  # (n, 14) its entries at the places of `columns`, in units of both
    columns: np.ndarray  # (n, 15) number of places of a row that may be other than zero, and these
    sources: np.ndarray  # (n, 14) their places in the row of phi_q
    order: np.ndarray  # (2 n,) numbers of rows, then columns, in the order of elimination
    factors: np.ndarray  # (n n,) scaled, `Factors.values`
    entries: np.ndarray  # (n n,) places, `Factors.places`
    ends: np.ndarray  # (n, 4) places, `Factors.ends`
    diagonal: np.ndarray  # (n,) `Factors.diagonal`, scaled
    chosen: np.ndarray  # (2,) no unit: ORDER_QUALITY, 0 where no order is chosen, and PARITY


@plain
def make_sparse_work(system: System, repeated: tuple[int, ...], dependent: tuple[int, ...]) -> SparseWork:
    """Work without the rows `repeated`, which repeat others; corrections of `dependent` coordinates are 0."""
    n = system.places.shape[0]
    columns, sources = np.zeros((n, 15), np.int64), np.zeros((n, 14), np.int64)
    for row in sorted(set(range(n)).difference(repeated)):
        i, j = int(system.places[row, BODY_I]), int(system.places[row, BODY_J])
        halves = [(i, 0)] if i == j else sorted([(i, 0), (j, 7)])
        kept = [
            (7 * body + k, at + k) for body, at in halves for k in range(7) if 7 * body + k not in dependent
        ]
        columns[row, 0] = len(kept)
        columns[row, 1 : 1 + len(kept)] = [place for place, _ in kept]
        sources[row, : len(kept)] = [source for _, source in kept]
    return SparseWork(
        np.zeros((3, n // 7, 3, 3)),
        np.zeros((6, n)),
        np.zeros((n, 14)),
        np.zeros((n, 14)),
        columns,
        sources,
        np.zeros(2 * n, np.int64),
        paged_zeros((n * n,)),
        paged_zeros((n * n,), np.int64),
        np.zeros((n, 4), np.int64),
        np.zeros(n),
        np.zeros(2),
    )


@kernel
def _fill_jacobian(system: System, work: SparseWork) -> None:
    for row in range(work.jacobian.shape[0]):
        doubled = system.places[row, BODY_I] == system.places[row, BODY_J]
        for p in range(work.columns[row, 0]):
            source, column = work.sources[row, p], work.columns[row, 1 + p]
            value = work.phi_q[row, source]
            if doubled:
                value += work.phi_q[row, source + 7]
            work.jacobian[row, p] = value * (system.units[OF_COORDINATE, column] * system.units[PER_ROW, row])


@allocating
def _choose(work: SparseWork, rank: int) -> int:
    """Choose the order by the Jacobian at hand; returns the rank, at most `rank`."""
    n, c = work.jacobian.shape
    counts, columns, values = np.empty(n, np.int64), np.empty((n, c), np.int64), np.empty((n, c))
    for i in range(n):
        counts[i] = work.columns[i, 0]
        for p in range(counts[i]):
            columns[i, p], values[i, p] = work.columns[i, 1 + p], work.jacobian[i, p]
    found = choose_local(counts, columns, values, work.order, rank)
    work.chosen[PARITY] = _sign(work.order[:n]) * _sign(work.order[n:])
    return found


@allocating
def _sign(order: np.ndarray) -> int:
    """Return -1 for a permutation (n,) made of an odd number of exchanges, else 1: n less its cycles."""
    seen, sign = np.zeros(order.shape[0], np.int64), 1
    for first in range(order.shape[0]):
        k = first
        while seen[k] == 0:
            seen[k] = 1
            k = order[k]
            if k != first:
                sign = -sign
    return sign


@kernel
def factorise_sparse(system: System, work: SparseWork, q: np.ndarray) -> int:
    """Factors of Φ_q at q, where A belongs to q; returns the sign of det Φ_q, 0 where it is singular."""
    equations.jacobian(system.constraints, q, work.rotations[A], work.phi_q)
    _fill_jacobian(system, work)
    rank, quality = int(system.limits[RANK]), 0.0
    factors = Factors(work.factors, work.entries, work.ends, work.diagonal)
    if work.chosen[ORDER_QUALITY] > 0.0:
        quality = factorise(work.jacobian, work.columns, work.order, rank, factors)
    if not quality > WORN * work.chosen[ORDER_QUALITY]:
        if _choose(work, rank) == rank:
            quality = factorise(work.jacobian, work.columns, work.order, rank, factors)
        work.chosen[ORDER_QUALITY] = quality
    if not (quality > 0.0 and smallest_pivot(work.diagonal, rank) > system.limits[PIVOT]):
        work.chosen[ORDER_QUALITY] = 0.0
        return 0
    sign = int(work.chosen[PARITY])
    for k in range(rank):
        if work.diagonal[k] < 0.0:
            sign = -sign
    return sign


@kernel
def solve_sparse(system: System, work: SparseWork, right_side: np.ndarray, solution: np.ndarray) -> float:
    """Fill solution (n,) of Φ_q solution = right_side by the factors at hand; right_side (n,).

    Returns its largest scaled component.
    """
    scaled, unknown = work.vectors[SCALED], work.vectors[UNKNOWN]
    for row in range(scaled.size):
        scaled[row] = right_side[row] * system.units[PER_ROW, row]
    factors = Factors(work.factors, work.entries, work.ends, work.diagonal)
    dependent_speeds(factors, work.order, int(system.limits[RANK]), scaled, unknown)
    found = 0.0
    for k in range(solution.size):
        found = max(found, abs(unknown[k]))
        solution[k] = unknown[k] * system.units[OF_COORDINATE, k]
    return found


SPARSE = LinearSolver(factorise_sparse, solve_sparse)
