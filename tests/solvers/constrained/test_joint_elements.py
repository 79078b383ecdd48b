"""Springs, stops, cables, bushings, couplings, composite joints: closed forms, energy, all integrators."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq

from flexmb_cli.errors import AnalysisError, ModelError
from tests.solvers.constrained.element_decks import (
    ARM,
    FREE,
    METHODS,
    ROTOR,
    SLIDER,
    TWO_ROTORS,
    analysis_of,
    model_of,
    rows_of,
)

SPUN = "MASS 2 1 0 0 0 1 1 0.5\n"
SLID = "MASS 2 2 0 0 0 1 1 1\n"
# Relative errors of ten periods or so, at the tolerances of the decks.
NEAR = {"DOP853": 1e-7, "RAD5": 1e-5, "GALF": 2e-3}


# Interpreted kernels take a minute for the implicit methods.
@pytest.fixture(
    params=[pytest.param(name, marks=() if name == "DOP853" else pytest.mark.long_motion) for name in METHODS]
)
def method(request):
    """Name and card of an integrator."""
    return request.param, METHODS[request.param]


def oscillation(t, x0, v0, omega, zeta=0.0):
    """Free motion of a damped oscillator (Rao, Mechanical Vibrations, section 2.6)."""
    damped = omega * math.sqrt(1.0 - zeta**2)
    b = (v0 + zeta * omega * x0) / damped
    return np.exp(-zeta * omega * t) * (x0 * np.cos(damped * t) + b * np.sin(damped * t))


def test_a_torsional_spring_with_damper_and_preload_swings_as_in_textbooks(method):
    """I = 0.5, k = 8, c = 0.4, preload 1.6 about the rest angle 0.1: the middle is 0.1 - 1.6/8 = -0.1."""
    name, card = method
    rows = rows_of(
        ROTOR,
        "0 2 0.1",
        f"{SPUN}ELEMENTS\n"
        "  SPRING tspring-1 at=1.angle stiffness=8 rest=0.1 damping=0.4 preload=1.6\n"
        "  START at=1.angle rate=0.4\n"
        f"{card}",
    )
    wanted = -0.1 + oscillation(rows.time, 0.1, 0.4, 4.0, 0.4 / (2 * math.sqrt(8 * 0.5)))
    assert rows.joint_coordinate[:, 0] == pytest.approx(wanted, abs=0.2 * NEAR[name])
    force = -(1.6 + 8 * (rows.joint_coordinate[:, 0] - 0.1) + 0.4 * rows.joint_rate[:, 0])
    assert rows.element_effort[:, 0] == pytest.approx(force, abs=1e-12)
    assert rows.element_power[:, 0] == pytest.approx(-0.4 * rows.joint_rate[:, 0] ** 2, abs=1e-12)
    assert np.ptp(rows.total) < 1e-2 * NEAR[name] + 1e-6


def test_an_axial_spring_moves_a_slider_at_its_natural_frequency(method):
    name, card = method
    rows = rows_of(
        SLIDER, "0 2 0.1", f"{SLID}ELEMENTS\n  SPRING aspring-1 at=1.stroke stiffness=50 rest=0.2\n{card}"
    )
    assert rows.joint_coordinate[:, 0] == pytest.approx(
        0.2 - 0.2 * np.cos(5 * rows.time), abs=0.4 * NEAR[name]
    )


def test_a_hardening_spring_by_a_function_has_duffings_period(method):
    """m ẍ + x³ β = 0 from x = A: T = Γ(1/4)² / (sqrt(π) A) sqrt(m/β) (Rao, section 13.3)."""
    name, card = method
    period = math.gamma(0.25) ** 2 / (math.sqrt(math.pi) * 0.5) * math.sqrt(2.0 / 40.0)
    cards = (
        f"{SLID}ELEMENTS\n"
        "  FUNCTION 3 polynomial 0 0 0 40\n"
        "  SPRING aspring-1 at=1.stroke stiffness=0 rest=-0.5 curve=3\n"
        f"{card}"
    )
    rows = rows_of(SLIDER, f"0 {period:.17g} {period / 4:.17g}", cards)
    wanted = (0.0, -0.5, -1.0, -0.5, 0.0)
    assert rows.joint_coordinate[:, 0] == pytest.approx(wanted, abs=2 * NEAR[name])
    assert rows.total == pytest.approx(np.full(5, 10 * 0.5**4), abs=1e-2 * NEAR[name] + 1e-8)


def test_a_tabulated_damper_and_a_spring_table_give_their_forces():
    """At the start: x - rest = -0.2 on the line from (-1, -8) to 0, rate 3 on the table of the damper."""
    cards = (
        f"{SLID}ELEMENTS\n"
        "  FUNCTION 1 table -1 -8 0 0 1 4\n"
        "  FUNCTION 2 table -5 -1 0 0 5 10\n"
        "  SPRING aspring-1 at=1.stroke stiffness=0 rest=0.2 curve=1 damper=2\n"
        "  START at=1.stroke rate=3"
    )
    rows = rows_of(SLIDER, "0 0.1 0.1", cards)
    assert rows.element_effort[0, 0] == pytest.approx(-(-1.6 + 6.0), rel=1e-13)
    assert rows.element_power[0, 0] == pytest.approx(-6.0 * 3.0, rel=1e-13)


def test_a_spring_in_line_pulls_a_pendulum_from_the_ground():
    """Body 0 is the ground: from (2, 0, 0) to the point (1, 0, 0) of a rotor, length by the cosine rule."""
    cards = (
        f"{SPUN}ELEMENTS\n"
        "  SPRING lspring-1 from=0(2,0,0) to=2(1,0,0) stiffness=30 rest=0.5 preload=4\n"
        "  START at=1.angle rate=2\n"
        "TOLERANCE 1e-11"
    )
    rows = rows_of(ROTOR, "0 1 0.1", cards)
    phi = rows.joint_coordinate[:, 0]
    length = np.sqrt(5.0 - 4.0 * np.cos(phi))
    pull = 4 + 30 * (length - 0.5)
    assert rows.element_coordinate[:, 0] == pytest.approx(length, rel=1e-12)
    assert rows.element_effort[:, 0] == pytest.approx(-pull, rel=1e-12)
    assert rows.angular_acceleration[:, 1, 2] == pytest.approx(
        -pull * 2 * np.sin(phi) / length / 0.5, abs=1e-10
    )
    kinetic = 0.25 * rows.joint_rate[:, 0] ** 2
    stored = 4 * (length - 0.5) + 15 * (length - 0.5) ** 2
    assert kinetic + stored == pytest.approx(np.full(11, 1.0 + 4 * 0.5 + 15 * 0.25), rel=1e-8)


def test_the_damper_of_a_spring_between_points_does_power_by_its_rate_squared():
    """Body 1 is the ground: from (2, 0, 0) to the point (1, 0, 0) of a rotor, length by the cosine rule."""
    rows = rows_of(
        ROTOR, "0 0.5 0.1", f"{SPUN}SPRING 1 2 2 0 0 1 0 0 30 0.5 0.7\nELEMENTS\n  START at=1.angle rate=2\n"
    )
    phi = rows.joint_coordinate[:, 0]
    length = np.sqrt(5.0 - 4.0 * np.cos(phi))
    rate = 2.0 * np.sin(phi) * rows.joint_rate[:, 0] / length
    assert np.ptp(rate) > 0.5
    assert rows.element_effort[:, 0] == pytest.approx(-30 * (length - 0.5) - 0.7 * rate, rel=1e-11)
    assert rows.element_power[:, 0] == pytest.approx(-0.7 * rate**2, rel=1e-11)
    assert rows.element_rate[:, 0] == pytest.approx(rate, rel=1e-11)


def test_an_end_stop_without_damping_returns_the_speed(method):
    """Contact takes half a period, π sqrt(m/k) = 0.0314 s, from 0.1 s on; then the slider returns."""
    name, card = method
    rows = rows_of(
        SLIDER,
        "0 0.2 0.05",
        f"{SLID}ELEMENTS\n"
        "  STOP astop-1 at=1.stroke lower=-1 upper=0.2 stiffness=20000\n"
        "  START at=1.stroke rate=2\n"
        f"{card}",
    )
    half = math.pi * math.sqrt(2 / 20000)
    assert rows.joint_coordinate[-1, 0] == pytest.approx(0.2 - 2 * (0.1 - half), abs=2e-2 * NEAR[name] + 1e-6)
    assert rows.joint_rate[-1, 0] == pytest.approx(-2.0, rel=10 * NEAR[name])


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_stop_with_damping_returns_the_speed_of_hunt_and_crossley(side):
    """m v dv = -k s (1 + b v) ds: v/b - ln(1 + b v)/b² is the same at both ends of the contact."""
    b, v = 0.3, 2.0
    left = brentq(lambda w: b * v - math.log(1 + b * v) + b * w + math.log(1 - b * w), 0.01, v)
    cards = (
        f"{SLID}ELEMENTS\n"
        f"  STOP astop-1 at=1.stroke lower=-0.2 upper=0.2 stiffness=20000 damping={b}\n"
        f"  START at=1.stroke rate={side * v}\n"
        "TOLERANCE 1e-11"
    )
    rows = rows_of(SLIDER, "0 0.2 0.1", cards)
    assert rows.joint_rate[-1, 0] == pytest.approx(-side * left, rel=1e-7)
    assert rows.applied_work[-1] == pytest.approx(left**2 - v**2, rel=1e-6)


def test_a_cable_pulls_only_while_it_is_taut():
    """Slack up to 1.5 m: free flight, half a period, free flight back."""
    cards = (
        f"{SLID}ELEMENTS\n"
        "  CABLE cable-1 from=0(-1,0,0) to=2(0,0,0) stiffness=800 rest=1.5\n"
        "  START at=1.stroke rate=1\n"
        "TOLERANCE 1e-11"
    )
    rows = rows_of(SLIDER, "0 1 0.1", cards)
    assert rows.joint_coordinate[4, 0] == pytest.approx(0.4, abs=1e-12)
    t = np.clip(rows.time - 0.5, 0.0, math.pi / 20)
    taut = np.where(rows.time < 0.5, rows.time, 0.5 + np.sin(20 * t) / 20)
    back = np.where(rows.time > 0.5 + math.pi / 20, rows.time - 0.5 - math.pi / 20, 0.0)
    assert rows.joint_coordinate[:, 0] == pytest.approx(taut - back, abs=1e-8)
    assert rows.element_effort[:4, 0] == pytest.approx(np.zeros(4))


@pytest.mark.parametrize("axis", range(3))
def test_a_bushing_has_six_natural_frequencies(axis):
    """Displacements with sqrt(k/m), turns with sqrt(kr/I), each along its own axis; both are undamped."""
    k, kr = (90.0, 160.0, 250.0), (4.0, 9.0, 16.0)
    mass = "MASS 2 2.5 0 0 0 0.4 0.5 0.6\n"
    ends = "from=1(0,0,0) to=2(0,0,0)"
    stiff, stiff_turns = (" ".join(map(str, each)) for each in (k, kr))
    velocity = [0.0] * 6
    velocity[axis], velocity[3 + axis] = 0.05, 0.1
    cards = f"{mass}ELEMENTS\n  BUSHING bushing-1 {ends} k=({stiff}) kr=({stiff_turns})\n"
    cards += f"VELOCITY 2 {' '.join(map(str, velocity))}"
    rows = rows_of(FREE, "0 1 0.1", cards)
    slow, quick = math.sqrt(k[axis] / 2.5), math.sqrt(kr[axis] / (0.4, 0.5, 0.6)[axis])
    assert rows.position[:, 1, axis] == pytest.approx(0.05 / slow * np.sin(slow * rows.time), abs=1e-8)
    assert rows.element_coordinate[:, 3 + axis] == pytest.approx(
        0.1 / quick * np.sin(quick * rows.time), abs=1e-8
    )


def test_a_bushing_damps_by_its_six_coefficients():
    cards = (
        "MASS 2 2 0 0 0 1 1 1\n"
        "ELEMENTS\n"
        "  BUSHING bushing-1 from=0(0,0,0) to=2(0,0,0) k=(50,0,0) kr=(0,0,8) c=(4,0,0) "
        "cr=(0,0,0.8)\n"
        "VELOCITY 2 1 0 0 0 0 0.5"
    )
    rows = rows_of(FREE, "0 1 0.1", cards)
    assert rows.position[:, 1, 0] == pytest.approx(oscillation(rows.time, 0.0, 1.0, 5.0, 0.2), abs=1e-8)
    turned = oscillation(rows.time, 0.0, 0.5, math.sqrt(8), 0.4 / math.sqrt(8))
    assert rows.element_coordinate[:, 5] == pytest.approx(turned, abs=1e-8)


RACK = """3 0 0 0 0 1 0 1 0 0 0 1
0 0 0 1 0 0 0
0 0 0 1 0 0 0
0 0 0 1 0 0 0
1 2 0 0 0 0 0 0 0 0 1 0 0 1
1 3 0 0 0 0 0 0 1 0 0 1 0 0 0 1 0 0 0 1
1 0 0 0 0 0 0
"""


def test_a_rack_and_pinion_fall_together(method):
    """Stroke = 0.2 θ; (m + I/r²) ẍ = m g, with m = 2, I = 0.5."""
    _, card = method
    cards = (
        f"{SPUN}MASS 3 2 0 0 0 1 1 1\n"
        "GRAVITY 9.81 0 0\n"
        "ELEMENTS\n"
        "  COUPLING coupling-1 1.angle=-0.2 2.stroke=1\n"
        f"{card}"
    )
    rows = rows_of(RACK, "0 1 0.25", cards)
    a = 2 * 9.81 / (2 + 0.5 / 0.04)
    assert rows.joint_coordinate[:, 1] == pytest.approx(a * rows.time**2 / 2, abs=1e-8)
    assert rows.joint_coordinate[:, 0] == pytest.approx(5 * rows.joint_coordinate[:, 1], abs=1e-12)
    # The teeth turn I θ̈ = -0.2 λ, and hold the rack back.
    assert rows.coupling_effort[:, 0] == pytest.approx(np.full(5, 2 * (a - 9.81)), abs=1e-8)


def test_a_differential_shares_the_torque_of_its_carrier():
    """θ_c = (θ_1 + θ_2)/2: each side gets half the carrier's torque.  Three rotors on the ground."""
    deck = "4 0 0 0 0 3 0 0 0 0 0 1\n" + "0 0 0 1 0 0 0\n" * 4
    deck += "".join(f"1 {k} 0 0 0 0 0 0 0 0 1 0 0 1\n" for k in (2, 3, 4)) + "1 0 0 0 0 0 0\n"
    masses = "".join(f"MASS {b} 1 0 0 0 1 1 {inertia}\n" for b, inertia in ((2, 0.4), (3, 0.5), (4, 0.7)))
    rows = rows_of(
        deck,
        "0 1 0.25",
        f"{masses}TORQUE 2 0 0 6\nELEMENTS\n  COUPLING coupling-1 1.angle=2 2.angle=-1 3.angle=-1",
    )
    # 0.4 a = 6 + 2 λ, 0.5 b = -λ, 0.7 c = -λ, 2 a = b + c
    load = -12 / 0.4 / (4 / 0.4 + 1 / 0.5 + 1 / 0.7)
    a, b, c = (6 + 2 * load) / 0.4, -load / 0.5, -load / 0.7
    assert rows.joint_coordinate[-1] == pytest.approx((a / 2, b / 2, c / 2), rel=1e-9)
    assert rows.coupling_effort[:, 0] == pytest.approx(np.full(5, load), rel=1e-9)


@pytest.mark.parametrize("size", [1e-14, 1e12])
def test_a_belt_in_other_units_holds_as_well(size):
    """The factors 0.1 and -0.2 in units of nanometres, or of light years."""
    cards = "MASS 2 1 0 0 0 1 1 0.3\nMASS 3 1 0 0 0 1 1 0.8\nTORQUE 2 0 0 2\n"
    rows = rows_of(
        TWO_ROTORS,
        "0 1 0.5",
        f"{cards}ELEMENTS\n  COUPLING coupling-1 1.angle={0.1 * size!r} 2.angle={-0.2 * size!r}\n",
    )
    turn = 2 / (0.3 + 0.8 / 4)
    assert rows.joint_coordinate[-1] == pytest.approx((turn / 2, turn / 4), rel=1e-8)
    # 0.1 λ = 0.3 turn - 2
    assert rows.coupling_effort[:, 0] == pytest.approx(np.full(3, (0.3 * turn - 2) / (0.1 * size)), rel=1e-8)


def test_a_link_of_two_spheres_keeps_its_length_and_one_of_revolute_and_sphere_its_plane():
    cards = "MASS 2 2 0 0 0 0.4 0.5 0.6\nGRAVITY 0.3 -9.81 0.2\nELEMENTS\n"
    cards += "  JOINT link {kind} from=0(0,1,0) to=2(0,0,0){axis} length=1\n"
    cards += "TOLERANCE 1e-11"
    sphere = rows_of(FREE, "0 1 0.1", cards.format(kind="sphsph", axis=""))
    far = np.linalg.norm(sphere.position[:, 1] - (0, 1, 0), axis=1)
    assert far == pytest.approx(np.ones(11), abs=1e-12)
    plane = rows_of(FREE, "0 1 0.1", cards.format(kind="revsph", axis=" axis_from=(0,0,1)"))
    assert plane.position[:, 1, 2] == pytest.approx(np.zeros(11), abs=1e-12)
    # A point mass on a rod of 1 m in the plane x y: energy of the planar pendulum.
    v2 = np.sum(plane.velocity[:, 1, :2] ** 2, axis=1)
    assert v2 == pytest.approx(2 * (0.3 * plane.position[:, 1, 0] - 9.81 * plane.position[:, 1, 1]), abs=1e-8)


def test_a_revolute_cylindrical_joint_is_the_two_joints_with_a_massless_body_between():
    """YOUNG dissertation, section 6.2.2: the composite and the pair of simple joints give the same motion."""
    masses = "MASS 2 1.5 0.3 0.1 0 0.2 0.3 0.4 0.01 0.02 0.03\n"
    rest = "GRAVITY 0.5 -9.81 1.2\nVELOCITY 2 0 0 0 0.4 0.9 -0.6\nTOLERANCE 1e-11\n"
    composite = rows_of(
        FREE,
        "0 0.6 0.1",
        f"{masses}{rest}ELEMENTS\n"
        "  JOINT revcyl-1 revcyl from=0(0,0,0) to=2(0,0,0) axis_from=(0,0,1) axis_to=(1,0,0)\n",
    )
    two = """3 0 0 0 0 1 1 0 0 0 0 1
0 0 0 1 0 0 0
0 0 0 1 0 0 0
0 0 0 1 0 0 0
1 3 0 0 0 0 0 0 0 0 1 0 0 1
3 2 0 0 0 0 0 0 1 0 0 1 0 0
1 0 0 0 0 0 0
"""
    shown = "ELEMENTS\n  SPRING shown at=1.angle\n"  # bears nothing
    pair = rows_of(two, "0 0.6 0.1", f"{masses}{rest}{shown}")
    assert composite.position[:, 1] == pytest.approx(pair.position[:, 1], abs=1e-8)
    assert composite.angular_velocity[:, 1] == pytest.approx(pair.angular_velocity[:, 1], abs=1e-8)
    # The cylindrical joint is the second of the pair, its body J that of the composite.
    assert composite.composite_force[:, 0] == pytest.approx(pair.reaction_force[:, 1], abs=1e-7)
    assert composite.composite_torque[:, 0] == pytest.approx(pair.reaction_torque[:, 1], abs=1e-7)


def test_initial_joint_rates_move_a_serial_arm():
    """ω2 = 0.5, ω3 = 0.5 + 2 rad/s; the second joint, 1 m away, moves at 0.5 m/s."""
    cards = (
        "MASS 2 1 0.5 0 0 1 1 1\n"
        "MASS 3 1 0.2 0 0 1 1 1\n"
        "ELEMENTS\n"
        "  START at=1.angle rate=0.5\n"
        "  START at=2.angle rate=2"
    )
    rows = rows_of(ARM, "0 0.1 0.1", cards)
    assert rows.angular_velocity[0, 1:, 2] == pytest.approx((0.5, 2.5), rel=1e-12)
    assert rows.velocity[0, 2] == pytest.approx((0.0, 0.5, 0.0), abs=1e-12)


def test_initial_joint_rates_that_a_coupling_forbids_are_named():
    """The coupling makes the rates equal; before, the message spoke of drivers, which the deck lacks."""
    cards = (
        "MASS 2 1 0 0 0 1 1 1\n"
        "MASS 3 1 0 0 0 1 1 1\n"
        "ELEMENTS\n"
        "  START at=1.angle rate=1\n"
        "  START at=2.angle rate=5\n"
        "  COUPLING coupling-1 1.angle=1 2.angle=-1"
    )
    with pytest.raises(ModelError) as refused:
        rows_of(TWO_ROTORS, "0 0.1 0.1", cards)
    (fault,) = refused.value.faults
    assert "the initial joint rates contradict each other" in fault.message and fault.about == "start-2"


def test_a_belt_makes_inertias_one(method):
    """Pulleys of 0.1 m and 0.2 m: 0.1 θ1 = 0.2 θ2; a torque on the first."""
    _, card = method
    cards = (
        "MASS 2 1 0 0 0 1 1 0.3\n"
        "MASS 3 1 0 0 0 1 1 0.8\n"
        "TORQUE 2 0 0 2\n"
        "ELEMENTS\n"
        "  COUPLING coupling-1 1.angle=0.1 2.angle=-0.2\n" + card
    )
    rows = rows_of(TWO_ROTORS, "0 1 0.5", cards)
    assert rows.joint_coordinate[-1, 0] == pytest.approx(2 / (0.3 + 0.8 / 4) / 2, rel=1e-8)


def turned_bushing(about, end):
    """A rotor that turns by 1 rad/s on a bushing with stiffnesses about x, y, z."""
    cards = (
        f"{SPUN}ELEMENTS\n"
        "  FUNCTION 1 polynomial 0 1\n"
        "  DRIVE angle-1 at=1.angle value=1\n"
        f"  BUSHING bushing-1 from=1(0,0,0) to=2(0,0,0) k=(0,0,0) kr=({about})"
    )
    return rows_of(ROTOR, f"0 {end} 0.5", cards, "inverse")


def test_a_bushing_about_the_axis_of_a_shaft_winds_up_over_many_turns():
    rows = turned_bushing("0 0 7", 9)
    assert rows.driver_effort[:, 0] == pytest.approx(7 * rows.time, abs=1e-9)


def test_a_bushing_stops_the_run_before_its_other_angles_jump():
    """At a quarter turn about z the axes x of both bodies stand at right angles: t = π/2 s."""
    with pytest.raises(AnalysisError, match="bushing 1 have turned by a quarter turn") as raised:
        turned_bushing("5 0 7", 2)
    assert raised.value.time == pytest.approx(math.pi / 2, abs=0.5)
    assert turned_bushing("5 0 7", 1.5).driver_effort[-1, 0] == pytest.approx(7 * 1.5, abs=1e-9)


def test_a_bushing_ends_a_free_motion_by_every_method_before_its_angles_jump(method):
    """A body that spins at 3 rad/s without hindrance about z; its angles are held about x only."""
    _, card = method
    cards = (
        "MASS 2 1 0 0 0 1 1 1\n"
        "ELEMENTS\n"
        "  BUSHING bushing-1 from=0(0,0,0) to=2(0,0,0) k=(0,0,0) kr=(5,0,0) c=(0,0,0) "
        "cr=(0,0,0)\n"
        f"{card}"
    )
    with pytest.raises(AnalysisError, match="bushing 1 have turned by a quarter turn") as raised:
        rows_of(FREE, "0 1 0.5", f"{cards}VELOCITY 2 0 0 0 0 0 3\n")
    assert raised.value.time == pytest.approx(math.pi / 6, abs=1e-2)


@pytest.mark.parametrize("start, noted", [(0.25, True), (0.05, False)])
def test_a_stop_that_is_pressed_at_the_start_is_noted_with_depth_and_force(start, noted):
    """The end of the slide stands 0.15 m after the stop: 400 N/m · 0.15 m."""
    cards = (
        f"{SLID}ELEMENTS\n"
        f"  FUNCTION 1 polynomial {start} 0\n"
        "  DRIVE stroke-1 at=1.stroke value=1\n"
        "  STOP astop-1 at=1.stroke lower=-1 upper=0.1 stiffness=400\n"
    )
    analysis = analysis_of(model_of(SLIDER, "0 1 1", cards))
    analysis.start()
    found = [fault for fault in analysis.warnings if "beyond its limit" in fault.message]
    assert len(found) == noted
    if noted:
        assert "0.15 m beyond" in found[0].message and "pushes with 60 N;" in found[0].message
        assert (found[0].subject, found[0].place.line) == ("astop-1", 12)
