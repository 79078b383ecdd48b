"""Cams: a follower's coordinate is a function of the cam's; closed forms, energy, all integrators.

Values of the 3-4-5 cam: `reference/motion`, problem cam-coupling-345, closed form: torque = force df/da.
"""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from flexmb_cli.errors import DeckError
from tests.solvers.constrained.element_decks import METHODS, TWO_ROTORS, model_of, rows_of

# Body 2 turns about z, body 3 slides along z.
CAM = """3 0 0 0 0 1 0 1 0 0 0 1
0 0 0 1 0 0 0
0 0 0 1 0 0 0
0 0 0 1 0 0 0
1 2 0 0 0 0 0 0 1 0 0 1 0 0
1 3 0 0 0 0 0 0 0 0 1 0 0 1 1 0 0 0 1 0
1 0 0 0 0 0 0
"""
BODIES = "MASS 2 1 0 0 0 0.1 0.1 0.1\nMASS 3 0.8 0 0 0 0.1 0.1 0.1\n"
LIFT = """GRAVITY 0 0 -9.81
ELEMENTS
  FUNCTION turn polynomial 0 20
  FUNCTION lift step 0 0 3.141592653589793 0.03
  SPRING back at=2.stroke stiffness=2000 preload=30
  COUPLING cam from=1.angle to=2.stroke function=lift
  DRIVE shaft at=1.angle value=turn
"""
# Time over pi/200, velocity, acceleration, force of the cam on the follower, torque of the motor.
REFERENCE = (
    (1, 0.0464095814056, 5.25249016002, 42.563592128, 0.098767924689),
    (2, 0.146677195554, 7.00332021336, 46.9258561707, 0.344147649103),
    (5, 0.358098621957, 0.0, 67.848, 1.21481376513),
    (6, 0.330023689995, -3.50166010668, 76.0002719147, 1.2540945089),
    (8, 0.146677195554, -7.00332021336, 88.7701438293, 0.651027787288),
    (10, 0.0, 0.0, 97.848, 0.0),
)
NEAR = {"DOP853": 1e-8, "RAD5": 1e-6, "GALF": 2e-3}


@pytest.mark.parametrize("analysis", ["forward", "inverse"])
def test_the_345_cam_gives_the_motion_the_force_and_the_torque_of_the_closed_form(analysis):
    step = math.pi / 200
    rows = rows_of(CAM, f"0 {10 * step!r} {step!r}", f"{BODIES}{LIFT}", analysis)
    for k, velocity, acceleration, force, torque in REFERENCE:
        u = k / 10
        assert rows.position[k, 2, 2] == pytest.approx(0.03 * u**3 * (10 - 15 * u + 6 * u * u), abs=1e-12)
        assert rows.velocity[k, 2, 2] == pytest.approx(velocity, abs=1e-11)
        assert rows.acceleration[k, 2, 2] == pytest.approx(acceleration, abs=1e-9)
        assert rows.coupling_effort[k, 0] == pytest.approx(force, abs=1e-8)
        assert rows.driver_effort[k, 0] == pytest.approx(torque, abs=1e-9)


@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=() if n == "DOP853" else pytest.mark.long_motion) for n in METHODS]
)
def test_a_free_cam_with_a_heavy_follower_keeps_its_energy(name):
    """One degree of freedom: (I + m f'²) a'²/2 + m g f(a) stays, for many turns of a sine."""
    cards = (
        f"{BODIES}GRAVITY 0 0 -9.81\nELEMENTS\n  FUNCTION lift sine 0 0.05 2\n"
        "  COUPLING cam from=1.angle to=2.stroke function=lift\n  START at=1.angle rate=9\n"
        f"{METHODS[name]}"
    )
    rows = rows_of(CAM, "0 2 0.1", cards)
    angle, rate = rows.joint_coordinate[:, 0], rows.joint_rate[:, 0]
    slope = 0.1 * np.cos(2 * angle)
    energy = (0.1 + 0.8 * slope**2) * rate**2 / 2 + 0.8 * 9.81 * 0.05 * np.sin(2 * angle)
    assert angle[-1] > 4 * math.pi
    assert rows.position[:, 2, 2] == pytest.approx(0.05 * np.sin(2 * angle), abs=1e-12)
    assert energy == pytest.approx(np.full(21, energy[0]), rel=NEAR[name])


def test_a_follower_that_turns_begins_where_the_function_of_the_cam_does():
    """Angle 2 = 0.3 + angle 1 + angle 1²/2, which assembly meets; the effort is a torque."""
    cards = (
        "MASS 2 1 0 0 0 1 1 0.3\nMASS 3 1 0 0 0 1 1 0.8\nTORQUE 2 0 0 2\nELEMENTS\n"
        "  FUNCTION gain polynomial 0.3 1 0.5\n"
        "  COUPLING cam from=1.angle to=2.angle function=gain"
    )
    rows = rows_of(TWO_ROTORS, "0 1 0.25", cards)
    one, other = rows.joint_coordinate.T
    assert other == pytest.approx(0.3 + one + one**2 / 2, abs=1e-12)
    work = 0.15 * rows.joint_rate[:, 0] ** 2 + 0.4 * rows.joint_rate[:, 1] ** 2
    assert work == pytest.approx(2 * (one - one[0]), abs=1e-8)


JUMPS = (
    f"{BODIES}GRAVITY 0 0 -9.81\nELEMENTS\n  FUNCTION turn polynomial 0 20\n  FUNCTION lift sine 0 0.05 1\n"
    "  COUPLING cam from=1.angle to=2.stroke function=lift stiffness=5000 damping=0.3\n"
    "  DRIVE shaft at=1.angle value=turn\n  START at=2.stroke rate=1\n"
)


@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=() if n == "DOP853" else pytest.mark.long_motion) for n in METHODS]
)
def test_a_follower_lifts_off_and_lands_again(name):
    """The cam of 0.05 sin 20 t is faster than gravity; m z'' = F - m g by an independent integrator.

    F = k d (1 + c d') at the depth d = 0.05 sin 20 t - z, of Hunt and Crossley.
    """
    rows = rows_of(CAM, "0 0.4 0.01", f"{JUMPS}{METHODS[name]}")

    def force(t, z, v):
        depth, rate = 0.05 * np.sin(20 * t) - z, np.cos(20 * t) - v
        return np.where(depth > 0, 5000 * depth * np.maximum(0, 1 + 0.3 * rate), 0)

    def slope(t, y):
        return y[1], force(t, *y) / 0.8 - 9.81

    found = solve_ivp(slope, (0, 0.4), (0, 1), "DOP853", rows.time, rtol=1e-12, atol=1e-13, max_step=1e-4)
    near = {"DOP853": 1e-6, "RAD5": 1e-5, "GALF": 1e-3}[name]
    assert rows.position[:, 2, 2] == pytest.approx(found.y[0], abs=near)
    efforts = force(rows.time, *found.y)
    assert rows.element_effort[:, 0] == pytest.approx(efforts, abs=1e4 * near)
    assert 5 < np.sum(efforts == 0) < 35
    assert rows.element_coordinate[:, 0] == pytest.approx(
        found.y[0] - 0.05 * np.sin(20 * rows.time), abs=near
    )
    # The cam bears the follower's force by its slope.
    assert rows.driver_effort[:, 0] == pytest.approx(0.05 * np.cos(20 * rows.time) * efforts, abs=1e4 * near)


def test_gears_with_play_push_each_other_on_both_sides():
    """Angle 2 - angle 1 between limits 0.01 apart; the wheels' momentum stays, and the play is not passed."""
    cards = (
        "MASS 2 1 0 0 0 1 1 0.3\nMASS 3 1 0 0 0 1 1 0.8\nELEMENTS\n  FUNCTION same polynomial 0 1\n"
        "  COUPLING teeth from=1.angle to=2.angle function=same stiffness=1e4 lower=-0.005 upper=0.005\n"
        "  START at=1.angle rate=1"
    )
    rows = rows_of(TWO_ROTORS, "0 0.2 0.002", cards)
    play = rows.joint_coordinate[:, 1] - rows.joint_coordinate[:, 0]
    assert np.ptp(np.sign(np.round(rows.element_effort[:, 0], 6))) == 2
    assert 0.005 < np.max(np.abs(play)) < 0.012
    assert rows.joint_rate @ (0.3, 0.8) == pytest.approx(np.full(101, 0.3), abs=1e-9)
    assert rows.total == pytest.approx(np.full(101, 0.15), abs=1e-5)


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("from=1.angle to=2.stroke", "a cam takes from=1.angle to=2.stroke function=name, all three"),
        ("from=1.angle to=2.stroke function=lift 1.angle=2", "all three and no factors"),
        ("from=1.angle to=2.stroke function=lift lower=1", "with stiffness= one side only"),
        ("from=1.angle to=2.stroke function=lift stiffness=-1", "stiffness must not be negative; read -1"),
        (
            "from=1.angle to=2.stroke function=lift stiffness=1 lower=2 upper=1",
            "upper must be larger than lower, 2",
        ),
        ("from=1.angle to=1.angle function=lift", "from and to are the same coordinate"),
        ("from=1.angle to=2.stroke function=corner", "the rate of a coordinate cannot jump"),
        ("from=1.angle to=2.stroke function=none", "there is no function none"),
        ("from=1.stroke to=2.stroke function=lift", "has an angle, not a stroke"),
    ],
)
def test_faults_of_cams_are_named(line, message):
    functions = "  FUNCTION lift sine 0 1 1\n  FUNCTION corner table 0 0 1 1\n"
    cards = f"{BODIES}ELEMENTS\n{functions}  COUPLING cam {line}"
    with pytest.raises(DeckError) as refused:
        model_of(CAM, "0 1 0.5", cards)
    assert any(message in fault.message for fault in refused.value.faults)
