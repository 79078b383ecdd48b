"""The order of pivots of sparse matrices against a dense elimination written out with numpy."""

import numpy as np
import pytest

from flexmb_cli.kernels.linalg.local_order import choose_local
from flexmb_cli.kernels.linalg.lu import GOOD_ENOUGH
from flexmb_cli.kernels.linalg.pivot_order import RANK_TOLERANCE, choose


def dense_order(J, most):
    """Rows and columns in the order of pivots, and the rank, by looking at every entry before each."""
    left, rows, columns = J.copy(), [*range(len(J))], [*range(J.shape[1])]
    rank, least = 0, RANK_TOLERANCE * np.abs(J).max()
    while rank < min(*J.shape, most):
        rest = left[np.ix_(rows[rank:], columns[rank:])]
        if np.abs(rest).max() <= least:
            break
        held = rest != 0.0
        fill = np.outer(held.sum(axis=1) - 1, held.sum(axis=0) - 1)
        good = np.abs(rest) >= GOOD_ENOUGH * np.abs(rest).max()
        i, j = np.unravel_index(np.argmin(np.where(good, fill, J.size)), fill.shape)
        for order, k in ((rows, rank + i), (columns, rank + j)):
            order[rank], order[k] = order[k], order[rank]
        pivot, column = rows[rank], columns[rank]
        for row in rows[rank + 1 :]:
            factor = left[row, column] / left[pivot, column]
            left[row] -= factor * left[pivot]
            left[row, column] = 0.0
        rank += 1
    return [*rows, *columns], rank


def chained_rows(random, bodies, per_body=6):
    """Rows of joints between neighbours: 12 columns each, half of them zero, some rows repeated."""
    J = np.zeros((5 * bodies, per_body * (bodies + 1)))
    for k in range(bodies):
        block = random.integers(-2, 3, (5, 2 * per_body)) * random.integers(0, 2, (5, 2 * per_body))
        J[5 * k : 5 * k + 5, per_body * k : per_body * (k + 2)] = block
    J[-1] = J[0]
    J[0, 0], J[-1, 0] = 1.0, 1.0
    return J


@pytest.mark.parametrize("seed", range(8))
def test_the_order_is_that_of_dense_elimination(seed):
    """Small integers cancel to zeros, and many costs are equal: every rule for ties is used."""
    J = chained_rows(np.random.default_rng(seed), 7)
    order = np.zeros(sum(J.shape), np.int64)
    for most in (len(J), 9):
        wanted, rank = dense_order(J, most)
        assert choose(J.copy(), order, most) == rank
        assert order.tolist() == wanted
    assert rank == 9 and np.linalg.matrix_rank(J) == dense_order(J, len(J))[1]


@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize("most", [99, 20])
def test_the_local_order_finds_the_rank_and_independent_rows(seed, most):
    """Zeros among the entries count, and the leading block has an inverse that numpy finds."""
    random = np.random.default_rng(seed)
    J = chained_rows(random, 9) + 0.0
    J[-2] = J[1] - 2.0 * J[5]
    columns = np.array(
        [[k for k in range(J.shape[1]) if 6 * (i // 5) <= k < 6 * (i // 5) + 12] for i in range(43)]
    )
    columns = np.vstack([columns, [range(12), range(12)]])[: len(J)]
    J[-2], J[-1] = J[1] - 2.0 * J[3], J[0]
    m, n = J.shape
    order = np.zeros(m + n, np.int64)
    values = np.take_along_axis(J, columns, axis=1)
    assert np.count_nonzero(values) == np.count_nonzero(J)
    rank = choose_local(np.full(m, 12), columns.copy(), values, order, most)
    assert rank == min(most, np.linalg.matrix_rank(J, 1e-9))
    assert sorted(order[:m]) == list(range(m)) and sorted(order[m:]) == list(range(n))
    assert np.linalg.cond(J[np.ix_(order[:rank], order[m : m + rank])]) < 1e5
