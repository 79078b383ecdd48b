"""Independent equations of a constraint Jacobian, and elimination with those alone.

Redundant but consistent equations are ordinary in mechanisms: planar loops of spatial joints,
Bricard's and Bennett's linkages.  Elimination with free choice of row and column shows the rank; the
order found is kept from step to step, so that the same equations stay in charge and elimination
needs no search, and is found anew when its pivots get small.

Entries are scaled to pure numbers.  J: jacobian (m, c), row by row its entries in `columns` (m, 1 + c): how
many of a row may be other than zero, and their columns.  order (m + n,): the rows in pivot order, then the
columns; the first r of each are the independent equations and the dependent speeds.  Of the factors, too,
only entries other than zero are kept and visited.

The nonzero places of a row that is eliminated form a chain in order.  whole (n,) is the row that is worked
on, in the order of pivots; zeros between two rows.
"""

import math
from typing import NamedTuple

import numpy as np

from .._jit import allocating, kernel
from .number_rows import subtract_multiple

# Columns of `Factors.ends`.
BELOW_PIVOT, ABOVE_PIVOT, BEHIND_BLOCK, ROW_END = 0, 1, 2, 3


class Factors(NamedTuple):
    """Rows of L and U, one after the other, without their zeros."""

    values: np.ndarray  # (m n,) entries, scaled: left of the pivot, right of it, behind the leading block
    places: np.ndarray  # (m n,) their places in the order of pivots
    ends: np.ndarray  # (m, 4) places where the parts of a row begin, and ROW_END
    diagonal: np.ndarray  # (m,) pivots, scaled


@kernel
def take_row(
    jacobian: np.ndarray,
    columns: np.ndarray,
    row: int,
    places: np.ndarray,
    whole: np.ndarray,
    following: np.ndarray,
) -> None:
    """Spread a row of the Jacobian over `whole`.

    places (n,): place of each column in the order of pivots.  following (n + 1,) becomes the chain of the
    row's places in order: that after place j, n behind the last; the first one is following[n].
    """
    n = whole.shape[0]
    following[n] = n
    for p in range(columns[row, 0]):
        # Planar mechanisms have mostly zeros.
        if jacobian[row, p] != 0.0:
            place = places[columns[row, 1 + p]]
            whole[place] = jacobian[row, p]
            at = n
            while following[at] < place:
                at = following[at]
            following[place] = following[at]
            following[at] = place


@kernel
def eliminate(
    factors: Factors, i: int, end: int, rank: int, whole: np.ndarray, following: np.ndarray, count: int
) -> tuple[float, int]:
    """Take multiples of the rows before `end` from `whole`, and store it as row i, from place `count` on.

    following (n + 1,) is the chain of `take_row`; `rank` columns belong to the leading block.  Returns the
    largest multiplier, and where the row ends.
    """
    values, places, ends, diagonal = factors.values, factors.places, factors.ends, factors.diagonal
    n, largest = whole.shape[0], 0.0
    ends[i, BELOW_PIVOT] = count
    k = following[n]
    while k < end:
        if whole[k] != 0.0:
            factor = whole[k] / diagonal[k]
            values[count], places[count] = factor, k
            largest = max(largest, abs(factor))
            count += 1
            at = k
            for p in range(ends[k, ABOVE_PIVOT], ends[k, ROW_END]):
                j = places[p]
                whole[j] -= factor * values[p]
                while following[at] < j:
                    at = following[at]
                if following[at] != j:
                    following[j] = following[at]
                    following[at] = j
        whole[k] = 0.0
        k = following[k]
    ends[i, ABOVE_PIVOT] = ends[i, BEHIND_BLOCK] = count
    diagonal[i] = whole[i]
    while k < n:
        if whole[k] != 0.0 and k != i:
            values[count], places[count] = whole[k], k
            count += 1
            if k < rank:
                ends[i, BEHIND_BLOCK] = count
        whole[k] = 0.0
        k = following[k]
    ends[i, ROW_END] = count
    return largest, count


SMALLEST_FACTOR = 1e-12
WORN = 0.1  # of the quality of the factors when the order was chosen: asks for another one
# Pivot below which the equations leave a second motion free but for round-off: two branches, 1e-16 of
# gap apart, come as near as a pivot of 1e-8.
BRANCHING = 1e-6


@allocating
def factorise(
    jacobian: np.ndarray, columns: np.ndarray, order: np.ndarray, rank: int, factors: Factors
) -> float:
    """Factors of the first `rank` rows in the order at hand, columns in pivot order.

    The leading block (rank, rank) becomes L with unit diagonal below, U above; the columns behind it
    L⁻¹ times those of the free speeds.  Returns the smallest pivot over the largest multiplier, at least 1:
    small where the order is a bad one, 0 where a pivot vanishes.
    """
    m = jacobian.shape[0]
    n = order.shape[0] - m
    places, following, whole = np.empty(n, np.int64), np.empty(n + 1, np.int64), np.zeros(n)
    for j in range(n):
        places[order[m + j]] = j
    growth, smallest, end, count = 1.0, 1e300, rank, 0
    for i in range(rank):
        take_row(jacobian, columns, order[i], places, whole, following)
        largest, count = eliminate(factors, i, min(i, end), rank, whole, following, count)
        growth = max(growth, largest)
        if i < end:
            smallest = min(smallest, abs(factors.diagonal[i]))
            if not abs(factors.diagonal[i]) > SMALLEST_FACTOR:
                end = i
    return smallest / growth if end == rank else 0.0


@kernel
def smallest_pivot(diagonal: np.ndarray, rank: int) -> float:
    """Return the smallest of the first `rank` pivots in diagonal (m,), infinite where there are none."""
    smallest = math.inf
    for k in range(rank):
        smallest = min(smallest, abs(diagonal[k]))
    return smallest


@kernel
def free_motions(factors: Factors, order: np.ndarray, rank: int, motions: np.ndarray) -> None:
    """Fill motions (n, n - rank): its columns span the speeds that the equations leave free."""
    values, places, ends, diagonal = factors.values, factors.places, factors.ends, factors.diagonal
    m, n = ends.shape[0], order.shape[0] - ends.shape[0]
    free = n - rank
    for f in range(free):
        for g in range(free):
            motions[order[m + rank + f], g] = 0.0
        motions[order[m + rank + f], f] = 1.0
    for i in range(rank - 1, -1, -1):
        row, pivot = motions[order[m + i], :free], diagonal[i]
        for f in range(free):
            row[f] = -0.0
        for p in range(ends[i, BEHIND_BLOCK], ends[i, ROW_END]):
            row[places[p] - rank] = -values[p]
        for p in range(ends[i, ABOVE_PIVOT], ends[i, BEHIND_BLOCK]):
            subtract_multiple(values[p], motions[order[m + places[p]], :free], row)
        for f in range(free):
            row[f] /= pivot


@kernel
def dependent_speeds(
    factors: Factors, order: np.ndarray, rank: int, right_side: np.ndarray, x: np.ndarray
) -> None:
    """Fill x (n or more,) with a solution of the independent equations whose free speeds are zero.

    right_side (m,) in the order of the equations.
    """
    values, places, ends, diagonal = factors.values, factors.places, factors.ends, factors.diagonal
    m, n = ends.shape[0], order.shape[0] - ends.shape[0]
    for j in range(rank, n):
        x[order[m + j]] = 0.0
    for i in range(rank):
        total = right_side[order[i]]
        for p in range(ends[i, BELOW_PIVOT], ends[i, ABOVE_PIVOT]):
            total -= values[p] * x[order[m + places[p]]]
        x[order[m + i]] = total
    for i in range(rank - 1, -1, -1):
        total = x[order[m + i]]
        for p in range(ends[i, ABOVE_PIVOT], ends[i, BEHIND_BLOCK]):
            total -= values[p] * x[order[m + places[p]]]
        x[order[m + i]] = total / diagonal[i]


@allocating
def transposed_solution(factors: Factors, rank: int, y: np.ndarray) -> None:
    """Solve Bᵀ x = y in place, y (rank,) in pivot order, B the leading block."""
    values, places, ends, diagonal = factors.values, factors.places, factors.ends, factors.diagonal
    for j in range(rank):
        y[j] /= diagonal[j]
        for p in range(ends[j, ABOVE_PIVOT], ends[j, BEHIND_BLOCK]):
            y[places[p]] -= values[p] * y[j]
    starts, rows, below = _rows_below(factors, rank)
    for i in range(rank - 1, -1, -1):
        for p in range(starts[i], starts[i + 1]):
            y[i] -= values[below[p]] * y[rows[p]]


@allocating
def _rows_below(factors: Factors, rank: int):
    """The rows with an entry below the diagonal and where it stands, column by column, and where each column
    begins and ends.
    """
    places, ends = factors.places, factors.ends
    starts = np.zeros(rank + 2, np.int64)
    for i in range(rank):
        for p in range(ends[i, BELOW_PIVOT], ends[i, ABOVE_PIVOT]):
            starts[places[p] + 2] += 1
    for k in range(2, rank + 2):
        starts[k] += starts[k - 1]
    rows, below = np.empty(starts[rank + 1], np.int64), np.empty(starts[rank + 1], np.int64)
    for i in range(rank):
        for p in range(ends[i, BELOW_PIVOT], ends[i, ABOVE_PIVOT]):
            k = places[p] + 1
            rows[starts[k]], below[starts[k]] = i, p
            starts[k] += 1
    return starts, rows, below


@kernel
def row_times(jacobian: np.ndarray, columns: np.ndarray, row: int, x: np.ndarray, scale: np.ndarray):
    """Return the product of a row of jacobian (m, c) and x / scale, x (n,), scale (n,)."""
    total = 0.0
    for p in range(columns[row, 0]):
        if jacobian[row, p] != 0.0:
            k = columns[row, 1 + p]
            total += jacobian[row, p] * x[k] / scale[k]
    return total


@kernel
def entry_of(jacobian: np.ndarray, columns: np.ndarray, row: int, column: int) -> float:
    """Return one entry of jacobian (m, c)."""
    for p in range(columns[row, 0]):
        if columns[row, 1 + p] == column:
            return jacobian[row, p]
    return 0.0
