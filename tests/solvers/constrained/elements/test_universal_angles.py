"""Elements in the two angles of universal joints: 1.angle1 about the axis of the first body, 1.angle2.

Their meaning is that of two turns one after the other; their motion is that of a hinge with two rotations by
Kane's equations, in which no constraint, multiplier or angle between vectors occurs.
"""

import json
import math

import h5py
import numpy as np
import pytest
from click.testing import CliRunner

from flexmb_cli.cli import cli
from flexmb_cli.interface import solve_to_files
from flexmb_cli.run.outcome import RunOptions

YOUNG = (
    "2 0 0 0 1 0 0 0 0 0 0 1\n0 0 0 1 0 0 0\n0 0 0 1 0 0 0\n1 2 0 0 0 0 0 0 1 0 0 0 1 0\n"
    "1 0 0 0 0 0 0\n0 1 0.05\nDYNAMICS forward\nMASS 2 1.5 0 0 -0.4 0.2 0.3 0.1\nGRAVITY 0 0 -9.81\n{card}"
    "ELEMENTS\n{lines}END\n"
)
VSDF = (
    "VSDF CROSS\nBODY\n 1,RIGD\nRIGI\n 1,1.5,0,0,-0.4\n 0.2,0.3,0.1,0,0,0\nNODE\n 0,1,0,0,0\n"
    " 0,2,1,0,0\n 1,1,0,0,0\n 1,2,0,1,0\nPOSI\n 1,0,0,0\nJOIN\n 1,UNIV,0,1,2,1,1,2,\nGRAV\n 0,0,-9.81\n"
    "ELEMENTS\n{lines}\nINTG\n RK45,,1e-12\nTIME\n 1,0.05\nEND\nSTAR\nSTOP\n"
)
TREE = """    1    3
DFMB CROSS
    1    0    0    0    0
    1    2    1    1    0
    0
    0
   20
      0.05
CONN
    0
MASS
    1       1.5
INER
    1      0.44      0.54       0.1
Q(k)
    1       0.0       0.0       0.0
EULT
    1       0.0       0.0       0.0       1.0
EULL
    1       0.0       0.0       0.0       1.0
Y(L)
       0.3      -0.2       0.4      -0.3
RC(K
    1       0.0       0.0      -0.4
GRAV
    0       0.0       0.0     -9.81
TOLR
    1.000E-12    1.000E-13
ELEMENTS
{lines}END
STAR
STOP
"""
FORCES = (
    "  SPRING first at=FIRST stiffness=6 rest=0.1 damping=0.2\n"
    "  SPRING second at=SECOND stiffness=4 damping=0.1\n"
    "  STOP end at=FIRST lower=-0.35 upper=0.45 stiffness=300\n"
    "  FUNCTION push sine 0.2 1.5 5\n  MOTOR turn at=SECOND effort=push\n"
)
STARTS = "  START at=FIRST value=0.4 rate=0.3\n  START at=SECOND value=-0.3 rate=-0.2\n"


def lines_of(text, tree=False):
    names = ("1.r1", "1.r2") if tree else ("1.angle1", "1.angle2")
    return text.replace("FIRST", names[0]).replace("SECOND", names[1])


def run(folder, name, text, **options):
    (folder / name).write_text(text)
    settings = RunOptions(folder=str(folder), no_out=True, h5=str(folder / f"{name}.h5"), **options)
    outcome = solve_to_files(folder / name, settings)
    assert outcome.exit_code == 0, [fault.message for fault in outcome.faults]
    return h5py.File(folder / f"{name}.h5")


def young(text, card="TOLERANCE 1e-12\n"):
    return YOUNG.replace("{card}", card).replace("{lines}", lines_of(text))


@pytest.mark.long_motion
def test_a_body_on_a_universal_joint_moves_as_on_a_hinge_of_two_rotations(tmp_path):
    expected = run(tmp_path, "a.DAT", TREE.replace("{lines}", lines_of(FORCES, tree=True)))
    found = {
        "young": run(tmp_path, "INU", young(FORCES + STARTS)),
        "vsdf": run(tmp_path, "u.vsdf", VSDF.replace("{lines}", lines_of(FORCES + STARTS))),
    }
    for dialect, h5 in found.items():
        for path in ("body/position", "body/angular_velocity"):
            assert h5[path][:, -1:] == pytest.approx(expected[path][:], abs=1e-8), dialect
        for path in ("coordinate", "rate", "effort", "work"):
            # Steps end at 1e-12; the stop multiplies what they leave by its stiffness.
            within = {"effort": 1e-6, "work": 1e-7}.get(path, 1e-8)
            name = f"element/{path}"
            assert h5[name][:] == pytest.approx(expected[name][:], abs=within), (dialect, path)


@pytest.mark.parametrize("card", ["", "RAD5 1e-9\n", "GALF 0.002 0.9\n"])
def test_angles_are_those_of_two_turns_one_after_the_other(tmp_path, card):
    a, b = 0.7, -0.5
    lines = (
        f"  FUNCTION a polynomial {a}\n  FUNCTION b polynomial {b} 0.4\n"
        "  DRIVE one at=FIRST value=a\n  DRIVE two at=SECOND value=b\n"
    )
    h5 = run(tmp_path, "INU", young(lines, card))
    for row, t in ((0, 0.0), (20, 1.0)):
        half = a / 2, (b + 0.4 * t) / 2
        # The product of the quaternions of the turns about x and then y.
        expected = np.array(
            [
                math.cos(half[0]) * math.cos(half[1]),
                math.sin(half[0]) * math.cos(half[1]),
                math.cos(half[0]) * math.sin(half[1]),
                math.sin(half[0]) * math.sin(half[1]),
            ]
        )
        p = h5["body/euler_parameters"][row, -1]
        assert p * np.sign(p @ expected) == pytest.approx(expected, abs=1e-10)
    # Turned by a about x, the axis y of the cross is (0, cos a, sin a).
    assert h5["body/angular_velocity"][20, -1] == pytest.approx(
        [0.0, 0.4 * math.cos(a), 0.4 * math.sin(a)], abs=1e-10
    )


@pytest.mark.parametrize(
    ("line", "fault"),
    [
        ("  SPRING a at=1.angle stiffness=1 rest=0\n", "ELEMENTS-045"),
        ("  SPRING a at=1.stroke stiffness=1 rest=0\n", "ELEMENTS-045"),
    ],
)
def test_other_coordinates_are_refused(tmp_path, line, fault):
    (tmp_path / "INU").write_text(young(line))
    done = CliRunner().invoke(cli, ["check", str(tmp_path / "INU"), "--json"])
    faults = json.loads(done.stdout)["faults"]
    assert fault in [each["id"] for each in faults]
    if fault == "ELEMENTS-045":
        assert "1.angle1" in next(each["message"] for each in faults if each["id"] == fault)


def test_a_revolute_joint_has_no_two_angles(tmp_path):
    text = young("  SPRING a at=1.angle2 stiffness=1 rest=0\n").replace("2 0 0 0 1 0", "2 0 0 0 0 1")
    (tmp_path / "INU").write_text(text.replace("0 0 1 0\n1 0 0 0 0", "1 0 0 1\n1 0 0 0 0"))
    done = CliRunner().invoke(cli, ["check", str(tmp_path / "INU")])
    assert "has an angle, not two angles; take 1.angle" in " ".join(done.stderr.split())


def test_vsdf_decks_drive_no_angle_of_a_universal_joint(tmp_path):
    lines = "  FUNCTION a polynomial 0.4\n  DRIVE one at=1.angle1 value=a\n"
    (tmp_path / "u.vsdf").write_text(VSDF.replace("{lines}", lines))
    done = CliRunner().invoke(cli, ["check", str(tmp_path / "u.vsdf"), "--json"])
    assert "ELEMENTS-246" in [each["id"] for each in json.loads(done.stdout)["faults"]]


@pytest.mark.parametrize("form", ["vsdf", "dafms"])
def test_conversion_refuses_these_angles(tmp_path, form):
    (tmp_path / "INU").write_text(young(FORCES))
    command = ["convert", str(tmp_path / "INU"), "--to", form, "-o", str(tmp_path / "other")]
    done = CliRunner().invoke(cli, command)
    assert done.exit_code != 0 and "angles of universal joints" in str(done.exception)
