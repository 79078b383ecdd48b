"""Overconstrained loops whose axes are off, or rounded to print: refused with what is left, or moved with it.

Expected: a four-bar in the plane, whose loop closes by the law of cosines, and the constancy of its energy; a
bar's end that stays off the plane by what the deck types.
"""

import math
from pathlib import Path

import h5py
import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from flexmb_cli import interface
from flexmb_cli.deck.text import decode
from flexmb_cli.dialects.recognise import read_deck
from flexmb_cli.errors import AnalysisError
from flexmb_cli.run.mechanism_modes import Wish
from flexmb_cli.run.model import typed_precision
from flexmb_cli.run.modes import modes_of_deck
from flexmb_cli.run.outcome import Listener, RunOptions
from flexmb_cli.run.verify.verify import verify_deck
from tests.solvers.tree.test_tree_loops import FourBar
from tests.solvers.tree.tree_runs import deck_tree
from tests.study.studies import flexmb

DECKS = Path(__file__).parents[3] / "decks"
BAR = Path(__file__).parents[2] / "fe/formats/bar"
CRANK, COUPLER, ROCKER, GROUND, ANGLE = 0.4, 0.9, 0.7, 1.0, 1.0


def four_bar(tilt, digits=17, method=""):
    """A four-bar of revolutes about z; the last axis is tilted on the ground."""
    B = CRANK * np.array([math.cos(ANGLE), math.sin(ANGLE)])
    way = np.array([GROUND, 0.0]) - B
    L = float(np.hypot(*way))
    angle = math.atan2(way[1], way[0]) + math.acos((COUPLER**2 + L**2 - ROCKER**2) / (2 * COUPLER * L))
    C = B + COUPLER * np.array([math.cos(angle), math.sin(angle)])
    poses = [(0, 0, ANGLE), (*B, angle), (GROUND, 0, math.atan2(C[1], C[0] - GROUND))]
    bodies = [[x, y, 0, math.cos(0.5 * a), 0, 0, math.sin(0.5 * a)] for x, y, a in poses]
    lines = [" ".join(repr(round(float(x), digits)) for x in body) for body in bodies]
    masses = "".join(f"MASS {k} 1 0.2 0 0 .01 .02 .02\n" for k in (2, 3, 4))
    return "\n".join(
        [
            "4 0 0 0 0 4 0 0 0 0 0 1",
            "0 0 0 1 0 0 0",
            *lines,
            "1 2 0 0 0 0 0 0 0 0 1 0 0 1",
            f"2 3 {CRANK} 0 0 0 0 0 {CRANK} 0 1 0 0 1",
            f"3 4 {COUPLER} 0 0 {ROCKER} 0 0 {COUPLER} 0 1 {ROCKER} 0 1",
            f"1 4 {GROUND} 0 0 0 0 0 {GROUND} {tilt} 1 0 0 1",
            "1 0 0 0 0 0 0",
            "0 1 0.05",
            "DYNAMICS forward",
            f"{masses}GRAVITY 0 -9.81 0",
            f"{method}\nEND\n",
        ]
    )


@pytest.fixture
def solve(tmp_path):
    def solved(text, name="x.dat", **options):
        path = tmp_path / name
        path.write_text(text)
        return interface.solve(path, **options)

    return solved


def loop_gap(position):
    """How far coupler's and rocker's lengths are off between their pins, from the origins of the bodies."""
    B, D = position[:, 2, :2], position[:, 3, :2]
    crank = np.hypot(*B.T) - CRANK
    return max(np.max(np.abs(crank)), np.max(np.abs(D - [GROUND, 0.0])))


@pytest.mark.parametrize(
    ("tilt", "digits", "options"),
    [
        ("1e-8", 17, {"loop_tolerance": 1e-7}),
        ("1e-6", 7, {}),
        ("1e-6", 17, {"loop_tolerance": 1e-5}),
        ("1e-4", 17, {"loop_tolerance": 1e-3}),
        ("1e-2", 17, {"loop_tolerance": 0.02}),
    ],
)
def test_a_loop_within_the_tolerance_moves_and_keeps_its_gap(solve, tilt, digits, options):
    """The gaps of the four hinges add up to the tilt, so that the largest is a quarter of it or more.

    They lead out of the plane, so that lengths and heights within it change at second order only: by less
    than 25 tilt², a turn of five tilts for chosen equations whose least singular value is a fifth.
    """
    found = solve(four_bar(tilt, digits), **options)
    residual, total = (np.array(found[name]) for name in ("audit/constraint_residual", "energy/total"))
    second_order = 25.0 * float(tilt) ** 2
    assert 0.25 * float(tilt) <= residual.max() < 2.0 * float(tilt)
    assert np.ptp(total) < 1e-6 + 3.0 * 9.81 * second_order
    assert loop_gap(np.array(found["body/position"])) < 1e-9 + second_order
    notes = [fault.message for fault in found.warnings if fault.id == "SOLVE-080"]
    assert len(notes) == 1
    assert "overconstrained and closes only to" in notes[0]
    assert np.ptp(np.array(found["body/position"])[:, 2, 0]) > 0.1, "it moves"


@pytest.mark.parametrize("tilt", ["1e-8", "1e-6", "1e-4", "1e-3", "1e-2"])
def test_a_loop_beyond_the_tolerance_is_refused_with_what_is_left(solve, tilt):
    with pytest.raises(AnalysisError, match=r"overconstrained and closes only to .* rad") as failure:
        solve(four_bar(tilt))
    assert 0.05 * float(tilt) < failure.value.norms["gap"] < float(tilt)
    assert "--loop-tolerance" in str(failure.value)


def test_the_digits_typed_are_those_of_the_coarsest_number_that_looks_rounded():
    """Half a unit of the sixth digit is 5e-7; the roundings of a loop add up to ten times as much."""
    for typed, precision in (
        ("0.707107", 5e-6),
        ("-.70710678", 5e-8),
        ("1.50000000000", 5e-12),
        ("0.5", 5e-8),
    ):
        text = f"{{ {typed} 0.25 1.5 }}\n{four_bar(0, 1)}".replace("0.01", "1")
        assert typed_precision(read_deck(decode("x.dat", text.encode()))) == pytest.approx(precision)


def beside_the_plane():
    """A four-bar as a tree whose cut joint is closed across its plane, too, a millimetre beside it."""
    text = (DECKS / "dafms/fourbar_rigid.DAT").read_text()
    plane = "    3    0    0    0    0    1    1\n       0.0        .5       0.0       0.0"
    assert plane in text
    return text.replace(
        plane, "    3    0    0    0    1    1    1\n       0.0        .5       0.0      .001"
    )


def test_a_loop_of_a_tree_keeps_the_gap_across_its_plane(solve):
    with pytest.raises(AnalysisError, match=r"overconstrained and closes only to 1\.0e-03 m"):
        solve(beside_the_plane(), "x.DAT")
    found = solve(beside_the_plane(), "x.DAT", loop_tolerance=0.01)
    assert np.array(found["audit/constraint_residual"]) == pytest.approx(np.full(201, 1e-3), rel=1e-6)


def test_a_loop_of_a_tree_keeps_its_energy_in_absolute_coordinates(solve):
    """Other equations are chosen on the way, each time with a step of a part of the gap of a millimetre.

    To fall by it changes the energy of 1.2 kg by 12 mJ.
    """
    found = solve(beside_the_plane(), "x.DAT", loop_tolerance=0.01, formulation="absolute", rtol=1e-11)
    assert np.ptp(np.array(found["energy/total"])) < 2e-3
    assert sum(fault.id == "SOLVE-080" for fault in found.warnings) == 1


VSDF = """VSDF FOUR-BAR
BODY
    1,RIGD
    2,RIGD
    3,RIGD
RIGI
    1,1.0,0.2,0.0,0.0
    0.01,0.02,0.02
    2,1.0,0.2,0.0,0.0
    0.01,0.02,0.02
    3,1.0,0.2,0.0,0.0
    0.01,0.02,0.02
POSI
{positions}EULP
{parameters}NODE
    0,1,0,0,0
    0,2,0,0,0.5
    0,3,1.0,0,0
    0,4,1.0,{tilt},0.5
    1,1,0,0,0
    1,2,0,0,0.5
    1,3,0.4,0,0
    1,4,0.4,0,0.5
    2,1,0,0,0
    2,2,0,0,0.5
    2,3,0.9,0,0
    2,4,0.9,0,0.5
    3,1,0,0,0
    3,2,0,0,0.5
    3,3,0.7,0,0
    3,4,0.7,0,0.5
JOIN
    1,REVO,0,1,2,1,1,2
    2,REVO,1,3,4,2,1,2
    3,REVO,2,3,4,3,3,4
    4,REVO,0,3,4,3,1,2
GRAV
    0,-9.81,0
TIME
    1.0,0.05
INTG
    RK45,1e-10
END
STAR
STOP
"""


def vsdf_four_bar(tilt):
    """The same four-bar between nodes."""
    poses = [line.split() for line in four_bar(tilt).splitlines()[2:5]]
    rows = [",".join([str(k), *pose]) for k, pose in enumerate(poses, 1)]
    positions = "".join("    " + ",".join(row.split(",")[:4]) + "\n" for row in rows)
    parameters = "".join(f"    {k},{','.join(pose[3:])}\n" for k, pose in enumerate(poses, 1))
    return VSDF.format(positions=positions, parameters=parameters, tilt=0.5 * float(tilt))


def test_a_loop_of_a_vsdf_deck_moves_and_keeps_its_gap(solve):
    with pytest.raises(AnalysisError, match="overconstrained and closes only to"):
        solve(vsdf_four_bar("1e-4"), "x.vsdf")
    found = solve(vsdf_four_bar("1e-4"), "x.vsdf", loop_tolerance=1e-3)
    position = np.array(found["body/position"])
    assert np.ptp(position[:, 1, 0]) > 0.1, "it moves"
    assert np.ptp(np.array(found["energy/total"])) < 1e-5
    crank = np.hypot(*position[:, 1, :2].T) - CRANK
    assert max(np.abs(crank).max(), np.abs(position[:, 2, :2] - [GROUND, 0.0]).max()) < 1e-6


def inertia_and_potential(a):
    """M of T = M (da/dt)²/2, and V: bars of 1 kg, their centres 0.2 m along, 0.02 kg m² about these."""

    def centres(a):
        B = CRANK * np.exp(1j * a)
        way = GROUND - B
        c = np.angle(way) + np.arccos((COUPLER**2 + abs(way) ** 2 - ROCKER**2) / (2 * COUPLER * abs(way)))
        r = np.angle(B + COUPLER * np.exp(1j * c) - GROUND)
        return np.array([0.0, B, GROUND]) + 0.2 * np.exp(1j * np.array([a, c, r])), np.array([a, c, r])

    (one, angles), (other, before), h = centres(a + 1e-5), centres(a - 1e-5), 2e-5
    turned = np.angle(np.exp(1j * (angles - before))) / h
    M = np.sum(np.abs((one - other) / h) ** 2) + 0.02 * np.sum(turned**2)
    return M, 9.81 * centres(a)[0].imag.sum()


def frequency(energies, near):
    """Hz, of small oscillations about the angle with the least potential."""
    h, bounds = 1e-3, (near - 1.0, near + 1.0)
    found = minimize_scalar(
        lambda a: energies(a)[1], bounds=bounds, method="bounded", options={"xatol": 1e-9}
    )
    M, V = energies(found.x)
    stiffness = (energies(found.x + h)[1] - 2 * V + energies(found.x - h)[1]) / h**2
    return math.sqrt(stiffness / M) / (2 * math.pi)


@pytest.mark.parametrize(
    ("name", "text", "energies", "near"),
    [
        pytest.param("x.dat", four_bar("1e-4"), inertia_and_potential, -1.7, marks=pytest.mark.campaign),
        pytest.param(
            "x.vsdf", vsdf_four_bar("1e-4"), inertia_and_potential, -1.7, marks=pytest.mark.campaign
        ),
        ("x.DAT", beside_the_plane(), FourBar(deck_tree("fourbar_rigid", 1e-9)).inertia_and_potential, 0.1),
    ],
    ids=["young", "vsdf", "dafms"],
)
def test_modes_of_a_loop_that_nearly_closes_are_those_of_the_plane(tmp_path, name, text, energies, near):
    """Equations are left out by the gap found: by the tolerance, those that move the bodies were, too."""
    path = tmp_path / name
    path.write_text(text)
    options = RunOptions(loop_tolerance=0.02)
    report = modes_of_deck(str(path), Wish(equilibrium=True), options, Listener())
    assert report.outcome.exit_code == 0, report.outcome.faults
    assert {fault.id for fault in report.outcome.faults} & {"SOLVE-080", "SOLVE-082"}
    assert report.mechanism.modes.frequency == pytest.approx([frequency(energies, near)], rel=1e-4)


def beside_a_bar():
    """The four-bar between nodes, and a free bar of finite elements, of which verify takes two frames."""
    text = vsdf_four_bar("1e-4").replace("    3,RIGD\n", "    3,RIGD\n    4,FLEX,0,1,13,3\n")
    files = (("FEMN", "TXT ", "nodes.txt"), ("FEMM", "MM  ", "M.mtx"), ("FEMK", "MM  ", "K.mtx"))
    cards = "".join(f"{word}\n    4 {form} {BAR / name}\n" for word, form, name in files)
    return text.replace("RIGI\n", f"{cards}RIGI\n", 1).replace("1.0,0.05", "0.01,0.005")


@pytest.mark.parametrize(
    ("name", "text"),
    [("x.dat", four_bar("1e-4")), ("x.vsdf", beside_a_bar()), ("x.DAT", beside_the_plane())],
    ids=["young", "vsdf", "dafms"],
)
def test_verify_refuses_a_loop_that_nearly_closes(tmp_path, name, text):
    path = tmp_path / name
    path.write_text(text)
    outcome = verify_deck(str(path), RunOptions(loop_tolerance=0.01), 1e-6).outcome
    assert outcome.exit_code
    assert "motions cannot be compared" in outcome.faults[-1].message


@pytest.mark.processes
def test_a_sweep_takes_the_tolerance_of_loops(tmp_path):
    """Cases whose axis is off by 1e-4, which fail without it, move with it."""
    (tmp_path / "x.dat").write_text(four_bar("1e-4").replace("0 1 0.05", "0 0.1 0.05"))
    study = tmp_path / "study.toml"
    study.write_text(
        'deck = "x.dat"\n[parameters]\n"gravity.1.g.y" = [-9.81, -5.0]\n[results]\ntop = "max body.3.x"\n'
    )
    flexmb("sweep", study, "-q", "-j", "1", "--loop-tolerance", "1e-3", cwd=tmp_path)
    with h5py.File(tmp_path / "study.h5") as file:
        assert file["exit_code"][:].tolist() == [0, 0]
