"""Screws over many turns, through θ = π and sin θ = 0, with any points and vectors.

Expected: slide - slide0 = pitch · turn, the definition (YOUNG dissertation (1996), section 4.2.6) with a
signed, continuous angle.  Body 2 hangs on the ground by a screw along z at P_i ≠ 0; h_i and h_j are
neither unit vectors nor normal to the axis.
"""

import numpy as np
import pytest

from flexmb_cli.model.mechanism import Body, Driver, Joint, Mechanism, TimeGrid
from tests.solvers.kinematics.geometry import axes, euler_parameters
from tests.solvers.kinematics.linkages import AT_REST, GROUND, Z
from tests.solvers.kinematics.solved import mechanism_of, solved

P_I, P_J = np.array([0.3, -0.2, 0.5]), np.array([0.2, 0.4, -0.1])
H_I = (2.0, 1.0, 0.7)
START = 0.7  # turn of body 2 about z in its estimate, rad
FUNCTION = (-7.0, 0.3)  # turning rate and half of its growth: 40 rad back, then 800 rad forward in 60 s


def nut(pitch, slide, angle, driver, step, end=60.0, s_j=(0.0, 0.0, -3.0), start=START) -> Mechanism:
    """Body 2 at the slide δ0 = `slide` and the angle θ0 = `angle` from h_i to h_j."""
    p = euler_parameters(Z, start)
    across = np.array([2.0, 1.0, 0.0]) / np.sqrt(5.0)
    h_j = 1.5 * (np.cos(angle) * across + np.sin(angle) * np.cross(Z, across)) + 0.8 * np.array(Z)
    r = P_I + slide * np.array(Z) - axes(p) @ P_J
    h_local = tuple(axes(p).T @ h_j)
    joint = Joint("screw", "screw 1", 0, 1, tuple(P_I), tuple(P_J), (0.0, 0.0, 2.0), s_j, H_I, h_local, pitch)
    function = (start, *FUNCTION[:1], 2.0 * FUNCTION[1]) if driver == "turn" else (float(r[2]), -1.9, 0.22)
    return Mechanism(
        (GROUND, Body("body 2", tuple(map(float, r)), tuple(p))),
        TimeGrid(0.0, end, step),
        (joint,),
        drivers=(Driver("driver 1", 1, 6 if driver == "turn" else 3, *function),),
        grounds=(AT_REST,),
    )


def turn(t):
    return FUNCTION[0] * t + FUNCTION[1] * t * t


@pytest.mark.long_motion
@pytest.mark.parametrize("pitch", [0.5, -0.3, 1e-4, 20.0, 0.0])
@pytest.mark.parametrize("step", [0.1, 6.0 * np.pi / 7.0, 30.0])
def test_the_slide_follows_any_number_of_turns_either_way(pitch, step):
    rows = solved(nut(pitch, 0.4, -2.0, "turn", step))
    expected = rows.position[0, 1, 2] + pitch * turn(rows.time)
    assert np.max(np.abs(rows.position[:, 1, 2] - expected)) <= 1e-14 * (1.0 + 800.0 * abs(pitch))
    expected = pitch * (FUNCTION[0] + 2.0 * FUNCTION[1] * rows.time)
    assert np.max(np.abs(rows.velocity[:, 1, 2] - expected)) <= 1e-12 * (1.0 + abs(pitch))
    assert np.max(np.abs(rows.acceleration[:, 1, 2] - 2.0 * FUNCTION[1] * pitch)) <= 1e-11 * (
        1.0 + abs(pitch)
    )


@pytest.mark.long_motion
@pytest.mark.parametrize("pitch", [0.5, -0.3, 0.02, 20.0])
@pytest.mark.parametrize("step", [0.1, 1.0, 30.0])
def test_the_turn_follows_the_slide(pitch, step):
    """Driven along z: the x axis of the body points where (z - z0) / pitch says, up to 15,000 rad."""
    rows = solved(nut(pitch, 0.4, 1.0, "slide", step))
    angle = START + (-1.9 * rows.time + 0.11 * rows.time**2) / pitch
    found = axes(rows.euler_parameters[:, 1])[:, :, 0]
    expected = np.stack([np.cos(angle), np.sin(angle), 0.0 * angle], -1)
    assert np.max(np.abs(found - expected)) <= 1e-12 * (1.0 + 1.0 / abs(pitch))


@pytest.mark.parametrize("angle", [0.0, 0.5 * np.pi, np.pi, -np.pi, 3.0, -3.0])
def test_the_angle_of_the_estimates_may_be_any(angle):
    """θ0 = 0 and ±π are where the source's formulas divide by sin θ."""
    rows = solved(nut(0.5, 0.4, angle, "turn", 0.25, end=20.0))
    expected = rows.position[0, 1, 2] + 0.5 * turn(rows.time)
    assert np.max(np.abs(rows.position[:, 1, 2] - expected)) <= 1e-13


@pytest.mark.long_motion
@pytest.mark.parametrize("slide", [0.4, 1e-3, -0.4, -1e-3])
def test_the_slide_is_counted_along_the_points_distance_in_the_estimates(slide):
    """δ = |d| in the estimates: for P_j below P_i the slide grows downwards, and it passes δ = 0."""
    rows = solved(nut(0.5, slide, 1.0, "turn", 0.5))
    expected = rows.position[0, 1, 2] + np.sign(slide) * 0.5 * turn(rows.time)
    assert np.max(np.abs(rows.position[:, 1, 2] - expected)) <= 1e-12


@pytest.mark.long_motion
def test_points_that_coincide_in_the_estimates_slide_along_the_axis():
    """δ0 = 0 up to round-off, the natural way to type a screw: the sense is that of s_i."""
    for start in np.linspace(0.0, 3.0, 13):
        rows = solved(nut(0.5, 0.0, 1.0, "turn", 0.5, end=5.0, start=start))
        expected = rows.position[0, 1, 2] + 0.5 * turn(rows.time)
        assert np.max(np.abs(rows.position[:, 1, 2] - expected)) <= 1e-12


@pytest.mark.long_motion
@pytest.mark.parametrize("s_j", [(0.0, 0.0, 3.0), (0.0, 0.0, -3.0)])
def test_a_screw_with_its_bodies_exchanged_moves_the_same(s_j):
    """Seen from the other body d is -d and θ is -θ; about an axis of the other sense θ stays.

    δ is |d| in both, so that the pitch changes its sign with that of θ.
    """
    mechanism = nut(0.5, 0.4, 1.0, "turn", 0.5, s_j=s_j)
    joint = mechanism.joints[0]
    pitch = -joint.pitch if s_j[2] > 0.0 else joint.pitch
    other = Joint(
        "screw", "screw 1", 1, 0, joint.P_j, joint.P_i, joint.s_j, joint.s_i, joint.h_j, joint.h_i, pitch
    )
    rows, exchanged = solved(mechanism), solved(Mechanism(**{**vars(mechanism), "joints": (other,)}))
    assert np.max(np.abs(exchanged.position - rows.position)) <= 1e-12
    assert np.max(np.abs(exchanged.acceleration - rows.acceleration)) <= 1e-10


def test_the_screw_of_the_dissertation_advances_as_its_data_say():
    """IN2-6-1: y = 2 + 0.5 · 1.047 t, where the listing is wrong; dY = 0.5235, ddY = 0."""
    rows = solved(mechanism_of("IN2-6-1"))
    assert np.max(np.abs(rows.position[:, 1, 1] - (2.0 + 0.5235 * rows.time))) <= 1e-14
    assert np.max(np.abs(rows.velocity[:, 1, 1] - 0.5235)) <= 1e-14
    assert np.max(np.abs(rows.acceleration[:, 1, 1])) <= 1e-13
