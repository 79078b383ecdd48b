"""Models written for other programs, proved by running these: MuJoCo and Exudyn are independent of flexmb."""

import re
import subprocess
import sys
from pathlib import Path

import mujoco
import numpy as np
import pytest
from click.testing import CliRunner

from flexmb_cli.cli.convert import convert
from flexmb_cli.cli.diff import diff
from flexmb_cli.deck.text import read_text
from flexmb_cli.dialects.dafms.build import build_dafms
from flexmb_cli.dialects.recognise import read_deck
from flexmb_cli.errors import ModelError
from flexmb_cli.interface import solve
from flexmb_cli.model import laws
from flexmb_cli.model.integrators import Integrator
from flexmb_cli.model.loads import AppliedForce, DynamicModel, InitialVelocity
from flexmb_cli.model.mechanism import Joint, Mechanism, TimeGrid
from flexmb_cli.model.tree import Body, Hinge, Tree
from flexmb_cli.results.hdf5.dynamic import dynamic_values
from flexmb_cli.results.models.exudyn import exudyn_script
from flexmb_cli.results.models.exudyn_joints import independent_equations
from flexmb_cli.results.models.mjcf import mjcf
from flexmb_cli.run.convert import converted, start_of
from flexmb_cli.solvers.tree.analysis import TreeAnalysis
from flexmb_cli.solvers.tree.points import point_motion
from tests.dialects.dafms.test_dafms_elements import deck
from tests.naive.random_trees import sprung
from tests.solvers.constrained.dynamic_runs import AT_REST, GROUND, body, run, uneven_masses

DECKS = Path(__file__).resolve().parents[2] / "decks"
INERTIA = np.array([[0.9, 0.02, -0.03], [0.02, 1.0, 0.04], [-0.03, 0.04, 1.1]])
TURNED = (0.8, 0.36, -0.48, 0.0)


def positions_of_tree(tree):
    """Times and origins of the bodies (rows, bodies, 3) by flexmb."""
    from flexmb_cli.results.hdf5.tree import tree_values

    blocks = [tree_values(tree, rows, point_motion(tree, rows)) for rows in TreeAnalysis(tree).rows()]
    return [np.concatenate([block[name] for block in blocks]) for name in ("time", "body/position")]


def positions_by_mujoco(text, times):
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    rows = []
    for time in times:
        while data.time < time - 1e-9:
            mujoco.mj_step(model, data)
        mujoco.mj_forward(model, data)
        rows.append(data.xpos[1:].copy())
    return np.array(rows)


def every_hinge():
    """A chain with a ball, a slide with a spring, a weld, two successive rotations, and a branch."""
    heavy = [Body(f"body {k + 1}", 1.0 + k, INERTIA * (1 + k), (0.1, -0.05 * k, 0.2)) for k in range(5)]
    hinges = (
        Hinge(-1, (0.0, 0.0, 1.0), frame=TURNED, attitude=(0.6, 0.0, 0.8, 0.0), rotations=(1, 2, 3)),
        Hinge(0, (0.3, 0.1, 0.5), frame=TURNED, rotations=(2,), translations=(3,)),
        Hinge(1, (0.1, 0.4, 0.2), frame=TURNED, attitude=(0.8, 0.0, 0.0, 0.6)),
        Hinge(2, (0.2, 0.1, 0.3), rotations=(1, 3)),
        Hinge(0, (-0.2, 0.3, 0.1), attitude=(0.6, 0.8, 0.0, 0.0), translations=(1,)),
    )
    springs = sprung(
        (1, "translation", 3, 40.0, 1.5, 0.1), (3, "rotation", 1, 5.0, 0.3, 0.2),
        (4, "translation", 1, 30.0, 0.5, -0.1),
    )  # fmt: skip
    y = np.array([0.5, -0.4, 0.8, 0.6, -0.7, 0.3, 0.2, -0.1])
    q = np.array([0.0, 0.0, 0.0, 0.2, 0.3, -0.4, 0.1, 0.05])
    time = TimeGrid(0.0, 0.5, 0.1)
    return Tree(tuple(heavy), hinges, q, y, time, (0.5, -9.0, 2.0), elements=springs)


def test_a_tree_with_every_hinge_moves_alike_in_mujoco():
    """Two programs, minimal coordinates in both, but other equations: RNE and CRB against Kane's."""
    tree = every_hinge()
    times, wanted = positions_of_tree(tree)
    found = positions_by_mujoco(mjcf(tree, "chain"), times)
    assert np.abs(wanted - wanted[0]).max() > 0.1
    assert np.abs(found - wanted).max() < 1e-9


def test_a_supplied_deck_of_1992_moves_alike_in_mujoco(tmp_path):
    done = CliRunner().invoke(
        convert, [str(DECKS / "dafms/spatial_rigid.DAT"), "--to", "mjcf", "-o", str(tmp_path / "m.xml")]
    )
    assert done.exit_code == 0, done.output
    tree = build_dafms(read_deck(read_text(str(DECKS / "dafms/spatial_rigid.DAT"))))[0]
    times, wanted = positions_of_tree(tree)
    early = times <= 0.5
    found = positions_by_mujoco((tmp_path / "m.xml").read_text(), times[early])
    assert np.abs(found - wanted[early]).max() < 1e-10


def spatial_chain():
    """Ground, revolute, spherical, cylindrical and translational joint, a spring, a force, initial speeds."""
    bodies = (GROUND, body(2, (0.5, 0.0, 0.0)), body(3, (1.5, 0.0, 0.0)), body(4, (2.5, 0.0, 0.0)))
    bodies += (body(5, (0.0, 2.0, 0.0)),)
    x, y = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)
    joints = (
        Joint("revolute", "r", 0, 1, (0, 0, 0), (-0.5, 0, 0), (0, 0.6, 0.8), (0, 0.6, 0.8)),
        Joint("spherical", "s", 1, 2, (0.5, 0, 0), (-0.5, 0, 0)),
        Joint("cylindrical", "c", 2, 3, (0.5, 0, 0), (-0.5, 0, 0), (0, 0, 1.0), (0, 0, 1.0)),
        Joint("translational", "t", 0, 4, (0, 2.0, 0), (0, 0, 0), x, x, y, y),
    )  # fmt: skip
    mechanism = Mechanism(bodies, TimeGrid(0.0, 0.2, 0.05), joints, grounds=(AT_REST,))
    masses = tuple(mass for mass in uneven_masses(5) if mass.body)
    springs = (laws.spring("k", laws.Line(4, 2, (0.1, 0, 0), (0, 0.2, 0)), 60.0, 1.0, 2.0),)
    forces = (
        AppliedForce("f", 3, (3.0, -2.0, 1.0), (0.1, 0.2, 0.3)),
        AppliedForce("g", 2, (1.0, 2.0, 0.5), (0.2, 0.0, 0.1), following=True),
    )
    speeds = (InitialVelocity("v", 4, (0.7, 0.0, 0.0), (0.0, 0.0, 0.0)),)
    integrator = Integrator(tolerance=1e-11)
    return DynamicModel(
        mechanism, "forward", masses, forces, (), springs, (0.0, -9.81, 1.0), speeds, integrator
    )


@pytest.mark.processes
def test_a_mechanism_moves_alike_in_exudyn(tmp_path):
    """Absolute coordinates in both, but other equations and integrators: index 2, trapezoidal rule."""
    model = spatial_chain()
    rows = run(model)
    (tmp_path / "m.py").write_text(exudyn_script(model, start_of(model), "chain"), encoding="utf-8")
    done = subprocess.run([sys.executable, "m.py"], cwd=tmp_path, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    found = np.loadtxt(tmp_path / "chain-exudyn.csv", delimiter=",", skiprows=1)
    r = dynamic_values(model, rows)["body/position"]
    for k, mass in enumerate(model.masses):
        np.testing.assert_allclose(found[:, 1 + 3 * k : 4 + 3 * k], r[:, mass.body], atol=1e-6)


# A spherical, a revolute and a translational joint with springs, stops and a cable; estimates are off.
SPRUNG = """\
4 0 0 1 0 1 0 1 0 0 0 1
0 0 0 1 0 0 0
0.31 0.02 0.01 0.99 0.05 0.02 0.1
0.81 0.02 0.02 1 0.01 0 0
1.32 0.1 0.15 0.98 0.1 0.1 0
3 4 0.2 0 0.03 -0.2 0.01 0
1 2 0 0 0 -0.3 0 0 0 0 1 -0.3 0 1
2 3 0.2 0 0 -0.2 0 0 1.2 0 0 0.8 0 0 0.2 0 1 -0.2 1 0
1 0 0 0 0 0 0
0 0.3 0.05

DYNAMICS forward
MASS 2 2 0.05 0.01 0.02 0.3 0.4 0.5 0.02 0.03 -0.04
MASS 3 1.5 0.03 0 0.01 0.2 0.3 0.25 0.01 0 0.02
MASS 4 1.2 0.1 0.02 0 0.22 0.27 0.3
GRAVITY 0.5 -9.81 -1.3
ELEMENTS
  SPRING tspring-1 at=2.angle stiffness=20 rest=0.2 damping=0.5 preload=1.5
  SPRING aspring-1 at=3.stroke stiffness=300 rest=0.02 damping=4 preload=2
  STOP tstop-1 at=2.angle lower=-0.3 upper=0.1 stiffness=60 damping=0.2
  STOP astop-1 at=3.stroke lower=-0.005 upper=0.005 stiffness=400 damping=0.1
  SPRING lspring-1 from=0(0.5,1.5,0) to=4(0.2,0,0.1) stiffness=60 rest=1.2 damping=0.7 preload=5
  CABLE cable-1 from=0(0.5,-1.2,0) to=3(0.1,0.1,0) stiffness=300 rest=1.25 damping=0.2
SPRING 0 2 0.2 1 0 0.1 0 0 20 0.5 0.1
ELEMENTS
  START at=2.angle rate=0.8
TOLERANCE 1e-12
END
"""


# Two free bodies hang from the ground, one below the other, on links with two spheres.
LINKED = f"""\
3 0 0 0 0 0 0 0 0 0 0 1
0 0 0 1 0 0 0
0 0 0 1 0 0 0
1 0 0 1 0 0 0
1 0 0 0 0 0 0
0 0.3 0.1

DYNAMICS forward
MASS 2 2 0.05 0.01 0.02 0.3 0.4 0.5 0.02 0.03 -0.04
MASS 3 1.5 0.03 0 0.01 0.2 0.3 0.25 0.01 0 0.02
GRAVITY 0.3 -9.81 0.2
ELEMENTS
  JOINT sphsph-1 sphsph from=0(0,1,0) to=2(0.3,0.1,0) length={0.9**0.5!r}
  JOINT sphsph-2 sphsph from=2(0.3,0.1,0) to=3(-0.2,0,0.1) length={0.27**0.5!r}
TOLERANCE 1e-12
END
"""


@pytest.mark.processes
def test_links_with_two_spheres_hold_alike_in_exudyn(tmp_path):
    """Without either link the bodies would be elsewhere: weights alone move them by 0.44 m."""
    values = moved_as_in_exudyn(tmp_path, LINKED)
    fallen = values["body/position"][-1, 1:, 1]
    assert np.abs(fallen + 9.81 * 0.3**2 / 2).min() > 0.05


# A pendulum about z, and a link from its axis to the ground, which repeats an equation of the revolute.
REPEATED = """\
2 0 0 0 0 1 0 0 0 0 0 1
0 0 0 1 0 0 0
0.4 0 0 1 0 0 0
1 2 0 0 0 -0.4 0 0 0 0 1 -0.4 0 1
1 0 0 0 0 0 0
0 0.3 0.1

DYNAMICS forward
MASS 2 1.5 0.1 0.02 0 0.2 0.3 0.25
GRAVITY 0.3 -9.81 0.2
ELEMENTS
  JOINT sphsph-1 sphsph from=0(0,0,0.7) to=2(-0.4,0,-0.2) length=0.9
TOLERANCE 1e-12
END
"""


@pytest.mark.processes
def test_a_link_that_repeats_an_equation_is_left_out_in_exudyn(tmp_path):
    """With it Exudyn's Jacobian is singular."""
    assert np.ptp(moved_as_in_exudyn(tmp_path, REPEATED)["body/position"][:, 1, 1]) > 0.1
    assert " repeats equations of others" in (tmp_path / "m.py").read_text()


@pytest.mark.processes
@pytest.mark.long_motion
def test_springs_stops_and_a_cable_act_alike_in_exudyn(tmp_path):
    values = moved_as_in_exudyn(tmp_path, SPRUNG)
    assert np.abs(values["element/effort"][:]).max(axis=0).min() > 1  # all of them act


def moved_as_in_exudyn(tmp_path, deck):
    """Results of a deck whose bodies move within 1e-6 m as its script moves them.

    The script halves its steps as long as that changes more than is compared.
    """
    (tmp_path / "IN-S.dat").write_text(deck)
    script = converted(str(tmp_path / "IN-S.dat"), "exudyn")
    (tmp_path / "m.py").write_text(
        script.replace("TOLERANCE, MOST_STEPS = 1e-07", "TOLERANCE, MOST_STEPS = 1e-06")
    )
    done = subprocess.run([sys.executable, "m.py"], cwd=tmp_path, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    found = np.loadtxt(tmp_path / "IN-S-exudyn.csv", delimiter=",", skiprows=1)
    values = solve(tmp_path / "IN-S.dat")
    moving = values["body/position"][:, 1:].reshape(len(found), -1)
    np.testing.assert_allclose(found[:, 1:], moving, atol=1e-6)
    return values


@pytest.mark.parametrize(
    ("deck", "form", "reported"),
    [
        ("dafms/pendulum.DAT", "mjcf", "body 1: the body is flexible; --to mjcf is for rigid trees"),
        ("dafms/fourbar_rigid.DAT", "mjcf", "body 1: MuJoCo needs a positive mass and inertia"),
        ("young/IN4-BAR.dat", "mjcf", "the deck describes kinematics only, and other dialects need masses"),
        ("young/dynamics/IN-BRICARD.dat", "mjcf", "revolute joint 6: the joint closes a loop"),
        ("young/IN4-BAR.dat", "exudyn", "rigid mechanisms under forces: decks with DYNAMICS forward"),
        ("vsdf/pendulum.vsdf", "exudyn", "body 1: the body is flexible"),
        ("vsdf/pendulum.vsdf", "mjcf", "body 1: the body is flexible"),
    ],
)
def test_what_the_other_program_cannot_hold_is_refused_and_leaves_no_file(deck, form, reported, tmp_path):
    output = tmp_path / "m"
    done = CliRunner().invoke(convert, [str(DECKS / deck), "--to", form, "-o", str(output)])
    assert done.exception.exit_code == 2
    assert reported in " ".join(fault.sentence for fault in done.exception.faults)
    assert done.exception.file == str(DECKS / deck)
    assert not output.exists()


def test_an_open_chain_of_another_dialect_moves_alike_in_mujoco(tmp_path):
    """It goes by way of a tree with ten columns a number: the file states the rounding, 1e-7 at most."""
    deck = DECKS / "dafms/spatial_rigid.DAT"
    (tmp_path / "a.vsdf").write_text(converted(str(deck), "vsdf"))
    text = converted(str(tmp_path / "a.vsdf"), "mjcf")
    assert "Numbers are rounded to their columns" in text
    times, wanted = positions_of_tree(build_dafms(read_deck(read_text(str(deck))))[0])
    early = times <= 0.5
    assert np.ptp(wanted[early], axis=0).max() > 0.1
    assert np.abs(positions_by_mujoco(text, times[early]) - wanted[early]).max() < 1e-6


def test_a_fault_of_a_deck_on_the_way_has_no_line_of_the_users_deck(tmp_path):
    (tmp_path / "arm.DAT").write_text(deck("ELEMENTS\n  COUPLING gear 1.r3=2 2.r3=3"))
    with pytest.raises(ModelError, match="this is in the deck that --to young writes") as refused:
        converted(str(tmp_path / "arm.DAT"), "exudyn")
    assert [fault.place for fault in refused.value.faults] == [None] * len(refused.value.faults)


def test_an_inverse_run_is_refused_for_its_drivers_and_sent_nowhere(tmp_path):
    """The refusal told in 600 letters what another dialect met: a motion that nothing determines."""
    text = (DECKS / "young/dynamics/IN-BRICARD.dat").read_text()
    (tmp_path / "a.dat").write_text(text.replace("DYNAMICS forward", "DYNAMICS inverse"))
    refused = CliRunner().invoke(convert, [str(tmp_path / "a.dat"), "--to", "exudyn"]).exception
    (fault,) = refused.faults
    assert fault.sentence == (
        "--to exudyn takes rigid mechanisms under forces: decks with DYNAMICS forward; "
        "drivers move an inverse run, and they do not convert"
    )


def test_an_element_at_a_joint_is_refused_where_it_stands(tmp_path):
    text = (DECKS / "young/dynamics/IN-BRICARD.dat").read_text()
    deck = tmp_path / "sprung.dat"
    deck.write_text(
        re.sub(
            r"\nEND\b",
            "\n"
            "ELEMENTS\n"
            "  FRICTION friction-1 joint=1 dynamic=0.1 static=0.1 stribeck=1 creep=0.01 "
            "radius=0.1\n"
            "END",
            text,
        )
    )
    done = CliRunner().invoke(convert, [str(deck), "--to", "exudyn", "-o", str(tmp_path / "m.py")])
    (fault,) = done.exception.faults
    assert (fault.subject, fault.place.line) == ("friction-1", text[: text.index("\nEND")].count("\n") + 3)


@pytest.mark.processes
def test_a_supplied_mechanism_with_repeated_equations_moves_alike_in_exudyn(tmp_path):
    """Nine of the squeezer's equations repeat others; the first third of its motion."""
    deck = tmp_path / "m.dat"
    text = (DECKS / "young/dynamics/IN-ANDREWS.dat").read_text()
    deck.write_text(text.replace("\n0 0.03 0.0005\n", "\n0 0.01 0.0005\n"))
    assert deck.read_text() != text
    done = CliRunner().invoke(convert, [str(deck), "--to", "exudyn", "-o", str(tmp_path / "m.py")])
    assert done.exit_code == 0, done.output
    call = [sys.executable, "-W", "error::DeprecationWarning", "m.py"]
    done = subprocess.run(call, cwd=tmp_path, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    table, result = tmp_path / "m-exudyn.csv", tmp_path / "m.h5"
    assert np.ptp(np.loadtxt(table, delimiter=",", skiprows=1)[:, 1:], axis=0).max() > 0.01
    solve(deck).save(result)
    done = CliRunner().invoke(diff, [str(table), str(result), "--atol", "2e-8"])
    assert "no difference" in done.output, done.output


def test_a_start_in_a_singular_position_costs_exudyn_no_equation():
    """A parallelogram flat on its line has one more repeated equation there than anywhere else."""
    z = ((0.0, 0.0, 1.0),) * 2
    joints = (
        Joint("revolute", "a", 0, 1, (0, 0, 0), (0, 0, 0), *z),
        Joint("revolute", "b", 0, 3, (2, 0, 0), (0, 0, 0), *z),
        Joint("revolute", "c", 1, 2, (1, 0, 0), (0, 0, 0), *z),
        Joint("revolute", "d", 2, 3, (2, 0, 0), (1, 0, 0), *z),
    )
    bodies = (GROUND, body(2, (0, 0, 0)), body(3, (1, 0, 0)), body(4, (2, 0, 0)))
    mechanism = Mechanism(bodies, TimeGrid(0.0, 1.0, 0.1), joints, grounds=(AT_REST,))
    flat = {"r": np.array([[0.0, 0, 0], [0, 0, 0], [1, 0, 0], [2, 0, 0]]), "p": np.eye(4)[[0, 0, 0, 0]]}
    turned = np.array([np.cos(0.3), 0.0, 0.0, np.sin(0.3)])
    up = {
        "r": np.array([[0.0, 0, 0], [0, 0, 0], [np.cos(0.6), np.sin(0.6), 0], [2, 0, 0]]),
        "p": np.array([flat["p"][0], turned, flat["p"][0], turned]),
    }
    assert sum(map(sum, independent_equations(mechanism, (), [flat])[0])) == 16
    axes, _ = independent_equations(mechanism, (), [flat, up])
    assert axes == [(1, 1, 1, 1, 1, 0)] * 3 + [(1, 1, 0, 0, 0, 0)]
