"""Cholesky's factors of small dense matrices, such as the mass matrix of the free motions."""

from typing import TYPE_CHECKING

from .._jit import kernel

if TYPE_CHECKING:
    import numpy as np


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
