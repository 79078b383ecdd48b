"""Lines `JOINT name general|weld|inline|inplane|parallel|angle`: joints that hold some of six directions.

Expected motions are those of the joints of the deck, whose equations are in other kernels, and of a hinge of
a tree; the falling rod is the problem reactions-rod-pendulum of `reference/motion`, elliptic functions.
"""

import json

import h5py
import numpy as np
import pytest
from click.testing import CliRunner

from flexmb_cli.cli import cli
from flexmb_cli.interface import solve_to_files
from flexmb_cli.run.outcome import RunOptions
from tests.dialects.dafms.test_dafms_elements import TWO_LINKS

pytestmark = pytest.mark.long_motion

# A body of unequal inertia at an attitude aside of all axes, under its weight and a torque.
FREE = """2 {counts}
0 0 0 1 0 0 0
0.3 -0.2 0.1 0.9 0.3 -0.2 0.25
{joint}1 0 0 0 0 0 0
0 0.6 0.1
DYNAMICS forward
MASS 2 2 0.2 0.1 -0.1 0.1 0.25 0.3
GRAVITY 0.5 1 -9.81
TORQUE 2 0.1 0.2 -0.1
ELEMENTS
  SPRING hold from=0(0.5,0.4,1) to=2(0.2,0,0.3) stiffness=30 rest=0.5 damping=1
{lines}TOLERANCE 1e-11
END
"""
COUNTS = {"spherical": 0, "universal": 1, "revolute": 2, "cylindrical": 3, "translational": 4}
NO_COUNTS = [*([0] * 10), 1]


def deck(kind="", points="", lines=""):
    counts = list(NO_COUNTS)
    if kind:
        counts[COUNTS[kind] + 2] = 1
    joint = f"1 2 {points}\n" if kind else ""
    return FREE.format(counts=" ".join(map(str, counts)), joint=joint, lines=lines)


def run(folder, name, text, **options):
    (folder / name).write_text(text)
    settings = RunOptions(folder=str(folder), no_out=True, h5=str(folder / f"{name}.h5"), **options)
    outcome = solve_to_files(folder / name, settings)
    assert outcome.exit_code == 0, [fault.message for fault in outcome.faults]
    return h5py.File(folder / f"{name}.h5")


def attitude():
    e = np.array([0.9, 0.3, -0.2, 0.25])
    e /= np.linalg.norm(e)
    w, v = e[0], e[1:]
    cross = np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])
    return (w * w - v @ v) * np.eye(3) + 2 * np.outer(v, v) + 2 * w * cross


def on_body(point):
    """A global point in the axes of the body."""
    return attitude().T @ (np.array(point) - [0.3, -0.2, 0.1])


def text(*points):
    return " ".join(repr(float(x)) for point in points for x in point)


P = np.array([0.1, 0.05, -0.05])  # on the ground
Z, X = np.array([0.0, 0.0, 1.0]), np.array([1.0, 0.0, 0.0])
HERE = on_body(P)
ENDS = f"from=0({text(P).replace(' ', ',')}) to=2({text(HERE).replace(' ', ',')})"
ALONG_Z = text(P, HERE, P + Z, on_body(P + Z))
CASES = [
    ("spherical", text(P, HERE), [f"JOINT a general {ENDS} free=(rx,ry,rz)"]),
    ("spherical", text(P, HERE), [f"JOINT a inline {ENDS} axis_from=(0,0,2)",
                                  f"JOINT b inplane {ENDS} axis_from=(0,0,1)"]),
    ("universal", text(P, HERE, P + X, on_body(P + np.array([0.0, 1.0, 0.0]))),
     [f"JOINT a general {ENDS} free=(rx,ry)"]),
    ("universal", text(P, HERE, P + X, on_body(P + np.array([0.0, 1.0, 0.0]))),
     [f"JOINT a general {ENDS} free=(rx,ry,rz)",
      f"JOINT b angle {ENDS} axis_from=(1,0,0) axis_to=({text(attitude()[1]).replace(' ', ',')})"]),
    ("revolute", ALONG_Z, [f"JOINT a general {ENDS} free=(rz)"]),
    ("revolute", ALONG_Z, [f"JOINT a parallel {ENDS} axis_from=(0,0,1)",
                           f"JOINT b general {ENDS} free=(rx,ry,rz)"]),
    ("cylindrical", ALONG_Z, [f"JOINT a general {ENDS} free=(rz,tz)"]),
    ("cylindrical", ALONG_Z, [f"JOINT a inline {ENDS} axis_from=(0,0,1)",
                              f"JOINT b parallel {ENDS} axis_from=(0,0,1)"]),
    ("translational", text(P, HERE, P + Z, on_body(P + Z), P + X, on_body(P + np.array([0.0, 1.0, 0.0]))),
     [f"JOINT a general {ENDS} free=tz"]),
    ("revolute", text(P, HERE, P + np.array([0.6, 0, 0.8]), on_body(P + np.array([0.6, 0, 0.8]))),
     [f"JOINT a general {ENDS} axis_from=(3,0,4) across=(0,1,0) free=rz"]),
]  # fmt: skip


@pytest.mark.parametrize(("kind", "points", "lines"), CASES)
def test_a_mask_moves_as_the_joint_whose_directions_it_leaves_free(tmp_path, kind, points, lines):
    expected = run(tmp_path, "INA", deck(kind, points))
    found = run(tmp_path, "INB", deck(lines="".join(f"  {line}\n" for line in lines)))
    for name in ("body/position", "body/euler_parameters", "body/velocity", "body/acceleration"):
        assert found[name][:] == pytest.approx(expected[name][:], abs=2e-7), name
    # What it bears is what the joint of the deck bears, as a force on its second body.
    force = found["general/force"][:].sum(axis=1)
    assert force == pytest.approx(expected["reaction/force"][:, 0], abs=1e-5)


@pytest.mark.parametrize("method", ["dop853", "radau", "alpha"])
def test_a_welded_body_stays_and_its_weld_bears_all_loads(tmp_path, method):
    """Weight 2 (0.5, 1, -9.81) N, torque and spring: force and moment about the point, by hand."""
    options = {"integration": {"method": method}}
    found = run(tmp_path, "INW", deck(lines=f"  JOINT a weld {ENDS}\n"), **options)
    A, r = attitude(), np.array([0.3, -0.2, 0.1])
    assert found["body/position"][:, 1] == pytest.approx(np.tile(r, (7, 1)), abs=1e-9)
    weight, at = 2 * np.array([0.5, 1, -9.81]), r + A @ [0.2, 0.1, -0.1]
    end = r + A @ [0.2, 0, 0.3]
    line = np.array([0.5, 0.4, 1]) - end
    pull = 30 * (np.linalg.norm(line) - 0.5) * line / np.linalg.norm(line)
    moment = np.cross(at - P, weight) + np.cross(end - P, pull) + [0.1, 0.2, -0.1]
    assert found["general/force"][-1, 0] == pytest.approx(-weight - pull, abs=1e-7)
    assert found["general/torque"][-1, 0] == pytest.approx(-moment, abs=1e-7)


ROD = """1 0 0 0 0 0 0 0 0 0 0 0
0.4 0 0 1 0 0 0
0 0.6 0.2
DYNAMICS forward
MASS 1 1.2 0 0 0 0.064 0.064 0.064
GRAVITY 0 0 -9.81
ELEMENTS
  JOINT hinge general from=0(0,0,0) to=1(-0.4,0,0) free=ry
TOLERANCE 1e-12
END
"""
FALLING = [[0, 2.943], [-8.85587192665, 6.33947889365], [-5.04297092478, 28.4322640228],
           [12.6508149925, 12.2689532835]]  # fmt: skip
ANGLES = [1.5707963268, 1.20456969744, 0.195324381082, -0.935549326804]
ROD_OF_VSDF = (
    "VSDF ROD\nBODY\n 1,RIGD\nRIGI\n 1,1.2,0,0,0\n 0.064,0.064,0.064,0,0,0\nNODE\n 0,1,0,0,0\n 1,1,-0.4,0,0\n"
    "PLAC\n 1,1,0,1\nGRAV\n 0,0,-9.81\nELEMENTS\n  JOINT hinge general from=0:1 to=1:1 free=ry\n\n"
    "INTG\n RK45,,1e-12\nTIME\n 0.6,0.2\nEND\nSTAR\nSTOP\n"
)


@pytest.mark.parametrize(("name", "text"), [("INR", ROD), ("rod.vsdf", ROD_OF_VSDF)])
def test_a_rod_on_a_general_hinge_has_the_reaction_of_the_closed_form(tmp_path, name, text):
    found = run(tmp_path, name, text)
    assert found["general/force"][:, 0, ::2] == pytest.approx(np.array(FALLING), abs=1e-8)
    x, z = found["body/position"][:, 0, 0], found["body/position"][:, 0, 2]
    assert np.arctan2(x, -z) == pytest.approx(np.array(ANGLES), abs=1e-9)


# Trees

# The second link hangs on nothing: all six coordinates of its hinge are free.
ZERO = "       0.0"
LOOSE = (
    TWO_LINKS.replace("    2    0    0    0    0\n    1    1    0    0    1\n    2    1    0    0    1\n",
                      "    2    3    1    1    1\n    1    1    0    0    1\n    2    3    1    1    1\n")
    .replace("    0    1\nMASS", "    0    0\nMASS")
    .replace("    2       1.0       0.0       0.0\nEULT", "    2       0.0       0.0       0.0\nEULT")
    .replace(f"{4 * ZERO}\nRC(K", f"{5 * ZERO}\n{5 * ZERO}\n{ZERO}       1.0{2 * ZERO}\nRC(K")
)  # fmt: skip
HINGE = "  JOINT hinge general from=1(1,0,0) to=2(0,0,0) free=rz\n"


def tree(lines, base=LOOSE):
    return f"{base}ELEMENTS\n{lines}END \nSTAR\nSTOP\n"


@pytest.mark.parametrize("options", [{}, {"formulation": "absolute"}, {"integration": {"method": "sdirk4"}}])
def test_a_loose_link_of_a_tree_swings_on_a_general_joint_as_on_a_hinge(tmp_path, options):
    expected = run(tmp_path, "a.DAT", f"{TWO_LINKS}END \nSTAR\nSTOP\n")
    found = run(tmp_path, "b.DAT", tree(HINGE), **options)
    within = 1e-6 if "integration" in options else 1e-9
    assert found["body/position"][:] == pytest.approx(expected["body/position"][:], abs=within)
    assert found["body/angular_velocity"][:] == pytest.approx(
        expected["body/angular_velocity"][:], abs=10 * within
    )
    force = expected["hinge/force"][:, 1]
    assert found["general/force"][:, 0] == pytest.approx(force, abs=1e3 * within)
    assert found["general/torque"][:, 0] == pytest.approx(expected["hinge/torque"][:, 1], abs=1e3 * within)


@pytest.mark.parametrize(
    "line",
    [
        "weld from=1(1,0,0) to=2(0,0,0)",
        "parallel from=1(1,0,0) to=2(0,0,0) axis_from=(1,2,3)",
        "inplane from=1(1,0,0) to=2(0,0,0.1) axis_from=(1,2,3)",
        "inline from=1(1,0,0) to=2(0,0,0) axis_from=(1,2,0)",
        "angle from=0(0,0,0) to=2(0,0,0) axis_from=(1,2,3) axis_to=(3,1,0)",
        "general from=1(1,0,0) to=2(0,0,0) free=(rx,ry)",
    ],
)
def test_both_formulations_of_a_tree_agree_on_each_case(tmp_path, line):
    (tmp_path / "a.DAT").write_text(tree(f"  JOINT held {line}\n"))
    done = CliRunner().invoke(cli, ["verify", str(tmp_path / "a.DAT"), "--json", "--tol", "1e-6"])
    assert done.exit_code == 0, done.output
    assert json.loads(done.stdout)["agree"]


# What is refused


@pytest.mark.parametrize(
    ("line", "fault"),
    [
        ("weld from=0(0,0,0) to=2(0,0,0) axis_from=(1,0,0)", "ELEMENTS-201"),
        ("inline from=0(0,0,0) to=2(0,0,0)", "ELEMENTS-201"),
        ("revcyl from=0(0,0,0) to=2(0,0,0) free=rx", "YOUNG-183"),
        ("general from=0(0,0,0) to=2(0,0,0) free=(rx,up)", "ELEMENTS-202"),
        ("inplane from=0(0,0,0) to=2(0,0,0) axis_from=(0,0,0)", "ELEMENTS-203"),
        ("general from=0(0,0,0) to=2(0,0,0) free=(rx,ry,rz,tx,ty,tz)", "ELEMENTS-205"),
        ("general from=0(0,0,0) to=2(0,0,0) free=rx axis_from=(1,1,1)", "ELEMENTS-206"),
        ("general from=0(0,0,0) to=2(0,0,0) free=rx axis_from=(1,1,1) across=(2,2,2)", "ELEMENTS-207"),
    ],
)
def test_slips_are_named(tmp_path, line, fault):
    (tmp_path / "INX").write_text(deck(lines=f"  JOINT a {line}\n"))
    done = CliRunner().invoke(cli, ["check", str(tmp_path / "INX"), "--json"])
    found = [each for each in json.loads(done.stdout)["faults"] if each["severity"] == "error"]
    assert done.exit_code == 2 and fault in [each["id"] for each in found]


def test_a_conversion_is_refused_with_the_joint(tmp_path):
    (tmp_path / "INX").write_text(deck(lines=f"  JOINT a weld {ENDS}\n"))
    done = CliRunner().invoke(cli, ["convert", str(tmp_path / "INX"), "--to", "vsdf", "--json"])
    assert [fault.id for fault in done.exception.faults] == ["SOLVE-184"]
