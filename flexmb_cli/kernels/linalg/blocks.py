"""Parts of a row of numbers, seen as matrices."""

from typing import TYPE_CHECKING

from .._jit import built_in

if TYPE_CHECKING:
    import numpy as np


@built_in
def block(flat: "np.ndarray", first: int, shape: "tuple[int, ...]"):
    """Return the numbers of flat (k,) from `first` on as an array of this shape, a view."""
    size = 1
    for length in shape:
        size *= length
    return flat[first : first + size].reshape(shape)
