"""Copies of vectors by a loop: assignments of slices compile slowly."""

import numpy as np

from .._jit import kernel


@kernel
def copy(a: np.ndarray, b: np.ndarray) -> None:
    """Copy a (n,) to the first n places of b (k,)."""
    for i in range(a.shape[0]):
        b[i] = a[i]
