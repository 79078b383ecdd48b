"""Products of long rows of numbers, which come as slices: indices from 0 on need no test for a sign."""

from typing import Any

import numpy as np

from .._jit import kernel


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
