"""Elimination without exchange of rows, for matrices whose leading blocks are all positive definite."""

from ._jit import kernel


@kernel
def factorise_plainly(A):
    """Overwrite A (n, n) with its factors; returns whether all pivots are above zero."""
    n = A.shape[0]
    for k in range(n):
        if not A[k, k] > 0.0:
            return False
        for i in range(k + 1, n):
            if A[i, k] != 0.0:
                factor = A[i, k] / A[k, k]
                A[i, k] = factor
                for j in range(k + 1, n):
                    A[i, j] -= factor * A[k, j]
    return True


@kernel
def substitute_plainly(A, x):
    """Replace a right-hand side x (n,) by the solution, A holding the factors."""
    n = A.shape[0]
    for i in range(n):
        x[i] -= row_times(A[i], x, i)
    for i in range(n - 1, -1, -1):
        x[i] = (x[i] - row_times(A[i, i + 1 :], x[i + 1 :], n - 1 - i)) / A[i, i]


@kernel
def row_times(row, x, count):
    """Scalar product over the first `count` places."""
    # Four sums side by side: one alone waits for each addition to end.
    a = b = c = d = 0.0
    whole = count - count % 4
    for j in range(0, whole, 4):
        a += row[j] * x[j]
        b += row[j + 1] * x[j + 1]
        c += row[j + 2] * x[j + 2]
        d += row[j + 3] * x[j + 3]
    for j in range(whole, count):
        a += row[j] * x[j]
    return (a + b) + (c + d)
