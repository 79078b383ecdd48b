"""Functions, motors, stops and composite joints in closed form, each with its source."""

import math

import numpy as np
import pytest
from scipy.special import ellipk

from tests.solvers.constrained.element_decks import FREE, ROTOR, SLIDER, rows_of

TURNED = "MASS 2 1 0 0 0 1 1 0.5\n"
# Functions of time that carry number 5, and their double integrals from 0: angles of a rotor with I = 0.5.
FUNCTIONS = {
    "TABLE": (
        "ELEMENTS\n  FUNCTION 5 table 0 1 0.5 3 1 3",
        lambda t: t**2 / 2 + 2 * t**3 / 3 - _after(t, 0.5) ** 3 * 2 / 3,
    ),
    "RAMP": (
        "ELEMENTS\n  FUNCTION 5 ramp 0 1 0.5 3",
        lambda t: t**2 / 2 + 2 * t**3 / 3 - _after(t, 0.5) ** 3 * 2 / 3,
    ),
    # Of a cubic, 1 - t + 2 t³, which a spline through four points is.
    "SPLINE": (
        "ELEMENTS\n  FUNCTION 5 spline 0 1 0.2 0.816 0.5 0.75 1 2",
        lambda t: t**2 / 2 - t**3 / 6 + t**5 / 10,
    ),
    "POLYNOMIAL": ("ELEMENTS\n  FUNCTION 5 polynomial 1 -1 0 2", lambda t: t**2 / 2 - t**3 / 6 + t**5 / 10),
    "SINE": ("ELEMENTS\n  FUNCTION 5 sine 1 2 3 0.5", lambda t: t**2 / 2 + 2 * _sine(t, 3, 0.5)),
    "SUM": (
        "ELEMENTS\n  FUNCTION 3 sine 1 2 3 0.5\n  FUNCTION 4 polynomial 0 1\n  FUNCTION 5 sum 3 4 4",
        lambda t: t**2 / 2 + 2 * _sine(t, 3, 0.5) + t**3 / 3,
    ),
    # t sin 3 t
    "PRODUCT": (
        "ELEMENTS\n  FUNCTION 3 sine 0 1 3\n  FUNCTION 4 polynomial 0 1\n  FUNCTION 5 product 3 4",
        lambda t: (2 - 2 * np.cos(3 * t) - 3 * t * np.sin(3 * t)) / 27,
    ),
    "STEP": ("ELEMENTS\n  FUNCTION 5 step 0 0 1 2", lambda t: 2 * (t**5 / 2 - t**6 / 2 + t**7 / 7)),
}


def _after(t, start):
    return np.clip(t - start, 0.0, None)


def _sine(t, omega, phase):
    """Double integral of sin(ω t + phase) from 0, without rate there."""
    return (math.sin(phase) + omega * t * math.cos(phase) - np.sin(omega * t + phase)) / omega**2


SHOWN = "  SPRING shown at=1.angle\n"  # without forces: results of decks with elements hold coordinates


@pytest.mark.parametrize("keyword", FUNCTIONS)
def test_a_torque_by_a_function_turns_a_rotor_by_its_double_integral(keyword):
    card, integral = FUNCTIONS[keyword]
    rows = rows_of(ROTOR, "0 1 0.25", f"{TURNED}{card}\n{SHOWN}TORQUE 2 0 0 1 0 5\nTOLERANCE 1e-12\n")
    assert rows.joint_coordinate[:, 0] == pytest.approx(2 * integral(rows.time), abs=2e-10)


def test_a_force_and_a_torque_accelerate_a_body_by_newton_and_euler():
    """F = m a, T + P × F = I α about the centre of mass; the second force turns with a body that does not."""
    cards = "MASS 2 2 0 0 0 0.4 0.5 0.8\nFORCE 2 0 0.25 0 4 0 0\nFORCE 2 0 0 0 0 3 0 1\nTORQUE 2 0 0 1\n"
    rows = rows_of(
        FREE, "0 0.5 0.5", f"{cards}ELEMENTS\n  SPRING shown from=0(9,0,0) to=2(0,0,0)\nTOLERANCE 1e-12\n"
    )
    # 4 N at 0.25 m across: -1 N m; the torque takes it up, nothing turns.
    assert rows.angular_velocity[-1, 1] == pytest.approx(np.zeros(3), abs=1e-14)
    assert rows.position[-1, 1] == pytest.approx((0.25, 0.1875, 0.0), abs=1e-13)


@pytest.mark.parametrize(
    ("deck", "mass", "inertia", "at"),
    [(ROTOR, TURNED, 0.5, "1.angle"), (SLIDER, "MASS 2 2 0 0 0 1 1 1\n", 2.0, "1.stroke")],
    ids=["TMOTOR", "AMOTOR"],
)
def test_a_motor_against_a_damper_reaches_its_speed_exponentially(deck, mass, inertia, at):
    """I ω̇ = T - c ω: ω = T/c (1 - exp(-c t/I)) (Ogata, System Dynamics, first-order systems)."""
    torque, c = 3.0, 1.5
    rows = rows_of(
        deck,
        "0 1 0.25",
        f"{mass}ELEMENTS\n"
        f"  FUNCTION 1 polynomial {torque}\n"
        f"  MOTOR motor at={at} effort=1\n"
        f"  SPRING drag at={at} damping={c}\n"
        "TOLERANCE 1e-12\n",
    )
    fall = np.exp(-c * rows.time / inertia)
    assert rows.joint_rate[:, 0] == pytest.approx(torque / c * (1 - fall), abs=2e-10)
    wanted = torque / c * (rows.time - inertia / c * (1 - fall))
    assert rows.joint_coordinate[:, 0] == pytest.approx(wanted, abs=2e-10)
    # The motor stands after all other elements.
    assert rows.element_effort[:, -1] == pytest.approx(np.full(5, torque), rel=1e-15)
    assert rows.element_power[:, -1] == pytest.approx(torque * rows.joint_rate[:, 0], rel=1e-13)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_an_end_stop_of_an_angle_returns_the_rate(side):
    """Free flight to 0.2 rad, half a period π sqrt(I/k) in contact, the way back."""
    cards = (
        f"{TURNED}ELEMENTS\n"
        "  STOP tstop-1 at=1.angle lower=-0.2 upper=0.2 stiffness=5000\n"
        f"  START at=1.angle rate={2 * side}\n"
        "TOLERANCE 1e-11\n"
    )
    rows = rows_of(ROTOR, "0 0.3 0.3", cards)
    half = math.pi * math.sqrt(0.5 / 5000)
    assert rows.joint_coordinate[-1, 0] == pytest.approx(side * (0.2 - 2 * (0.2 - half)), abs=1e-9)
    assert rows.joint_rate[-1, 0] == pytest.approx(-2 * side, rel=1e-8)


# A particle at P_j of a link of 0.8 m whose other end is at the origin of the ground.
PARTICLE = "MASS 2 2 0 0 0 1e-9 1e-9 1e-9\nTOLERANCE 1e-11\n"


def test_a_link_of_two_spheres_leads_a_conical_pendulum():
    """Ω² = g/(l cos θ) (Goldstein, Classical Mechanics, chapter 1): a circle at constant height."""
    length, theta, g = 0.8, 0.6, 9.81
    radius, spin = length * math.sin(theta), math.sqrt(g / (length * math.cos(theta)))
    deck = FREE.replace("0 0 0 1 0 0 0\n1 0", f"{radius!r} 0 {-length * math.cos(theta)!r} 1 0 0 0\n1 0")
    cards = f"{PARTICLE}GRAVITY 0 0 -{g}\nVELOCITY 2 0 {radius * spin!r} 0\n"
    cards += f"ELEMENTS\n  JOINT sphsph-1 sphsph from=0(0,0,0) to=2(0,0,0) length={length}\n"
    rows = rows_of(deck, "0 1 0.125", cards)
    turned = spin * rows.time
    wanted = np.column_stack(
        [radius * np.cos(turned), radius * np.sin(turned), np.full(9, -length * math.cos(theta))]
    )
    assert rows.position[:, 1] == pytest.approx(wanted, abs=1e-8)
    # The link bears m g / cos θ along itself; on the ground, where that is body J, it pulls the other way.
    pull = -wanted / length * 2.0 * g / math.cos(theta)
    assert rows.composite_force[:, 0] == pytest.approx(pull, abs=1e-6)
    assert rows.composite_torque == pytest.approx(0.0, abs=1e-6)
    other = rows_of(deck, "0 1 0.5", cards.replace("from=0(0,0,0) to=2(0,0,0)", "from=2(0,0,0) to=0(0,0,0)"))
    assert other.composite_force[:, 0] == pytest.approx(-pull[::4], abs=1e-6)
    assert other.composite_torque == pytest.approx(0.0, abs=1e-6)


def test_a_link_of_revolute_and_sphere_has_the_period_of_a_plane_pendulum():
    """T = 4 sqrt(l/g) K(sin² θ0/2) (Landau and Lifshitz, Mechanics, section 11), from rest at 2 rad.

    The plane is inclined: its normal has no component of 0, and gravity lies in it.
    """
    length, theta, g = 0.8, 2.0, 9.81
    normal = np.array([1.0, 2.0, 2.0]) / 3.0
    down, across = np.array([2.0, 1.0, -2.0]) / 3.0, np.array([2.0, -2.0, 1.0]) / 3.0
    start = length * (math.cos(theta) * down + math.sin(theta) * across)
    text = {
        key: " ".join(map(repr, value.tolist()))
        for key, value in (("start", start), ("normal", normal), ("gravity", g * down))
    }
    deck = FREE.replace("0 0 0 1 0 0 0\n1 0", f"{text['start']} 1 0 0 0\n1 0")
    period = 4 * math.sqrt(length / g) * float(ellipk(math.sin(theta / 2) ** 2))
    cards = (
        f"{PARTICLE}GRAVITY {text['gravity']}\n"
        "ELEMENTS\n"
        "  JOINT revsph-1 revsph from=0(0,0,0) to=2(0,0,0) "
        f"axis_from=({text['normal']}) length={length}\n"
    )
    rows = rows_of(deck, f"0 {period!r} {period / 4!r}", cards)
    mirrored = length * (math.cos(theta) * down - math.sin(theta) * across)
    assert rows.position[[0, 2, 4], 1] == pytest.approx(np.array([start, mirrored, start]), abs=1e-7)
    assert rows.position[[1, 3], 1] == pytest.approx(np.array([length * down] * 2), abs=1e-7)
    # m (g cos θ + v²/l) along the link, v² = 2 g l (cos θ - cos θ0).
    tension = 2.0 * g * (3.0 * rows.position[:, 1] @ down / length - 2.0 * math.cos(theta))
    wanted = -tension[:, None] * rows.position[:, 1] / length
    assert rows.composite_force[:, 0] == pytest.approx(wanted, abs=1e-5)


def test_a_swivel_lets_a_rod_slide_like_a_bead():
    """A rod without inertia about its centre slides free of forces: its centre goes straight (Newton)."""
    deck = FREE.replace("0 0 0 1 0 0 0\n1 0", "0.6 0 0 1 0 0 0\n1 0")
    cards = (
        "MASS 2 2 0 0 0 1e-9 1e-9 1e-9\n"
        "ELEMENTS\n"
        "  JOINT revcyl-1 revcyl from=0(0,0,0) to=2(0,0,0) axis_from=(0,0,1) axis_to=(1,0,0)\n"
    )
    cards += "VELOCITY 2 -0.3 0.9 0 0 0 1.5\nTOLERANCE 1e-12\n"
    rows = rows_of(deck, "0 1 0.25", cards)
    wanted = np.array([0.6, 0.0, 0.0]) + rows.time[:, None] * np.array([-0.3, 0.9, 0.0])
    assert rows.position[:, 1] == pytest.approx(wanted, abs=1e-7)
