"""Tables, ramps, smooth steps, sums and products: against SciPy and against their definitions."""

import math

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.interpolate import CubicSpline

from flexmb_cli.kernels.constrained.time_functions import function_values
from flexmb_cli.model.arrays.function_table import FunctionTable
from flexmb_cli.model.piecewise_polynomials import linear_table, polynomial, smooth_step, spline_table
from flexmb_cli.model.time_functions import (
    SINE,
    MotionFunction,
    integral_of,
    piecewise,
    product_of,
    smoothness,
    sum_of,
)

POINTS = (0.0, 0.4, 0.9, 1.6, 2.0, 2.7), (0.5, -0.2, 0.3, 1.1, 0.4, 0.9)
SINUS = MotionFunction(SINE, (0.2, 1.5, 3.0, 0.4))
CUBE = piecewise(polynomial((1.0, -2.0, 0.0, 0.5)))


def test_a_spline_is_scipys_not_a_knot_spline():
    function, wanted = piecewise(spline_table(*POINTS)), CubicSpline(*POINTS, bc_type="not-a-knot")
    for t in np.linspace(0.0, 2.7, 31)[:-1]:
        assert function.at(t) == pytest.approx([float(wanted(t, n)) for n in range(3)], abs=1e-12)


@pytest.mark.parametrize("count", [2, 3])
def test_a_spline_of_few_points_is_a_line_or_a_parabola(count):
    times, values = POINTS[0][:count], POINTS[1][:count]
    function, wanted = piecewise(spline_table(times, values)), np.polyfit(times, values, count - 1)
    assert [function.at(t)[0] for t in (0.1, 0.3, 0.8)] == pytest.approx(np.polyval(wanted, (0.1, 0.3, 0.8)))


def test_a_linear_table_keeps_its_first_and_last_value_outside():
    function = piecewise(linear_table(*POINTS))
    assert function.at(-5.0) == (0.5, 0.0, 0.0)
    assert function.at(9.0) == (0.9, 0.0, 0.0)
    assert [function.at(t)[0] for t in (0.1, 1.0, 2.5)] == pytest.approx(np.interp((0.1, 1.0, 2.5), *POINTS))


def test_a_smooth_step_begins_and_ends_without_rate_and_acceleration():
    function = piecewise(smooth_step(1.0, -2.0, 3.0, 4.0))
    assert function.at(1.0) == pytest.approx((-2.0, 0.0, 0.0))
    assert function.at(3.0 - 1e-12) == pytest.approx((4.0, 0.0, 0.0), abs=1e-10)
    assert function.at(2.0) == pytest.approx((1.0, 15.0 / 8.0 * 3.0, 0.0))
    assert (function.at(0.0)[0], function.at(7.0)[0]) == (-2.0, 4.0)


def test_smoothness_tells_what_a_driver_may_follow():
    assert smoothness(piecewise(linear_table(*POINTS))) == 0
    assert smoothness(piecewise(spline_table(*POINTS))) == 2
    assert smoothness(piecewise(smooth_step(0.0, 0.0, 1.0, 1.0))) == 2


def test_a_product_has_the_derivatives_of_its_factors_by_leibniz():
    t = 0.7
    f, fd, fdd = 1.0 - 2.0 * t + 0.5 * t**3, -2.0 + 1.5 * t * t, 3.0 * t
    phase = 3.0 * t + 0.4
    g, gd, gdd = 0.2 + 1.5 * math.sin(phase), 4.5 * math.cos(phase), -13.5 * math.sin(phase)
    wanted = (f * g, fd * g + f * gd, fdd * g + 2 * fd * gd + f * gdd)
    assert product_of([CUBE, SINUS]).at(t) == pytest.approx(wanted)
    both = product_of([sum_of([CUBE, SINUS]), SINUS]).at(t)[0]
    assert both == pytest.approx((f + g) * g)


@pytest.mark.parametrize(
    "function",
    [CUBE, SINUS, piecewise(linear_table(*POINTS)), piecewise(smooth_step(0.5, 1.0, 2.0, 3.0)),
     sum_of([SINUS, piecewise(spline_table(*POINTS))])],
    ids=["polynomial", "sine", "table", "step", "sum"],
)  # fmt: skip
def test_an_integral_is_that_of_quadrature(function):
    found = integral_of(function, 0.3)
    for t in (-0.5, 0.3, 1.2, 3.5):
        wanted = quad(
            lambda x: function.at(x)[0], 0.3, t, points=(0.4, 0.5, 0.9, 1.6, 2.0, 2.7), epsabs=1e-12
        )[0]
        assert found.at(t)[0] == pytest.approx(wanted, abs=1e-10)
        assert found.at(t)[1] == pytest.approx(function.at(t)[0], abs=1e-12)


def test_kernels_follow_the_laws_of_the_model():
    """The two are written apart: one walks arrays of knots, the other tuples of pieces."""
    table, functions = FunctionTable(), [
        CUBE, SINUS, piecewise(linear_table(*POINTS)), piecewise(spline_table(*POINTS)),
        product_of([sum_of([CUBE, SINUS]), piecewise(smooth_step(0.5, 1.0, 2.0, 3.0))]),
    ]  # fmt: skip
    numbers = [table.function(function) for function in functions]
    arrays = table.function_arrays()
    for function, number in zip(functions, numbers, strict=True):
        for t in (-1.0, 0.0, 0.4, 0.77, 2.0, 2.69, 5.0):
            assert function_values(arrays["functions"], arrays["knots"], number, t) == pytest.approx(
                function.at(t), abs=1e-13
            )
