"""Cams: a follower's coordinate is a function of the cam's; closed forms, energy, all integrators.

Values of the 3-4-5 cam: `reference/motion`, problem cam-coupling-345, closed form: torque = force df/da.
"""

import math

import numpy as np
import pytest

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


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("from=1.angle to=2.stroke", "a cam takes from=1.angle to=2.stroke function=name, all three"),
        ("from=1.angle to=2.stroke function=lift 1.angle=2", "all three and no factors"),
        ("from=1.angle to=1.angle function=lift", "from and to are one coordinate"),
        ("from=1.angle to=2.stroke function=corner", "the rate of a coordinate cannot jump"),
        ("from=1.angle to=2.stroke function=none", "there is no function none"),
        ("from=1.stroke to=2.stroke function=lift", "has an angle, not a stroke"),
    ],
)
def test_faults_of_cams_are_named(line, message):
    cards = (
        f"{BODIES}ELEMENTS\n  FUNCTION lift sine 0 1 1\n  FUNCTION corner table 0 0 1 1\n  COUPLING cam {line}"
    )
    with pytest.raises(DeckError) as refused:
        model_of(CAM, "0 1 0.5", cards)
    assert any(message in fault.message for fault in refused.value.faults)
