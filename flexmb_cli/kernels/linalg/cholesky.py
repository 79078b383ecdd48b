"""Cholesky's factors of small dense matrices, such as the mass matrix of the free motions."""

import numpy as np

from .._jit import kernel, part


@kernel
def cholesky(matrix: np.ndarray, size: int, smallest: float) -> int:
    """Overwrite the lower part of matrix (size, size) with its factor; 0 or the 1-based failing row.

    A pivot must exceed `smallest` of its diagonal entry.
    """
    # Column by column: the divisions of a column wait for none of the others in it.
    for j in range(size):
        left = _left_over(matrix, j, j)
        if not left > smallest * abs(matrix[j, j]):
            return j + 1
        matrix[j, j] = left**0.5
        for i in range(j + 1, size):
            matrix[i, j] = _left_over(matrix, i, j) / matrix[j, j]
    return 0


@part
def _left_over(matrix: np.ndarray, i: int, j: int) -> float:
    """Return entry i, j less what the columns before j account for."""
    left = matrix[i, j]
    for k in range(j):
        left -= matrix[i, k] * matrix[j, k]
    return left


@kernel
def cholesky_solve(matrix: np.ndarray, size: int, y: np.ndarray) -> None:
    """Replace a right-hand side y (size,) by the solution.

    matrix (size, size): the factor of `cholesky`.
    """
    for i in range(size):
        _forward(matrix, i, y)
    for i in range(size - 1, -1, -1):
        _backward(matrix, size, i, y)


@kernel
def cholesky_solve_rows(matrix: np.ndarray, size: int, rows: np.ndarray) -> None:
    """Solve in place for each of rows (r, size), with the factor of `cholesky` in matrix (size, size).

    All rows together, since the divisions of one wait for each other.
    """
    for i in range(size):
        for row in range(rows.shape[0]):
            _forward(matrix, i, rows[row])
    for i in range(size - 1, -1, -1):
        for row in range(rows.shape[0]):
            _backward(matrix, size, i, rows[row])


@part
def _forward(matrix: np.ndarray, i: int, y: np.ndarray) -> None:
    total = y[i]
    for k in range(i):
        total -= matrix[i, k] * y[k]
    y[i] = total / matrix[i, i]


@part
def _backward(matrix: np.ndarray, size: int, i: int, y: np.ndarray) -> None:
    total = y[i]
    for k in range(i + 1, size):
        total -= matrix[k, i] * y[k]
    y[i] = total / matrix[i, i]
