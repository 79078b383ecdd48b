"""Angles and strokes that laws prescribe, and springs in joints, against closed forms; many turns."""

import math
from dataclasses import replace

import numpy as np
import pytest

from flexmb_cli.model.flexible_mechanism import FlexibleMechanism, FloatingBody, NodePoint, PointJoint
from flexmb_cli.model.joints import BY_NAME
from flexmb_cli.model.laws import At, spring
from flexmb_cli.model.mechanism import TimeGrid
from flexmb_cli.model.time_functions import Motion, MotionFunction
from flexmb_cli.solvers.constrained.flexible_dynamics import FlexibleDynamics
from tests.dialects.vsdf.mechanisms import DEFAULT, NO_SHAPE

AXIS = np.array([2.0, -1.0, 2.0]) / 3.0
TURNS = MotionFunction(2, (9.0, 1.0, 0.0, 0.0))  # 9 rad/s within 1 s: 2.1 turns after 2 s
SWING = MotionFunction(3, (0.0, 0.4, 3.0, 0.0))
MASS, INERTIA = 2.0, 0.3  # kg, about the centre; a ball


def ball():
    rest = np.zeros(3)
    p = np.array([1.0, 0.0, 0.0, 0.0])
    return FloatingBody("body 1", rest, p, rest, rest, MASS, rest, INERTIA * np.eye(3))


def joint(kind, size=math.nan):
    """A joint with the ground through the ball's centre, along AXIS."""
    side = np.cross(AXIS, [0.0, 0.0, 1.0])
    places = [np.zeros(3), AXIS, side][: 3 if kind in ("translational", "screw") else 2]
    a = tuple(NodePoint(f"ground node {k}", -1, place, NO_SHAPE) for k, place in enumerate(places))
    b = tuple(NodePoint(f"body 1 node {k}", 0, place, NO_SHAPE) for k, place in enumerate(places))
    return PointJoint("joint 1", kind, a, b, size)


def run(kind, *motions, size=math.nan, end=2.0, **parts):
    grid = TimeGrid(0.0, end, 0.1)
    items = [Motion(f"motion {k}", what, 0, function) for k, (what, function) in enumerate(motions, start=1)]
    mechanism = FlexibleMechanism(
        (ball(),), grid, DEFAULT, (0.0,) * 3, (joint(kind, size),), motions=tuple(items), **parts
    )
    (rows,) = FlexibleDynamics(mechanism).rows()
    return rows


def assert_turned(rows, angles):
    p = np.column_stack([np.cos(angles / 2), np.sin(angles / 2)[:, None] * AXIS])
    same = np.sign(np.sum(p * rows.euler_parameters[:, 0], axis=1))
    np.testing.assert_allclose(rows.euler_parameters[:, 0] * same[:, None], p, atol=1e-9)


def values(function, rows):
    return np.array([function.at(t) for t in rows.time]).T


@pytest.mark.parametrize("kind", ["revolute", "cylindrical", "screw"])
def test_a_prescribed_angle_turns_more_than_two_turns(kind):
    rows = run(kind, ("ANGL", TURNS), *([("STRK", SWING)] if kind == "cylindrical" else []), size=0.1)
    angle, rate, second = values(TURNS, rows)
    assert angle[-1] > 4 * math.pi
    assert_turned(rows, angle)
    np.testing.assert_allclose(rows.angular_velocity[:, 0], rate[:, None] * AXIS, atol=1e-8)
    np.testing.assert_allclose(rows.angular_acceleration[:, 0], second[:, None] * AXIS, atol=1e-7)
    pitch = 0.1 if kind == "screw" else 0.0
    effort = (INERTIA + MASS * pitch**2) * second
    np.testing.assert_allclose(rows.driver_effort[:, 0], effort, atol=1e-7)
    if kind == "screw":
        np.testing.assert_allclose(rows.position[:, 0], pitch * angle[:, None] * AXIS, atol=1e-9)


@pytest.mark.parametrize("kind", ["translational", "cylindrical"])
def test_a_prescribed_stroke_slides_along_the_axis(kind):
    rows = run(kind, ("STRK", SWING), *([("ANGL", TURNS)] if kind == "cylindrical" else []))
    stroke, rate, second = values(SWING, rows)
    np.testing.assert_allclose(rows.position[:, 0], stroke[:, None] * AXIS, atol=1e-9)
    np.testing.assert_allclose(rows.velocity[:, 0], rate[:, None] * AXIS, atol=1e-8)
    np.testing.assert_allclose(rows.driver_effort[:, 0], MASS * second, atol=1e-7)
    work = 0.5 * MASS * (rate**2 - rate[0] ** 2)
    if kind == "translational":
        np.testing.assert_allclose(rows.applied_work, work, atol=1e-8)
        np.testing.assert_allclose(rows.applied_power, MASS * second * rate, atol=1e-7)


def test_an_angle_begins_where_its_law_does():
    rows = run("revolute", ("ANGL", MotionFunction(1, (7.0, 1.0, 0.0, 0.0))), end=0.5)
    assert_turned(rows, 7.0 + rows.time)


@pytest.mark.parametrize(("kind", "inertia"), [("revolute", INERTIA), ("translational", MASS)])
def test_a_joint_spring_swings_as_one_freedom_does(kind, inertia):
    """x'' + (c/m) x' + (k/m) (x - x0) = 0 from rest; the angle turns through more than one turn."""
    k, c, x0 = 12.0, 0.3, 9.0
    rows = run(kind, springs=(spring("joint spring 1", At(0, BY_NAME[kind].sprung), k, x0, c),))
    decay, w = 0.5 * c / inertia, math.sqrt(k / inertia - (0.5 * c / inertia) ** 2)
    t = rows.time
    x = x0 - x0 * np.exp(-decay * t) * (np.cos(w * t) + decay / w * np.sin(w * t))
    if kind == "translational":
        np.testing.assert_allclose(rows.position[:, 0], x[:, None] * AXIS, atol=1e-7)
    else:
        assert x.max() > 2 * math.pi
        assert_turned(rows, x)
    np.testing.assert_allclose(rows.total, 0.5 * k * x0**2, rtol=1e-8)


def test_rotations_of_a_body_are_prescribed_about_one_axis():
    function = TURNS
    for about, axis in zip("XYZ", np.eye(3), strict=True):
        motions = [
            Motion(f"motion {w}", f"ROT{w}", 0, function if w == about else MotionFunction(1)) for w in "XYZ"
        ]
        held = [
            Motion(f"motion {w}", f"TRA{w}", 0, SWING if w == about else MotionFunction(1)) for w in "XYZ"
        ]
        mechanism = FlexibleMechanism(
            (ball(),), TimeGrid(0.0, 2.0, 0.1), DEFAULT, (0.0,) * 3, motions=(*motions, *held)
        )
        (rows,) = FlexibleDynamics(mechanism).rows()
        _, rate, second = values(function, rows)
        np.testing.assert_allclose(rows.angular_velocity[:, 0], rate[:, None] * axis, atol=1e-8)
        k = "XYZ".index(about)
        np.testing.assert_allclose(rows.driver_effort[:, k], INERTIA * second, atol=1e-7)
        np.testing.assert_allclose(rows.position[:, 0], values(SWING, rows)[0][:, None] * axis, atol=1e-9)


def test_one_body_cannot_be_turned_about_two_axes_at_once():
    from flexmb_cli.errors import ModelError

    motions = tuple(Motion(f"motion {w}", f"ROT{w}", 0, SWING) for w in "XZ")
    mechanism = FlexibleMechanism((ball(),), TimeGrid(0.0, 1.0, 0.1), DEFAULT, (0.0,) * 3, motions=motions)
    with pytest.raises(ModelError) as failure:
        FlexibleDynamics(replace(mechanism))
    assert "ROTX and ROTZ both turn body 1" in failure.value.faults[0].message
