"""Least squares by Levenberg and Marquardt, on the problems of Moré, Garbow and Hillstrom.

Testing unconstrained optimization software, ACM TOMS 7 (1981), section 3, which prints starts and minima.
"""

import numpy as np
import pytest

from flexmb_cli.solvers.assembly import damped_step, least_squares


def rosenbrock(x):
    """(1)"""
    return np.array([10.0 * (x[1] - x[0] ** 2), 1.0 - x[0]])


def rosenbrock_slope(x):
    return np.array([[-20.0 * x[0], 10.0], [-1.0, 0.0]])


def freudenstein(x):
    """(2)"""
    a = -13.0 + x[0] + ((5.0 - x[1]) * x[1] - 2.0) * x[1]
    b = -29.0 + x[0] + ((x[1] + 1.0) * x[1] - 14.0) * x[1]
    return np.array([a, b])


def freudenstein_slope(x):
    y = x[1]
    return np.array([[1.0, 10.0 * y - 3.0 * y**2 - 2.0], [1.0, 3.0 * y**2 + 2.0 * y - 14.0]])


def powell(x):
    """(13): the Jacobian is singular at the minimum."""
    a, b, c, d = x
    return np.array([a + 10 * b, np.sqrt(5.0) * (c - d), (b - 2 * c) ** 2, np.sqrt(10.0) * (a - d) ** 2])


def powell_slope(x):
    a, b, c, d = x
    last = 2.0 * np.sqrt(10.0) * (a - d)
    return np.array(
        [
            [1.0, 10.0, 0.0, 0.0],
            [0.0, 0.0, np.sqrt(5.0), -np.sqrt(5.0)],
            [0.0, 2.0 * (b - 2.0 * c), -4.0 * (b - 2.0 * c), 0.0],
            [last, 0.0, 0.0, -last],
        ]
    )


PROBLEMS = [
    pytest.param(rosenbrock, rosenbrock_slope, (-1.2, 1.0), 0.0, (1.0, 1.0), 1e-12, id="Rosenbrock"),
    pytest.param(
        freudenstein, freudenstein_slope, (0.5, -2.0), 48.9842, (11.41, -0.8968), 1e-2, id="Freudenstein-Roth"
    ),
    pytest.param(powell, powell_slope, (3.0, -1.0, 0.0, 1.0), 0.0, (0, 0, 0, 0), 1e-3, id="Powell singular"),
]


@pytest.mark.parametrize("residual, slope, start, least, minimiser, digits", PROBLEMS)
def test_the_printed_minimum_is_found(residual, slope, start, least, minimiser, digits):
    x, r = least_squares(residual, slope, np.array(start))
    assert r @ r == pytest.approx(least, rel=2e-6, abs=1e-12)
    assert x == pytest.approx(np.array(minimiser), abs=digits)
    assert r == pytest.approx(residual(x), abs=0.0)


def test_repeated_equations_are_met_to_round_off():
    """x² + y² = 1 and x = y, each twice: (1, 1)/√2."""

    def residual(x):
        circle, line = x @ x - 1.0, x[0] - x[1]
        return np.array([circle, line, circle, line])

    def slope(x):
        return np.array([2.0 * x, [1.0, -1.0], 2.0 * x, [1.0, -1.0]])

    x, r = least_squares(residual, slope, np.array([2.0, 0.3]))
    assert x == pytest.approx(np.full(2, np.sqrt(0.5)), abs=1e-14)
    assert np.max(np.abs(r)) < 1e-14


def test_the_damped_step_solves_the_damped_normal_equations():
    generator = np.random.default_rng(7)
    J, r = generator.normal(size=(5, 3)), generator.normal(size=5)
    step = damped_step(J, r, 0.2)
    assert (J.T @ J + 0.2 * np.eye(3)) @ step == pytest.approx(-J.T @ r, abs=1e-14)
