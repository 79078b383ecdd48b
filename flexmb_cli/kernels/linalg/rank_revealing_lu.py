"""Which equations of a constraint Jacobian are independent, and elimination with those alone.

Redundant but consistent equations are ordinary in mechanisms: planar loops of spatial joints,
Bricard's and Bennett's linkages.  Elimination with free choice of row and column shows the rank; the
order found is kept from step to step, so that the same equations stay in charge and elimination
needs no search, and is found anew when its pivots get small.

Entries are scaled to pure numbers.  J (m, n); `order` (m + n,): the rows in pivot order, then the
columns; the first r of each are the independent equations and the dependent speeds.
"""

import math
from typing import TYPE_CHECKING

from .._jit import kernel

if TYPE_CHECKING:
    import numpy as np


RANK_TOLERANCE = 1e-9  # of the largest entry: what is left below counts as zero
GOOD_ENOUGH = 0.1  # of the largest entry left: may be a pivot, and the one that spares most zeros is
TINY = 1e-12
WORN = 0.1  # of the quality of the factors when the order was chosen: asks for another one
# Pivot below which the equations leave a second motion free but for round-off: two branches, 1e-16 of
# gap apart, come as near as a pivot of 1e-8.
BRANCHING = 1e-6


@kernel
def choose(jacobian: "np.ndarray", left: "np.ndarray", order: "np.ndarray", most: int) -> int:
    """Find the order of pivots, at most `most` of them; returns the rank.

    left (m, n) is overwritten.
    """
    m, n = jacobian.shape
    largest = 0.0
    for i in range(m):
        order[i] = i
        for j in range(n):
            left[i, j] = jacobian[i, j]
            largest = max(largest, abs(left[i, j]))
    for j in range(n):
        order[m + j] = j
    for k in range(min(m, n, most)):
        row, column = _best_pivot(left, order, k, RANK_TOLERANCE * largest)
        if row < 0:
            return k
        _swap(order, k, row)
        _swap(order, m + k, m + column)
        _clear_below(left, order, k)
    return min(m, n, most)


@kernel
def _swap(order: "np.ndarray", a: int, b: int) -> None:
    kept = order[a]
    order[a] = order[b]
    order[b] = kept


@kernel
def _best_pivot(left: "np.ndarray", order: "np.ndarray", k: int, smallest: float) -> tuple[int, int]:
    """Places in the order of the row and column of the next pivot; -1, -1 when only zeros are left.

    Among the good entries that one whose row and column hold fewest others (Markowitz).
    """
    m, n = left.shape
    largest = 0.0
    for i in range(k, m):
        for j in range(k, n):
            largest = max(largest, abs(left[order[i], order[m + j]]))
    if not largest > smallest:
        return -1, -1
    found_row, found_column, cost = -1, -1, m * n
    for i in range(k, m):
        row = order[i]
        in_row = 0
        for j in range(k, n):
            if left[row, order[m + j]] != 0.0:
                in_row += 1
        for j in range(k, n):
            column = order[m + j]
            if abs(left[row, column]) >= GOOD_ENOUGH * largest:
                in_column = 0
                for other in range(k, m):
                    if left[order[other], column] != 0.0:
                        in_column += 1
                fill = (in_row - 1) * (in_column - 1)
                if fill < cost:
                    found_row, found_column, cost = i, j, fill
    return found_row, found_column


@kernel
def _clear_below(left: "np.ndarray", order: "np.ndarray", k: int) -> None:
    m, n = left.shape
    pivot_row, pivot_column = order[k], order[m + k]
    for i in range(k + 1, m):
        row = order[i]
        if left[row, pivot_column] != 0.0:
            factor = left[row, pivot_column] / left[pivot_row, pivot_column]
            left[row, pivot_column] = 0.0
            for j in range(k + 1, n):
                column = order[m + j]
                if left[pivot_row, column] != 0.0:
                    left[row, column] -= factor * left[pivot_row, column]


@kernel
def factorise(jacobian: "np.ndarray", order: "np.ndarray", rank: int, factors: "np.ndarray") -> float:
    """Factors of the first `rank` rows in the order at hand: factors (m, n), columns in pivot order.

    The leading block (rank, rank) becomes L with unit diagonal below, U above; the columns behind it
    L⁻¹ times those of the free speeds.  Returns the smallest pivot over the largest multiplier, at
    least 1: small where the order is a bad one, 0 where a pivot vanishes.
    """
    m, n = jacobian.shape
    for i in range(rank):
        for j in range(n):
            factors[i, j] = jacobian[order[i], order[m + j]]
    growth, smallest = 1.0, 1e300
    for k in range(rank):
        pivot = factors[k, k]
        if not abs(pivot) > TINY:
            return 0.0
        smallest = min(smallest, abs(pivot))
        for i in range(k + 1, rank):
            if factors[i, k] != 0.0:
                factor = factors[i, k] / pivot
                factors[i, k] = factor
                growth = max(growth, abs(factor))
                for j in range(k + 1, n):
                    if factors[k, j] != 0.0:
                        factors[i, j] -= factor * factors[k, j]
    return smallest / growth


@kernel
def smallest_pivot(factors: "np.ndarray", rank: int) -> float:
    """The smallest pivot of `factorise`, infinite where there are no equations."""
    smallest = math.inf
    for k in range(rank):
        smallest = min(smallest, abs(factors[k, k]))
    return smallest


@kernel
def free_motions(
    factors: "np.ndarray", order: "np.ndarray", rank: int, m: int, motions: "np.ndarray"
) -> None:
    """Fill motions (n, n - rank): its columns span the speeds that the equations leave free."""
    n = factors.shape[1]
    for f in range(n - rank):
        for i in range(n):
            motions[i, f] = 0.0
        motions[order[m + rank + f], f] = 1.0
        for i in range(rank - 1, -1, -1):
            total = -factors[i, rank + f]
            for j in range(i + 1, rank):
                if factors[i, j] != 0.0:
                    total -= factors[i, j] * motions[order[m + j], f]
            motions[order[m + i], f] = total / factors[i, i]


@kernel
def dependent_speeds(
    factors: "np.ndarray", order: "np.ndarray", rank: int, m: int, right_side: "np.ndarray", x: "np.ndarray"
) -> None:
    """Fill x (n,) with a solution of the independent equations whose free speeds are zero.

    right_side (m,) in the order of the equations.
    """
    n = factors.shape[1]
    for j in range(rank, n):
        x[order[m + j]] = 0.0
    for i in range(rank):
        total = right_side[order[i]]
        for j in range(i):
            if factors[i, j] != 0.0:
                total -= factors[i, j] * x[order[m + j]]
        x[order[m + i]] = total
    for i in range(rank - 1, -1, -1):
        total = x[order[m + i]]
        for j in range(i + 1, rank):
            if factors[i, j] != 0.0:
                total -= factors[i, j] * x[order[m + j]]
        x[order[m + i]] = total / factors[i, i]


@kernel
def transposed_solution(factors: "np.ndarray", rank: int, y: "np.ndarray") -> None:
    """Solve Bᵀ x = y in place, y (rank,) in pivot order, B the leading block."""
    for i in range(rank):
        for j in range(i):
            if factors[j, i] != 0.0:
                y[i] -= factors[j, i] * y[j]
        y[i] /= factors[i, i]
    for i in range(rank - 1, -1, -1):
        for j in range(i + 1, rank):
            if factors[j, i] != 0.0:
                y[i] -= factors[j, i] * y[j]


@kernel
def cholesky(matrix: "np.ndarray", size: int, smallest: float) -> int:
    """Overwrite the lower part of matrix (size, size) with its factor; 0 or the 1-based failing row.

    A pivot must exceed `smallest` of its diagonal entry.
    """
    for i in range(size):
        for j in range(i + 1):
            total = matrix[i, j]
            for k in range(j):
                total -= matrix[i, k] * matrix[j, k]
            if i > j:
                matrix[i, j] = total / matrix[j, j]
            elif not total > smallest * abs(matrix[i, i]):
                return i + 1
            else:
                matrix[i, i] = total**0.5
    return 0


@kernel
def cholesky_solve(matrix: "np.ndarray", size: int, y: "np.ndarray") -> None:
    """Solve in place with the factor of `cholesky`."""
    for i in range(size):
        for k in range(i):
            y[i] -= matrix[i, k] * y[k]
        y[i] /= matrix[i, i]
    for i in range(size - 1, -1, -1):
        for k in range(i + 1, size):
            y[i] -= matrix[k, i] * y[k]
        y[i] /= matrix[i, i]
