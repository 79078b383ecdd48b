"""Lines FORCE and TORQUE: closed forms of projectile and rotor, and the same motion in all formulations."""

from pathlib import Path

import numpy as np
import pytest

from flexmb_cli import interface
from flexmb_cli.errors import ModelError

METHODS = {"RK45": "dop853", "RAD5": "radau"}
DECKS = Path(__file__).resolve().parents[4] / "decks"
# A free body of 2 kg: three free translations and rotations about axis 3.
FREE = """    1    3
DFMB
    1    3    1    1    1
    1    1    0    0    1
    0
    0
  100
      0.01
CONN
    0
MASS
    1       2.0
INER
    1       0.3       0.3       0.4
Q(k)
    1       0.0       0.0       0.0
Y(L)
       0.0       0.0       0.0       0.0
       0.0       0.0       0.0       0.0
GRAV
    0       0.0       0.0     -9.81
ELEMENTS
{lines}END{blank}
STAR
STOP
"""
ROTOR = """2 0 0 0 0 1 0 0 0 0 0 1
0 0 0 1 0 0 0
0 0 0 1 0 0 0
1 2 0 0 0 0 0 0 0 0 1 0 0 1
1 0 0 0 0 0 0
0 1 0.01
DYNAMICS forward
MASS 2 2 0 0 0 0.3 0.3 0.4
ELEMENTS
{lines}END
"""
HINGED = """VSDF
BODY
    1 RIGD
RIGI
1,2.0,0,0,0
0.3,0.3,0.4
NODE
1,1,0,0,0
1,2,0.5,0,0
1,3,0,0,1
0,1,0,0,0
0,2,0,0,1
JOIN
1,REVO,0,1,2,1,1,3
TIME
1,0.01
INTG
 RAD5,1e-9
ELEMENTS
{lines}END
STAR
STOP
"""


def solved(tmp_path, text, lines, name="x.DAT", **options):
    path = tmp_path / name
    path.write_text(text.format(lines="".join(f"  {line}\n" for line in lines), blank=" "))
    return interface.solve(str(path), **options)


@pytest.mark.parametrize("formulation", ["kane", "absolute"])
def test_a_projectile_with_a_thrust_that_grows(tmp_path, formulation):
    """m a = F0 + F1 t along x, -m g along z: x = (F0 t^2/2 + F1 t^3/6)/m; the work is that of the force."""
    lines = ["FUNCTION rise polynomial 3 12", "FORCE thrust to=1(0,0,0) direction=(2,0,0) effort=rise"]
    found = solved(tmp_path, FREE, lines, formulation=formulation)
    t = found.time
    x, v = (1.5 * t**2 + 2 * t**3) / 2, (3 * t + 6 * t**2) / 2
    assert np.abs(found["body/position"][:, 0, 0] - x).max() < 1e-9
    assert np.abs(found["body/position"][:, 0, 2] + 9.81 * t**2 / 2).max() < 1e-9
    assert np.abs(found["element/effort"][:, 0] - 3 - 12 * t).max() < 1e-12
    assert np.abs(found["element/rate"][:, 0] - v).max() < 1e-8
    assert np.abs(found["element/work"][:, 0] - v**2).max() < 1e-8
    assert np.abs(found["energy/total"]).max() < 1e-8


@pytest.mark.parametrize("formulation", ["kane", "absolute"])
def test_a_force_beside_the_centre_that_turns_with_the_body(tmp_path, formulation):
    """F across an arm of 0.3 m: angle F r t^2/(2 I), however the body has turned, and Fresnel's velocity."""
    lines = ["FUNCTION steady polynomial 8", "FORCE jet to=1(0.3,0,0) direction=(0,1,0) axes=1 effort=steady"]
    found = solved(tmp_path, FREE, lines, formulation=formulation)
    t, rate = found.time, 8 * 0.3 / 0.4
    angle = rate * t**2 / 2
    assert np.abs(found["coordinate/q"] - angle[:, None]).min(axis=1).max() < 1e-9
    from scipy.integrate import quad

    along = [quad(lambda s: -4 * np.sin(rate * s**2 / 2), 0, end)[0] for end in t[::20]]
    assert np.abs(found["body/velocity"][::20, 0, 0] - along).max() < 1e-8


# Angle of a rotor of 0.4 kg m^2 under 3 sin 5 t: 3/(5 I) (t - sin(5 t)/5).
def rotor(t):
    return 3 / (5 * 0.4) * (t - np.sin(5 * t) / 5)


@pytest.mark.parametrize("method", ["RK45", "RAD5"])
def test_a_rotor_of_a_young_deck(tmp_path, method):
    lines = ["FUNCTION wave sine 0 3 5", "TORQUE turn to=2(0,0,0) direction=(0,0,1) effort=wave"]
    found = solved(tmp_path, ROTOR, lines, "x.dat", method=METHODS[method])
    assert np.abs(found["coordinate/q"][:, 0] - rotor(found.time)).max() < 1e-6
    assert np.abs(found["element/effort"][:, 0] - 3 * np.sin(5 * found.time)).max() < 1e-12


def test_a_force_and_a_torque_of_a_vsdf_deck(tmp_path):
    """4 N along y of the body at its node 2, 0.5 m from the axis, and 1 N m: angle 3 t^2/(2 I)."""
    lines = ["FUNCTION steady polynomial 4", "FUNCTION one polynomial 1"]
    lines += ["FORCE push to=1:2 direction=(0,1,0) axes=1 effort=steady"]
    lines += ["TORQUE turn to=1:1 direction=(0,0,3) effort=one"]
    found = solved(tmp_path, HINGED, lines, "x.vsdf")
    assert np.abs(found["coordinate/q"][:, 0] - 3.75 * found.time**2).max() < 1e-6
    assert found["element/rate"][-1, 0] == pytest.approx(0.5 * 7.5, abs=1e-6)


def test_forces_at_nodes_and_points_of_flexible_trees_are_the_same_in_both_formulations(tmp_path):
    text = (DECKS / "dafms/two_link_n2.DAT").read_text()
    lines = """ELEMENTS
  FUNCTION wave sine 0 0.05 9
  FORCE tip to=2:2 direction=(0.2,1,0) effort=wave
  FORCE along to=1:1 direction=(0,1,0) axes=1 effort=wave
  TORQUE turn to=1(0,0,0) direction=(0,0,1) effort=wave
"""
    end = next(k for k, line in enumerate(text.split("\n")) if line.startswith("END"))
    rows = text.split("\n")
    path = tmp_path / "x.DAT"
    path.write_text("\n".join([*rows[:end], *lines.rstrip().split("\n"), *rows[end:]]))
    changes = {"time.IT": 40}
    kane, absolute = (
        interface.solve(interface.read_deck(str(path), changes), formulation=one, rtol=1e-10, atol=1e-12)
        for one in ("kane", "absolute")
    )
    for name in ("coordinate/q", "element/work", "element/rate"):
        size = np.abs(kane[name]).max()
        assert size > 0 and np.abs(kane[name] - absolute[name]).max() < 1e-5 * size, name


@pytest.mark.parametrize(
    ("line", "sentence"),
    {
        "FORCE a to=1(0,0,0) direction=(0,0,0) effort=f": "the direction has no length",
        "FORCE a to=1(0,0,0) direction=(0,0,1) axes=3 effort=f": "axes of the ground, 0, or of body 1",
        "FORCE a to=0(0,0,0) direction=(0,0,1) effort=f": "two bodies are needed",
    }.items(),
)  # fmt: skip
def test_wrong_lines_are_faults(tmp_path, line, sentence):
    with pytest.raises(ModelError, match=sentence):
        solved(tmp_path, FREE, ["FUNCTION f polynomial 1", line])
