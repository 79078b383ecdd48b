"""Ground and simplified constraints on angles: each holds e1, e2 or e3 at sin(value/2), by itself.

Half turns are the trap: e0 = 0 there, and the normalisation has no slope in e0.  Expected: e_k =
sin(value/2) (YOUNG dissertation (1996), section 4.2.7) and |p| = 1.
"""

import numpy as np
import pytest

from flexmb_cli.model.mechanism import Body, Driver, Ground, Joint, Mechanism, Simplified, TimeGrid
from tests.solvers.kinematics.geometry import axes, unit
from tests.solvers.kinematics.linkages import AT_REST, GROUND
from tests.solvers.kinematics.solved import solved

PI = np.pi
SINGLE = [0.0, 0.3, 0.5 * PI, 3.0, PI, -PI, 1.5 * PI, -1.5 * PI, 5.0, 2.0 * PI, -2.0 * PI, 3.0 * PI, 5.0 * PI]
SEVERAL = [(0.5, 0.6, -0.7), (1.5, -1.1, 0.0), (PI, 0.0, 0.0), (0.5 * PI, 0.0, -0.5), (0.7, 0.7, 0.7)]
ESTIMATES = [(1.0, 0.0, 0.0, 0.0), (-1.0, 0.0, 0.0, 0.0), (0.0, 1.0, 0.0, 0.0), (0.1, 1.0, 1.0, 1.0)]
ONCE = TimeGrid(0.0, 0.0, 1.0)


def assert_holds(p, angles, allowed=1e-15):
    assert np.max(np.abs(p[1:] - np.sin(0.5 * np.asarray(angles)))) <= allowed
    assert abs(p @ p - 1.0) <= 4.0 * allowed


@pytest.mark.parametrize("estimate", ESTIMATES)
@pytest.mark.parametrize("angles", [*SEVERAL, *(tuple(v * np.eye(3)[k]) for v in SINGLE for k in range(3))])
def test_a_ground_body_stands_at_the_angles_of_its_deck(angles, estimate):
    values = (1.0, 2.0, 3.0, *map(float, angles))
    mechanism = Mechanism(
        (Body("body 1", (0.9, 2.1, 3.0), tuple(unit(estimate))),),
        ONCE,
        grounds=(Ground("ground 1", 0, values),),
    )
    rows = solved(mechanism)
    assert rows.position[0, 0].tolist() == [1.0, 2.0, 3.0]
    assert_holds(rows.euler_parameters[0, 0], angles)
    assert rows.euler_parameters[0, 0, 0] * estimate[0] >= 0.0


@pytest.mark.parametrize("angles", [*SEVERAL, (0.0, PI, 0.0), (0.0, 0.0, -PI), (0.0, 1.5 * PI, 0.0)])
def test_a_hinged_body_with_held_angles_swings_its_origin_there(angles):
    joint = Joint("spherical", "spherical 1", 0, 1, (1.0, 2.0, 3.0), (0.3, 0.2, 0.1))
    held = tuple(Simplified(f"simplified {k + 1}", 1, 4 + k, float(v)) for k, v in enumerate(angles))
    bodies = GROUND, Body("body 2", (1.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0))
    rows = solved(Mechanism(bodies, ONCE, (joint,), held, grounds=(AT_REST,)))
    p = rows.euler_parameters[0, 1]
    assert_holds(p, angles)
    expected = np.array([1.0, 2.0, 3.0]) - axes(p) @ np.array([0.3, 0.2, 0.1])
    assert np.max(np.abs(rows.position[0, 1] - expected)) <= 1e-14


@pytest.mark.parametrize("estimate", ESTIMATES[:3])
@pytest.mark.parametrize("value", [*SINGLE, PI - 1e-6, PI + 1e-6])
def test_one_held_angle_leaves_the_others_to_the_joint(value, estimate):
    """A revolute joint about x, whose own rows keep e2 = e3 = 0; at a half turn e0 is a double root."""
    joint = Joint("revolute", "revolute 1", 0, 1, (0.0,) * 3, (0.0,) * 3, (1.0, 0.0, 0.0), (1.0, 0.0, 0.0))
    bodies = GROUND, Body("body 2", (0.0, 0.0, 0.0), estimate)
    held = (Simplified("simplified 1", 1, 4, value),)
    rows = solved(Mechanism(bodies, ONCE, (joint,), held, grounds=(AT_REST,)))
    assert_holds(rows.euler_parameters[0, 1], (value, 0.0, 0.0), allowed=1e-14)


def test_a_body_held_at_a_half_turn_slides_as_driven():
    """Equations that repeat each other at e0 = 0, with a motion that is determined all the same."""
    joint = Joint(
        "cylindrical", "cylindrical 1", 0, 1, (0.0,) * 3, (0.0,) * 3, (1.0, 0.0, 0.0), (1.0, 0.0, 0.0)
    )
    mechanism = Mechanism(
        (GROUND, Body("body 2", (0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0))),
        TimeGrid(0.0, 3.0, 0.5),
        (joint,),
        (Simplified("simplified 1", 1, 4, PI),),
        drivers=(Driver("driver 1", 1, 1, 0.2, 1.0, 0.3),),
        grounds=(AT_REST,),
    )
    rows = solved(mechanism)
    assert np.max(np.abs(rows.position[:, 1, 0] - (0.2 + rows.time + 0.15 * rows.time**2))) <= 1e-14
    assert np.max(np.abs(rows.velocity[:, 1, 0] - (1.0 + 0.3 * rows.time))) <= 1e-14
    assert np.max(np.abs(rows.acceleration[:, 1, 0] - 0.3)) <= 1e-14
    assert np.max(np.abs(rows.euler_parameters[:, 1, 1] - 1.0)) <= 1e-14
