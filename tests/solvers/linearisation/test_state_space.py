"""B, C and D of the linearised motion against closed forms and against `run` itself."""

import json
import math
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.io import loadmat
from scipy.linalg import expm

from flexmb_cli.model.integrators import Integrator
from flexmb_cli.model.loads import AppliedForce, DynamicModel, MassProperties
from flexmb_cli.model.mechanism import Driver, Joint, Mechanism, Point, Simplified, TimeGrid
from flexmb_cli.solvers.constrained.young_dynamics import ForwardDynamics
from flexmb_cli.solvers.linearisation.constrained import bring_to, linearised
from flexmb_cli.solvers.linearisation.constrained_responses import ConstrainedResponses, constrained_signals
from flexmb_cli.solvers.linearisation.state_space import state_space
from tests.solvers.constrained.dynamic_runs import AT_REST, GROUND, body, run
from tests.solvers.linearisation.test_turning_frames import MASS, OMEGA, O, X, Y, springs, turntable

DECKS = Path(__file__).parent / "turning"
ARM = 0.1  # of the point on the mass, along the rail, m


def space_of(model, time=0.0):
    analysis = ForwardDynamics(model)
    bring_to(analysis, time)
    motion, A, _ = linearised(analysis)
    later = ConstrainedResponses(motion.soon(A))
    return state_space(ConstrainedResponses(motion), later, constrained_signals(motion))


class Entries:
    """Entries of a state space's record by the names of its signals."""

    def __init__(self, record):
        self.record = record

    def __call__(self, matrix, row, column):
        rows = self.record["states" if matrix in "AB" else "outputs"]
        columns = self.record["states" if matrix in "AC" else "inputs"]
        places = [[signal["name"] for signal in signals] for signals in (rows, columns)]
        return self.record[matrix][places[0].index(row)][places[1].index(column)]


def modes(*arguments):
    command = [sys.executable, "-m", "flexmb_cli", "modes", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, cwd=DECKS.parents[2], timeout=300)


def record_of(deck, *arguments):
    done = modes(DECKS / deck, "--json", *arguments)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)["mechanism"]


# Of a deck: state, driver, point on the mass.
NAMES = {
    "turntable.dat": ("body 3 displacement x", "driver 1", "point of interest 1"),
    "turntable.vsdf": ("body 2 displacement x", "motion 1", "body 2 node 3"),
    "turntable.DAT": ("body 2 translation 1", "body 1 rotation 3", "hinge 2"),
}


@pytest.mark.processes
@pytest.mark.parametrize("deck", NAMES)
def test_the_turntable_of_every_dialect_has_its_closed_form(deck):
    """r'' = (Omega² - k/m) r; a point at r + a: a_r = r'' - Omega² (r + a) - 2 Omega a δ', and so on."""
    mechanism = record_of(deck)
    entry = Entries(mechanism["state_space"])
    state, driver, point = NAMES[deck]
    assert mechanism["frequency"] == pytest.approx([1.51824], abs=5e-6)
    assert not mechanism["frozen"]
    assert entry("A", f"{state} rate", state) == pytest.approx(-91.0, abs=1e-7)
    assert entry("A", state, f"{state} rate") == pytest.approx(1.0, abs=1e-9)
    assert entry("B", f"{state} rate", f"{driver} rate") == pytest.approx(0.0, abs=1e-9)
    if deck == "turntable.DAT":
        assert entry("C", f"{state} rate", f"{state} rate") == pytest.approx(1.0, abs=1e-9)
        assert entry("D", f"{driver} rate", f"{driver} rate") == pytest.approx(1.0, abs=1e-9)
        return
    assert entry("C", f"{point} position x", state) == pytest.approx(1.0, abs=1e-9)
    assert entry("C", f"{point} velocity y", state) == pytest.approx(OMEGA, abs=1e-9)
    assert entry("C", f"{point} acceleration y", f"{state} rate") == pytest.approx(2.0 * OMEGA, abs=1e-9)
    assert entry("C", f"{point} acceleration x", state) == pytest.approx(-100.0, abs=1e-7)


def test_inputs_of_a_turntable_seen_on_its_rail():
    """Mass at r = 0, point at a on it: F = m (r'' - Omega² r), N = m (2 Omega r' + r w'), tensions pull.

    A force that stays along the global axes turns against the rail: B changes.
    """
    loads = turntable(1, springs(X, 100.0))
    mechanism = replace(loads.mechanism, points=(Point("point 1", 2, (ARM, 0.0, 0.0)),))
    force = AppliedForce("force 1", 2, (0.0, 0.0, 0.0))
    following = AppliedForce("force 2", 2, (0.0, 0.0, 0.0), following=True)
    space = space_of(replace(loads, mechanism=mechanism, forces=(force, following)), 0.3)
    signals = {what: [vars(s) for s in getattr(space, what)] for what in ("states", "inputs", "outputs")}
    entry = Entries({**{name: getattr(space, name) for name in "ABCD"}, **signals})
    rate = "body 3 displacement x rate"
    turned = OMEGA * 0.3
    assert entry("B", rate, "force 1 x") == pytest.approx(math.cos(turned) / MASS, rel=1e-8)
    assert entry("B", rate, "force 1 y") == pytest.approx(math.sin(turned) / MASS, rel=1e-8)
    assert entry("B", rate, "force 2 x") == pytest.approx(1.0 / MASS, rel=1e-8)
    assert entry("B", rate, "force 2 y") == pytest.approx(0.0, abs=1e-10)
    # The spring from the point at -1 pulls the mass back, the other one forward.
    assert entry("B", rate, f"spring {X} 0 tension") == pytest.approx(-1.0 / MASS, rel=1e-8)
    assert entry("B", rate, f"spring {X} 1 tension") == pytest.approx(1.0 / MASS, rel=1e-8)
    assert entry("D", "revolute 1 rotation z", "driver 1") == pytest.approx(1.0, rel=1e-8)
    assert entry("D", "revolute 1 rotation z rate", "driver 1 rate") == pytest.approx(1.0, rel=1e-8)
    assert entry("D", "point 1 position y", "driver 1") == pytest.approx(ARM, rel=1e-8)
    assert entry("D", "point 1 velocity x", "driver 1") == pytest.approx(-OMEGA * ARM, rel=1e-8)
    assert entry("D", "point 1 velocity y", "driver 1 rate") == pytest.approx(ARM, rel=1e-8)
    assert entry("D", "point 1 acceleration y", "driver 1") == pytest.approx(-(OMEGA**2) * ARM, rel=1e-8)
    assert entry("D", "point 1 acceleration x", "driver 1 rate") == pytest.approx(
        -2.0 * OMEGA * ARM, rel=1e-8
    )
    assert entry("D", "point 1 acceleration y", "driver 1 acceleration") == pytest.approx(ARM, rel=1e-8)
    assert entry("D", "driver 1 effort", "driver 1 acceleration") == pytest.approx(0.1, rel=1e-8)
    assert entry("D", "translational 1 force y", "force 2 y") == pytest.approx(-1.0, rel=1e-8)
    assert entry("C", "translational 1 force y", rate) == pytest.approx(2.0 * MASS * OMEGA, rel=1e-8)
    assert entry("C", "revolute 1 force x", "body 3 displacement x") == pytest.approx(-200.0, rel=1e-8)
    assert space.constant == {"A": True, "B": False, "C": True, "D": False}
    assert [s.unit for s in space.states] == ["m", "m/s"]
    assert space.states[0].relative_to == "body 2"


def hung_from_slider():
    """A pendulum of 0.8 m and 2 kg m² about its joint, hung from a body that a driver moves along x."""
    mechanism = Mechanism(
        (GROUND, body(2), body(3, p=(math.cos(math.pi / 4), 0.0, math.sin(math.pi / 4), 0.0))),
        TimeGrid(0.0, 1.0, 0.5),
        (Joint("revolute", "revolute 1", 1, 2, O, O, Y, Y),),
        tuple(Simplified(f"simplified {k}", 1, k, 0.0) for k in (2, 3, 4, 5, 6)),
        drivers=(Driver("driver 1", 1, 1, 0.0, 0.0, 0.0),),
        grounds=(AT_REST,),
    )
    inertia = (2.0 - 1.5 * 0.64,) * 3 + (0.0,) * 3
    mass = MassProperties("mass 1", 2, 1.5, (0.8, 0.0, 0.0), inertia)
    return DynamicModel(mechanism, "forward", (mass,), gravity=(0.0, 0.0, -9.81))


def test_a_driven_support_shakes_its_pendulum():
    """J phi'' + m g l phi = ± m l a for the acceleration a of the support; its place and speed do nothing."""
    space = space_of(hung_from_slider())
    names = [s.name for s in space.inputs]
    assert names == ["driver 1", "driver 1 rate", "driver 1 acceleration"]
    assert [s.unit for s in space.inputs] == ["m", "m/s", "m/s2"]
    assert space.A[1] == pytest.approx([-1.5 * 9.81 * 0.8 / 2.0, 0.0], abs=1e-8)
    # The bob hangs along -z and lags behind: about +y it turns so that a point below moves to -x.
    assert space.B[1] == pytest.approx([0.0, 0.0, 1.5 * 0.8 / 2.0], abs=1e-8)
    assert space.B[0] == pytest.approx([0.0, 0.0, 0.0], abs=1e-10)


@pytest.mark.long_motion
def test_a_small_step_of_a_load_moves_a_run_as_the_state_space_tells():
    """Two rails, unequal springs, a force of 1e-3 N from the start: expm of A and B against `run`."""
    points = (Point("point 1", 2, (0.05, 0.02, 0.0)),)
    loads = turntable(2, springs(X, 100.0) + springs(Y, 36.0))
    grid = TimeGrid(0.0, 0.6, 0.1)
    mechanism = replace(loads.mechanism, points=points, time=grid)
    step = AppliedForce("force 1", 2, (1e-3, 0.0, 0.0), following=True)
    model = replace(loads, mechanism=mechanism, forces=(step,), integrator=Integrator(tolerance=1e-12))
    still = replace(model, forces=(replace(step, force=(0.0, 0.0, 0.0)),))
    space = space_of(still)
    there, here = run(model), run(still)
    n, k = len(space.A), [s.name for s in space.inputs].index("force 1 x")
    grown = np.zeros((n + 1, n + 1))
    grown[:n, :n], grown[:n, n] = space.A, space.B[:, k]
    for row, t in enumerate(here.time):
        x = expm(grown * t)[:n, n] * 1e-3
        reported = (space.C @ x + space.D[:, k] * 1e-3)[[s.name.startswith("point 1") for s in space.outputs]]
        turn = rotation(OMEGA * t)
        for part, name in enumerate(("point_position", "point_velocity", "point_acceleration")):
            change = (getattr(there, name) - getattr(here, name))[row, 0] @ turn
            assert change == pytest.approx(reported[3 * part : 3 * part + 3], abs=2e-8)
    assert np.abs(reported).max() > 1e-5


def rotation(angle):
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


@pytest.mark.processes
def test_the_state_space_goes_to_a_file_of_any_form(tmp_path):
    deck = DECKS / "turntable.dat"
    files = [tmp_path / f"space{suffix}" for suffix in (".npz", ".mat", ".json")]
    for file in files:
        done = modes(deck, "--out", file, "-q")
        assert done.returncode == 0, done.stderr
    archive, reported = np.load(files[0]), json.loads(files[2].read_text())
    matlab = loadmat(files[1], simplify_cells=True)["state_space"]
    assert archive["A"] == pytest.approx(np.array([[0.0, 1.0], [-91.0, 0.0]]), abs=1e-7)
    for name in "ABCD":
        assert archive[name].tolist() == reported[name] == matlab[name].tolist()
    assert list(archive["states"]) == ["body 3 displacement x", "body 3 displacement x rate"]
    assert list(matlab["input_units"]) == ["N", "N", "rad", "rad/s", "rad/s2"]
    assert archive["C"].shape == (len(archive["outputs"]), 2)


@pytest.mark.processes
def test_the_file_of_a_state_space_is_named_once_it_is_written(tmp_path):
    """Rule: a command that writes a file names it on standard error, unless -q or --json is given."""
    deck, file = DECKS / "turntable.dat", tmp_path / "space.npz"
    assert modes(deck, "--out", file).stderr.splitlines()[-1] == f"{deck} → {file}, state space"
    for option in ("--json", "-q"):
        assert "→" not in modes(deck, "--out", file, option).stderr
    lost = tmp_path / "missing" / "space.npz"
    done = modes(deck, "--out", lost)
    assert done.returncode != 0 and "→" not in done.stderr


@pytest.mark.processes
@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["turntable.dat", "--out", "space.txt"], ".npz, .mat, .json"),
        (["turntable.dat", "turntable.vsdf", "--out", "space.npz"], "one deck"),
    ],
)
def test_an_output_that_cannot_be_is_refused(arguments, words):
    done = modes(*(DECKS / word if "turntable" in word else word for word in arguments))
    assert done.returncode == 2
    assert words in done.stderr
