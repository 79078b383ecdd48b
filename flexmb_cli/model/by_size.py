"""The order in which shares of a combination are reported: largest first, equal ones in the deck's order.

Singular vectors come from LAPACK, whose last digits depend on the processor: what symmetry makes equal must
not be ordered by them.
"""

import numpy as np

SAME_SHARE = 1e-6  # of a share: others as near to it are equal to it


def by_size(size: np.ndarray) -> list[int]:
    """Return the places of `size` (n,), largest first, those equal but for round-off as they stand."""
    order = np.argsort(-size, kind="stable").tolist()
    places, first = [], 0
    while first < len(order):
        last, least = first, (1.0 - SAME_SHARE) * size[order[first]]
        while last < len(order) and size[order[last]] >= least:
            last += 1
        last = max(last, first + 1)  # nan is equal to nothing
        places += sorted(order[first:last])
        first = last
    return places


def first_of_largest(size: np.ndarray) -> int:
    """Return the first place at which `size` (n,) is largest but for round-off."""
    return int(np.argmax(size >= (1.0 - SAME_SHARE) * size.max()))
