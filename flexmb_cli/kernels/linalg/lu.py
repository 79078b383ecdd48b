"""Dense LU with partial pivoting, written out so that its bits do not depend on the machine.

LAPACK chooses its loops by processor and gives other last digits elsewhere.  A constraint Jacobian
is mostly zeros: among the pivots that are good enough the first in order is taken, which leaves
most zeros standing when simple equations come first, and elimination and substitution visit
nonzeros only.
"""

import numpy as np

from .._jit import kernel

GOOD_ENOUGH = 0.1  # of the largest entry: may be a pivot, and the one that spares most zeros is


@kernel
def pivot_row(matrix: np.ndarray, order: np.ndarray, k: int) -> int:
    """Return the place in order (n,), from k on, of the first row whose entry in column k is good enough.

    matrix (n, n): what is left of it after k pivots; good enough is GOOD_ENOUGH of the largest entry.
    """
    n = matrix.shape[0]
    largest = 0.0
    for i in range(k, n):
        largest = max(largest, abs(matrix[order[i], k]))
    for i in range(k, n):
        if abs(matrix[order[i], k]) >= GOOD_ENOUGH * largest:
            return i
    return k


@kernel
def factorise(matrix: np.ndarray, order: np.ndarray, pattern: np.ndarray, smallest: float, rank: int) -> int:
    """Overwrite matrix (n, n) with its factors, pivots by their reciprocals.

    Rows are exchanged in `order` (n,) only.  pattern (n, n + 1) receives the nonzero places of every
    row: where those left of the diagonal end, where those right of it end, then the places.  The
    columns from `rank` on depend on those before: their unknowns become 0.  Returns the sign of the
    determinant of the first `rank` pivots, 0 where a column has no pivot above `smallest` (also for
    NaN).
    """
    n = matrix.shape[0]
    sign = 1
    for row in range(n):
        pattern[row, 0] = 2
    for k in range(rank):
        pivot = pivot_row(matrix, order, k)
        row = order[pivot]
        order[pivot] = order[k]
        order[k] = row
        if not abs(matrix[row, k]) > smallest:
            return 0
        if (pivot != k) != (matrix[row, k] < 0.0):
            sign = -sign
        matrix[row, k] = 1.0 / matrix[row, k]
        note_right(matrix, pattern, row, k)
        for i in range(k + 1, n):
            if matrix[order[i], k] != 0.0:
                eliminate(matrix, pattern, row, order[i], k)
    for k in range(rank, n):
        row = order[k]
        matrix[row, k] = 0.0
        pattern[row, 1] = pattern[row, 0]
    return sign


@kernel
def note_right(matrix: np.ndarray, pattern: np.ndarray, row: int, k: int) -> None:
    """Note in pattern (n, n + 1) the nonzero places of a pivot row of matrix (n, n) right of its pivot in
    column k.
    """
    end = pattern[row, 0]
    for j in range(k + 1, matrix.shape[0]):
        if matrix[row, j] != 0.0:
            pattern[row, end] = j
            end += 1
    pattern[row, 1] = end


@kernel
def eliminate(matrix: np.ndarray, pattern: np.ndarray, row: int, below: int, k: int) -> None:
    """Take a multiple of the pivot row from the row `below` of matrix (n, n); the multiple stays in column k.

    pattern (n, n + 1) as in `factorise`; `row` and `below` are rows of the matrix, not places in the order.
    """
    factor = matrix[below, k] * matrix[row, k]
    matrix[below, k] = factor
    pattern[below, pattern[below, 0]] = k
    pattern[below, 0] += 1
    for place in range(pattern[row, 0], pattern[row, 1]):
        j = pattern[row, place]
        matrix[below, j] -= factor * matrix[row, j]


@kernel
def substitute(
    matrix: np.ndarray, order: np.ndarray, pattern: np.ndarray, b: np.ndarray, x: np.ndarray
) -> None:
    """Solve with the factors of `factorise`: fill x (n,) for the right-hand side b (n,).

    matrix (n, n), order (n,) and pattern (n, n + 1) are as `factorise` leaves them.
    """
    n = matrix.shape[0]
    for i in range(n):
        row = order[i]
        total = b[row]
        for place in range(2, pattern[row, 0]):
            j = pattern[row, place]
            total -= matrix[row, j] * x[j]
        x[i] = total
    for i in range(n - 1, -1, -1):
        row = order[i]
        total = x[i]
        for place in range(pattern[row, 0], pattern[row, 1]):
            j = pattern[row, place]
            total -= matrix[row, j] * x[j]
        x[i] = total * matrix[row, i]
