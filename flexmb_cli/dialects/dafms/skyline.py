"""Skyline storage of a symmetric matrix, as DFIN of DAFMS reads it (thesis of Zhao, 1992, appendix C).

Columns of the upper triangle stand one behind the other, each from its first stored row down to the
diagonal; `addresses` (n,) are those of the diagonals, counted from 1.
"""

from collections.abc import Sequence

import numpy as np


def full_matrix(addresses: Sequence[int], packed: Sequence[float]) -> np.ndarray:
    """The symmetric matrix (n, n) of `packed`; `addresses` must be valid (the reader has checked them)."""
    values = np.asarray(packed, float)
    matrix = np.zeros((len(addresses), len(addresses)))
    before = 0
    for column, address in enumerate(addresses):
        top = column + 1 - (address - before)
        matrix[top : column + 1, column] = values[before:address]
        matrix[column, top : column + 1] = values[before:address]
        before = address
    return matrix


def full_columns(matrix: np.ndarray) -> tuple[list[int], np.ndarray]:
    """Addresses and packed entries of `matrix` (n, n) with every column stored from its first row."""
    n = len(matrix)
    packed = [matrix[: column + 1, column] for column in range(n)]
    return [j * (j + 1) // 2 for j in range(1, n + 1)], np.concatenate(packed)
