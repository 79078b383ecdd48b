"""Elimination with a complex symmetric matrix, M + c D + c² K with real M, D, K that are nowhere negative.

For c right of the imaginary axis no pivot vanishes and no search for pivots is needed: x* M x, c x* D x and
c² x* K x lie in one half of the plane for every x, so no leading block is singular.
"""

from typing import TYPE_CHECKING

from .._jit import kernel

if TYPE_CHECKING:
    import numpy as np


@kernel
def factorise_symmetric(matrix: "np.ndarray", size: int) -> None:
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
def solve_symmetric(matrix: "np.ndarray", size: int, y: "np.ndarray") -> None:
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
