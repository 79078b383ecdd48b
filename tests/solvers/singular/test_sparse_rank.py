"""Rank, free motions and corrections of sparse matrices against singular values and numpy's least squares."""

import numpy as np
import pytest
from scipy.sparse import csr_matrix, diags

from flexmb_cli.model.joints import Equation
from flexmb_cli.solvers.projection import shortest_correction
from flexmb_cli.solvers.singular.sparse_rank import order_of_pivots, sparse_conditioning, sparse_mobility


def matrix_of(seed, m=30, n=40, repeated=3):
    """Random rows of five entries; the last ones are sums of two others."""
    random = np.random.default_rng(seed)
    J = np.zeros((m, n))
    for row in J:
        row[random.choice(n, 5, replace=False)] = random.normal(size=5)
    for k in range(repeated):
        J[-1 - k] = J[2 * k] - 2.0 * J[2 * k + 1]
    return J


def names_of(J):
    return tuple(Equation(f"joint {k + 1}", "x", None, 1.0) for k in range(len(J)))


@pytest.mark.parametrize("seed", range(3))
def test_null_vectors_and_dependencies_are_those_of_the_matrix(seed):
    J = matrix_of(seed)
    rank = np.linalg.matrix_rank(J)
    order, found = order_of_pivots(csr_matrix(J))
    assert found == rank == 27
    mobility = sparse_mobility(csr_matrix(J), order, found, names_of(J), str)
    assert (mobility.dofs, len(mobility.redundant)) == (40 - rank, 3)
    np.testing.assert_allclose(J @ mobility.motions.T, 0.0, atol=1e-10)
    assert np.linalg.matrix_rank(mobility.motions) == 40 - rank
    for motion, names, own in zip(mobility.motions, mobility.free, mobility.pivots, strict=True):
        shown = np.abs(motion[[int(name) for name in names]])
        assert np.all(shown[:-1] >= shown[1:] * (1 - 1e-5)) and str(own) in names
    for group in mobility.redundant:
        rows = [int(equation.owner.split()[1]) - 1 for equation in group]
        assert np.linalg.matrix_rank(J[rows]) == len(rows) - 1
        assert all(np.linalg.matrix_rank(np.delete(J[rows], k, 0)) == len(rows) - 1 for k in range(len(rows)))


@pytest.mark.parametrize("shape", [(30, 40), (30, 30), (40, 30)])
def test_the_condition_is_that_of_singular_values(shape):
    J = matrix_of(7, *shape, repeated=0)
    left, values, right = np.linalg.svd(J)
    weak = sparse_conditioning(csr_matrix(J))
    assert weak.condition == pytest.approx(values[0] / values[-1], rel=1e-3)
    assert abs(weak.motion @ right[len(values) - 1]) == pytest.approx(1.0, abs=1e-6)
    assert abs(weak.combination @ left[:, len(values) - 1]) == pytest.approx(1.0, abs=1e-6)


def test_the_condition_of_independent_rows_leaves_others_out():
    J = matrix_of(1)
    order, rank = order_of_pivots(csr_matrix(J))
    rows = np.sort(order[:rank])
    values = np.linalg.svd(J[rows], compute_uv=False)
    weak = sparse_conditioning(csr_matrix(J), rows)
    assert weak.condition == pytest.approx(values[0] / values[-1], rel=1e-3)
    assert not weak.combination[order[rank : len(J)]].any()


def test_the_shortest_correction_is_that_of_least_squares():
    """Three equations repeat others, which the right-hand side fits."""
    J = matrix_of(2)
    gap = J @ np.linspace(-1.0, 1.0, J.shape[1])
    np.testing.assert_allclose(
        shortest_correction(csr_matrix(J), gap), np.linalg.pinv(J, 1e-9) @ gap, atol=1e-9
    )


def test_weights_decide_what_a_correction_moves():
    """With W = R², x = R⁻¹ y for the shortest y with (J R⁻¹) y = gap."""
    J, roots = matrix_of(3), np.geomspace(1e-3, 1.0, 40)
    gap = J @ np.ones(40)
    wanted = np.linalg.pinv(J / roots, 1e-9) @ gap / roots
    np.testing.assert_allclose(shortest_correction(csr_matrix(J), gap, diags(roots**2)), wanted, atol=1e-7)
