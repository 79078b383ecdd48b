"""Cards of functions and elements in VSDF decks: closed forms, and the same mechanism in a YOUNG deck."""

import math
from dataclasses import fields
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from flexmb_cli.dialects.vsdf.build import build_vsdf
from flexmb_cli.fe.build_mechanism import flexible_mechanism
from flexmb_cli.solvers.constrained.element_rows import FlexibleElementRows
from flexmb_cli.solvers.constrained.flexible_dynamics import FlexibleDynamics
from tests.dialects.vsdf.vsdf_decks import read, reported
from tests.solvers.constrained.element_decks import ARM
from tests.solvers.constrained.element_decks import rows_of as young_rows

TURNING = """VSDF ROTOR
BODY
 1,RIGD
RIGI
 1,1
 1,1,0.5
NODE
 0,1,0,0,0
 0,2,0,0,1
 0,3,2,0,0
 1,1,0,0,0
 1,2,0,0,1
 1,3,1,0,0
JOIN
 1,REVO,0,1,2,1,1,2
"""
SLIDING = """VSDF SLIDER
BODY
 1,RIGD
RIGI
 1,2
 1,1,1
NODE
 0,1,0,0,0
 0,2,1,0,0
 0,3,0,1,0
 0,4,-1,0,0
 1,1,0,0,0
 1,2,1,0,0
 1,3,0,1,0
JOIN
 1,TRAN,0,1,2,1,1,2,3,3
"""
TWO_LINKS = """VSDF ARM
BODY
 1,RIGD
 2,RIGD
RIGI
 1,1.5,0.4
 0.1,0.2,0.2
 2,0.8,0.3
 0.05,0.1,0.1
POSI
 2,1
NODE
 0,1,0,0,0
 0,2,0,0,1
 0,3,1,2,0
 1,1,0,0,0
 1,2,0,0,1
 1,3,1,0,0
 1,4,1,0,1
 2,1,0,0,0
 2,2,0,0,1
 2,3,0.6,0,0
JOIN
 1,REVO,0,1,2,1,1,2
 2,REVO,1,3,4,2,1,2
GRAV
 0,-9.81,0
"""
METHODS = {"RK45": "RK45,1e-11", "RAD5": "RAD5,1e-9", "GALF": "GALF,0.9"}
# Interpreted kernels take seconds for the steps of the implicit methods.
BY_METHODS = ["RK45", *(pytest.param(word, marks=pytest.mark.long_motion) for word in ("RAD5", "GALF"))]
NEAR = {"RK45": 1e-8, "RAD5": 1e-6, "GALF": 2e-3}


def rows_of(mechanism, end, step, cards, method="RK45"):
    """All rows of a mechanism with cards."""
    text = f"{mechanism}{cards}\nINTG\n {METHODS[method]}\nTIME\n {end},{step}\nEND\nSTAR\nSTOP\n"
    model, _ = build_vsdf(read(text), Path())
    blocks = list(FlexibleDynamics(flexible_mechanism(model)[0]).rows())
    names = [field.name for field in fields(FlexibleElementRows) if "amplitude" not in field.name]
    return SimpleNamespace(
        total=np.concatenate([block.total for block in blocks]),
        **{name: np.concatenate([getattr(block, name) for block in blocks]) for name in names},
    )


def faults(cards):
    return [
        line for line in reported(f"{TURNING}{cards}\nTIME\n 1,0.1\nEND\nSTAR\nSTOP\n") if ": error: " in line
    ]


@pytest.mark.parametrize("method", BY_METHODS)
def test_a_torsional_spring_with_damper_and_preload_swings_as_in_textbooks(method):
    """Rao, Mechanical Vibrations, section 2.6: I = 0.5, k = 8, c = 0.4, middle 0.1 - 1.6/8."""
    rows = rows_of(
        TURNING,
        2,
        0.1,
        "ELEMENTS\n"
        "  SPRING tspr-1 at=1.angle stiffness=8 rest=0.1 damping=0.4 preload=1.6\n"
        "  START at=1.angle rate=0.4",
        method,
    )
    zeta, omega = 0.4 / (2 * math.sqrt(8 * 0.5)), 4.0
    damped = omega * math.sqrt(1 - zeta**2)
    b = (0.4 + zeta * omega * 0.1) / damped
    t = rows.time
    wanted = -0.1 + np.exp(-zeta * omega * t) * (0.1 * np.cos(damped * t) + b * np.sin(damped * t))
    assert rows.joint_coordinate[:, 0] == pytest.approx(wanted, abs=0.2 * NEAR[method])
    assert rows.element_power[:, 0] == pytest.approx(-0.4 * rows.joint_rate[:, 0] ** 2, abs=1e-12)
    assert np.ptp(rows.total) < NEAR[method]


@pytest.mark.parametrize("method", BY_METHODS)
def test_a_hardening_spring_by_a_function_has_duffings_period(method):
    """m ẍ + β x³ = 0 from A: T = Γ(1/4)² / (sqrt(π) A) sqrt(m/β) (Rao, section 13.3)."""
    period = math.gamma(0.25) ** 2 / (math.sqrt(math.pi) * 0.5) * math.sqrt(2.0 / 40.0)
    cards = (
        "ELEMENTS\n"
        "  FUNCTION 7 polynomial 0 0 0 40\n"
        "  SPRING aspr-1 at=1.stroke stiffness=0 rest=-0.5 curve=7"
    )
    rows = rows_of(SLIDING, f"{period:.17g}", f"{period / 4:.17g}", cards, method)
    assert rows.joint_coordinate[:, 0] == pytest.approx((0, -0.5, -1, -0.5, 0), abs=2 * NEAR[method])


def test_a_stop_returns_the_speed_and_takes_half_a_period():
    """From 0.1 s on, π sqrt(m/k); the slider then returns with the speed it came with."""
    rows = rows_of(
        SLIDING,
        0.2,
        0.05,
        "ELEMENTS\n  STOP asto-1 at=1.stroke lower=-1 upper=0.2 stiffness=20000\n  START at=1.stroke rate=2",
    )
    half = math.pi * math.sqrt(2 / 20000)
    assert rows.joint_coordinate[-1, 0] == pytest.approx(0.2 - 2 * (0.1 - half), abs=1e-7)


def test_a_cable_is_slack_up_to_its_length():
    """Free flight for 0.5 s, half a period π/20 s of 800 N/m and 2 kg, free flight back."""
    rows = rows_of(
        SLIDING,
        1,
        0.1,
        "ELEMENTS\n  CABLE cabl-1 from=0:4 to=1:1 stiffness=800 rest=1.5\n  START at=1.stroke rate=1",
    )
    t = np.clip(rows.time - 0.5, 0.0, math.pi / 20)
    taut = np.where(rows.time < 0.5, rows.time, 0.5 + np.sin(20 * t) / 20)
    back = np.where(rows.time > 0.5 + math.pi / 20, rows.time - 0.5 - math.pi / 20, 0.0)
    assert rows.joint_coordinate[:, 0] == pytest.approx(taut - back, abs=1e-8)


def test_a_braking_rotor_stops_when_friction_has_taken_its_spin():
    """Preload 4 N, mu 0.25, radius 0.1: -0.1 N m on 0.5 kg m² from 0.2 rad/s, at rest after 1 s."""
    rows = rows_of(
        TURNING,
        1.2,
        0.1,
        "ELEMENTS\n"
        "  FRICTION fric-1 joint=1 dynamic=0.25 static=0.25 stribeck=0.1 creep=1e-5 "
        "radius=0.1 preload=4\n"
        "  START at=1.angle rate=0.2",
        "RAD5",
    )
    wanted = np.maximum(0.2 - 0.2 * rows.time, 0.0)
    assert rows.joint_rate[:, 0] == pytest.approx(wanted, abs=3e-4)
    assert rows.element_effort[3, 0] == pytest.approx(-1.0, rel=1e-9)
    assert rows.element_power[3, 0] == pytest.approx(-0.1 * rows.joint_rate[3, 0], rel=1e-9)


SHOWN = "  SPRING shown at=1.angle\n"  # without forces: results of decks with elements hold coordinates


@pytest.mark.parametrize(
    ("card", "value"),
    [
        ("sine 0.1 0.2 3 0.4", lambda t: 0.1 + 0.2 * math.sin(3 * t + 0.4)),
        ("step 0.2 0 0.8 1", lambda t: _step((t - 0.2) / 0.6)),
        ("polynomial 0 1 2", lambda t: t + 2 * t * t),
    ],
)
def test_a_motion_follows_a_function(card, value):
    rows = rows_of(TURNING, 1, 0.125, f"ELEMENTS\n  FUNCTION 3 {card}\n{SHOWN}MOTN\n 1,ANGL,1,5,3")
    assert rows.joint_coordinate[:, 0] == pytest.approx([value(t) for t in rows.time], abs=1e-9)


def _step(s):
    """10 s³ - 15 s⁴ + 6 s⁵."""
    s = min(max(s, 0.0), 1.0)
    return s**3 * (10 - 15 * s + 6 * s * s)


def test_a_rate_by_a_function_turns_by_its_integral():
    rows = rows_of(TURNING, 1, 0.25, f"ELEMENTS\n  FUNCTION 3 polynomial 1 4\n{SHOWN}MOTN\n 1,ANGL,1,6,3")
    assert rows.joint_coordinate[:, 0] == pytest.approx(rows.time + 2 * rows.time**2, abs=1e-10)


def test_a_force_by_a_product_of_functions_moves_a_slider():
    """2 kg under 6 t · 2 N: x = t³ (one factor a table, the other a polynomial)."""
    cards = (
        "TABL\n"
        " 1,0,0\n"
        " 1,2,12\n"
        "ELEMENTS\n"
        "  FUNCTION 5 table points=1\n"
        "  FUNCTION 6 polynomial 2\n"
        "  FUNCTION 7 product 5 6\n"
        "  SPRING shown at=1.stroke\n"
        "FORC\n"
        " 1,1,1,0,0,0,7"
    )
    rows = rows_of(SLIDING, 1, 0.25, cards)
    assert rows.joint_coordinate[:, 0] == pytest.approx(rows.time**3, abs=1e-9)


def test_a_support_moved_by_a_sine_drives_an_oscillator():
    """2 kg on 50 N/m whose other end, a pinned body, moves by 0.1 sin 3t: x by Rao, section 3.6."""
    text = SLIDING.replace(" 1,RIGD\n", " 1,RIGD\n 2,RIGD\n").replace(
        " 1,2\n 1,1,1\n", " 1,2\n 1,1,1\n 2,1\n 1,1,1\n"
    )
    text = text.replace(
        "JOIN\n", " 2,1,0,0,0\nPOSI\n 2,1\nPINN\n 2,1,111,1,0,0\nELEMENTS\n  SUPPORT supp-1 pin=1 x=9\nJOIN\n"
    )
    rows = rows_of(
        text,
        2,
        0.25,
        "ELEMENTS\n  FUNCTION 9 sine 0 0.1 3\n  SPRING lspr-1 from=1:1 to=2:1 stiffness=50 rest=1",
    )
    X = 0.1 * 25 / (25 - 9)
    wanted = X * np.sin(3 * rows.time) - X * 3 / 5 * np.sin(5 * rows.time)
    # The support begins with a speed; the slider at rest.
    assert rows.joint_coordinate[:, 0] == pytest.approx(wanted, abs=1e-9)
    assert rows.position[:, 1, 0] == pytest.approx(1 + 0.1 * np.sin(3 * rows.time), abs=1e-12)


def test_a_motor_by_a_function_turns_against_inertia():
    rows = rows_of(
        TURNING, 1, 0.25, "ELEMENTS\n  FUNCTION 2 polynomial 0 3\n  MOTOR tmot-1 at=1.angle effort=2"
    )
    assert rows.joint_coordinate[:, 0] == pytest.approx(rows.time**3, abs=1e-9)
    assert np.ptp(rows.total) < 1e-9


ELEMENTS = (
    (
        "ELEMENTS\n"
        "  SPRING tspring-1 at=1.angle stiffness=20 rest=0.2 damping=0.3\n"
        "  SPRING lspring-1 from=0(1,2,0) to=3(0.6,0,0) stiffness=30 rest=1.2 damping=0.5",
        "ELEMENTS\n"
        "  SPRING tspr-1 at=1.angle stiffness=20 rest=0.2 damping=0.3\n"
        "  SPRING lspr-1 from=0:3 to=2:3 stiffness=30 rest=1.2 damping=0.5",
    ),
    (
        "ELEMENTS\n"
        "  STOP tstop-1 at=1.angle lower=-0.5 upper=3 stiffness=4000 damping=0.2\n"
        "  CABLE cable-1 from=0(1,2,0) to=3(0.6,0,0) stiffness=300 rest=1.9 damping=0.1",
        "ELEMENTS\n"
        "  STOP tsto-1 at=1.angle lower=-0.5 upper=3 stiffness=4000 damping=0.2\n"
        "  CABLE cabl-1 from=0:3 to=2:3 stiffness=300 rest=1.9 damping=0.1",
    ),
    (
        "ELEMENTS\n"
        "  BUSHING bushing-1 from=0(1,2,0) to=3(0.6,0,0) k=(90,160,250) kr=(6,9,16) c=(5,6,7) "
        "cr=(0.2,0.3,0.4)",
        "ELEMENTS\n  BUSHING bush-1 from=0:3 to=2:3 k=(90,160,250) kr=(6,9,16) c=(5,6,7) cr=(0.2,0.3,0.4)",
    ),
    (
        "ELEMENTS\n  COUPLING coupling-1 1.angle=2 2.angle=3",
        "ELEMENTS\n  COUPLING coup-1 1.angle=2 2.angle=3",
    ),
    (
        "ELEMENTS\n"
        "  FRICTION friction-1 joint=1 dynamic=0.2 static=0.3 stribeck=0.1 creep=0.01 "
        "radius=0.05\n"
        "  FRICTION friction-2 joint=2 dynamic=0.1 static=0.1 stribeck=1 creep=0.01 "
        "radius=0.05 preload=3",
        "ELEMENTS\n"
        "  FRICTION fric-1 joint=1 dynamic=0.2 static=0.3 stribeck=0.1 creep=0.01 "
        "radius=0.05\n"
        "  FRICTION fric-2 joint=2 dynamic=0.1 static=0.1 stribeck=1 creep=0.01 radius=0.05 "
        "preload=3",
    ),
    (
        "ELEMENTS\n"
        "  FUNCTION 4 sine 0 3 5\n"
        "  MOTOR tmotor-1 at=2.angle effort=4\n"
        "  FUNCTION 5 table -9 -9 0 0 9 3\n"
        "  SPRING tspring-1 at=1.angle stiffness=0 rest=0.1 curve=5",
        "ELEMENTS\n"
        "  FUNCTION 4 sine 0 3 5\n"
        "  FUNCTION 5 table points=1\n"
        "TABL\n"
        " 1,-9,-9\n"
        " 1,0,0\n"
        " 1,9,3\n"
        "ELEMENTS\n"
        "  MOTOR tmot-1 at=2.angle effort=4\n"
        "  SPRING tspr-1 at=1.angle stiffness=0 rest=0.1 curve=5",
    ),
)


@pytest.mark.long_motion
@pytest.mark.parametrize(("young", "vsdf"), ELEMENTS)
def test_an_arm_moves_as_the_same_arm_in_a_young_deck(young, vsdf):
    """Gears of the two dialects are constraints between bodies of other numbers and other joint types."""
    masses = "MASS 2 1.5 0.4 0 0 0.1 0.2 0.2\nMASS 3 0.8 0.3 0 0 0.05 0.1 0.1\nGRAVITY 0 -9.81 0\n"
    # A bushing ends the longer run: its bodies turn by more than a quarter.
    step = 0.01 if "BUSHING" in vsdf else 0.1
    one = young_rows(ARM, f"0 {5 * step} {step}", f"{masses}{young}\nTOLERANCE 1e-12")
    other = rows_of(TWO_LINKS, 5 * step, step, f"{vsdf}")
    for field in (
        "joint_coordinate",
        "joint_rate",
        "element_coordinate",
        "element_effort",
        "element_power",
        "coupling_effort",
    ):
        expected = getattr(one, field)
        # Power, the product of an effort of 90 and a rate, has the error of the rate times the effort.
        scale = np.abs(expected).max(initial=1.0)
        assert getattr(other, field) == pytest.approx(expected, abs=1e-8 * scale), field
    assert other.reaction_force == pytest.approx(one.reaction_force, abs=1e-7)


def test_slips_are_told_with_place_object_and_remedy():
    assert faults("ELEMENTS\n  SPRING tspr-1 at=2.angle stiffness=8") == [
        "17:20: error: tspr-1: joint number 2 is outside 1..1"
    ]
    assert faults("ELEMENTS\n  STOP asto-1 at=1.stroke lower=0 upper=1 stiffness=5") == [
        "17:18: error: asto-1: joint 1 (joint 1) has an angle, not a stroke; take 1.angle"
    ]
    assert faults(
        "TABL\n 1,0,0\n 1,1,1\nELEMENTS\n  FUNCTION 1 table points=1\n  MOTOR tmot-1 at=1.angle effort=1"
    ) == ["20:3: error: 1: 1 is a table; functions and tables have numbers of their own"]
    assert faults("ELEMENTS\n  FUNCTION 4 sine 1\n  MOTOR tmot-1 at=1.angle effort=4") == [
        "17:3: error: 4: sine takes mean amplitude omega phase; amplitude and omega must be given"
    ]
    assert faults("ELEMENTS\n  SPRING lspr-1 from=0:1 to=0:3 stiffness=5") == [
        "17:29: error: lspr-1: both ends are on the ground, so nothing changes between them"
    ]
