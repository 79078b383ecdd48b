"""Rows of numbers: copies, parts seen as matrices, and products.

Copies are loops, since assignments of slices compile slowly.  Long rows of products come as slices: indices
from 0 on need no test for a sign.
"""

from typing import Any

import numpy as np

from .._jit import built_in, kernel


@kernel
def copy(a: np.ndarray, b: np.ndarray) -> None:
    """Copy a (n,) to the first n places of b (k,)."""
    for i in range(a.shape[0]):
        b[i] = a[i]


@built_in
def block(flat: np.ndarray, first: int, shape: tuple[int, ...]):
    """Return the numbers of flat (k,) from `first` on as an array of this shape, a view."""
    size = 1
    for length in shape:
        size *= length
    return flat[first : first + size].reshape(shape)


@kernel
def product(a: np.ndarray, b: np.ndarray) -> Any:
    """Return the scalar product of the rows a (n,) and b (n,), in four sums."""
    # Four sums side by side: one alone waits for each addition to end.
    s0 = s1 = s2 = s3 = 0.0
    n = a.shape[0]
    whole = n - n % 4
    for j in range(0, whole, 4):
        s0 += a[j] * b[j]
        s1 += a[j + 1] * b[j + 1]
        s2 += a[j + 2] * b[j + 2]
        s3 += a[j + 3] * b[j + 3]
    for j in range(whole, n):
        s0 += a[j] * b[j]
    return (s0 + s1) + (s2 + s3)


@kernel
def subtract_multiple(factor: float, a: np.ndarray, out: np.ndarray) -> None:
    """Take factor a from out: a (n,), out (n,)."""
    for j in range(a.shape[0]):
        out[j] -= factor * a[j]
