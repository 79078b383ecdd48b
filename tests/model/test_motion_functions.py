"""Functions of time: their derivatives by differences, their pieces by their ends."""

import math
import tracemalloc

import numpy as np
import pytest

from flexmb_cli.model.time_functions import MotionFunction, table_function

KNOTS = (0.0, 0.4, 0.9, 1.6, 2.0), (0.5, -0.2, 0.3, 1.1, 0.4)
FUNCTIONS = {
    "polynomial": MotionFunction(1, (0.3, -1.2, 0.7, 0.25)),
    "spin-up": MotionFunction(2, (6.0, 1.5)),
    "sine": MotionFunction(3, (0.1, 0.8, 3.0, 0.4)),
    "table": table_function(*KNOTS),
}


@pytest.mark.parametrize("function", FUNCTIONS.values(), ids=FUNCTIONS)
@pytest.mark.parametrize("t", [0.05, 0.63, 1.2, 1.9, 3.0])
def test_rates_are_the_differences_of_the_values(function, t):
    h = 1e-5
    before, now, after = function.at(t - h), function.at(t), function.at(t + h)
    assert now[1] == pytest.approx((after[0] - before[0]) / (2 * h), abs=1e-8)
    assert now[2] == pytest.approx((after[1] - before[1]) / (2 * h), abs=1e-8)


def test_a_spin_up_turns_half_its_time_less_than_a_steady_spin():
    """psi(T) = w T/2, psi'(T) = w, psi''(T) = 0 from the formula of the spin-up."""
    function = FUNCTIONS["spin-up"]
    assert function.at(0.0) == pytest.approx((0.0, 0.0, 0.0))
    assert function.at(1.5) == pytest.approx((6.0 * 0.75, 6.0, 0.0))
    assert function.at(1.5 - 1e-9) == pytest.approx(function.at(1.5), abs=1e-7)
    assert function.at(0.75)[2] == pytest.approx(8.0)


def test_a_table_passes_its_points_and_ends_straight():
    function = FUNCTIONS["table"]
    for t, value in zip(*KNOTS, strict=True):
        assert function.at(t)[0] == pytest.approx(value)
    assert function.at(0.0)[2] == 0.0
    assert function.at(2.5)[0] == pytest.approx(0.4 + 0.5 * function.at(2.0)[1])
    assert function.at(-1.0)[1] == pytest.approx(function.at(0.0)[1])


def test_a_table_agrees_with_scipys_natural_spline():
    from scipy.interpolate import CubicSpline

    spline = CubicSpline(*KNOTS, bc_type="natural")
    for t in np.linspace(0.0, 2.0, 41):
        wanted = [float(spline(t, n)) for n in range(3)]
        assert FUNCTIONS["table"].at(t) == pytest.approx(wanted, abs=1e-12)


def test_a_table_of_a_megabyte_takes_a_megabyte_of_memory():
    """A full matrix of 40,000 points is 12 GB."""
    times = np.arange(40_000) * 0.1
    tracemalloc.start()
    function = table_function(times, np.sin(times))
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < 20e6
    # A natural spline of sin errs by h^4 times 5/384 at most, away from its ends.
    assert function.at(2000.05)[0] == pytest.approx(math.sin(2000.05), abs=2e-6)


def test_a_table_of_two_points_is_a_line():
    assert table_function((0.0, 2.0), (1.0, 5.0)).at(0.5) == pytest.approx((2.0, 2.0, 0.0))


def test_a_sine_begins_at_its_phase():
    value, rate, _ = MotionFunction(3, (1.0, 2.0, 3.0, math.pi / 2)).at(0.0)
    assert (value, rate) == pytest.approx((3.0, 0.0))
