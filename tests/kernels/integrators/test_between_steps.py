"""States inside steps: Hermite's polynomials and the dense output of DOP853 reproduce polynomials exactly."""

import numpy as np
import pytest
from numpy.polynomial import Polynomial

from flexmb_cli.kernels.integrators import sdirk4
from flexmb_cli.kernels.integrators.clock import new_clock
from flexmb_cli.kernels.integrators.dop853 import interpolate, interpolate_slopes, set_dense
from flexmb_cli.kernels.integrators.dop853_table import DENSE_TERMS, STAGE_TIMES
from flexmb_cli.kernels.integrators.hermite import cubic, cubic_slope, quintic
from flexmb_cli.kernels.integrators.sdirk4 import implicit_work
from flexmb_cli.model.arrays.tree_elements import CLOSURE_ROW

INSIDE = (0.0, 0.2, 0.55, 0.9, 1.0)
T, H = 0.4, 0.25  # s: the step


def polynomials(degree, count, seed=1):
    """Random ones in time."""
    return [Polynomial(c) for c in np.random.default_rng(seed).uniform(-1, 1, (count, degree + 1))]


def at(functions, t, order=0):
    return np.array([function.deriv(order)(t) if order else function(t) for function in functions])


@pytest.mark.parametrize("x", INSIDE)
def test_a_cubic_with_its_slopes_is_met(x):
    f = polynomials(3, 1)[0].convert(domain=[0, 1], window=[0, 1])
    ends = f(0.0), f(1.0), f.deriv()(0.0), f.deriv()(1.0)
    assert cubic(x, *ends) == pytest.approx(f(x), rel=1e-13)
    assert cubic_slope(x, *ends) == pytest.approx(f.deriv()(x), rel=1e-12)


@pytest.mark.parametrize("x", INSIDE)
def test_a_quintic_with_its_first_and_second_derivatives_is_met(x):
    f = polynomials(5, 1)[0].convert(domain=[0, 1], window=[0, 1])
    ends = [d(t) for d in (f, f.deriv(), f.deriv(2)) for t in (0.0, 1.0)]
    assert quintic(x, *ends) == pytest.approx((f(x), f.deriv()(x)), rel=1e-12)


@pytest.mark.parametrize("x", INSIDE)
def test_a_row_inside_an_implicit_step_lies_on_the_quintic_of_its_coordinates(x):
    """Speeds are its slope; attitudes, which have no second derivative, lie on a cubic."""
    coordinates, others = polynomials(5, 3), polynomials(3, 4)

    def state(t, order=0):
        return np.concatenate(
            [at(coordinates, t, order + 1), at(coordinates, t, order), at(others, t, order)]
        )

    s = implicit_work(new_clock(), state(T + H), 3, np.zeros(0, CLOSURE_ROW), 0)
    s.old[:], s.old_slope[:], s.before[:] = state(T), state(T, 1), state(T + H, 1)
    found = np.empty(10)
    sdirk4.between(x, H, s, found)
    assert found == pytest.approx(state(T + x * H), rel=1e-12)


@pytest.mark.parametrize("x", INSIDE)
def test_dense_output_of_a_quadrature_is_exact_for_polynomials_of_its_order(x):
    """Hairer, Nørsett and Wanner I, section II.6: the continuous extension has order 7."""
    functions = polynomials(7, 3)
    slopes = np.array([at(functions, T + c * H, 1) for c in STAGE_TIMES])
    dense, found = np.empty((DENSE_TERMS, 3)), np.empty(3)
    set_dense(at(functions, T), at(functions, T + H), slopes, H, dense)
    interpolate(at(functions, T), dense, x, found)
    assert found == pytest.approx(at(functions, T + x * H), rel=1e-12)
    slopes_of_last = np.empty(2)
    interpolate_slopes(dense, x, H, 1, slopes_of_last)
    assert slopes_of_last == pytest.approx(at(functions[1:], T + x * H, 1), rel=1e-11)
