"""Symmetric matrices of which each row is stored from its diagonal to its last nonzero place.

The profile of a row ends at `ends[i]`, one past that place; what stands below the diagonal and behind
the end is not looked at.  Factors A = U D U' keep the profile when they are made from the last row to
the first: Jennings, Matrix Computation for Engineers and Scientists (1977), section 5.6 on variable
bandwidth, here from the other corner, so that coordinates of the whole tree come first and may
reach far.  No rows are exchanged: for positive definite matrices that is stable.

A (n, n) holds the matrix or its factors in its upper triangle; ends (n,) are integers.

Elimination with a complex symmetric matrix, M + c D + c² K with real M, D, K that are nowhere negative.

For c right of the imaginary axis no pivot vanishes and no search for pivots is needed: x* M x, c x* D x and
c² x* K x lie in one half of the plane for every x, so no leading block is singular.
"""

import numpy as np

from .._jit import kernel
from .number_rows import product, subtract_multiple


@kernel
def factorise_profile(A: np.ndarray, ends: np.ndarray) -> bool:
    """Overwrite A (n, n) with U and D; returns whether all pivots are above zero."""
    for i in range(A.shape[0] - 1, -1, -1):
        for j in range(ends[i] - 1, i, -1):
            end = min(ends[i], ends[j])
            A[i, j] -= product(A[i, j + 1 : end], A[j, j + 1 : end])
        for j in range(i + 1, ends[i]):
            share = A[i, j] / A[j, j]
            A[i, i] -= share * A[i, j]
            A[i, j] = share
        if not A[i, i] > 0.0:
            return False
    return True


@kernel
def substitute_profile(A: np.ndarray, ends: np.ndarray, x: np.ndarray) -> None:
    """Replace a right-hand side x (n,) by the solution, A holding the factors."""
    n = x.shape[0]
    for i in range(n - 1, -1, -1):
        x[i] -= product(A[i, i + 1 : ends[i]], x[i + 1 : ends[i]])
    for i in range(n):
        x[i] /= A[i, i]
    for i in range(n):
        subtract_multiple(x[i], A[i, i + 1 : ends[i]], x[i + 1 : ends[i]])


@kernel
def set_profile_times(A: np.ndarray, ends: np.ndarray, x: np.ndarray, out: np.ndarray) -> None:
    """Fill out (n,) with A x, x (n,)."""
    n = x.shape[0]
    for i in range(n):
        out[i] = 0.0
    for i in range(n):
        out[i] += A[i, i] * x[i] + product(A[i, i + 1 : ends[i]], x[i + 1 : ends[i]])
        subtract_multiple(-x[i], A[i, i + 1 : ends[i]], out[i + 1 : ends[i]])


@kernel
def factorise_symmetric(matrix: np.ndarray, size: int) -> None:
    """Overwrite the lower part of matrix (size, size) with L and D of L D Lᵀ, L with unit diagonal."""
    for j in range(size):
        for k in range(j):
            matrix[j, j] -= matrix[j, k] * matrix[j, k] * matrix[k, k]
        for i in range(j + 1, size):
            total = matrix[i, j]
            for k in range(j):
                total -= matrix[i, k] * matrix[j, k] * matrix[k, k]
            matrix[i, j] = total / matrix[j, j]


@kernel
def solve_symmetric(matrix: np.ndarray, size: int, y: np.ndarray) -> None:
    """Replace a right-hand side y (size,), complex, by the solution.

    matrix (size, size): the factors of `factorise_symmetric`.
    """
    for i in range(size):
        for k in range(i):
            y[i] -= matrix[i, k] * y[k]
    for i in range(size):
        y[i] /= matrix[i, i]
    for i in range(size - 1, -1, -1):
        for k in range(i + 1, size):
            y[i] -= matrix[k, i] * y[k]


@kernel
def factorise_rows(flat: np.ndarray, starts: np.ndarray, ends: np.ndarray) -> None:
    """As `factorise_profile`, of a definite matrix with entry i, j at flat[starts[i] + j].

    flat (k,), starts (n,), ends (n,).
    """
    for i in range(ends.shape[0] - 1, -1, -1):
        row = starts[i]
        for j in range(ends[i] - 1, i, -1):
            end = min(ends[i], ends[j])
            flat[row + j] -= product(flat[row + j + 1 : row + end], flat[starts[j] + j + 1 : starts[j] + end])
        for j in range(i + 1, ends[i]):
            share = flat[row + j] / flat[starts[j] + j]
            flat[row + i] -= share * flat[row + j]
            flat[row + j] = share


@kernel
def substitute_rows(flat: np.ndarray, starts: np.ndarray, ends: np.ndarray, x: np.ndarray) -> None:
    """Replace a right-hand side x (n,) by the solution, by the factors of `factorise_rows`.

    flat (k,), starts (n,), ends (n,).
    """
    n = x.shape[0]
    for i in range(n - 1, -1, -1):
        x[i] -= product(flat[starts[i] + i + 1 : starts[i] + ends[i]], x[i + 1 : ends[i]])
    for i in range(n):
        x[i] /= flat[starts[i] + i]
    for i in range(n):
        subtract_multiple(x[i], flat[starts[i] + i + 1 : starts[i] + ends[i]], x[i + 1 : ends[i]])
