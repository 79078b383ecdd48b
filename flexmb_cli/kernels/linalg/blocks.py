"""Parts of a row of numbers, seen as matrices."""

import numpy as np

from .._jit import built_in


@built_in
def block(flat: np.ndarray, first: int, shape: tuple[int, ...]):
    """Return the numbers of flat (k,) from `first` on as an array of this shape, a view."""
    size = 1
    for length in shape:
        size *= length
    return flat[first : first + size].reshape(shape)
