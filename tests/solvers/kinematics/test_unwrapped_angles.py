"""Turns of any number, either way, at any report step: the motion is the continuous one.

Expected: closed forms of the planar four-bar and slider-crank (linkages.py), of Cardan's joint, and
of a body turned about an axis.
"""

import numpy as np
import pytest

from flexmb_cli.model.mechanism import Body, Driver, Joint, Mechanism, Simplified, TimeGrid
from tests.solvers.kinematics.geometry import axes, euler_parameters
from tests.solvers.kinematics.linkages import (
    AT_REST,
    GROUND,
    FourBar,
    SliderCrank,
    Z,
    crank_held,
    turned_about_z,
)
from tests.solvers.kinematics.solved import rows_of_deck, solved

CRANK_ROCKER = FourBar(4.0, 1.0, 3.5, 3.0)


def angle_of(function, t):
    C, B, A = function
    return C + B * t + 0.5 * A * t * t


@pytest.mark.long_motion
@pytest.mark.parametrize("function", [(0.3, 1.0, 0.0), (0.3, -2.0, 0.0), (0.0, 9.0, -3.0), (-0.7, 0.0, 1.7)])
@pytest.mark.parametrize("step", [0.01, 0.5, 2.0 * np.pi, 11.0])
def test_a_crank_rocker_follows_its_closed_form_at_any_step(function, step):
    """Steps of a hundredth of a turn, of exactly one turn and of many, with reversal at t = 3 s."""
    rows = solved(CRANK_ROCKER.mechanism(function, TimeGrid(0.0, 22.0, step)))
    expected = CRANK_ROCKER.rocker_end(angle_of(function, rows.time))
    assert np.max(np.abs(rows.position[:, 3, :2] - expected)) <= 1e-13


@pytest.mark.parametrize("C", [0.0, 1.0, np.pi, 4.0, -np.pi, 2.0 * np.pi, -9.0, 3.0 * np.pi, 100.0, -1e4])
@pytest.mark.parametrize("estimate", [None, (1.0, 0.0, 0.0, 0.0), (-0.6, 0.0, 0.0, 0.8)])
def test_a_driver_starts_at_any_angle_whatever_the_estimate(C, estimate):
    mechanism = CRANK_ROCKER.mechanism((C, 2.0, 0.0), TimeGrid(0.0, 5.0, 0.5))
    bodies = list(mechanism.bodies)
    if estimate:
        bodies[1] = Body("body 2", (0.0, 0.0, 0.0), estimate)
    rows = solved(Mechanism(**{**vars(mechanism), "bodies": tuple(bodies)}))
    expected = CRANK_ROCKER.rocker_end(C + 2.0 * rows.time)
    assert np.max(np.abs(rows.position[:, 3, :2] - expected)) <= 1e-13


@pytest.mark.long_motion
@pytest.mark.parametrize("direction", [4, 5, 6])
def test_the_euler_parameters_of_a_driven_body_are_those_of_half_its_angle(direction):
    """e0 = cos θ/2, e_k = sin θ/2 (dissertation, eq. (3.8)) through 80 turns and back again.

    1e-12: half an ulp of the 1000 rad that the law reaches.
    """
    axis = np.eye(3)[direction - 4]
    held = [k for k in range(1, 7) if k != direction]
    mechanism = Mechanism(
        (Body("body 1", (0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0)),),
        TimeGrid(-10.0, 30.0, 0.8),
        simplified=tuple(Simplified(f"simplified {k}", 0, k, 0.0) for k in held),
        drivers=(Driver("driver 1", 0, direction, 5.0, 100.0, -10.0),),
    )
    rows = solved(mechanism)
    expected = np.stack([euler_parameters(axis, angle_of((5.0, 100.0, -10.0), t)) for t in rows.time])
    assert np.max(np.abs(rows.euler_parameters[:, 0] - expected)) <= 1e-12
    assert np.max(np.abs(rows.angular_velocity[:, 0] - np.outer(100.0 - 10.0 * rows.time, axis))) <= 1e-12
    assert np.max(np.abs(rows.angular_acceleration[:, 0] + 10.0 * axis)) <= 1e-11


def test_several_bodies_are_driven_at_once():
    """A five-bar: two cranks at different rates, the point between their couplers where two circles meet."""
    rows = solved(five_bar(TimeGrid(0.0, 7.0, 0.35)))
    a = np.stack([np.cos(2.0 * rows.time), np.sin(2.0 * rows.time)], -1)
    phi = 0.4 - 3.0 * rows.time
    b = np.stack([3.0 + 0.8 * np.cos(phi), 0.8 * np.sin(phi)], -1)
    gap = b - a
    half, across = 0.5 * gap, np.stack([-gap[:, 1], gap[:, 0]], -1)
    square = np.sum(gap**2, axis=1)
    expected = a + half + across * np.sqrt(3.0**2 / square - 0.25)[:, None]
    assert np.max(np.abs(rows.position[:, 4, :2] - expected)) <= 1e-13


def five_bar(time):
    """Cranks 2 and 3 at (0, 0) and (3, 0); rods 4 and 5, both 3 m long, meet in a revolute joint."""
    a, phi = np.array([1.0, 0.0]), 0.4
    b = np.array([3.0 + 0.8 * np.cos(phi), 0.8 * np.sin(phi)])
    gap = b - a
    top = a + 0.5 * gap + np.array([-gap[1], gap[0]]) * np.sqrt(9.0 / (gap @ gap) - 0.25)
    up, down = top - a, b - top
    bodies = (
        GROUND,
        turned_about_z("body 2", 0.0, 0.0, 0.0),
        turned_about_z("body 3", 3.0, 0.0, phi),
        turned_about_z("body 4", *a, np.arctan2(up[1], up[0])),
        turned_about_z("body 5", *top, np.arctan2(down[1], down[0])),
    )
    origin = (0.0, 0.0, 0.0)
    joints = (
        Joint("spherical", "spherical 1", 4, 2, (3.0, 0.0, 0.0), (0.8, 0.0, 0.0)),
        Joint("universal", "universal 1", 1, 3, (1.0, 0.0, 0.0), origin, Z, (0.0, 1.0, 0.0)),
        Joint("revolute", "revolute 1", 3, 4, (3.0, 0.0, 0.0), origin, Z, Z),
    )
    held = (*crank_held(1), *crank_held(2)[1:], Simplified("simplified 11", 2, 1, 3.0))
    drivers = (Driver("driver 1", 1, 6, 0.0, 2.0, 0.0), Driver("driver 2", 2, 6, phi, -3.0, 0.0))
    return Mechanism(bodies, time, joints, held, drivers=drivers, grounds=(AT_REST,))


@pytest.mark.long_motion
@pytest.mark.parametrize("bend", [0.5, 1.2, 1.5])
def test_a_cardan_joint_turns_its_output_as_cardan_says(bend):
    """The cross: the output's arm stays normal to the input's arm and to the output's axis.

    Bent by up to 86 degrees, through a reversal of the input; tan(out) = tan(in) / cos(bend).
    """
    axis = np.array([np.cos(bend), np.sin(bend), 0.0])
    function = (0.0, -2.0, 0.15)
    bodies = (GROUND, turned_about_z("body 2", 0.0, 0.0, 0.0), turned_about_z("body 3", 0.0, 0.0, bend))
    joints = (
        Joint("universal", "universal 1", 1, 2, (0.0,) * 3, (0.0,) * 3, (0.0, 1.0, 0.0), (0.0, 0.0, 2.0)),
        Joint(
            "revolute", "revolute 1", 0, 2, tuple(0.3 * axis), (0.3, 0.0, 0.0), tuple(axis), (1.0, 0.0, 0.0)
        ),
    )
    held = (Simplified("simplified 1", 1, 5, 0.0), Simplified("simplified 2", 1, 6, 0.0))
    drivers = (Driver("driver 1", 1, 4, *function),)
    rows = solved(
        Mechanism(bodies, TimeGrid(0.0, 20.0, 0.9), joints, held, drivers=drivers, grounds=(AT_REST,))
    )
    phi = angle_of(function, rows.time)
    arm = np.stack([0.0 * phi, np.cos(phi), np.sin(phi)], -1)
    expected = np.cross(axis, arm)
    expected /= np.linalg.norm(expected, axis=1)[:, None]
    found = axes(rows.euler_parameters[:, 2])[:, :, 2]
    assert np.max(np.abs(found - expected)) <= 1e-13


@pytest.mark.parametrize("step", [0.05, 0.25 * np.pi, 7.0])
def test_a_slider_crank_passes_its_dead_centres(step):
    """In line at crank angles 0, π, 2π …, which the second step meets exactly."""
    linkage = SliderCrank(1.0, 2.0)
    rows = solved(linkage.mechanism((0.0, 1.0, 0.0), TimeGrid(0.0, 21.0, step)))
    assert np.max(np.abs(rows.position[:, 3, 0] - linkage.slide(rows.time))) <= 1e-13


def test_the_four_bar_takes_six_iterations_a_step_and_115_in_all_at_most():
    """26 rows at 0.1 s; YOUNG needed 4 to 7 a step, with its tolerance of 1e-4."""
    iterations = rows_of_deck("IN4-BAR").newton_iterations
    assert iterations.size == 26
    assert iterations.max() <= 6
    assert iterations.sum() <= 115
