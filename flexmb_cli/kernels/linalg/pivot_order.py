"""Order of pivots of a sparse matrix of any rank: threshold pivoting with Markowitz's cost.

Only entries other than zero are kept: a row has its number of entries in `counts`, and their columns and
values at the same places of two arrays, which get wider as rows fill in.

Arrays for J (m, n), in which entries have no unit:

- counts (m,): entries of each row; in_column (n,): entries of each column in rows that have no pivot yet
- columns (m, c), values (m, c): column and value of each entry of a row, c the room of a row
- largest (m,): magnitude of the largest entry of each row
- order (m + n,): rows, then columns, in the order of pivots; places (n,): place of each column in that order
- slots (n,): work, 1 + the place in its row of the entry of each column; zeros outside `subtract_row`

Markowitz, Management Science 3 (1957), pages 255-269; threshold pivoting: Duff, Erisman and Reid, Direct
Methods for Sparse Matrices (1986), sections 5.3 and 5.4.
"""

import numpy as np

from .._jit import allocating, kernel
from .lu import GOOD_ENOUGH

RANK_TOLERANCE = 1e-9  # of the largest entry: what is left below counts as zero


@allocating
def choose(counts: np.ndarray, columns: np.ndarray, values: np.ndarray, order: np.ndarray, most: int) -> int:
    """Fill order (m + n,) with rows, then columns, in the order of pivots, at most `most`; returns the rank.

    For rows of so many entries (m,), none of them 0, at columns (m, c); overwrites them.
    """
    m, n = counts.shape[0], order.shape[0] - counts.shape[0]
    in_column, largest = np.zeros(n, np.int64), np.zeros(m)
    places, slots = np.empty(n, np.int64), np.zeros(n, np.int64)
    for k in range(m + n):
        order[k] = k if k < m else k - m
    for j in range(n):
        places[j] = j
    smallest = 0.0
    for i in range(m):
        for p in range(counts[i]):
            in_column[columns[i, p]] += 1
            largest[i] = max(largest[i], abs(values[i, p]))
        smallest = max(smallest, RANK_TOLERANCE * largest[i])
    for k in range(min(m, n, most)):
        i, j = best_pivot(order, k, smallest, counts, in_column, largest, columns, values, places)
        if i < 0:
            return k
        swap(order, k, i)
        swap(order, m + k, m + j)
        places[order[m + k]], places[order[m + j]] = k, j
        need = widest_after(order, k, counts, columns)
        if need > columns.shape[1]:
            columns, values = wider_columns(columns, counts, need), wider_values(values, counts, need)
        clear_below(order, k, counts, in_column, largest, columns, values, slots)
    return min(m, n, most)


@kernel
def swap(order: np.ndarray, a: int, b: int) -> None:
    """Exchange two places of the order."""
    kept = order[a]
    order[a] = order[b]
    order[b] = kept


@kernel
def best_pivot(
    order: np.ndarray,
    k: int,
    smallest: float,
    counts: np.ndarray,
    in_column: np.ndarray,
    largest: np.ndarray,
    columns: np.ndarray,
    values: np.ndarray,
    places: np.ndarray,
) -> tuple[int, int]:
    """Places in the order of the row and column of the next pivot; -1, -1 when only zeros are left.

    Among the good entries that one whose row and column hold fewest others (Markowitz), the first in order
    of several.
    """
    m, good = counts.shape[0], 0.0
    for i in range(k, m):
        good = max(good, largest[order[i]])
    if not good > smallest:
        return -1, -1
    good *= GOOD_ENOUGH
    found_row, found_column, cost = -1, -1, m * places.shape[0]
    for i in range(k, m):
        row, found, least = order[i], -1, cost
        if largest[row] >= good:
            for p in range(counts[row]):
                fill = (counts[row] - 1) * (in_column[columns[row, p]] - 1)
                if fill <= least and abs(values[row, p]) >= good:
                    j = places[columns[row, p]]
                    if fill < least or -1 < j < found:
                        found, least = j, fill
            if found >= 0:
                found_row, found_column, cost = i, found, least
            if cost == 0:
                break
    return found_row, found_column


@kernel
def widest_after(order: np.ndarray, k: int, counts: np.ndarray, columns: np.ndarray) -> int:
    """Return how many entries a row may have after elimination with pivot k."""
    widest, column = 0, order[counts.shape[0] + k]
    for i in range(k + 1, counts.shape[0]):
        row = order[i]
        for p in range(counts[row]):
            if columns[row, p] == column:
                widest = max(widest, counts[row])
    return widest + counts[order[k]]


@allocating
def wider_columns(columns: np.ndarray, counts: np.ndarray, need: int) -> np.ndarray:
    """Return columns (m, c) with room for `need` entries a row and as many again."""
    wider = np.empty((columns.shape[0], 2 * need), np.int64)
    for i in range(columns.shape[0]):
        for p in range(counts[i]):
            wider[i, p] = columns[i, p]
    return wider


@allocating
def wider_values(values: np.ndarray, counts: np.ndarray, need: int) -> np.ndarray:
    """Return values (m, c) with room for `need` entries a row and as many again."""
    wider = np.empty((values.shape[0], 2 * need))
    for i in range(values.shape[0]):
        for p in range(counts[i]):
            wider[i, p] = values[i, p]
    return wider


@kernel
def clear_below(
    order: np.ndarray,
    k: int,
    counts: np.ndarray,
    in_column: np.ndarray,
    largest: np.ndarray,
    columns: np.ndarray,
    values: np.ndarray,
    slots: np.ndarray,
) -> None:
    """Eliminate the column of pivot k from all rows behind it; slots (n,) are zeros, and left so."""
    pivot, column = order[k], order[counts.shape[0] + k]
    for p in range(counts[pivot]):
        in_column[columns[pivot, p]] -= 1
    for i in range(k + 1, counts.shape[0]):
        row = order[i]
        for p in range(counts[row]):
            if columns[row, p] == column:
                subtract_row(pivot, row, p, counts, in_column, columns, values, slots)
                largest[row] = drop_zeros(row, counts, in_column, columns, values)
                break


@kernel
def subtract_row(
    pivot: int,
    row: int,
    at: int,
    counts: np.ndarray,
    in_column: np.ndarray,
    columns: np.ndarray,
    values: np.ndarray,
    slots: np.ndarray,
) -> None:
    """Take so much of the pivot's row from `row` that its entry `at`, in the pivot's column, vanishes."""
    column, count = columns[row, at], counts[row]
    for p in range(count):
        slots[columns[row, p]] = 1 + p
    first = 0
    while columns[pivot, first] != column:
        first += 1
    factor = values[row, at] / values[pivot, first]
    values[row, at] = 0.0
    for p in range(counts[pivot]):
        j = columns[pivot, p]
        if j != column:
            if slots[j] == 0:
                columns[row, counts[row]], values[row, counts[row]] = j, 0.0
                counts[row] += 1
                in_column[j] += 1
                slots[j] = counts[row]
            values[row, slots[j] - 1] -= factor * values[pivot, p]
    for p in range(counts[row]):
        slots[columns[row, p]] = 0


@kernel
def drop_zeros(
    row: int, counts: np.ndarray, in_column: np.ndarray, columns: np.ndarray, values: np.ndarray
) -> float:
    """Remove the entries of a row that have become zero; returns the largest of the others."""
    kept, largest = 0, 0.0
    for p in range(counts[row]):
        if values[row, p] != 0.0:
            columns[row, kept], values[row, kept] = columns[row, p], values[row, p]
            largest = max(largest, abs(values[row, p]))
            kept += 1
        else:
            in_column[columns[row, p]] -= 1
    counts[row] = kept
    return largest
