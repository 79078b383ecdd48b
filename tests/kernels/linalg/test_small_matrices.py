"""Elimination in kernels against numpy's linear algebra."""

import numpy as np
import pytest

from flexmb_cli.kernels.linalg import lu
from flexmb_cli.kernels.linalg import rank_revealing_lu as rows
from flexmb_cli.kernels.linalg.cholesky import cholesky, cholesky_solve, cholesky_solve_rows
from flexmb_cli.kernels.linalg.number_rows import product, subtract_multiple
from flexmb_cli.kernels.linalg.pivot_order import choose
from flexmb_cli.kernels.linalg.profile_ldl import factorise_symmetric, solve_symmetric
from flexmb_cli.kernels.linalg.rank_revealing_lu import Factors

N = 7


def random_matrices(seed, count=1):
    return np.random.default_rng(seed).normal(size=(count, N, N))


def blank_factors(m, n):
    return Factors(np.zeros(m * n), np.zeros(m * n, np.int64), np.zeros((m, 4), np.int64), np.zeros(m))


def matrix_of(factors, rank, n):
    """L below the diagonal, U and what stands after it, of the first `rank` rows."""
    found = np.zeros((rank, n))
    for i, (first, _, _, end) in enumerate(factors.ends[:rank]):
        found[i, factors.places[first:end]] = factors.values[first:end]
        found[i, i] = factors.diagonal[i]
    return found


def definite(matrix):
    return matrix @ matrix.T + 0.1 * np.eye(N)


@pytest.mark.parametrize("seed", range(3))
def test_complex_symmetric_matrices_are_solved(seed):
    """M + c D + c² K, as an implicit step of Radau's method has it; c of that method."""
    M, D, K = map(definite, random_matrices(seed, 3))
    c = 0.3 * (2.681082873627752 + 3.050430199247410j) ** -1
    matrix, b = M + c * D + c**2 * K, np.random.default_rng(seed).normal(size=N) + 0.5j
    factors, x = np.tril(matrix), b.copy()
    factorise_symmetric(factors, N)
    solve_symmetric(factors, N, x)
    np.testing.assert_allclose(x, np.linalg.solve(matrix, b), rtol=1e-11)


@pytest.mark.parametrize("seed", range(3))
def test_definite_matrices_are_solved_and_others_named_by_their_row(seed):
    matrix, b = definite(random_matrices(seed)[0]), np.arange(1.0, N + 1)
    factors, x = np.tril(matrix), b.copy()
    assert cholesky(factors, N, 1e-13) == 0
    np.testing.assert_allclose(factors, np.linalg.cholesky(matrix), rtol=1e-11)
    cholesky_solve(factors, N, x)
    np.testing.assert_allclose(x, np.linalg.solve(matrix, b), rtol=1e-10)
    several = np.array([b, b**2, -b])
    cholesky_solve_rows(factors, N, several)
    np.testing.assert_allclose(several.T, np.linalg.solve(matrix, np.array([b, b**2, -b]).T), rtol=1e-10)
    matrix[3, :] = matrix[:, 3] = matrix[2]
    matrix[3, 3] = matrix[2, 3] = matrix[3, 2] = matrix[2, 2]
    assert cholesky(np.tril(matrix), N, 1e-13) == 4


@pytest.mark.parametrize("seed", range(4))
def test_independent_rows_are_found_and_solved(seed):
    """Five equations of rank 4 for seven speeds; the fifth is a sum of two others."""
    J = random_matrices(seed)[0][:5]
    J[4] = J[0] + 2.0 * J[3]
    m, n, rank = *J.shape, 4
    order, factors, motions = np.zeros(m + n, np.int64), blank_factors(m, n), np.zeros((n, n))
    assert choose(J.copy(), order, m) == rank
    columns = np.tile([n, *range(n)], (m, 1))
    assert rows.factorise(J, columns, order, rank, factors) > 0.0
    rows.free_motions(factors, order, rank, motions)
    Z = motions[:, : n - rank]
    np.testing.assert_allclose(J @ Z, 0.0, atol=1e-12)
    np.testing.assert_allclose(Z[order[m + rank :]], np.eye(n - rank))
    x = np.full(n, np.nan)
    right_side = J @ np.arange(1.0, n + 1)
    rows.dependent_speeds(factors, order, rank, right_side, x)
    np.testing.assert_allclose(J @ x, right_side, rtol=1e-10)
    assert not x[order[m + rank :]].any()
    B = J[np.ix_(order[:rank], order[m : m + rank])]
    y = np.arange(1.0, rank + 1)
    rows.transposed_solution(factors, rank, y)
    np.testing.assert_allclose(B.T @ y, np.arange(1.0, rank + 1), rtol=1e-10)
    pivots = np.abs(np.diag(np.linalg.qr(B)[1]))
    assert np.prod(np.abs(factors.diagonal[:rank])) == pytest.approx(np.prod(pivots), rel=1e-10)


def sparse_rows(random, columns, n):
    """Rows with entries in the places of `columns` alone, of which every third is zero all the same."""
    J = np.zeros((len(columns), n))
    for row, places in enumerate(columns[:, 1:]):
        J[row, places] = random.uniform(0.5, 2.0, places.size) * random.choice([-1.0, 0.0, 1.0], places.size)
    return J


def product_of(factors, rank):
    """What elimination has taken apart: L U, the free columns after."""
    lower = np.tril(factors[:rank, :rank], -1) + np.eye(rank)
    return lower @ np.triu(factors[:rank])


@pytest.mark.parametrize("seed", range(6))
def test_factors_of_sparse_rows_hold_nothing_of_other_rows_and_orders(seed):
    """Arrays serve again and again: what an earlier Jacobian and its order left must not be seen."""
    random, m, n = np.random.default_rng(seed), 12, 15
    columns = np.array([[5, *sorted(random.choice(n, 5, replace=False))] for _ in range(m)])
    factors, order = blank_factors(m, n), np.zeros(m + n, np.int64)
    for _ in range(4):
        J = sparse_rows(random, columns, n)
        rank = choose(J.copy(), order, m)
        assert rank == np.linalg.matrix_rank(J)
        compact = np.take_along_axis(J, columns[:, 1:], axis=1)
        assert rows.factorise(compact, columns, order, rank, factors) > 0.0
        wanted = J[np.ix_(order[:rank], order[m:])]
        np.testing.assert_allclose(product_of(matrix_of(factors, rank, n), rank), wanted, atol=1e-13)
        for i in range(rank):
            first, right, behind, end = factors.ends[i]
            assert np.all(factors.values[first:end] != 0.0)
            assert all(factors.places[first:right] < i) and all(factors.places[behind:end] >= rank)
            assert all((i < factors.places[right:behind]) & (factors.places[right:behind] < rank))
        y, x = random.uniform(-1.0, 1.0, rank), np.zeros(n)
        borne = y.copy()
        rows.transposed_solution(factors, rank, borne)
        np.testing.assert_allclose(wanted[:, :rank].T @ borne, y, atol=1e-12)
        rows.dependent_speeds(factors, order, rank, J @ np.ones(n), x)
        np.testing.assert_allclose(J @ x, J @ np.ones(n), atol=1e-12)


def test_a_vanishing_pivot_is_told_and_those_before_it_are_right():
    J = np.array([[2.0, 1.0, 0.0], [4.0, 2.0, 3.0], [0.0, 5.0, 1.0]])
    columns, order, factors = np.tile([3, 0, 1, 2], (3, 1)), np.array([0, 1, 2, 0, 1, 2]), blank_factors(3, 3)
    assert rows.factorise(J, columns, order, 3, factors) == 0.0
    found = matrix_of(factors, 3, 3)
    assert (found[0, 0], found[1, 1], found[1, 0]) == (2.0, 0.0, 2.0)
    J[1, 1] = 3.0
    assert rows.factorise(J, columns, order, 3, factors) > 0.0
    np.testing.assert_allclose(product_of(matrix_of(factors, 3, 3), 3), J, atol=1e-14)


@pytest.mark.parametrize("count", [1, 4, 9])
def test_products_of_rows(count):
    a, b = np.random.default_rng(count).normal(size=(2, count))
    assert product(a, b) == pytest.approx(a @ b, rel=1e-13)
    out = b.copy()
    subtract_multiple(0.3, a, out)
    np.testing.assert_allclose(out, b - 0.3 * a, rtol=1e-15)


@pytest.mark.parametrize("seed", range(3))
def test_sparse_general_matrices_are_solved_in_the_order_of_their_pivots(seed):
    random = np.random.default_rng(seed)
    matrix = np.where(random.random((N, N)) < 0.5, 0.0, random_matrices(seed)[0]) + 3.0 * np.roll(
        np.eye(N), 2, 1
    )
    order, pattern = np.arange(N), np.zeros((N, N + 1), np.int64)
    factors, b, x = matrix.copy(), random.normal(size=N), np.empty(N)
    assert lu.factorise(factors, order, pattern, 1e-12, N) in (-1, 1)
    lu.substitute(factors, order, pattern, b, x)
    np.testing.assert_allclose(x, np.linalg.solve(matrix, b), rtol=1e-10)
