"""Order of pivots of a small matrix of any rank, mostly zeros: threshold pivoting with Markowitz's cost.

Among the good entries that one is the next pivot whose row and column hold fewest others, the first in order
of several.  J (m, n) has entries without a unit; order (m + n,): rows, then columns, in the order of pivots.

Markowitz, Management Science 3 (1957), pages 255-269; threshold pivoting: Duff, Erisman and Reid, Direct
Methods for Sparse Matrices (1986), sections 5.3 and 5.4.
"""

import numpy as np

from .._jit import allocating, kernel
from .lu import GOOD_ENOUGH

RANK_TOLERANCE = 1e-9  # of the largest entry: what is left below counts as zero


@allocating
def choose(J: np.ndarray, order: np.ndarray, most: int) -> int:
    """Fill order (m + n,) with rows, then columns, in the order of pivots, at most `most`; returns the rank.

    Overwrites J (m, n).
    """
    m, n = J.shape
    in_row, in_column = np.empty(m, np.int64), np.empty(n, np.int64)
    for k in range(m + n):
        order[k] = k if k < m else k - m
    smallest = 0.0
    for k in range(min(m, n, most)):
        largest = _count_entries(J, order, k, in_row, in_column)
        if k == 0:
            smallest = RANK_TOLERANCE * largest
        if not largest > smallest:
            return k
        i, j = _best_pivot(J, order, k, GOOD_ENOUGH * largest, in_row, in_column)
        _exchange(order, k, i)
        _exchange(order, m + k, m + j)
        _clear_below(J, order, k)
    return min(m, n, most)


@kernel
def _exchange(order: np.ndarray, a: int, b: int) -> None:
    first = order[a]
    order[a] = order[b]
    order[b] = first


@kernel
def _count_entries(
    J: np.ndarray, order: np.ndarray, k: int, in_row: np.ndarray, in_column: np.ndarray
) -> float:
    """Count the entries other than 0 of rows and columns behind k pivots; returns the largest magnitude."""
    (m, n), largest = J.shape, 0.0
    in_row[:] = 0
    in_column[:] = 0
    for i in range(k, m):
        for j in range(k, n):
            value = J[order[i], order[m + j]]
            if value != 0.0:
                in_row[i] += 1
                in_column[j] += 1
                largest = max(largest, abs(value))
    return largest


@kernel
def _best_pivot(
    J: np.ndarray, order: np.ndarray, k: int, good: float, in_row: np.ndarray, in_column: np.ndarray
) -> tuple[int, int]:
    """Places in the order of the row and column of the next pivot, whose magnitude is `good` at least."""
    (m, n), row, column = J.shape, k, k
    cost = m * n
    for i in range(k, m):
        for j in range(k, n):
            fill = (in_row[i] - 1) * (in_column[j] - 1)
            if fill < cost and abs(J[order[i], order[m + j]]) >= good:
                row, column, cost = i, j, fill
    return row, column


@kernel
def _clear_below(J: np.ndarray, order: np.ndarray, k: int) -> None:
    """Eliminate the column of pivot k from all rows behind it."""
    (m, n), pivot = J.shape, order[k]
    column = order[m + k]
    for i in range(k + 1, m):
        row = order[i]
        if J[row, column] != 0.0:
            factor = J[row, column] / J[pivot, column]
            J[row, column] = 0.0
            for j in range(k + 1, n):
                J[row, order[m + j]] -= factor * J[pivot, order[m + j]]
