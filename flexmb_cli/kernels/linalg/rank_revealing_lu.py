"""Independent equations of a constraint Jacobian, and elimination with those alone.

Redundant but consistent equations are ordinary in mechanisms: planar loops of spatial joints,
Bricard's and Bennett's linkages.  Elimination with free choice of row and column shows the rank; the
order found is kept from step to step, so that the same equations stay in charge and elimination
needs no search, and is found anew when its pivots get small.

Entries are scaled to pure numbers.  J: jacobian (m, n); order (m + n,): the rows in pivot order, then the
columns; the first r of each are the independent equations and the dependent speeds.  A row holds the
speeds of two bodies or few more: only entries that may be other than zero are visited.  factors (m, n) and
entries (m, n + 2) are those of `factorise`, whose columns (m, 1 + c) are the places of the Jacobian.
"""

import math

import numpy as np

from .._jit import allocating, kernel
from .row_products import subtract_multiple
from .sparse_rows import FIRST_ENTRY, eliminate, take_row

SMALLEST_FACTOR = 1e-12
WORN = 0.1  # of the quality of the factors when the order was chosen: asks for another one
# Pivot below which the equations leave a second motion free but for round-off: two branches, 1e-16 of
# gap apart, come as near as a pivot of 1e-8.
BRANCHING = 1e-6


@allocating
def factorise(
    jacobian: np.ndarray,
    columns: "np.ndarray",
    order: np.ndarray,
    rank: int,
    factors: np.ndarray,
    entries: "np.ndarray",
) -> float:
    """Factors of the first `rank` rows in the order at hand: factors (m, n), columns in pivot order.

    The leading block (rank, rank) becomes L with unit diagonal below, U above; the columns behind it
    L⁻¹ times those of the free speeds.  columns (m, 1 + c): how many entries of a row of the Jacobian may
    be other than zero, and their columns.  entries (m, n + 2) receives the nonzero places of every row:
    where those left of the diagonal end, those right of it in the leading block, those behind it, then the
    places.  factors and entries must come from the last call, or be zeros.  Returns the smallest pivot over
    the largest multiplier, at least 1: small where the order is a bad one, 0 where a pivot vanishes.
    """
    m, n = jacobian.shape
    places, following = np.empty(n, np.int64), np.empty(n + 1, np.int64)
    for j in range(n):
        places[order[m + j]] = j
    growth, smallest, end = 1.0, 1e300, rank
    for i in range(rank):
        take_row(jacobian, columns, order[i], places, factors, entries, i, following)
        growth = max(growth, eliminate(factors, entries, i, min(i, end), rank, following))
        if i < end:
            smallest = min(smallest, abs(factors[i, i]))
            if not abs(factors[i, i]) > SMALLEST_FACTOR:
                end = i
    return smallest / growth if end == rank else 0.0


@kernel
def smallest_pivot(factors: np.ndarray, rank: int) -> float:
    """Return the smallest of the first `rank` pivots in factors (m, n), infinite where there are none."""
    smallest = math.inf
    for k in range(rank):
        smallest = min(smallest, abs(factors[k, k]))
    return smallest


@kernel
def free_motions(
    factors: np.ndarray, entries: "np.ndarray", order: np.ndarray, rank: int, m: int, motions: np.ndarray
) -> None:
    """Fill motions (n, n - rank): its columns span the speeds that the equations leave free."""
    free = factors.shape[1] - rank
    for f in range(free):
        for g in range(free):
            motions[order[m + rank + f], g] = 0.0
        motions[order[m + rank + f], f] = 1.0
    for i in range(rank - 1, -1, -1):
        row, pivot = motions[order[m + i], :free], factors[i, i]
        for f in range(free):
            row[f] = -factors[i, rank + f]
        for p in range(entries[i, 0], entries[i, 1]):
            j = entries[i, p]
            subtract_multiple(factors[i, j], motions[order[m + j], :free], row)
        for f in range(free):
            row[f] /= pivot


@kernel
def dependent_speeds(
    factors: np.ndarray,
    entries: "np.ndarray",
    order: np.ndarray,
    rank: int,
    m: int,
    right_side: np.ndarray,
    x: np.ndarray,
) -> None:
    """Fill x (n,) with a solution of the independent equations whose free speeds are zero.

    right_side (m,) in the order of the equations.
    """
    n = factors.shape[1]
    for j in range(rank, n):
        x[order[m + j]] = 0.0
    for i in range(rank):
        total = right_side[order[i]]
        for p in range(FIRST_ENTRY, entries[i, 0]):
            j = entries[i, p]
            total -= factors[i, j] * x[order[m + j]]
        x[order[m + i]] = total
    for i in range(rank - 1, -1, -1):
        total = x[order[m + i]]
        for p in range(entries[i, 0], entries[i, 1]):
            j = entries[i, p]
            total -= factors[i, j] * x[order[m + j]]
        x[order[m + i]] = total / factors[i, i]


@allocating
def transposed_solution(factors: np.ndarray, entries: "np.ndarray", rank: int, y: np.ndarray) -> None:
    """Solve Bᵀ x = y in place, y (rank,) in pivot order, B the leading block."""
    for j in range(rank):
        y[j] /= factors[j, j]
        for p in range(entries[j, 0], entries[j, 1]):
            i = entries[j, p]
            y[i] -= factors[j, i] * y[j]
    starts, rows = _rows_below(entries, rank)
    for i in range(rank - 1, -1, -1):
        for p in range(starts[i], starts[i + 1]):
            y[i] -= factors[rows[p], i] * y[rows[p]]


@allocating
def _rows_below(entries: "np.ndarray", rank: int):
    """The rows with an entry below the diagonal, column by column, and where each column begins and ends."""
    starts = np.zeros(rank + 2, np.int64)
    for i in range(rank):
        for p in range(FIRST_ENTRY, entries[i, 0]):
            starts[entries[i, p] + 2] += 1
    for k in range(2, rank + 2):
        starts[k] += starts[k - 1]
    rows = np.empty(starts[rank + 1], np.int64)
    for i in range(rank):
        for p in range(FIRST_ENTRY, entries[i, 0]):
            k = entries[i, p] + 1
            rows[starts[k]] = i
            starts[k] += 1
    return starts, rows


@kernel
def row_times(jacobian: np.ndarray, columns: np.ndarray, row: int, x: np.ndarray, scale: np.ndarray):
    """Return the product of a row of jacobian (m, n) and x / scale, x (n,), scale (n,)."""
    total = 0.0
    for p in range(1, 1 + columns[row, 0]):
        k = columns[row, p]
        total += jacobian[row, k] * x[k] / scale[k]
    return total
