"""Points on curves: slots, rails and tracks in space; closed forms, other constraints, all integrators.

Values of cycloid, Scotch yoke and Geneva wheel: `reference/motion`, problems curve-cycloid, slot-scotch-yoke
and slot-geneva, closed forms.
"""

import math

import numpy as np
import pytest

from flexmb_cli.errors import AnalysisError, DeckError
from tests.solvers.constrained.element_decks import METHODS, analysis_of, model_of, rows_of

LONG = [pytest.param(n, marks=() if n == "DOP853" else pytest.mark.long_motion) for n in METHODS]
BEAD = "2 0 0 0 0 0 0 0 0 0 0 1\n0 0 0 1 0 0 0\n{} {} {} 1 0 0 0\n1 0 0 0 0 0 0\n"
WEIGHT = "GRAVITY 0 0 -9.81\n"
# The errors below fall with the tolerance, tenfold for tenfold from 1e-9 on.
FINE = "TOLERANCE 1e-12\n"
CYCLOID = f"""MASS 2 0.2 0 0 0 0.01 0.01 0.01
{WEIGHT}ELEMENTS
  FUNCTION line polynomial 0 0.25
  FUNCTION wave sine 0 0.25 1
  FUNCTION x sum line wave
  FUNCTION z sine -0.25 0.25 1 -1.5707963267948966
  CURVE rail from=0(0,0,0) to=2(0,0,0) x=x z=z begin=-3.1 end=3.1
"""


def bead(x, y, z):
    return BEAD.format(*(repr(float(c)) for c in (x, y, z)))


@pytest.mark.parametrize("name", LONG)
@pytest.mark.parametrize("phi", [0.3, 2.6])
def test_a_bead_on_a_cycloid_has_the_period_of_huygens(phi, name):
    """S = 4 R sin(phi/2) = S0 cos(sqrt(g/(4R)) t), at every amplitude."""
    start = bead(0.25 * (phi + math.sin(phi)), 0, -0.25 * (1 + math.cos(phi)))
    rows = rows_of(start, "0 3 0.1", f"{CYCLOID}{METHODS[name]}")
    near = {"DOP853": 1e-8, "RAD5": 1e-6, "GALF": 2e-3}[name]
    S = 4 * 0.25 * math.sin(phi / 2) * np.cos(math.sqrt(9.81) * rows.time)
    p = 2 * np.arcsin(S)
    assert rows.position[:, 1, 0] == pytest.approx(0.25 * (p + np.sin(p)), abs=near)
    assert rows.position[:, 1, 2] == pytest.approx(-0.25 * (1 + np.cos(p)), abs=near)
    # Arc lengths count from the beginning, at p = -3.1.
    assert rows.curve_position[:, 0] == pytest.approx(S + math.sin(1.55), abs=10 * near)
    speed = -4 * 0.25 * math.sin(phi / 2) * math.sqrt(9.81) * np.sin(math.sqrt(9.81) * rows.time)
    assert rows.curve_speed[:, 0] == pytest.approx(speed, abs=10 * near)
    assert rows.curve_force[:, 0] == pytest.approx(
        0.2 * (rows.acceleration[:, 1] - (0, 0, -9.81)), abs=1e-9 if name == "DOP853" else 1e-2
    )
    assert rows.curve_force[:, 0, 1] == pytest.approx(np.zeros(31), abs=1e-12)


def test_a_bead_slides_down_a_helix():
    """Along the slope: s'' = -g c/sqrt(r² + c²), and the pressure m v_t²/r towards the axis."""
    r, c = 0.4, 0.1
    cards = f"""MASS 2 0.5 0 0 0 0.01 0.01 0.01
{WEIGHT}{FINE}ELEMENTS
  FUNCTION x sine 0 0.4 1 1.5707963267948966
  FUNCTION y sine 0 0.4 1
  FUNCTION z polynomial 0 0.1
  CURVE spiral from=0(0,0,0.2) to=2(0,0,0) x=x y=y z=z begin=-40 end=1
"""
    rows = rows_of(bead(r, 0, 0.2), "0 2 0.1", cards)
    size, g = math.hypot(r, c), 9.81
    phi = -g * c / size**2 * rows.time**2 / 2
    assert rows.position[:, 1, 0] == pytest.approx(r * np.cos(phi), abs=1e-10)
    assert rows.position[:, 1, 2] == pytest.approx(0.2 + c * phi, abs=1e-10)
    assert rows.curve_position[:, 0] == pytest.approx(size * (40 + phi), abs=1e-10)
    rate = -g * c / size**2 * rows.time
    towards = 0.5 * r * rate**2
    inward = -(rows.curve_force[:, 0, 0] * np.cos(phi) + rows.curve_force[:, 0, 1] * np.sin(phi))
    assert inward == pytest.approx(towards, abs=1e-8)


def test_a_closed_circle_is_a_pendulum_that_turns_over():
    """The body turns with the point of a light rod in a revolute joint: same motion, same force."""
    cards = f"MASS 2 1.5 0 0 0 0.02 0.02 0.02\n{WEIGHT}{FINE}VELOCITY 2 7 0 0\n"
    circle = (
        "ELEMENTS\n  FUNCTION x sine 0 0.5 1\n  FUNCTION z sine 0 -0.5 1 1.5707963267948966\n"
        "  CURVE ring from=0(0,0,0) to=2(0,0,0) x=x z=z begin=0 end=6.283185307179586\n"
    )
    rows = rows_of(bead(0, 0, -0.5), "0 1.5 0.05", cards + circle)
    lines = "ELEMENTS\n  JOINT rod sphsph from=0(0,0,0) to=2(0,0,0) length=0.5\n"
    other = rows_of(bead(0, 0, -0.5), "0 1.5 0.05", cards + lines)
    assert rows.curve_position[-1, 0] > 2 * math.pi * 0.5
    assert rows.position == pytest.approx(other.position, abs=1e-9)
    assert rows.curve_force[:, 0] == pytest.approx(other.composite_force[:, 0], abs=1e-7)


YOKE = """3 0 0 0 0 1 0 1 0 0 0 1
0 0 0 1 0 0 0
0 0 0 1 0 0 0
0.1 0 0 1 0 0 0
1 2 0 0 0 0 0 0 0 0 1 0 0 1
1 3 0 0 0 0 0 0 1 0 0 1 0 0 0 1 0 0 0 1
1 0 0 0 0 0 0
"""
YOKE_CARDS = """MASS 2 1 0 0 0 0.1 0.1 0.01
MASS 3 2 0 0 0 1 1 1
ELEMENTS
  FUNCTION along polynomial 0 1
  CURVE slot from=3(0,0,0) to=2(0.1,0,0) y=along begin=-0.2 end=0.2
  START at=1.angle rate=5
"""


@pytest.mark.parametrize("name", LONG)
def test_the_pin_of_a_scotch_yoke_runs_in_its_slot(name):
    rows = rows_of(YOKE, "0 2 0.1", f"{YOKE_CARDS}{METHODS[name]}")
    near = {"DOP853": 1, "RAD5": 10, "GALF": 1e4}[name]
    values = (
        (1, 0.468903839707, 4.21308645803, 0.089206418842, -2.24847248897),
        (3, 1.16852058114, 3.04660954153, 0.0391513432648, -0.269838457549),
        (6, 2.0538927968, 3.11986387642, -0.046452351053, 0.352079119074),
        (10, 3.71761160899, 3.96105802372, -0.0838637723466, 1.65161644245),
        (20, 7.30359953976, 3.19248422715, 0.0523012935456, -0.434627756654),
    )
    for k, angle, rate, x, force in values:
        assert rows.joint_coordinate[k, 0] == pytest.approx(angle, abs=1e-9 * near)
        assert rows.joint_rate[k, 0] == pytest.approx(rate, abs=1e-8 * near)
        assert rows.position[k, 2, 0] == pytest.approx(x, abs=1e-9 * near)
        # The curve bears the opposite of what the pin does to the yoke.
        assert -rows.curve_force[k, 0, 0] == pytest.approx(force, abs=1e-7 * near)


GENEVA = """3 0 0 0 0 2 0 0 0 0 0 1
0 0 0 1 0 0 0
0 0 0 1 0 0 0
0.1 0 0 1 0 0 0
1 2 0 0 0 0 0 0 0 0 1 0 0 1
1 3 0.1 0 0 0 0 0 0.1 0 1 0 0 1
1 0 0 0 0 0 0
"""


@pytest.mark.parametrize("analysis", ["inverse", "forward"])
def test_a_geneva_wheel_has_the_motion_and_the_torque_of_the_closed_form(analysis):
    """The wheel's slot lies along -x at b = 0: b = atan2(r sin a, d - r cos a), the wheel turns by -b."""
    cards = """MASS 2 1 0 0 0 0.001 0.001 0.001
MASS 3 1 0 0 0 0.001 0.001 0.0002
ELEMENTS
  FUNCTION turn polynomial -0.7853981633974483 3
  FUNCTION along polynomial 0 -1
  CURVE slot from=3(0,0,0) to=2(0.0707106781186548,0,0) x=along begin=0 end=0.2
  DRIVE shaft at=1.angle value=turn
"""
    rows = rows_of(GENEVA, "0 0.25 0.05", cards, analysis)
    values = (
        (0, -0.785398163397, 0, 9, 0),
        (1, -0.772197160378, 0.573021264165, 14.4278552168, 0.000551164522368),
        (2, -0.722083624062, 1.51031569911, 23.9170222122, 0.00240815027487),
        (3, -0.61099899254, 3.05685044032, 38.6626866783, 0.00787907005309),
        (4, -0.403859818276, 5.31682392574, 48.4566905893, 0.0171757127925),
        (5, -0.085105785381, 7.15327659157, 14.9908475957, 0.00714891194629),
    )
    for k, b, rate, second, torque in values:
        assert -rows.joint_coordinate[k, 1] == pytest.approx(b, abs=1e-10)
        assert -rows.joint_rate[k, 1] == pytest.approx(rate, abs=1e-9)
        assert -rows.angular_acceleration[k, 2, 2] == pytest.approx(second, abs=1e-8)
        assert rows.driver_effort[k, 0] == pytest.approx(torque, abs=1e-10)


def test_a_point_that_leaves_its_curve_ends_the_run_and_keeps_the_rows_before():
    cards = f"{CYCLOID}".replace("begin=-3.1", "begin=-0.1")
    start = bead(0.25 * (0.3 + math.sin(0.3)), 0, -0.25 * (1 + math.cos(0.3)))
    blocks, analysis = [], analysis_of(model_of(start, "0 3 0.1", cards))
    with pytest.raises(AnalysisError) as ended:
        blocks.extend(analysis.rows())
    # S = 4 R sin 0.15 cos(3.132 t) falls below -4 R sin 0.05 at t = 0.611 s.
    assert sum(len(block.time) for block in blocks) == 7
    assert "by t = 0.7 s the point has left the curve at its beginning" in str(ended.value)


@pytest.mark.long_motion
def test_points_of_a_file_give_a_smooth_closed_track(tmp_path, monkeypatch):
    """An ellipse through 200 points, whose error falls with the fourth power of their distance."""
    s = np.linspace(0, 2 * math.pi, 201)
    points = np.column_stack([0.5 * np.cos(s), 0.3 * np.sin(s), np.zeros(201)])
    points[-1] = points[0]
    monkeypatch.chdir(tmp_path)
    np.savetxt("track.txt", points)
    cards = (
        f"MASS 2 1.5 0 0 0 0.02 0.02 0.02\n{FINE}VELOCITY 2 0 2 0\n"
        "ELEMENTS\n  CURVE ring from=0(0,0,0) to=2(0,0,0) file=track.txt\n"
    )
    rows = rows_of(bead(0.5, 0, 0), "0 3 0.01", cards)
    x, y = rows.position[:, 1, :2].T
    assert (x / 0.5) ** 2 + (y / 0.3) ** 2 == pytest.approx(np.ones(301), abs=1e-6)
    # No force acts along it: it goes on with its speed, round and round.
    assert rows.curve_position[:, 0] == pytest.approx(2 * rows.time, abs=1e-8)
    assert rows.curve_position[-1, 0] > 2.55 * 2


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("x=x", "a curve of functions needs begin= and end="),
        ("begin=0 end=1", "a curve takes file=, or functions of a parameter"),
        ("x=x begin=1 end=0", "its end, 0, must be larger than its beginning, 1"),
        ("x=square begin=-1 end=1", "the curve stands still at the parameter 0: it has no direction"),
        ("x=corner begin=0 end=2", "the curvature of a curve cannot jump"),
        ("file=none.txt", "no such file"),
    ],
)
def test_faults_of_curves_are_named(line, message):
    functions = (
        "  FUNCTION x polynomial 0 1\n  FUNCTION square polynomial 0 0 1\n"
        "  FUNCTION corner table 0 0 1 1 2 0\n"
    )
    cards = f"MASS 2 1 0 0 0 1 1 1\nELEMENTS\n{functions}  CURVE rail from=0(0,0,0) to=2(0,0,0) {line}"
    with pytest.raises(DeckError) as refused:
        model_of(bead(0, 0, 0), "0 1 0.5", cards)
    assert any(message in fault.message for fault in refused.value.faults)
