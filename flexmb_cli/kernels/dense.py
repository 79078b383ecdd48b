"""Dense LU with partial pivoting, written out so that its bits do not depend on the machine.

LAPACK chooses its loops by processor and gives other last digits elsewhere.  A constraint Jacobian
is mostly zeros: among the pivots that are good enough the first in order is taken, which leaves
most zeros standing when simple equations come first, rows without an entry in the pivot's column
are skipped, and substitution visits nonzeros only.
"""

from ._jit import kernel

GOOD_ENOUGH = 0.1  # of the largest entry in the column: bounds the growth, spares the zeros
HUGE = 1e300


@kernel
def pivot_row(matrix, order, k):
    """Place in `order` of the first row whose entry in column k is good enough."""
    n = matrix.shape[0]
    largest = 0.0
    for i in range(k, n):
        largest = max(largest, abs(matrix[order[i], k]))
    for i in range(k, n):
        if abs(matrix[order[i], k]) >= GOOD_ENOUGH * largest:
            return i
    return k


@kernel
def factorise(matrix, order, pattern, smallest, rank):
    """Overwrite matrix (n, n) with its factors; rows are exchanged in `order` (n,) only.

    pattern (n, n + 1) receives the nonzero places.  The columns from `rank` on depend on those
    before: their unknowns become 0.  Returns 0, or the 1-based column before `rank` in which no
    pivot exceeds `smallest` (also for NaN).
    """
    n = matrix.shape[0]
    for k in range(rank):
        pivot = pivot_row(matrix, order, k)
        row = order[pivot]
        order[pivot] = order[k]
        order[k] = row
        if not abs(matrix[row, k]) > smallest:
            return k + 1
        for i in range(k + 1, n):
            below = order[i]
            if matrix[below, k] != 0.0:
                factor = matrix[below, k] / matrix[row, k]
                matrix[below, k] = factor
                for j in range(k + 1, n):
                    matrix[below, j] -= factor * matrix[row, j]
    for k in range(rank, n):
        matrix[order[k], k] = HUGE
    note_nonzeros(matrix, order, pattern)
    return 0


@kernel
def note_nonzeros(matrix, order, pattern):
    """Row i of pattern: where its left places end, where its right places end, then the places."""
    n = matrix.shape[0]
    for i in range(n):
        row = order[i]
        end = 2
        for j in range(n):
            if j == i:
                pattern[i, 0] = end
            elif matrix[row, j] != 0.0:
                pattern[i, end] = j
                end += 1
        pattern[i, 1] = end


@kernel
def substitute(matrix, order, pattern, b, x):
    """Solve with the factors of `factorise`: x (n,) for the right-hand side b (n,)."""
    n = matrix.shape[0]
    for i in range(n):
        row = order[i]
        total = b[row]
        for place in range(2, pattern[i, 0]):
            j = pattern[i, place]
            total -= matrix[row, j] * x[j]
        x[i] = total
    for i in range(n - 1, -1, -1):
        row = order[i]
        total = x[i]
        for place in range(pattern[i, 0], pattern[i, 1]):
            j = pattern[i, place]
            total -= matrix[row, j] * x[j]
        x[i] = total / matrix[row, i]
