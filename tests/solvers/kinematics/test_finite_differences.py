"""Velocities and accelerations of every deck are the derivatives of its positions.

Every deck is solved at 1201 times over the span of its own run.  Central differences of eighth order
over nine neighbours have a truncation error of (ω h)⁸/630 and a round-off error of about 1e-15/(ω h)ᵏ
for the k-th derivative.  With a driver's ω h = 0.003 … 0.008 and ten times that in the fastest
phases (four-bar) the first stays below 1e-11; round-off is allowed for by itself.
"""

import numpy as np
import pytest

from tests.solvers.kinematics.geometry import Gaps, axes
from tests.solvers.kinematics.solved import DECKS, at_times, coordinates, mechanism_of, rows_of_deck, solved

pytestmark = pytest.mark.long_motion

ROWS = 1201
# Eighth-order central differences (B. Fornberg, Math. Comp. 51 (1988) 699-706, table 1).
FIRST = np.array([1 / 280, -4 / 105, 1 / 5, -4 / 5, 0, 4 / 5, -1 / 5, 4 / 105, -1 / 280])
SECOND = np.array([-1 / 560, 8 / 315, -1 / 5, 8 / 5, -205 / 72, 8 / 5, -1 / 5, 8 / 315, -1 / 560])


@pytest.fixture(scope="module", params=DECKS)
def fine(request):
    """(rows, step) of a deck at a fine step."""
    mechanism = mechanism_of(request.param)
    grid = mechanism.time
    step = (grid.time(grid.rows - 1) - grid.start) / (ROWS - 1)
    return solved(at_times(mechanism, grid.start, step, ROWS)), step


def assert_derivative(found, values, step, order):
    """`found` (T, …) is the derivative of `values`, to 1e-10 of its size and what round-off adds."""
    weights, factor = (FIRST, SECOND)[order - 1], step**-order
    last = len(values) - 8
    expected = sum(w * values[k : k + last] for k, w in enumerate(weights)) * factor
    round_off = 30.0 * np.finfo(float).eps * np.max(np.abs(values)) * factor
    error, size = np.max(np.abs(found[4:-4] - expected)), np.max(np.abs(expected))
    assert float(error) <= float(1e-10 * size + round_off)


def test_velocities_are_derivatives_of_positions(fine):
    rows, step = fine
    assert_derivative(coordinates(rows, 1), coordinates(rows), step, 1)
    if rows.point_position.size:
        assert_derivative(rows.point_velocity, rows.point_position, step, 1)


def test_accelerations_are_second_derivatives_of_positions(fine):
    rows, step = fine
    assert_derivative(coordinates(rows, 2), coordinates(rows), step, 2)
    if rows.point_position.size:
        assert_derivative(rows.point_acceleration, rows.point_position, step, 2)


def test_accelerations_are_derivatives_of_velocities(fine):
    rows, step = fine
    assert_derivative(coordinates(rows, 2), coordinates(rows, 1), step, 1)
    assert_derivative(rows.angular_acceleration, rows.angular_velocity, step, 1)


def test_angular_velocity_belongs_to_the_turning_axes(fine):
    """dA/dt = ω̃ A, column by column: the axes of a body turn with ω."""
    rows, step = fine
    A = axes(rows.euler_parameters)
    turning = np.cross(rows.angular_velocity[..., None, :], np.swapaxes(A, -1, -2))
    assert_derivative(np.swapaxes(turning, -1, -2), A, step, 1)


@pytest.mark.parametrize("deck", DECKS)
def test_constraints_and_their_rates_are_met_at_every_report_time(deck):
    rows, gaps = rows_of_deck(deck), Gaps(mechanism_of(deck))
    assert gaps.largest(coordinates(rows), rows.time) <= 1e-12
    assert gaps.largest_rate(coordinates(rows), coordinates(rows, 1), rows.time) <= 1e-12


def test_the_audit_of_the_run_is_as_small(fine):
    assert np.max(fine[0].constraint_residual) <= 1e-12
    assert np.max(fine[0].velocity_residual) <= 1e-12
