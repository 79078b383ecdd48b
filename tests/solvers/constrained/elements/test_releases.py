"""Lines RELEASE: joints that are let go at a time, or when a quantity reaches a value.

The hinged rod is the problem release-time-and-force of `reference/motion`: elliptic functions, then a
parabola.
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
from tests.solvers.constrained.elements.test_general_joints import HINGE, tree

pytestmark = pytest.mark.long_motion

X, Z = 0.5 * math.sin(math.radians(75)), -0.5 * math.cos(math.radians(75))
E0, E2 = math.cos(math.radians(7.5)), math.sin(math.radians(7.5))
PULL = "  OUTPUT pull = sqrt(general.1.force.x^2 + general.1.force.z^2)\n"
AT_TIME = "  RELEASE go of=hinge time=0.5\n"
AT_FORCE = f"{PULL}  RELEASE go of=hinge when=pull above=31.392\n"  # 1.6 m g
YOUNG = (
    f"1 0 0 0 0 0 0 0 0 0 0 0\n{X!r} 0 {Z!r} {E0!r} 0 {E2!r} 0\n0 1.5 0.1\nDYNAMICS forward\n"
    "MASS 1 2 0 0 0 {I} {I} {I}\nGRAVITY 0 0 -9.81\nELEMENTS\n"
    "  JOINT hinge general from=0(0,0,0) to=1(-0.5,0,0) free=ry\n{lines}TOLERANCE 1e-12\nEND\n"
)
VSDF = (
    "VSDF ROD\nBODY\n 1,RIGD\nRIGI\n 1,2,0,0,0\n {I},{I},{I},0,0,0\nNODE\n 0,1,0,0,0\n 1,1,-0.5,0,0\n"
    f"POSI\n 1,{X!r},0,{Z!r}\nEULP\n 1,{E0!r},0,{E2!r},0\nGRAV\n 0,0,-9.81\nELEMENTS\n"
    "  JOINT hinge general from=0:1 to=1:1 free=ry\n{lines}\nINTG\n RK45,,1e-12\n"
    "TIME\n 1.5,0.1\nEND\nSTAR\nSTOP\n"
)
DAFMS = """SET x = 0.5*sin(75*pi/180)
SET z = -0.5*cos(75*pi/180)
SET e0 = cos(7.5*pi/180)
SET e2 = sin(7.5*pi/180)
SET i = 2/12
    1    3
DFMB ROD
    1    3    1    1    1
    1    3    1    1    1
    0
    0
   15
       0.1
CONN
    0
MASS
    1       2.0
INER
    1        $i        $i        $i
Q(k)
    1       0.0       0.0       0.0
EULT
    1       0.0       $e2       0.0       $e0
EULL
    1       0.0       0.0       0.0       1.0
Y(L)
       0.0       0.0       0.0       0.0       0.0
       0.0       0.0       0.0       0.0        $x
       0.0        $z
RC(K
    1       0.0       0.0       0.0
GRAV
    0       0.0       0.0     -9.81
TOLR
    1.000E-12    1.000E-13
ELEMENTS
  JOINT hinge general from=0(0,0,0) to=1(-0.5,0,0) free=ry
{lines}END
STAR
STOP
"""
DECKS = {"INR": YOUNG, "rod.vsdf": VSDF, "rod.DAT": DAFMS}
# x, z of the centre, da/dt, which is that about -y, at rows of the deck.
TIMED = {
    3: (0.320364362159, -0.383883674384, -3.87018715011),
    5: (-0.0965869023049, -0.490582276793, -4.61070800579),
    7: (-0.548973228526, -0.59771547605, -4.61070800579),
    10: (-1.22755271786, -1.49416527494, -4.61070800579),
    15: (-2.35851853341, -4.95024827308, -4.61070800579),
}
FORCED = {
    3: (0.320364362159, -0.383883674384, -3.87018715011),
    7: (-0.30719652794, -1.61339059365, -3.96265369604),
    10: (-0.778184151838, -3.56507724767, -3.96265369604),
    15: (-1.563163525, -8.77988833769, -3.96265369604),
}


def run(folder, name, lines, **options):
    text = DECKS[name].replace("{I}", repr(2 / 12)).replace("{lines}", lines)
    (folder / name).write_text(text)
    settings = RunOptions(folder=str(folder), h5=str(folder / f"{name}.h5"), **options)
    outcome = solve_to_files(folder / name, settings)
    assert outcome.exit_code == 0, [fault.message for fault in outcome.faults]
    return outcome, h5py.File(folder / f"{name}.h5")


def compare(h5, expected, within):
    for row, (x, z, rate) in expected.items():
        assert h5["body/position"][row, 0, ::2] == pytest.approx([x, z], abs=within), row
        assert h5["body/angular_velocity"][row, 0, 1] == pytest.approx(-rate, abs=within), row
    energy = h5["energy/total"][:]
    assert energy == pytest.approx(np.full(len(energy), energy[0]), abs=1e-8)


@pytest.mark.parametrize("name", DECKS)
def test_a_rod_is_let_go_at_a_time(tmp_path, name):
    outcome, h5 = run(tmp_path, name, AT_TIME)
    compare(h5, TIMED, 1e-8)
    assert not h5["general/force"][6:].any() and h5["general/force"][5].any()
    assert "t = 0.5 s" in next(fault.message for fault in outcome.faults if fault.id == "SOLVE-189")


@pytest.mark.parametrize("name", DECKS)
def test_a_rod_is_let_go_when_its_hinge_force_reaches_a_limit(tmp_path, name):
    outcome, h5 = run(tmp_path, name, AT_FORCE)
    compare(h5, FORCED, 1e-7)
    [message] = [fault.message for fault in outcome.faults if fault.id == "SOLVE-189"]
    assert float(message.split()[-2]) == pytest.approx(0.31004575242, abs=1e-8)
    assert h5["output/pull"][3] < 31.392 and not h5["output/pull"][4:].any()


def test_a_tree_in_absolute_coordinates_lets_go_as_by_kanes_equations(tmp_path):
    text = tree(f"{HINGE}  RELEASE go of=hinge time=0.23\n").replace("       0.1\nCONN", "      0.05\nCONN")
    found = []
    for formulation in ("kane", "absolute"):
        (tmp_path / "a.DAT").write_text(text)
        place = tmp_path / f"{formulation}.h5"
        settings = RunOptions(no_out=True, folder=str(tmp_path), h5=str(place), formulation=formulation)
        assert solve_to_files(tmp_path / "a.DAT", settings).exit_code == 0
        found.append(h5py.File(place))
    one, other = found
    for path in ("body/position", "body/angular_velocity", "general/force", "energy/total"):
        assert one[path][:] == pytest.approx(other[path][:], abs=1e-7), path


@pytest.mark.parametrize(
    ("lines", "fault"),
    [
        ("  RELEASE go of=other time=0.5\n", "ELEMENTS-208"),
        ("  RELEASE go of=hinge when=time\n", "ELEMENTS-209"),
        ("  RELEASE go of=hinge time=1\n  RELEASE again of=hinge time=2\n", "ELEMENTS-001"),
        ("  RELEASE go of=hinge when=nothing above=1\n", "SOLVE-190"),
        ("  RELEASE go of=hinge when=body.1 above=1\n", "SOLVE-191"),
    ],
)
def test_slips_are_named(tmp_path, lines, fault):
    (tmp_path / "INX").write_text(YOUNG.replace("{I}", "0.1").replace("{lines}", lines))
    for command in (["run", "-o", str(tmp_path)], ["check"]):
        done = CliRunner().invoke(cli, [*command, str(tmp_path / "INX"), "--json"])
        assert done.exit_code == 2
        assert fault in [each["id"] for each in json.loads(done.stdout)["faults"]]


def test_states_of_signals_and_estimates_of_errors_are_refused(tmp_path):
    state = f"  SIGNAL area integral of=time\n{AT_TIME}"
    for lines, options, fault in ((state, [], "SOLVE-188"), (AT_TIME, ["--estimate-error"], "SOLVE-187")):
        (tmp_path / "INX").write_text(YOUNG.replace("{I}", "0.1").replace("{lines}", lines))
        command = ["run", str(tmp_path / "INX"), "-o", str(tmp_path), *options, "--json"]
        done = CliRunner().invoke(cli, command)
        assert (done.exit_code, json.loads(done.stdout)["faults"][-1]["id"]) == (2, fault)


@pytest.mark.parametrize("command", [["verify"], ["modes", "--at", "0.7"], ["statics", "--rows"]])
def test_commands_that_let_no_joints_go_say_so(tmp_path, command):
    (tmp_path / "INX").write_text(YOUNG.replace("{I}", "0.1").replace("{lines}", AT_TIME))
    done = CliRunner().invoke(cli, [*command, str(tmp_path / "INX"), "--json"])
    assert done.exit_code == 2
    assert json.loads(done.stdout)["faults"][-1]["id"] == "SOLVE-192"
