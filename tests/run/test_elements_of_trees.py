"""DAFMS decks with elements: `verify`, `modes`, state space, `--resume`; the note on closed directions."""

import math
from dataclasses import replace

import h5py
import numpy as np
import pytest

from flexmb_cli.errors import AnalysisError
from flexmb_cli.model.arrays import tree_elements
from flexmb_cli.run.check.check import check_deck
from flexmb_cli.run.mechanism_modes import Wish, tree_modes
from flexmb_cli.run.outcome import Listener, Outcome, Run, RunOptions
from flexmb_cli.run.solution import run_deck
from flexmb_cli.run.verify.verify import verify_deck
from flexmb_cli.solvers.constrained.tree import AbsoluteTree
from flexmb_cli.solvers.tree import steps
from flexmb_cli.solvers.tree.analysis import TreeAnalysis
from tests.dialects.dafms.dafms_decks import build, deck_text
from tests.dialects.dafms.test_dafms_elements import (
    CASES,
    SHORT,
    TWO_LINKS,
    card,
    deck,
    function,
    integers,
    reals,
)
from tests.run.dafms_runs import ENDINGS, altered, run, stop_after

pytestmark = pytest.mark.long_motion
# A clamped beam of two nodes, 0.25 m and 0.5 m from the clamp, EI = 5.5 N m2, a spring at its tip.
POSITIONS, MASSES = np.array([0.25, 0.5]), np.array([0.02145, 0.010725])
HELD = f"{function(1, 'polynomial', 0.0)}\nELEMENTS\n  DRIVE pref-1 at=1.r1 value=1\n"
TIP_SPRING = "ELEMENTS\n  SPRING lspr-1 from=0(0,0.55,1) to=1:2 stiffness=500 rest=1 damping=0.3"


def beam(*cards, swings=False):
    """The supplied beam without its torque, clamped by a driver unless it swings."""
    more = "\n".join(cards)
    return deck_text(
        "shaft_beam_n2",
        ("  500\n      .001", "    5\n      .002"),
        ("DESN\n    1    1", "DESN\n    1    0"),
        ("END \n", f"{'' if swings else HELD}{more}\nEND \n"),
    )


def verified(folder, text, tolerance=1e-8):
    path = folder / "x.DAT"
    path.write_text(text)
    return verify_deck(str(path), RunOptions(), tolerance)


@pytest.mark.parametrize("name", CASES)
def test_kanes_equations_and_absolute_coordinates_agree(tmp_path, name):
    # The bushing ends the longer run: its bodies turn by more than a quarter.
    model = SHORT if name == "bushing" else TWO_LINKS
    found = verified(tmp_path, f"{model}{CASES[name][1]}\nEND \nSTAR\nSTOP\n", 1e-7)
    assert found.outcome.exit_code == 0, [each for each in found.differences if each.relative > 1e-7]
    compared = {each.name for each in found.differences if each.scale > 0}
    expected = {"gears": {"coupling effort"}, "motor": set(), "driver": {"driver effort"}}
    assert compared >= expected.get(name, {"element effort", "element rate", "element work"})


def test_elements_on_nodes_of_a_beam_agree(tmp_path):
    """Spring, cable and bushing between nodes and the inertial frame; friction from what the nodes need."""
    cards = (
        TIP_SPRING,
        "ELEMENTS\n  CABLE cabl-1 from=0(0,0.3,-1) to=1:1 stiffness=80 rest=0.99 damping=0.2",
        "ELEMENTS\n"
        "  BUSHING bush-1 from=1:2 to=0(0,0.55,0) k=(3,4,5) kr=(0.1,0.2,0.3) c=(0.1,0.2,0.3) "
        "cr=(0.01,0.02,0.03)",
        "ELEMENTS\n"
        "  FRICTION fric-1 joint=1 dynamic=0.2 static=0.3 stribeck=0.1 creep=0.01 radius=0.05 "
        "preload=3",
        card("MOTR", integers(1, 1) + reals(0.4)),
    )
    found = verified(
        tmp_path, beam(*cards, swings=True).replace("GRAV\n    0       0.0", "GRAV\n    0       1.0")
    )
    assert found.outcome.exit_code == 0, [each for each in found.differences if each.relative > 1e-8]


@pytest.mark.parametrize("method", [2, 4])
def test_a_stiff_damper_is_verified_by_implicit_steps_in_both_formulations(tmp_path, method):
    """Little moves after J/c < 0.3 ms; explicit steps stay so short over all of the 0.5 s: 76852 of them."""
    cards = (
        "ELEMENTS\n"
        "  SPRING hspr-1 at=1.r3 stiffness=30 rest=0.4 damping=8000\n"
        "METH\n"
        f"{method:5d}\n"
        "END \n"
        "STAR\n"
        "STOP\n"
    )
    found = verified(tmp_path, f"{TWO_LINKS}{cards}", 1e-7)
    assert found.outcome.exit_code == 0, [each for each in found.differences if each.relative > 1e-7]
    assert found.outcome.faults == []
    analysis = TreeAnalysis(build(f"{TWO_LINKS}{cards}")[0])
    list(analysis.rows())
    # Twelve an explicit step would be 920,000.
    assert analysis.clock["evaluations"][0] < 92_000


def test_loops_and_couplings_agree(tmp_path):
    """A four-bar with a spring across it and friction in a hinge inside the loop."""
    cards = (
        "ELEMENTS\n  SPRING lspr-1 from=0(0,0,0.1) to=2(0,0.3,0) stiffness=30 rest=0.2 damping=0.1",
        "ELEMENTS\n"
        "  FRICTION fric-1 joint=2 dynamic=0.2 static=0.3 stribeck=0.1 creep=0.01 radius=0.02 "
        "preload=1",
    )
    text = deck_text("fourbar_rigid", ("  200\n", "    5\n"), ("END \n", "\n".join([*cards, "END \n"])))
    found = verified(tmp_path, text)
    assert found.outcome.exit_code == 0, [each for each in found.differences if each.relative > 1e-8]


def test_a_coupling_that_repeats_another_agrees(tmp_path):
    """The one formulation lets the first bear all, the other shares: along the coordinates it is the same."""
    cards = "ELEMENTS\n  COUPLING coup-1 1.r3=2 2.r3=3\n  COUPLING coup-2 1.r3=4 2.r3=6"
    found = verified(tmp_path, f"{SHORT}{cards}\nEND \nSTAR\nSTOP\n", 1e-8)
    assert found.outcome.exit_code == 0, [each for each in found.differences if each.relative > 1e-8]
    assert max(each.scale for each in found.differences if each.name == "coupling effort") > 0.1


@pytest.mark.parametrize("method", [1, 2])
def test_a_cam_of_two_hinges_agrees_by_kane_and_by_multipliers(tmp_path, method):
    """Hinge 2 follows 0.1 sin(2 q1 + 1) by explicit steps and by SDIRK4, and begins there."""
    cards = "ELEMENTS\n  FUNCTION lift sine 0 0.1 2 1\n  COUPLING cam from=1.r3 to=2.r3 function=lift"
    text = f"{SHORT}{cards}\nMETH\n{method:5d}\nEND \nSTAR\nSTOP\n"
    found = verified(tmp_path, text, 1e-8)
    assert found.outcome.exit_code == 0, [each for each in found.differences if each.relative > 1e-8]
    assert max(each.scale for each in found.differences if each.name == "coupling effort") > 0.1
    rows = list(TreeAnalysis(build(text)[0]).rows())
    q = np.concatenate([each.q for each in rows])
    assert np.ptp(q[:, 0]) > 0.01
    assert q[:, 1] == pytest.approx(0.1 * np.sin(2 * q[:, 0] + 1), abs=1e-12)


@pytest.mark.parametrize("method", [1, 2])
def test_a_follower_that_lifts_off_agrees_by_kane_and_by_multipliers(tmp_path, method):
    cards = (
        "ELEMENTS\n  FUNCTION lift sine 0 0.1 2 1\n"
        "  COUPLING cam from=1.r3 to=2.r3 function=lift stiffness=50 damping=0.3 upper=-0.1"
    )
    found = verified(tmp_path, f"{SHORT}{cards}\nMETH\n{method:5d}\nEND \nSTAR\nSTOP\n", 1e-8)
    assert found.outcome.exit_code == 0, [each for each in found.differences if each.relative > 1e-8]
    assert max(each.scale for each in found.differences if each.name == "element effort") > 0.1


# Body 1, light, slides along axis 1; body 2 hangs from it and turns about axis 3.
CART = (
    SHORT.replace("    1    0    0    0    0\n    2", "    1    1    1    0    0\n    2", 1)
    .replace("    1    1    0    0    1\n    2    1", "    1    0    0    0    0\n    2    1", 1)
    .replace("    1       1.5\n", "    1       0.1\n")
    .replace("    2       1.0       0.0", "    2       0.0       0.0", 1)
    .replace("    1       0.4       0.0", "    1       0.0       0.0")
    .replace("Y(L)\n       0.0       0.0       0.0", "Y(L)\n       0.0       1.0      -2.2")
)


def test_friction_agrees_where_it_changes_its_own_normal_force_by_more_than_the_whole(tmp_path):
    """The rod leans by φ: each N of friction on the light slide changes the normal force by about tan φ N."""
    found = verified(
        tmp_path,
        f"{CART}ELEMENTS\n"
        "  FRICTION fric-1 joint=1 dynamic=1.5 static=1.5 stribeck=1 creep=0.001\n"
        "END \n"
        "STAR\n"
        "STOP\n",
        1e-7,
    )
    assert found.outcome.exit_code == 0, [each for each in found.differences if each.relative > 1e-7]


@pytest.mark.parametrize("kind", [TreeAnalysis, AbsoluteTree])
def test_friction_that_jams_is_named_in_both_formulations(kind):
    """The rod leans so that each N of friction adds more than one N of normal force, and pulls at it."""
    tree = build(
        f"{CART}ELEMENTS\n"
        "  FRICTION fric-1 joint=1 dynamic=30 static=30 stribeck=1 creep=0.001\n"
        "END \n"
        "STAR\n"
        "STOP\n"
    )[0]
    with pytest.raises(AnalysisError, match="at t = 0 s friction jams a joint"):
        next(kind(replace(tree, y=-tree.y)).rows())


@pytest.mark.parametrize("method", ["dop853", "radau", "sdirk4", "lsoda"])
def test_a_bushing_that_turns_too_far_ends_the_recursion(method):
    tree = build(f"{TWO_LINKS}{CASES['bushing'][1]}\nEND \nSTAR\nSTOP\n")[0]
    tree = replace(tree, integration=replace(tree.integration, method=method, rtol=1e-6))
    with pytest.raises(AnalysisError, match="bushing 1 have turned by a quarter turn"):
        list(TreeAnalysis(tree).rows())


def test_an_error_in_one_formulation_shows(tmp_path, monkeypatch):
    right = tree_elements.fill_law

    def slightly_wrong(record, *law):
        right(record, *law)["c"][..., 2] *= 1.001  # the damping

    monkeypatch.setattr(tree_elements, "fill_law", slightly_wrong)
    found = verified(tmp_path, f"{SHORT}{CASES['line'][1]}\nEND \nSTAR\nSTOP\n")
    assert found.outcome.exit_code == 1


def linearised(text, **wish):
    return tree_modes(build(text)[0], Wish(**wish), Run(Outcome("x"), RunOptions(), Listener()))


def test_two_links_held_in_line_swing_as_one_pendulum_with_a_spring():
    """J = 0.44 + 0.172 + 0.8 (1 + 2 0.3), m g s = 9.81 (1.5 0.4 + 0.8 1.3); hanging, the spring at rest."""
    cards = [
        function(1, "polynomial", 0.0),
        "ELEMENTS\n  DRIVE pref-1 at=2.r3 value=1",
        "ELEMENTS\n  SPRING hspr-1 at=1.r3 stiffness=20 rest=-1.5707963 damping=0.5",
    ]
    found = linearised(deck("\n".join(cards)), equilibrium=True)
    J, stiffness = 0.612 + 0.8 * 1.6, 20 + 9.81 * 1.64
    omega, zeta = math.sqrt(stiffness / J), 0.5 / (2 * math.sqrt(stiffness * J))
    assert found.modes.damping == pytest.approx([zeta], rel=1e-6)
    assert found.modes.frequency == pytest.approx([omega * math.sqrt(1 - zeta**2) / math.tau], rel=1e-7)
    assert dict(found.position)["body 1 rotation 3"] == pytest.approx((-math.pi / 2,), abs=1e-7)
    assert np.abs(found.modes.shapes[0]) == pytest.approx([1, 0], abs=1e-9)


def test_a_spring_at_the_tip_of_a_beam_stiffens_and_carries_it():
    """Flexibility of a cantilever, x_i² (3 x_j - x_i)/6EI for x_i <= x_j (Gere, Mechanics of Materials)."""
    x, EI, k, g = POSITIONS, 5.5, 500.0, 0.5
    near, far = np.minimum.outer(x, x), np.maximum.outer(x, x)
    K = np.linalg.inv(near**2 * (3 * far - near) / (6 * EI)) + np.diag([0.0, k])
    text = beam(TIP_SPRING).replace(
        "GRAV\n    0       0.0       0.0       0.0", f"GRAV\n    0       0.0       0.0{g:10.2f}"
    )
    found = linearised(text, equilibrium=True)
    D = np.diag([0.0, 0.3])
    A = np.block([[np.zeros((2, 2)), np.eye(2)], [-K / MASSES[:, None], -D / MASSES[:, None]]])
    eigenvalues = np.linalg.eigvals(A)
    wanted = eigenvalues[eigenvalues.imag > 0][np.argsort(np.abs(eigenvalues[eigenvalues.imag > 0]))]
    assert found.modes.frequency == pytest.approx(wanted.imag / math.tau, rel=1e-8)
    assert found.modes.damping == pytest.approx(-wanted.real / np.abs(wanted), rel=1e-6)
    position = [value[0] for name, value in found.position if "node" in name]
    assert position == pytest.approx(np.linalg.solve(K, MASSES * g), rel=1e-7)


@pytest.mark.parametrize(
    ("name", "dof", "potential"),
    [
        ("driver", 1, 0.0),
        ("gears", 1, 0.0),
        ("line", 2, 15 * (math.sqrt(4.36) - 1.2) ** 2 + 2 * (math.sqrt(4.36) - 1.2)),
    ],
)
def test_check_counts_elements_and_their_energy(tmp_path, name, dof, potential):
    """A spring of 30 N/m and a preload of 2 N from (1, 2) to (1.6, 0), 1.2 m long at rest."""
    path = tmp_path / "x.DAT"
    path.write_text(deck(CASES[name][1]))
    report = check_deck(str(path), RunOptions())
    assert report.counts["degrees_of_freedom"] == dof
    assert report.tree.energies["potential"] == pytest.approx(potential, abs=1e-12)


def test_a_run_notes_a_stop_that_is_pressed_at_the_start_by_its_card(tmp_path):
    text = deck("ELEMENTS\n  STOP hsto-1 at=1.r3 lower=0.1 upper=0.5 stiffness=100")
    (tmp_path / "x.DAT").write_text(text)
    found = run_deck(str(tmp_path / "x.DAT"), RunOptions(folder=str(tmp_path)))
    (note,) = [fault for fault in found.faults if fault.severity == "note"]
    assert note.message.startswith("it begins 0.1 rad beyond its limit and pushes with 10 N m; correct")
    lines = text.splitlines()
    assert (note.subject, note.place.line) == ("hsto-1", lines.index("ELEMENTS") + 2)


def transfer(space, s):
    """Outputs by inputs at s: names, and C (s - A)⁻¹ B + D."""
    gain = space.C @ np.linalg.solve(s * np.eye(len(space.A)) - space.A, space.B) + space.D
    return {signal.name: row for signal, row in zip(space.outputs, gain, strict=True)}


@pytest.mark.parametrize(
    ("old", "new"),
    [
        (
            ["MOTR", integers(1), integers(2, 3) + reals(0.5)],
            [function(4, "polynomial", 0.5), "ELEMENTS\n  MOTOR motf-1 at=2.r3 effort=4"],
        ),
        (
            ["PRES", integers(1), integers(2, 3) + reals(0, 0.5, 0.3)],
            [function(4, "polynomial", 0, 0.5, 0.15), "ELEMENTS\n  DRIVE pref-1 at=2.r3 value=4"],
        ),
        (
            ["TABL", integers(1), integers(2, 3, 1), reals(0, 0.5)],
            [
                card("TABL", integers(2, 3, 1), reals(0, 0.5)),
                "ELEMENTS\n  STOP hsto-1 at=2.r3 lower=-9 upper=9 stiffness=1",
            ],
        ),
    ],
)
def test_the_state_space_is_that_of_the_tree_without_elements(old, new):
    """Cards of 1992 and the newer ones; names of the efforts of drivers are those of the cards."""
    spring = ["SPRI", integers(1), integers(1, 3) + reals(20, 0.2)]
    one = linearised(deck("\n".join([*spring, *old])), state_space=True).space
    other = linearised(
        deck("\n".join(["ELEMENTS\n  SPRING hspr-1 at=1.r3 stiffness=20 rest=0.2", *new])), state_space=True
    ).space
    wanted, found = transfer(one, 0.3 + 2j), transfer(other, 0.3 + 2j)
    assert len(one.inputs) in (1, 3)
    columns = [2] if len(other.inputs) > len(one.inputs) == 1 else range(len(one.inputs))
    for name, row in wanted.items():
        if name == "body 2 rotation 3 effort":
            name = next(other for other in found if other.endswith("effort"))
        assert found[name][[*columns]] == pytest.approx(row, abs=1e-9), name


def test_a_motor_accelerates_two_links_by_the_inverse_of_their_mass_matrix():
    """J1 + J2 + m (l² + 2 l c) = 1.892, J2 + m l c = 0.412 and J2 = 0.172 kg m2 in line; s x = ... + B u."""
    cards = [
        function(4, "polynomial", 0.5),
        "ELEMENTS\n  MOTOR motf-1 at=2.r3 effort=4",
        "ELEMENTS\n  SPRING hspr-1 at=1.r3 stiffness=20",
    ]
    space = linearised(deck("\n".join(cards)), state_space=True).space
    assert [signal.name for signal in space.inputs] == ["motf-1 effort"]
    expected = np.linalg.inv([[1.892, 0.412], [0.412, 0.172]])[:, 1]
    assert space.B[:, 0] == pytest.approx([0.0, 0.0, *expected], rel=1e-8)
    assert space.A[2:, 0] @ [1.892, 0.412] == pytest.approx(-20.0, rel=1e-6)


def test_a_stopped_run_goes_on_to_the_same_bytes(tmp_path, monkeypatch):
    """Angles beyond a turn and signs of Euler parameters go on from the row before the stop."""
    monkeypatch.setattr(steps, "LARGEST_BLOCK", 3)
    text = deck(f"{CASES['friction'][1]}\n{CASES['motor'][1]}").replace(
        "    5\n       0.1\n", "   12\n       0.2\n"
    )
    path = tmp_path / "x.DAT"
    path.write_text(text)
    run(path, tmp_path / "whole")
    first = run(path, tmp_path / "stopped", stop_after(2))
    assert (first.exit_code, first.rows, first.resumable) == (130, 6, True)
    assert run(path, tmp_path / "stopped", resume=True).exit_code == 0
    for ending in ENDINGS:
        assert (tmp_path / f"stopped/x.{ending}").read_bytes() == (
            tmp_path / f"whole/x.{ending}"
        ).read_bytes()


@pytest.mark.parametrize("method", ["dop853", "sdirk4"])
def test_a_run_stopped_in_the_step_before_a_contact_goes_on_to_the_same_bytes(tmp_path, monkeypatch, method):
    """The step is made again: as long as it was tried, not as the contact cut it, or the next one differs."""
    chosen = {"integration": {"method": method, "rtol": 1e-7, "atol": 1e-8}}
    monkeypatch.setattr(steps, "LARGEST_BLOCK", 1)
    contact = "CONTACT floor plane-sphere from=0(0,-0.9,0) to=2(0.6,0,0) normal=(0,1,0) radius_to=0.05"
    text = deck(f"ELEMENTS\n  {contact} stiffness=1e5 damping=0.3")
    old = "    5\n       0.1\n"
    assert old in text
    text = text.replace(old, "   60\n      0.01\n")
    path = tmp_path / "x.DAT"
    path.write_text(text)
    run(path, tmp_path / "whole", **chosen)
    with h5py.File(tmp_path / "whole/x.h5") as file:
        touch = np.unique(file["contact/changed"][:])[1]
    first = run(path, tmp_path / "stopped", stop_after(math.floor(touch / 0.01) + 1), **chosen)
    assert (first.exit_code, first.resumable) == (130, True)
    assert run(path, tmp_path / "stopped", resume=True, **chosen).exit_code == 0
    for ending in ENDINGS:
        assert (tmp_path / f"stopped/x.{ending}").read_bytes() == (
            tmp_path / f"whole/x.{ending}"
        ).read_bytes()


LOOP = "    3    0    0    0    0    1    1\n       0.0        .5"


@pytest.mark.parametrize("formulation", ["kane", "absolute"])
def test_a_planar_loop_tells_its_redundancy_once_in_a_note(tmp_path, formulation):
    """The direction across the plane is closed by the hinges already; a loop given twice is no such case."""
    spatial = altered(
        tmp_path,
        "fourbar_rigid",
        ("  200\n", "    2\n"),
        (LOOP, LOOP.replace("    0    1    1", "    1    1    1")),
    )
    (told,) = run(spatial, tmp_path, formulation=formulation).faults
    assert told.severity == "note"
    assert told.message.startswith("planar tree: 1 of ")
    assert "\n" not in told.message
    given = f"{LOOP}       0.0       0.0       0.0        .6\n"
    twice = altered(
        tmp_path, "fourbar_rigid", ("  200\n", "    2\n"), (f"    1\n{given}", f"    2\n{given}{given}")
    )
    (told,) = run(twice, tmp_path, formulation=formulation).faults
    assert told.severity == "warning"
    assert "closure" in told.message
