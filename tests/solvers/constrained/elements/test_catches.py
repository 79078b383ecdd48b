"""Lines CATCH: bodies that are caught and drivers that take over, at a time or by a quantity.

Closed forms: the impulse of a joint keeps momentum and angular momentum, and takes the kinetic energy of the
relative speeds; a rotor on a spring swings freely between two drivers.
"""

import json
import math

import h5py
import numpy as np
import pytest
from click.testing import CliRunner

from flexmb_cli.cli import cli
from flexmb_cli.interface import solve_to_files, sweep
from flexmb_cli.run.outcome import RunOptions
from flexmb_cli.solvers.constrained import analysis as constrained
from flexmb_cli.solvers.tree import steps
from tests.run.resume.stopped_runs import resumed

pytestmark = pytest.mark.long_motion

# Two bodies in a plane: masses, inertias about z, places, velocities and angular velocities at the start.
M = np.array([2.0, 3.0])
INERTIA = np.array([0.5, 0.8])
R = np.array([[0.0, 0.0], [2.0, 0.3]])
V = np.array([[1.5, 0.2], [-0.4, 0.1]])
W = np.array([0.7, -1.1])
YOUNG = (
    "2 0 0 0 0 0 0 0 0 0 0 0\n0 0 0 1 0 0 0\n2 0.3 0 1 0 0 0\n0 1.5 0.1\nDYNAMICS forward\n"
    "MASS 1 2 0 0 0 1 1 0.5\nMASS 2 3 0 0 0 1 1 0.8\nVELOCITY 1 1.5 0.2 0 0 0 0.7\n"
    "VELOCITY 2 -0.4 0.1 0 0 0 -1.1\n{card}ELEMENTS\n{lines}END\n"
)
VSDF = (
    "VSDF PAIR\nBODY\n 1,RIGD\n 2,RIGD\nRIGI\n 1,2,0,0,0\n 1,1,0.5,0,0,0\n 2,3,0,0,0\n 1,1,0.8,0,0,0\n"
    "NODE\n 1,1,0,0,0\n 1,2,1,0,0\n 2,1,0,0,0\n 2,2,-1,0,0\nPOSI\n 1,0,0,0\n 2,2,0.3,0\n"
    "VELO\n 1,1.5,0.2,0,0,0,0.7\n 2,-0.4,0.1,0,0,0,-1.1\nELEMENTS\n{lines}\n{card}"
    "TIME\n 1.5,0.1\nEND\nSTAR\nSTOP\n"
)
DAFMS = """    2    3
DFMB PAIR
    1    3    1    1    1
    2    3    1    1    1
    1    3    1    1    1
    2    3    1    1    1
    0    0
    0    0
   15
       0.1
CONN
    0    0
MASS
    1       2.0
    2       3.0
INER
    1       1.0       1.0       0.5
    2       1.0       1.0       0.8
Q(k)
    1       0.0       0.0       0.0
    2       0.0       0.0       0.0
EULT
    1       0.0       0.0       0.0       1.0
    2       0.0       0.0       0.0       1.0
EULL
    1       0.0       0.0       0.0       1.0
    2       0.0       0.0       0.0       1.0
Y(L)
       0.0       0.0       0.7       0.0       0.0
      -1.1       1.5       0.2       0.0      -0.4
       0.1       0.0       0.0       0.0       0.0
       0.0       0.0       0.0       0.0       0.0
       0.0       2.0       0.3       0.0
RC(K
    1       0.0       0.0       0.0
    2       0.0       0.0       0.0
GRAV
    0       0.0       0.0       0.0
TOLR
    1.000E-12    1.000E-13
ELEMENTS
{lines}END
STAR
STOP
"""
DECKS = {"INP": (YOUNG, "({x},0,0)"), "pair.vsdf": (VSDF, ":{node}"), "pair.DAT": (DAFMS, "({x},0,0)")}
CARDS = {
    "INP": {"": "TOLERANCE 1e-12\n", "RAD5": "RAD5 1e-9\n", "GALF": "GALF 0.005 0.9\n"},
    "pair.vsdf": {"": "INTG\n RK45,,1e-12\n", "RAD5": "INTG\n RAD5,,1e-9\n"},
}


def text_of(name, lines, method=""):
    """A deck whose ends FROM and TO are points at x = 1 of body 1, and at x = -1 of body 2."""
    deck, end = DECKS[name]
    ends = {"FROM": "1" + end.format(x=1, node=2), "TO": "2" + end.format(x=-1, node=2)}
    for word, own in ends.items():
        lines = lines.replace(word, own)
    return deck.replace("{lines}", lines).replace("{card}", CARDS.get(name, {}).get(method, ""))


def run(folder, name, text, **options):
    (folder / name).write_text(text)
    settings = RunOptions(folder=str(folder), no_out=True, h5=str(folder / f"{name}.h5"), **options)
    outcome = solve_to_files(folder / name, settings)
    assert outcome.exit_code == 0, [fault.message for fault in outcome.faults]
    return outcome, h5py.File(folder / f"{name}.h5")


def welded(t):
    """Angular velocity after a weld at t, and the kinetic energies before and after it."""
    r = R + V * t
    centre = M @ r / M.sum()
    velocity = M @ V / M.sum()
    arms = r - centre
    L = INERTIA @ W + np.sum(M * (arms[:, 0] * V[:, 1] - arms[:, 1] * V[:, 0]))
    w = L / (INERTIA.sum() + np.sum(M * np.sum(arms**2, axis=1)))
    after = velocity + w * np.stack([-arms[:, 1], arms[:, 0]], axis=1)

    def energy(v, w):
        return 0.5 * np.sum(M * np.sum(v**2, axis=1)) + 0.5 * INERTIA @ (w**2)

    return w, energy(V, W), energy(after, np.full(2, w))


WELD = "  JOINT latch weld from=FROM to=TO\n  CATCH hook of=latch time=0.6\n"


@pytest.mark.parametrize(
    ("name", "method", "options", "within"),
    [
        ("INP", "", {}, 1e-9),
        ("INP", "RAD5", {}, 1e-6),
        ("INP", "GALF", {}, 1e-6),
        ("pair.vsdf", "", {}, 1e-9),
        ("pair.vsdf", "RAD5", {}, 1e-6),
        ("pair.DAT", "", {}, 1e-9),
        ("pair.DAT", "", {"formulation": "absolute"}, 1e-9),
        ("pair.DAT", "", {"integration": {"method": "sdirk4"}}, 1e-6),
    ],
)
def test_two_bodies_that_latch_keep_their_momentum(tmp_path, name, method, options, within):
    outcome, h5 = run(tmp_path, name, text_of(name, WELD, method), **options)
    w, before_J, after_J = welded(0.6)
    row = 7
    assert h5["body/velocity"][5, :, :2] == pytest.approx(V, abs=within)
    assert h5["body/angular_velocity"][row:, :, 2] == pytest.approx(np.full((9, 2), w), abs=within)
    momentum = np.einsum("b,tbx->tx", M, h5["body/velocity"][:, :, :2])
    assert momentum == pytest.approx(np.tile(M @ V, (16, 1)), abs=10 * within)
    kinetic = h5["energy/kinetic"][:]
    assert kinetic[:7] == pytest.approx(np.full(7, before_J), abs=10 * within)
    assert kinetic[row:] == pytest.approx(np.full(9, after_J), abs=10 * within)
    assert h5["energy/total"][:] == pytest.approx(np.full(16, before_J), abs=10 * within)
    assert h5["energy/applied_work"][row:] == pytest.approx(np.full(9, after_J - before_J), abs=10 * within)
    apart = np.diff(h5["body/position"][6:, :, :], axis=1)
    assert np.linalg.norm(apart, axis=2) == pytest.approx(np.linalg.norm(apart[0]), abs=within)
    [note] = [fault for fault in outcome.faults if fault.id == "SOLVE-212"]
    assert float(note.message.split()[-2]) == pytest.approx(after_J - before_J, abs=1e-5)
    assert not h5["general/force"][:7].any() and h5["general/force"][row:].any()


def test_a_flying_body_is_caught_by_a_hinge_at_a_place(tmp_path):
    lines = (
        "  OUTPUT x = body.1.x\n  JOINT pin general from=0(0,0,0) to=1(-0.5,0.2,0) free=rz\n"
        "  CATCH hook of=pin when=x above=0.75\n"
    )
    outcome, h5 = run(tmp_path, "INP", text_of("INP", lines))
    # It turns about the point from there on: angular momentum about it is kept.
    arm = np.array([0.5, -0.2])
    t = 0.75 / V[0, 0]
    c, s = math.cos(W[0] * t), math.sin(W[0] * t)
    arm = np.array([c * arm[0] - s * arm[1], s * arm[0] + c * arm[1]])
    L = INERTIA[0] * W[0] + M[0] * (arm[0] * V[0, 1] - arm[1] * V[0, 0])
    w = L / (INERTIA[0] + M[0] * (arm @ arm))
    assert h5["body/angular_velocity"][6:, 0, 2] == pytest.approx(np.full(10, w), abs=1e-9)
    assert h5["body/velocity"][6:, 1, :2] == pytest.approx(np.tile(V[1], (10, 1)), abs=1e-9)
    [note] = [fault for fault in outcome.faults if fault.id == "SOLVE-212"]
    assert float(note.message.split(" s;")[0].split()[-1]) == pytest.approx(t, abs=1e-11)


# A rotor of inertia 0.5 on a spring of 8 N m/rad, 4 rad/s: driven, free, driven by another, free again.
ROTOR = {
    "INR": "2 0 0 0 0 1 0 0 0 0 0 1\n0 0 0 1 0 0 0\n0 0 0 1 0 0 0\n1 2 0 0 0 0 0 0 0 0 1 0 0 1\n"
    "1 0 0 0 0 0 0\n0 1.6 0.1\nDYNAMICS forward\nMASS 2 1 0 0 0 0.5 0.5 0.5\n{card}ELEMENTS\n{lines}END\n",
    "rotor.vsdf": "VSDF ROTOR\nBODY\n 1,RIGD\nRIGI\n 1,1,0,0,0\n 0.5,0.5,0.5,0,0,0\nNODE\n 0,1,0,0,0\n"
    " 0,2,0,0,1\n 1,1,0,0,0\n 1,2,0,0,1\nPOSI\n 1,0,0,0\nJOIN\n 1,REVO,0,1,2,1,1,2,\nELEMENTS\n{lines}\n"
    "{card}TIME\n 1.6,0.1\nEND\nSTAR\nSTOP\n",
    "rotor.DAT": """    1    3
DFMB ROTOR
    1    0    0    0    0
    1    1    0    0    1
    0
    0
   16
       0.1
CONN
    0
MASS
    1       1.0
INER
    1       0.5       0.5       0.5
Q(k)
    1       0.0       0.0       0.0
EULT
    1       0.0       0.0       0.0       1.0
EULL
    1       0.0       0.0       0.0       1.0
Y(L)
       0.0       0.0
RC(K
    1       0.0       0.0       0.0
GRAV
    0       0.0       0.0       0.0
TOLR
    1.000E-12    1.000E-13
ELEMENTS
{lines}END
STAR
STOP
""",
}
DRIVES = (
    "  FUNCTION slow polynomial 2\n  FUNCTION back polynomial -3\n  SPRING hold at=ANGLE stiffness=8 rest=0\n"
    "  DRIVE first at=ANGLE rate=slow\n  DRIVE second at=ANGLE rate=back\n"
    "  RELEASE let of=first time=0.5\n  CATCH take of=second time=1.1\n  RELEASE end of=second time=1.3\n"
)
CARDS |= {"INR": CARDS["INP"], "rotor.vsdf": CARDS["pair.vsdf"]}


def rotor(name, method=""):
    lines = DRIVES.replace("ANGLE", "1.r3" if name.endswith("DAT") else "1.angle")
    return ROTOR[name].replace("{lines}", lines).replace("{card}", CARDS.get(name, {}).get(method, ""))


def turned(t):
    """Angle and rate of the rotor."""

    def free(x, v, t):
        return x * math.cos(4 * t) + v / 4 * math.sin(4 * t), v * math.cos(4 * t) - 4 * x * math.sin(4 * t)

    if t < 0.55:
        return 2 * t, 2.0
    if t < 1.15:
        return free(1.0, 2.0, t - 0.5)
    reached = free(1.0, 2.0, 0.6)[0]
    if t < 1.35:
        return reached - 3 * (t - 1.1), -3.0
    return free(reached - 0.6, -3.0, t - 1.3)


@pytest.mark.parametrize(
    ("name", "method", "options", "within"),
    [
        ("INR", "", {}, 1e-9),
        ("INR", "RAD5", {}, 1e-6),
        ("INR", "GALF", {}, 1e-3),
        ("rotor.vsdf", "", {}, 1e-9),
        ("rotor.DAT", "", {}, 1e-9),
        ("rotor.DAT", "", {"formulation": "absolute"}, 1e-9),
    ],
)
def test_a_rotor_swings_between_two_drivers(tmp_path, name, method, options, within):
    _, h5 = run(tmp_path, name, rotor(name, method), **options)
    body = -1
    for row in range(17):
        angle, rate = turned(0.1 * row)
        e0, _, _, e3 = h5["body/euler_parameters"][row, body]
        assert 2 * math.atan2(e3, e0) == pytest.approx(angle, abs=within), row
        if row != 11:  # which has the rate before the second driver takes over
            assert h5["body/angular_velocity"][row, body, 2] == pytest.approx(rate, abs=4 * within), row
    assert h5["element/effort"][:, 0] == pytest.approx(
        [-8 * turned(0.1 * row)[0] for row in range(17)], abs=10 * within
    )
    effort = h5["driver/effort"][:]
    assert effort[:6, 0] == pytest.approx([1.6 * row for row in range(6)], abs=10 * within)
    assert not effort[6:, 0].any() and not effort[:12, 1].any() and not effort[14:, 1].any()
    total = h5["energy/total"][:]
    assert total == pytest.approx(np.full(17, total[0]), abs=20 * within)


# Resuming


@pytest.fixture
def short_blocks(monkeypatch):
    for module in (constrained, steps):
        monkeypatch.setattr(module, "LARGEST_BLOCK", 3)


FORCED = (
    "  OUTPUT x = body.1.x\n  OUTPUT lean roll_pitch_yaw body=1\n"
    "  JOINT pin general from=0(0,0,0) to=1(-0.5,0.2,0) free=rz\n  CATCH hook of=pin when=x above=0.75\n"
    "  RELEASE drop of=pin time=1.05\n"
)


@pytest.mark.parametrize(
    ("name", "method", "lines", "options"),
    [
        ("INP", "", WELD, {}),
        ("INP", "RAD5", FORCED, {}),
        ("INP", "GALF", FORCED, {}),
        ("pair.vsdf", "RAD5", WELD, {}),
        ("pair.DAT", "", WELD, {}),
        ("pair.DAT", "", WELD, {"formulation": "absolute"}),
        ("pair.DAT", "", WELD, {"integration": {"method": "radau"}}),
    ],
)
@pytest.mark.parametrize("stops", [(1, 1, 1), (2, 1), (3, 2)])
def test_stopped_runs_resume_to_the_same_bytes(tmp_path, short_blocks, name, method, lines, options, stops):
    whole, stopped = resumed(tmp_path, name, text_of(name, lines, method), stops, **options)
    assert stopped == whole


@pytest.mark.parametrize("name", ROTOR)
def test_runs_with_drivers_resume_to_the_same_bytes(tmp_path, short_blocks, name):
    whole, stopped = resumed(tmp_path, name, rotor(name, "RAD5"), (1, 1, 1, 1, 1))
    assert stopped == whole


# What is refused, and what the other commands say


@pytest.mark.parametrize(
    ("lines", "fault"),
    [
        ("  CATCH hook of=nothing time=0.5\n", "ELEMENTS-208"),
        (f"{WELD}  CATCH again of=latch time=0.7\n", "ELEMENTS-001"),
        ("  SIGNAL area integral of=time\n" + WELD, "SOLVE-188"),
    ],
)
def test_slips_are_named(tmp_path, lines, fault):
    (tmp_path / "INP").write_text(text_of("INP", lines))
    done = CliRunner().invoke(cli, ["run", "-o", str(tmp_path), str(tmp_path / "INP"), "--json"])
    assert done.exit_code == 2
    assert fault in [each["id"] for each in json.loads(done.stdout)["faults"]]


def test_a_part_that_holds_already_or_nothing_is_noted(tmp_path):
    lines = f"{WELD}  RELEASE early of=latch time=0.6\n"
    outcome, h5 = run(tmp_path, "INP", text_of("INP", lines))
    [note] = [fault for fault in outcome.faults if fault.id == "SOLVE-189"]
    assert note.message == "latch holds nothing at t = 0.6 s"
    assert h5["general/force"][7:].any()


def test_check_counts_the_joints_of_the_start(tmp_path):
    (tmp_path / "INP").write_text(text_of("INP", WELD))
    done = CliRunner().invoke(cli, ["check", str(tmp_path / "INP"), "--json"])
    assert done.exit_code == 0
    assert json.loads(done.stdout)["counts"]["degrees_of_freedom"] == 12


@pytest.mark.parametrize("form", ["vsdf", "exudyn"])
def test_conversion_refuses_drivers_that_are_caught(tmp_path, form):
    lines = (
        "ELEMENTS\n  FUNCTION back polynomial -3\n  DRIVE take at=1.angle rate=back\n"
        "  CATCH on of=take time=1\n"
    )
    (tmp_path / "INR").write_text(rotor("INR").partition("ELEMENTS")[0] + f"{lines}END\n")
    done = CliRunner().invoke(
        cli, ["convert", str(tmp_path / "INR"), "--to", form, "-o", str(tmp_path / "other")]
    )
    assert done.exit_code != 0 and "lines CATCH and RELEASE" in str(done.exception)


def test_a_sweep_follows_the_time_of_a_catch(tmp_path):
    (tmp_path / "INP").write_text(text_of("INP", WELD))
    study = {
        "deck": str(tmp_path / "INP"),
        "parameters": {"hook.time": [0.3, 0.6]},
        "results": {"w": "last body.1.angular_velocity.z"},
    }
    expected = [welded(0.3)[0], welded(0.6)[0]]
    assert sweep(study)["result/w"] == pytest.approx(expected, abs=1e-9)


def test_catches_do_not_depend_on_the_unit_of_length(tmp_path):
    _, metres = run(tmp_path, "INP", text_of("INP", WELD))
    scaled = text_of("INP", f"  UNITS mm\n{WELD}")
    for old, new in (
        ("2 0.3 0 1 0 0 0", "2000 300 0 1 0 0 0"),
        ("MASS 1 2 0 0 0 1 1 0.5", "MASS 1 0.002 0 0 0 1e3 1e3 500"),
        ("MASS 2 3 0 0 0 1 1 0.8", "MASS 2 0.003 0 0 0 1e3 1e3 800"),
        ("1.5 0.2 0 0 0 0.7", "1500 200 0 0 0 0.7"),
        ("-0.4 0.1 0 0 0 -1.1", "-400 100 0 0 0 -1.1"),
        ("1(1,0,0)", "1(1000,0,0)"),
        ("2(-1,0,0)", "2(-1000,0,0)"),
    ):
        assert old in scaled
        scaled = scaled.replace(old, new)
    _, millimetres = run(tmp_path, "INMM", scaled)
    assert millimetres["body/position"][:] == pytest.approx(1e3 * metres["body/position"][:], abs=1e-6)
    work = "energy/applied_work"
    assert millimetres[work][:] == pytest.approx(1e3 * metres[work][:], abs=1e-6)
