"""Elimination of a row of sparse factors: its nonzero places form a chain in order.

jacobian (m, c), columns (m, 1 + c) and the factors are those of `rank_revealing_lu`.  whole (n,) is the row
that is worked on, in the order of pivots; zeros between two rows.
"""

from typing import NamedTuple

import numpy as np

from .._jit import kernel

# Columns of `Factors.ends`.
BELOW_PIVOT, ABOVE_PIVOT, BEHIND_BLOCK, ROW_END = 0, 1, 2, 3


class Factors(NamedTuple):
    """Rows of L and U, one after the other, without their zeros."""

    values: np.ndarray  # (m n,) entries, scaled: left of the pivot, right of it, behind the leading block
    places: np.ndarray  # (m n,) their places in the order of pivots
    ends: np.ndarray  # (m, 4) places where the parts of a row begin, and ROW_END
    diagonal: np.ndarray  # (m,) pivots, scaled


@kernel
def take_row(
    jacobian: np.ndarray,
    columns: np.ndarray,
    row: int,
    places: np.ndarray,
    whole: np.ndarray,
    following: np.ndarray,
) -> None:
    """Spread a row of the Jacobian over `whole`.

    places (n,): place of each column in the order of pivots.  following (n + 1,) becomes the chain of the
    row's places in order: that after place j, n behind the last; the first one is following[n].
    """
    n = whole.shape[0]
    following[n] = n
    for p in range(columns[row, 0]):
        place = places[columns[row, 1 + p]]
        whole[place] = jacobian[row, p]
        if whole[place] != 0.0:
            at = n
            while following[at] < place:
                at = following[at]
            following[place] = following[at]
            following[at] = place


@kernel
def eliminate(
    factors: Factors, i: int, end: int, rank: int, whole: np.ndarray, following: np.ndarray, count: int
) -> tuple[float, int]:
    """Take multiples of the rows before `end` from `whole`, and store it as row i, from place `count` on.

    following (n + 1,) is the chain of `take_row`; `rank` columns belong to the leading block.  Returns the
    largest multiplier, and where the row ends.
    """
    values, places, ends, diagonal = factors.values, factors.places, factors.ends, factors.diagonal
    n, largest = whole.shape[0], 0.0
    ends[i, BELOW_PIVOT] = count
    k = following[n]
    while k < end:
        if whole[k] != 0.0:
            factor = whole[k] / diagonal[k]
            values[count], places[count] = factor, k
            largest = max(largest, abs(factor))
            count += 1
            at = k
            for p in range(ends[k, ABOVE_PIVOT], ends[k, ROW_END]):
                j = places[p]
                whole[j] -= factor * values[p]
                while following[at] < j:
                    at = following[at]
                if following[at] != j:
                    following[j] = following[at]
                    following[at] = j
        whole[k] = 0.0
        k = following[k]
    ends[i, ABOVE_PIVOT] = ends[i, BEHIND_BLOCK] = count
    diagonal[i] = whole[i]
    while k < n:
        if whole[k] != 0.0 and k != i:
            values[count], places[count] = whole[k], k
            count += 1
            if k < rank:
                ends[i, BEHIND_BLOCK] = count
        whole[k] = 0.0
        k = following[k]
    ends[i, ROW_END] = count
    return largest, count
