"""Order of pivots of a large sparse matrix of any rank, in time and memory of its number of entries.

Markowitz's cost as in `pivot_order`, looked for in the few shortest rows (Zlatev, SIAM Journal on Numerical
Analysis 17 (1980), pages 18-30), and pivots good enough for their row.  Entries count as they stand in the
rows, those that are 0 at this position among them: the order serves all positions.

Arrays for J (m, n), in which entries have no unit:

- counts (m,): entries of each row; columns (m, c), values (m, c): column and value of each, c the room of a
  row, which gets wider as rows fill in
- largest (m,): magnitude of the largest entry of each row, -1 of rows that have had their pivot
- in_column (n,): entries of each column in rows without pivot; rows (n, h): all rows that have or had one,
  as many as held (n,) says
- first (n + 1,), following (m,), before (m,): chains of the rows of so many entries, -1 at the ends
- slots (n,): work, 1 + the place in its row of the entry of each column; zeros outside `_subtract`
"""

import numpy as np

from .._jit import allocating, kernel
from .lu import GOOD_ENOUGH
from .pivot_order import RANK_TOLERANCE

ROWS_LOOKED_AT = 4  # rows that are looked at for a pivot
NO_CHAIN = -2  # `before` of a row that is in none


@allocating
def choose_by_rows(jacobian: np.ndarray, columns: np.ndarray, order: np.ndarray, most: int) -> int:
    """As `choose_local`, for entries jacobian (m, c) at columns (m, 1 + c), whose number comes first.

    order (m + n,)
    """
    m, c = jacobian.shape
    counts, places, values = np.empty(m, np.int64), np.empty((m, c), np.int64), np.empty((m, c))
    for i in range(m):
        counts[i] = columns[i, 0]
        for p in range(counts[i]):
            places[i, p], values[i, p] = columns[i, 1 + p], jacobian[i, p]
    return choose_local(counts, places, values, order, most)


@allocating
def choose_local(
    counts: np.ndarray, columns: np.ndarray, values: np.ndarray, order: np.ndarray, most: int
) -> int:
    """Fill order (m + n,) with rows, then columns, in the order of pivots, at most `most`; returns the rank.

    For rows of so many entries (m,) at columns (m, c); overwrites them.
    """
    m, n = counts.shape[0], order.shape[0] - counts.shape[0]
    largest, in_column, held = np.empty(m), np.zeros(n, np.int64), np.zeros(n, np.int64)
    first, slots = np.full(n + 1, -1, np.int64), np.zeros(n, np.int64)
    following, before = np.full(m, -1, np.int64), np.full(m, NO_CHAIN, np.int64)
    _measure(counts, columns, values, largest, in_column)
    rows = np.empty((n, max(1, _most(in_column))), np.int64)
    _hold_rows(counts, columns, held, rows)
    smallest, level, rank = RANK_TOLERANCE * _greatest(largest), np.inf, 0
    while rank < min(m, n, most):
        i, p = _search(first, following, counts, in_column, largest, columns, values, level)
        if i < 0:
            greatest = _greatest(largest)
            if not greatest > smallest:
                break
            level = GOOD_ENOUGH * greatest
            _link_good(level, largest, counts, first, following, before)
            continue
        j = columns[i, p]
        order[rank], order[m + rank] = i, j
        need, room = _need(i, j, counts, columns, largest, held, rows)
        if need > columns.shape[1]:
            columns, values = wider_columns(columns, counts, need), wider_values(values, counts, need)
        if room > rows.shape[1]:
            rows = wider_columns(rows, held, room)
        _unlink(i, counts[i], first, following, before)
        largest[i] = -1.0
        for k in range(held[j]):
            row = rows[j, k]
            if largest[row] >= 0.0:
                _unlink(row, counts[row], first, following, before)
                _subtract(i, p, row, counts, in_column, columns, values, held, rows, slots)
                largest[row] = _largest(values, counts, row)
        _release(i, counts, columns, in_column)
        _link_changed(j, level, held, rows, largest, counts, first, following, before)
        in_column[j] = -1
        rank += 1
    _append_others(order, rank, largest, in_column)
    return rank


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
def _largest(values: np.ndarray, counts: np.ndarray, row: int) -> float:
    largest = 0.0
    for p in range(counts[row]):
        largest = max(largest, abs(values[row, p]))
    return largest


@kernel
def _greatest(largest: np.ndarray) -> float:
    greatest = 0.0
    for i in range(largest.shape[0]):
        greatest = max(greatest, largest[i])
    return greatest


@kernel
def _most(counts: np.ndarray) -> int:
    most = 0
    for i in range(counts.shape[0]):
        most = max(most, counts[i])
    return most


@kernel
def _link(row: int, count: int, first: np.ndarray, following: np.ndarray, before: np.ndarray) -> None:
    """Put a row at the head of the chain of rows of so many entries."""
    following[row], before[row] = first[count], -1
    if first[count] >= 0:
        before[first[count]] = row
    first[count] = row


@kernel
def _measure(
    counts: np.ndarray, columns: np.ndarray, values: np.ndarray, largest: np.ndarray, in_column: np.ndarray
) -> None:
    """Fill largest (m,), and count the entries of the columns in zeros in_column (n,)."""
    for i in range(counts.shape[0]):
        largest[i] = _largest(values, counts, i)
        for p in range(counts[i]):
            in_column[columns[i, p]] += 1


@kernel
def _release(row: int, counts: np.ndarray, columns: np.ndarray, in_column: np.ndarray) -> None:
    """Count the entries of a row no longer."""
    for p in range(counts[row]):
        in_column[columns[row, p]] -= 1


@kernel
def _hold_rows(counts: np.ndarray, columns: np.ndarray, held: np.ndarray, rows: np.ndarray) -> None:
    """Fill rows (n, h) with the rows of each column, `held` (n,) of them."""
    for i in range(counts.shape[0]):
        for p in range(counts[i]):
            j = columns[i, p]
            rows[j, held[j]] = i
            held[j] += 1


@kernel
def _link_good(
    level: float,
    largest: np.ndarray,
    counts: np.ndarray,
    first: np.ndarray,
    following: np.ndarray,
    before: np.ndarray,
) -> None:
    """Put the rows with an entry as large as `level` into chains."""
    for row in range(counts.shape[0]):
        if before[row] == NO_CHAIN and largest[row] >= level:
            _link(row, counts[row], first, following, before)


@kernel
def _link_changed(
    column: int,
    level: float,
    held: np.ndarray,
    rows: np.ndarray,
    largest: np.ndarray,
    counts: np.ndarray,
    first: np.ndarray,
    following: np.ndarray,
    before: np.ndarray,
) -> None:
    """As `_link_good`, of the rows that had an entry in a column."""
    for k in range(held[column]):
        if before[rows[column, k]] == NO_CHAIN and largest[rows[column, k]] >= level:
            _link(rows[column, k], counts[rows[column, k]], first, following, before)


@kernel
def _unlink(row: int, count: int, first: np.ndarray, following: np.ndarray, before: np.ndarray) -> None:
    """Take a row out of its chain, if it is in one."""
    if before[row] == NO_CHAIN:
        return
    if before[row] >= 0:
        following[before[row]] = following[row]
    else:
        first[count] = following[row]
    if following[row] >= 0:
        before[following[row]] = before[row]
    before[row] = NO_CHAIN


@kernel
def _search(
    first: np.ndarray,
    following: np.ndarray,
    counts: np.ndarray,
    in_column: np.ndarray,
    largest: np.ndarray,
    columns: np.ndarray,
    values: np.ndarray,
    level: float,
) -> tuple[int, int]:
    """Row of the next pivot and its place in the row, -1 where no entry is as large as `level`."""
    row_of_pivot, place, cost, size, looked = -1, -1, counts.shape[0] * in_column.shape[0], 0.0, 0
    for count in range(1, first.shape[0]):
        row = first[count]
        while row >= 0:
            least = max(level, GOOD_ENOUGH * largest[row])
            for p in range(count):
                value, fill = abs(values[row, p]), (count - 1) * (in_column[columns[row, p]] - 1)
                if value >= least and (fill < cost or (fill == cost and value > size)):
                    row_of_pivot, place, cost, size = row, p, fill, value
            looked += 1
            if looked == ROWS_LOOKED_AT or cost == 0:
                return row_of_pivot, place
            row = following[row]
    return row_of_pivot, place


@kernel
def _need(
    pivot: int,
    column: int,
    counts: np.ndarray,
    columns: np.ndarray,
    largest: np.ndarray,
    held: np.ndarray,
    rows: np.ndarray,
) -> tuple[int, int]:
    """Return how many entries a row, and how many rows a column may have after this pivot."""
    widest = most = changed = 0
    for k in range(held[column]):
        if largest[rows[column, k]] >= 0.0:
            widest = max(widest, counts[rows[column, k]])
            changed += 1
    for p in range(counts[pivot]):
        most = max(most, held[columns[pivot, p]])
    return widest + counts[pivot], most + changed


@kernel
def _subtract(
    pivot: int,
    at: int,
    row: int,
    counts: np.ndarray,
    in_column: np.ndarray,
    columns: np.ndarray,
    values: np.ndarray,
    held: np.ndarray,
    rows: np.ndarray,
    slots: np.ndarray,
) -> None:
    """Take so much of the pivot's row, whose pivot is at place `at`, from `row` that its entry vanishes."""
    column = columns[pivot, at]
    for p in range(counts[row]):
        slots[columns[row, p]] = 1 + p
    own = slots[column] - 1
    factor = values[row, own] / values[pivot, at]
    for p in range(counts[pivot]):
        j = columns[pivot, p]
        if slots[j] == 0:
            columns[row, counts[row]], values[row, counts[row]] = j, 0.0
            counts[row] += 1
            slots[j] = counts[row]
            in_column[j] += 1
            rows[j, held[j]] = row
            held[j] += 1
        values[row, slots[j] - 1] -= factor * values[pivot, p]
    for p in range(counts[row]):
        slots[columns[row, p]] = 0
    last = counts[row] - 1
    columns[row, own], values[row, own] = columns[row, last], values[row, last]
    counts[row] = last


@kernel
def _append_others(order: np.ndarray, rank: int, largest: np.ndarray, in_column: np.ndarray) -> None:
    """Put rows and columns without a pivot behind those that have one, as they stand."""
    m, row, column = largest.shape[0], rank, rank
    for i in range(m):
        if largest[i] >= 0.0:
            order[row] = i
            row += 1
    for j in range(in_column.shape[0]):
        if in_column[j] >= 0:
            order[m + column] = j
            column += 1
