"""Motions stepped without an error: steady turns and prescribed ones."""

from dataclasses import replace

import numpy as np
import pytest

from flexmb_cli.model.flexible_mechanism import FlexibleMechanism
from flexmb_cli.model.integrators import Integrator
from flexmb_cli.model.mechanism import TimeGrid
from flexmb_cli.model.time_functions import Motion, MotionFunction
from flexmb_cli.solvers.constrained.flexible_dynamics import FlexibleDynamics
from tests.dialects.vsdf.test_drivers import AXIS, INERTIA, ball, joint

SPEED = 10.0  # rad/s
TOLERANCE = 1e-8
RADAU, CHOSEN, LONG = (
    Integrator("RAD5", 0.0, TOLERANCE),
    Integrator("GALF", 0.0, 1e-6, 0.9),
    Integrator("GALF", 0.7, 1e-6, 0.9),
)


def rows_of(method, end, omega=0.0, function=None):
    """The ball, spinning freely about AXIS or turned about it by the function, rows every 0.05 s."""
    spinning = replace(ball(), omega=omega * AXIS)
    joints, motions = (), ()
    if function:
        joints, motions = (joint("revolute"),), (Motion("motion 1", "ANGL", 0, function),)
    grid = TimeGrid(0.0, end, 0.05)
    mechanism = FlexibleMechanism((spinning,), grid, method, (0.0,) * 3, joints, motions=motions)
    (rows,) = FlexibleDynamics(mechanism).rows()
    return rows


def assert_turns_steadily(rows):
    half = 0.5 * SPEED * rows.time
    p = np.column_stack([np.cos(half), np.sin(half)[:, None] * AXIS])
    found = rows.euler_parameters[:, 0]
    same = np.sign(np.sum(p * found, axis=1))[:, None]
    np.testing.assert_allclose(found * same, p, rtol=0, atol=TOLERANCE)
    np.testing.assert_allclose(
        rows.angular_velocity[:, 0], np.tile(SPEED * AXIS, (len(p), 1)), rtol=0, atol=SPEED * TOLERANCE
    )


@pytest.mark.parametrize("method", [RADAU, CHOSEN, LONG], ids=["RAD5", "GALF chosen", "GALF 7 rad"])
def test_rows_of_a_free_steady_turn_are_exact_between_the_ends_of_steps(method):
    """A ball has no reason to change its spin, so no step has an error, whatever its length."""
    assert_turns_steadily(rows_of(method, 1.5, omega=SPEED))


@pytest.mark.parametrize("method", [RADAU, CHOSEN], ids=["RAD5", "GALF"])
def test_rows_of_a_driven_steady_turn_meet_the_constraints_to_round_off(method):
    rows = rows_of(method, 1.5, function=MotionFunction(1, (0.0, SPEED, 0.0, 0.0)))
    assert_turns_steadily(rows)
    assert rows.constraint_residual.max() < 1e-14


@pytest.mark.long_motion
def test_the_work_of_a_driver_is_the_change_of_energy():
    """½ J θ̇² for θ = 0.5 sin 60 t; positions and speeds are prescribed, and have no error of their own."""
    rows = rows_of(RADAU, 0.2, function=MotionFunction(3, (0.0, 0.5, 60.0, 0.0)))
    rate = 30.0 * np.cos(60.0 * rows.time)
    work = 0.5 * INERTIA * (rate**2 - rate[0] ** 2)
    np.testing.assert_allclose(rows.applied_work, work, rtol=0, atol=10.0 * TOLERANCE * np.ptp(work))
