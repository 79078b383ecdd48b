"""Copies of vectors by a loop: assignments of slices compile slowly."""

from .._jit import kernel


@kernel
def copy(a, b):
    """Copy a to b."""
    for i in range(a.shape[0]):
        b[i] = a[i]
