"""Elimination of a row of sparse factors: its nonzero places form a chain in order.

The arrays are those of `rank_revealing_lu`: jacobian (m, n), columns (m, 1 + c), factors (m, n) and
entries (m, n + 2).
"""

import numpy as np

from .._jit import kernel

FIRST_ENTRY = 3  # column of `entries` where the places begin


@kernel
def take_row(
    jacobian: np.ndarray,
    columns: "np.ndarray",
    row: int,
    places: "np.ndarray",
    factors: np.ndarray,
    entries: "np.ndarray",
    i: int,
    following: "np.ndarray",
) -> None:
    """Put a row of the Jacobian in row i of the factors.

    places (n,): place of each column in the order of pivots.  following (n + 1,) becomes the chain of the
    row's places in order: that after place j, n behind the last; the first one is following[n].
    """
    n = factors.shape[1]
    factors[i, i] = 0.0
    for p in range(FIRST_ENTRY, entries[i, 2]):
        factors[i, entries[i, p]] = 0.0
    following[n] = n
    for p in range(1, 1 + columns[row, 0]):
        place = places[columns[row, p]]
        factors[i, place] = jacobian[row, columns[row, p]]
        if factors[i, place] != 0.0:
            at = n
            while following[at] < place:
                at = following[at]
            following[place] = following[at]
            following[at] = place


@kernel
def eliminate(
    factors: np.ndarray, entries: "np.ndarray", i: int, end: int, rank: int, following: "np.ndarray"
):
    """Take multiples of the rows before `end` from row i; they stay.  Returns the largest.

    following (n + 1,) is the chain of `take_row`; `rank` columns belong to the leading block.
    """
    n, largest, count = factors.shape[1], 0.0, FIRST_ENTRY
    k = following[n]
    while k < end:
        if factors[i, k] != 0.0:
            factor = factors[i, k] / factors[k, k]
            factors[i, k] = factor
            largest = max(largest, abs(factor))
            entries[i, count] = k
            count += 1
            at = k
            for p in range(entries[k, 0], entries[k, 2]):
                j = entries[k, p]
                factors[i, j] -= factor * factors[k, j]
                while following[at] < j:
                    at = following[at]
                if following[at] != j:
                    following[j] = following[at]
                    following[at] = j
        k = following[k]
    entries[i, 0] = entries[i, 1] = count
    while k < n:
        if factors[i, k] != 0.0 and k != i:
            entries[i, count] = k
            count += 1
            if k < rank:
                entries[i, 1] = count
        k = following[k]
    entries[i, 2] = count
    return largest
