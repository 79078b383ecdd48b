"""Drivers at joints and functions of time: a serial arm in closed form, power, inverse against forward."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from flexmb_cli.cli import cli
from flexmb_cli.deck.text import read_text
from flexmb_cli.dialects.recognise import read_deck
from flexmb_cli.dialects.settings import apply_settings
from flexmb_cli.dialects.young.build_dynamics import build_young_dynamics
from flexmb_cli.errors import AnalysisError
from flexmb_cli.model.joint_elements import JointElements
from flexmb_cli.model.laws import Line, spring
from flexmb_cli.solvers.constrained.young_dynamics import DrivenDynamics
from tests.solvers.constrained.dynamic_runs import run
from tests.solvers.constrained.element_decks import ARM, ROTOR, SLIDER, TWO_ROTORS, model_of, rows_of

# Slender links: centres of mass, masses, moments of inertia about z.
LINKS = "MASS 2 1.5 0.4 0 0 0.1 0.2 0.2\nMASS 3 0.8 0.3 0 0 0.05 0.1 0.1\nGRAVITY 0 -9.81 0\n"
DRIVEN = (
    LINKS + "ELEMENTS\n"
    "  FUNCTION 1 sine 0.2 0.7 2.0 0.5\n"
    "  FUNCTION 2 polynomial 0.1 8.0 -0.4 0.3\n"
    "  DRIVE angle-1 at=1.angle value=1\n"
    "  DRIVE angle-2 at=2.angle value=2\n"
)


def functions(t):
    """The two angles of DRIVEN with their first two derivatives."""
    phase = 2.0 * t + 0.5
    one = 0.2 + 0.7 * np.sin(phase), 1.4 * np.cos(phase), -2.8 * np.sin(phase)
    two = 0.1 + 8.0 * t - 0.4 * t**2 + 0.3 * t**3, 8.0 - 0.8 * t + 0.9 * t**2, -0.8 + 1.8 * t
    return one, two


def efforts_of_two_links(t):
    """Lagrange's equations of the planar double pendulum with driven joints (Craig, Introduction to Robotics,
    third edition, section 6.7), here with distributed masses: l = 1 m, centres at 0.4 m and 0.3 m."""
    (q1, w1, a1), (q2, w2, a2) = functions(t)
    m1, m2, c1, c2, i1, i2, g = 1.5, 0.8, 0.4, 0.3, 0.2, 0.1, 9.81
    of_2 = i2 + m2 * c2**2
    coupling = m2 * c2 * np.cos(q2)
    swing = m2 * c2 * np.sin(q2)
    inertia = i1 + m1 * c1**2 + m2 + of_2 + 2 * coupling
    weight = m2 * g * c2 * np.cos(q1 + q2)
    first = inertia * a1 + (of_2 + coupling) * a2 - swing * (2 * w1 * w2 + w2**2)
    first += (m1 * c1 + m2) * g * np.cos(q1) + weight
    return first, (of_2 + coupling) * a1 + of_2 * a2 + swing * w1**2 + weight


def test_motors_of_a_serial_arm_bear_lagranges_efforts_over_many_turns():
    """The second angle turns 2.6 times round against a body that moves itself."""
    rows = rows_of(ARM, "0 2 0.1", DRIVEN, "inverse")
    one, two = functions(rows.time)
    assert rows.joint_coordinate == pytest.approx(np.column_stack([one[0], two[0]]), abs=1e-13)
    assert rows.joint_rate == pytest.approx(np.column_stack([one[1], two[1]]), abs=1e-12)
    assert rows.driver_effort == pytest.approx(np.column_stack(efforts_of_two_links(rows.time)), rel=1e-11)


def test_the_power_of_the_motors_is_the_rate_of_the_energy():
    """Kinetic and potential energy at rows 1e-3 s apart, by a fourth-order difference."""
    rows = rows_of(ARM, "0.5 0.504 0.001", DRIVEN, "inverse")
    energy = rows.kinetic + rows.potential
    rate = (energy[0] - 8.0 * energy[1] + 8.0 * energy[3] - energy[4]) / 0.012
    power = np.sum(rows.driver_effort * rows.joint_rate, axis=1)
    assert power[2] == pytest.approx(rate, rel=1e-8)
    assert rows.applied_power[2] == pytest.approx(power[2], rel=1e-12)


def test_a_velocity_driver_follows_the_integral_of_its_function():
    """Rate 3 - 2 cos 4 t from the estimates on: angle 3 t - sin(4 t)/2."""
    cards = (
        "MASS 2 1 0 0 0 1 1 1\n"
        "ELEMENTS\n"
        "  FUNCTION 1 sine 3 -2 4 1.5707963267948966\n"
        "  DRIVE angle-1 at=1.angle rate=1"
    )
    rows = rows_of(ROTOR, "0 3 0.25", cards, "inverse")
    assert rows.joint_coordinate[:, 0] == pytest.approx(3 * rows.time - np.sin(4 * rows.time) / 2, abs=1e-13)


def test_a_stroke_is_driven_and_its_force_is_mass_times_acceleration():
    cards = (
        "MASS 2 2.5 0 0 0 1 1 1\n"
        "ELEMENTS\n"
        "  FUNCTION 1 step 0.2 0 0.8 0.3\n"
        "  DRIVE stroke-1 at=1.stroke value=1"
    )
    rows = rows_of(SLIDER, "0 1 0.1", cards, "inverse")
    s = np.clip((rows.time - 0.2) / 0.6, 0.0, 1.0)
    bend = 0.3 / 0.36 * (60 * s - 180 * s**2 + 120 * s**3)
    assert rows.driver_effort[:, 0] == pytest.approx(2.5 * bend, abs=1e-12)
    assert rows.position[:, 1, 0] == pytest.approx(0.3 * (10 * s**3 - 15 * s**4 + 6 * s**5), abs=1e-14)


@pytest.mark.parametrize(("direction", "coordinate"), [(6, 0), (1, 1)])
def test_a_driver_of_the_deck_follows_a_function(direction, coordinate):
    """DRIVE takes the place of C, B, A; a torque of I α and a force of m a."""
    mechanism = (ROTOR if direction == 6 else SLIDER).replace("2 0 0", "2 1 0", 1)
    mechanism = mechanism.replace("0 0 0 1 0 0 0\n1 2", f"0 0 0 1 0 0 0\n2 {direction} 0 1 0\n1 2")
    rows = rows_of(
        mechanism,
        "0 2 0.2",
        "MASS 2 2 0 0 0 1 1 0.7\nELEMENTS\n  FUNCTION 1 sine 0 4 1.5\n  DRIVE drive-1 driver=1 value=1",
        "inverse",
    )
    value = 4 * np.sin(1.5 * rows.time)
    found = rows.joint_coordinate[:, 0]
    assert found == pytest.approx(value, abs=1e-12)
    assert rows.driver_effort[:, 0] == pytest.approx((0.7, 2.0)[coordinate] * -2.25 * value, abs=1e-11)


def test_a_support_that_moves_is_held_by_its_force():
    """A body held in all directions but turns, whose support follows z(t): the holder bears m (g + z̈)."""
    free = "1 0 0 0 0 0 0 0 0 6 0 0\n0 0 0 1 0 0 0\n" + "".join(f"1 {k} 0\n" for k in range(1, 7))
    cards = (
        "MASS 1 3 0 0 0 1 1 1\n"
        "GRAVITY 0 0 -9.81\n"
        "ELEMENTS\n"
        "  FUNCTION 1 polynomial 0 0 2\n"
        "  SUPPORT support-1 simplified=3 value=1"
    )
    rows = rows_of(free, "0 1 0.25", cards, "inverse")
    assert rows.position[:, 0, 2] == pytest.approx(2 * rows.time**2, abs=1e-14)
    assert rows.holding_force[:, 2, 2] == pytest.approx(np.full(5, 3 * (9.81 + 4.0)), rel=1e-13)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_gear_turns_its_joints_in_proportion(sign):
    """2 θ1 + sign θ2 = 0; the inertia felt at the driver is I1 + 4 I2."""
    cards = (
        "MASS 2 1 0 0 0 1 1 0.3\n"
        "MASS 3 1 0 0 0 1 1 0.2\n"
        "ELEMENTS\n"
        "  FUNCTION 1 polynomial 0 1 1.5\n"
        "  DRIVE angle-1 at=1.angle value=1\n"
        f"ELEMENTS\n  COUPLING coupling-1 1.angle=2 2.angle={sign}"
    )
    rows = rows_of(TWO_ROTORS, "0 1 0.1", cards, "inverse")
    assert rows.joint_coordinate[:, 1] == pytest.approx(-2.0 * sign * rows.joint_coordinate[:, 0], abs=1e-13)
    assert rows.driver_effort[:, 0] == pytest.approx(np.full(11, (0.3 + 4 * 0.2) * 3.0), rel=1e-12)
    # I2 θ̈2 = sign λ, θ̈2 = -2 sign 3.
    assert rows.coupling_effort[:, 0] == pytest.approx(np.full(11, -0.2 * 6.0), rel=1e-12)


def test_what_nothing_drives_is_refused_in_an_inverse_run():
    model = model_of(
        ARM,
        "0 1 0.1",
        LINKS + "ELEMENTS\n  FUNCTION 1 sine 0 1 1\n  DRIVE angle-1 at=1.angle value=1\n",
        "inverse",
    )
    with pytest.raises(AnalysisError, match="do not determine all velocities"):
        list(DrivenDynamics(model).rows())


@pytest.mark.long_motion
def test_the_effort_of_an_inverse_run_as_a_table_gives_the_motion_back(tmp_path: Path, monkeypatch):
    """`flexmb table --as-table` writes the torque of a motor; a forward run applies it."""
    monkeypatch.chdir(tmp_path)
    function = "ELEMENTS\n  FUNCTION 1 sine 0 0.4 2 0\n  DRIVE angle-1 at=1.angle value=1\n"
    mass = "MASS 2 2 0.3 0 0 0.4 0.5 0.7\nGRAVITY 0 -9.81 0\n"
    Path("inverse.dat").write_text(f"{ROTOR}0 1 0.005\nDYNAMICS inverse\n{mass}{function}END\n")
    run = CliRunner()
    assert run.invoke(cli, ["run", "-q", "inverse.dat"]).exit_code == 0
    cards = run.invoke(cli, ["table", "-q", "inverse.h5", "driver.1.effort", "--as-table", "4"]).stdout
    assert cards.startswith("ELEMENTS\n  FUNCTION 4 spline 0.0 ")
    rows = rows_of(
        ROTOR,
        "0 1 0.05",
        f"{mass}TORQUE 2 0 0 1 0 4\n{cards}ELEMENTS\n  START at=1.angle rate=0.8\nTOLERANCE 1e-12\n",
    )
    assert rows.joint_coordinate[:, 0] == pytest.approx(0.4 * np.sin(2 * rows.time), abs=1e-8)
    assert rows.joint_rate[:, 0] == pytest.approx(0.8 * np.cos(2 * rows.time), abs=1e-8)


def test_a_ramped_torque_turns_a_rotor_by_its_cubic():
    """I α = 6 t from 0.5 s to 1 s, 3 N m after: closed integrals, steps that end at the corners."""
    cards = "MASS 2 1 0 0 0 1 1 2\nELEMENTS\n  FUNCTION 1 ramp 0.5 0 1 3\n  SPRING shown at=1.angle\n"
    cards += "TORQUE 2 0 0 1 0 1\nTOLERANCE 1e-12"
    rows = rows_of(ROTOR, "0 1.5 0.25", cards)
    s, after = np.clip(rows.time - 0.5, 0.0, 0.5), np.clip(rows.time - 1.0, 0.0, None)
    wanted = s**3 / 2 + after * 0.375 + 0.75 * after**2
    assert rows.joint_coordinate[:, 0] == pytest.approx(wanted, abs=2e-12)


def test_turns_of_rate_and_position_agree_with_a_full_revolution_of_the_base():
    """An arm on a turntable: relative angles do not change when the base turns."""
    cards = (
        "MASS 2 1 0 0 0 1 1 0.2\n"
        "MASS 3 1 0 0 0 1 1 0.2\n"
        "ELEMENTS\n"
        "  FUNCTION 1 polynomial 0 9\n"
        "  FUNCTION 2 sine 0 1 3\n"
        "  DRIVE angle-1 at=1.angle value=1\n"
        "  DRIVE angle-2 at=2.angle value=2"
    )
    rows = rows_of(ARM, "0 1 0.1", cards, "inverse")
    assert rows.joint_coordinate[-1] == pytest.approx((9.0, math.sin(3.0)), abs=1e-13)


@pytest.mark.long_motion
def test_both_motors_of_the_supplied_arm_move_it_as_they_were_driven():
    """Motors with splines through the efforts of IN-ARM, which has a spring and a damper at its elbow."""
    text = (Path(__file__).parents[3] / "decks/young/dynamics/IN-ARM.dat").read_text()
    mechanism, cards = text.split("0 1 0.01\n")
    loads = cards.partition("inverse")[2].partition("  FUNCTION swing")[0]
    driven = rows_of(mechanism, "0 1 0.005", cards.partition("inverse")[2].partition("END")[0], "inverse")
    for k in range(2):
        pairs = zip(driven.time.tolist(), driven.driver_effort[:, k].tolist(), strict=True)
        points = " ".join(f"{t!r} {v!r}" for t, v in pairs)
        loads += (
            "ELEMENTS\n"
            f"  FUNCTION {k + 1} spline {points}\n"
            f"  MOTOR tmotor-{k + 1} at={k + 1}.angle effort={k + 1}\n"
        )
    free = rows_of(
        mechanism,
        "0 1 0.05",
        f"{loads}ELEMENTS\n  START at=1.angle rate=1.8\n  START at=2.angle rate=0\nTOLERANCE 1e-12",
    )
    assert free.joint_coordinate == pytest.approx(driven.joint_coordinate[::10], abs=1e-8)
    assert free.joint_rate == pytest.approx(driven.joint_rate[::10], abs=1e-8)


def test_an_inverse_run_by_projection_has_the_efforts_of_the_kinematic_analysis():
    """The RSSR of the dissertation by both ways: a spring that bears nothing asks for the constrained one."""
    path = Path(__file__).parents[3] / "decks/young/dynamics/IN-RSSR-MASS.dat"
    deck = apply_settings(read_deck(read_text(str(path))), ["time.end=0.02"])
    model = build_young_dynamics(deck)[0]
    wanted = run(model)
    idle = spring("idle", Line(-1, 1, (0.0, 0.0, 9.0), (0.0, 0.0, 0.0)))
    (found,) = DrivenDynamics(replace(model, elements=JointElements(forces=(idle,)))).rows()
    scale = np.abs(wanted.driver_effort).max()
    assert len(found.time) > 3
    assert found.driver_effort == pytest.approx(wanted.driver_effort, abs=1e-10 * scale)
    assert found.reaction_force == pytest.approx(wanted.reaction_force, rel=1e-8, abs=1e-8)


@pytest.mark.parametrize("analysis", ["forward", "inverse"])
def test_estimates_that_miss_the_axis_leave_no_bending_in_the_joint(analysis):
    """A torque about a principal axis through the centre of mass turns the body and needs no reaction.

    Body 2 is estimated 0.2 rad about x off the joint's axis z; assembly takes that away (Euler's equations:
    with ω and α along a principal axis only the torque along it is left).
    """
    tilted = ROTOR.replace("1 0 0 0\n0 0 0 1 0 0 0\n", "1 0 0 0\n0 0 0 0.9950041653 0.0998334166 0 0\n")
    assert tilted != ROTOR
    drive = {
        "forward": "ELEMENTS\n  MOTOR tmotor-1 at=1.angle effort=1\n  FUNCTION 1 polynomial 0.7",
        "inverse": "ELEMENTS\n  DRIVE angle-1 at=1.angle value=1\n  FUNCTION 1 polynomial 0 0 0.7",
    }[analysis]
    rows = rows_of(tilted, "0 0.3 0.1", f"MASS 2 2 0 0 0 1 1 0.5\n{drive}", analysis)
    assert np.abs(rows.angular_acceleration[:, 1, 2]) == pytest.approx(1.4, rel=1e-9)
    assert np.abs(rows.reaction_torque).max() < 1e-9
