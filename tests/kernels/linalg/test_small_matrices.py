"""Elimination in kernels against numpy's linear algebra."""

import numpy as np
import pytest

from flexmb_cli.kernels.linalg import lu
from flexmb_cli.kernels.linalg import rank_revealing_lu as rows
from flexmb_cli.kernels.linalg.complex_ldl import factorise_symmetric, solve_symmetric
from flexmb_cli.kernels.linalg.row_products import product, subtract_multiple

N = 7


def random_matrices(seed, count=1):
    return np.random.default_rng(seed).normal(size=(count, N, N))


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
    assert rows.cholesky(factors, N, 1e-13) == 0
    np.testing.assert_allclose(factors, np.linalg.cholesky(matrix), rtol=1e-11)
    rows.cholesky_solve(factors, N, x)
    np.testing.assert_allclose(x, np.linalg.solve(matrix, b), rtol=1e-10)
    matrix[3, :] = matrix[:, 3] = matrix[2]
    matrix[3, 3] = matrix[2, 3] = matrix[3, 2] = matrix[2, 2]
    assert rows.cholesky(np.tril(matrix), N, 1e-13) == 4


@pytest.mark.parametrize("seed", range(4))
def test_independent_rows_are_found_and_solved(seed):
    """Five equations of rank 4 for seven speeds; the fifth is a sum of two others."""
    J = random_matrices(seed)[0][:5]
    J[4] = J[0] + 2.0 * J[3]
    m, n, rank = *J.shape, 4
    order, factors, motions = np.zeros(m + n, np.int64), np.zeros((m, n)), np.zeros((n, n))
    assert rows.choose(J, np.zeros((m, n)), order, m) == rank
    assert rows.factorise(J, order, rank, factors) > 0.0
    rows.free_motions(factors, order, rank, m, motions)
    Z = motions[:, : n - rank]
    np.testing.assert_allclose(J @ Z, 0.0, atol=1e-12)
    np.testing.assert_allclose(Z[order[m + rank :]], np.eye(n - rank))
    x = np.full(n, np.nan)
    right_side = J @ np.arange(1.0, n + 1)
    rows.dependent_speeds(factors, order, rank, m, right_side, x)
    np.testing.assert_allclose(J @ x, right_side, rtol=1e-10)
    assert not x[order[m + rank :]].any()
    B = J[np.ix_(order[:rank], order[m : m + rank])]
    y = np.arange(1.0, rank + 1)
    rows.transposed_solution(factors, rank, y)
    np.testing.assert_allclose(B.T @ y, np.arange(1.0, rank + 1), rtol=1e-10)
    pivots = np.abs(np.diag(np.linalg.qr(B)[1]))
    assert np.prod(np.abs(np.diag(factors[:rank]))) == pytest.approx(np.prod(pivots), rel=1e-10)


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
