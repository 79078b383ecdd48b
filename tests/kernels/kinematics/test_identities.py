"""Identities between Euler parameters, rotation matrices and vectors hold for the kernels of rotation.

Liang Yong, YOUNG dissertation (1996), chapter 3.  Its list (3.34) is scrambled in print (dots, and
the signs on a⁺ and a⁻); with (3.32) and (3.33) it reads

    Gᵀ a = a⁺ p,   Lᵀ a = a⁻ p,   and the same for the derivatives of G, L and p;
    Ȧ a = 2 G a⁻ ṗ,   Ä a = 2 Ġ L̇ᵀ a + 2 G̈ Lᵀ a.

(3.35) prints dω/dt for ω on its left side.
"""

import numpy as np
import pytest

from flexmb_cli.kernels.linalg.rotation import add_rotation_row, rotate, rotation_matrices, rotation_rates
from flexmb_cli.model.vectors import rotation_matrix
from flexmb_cli.solvers.kinematics.rows import rotated, twice_g
from tests.solvers.kinematics.geometry import axes, euler_parameters, unit

SEEDS = range(8)
EXACT = {"rtol": 0.0, "atol": 4e-15}


def G(p):
    """(3.24)."""
    e0, e1, e2, e3 = p
    return np.array([[-e1, e0, -e3, e2], [-e2, e3, e0, -e1], [-e3, -e2, e1, e0]])


def L(p):
    """(3.25)."""
    e0, e1, e2, e3 = p
    return np.array([[-e1, e0, e3, -e2], [-e2, -e3, e0, e1], [-e3, e2, -e1, e0]])


def tilde(a):
    """(3.30)."""
    return np.array([[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]])


def bordered(a, sign):
    """a⁺ (3.32) or a⁻ (3.33)."""
    return np.block([[np.zeros((1, 1)), -a[None]], [a[:, None], sign * tilde(a)]])


@pytest.fixture(params=SEEDS)
def case(request):
    """p, ṗ, p̈ of a unit quadruple that stays one: pᵀṗ = 0, pᵀp̈ = -ṗᵀṗ; and a vector a."""
    random = np.random.default_rng([request.param, 3])
    p, pd, pdd = unit(random.standard_normal(4)), random.standard_normal(4), random.standard_normal(4)
    pd -= (pd @ p) * p
    pdd -= (pdd @ p + pd @ pd) * p
    return p, pd, pdd, random.standard_normal(3)


def kernel_matrices(p, pd):
    """A, dA/dt and the remainder of d²A/dt², of the kernels, for one body."""
    q, qd, out = np.zeros(7), np.zeros(7), np.zeros((3, 1, 3, 3))
    q[3:], qd[3:] = p, pd
    rotation_matrices(q, out[0])
    rotation_rates(q, qd, out[1], out[2])
    return out[:, 0]


def test_the_rotation_matrix_is_g_times_l_transposed(case):
    """(3.26), and its other form (3.16)."""
    p, pd, _, _ = case
    A = kernel_matrices(p, pd)[0]
    assert np.allclose(A, G(p) @ L(p).T, **EXACT)
    assert np.allclose(A, axes(p), **EXACT)
    assert np.allclose(rotation_matrix(p), A, **EXACT)
    assert np.allclose(A @ A.T, np.eye(3), **EXACT)


@pytest.mark.parametrize("seed", SEEDS)
def test_the_rotation_matrix_turns_as_rodrigues_says(seed):
    """(3.7): s = s' cos φ + u (u · s') (1 - cos φ) + u × s' sin φ, with (3.8)."""
    random = np.random.default_rng([seed, 33])
    u, s, phi = unit(random.standard_normal(3)), random.standard_normal(3), random.uniform(-7.0, 7.0)
    expected = s * np.cos(phi) + u * (u @ s) * (1 - np.cos(phi)) + np.cross(u, s) * np.sin(phi)
    A = kernel_matrices(euler_parameters(u, phi), np.zeros(4))
    assert np.allclose(rotate(A[:1], 0, s), expected, **EXACT)


def test_euler_parameters_follow_from_the_diagonal(case):
    """(3.20) to (3.23)."""
    p, pd, _, _ = case
    A = kernel_matrices(p, pd)[0]
    squares = [np.trace(A) + 1.0, *(1.0 + 2.0 * np.diag(A) - np.trace(A))]
    assert np.allclose(np.array(squares) / 4.0, p**2, **EXACT)


def test_the_rates_of_the_rotation_matrix_are_those_of_its_factors(case):
    """(3.27) and (3.28) less its second term, which holds p̈."""
    p, pd, _, _ = case
    _, Ad, remainder = kernel_matrices(p, pd)
    assert np.allclose(Ad, 2.0 * G(pd) @ L(p).T, **EXACT)
    assert np.allclose(Ad, 2.0 * G(p) @ L(pd).T, **EXACT)
    assert np.allclose(remainder, 2.0 * G(pd) @ L(pd).T, rtol=0.0, atol=2e-14)


def test_g_and_l_transposed_times_a_vector_are_bordered_matrices_times_p(case):
    """(3.34), lines 1 to 4, 6 and 7."""
    *all_p, a = case
    for p in all_p:
        assert np.allclose(G(p).T @ a, bordered(a, 1.0) @ p, **EXACT)
        assert np.allclose(L(p).T @ a, bordered(a, -1.0) @ p, **EXACT)


def test_the_rate_of_a_turned_vector_is_twice_g_a_bar_times_p_dot(case):
    """(3.34), line 5; and (4.9): w · 2 G a⁻ is the row of the Jacobian."""
    p, pd, _, a = case
    _, Ad, _ = kernel_matrices(p, pd)
    assert np.allclose(Ad @ a, 2.0 * G(p) @ bordered(a, -1.0) @ pd, **EXACT)
    w, row, q = np.array([0.3, -1.1, 0.7]), np.zeros(14), np.array([0.0, 0.0, 0.0, *p])
    add_rotation_row(q, 0, a, (w[0], w[1], w[2]), row, 3)
    assert np.allclose(row[3:7], w @ (2.0 * G(p) @ bordered(a, -1.0)), **EXACT)
    assert not row[:3].any()
    assert not row[7:].any()


def test_the_second_rate_of_a_turned_vector(case):
    """(3.34), last line, with d²A/dt² = (dω/dt)~ A + ω̃ ω̃ A."""
    p, pd, pdd, a = case
    A, _, remainder = kernel_matrices(p, pd)
    second = remainder @ a + 2.0 * G(pdd) @ L(p).T @ a
    omega, alpha = twice_g(p, pd), twice_g(p, pdd)
    expected = np.cross(alpha, A @ a) + np.cross(omega, np.cross(omega, A @ a))
    assert np.allclose(second, expected, rtol=0.0, atol=1e-13)


def test_angular_velocity_is_twice_g_p_dot(case):
    """(3.35) and (3.37); dA/dt = ω̃ A says the same of the matrices."""
    p, pd, pdd, _ = case
    A, Ad, _ = kernel_matrices(p, pd)
    assert np.allclose(twice_g(p, pd), 2.0 * G(p) @ pd, **EXACT)
    assert np.allclose(twice_g(p, pdd), 2.0 * G(p) @ pdd, **EXACT)
    assert np.allclose(tilde(twice_g(p, pd)) @ A, Ad, **EXACT)


def test_g_times_its_transposed_is_the_unit_matrix_and_g_annuls_p(case):
    p, _, _, _ = case
    for matrix in (G(p), L(p)):
        assert np.allclose(matrix @ matrix.T, np.eye(3), **EXACT)
        assert np.allclose(matrix.T @ matrix, np.eye(4) - np.outer(p, p), **EXACT)
        assert np.allclose(matrix @ p, 0.0, **EXACT)


def test_points_of_interest_use_the_same_quadratic_form(case):
    """G(p) L(r)ᵀ s (3.26), symmetrical in p and r by (3.27)."""
    p, r, _, s = case
    assert np.allclose(rotated(p, r, s), G(p) @ L(r).T @ s, **EXACT)
    assert np.allclose(rotated(p, r, s), rotated(r, p, s), **EXACT)
