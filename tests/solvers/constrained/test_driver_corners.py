"""Drivers whose rate has a corner: a sprung rotor on an arm whose speed rises by a ramp and then holds."""

import numpy as np
import pytest

from tests.solvers.constrained.element_decks import ARM, analysis_of, model_of, rows_of

INERTIA, STIFFNESS, DAMPING = 0.1, 2.0, 0.1  # kg m², N m/rad, N m s/rad
ACCELERATION, UNTIL = 8 / 3, 1.5  # rad/s², s
MASSES = (
    "MASS 2 1 0 0 0 1 1 1\n"
    f"MASS 3 0.8 0 0 0 1 1 {INERTIA}\n"
    "ELEMENTS\n"
    f"  SPRING tspring-1 at=2.angle stiffness={STIFFNESS} damping={DAMPING}\n"
)
RATES = {
    "ramp": f"ELEMENTS\n  FUNCTION 1 ramp 0 0 {UNTIL} 4\n",
    "table": f"ELEMENTS\n  FUNCTION 1 table 0 0 {UNTIL} 4 9 4\n",
    "sum": f"ELEMENTS\n  FUNCTION 2 ramp 0 0 {UNTIL} 4\n  FUNCTION 3 sine 0 0 1\n  FUNCTION 1 sum 2 3\n",
}
METHODS = {"DOP853": "TOLERANCE 1e-11", "RAD5": "RAD5 1e-10", "GALF": "GALF 0 0.9\nTOLERANCE 1e-6"}
NEAR = {"DOP853": 1e-8, "RAD5": 1e-8, "GALF": 3e-6}  # rad, rad/s: of GALF three tolerances


def step_response(t):
    """Angle and rate that a step of acceleration of its base gives a damped oscillator, per rad/s² (Ogata,
    System Dynamics, section 8-3)."""
    t = np.maximum(t, 0.0)
    decay, square = DAMPING / (2 * INERTIA), STIFFNESS / INERTIA
    damped = (square - decay**2) ** 0.5
    fade = np.exp(-decay * t)
    angle = -(1 - fade * (np.cos(damped * t) + decay / damped * np.sin(damped * t))) / square
    return angle, -fade * np.sin(damped * t) / damped


@pytest.mark.long_motion
@pytest.mark.parametrize("rate", RATES)
@pytest.mark.parametrize("method", METHODS)
def test_a_motor_whose_speed_stops_rising_leaves_the_rotor_ringing_as_the_step_response(method, rate):
    cards = f"{MASSES}{RATES[rate]}ELEMENTS\n  DRIVE angle-1 at=1.angle rate=1\n{METHODS[method]}"
    rows = rows_of(ARM, "0 3 0.05", cards)
    early, late = step_response(rows.time), step_response(rows.time - UNTIL)
    angle, speed = (ACCELERATION * (one - other) for one, other in zip(early, late, strict=True))
    assert rows.joint_coordinate[:, 1] == pytest.approx(angle, abs=NEAR[method])
    assert rows.joint_rate[:, 1] == pytest.approx(speed, abs=NEAR[method])


def test_steps_of_generalised_alpha_begin_anew_behind_a_corner():
    """At the corner the row has the acceleration after it: the motor's effort falls by that of the arm."""
    cards = f"{MASSES}{RATES['ramp']}ELEMENTS\n  DRIVE angle-1 at=1.angle rate=1\nGALF 0 0.9\nTOLERANCE 1e-3"
    rows = rows_of(ARM, f"0 {2 * UNTIL} {UNTIL}", cards)
    angle, speed = rows.joint_coordinate[1, 1], rows.joint_rate[1, 1]
    # The second body's mass runs on with the end of the arm; only the spring turns against the motor.
    assert rows.driver_effort[1, 0] == pytest.approx(-STIFFNESS * angle - DAMPING * speed, abs=1e-9)


@pytest.mark.long_motion
def test_a_stop_just_at_the_corner_goes_on_to_the_same_numbers():
    """A checkpoint after the row at the corner, whose acceleration has jumped."""
    cards = f"{MASSES}{RATES['ramp']}ELEMENTS\n  DRIVE angle-1 at=1.angle rate=1\nGALF 0 0.9\nTOLERANCE 1e-4"
    model = model_of(ARM, f"0 {2 * UNTIL} {UNTIL / 2}", cards)
    whole = np.concatenate([block.joint_coordinate for block in analysis_of(model).rows()])
    stopped = analysis_of(model)
    blocks = stopped.rows()
    parts = []
    while sum(map(len, parts)) < 3:
        parts.append(next(blocks).joint_coordinate)
    again = analysis_of(model)
    again.restore(stopped.checkpoint)
    parts += [block.joint_coordinate for block in again.rows()]
    assert np.array_equal(np.concatenate(parts), whole)
