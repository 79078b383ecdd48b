"""Friction by bristles in contacts and joints sticks, and slips as scipy integrates the same equations."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from flexmb_cli.errors import DeckError, ModelError
from tests.dialects.dafms.test_dafms_elements import rows_of as dafms_rows
from tests.solvers.constrained.element_decks import ARM, FREE, METHODS, SLIDER, model_of
from tests.solvers.constrained.element_decks import rows_of as young_rows
from tests.solvers.constrained.elements.test_contacts import DIALECTS, EXPLICIT, IMPLICIT, ball, on_plane

STATIC, DYNAMIC, STRIBECK, STIFFNESS, DAMPING = 0.5, 0.3, 0.05, 2e3, 12.0
LAW = f"stribeck={STRIBECK} bristle={STIFFNESS} bristle_damping={DAMPING}"
G, DEPTH = 10.0, 5e-4


def moved(push, speed, times):
    """Displacement, speed and bristles' force per weight of a block of 1 kg that is pushed by N at (t, x).

    Canudas de Wit and others (1995), equations (1) to (5), integrated by scipy's Radau method.
    """

    def rates(t, y):
        x, v, s = y
        mu = DYNAMIC + (STATIC - DYNAMIC) * math.exp(-((v / STRIBECK) ** 2))
        ds = STIFFNESS * (v - abs(v) * s / mu)
        return [v, push(t, x) - G * (s + DAMPING / STIFFNESS * ds), ds]

    found = solve_ivp(
        rates, (0.0, times[-1]), [0.0, speed, 0.0], "Radau", times, rtol=1e-10, atol=1e-13, max_step=0.01
    )
    return found.y


def on_slope(dialect, angle, end, step, method):
    """A sphere that can hardly turn, on a plane: gravity is tilted so that its weight across it is 1 N."""
    block = ball(
        (0.0, 0.0, 0.05 - DEPTH), (0.0, 0.0, 0.0), g=(G * math.tan(angle), 0.0, -G), m=1.0, J=1e15
    )  # fmt: skip
    law = f"stiffness={G / DEPTH} damping=2 friction={DYNAMIC} static={STATIC} {LAW}"
    rows = DIALECTS[dialect](block, end, step, on_plane(law), method)
    return rows.position[:, 1 if dialect == "young" else 0, 0]


@pytest.mark.parametrize("method", [EXPLICIT, IMPLICIT])
@pytest.mark.parametrize("dialect", DIALECTS)
def test_a_block_on_a_slope_sticks_below_the_angle_of_friction_and_slides_above(dialect, method):
    for angle in (math.atan(0.2), math.atan(0.6)):
        x = on_slope(dialect, angle, 0.5, 0.05, method)
        found = moved(lambda t, x, angle=angle: G * math.tan(angle), 0.0, np.linspace(0.0, 0.5, 11))
        assert x == pytest.approx(found[0], abs=1e-7)


@pytest.mark.long_motion
@pytest.mark.parametrize("dialect", DIALECTS)
def test_a_block_below_the_angle_of_friction_does_not_creep(dialect):
    """Once its bristles have settled it stays where it is, at most 1e-9 m in 100 s."""
    x = on_slope(dialect, math.atan(0.2), 102, 1.0, EXPLICIT)
    assert np.ptp(x[2:]) < 1e-9


BLOCK = """    1    3
DFMB BLOCK
    1    1    1    0    0
    1    0    0    0    0
    0
    0
  400
      .005
CONN
    0
MASS
    1       1.0
INER
    1       1.0       1.0       1.0
EULT
    1       0.0       0.0       0.0       1.0
GRAV
    0       0.0       0.0     -10.0
TOLR
   1.000E-11   1.000E-12
"""
SPRING, SPEED = 50.0, 0.2  # N/m, and m/s of its end
LINES = (
    "ELEMENTS\n"
    f"  FUNCTION 1 polynomial 0 {SPRING * SPEED}\n"
    "  MOTOR pull at=1.{c} effort=1\n"
    f"  SPRING back at=1.{{c}} stiffness={SPRING}\n"
    f"  FRICTION guide joint=1 dynamic={DYNAMIC} static={STATIC} {LAW}\n"
)
STEPS = "TOLERANCE 1e-11\n"
YOUNG_METHODS = METHODS | {"DOP853": STEPS, "RAD5": f"RAD5\n{STEPS}"}


def pulled():
    """Displacement and speed of the block on the spring."""
    return moved(lambda t, x: SPRING * (SPEED * t - x), 0.0, np.linspace(0.0, 2.0, 401))


@pytest.mark.long_motion
@pytest.mark.parametrize("method", METHODS)
def test_a_block_on_a_spring_sticks_and_slips_as_scipy_says(method):
    """Friction of the joint, whose normal force is the weight; GALF is of order 2."""
    cards = f"MASS 2 1 0 0 0 1 1 1\nGRAVITY 0 0 -{G}\n{YOUNG_METHODS[method]}{LINES.format(c='stroke')}"
    rows, (x, v, _), error = young_rows(SLIDER, "0 2 0.005", cards), pulled(), 1e-8
    stuck = v < 0.01
    assert np.sum(np.diff(stuck.astype(int)) != 0) >= 3  # it sticks, slips, sticks and slips
    assert rows.joint_coordinate[:, 0] == pytest.approx(x, abs=2e-6 if method == "GALF" else error)
    assert rows.joint_rate[:, 0] == pytest.approx(v, abs=2e-5 if method == "GALF" else error)
    assert rows.total == pytest.approx(np.full(401, rows.total[0]), abs=1e-4 if method == "GALF" else error)


@pytest.mark.long_motion
@pytest.mark.parametrize("method", ["dop853", "sdirk4", "radau", "lsoda"])
def test_a_block_in_a_hinge_sticks_and_slips_as_scipy_says(method):
    rows = dafms_rows(LINES.format(c="t1"), method, BLOCK)
    assert rows.q[:, 0] == pytest.approx(pulled()[0], abs=1e-8)


@pytest.mark.parametrize(
    ("keys", "fault"),
    [
        ("friction=0.3 bristle=2e3", "ELEMENTS-270"),
        ("friction=0.3 bristle=-1 bristle_damping=3", "ELEMENTS-270"),
        ("bristle=2e3 bristle_damping=3", "ELEMENTS-271"),
    ],
)
def test_bristles_need_damping_and_friction(keys, fault):
    line = "CONTACT floor plane-sphere from=0(0,0,0) to=2(0,0,0) normal=(0,0,1) radius_to=1"
    assert fault in ids_of(f"{line}\n    stiffness=1 {keys}")


def test_pairs_that_are_searched_have_no_bristles():
    line = "CONTACT pile sphere-sphere from=2-3(0,0,0) to=2-3(0,0,0) radius_from=0.1 radius_to=0.1"
    law = "stiffness=1 friction=0.3 bristle=2e3 bristle_damping=3"
    assert "ELEMENTS-272" in ids_of(f"{line}\n    {law}", ARM)


def ids_of(line, mechanism=FREE):
    return [fault.id for fault in faults_of(line, mechanism)]


def faults_of(line, mechanism=FREE):
    cards = "".join(f"MASS {k} 1 0 0 0 1 1 1\n" for k in range(2, int(mechanism[0]) + 1))
    try:
        model_of(mechanism, "0 1 1", f"{cards}ELEMENTS\n  {line}")
    except (DeckError, ModelError) as error:
        return error.faults
    return []
