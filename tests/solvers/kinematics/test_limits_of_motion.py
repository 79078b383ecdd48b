"""Where a mechanism locks, is left free, or is driven against its joints; and what it does next to that.

Expected: the reach of each linkage by the triangle inequality, and its closed form up to there.
"""

from dataclasses import replace

import numpy as np
import pytest

from flexmb_cli.errors import AnalysisError, ModelError
from flexmb_cli.model.mechanism import Body, Distance, Driver, Joint, Mechanism, Simplified, TimeGrid
from tests.solvers.kinematics.linkages import AT_REST, GROUND, FourBar, SliderCrank, Z, turned_about_z
from tests.solvers.kinematics.solved import mechanism_of, solved, until_failure

JOINTS = {"spherical 1", "universal 1", "revolute 1", "translational 1", "driver 1"}


@pytest.mark.long_motion
@pytest.mark.parametrize("step", [0.01, 0.25, 2.0, 50.0])
def test_a_crank_that_cannot_turn_fully_stops_the_run_at_the_first_report_time_beyond(step):
    """Ground 4, crank 2, coupler 1.5, rocker 2.2: the crank's end stays within 3.7 m of the rocker's pivot.

    cos φ = (4² + 2² - 3.7²) / (2 · 4 · 2) at the limit; from 0.3 rad at 1 rad/s that is at 0.8654 s.
    """
    linkage = FourBar(4.0, 2.0, 1.5, 2.2)
    locked = np.arccos((16.0 + 4.0 - 3.7**2) / 16.0) - 0.3
    rows, failure = until_failure(linkage.mechanism((0.3, 1.0, 0.0), TimeGrid(0.0, 50.0, step)))
    assert isinstance(failure, AnalysisError)
    assert rows.time.size == int(locked / step) + 1
    assert failure.time == rows.time.size * step
    assert f"at t = {failure.time:.6g} s" in str(failure)
    assert failure.norms["reached"] == pytest.approx(locked, abs=1e-6)
    expected = linkage.rocker_end(0.3 + rows.time)
    assert np.max(np.abs(rows.position[:, 3, :2] - expected)) <= 1e-13


@pytest.mark.long_motion
def test_the_failure_names_the_worst_constraints_and_the_gap_that_remains():
    """Crank and rocker end are drawn 0.077 m apart or less at 1 s, shared among the joints between."""
    linkage = FourBar(4.0, 2.0, 1.5, 2.2)
    _, failure = until_failure(linkage.mechanism((0.3, 1.0, 0.0), TimeGrid(0.0, 50.0, 1.0)))
    named = {name.partition(",")[0] for name in failure.norms["worst"]}
    assert named
    assert named <= JOINTS
    assert all(name in str(failure) for name in named)
    end = 2.0 * np.array([np.cos(1.3), np.sin(1.3)])
    beyond = np.linalg.norm(end - [4.0, 0.0]) - 3.7
    # No joint can be left with more than the whole.
    assert beyond / 20.0 < failure.norms["gap"] < beyond
    assert failure.norms["unit"] == "m"


@pytest.mark.long_motion
@pytest.mark.parametrize("step", [0.1, 2.0])
def test_a_crank_asked_beyond_its_reach_and_back_between_two_rows_fails(step):
    """φ = 0.3 + 2 t - t² passes the limit of 1.165 rad at 0.632 s and is back where it began at 2 s."""
    linkage = FourBar(4.0, 2.0, 1.5, 2.2)
    limit = np.arccos((16.0 + 4.0 - 3.7**2) / 16.0)
    rows, failure = until_failure(linkage.mechanism((0.3, 2.0, -2.0), TimeGrid(0.0, 2.0, step)))
    assert isinstance(failure, AnalysisError)
    assert rows.time[-1] <= 1.0 - np.sqrt(1.0 - (limit - 0.3))


@pytest.mark.long_motion
@pytest.mark.parametrize("step", [0.1, 2.0])
def test_a_slider_asked_beyond_its_reach_and_back_between_two_rows_fails(step):
    """x = 3.42 + 1.6 t - 0.8 t² exceeds crank + rod = 4 m at 0.476 s and is back where it began at 2 s."""
    linkage = SliderCrank(1.0, 3.0)
    start = float(linkage.slide(1.0))
    mechanism = linkage.mechanism((start, 1.6, -0.8), TimeGrid(0.0, 2.0, step), "slider", 1.0)
    rows, failure = until_failure(mechanism)
    assert isinstance(failure, AnalysisError)
    assert rows.time[-1] <= 1.0 - np.sqrt(1.0 - (4.0 - start) / 0.8)


@pytest.mark.parametrize(("part", "step"), [(0.9, 2.0), (0.99, 0.5), (0.999999, 0.01), (0.9999, 2.0)])
def test_a_slider_nearly_at_its_dead_centre_turns_back_with_its_crank(part, step):
    """Driven along x to `part` of the way and back: cos φ = (r² + x² - l²) / (2 r x), sin φ > 0."""
    linkage = SliderCrank(1.0, 3.0)
    start = float(linkage.slide(1.0))
    way = 4.0 * (4.0 - start) * part / 2.0
    function = (start, way, -way)
    rows = solved(linkage.mechanism(function, TimeGrid(0.0, 2.0, step), "slider", 1.0))
    x = start + way * rows.time - 0.5 * way * rows.time**2
    cosine = (x * x - 8.0) / (2.0 * x)
    e0, e3 = rows.euler_parameters[:, 1, 0], rows.euler_parameters[:, 1, 3]
    assert np.max(np.abs(e0**2 - e3**2 - cosine)) <= 1e-11
    assert np.min(e0 * e3) > 0.0


def test_a_coupler_that_can_spin_is_refused_by_name():
    """IN-RSSR whose equation for the rod's spin is spent on the ground body instead."""
    mechanism = mechanism_of("IN-RSSR")
    doubled = replace(mechanism, simplified=(Simplified("simplified 1", 0, 1, 0.0),))
    rows, failure = until_failure(doubled)
    assert rows is None
    assert isinstance(failure, ModelError)
    assert failure.exit_code == 2
    assert "body 3" in str(failure)
    assert "simplified 1" in str(failure)


@pytest.mark.parametrize("axis", [(0.0, 0.1, 1.0), (0.05, 0.0, -1.0)])
def test_a_driven_body_that_its_joint_tilts_is_refused_by_name(axis):
    mechanism = driven_about_z(Joint("revolute", "revolute 1", 0, 1, (0.0,) * 3, (0.0,) * 3, axis, axis))
    rows, failure = until_failure(mechanism)
    assert rows is None
    assert isinstance(failure, ModelError)
    assert failure.exit_code == 2
    assert "body 2" in str(failure)
    assert "driver 1" in str(failure)
    assert "global z axis" in str(failure)


def driven_about_z(joint):
    return Mechanism(
        (GROUND, turned_about_z("body 2", 0.0, 0.0, 0.5)),
        TimeGrid(0.0, 1.0, 0.5),
        (joint,),
        drivers=(Driver("driver 1", 1, 6, 0.5, 1.0, 0.0),),
        grounds=(AT_REST,),
    )


@pytest.mark.parametrize(
    ("function", "unit"), [((0.0, 0.9, 0.0), "0.81 rad/s;"), ((0.0, 0.0, 0.9), "0.81 rad/s²;")]
)
def test_a_driven_body_that_its_joint_begins_to_tilt_is_refused_at_its_only_row(function, unit):
    """The cross of a universal joint holds the body's axis w = (-1, 0.9, 0) square to the ground's z.

    At rest it is. Turned about x by a small θ, w leaves the plane by 0.9 θ, which only a turn about y by
    0.9 θ undoes: |p| = 1 in the first row, but the body turns about y at 0.9 of the driver's rates, 0.9.
    """
    joint = Joint("universal", "universal 1", 0, 1, (0.0,) * 3, (0.0,) * 3, Z, (-1.0, 0.9, 0.0))
    mechanism = replace(
        driven_about_z(joint),
        time=TimeGrid(0.0, 0.0, 1.0),
        bodies=(GROUND, turned_about_z("body 2", 0.0, 0.0, 0.0)),
        simplified=(Simplified("simplified 1", 1, 6, 0.0),),
        drivers=(Driver("driver 1", 1, 4, *function),),
    )
    rows, failure = until_failure(mechanism)
    assert rows is None
    assert isinstance(failure, ModelError)
    assert "driver 1" in str(failure)
    assert "global x axis" in str(failure)
    assert unit in str(failure)
    upright = replace(joint, s_j=(-1.0, 0.0, 0.0))
    assert solved(replace(mechanism, joints=(upright,))).time.size == 1


def test_an_axis_of_the_other_sense_is_no_tilt():
    """Parallel means along one line: opposite directions are allowed."""
    joint = Joint("revolute", "revolute 1", 0, 1, (0.0,) * 3, (0.0,) * 3, Z, (0.0, 0.0, -2.0))
    rows = solved(driven_about_z(joint))
    assert np.max(np.abs(rows.euler_parameters[:, 1, 3] - np.sin(0.25 + 0.5 * rows.time))) <= 1e-15


@pytest.mark.parametrize("step", [0.1, 1.0, 7.0])
def test_equal_euler_parameters_gear_two_bodies_through_half_turns(step):
    """A distance constraint between e3 of two bodies about z; at θ = π two motions cross, θ and 2π - θ.

    The follower goes on as it came.
    """
    origin = (0.0, 0.0, 0.0)
    joints = tuple(
        Joint("revolute", f"revolute {k}", 0, k, (3.0 * (k - 1), 0.0, 0.0), origin, Z, Z) for k in (1, 2)
    )
    mechanism = Mechanism(
        (GROUND, turned_about_z("body 2", 0.0, 0.0, 0.0), turned_about_z("body 3", 3.0, 0.0, 0.0)),
        TimeGrid(0.0, 14.0, step),
        joints,
        distances=(Distance("distance 1", 2, 1, 6, 0.0),),
        drivers=(Driver("driver 1", 1, 6, 0.0, 1.0, 0.0),),
        grounds=(AT_REST,),
    )
    rows = solved(mechanism)
    assert np.max(np.abs(rows.euler_parameters[:, 2] - rows.euler_parameters[:, 1])) <= 1e-12
    assert np.max(np.abs(rows.angular_velocity[:, 2, 2] - 1.0)) <= 1e-10


def sled(speed):
    """Body 2 slides along an oblique axis, its x at speed · t; body 3 turns on it."""
    u = np.array([0.36, 0.47, 0.83]) / np.linalg.norm([0.36, 0.47, 0.83])
    w = np.cross(u, Z)
    joints = (
        Joint("revolute", "revolute 1", 1, 2, (1.0, 0.0, 0.0), (0.0, 0.0, 0.0), Z, Z),
        Joint(
            "translational",
            "translational 1",
            0,
            1,
            (0.1, 0.2, 0.3),
            (0.1, 0.2, 0.3),
            tuple(u),
            tuple(u),
            tuple(w),
            tuple(np.cross(u, w)),
        ),
    )
    drivers = (Driver("driver 1", 1, 1, 0.0, speed, 0.0), Driver("driver 2", 2, 6, 0.0, 1.3, 0.0))
    bodies = (
        GROUND,
        turned_about_z("body 2", 0.0, 0.0, 0.0),
        Body("body 3", (1.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0)),
    )
    return Mechanism(bodies, TimeGrid(0.0, 10.0, 1.0), joints, drivers=drivers, grounds=(AT_REST,)), u


@pytest.mark.parametrize("speed", [10.0, 100.0, 1e4])
def test_a_mechanism_may_go_far_from_where_it_began(speed):
    mechanism, u = sled(speed)
    rows = solved(mechanism)
    expected = np.outer(speed * rows.time / u[0], u) + [1.0, 0.0, 0.0]
    assert np.max(np.abs(rows.position[:, 2] - expected)) <= 1e-14 * (1.0 + 30.0 * speed)


@pytest.mark.long_motion
@pytest.mark.parametrize("scale", [1e-9, 1e-3, 1e6])
def test_the_unit_of_length_does_not_matter(scale):
    linkage = FourBar(4.0 * scale, scale, 3.5 * scale, 3.0 * scale)
    rows = solved(linkage.mechanism((0.3, 5.0, -1.0), TimeGrid(0.0, 20.0, 0.7)))
    expected = linkage.rocker_end(0.3 + 5.0 * rows.time - 0.5 * rows.time**2)
    assert np.max(np.abs(rows.position[:, 3, :2] - expected)) <= 1e-13 * scale


def test_one_row_is_enough():
    assert solved(replace(mechanism_of("IN4-BAR"), time=TimeGrid(0.4, 0.4, 1.0))).time.tolist() == [0.4]
