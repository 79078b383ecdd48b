"""Decks that are not in SI units, and bodies without mass, are noticed; supplied decks are not.

Expected: a link of 0.5 m and 2 kg with the inertia m L²/12 of a thin rod has a radius of gyration of
L/√12 = 0.144 m; the same in kg and mm, or with the inertia alone in kg mm², is what the notes are for.
"""

import shutil
from pathlib import Path

import h5py
import pytest

from flexmb_cli.model.loads import DynamicModel, MassProperties
from flexmb_cli.model.mechanism import Body, Joint, Mechanism, TimeGrid
from flexmb_cli.model.unit_checks import unit_warnings
from flexmb_cli.run.check.check import check_deck
from flexmb_cli.run.mechanism_modes import Wish
from flexmb_cli.run.modes import modes_of_deck
from flexmb_cli.run.outcome import Listener, RunOptions
from flexmb_cli.run.solution import run_deck
from tests.dialects.vsdf.vsdf_decks import RIGID

DECKS = Path(__file__).resolve().parents[2] / "decks"
UNTURNED = (1.0, 0.0, 0.0, 0.0)


STEEL = 7850.0
BAR = (0.4, 0.05, 0.02)  # m


def rod(length=0.5, mass=2.0, inertia=2.0 * 0.5**2 / 12, gravity=9.81):
    joint = Joint("spherical", "joint", 0, 0, (-length / 2, 0.0, 0.0), (length / 2, 0.0, 0.0))
    mechanism = Mechanism(
        bodies=(Body("body 1", (0.0, 0.0, 0.0), UNTURNED),), joints=(joint,), time=TimeGrid(0.0, 1.0, 0.1)
    )
    masses = (MassProperties("mass 1", 0, mass, (0.0, 0.0, 0.0), (0.0, inertia, inertia, 0.0, 0.0, 0.0)),)
    return DynamicModel(mechanism, masses=masses if mass or inertia else (), gravity=(0.0, 0.0, -gravity))


def test_a_rod_in_si_units_raises_no_warn():
    assert unit_warnings(rod()) == []


@pytest.mark.parametrize(
    "model, words",
    [
        (rod(gravity=9810.0), "gravity 9810 looks like mm/s²"),
        (rod(length=500.0, inertia=2.0 * 500.0**2 / 12), "a joint is 250 m from the mass centre"),
        (rod(inertia=2.0 * 500.0**2 / 12), "make a radius of gyration of 144 m, joints are up to 0.25 m"),
        (rod(length=500.0, gravity=0.0), "make a radius of gyration of 0.144 m, joints are up to 250 m"),
        (rod(mass=0.0, inertia=0.0), "has neither mass nor inertia"),
    ],
    ids=["gravity", "lengths", "inertia", "inertia-of-long", "massless"],
)
def test_what_is_noticed(model, words):
    (note,) = unit_warnings(model)
    assert note.severity == "note" and words in note.message


@pytest.mark.parametrize(
    "path",
    [*sorted(DECKS.glob("young/dynamics/*.dat")), *sorted(DECKS.glob("dafms/*.DAT"))],
    ids=lambda path: path.stem,
)
def test_supplied_decks_are_in_si_units(path):
    report = check_deck(str(path), RunOptions())
    assert [f.message for f in report.outcome.faults if f.severity == "note" and "SI" in f.message] == []


def test_a_thin_rod_with_its_mass_in_tonnes_is_noticed():
    """0.5 m between joints at the ends: radius of gyration √(1000/12) 0.5 m = 4.56 m."""
    (note,) = unit_warnings(rod(mass=0.002))
    assert "make a radius of gyration of 4.56 m, joints are up to 0.25 m" in note.message


@pytest.mark.parametrize("thickness", [0.0, 0.01])
def test_a_flywheel_with_a_joint_beside_its_centre_raises_no_warn(thickness):
    """50 kg, 0.5 m: radius of gyration 0.354 m, the joint 0.01 m from the centre."""
    m, r = 50.0, 0.5
    across = m * (3.0 * r * r + thickness**2) / 12.0
    joint = Joint("revolute", "joint", 0, 0, (0.01, 0.0, 0.0), (0.01, 0.0, 0.0))
    bodies = (Body("body 1", (0.0, 0.0, 0.0), UNTURNED),)
    mechanism = Mechanism(bodies=bodies, joints=(joint,), time=TimeGrid(0.0, 1.0, 0.1))
    given = MassProperties("mass 1", 0, m, (0.0,) * 3, (across, across, m * r * r / 2.0, 0.0, 0.0, 0.0))
    assert unit_warnings(DynamicModel(mechanism, masses=(given,), gravity=(0.0, 0.0, -9.81))) == []


def bar(density, tonnes):
    """Return a homogeneous steel bar with all its moments, kg m²; the mass in kg or in tonnes."""
    a, b, c = BAR
    m = density * a * b * c
    moments = (m * (b * b + c * c) / 12, m * (a * a + c * c) / 12, m * (a * a + b * b) / 12)
    joint = Joint("spherical", "joint", 0, 0, (-a / 2, 0.0, 0.0), (a / 2, 0.0, 0.0))
    bodies = (Body("body 1", (0.0, 0.0, 0.0), UNTURNED),)
    mechanism = Mechanism(bodies=bodies, joints=(joint,), time=TimeGrid(0.0, 1.0, 0.1))
    given = MassProperties("mass 1", 0, m / 1000 if tonnes else m, (0.0,) * 3, (*moments, 0.0, 0.0, 0.0))
    return DynamicModel(mechanism, masses=(given,), gravity=(0.0, 0.0, -9.81))


@pytest.mark.parametrize("density", [950.0, STEEL, 22600.0])
def test_a_mass_in_tonnes_shows_in_the_density_of_the_body(density):
    """Polyethylene, steel and osmium: with the mass alone in tonnes the body is thinner than any."""
    assert unit_warnings(bar(density, tonnes=False)) == []
    (note,) = unit_warnings(bar(density, tonnes=True))
    assert "is the mass in kg, and not in tonnes?" in note.message or "are all in SI units?" in note.message


def test_finite_elements_with_masses_in_tonnes_are_noticed(tmp_path):
    """The pendulum's 0.26 kg in its box of 1.5e-5 m³ are 17,300 kg/m³, in tonnes 17.3."""
    shutil.copytree(DECKS / "vsdf/fe", tmp_path / "fe")
    deck = tmp_path / "pendulum.vsdf"
    shutil.copy(DECKS / "vsdf/pendulum.vsdf", deck)
    assert not notes_of(modes_of_deck(str(deck), Wish(), RunOptions(), Listener()))
    matrix = tmp_path / "fe/pendulum_M.mtx"
    head, *entries = matrix.read_text().split("\n162 162 1131\n")
    scaled = [f"{i} {j} {float(m) / 1000!r}" for i, j, m in map(str.split, entries[0].splitlines())]
    matrix.write_text("\n".join([head, "162 162 1131", *scaled]) + "\n")
    (note,) = notes_of(modes_of_deck(str(deck), Wish(), RunOptions(), Listener()))
    assert "17 kg/m³, less than foam: masses in tonnes (times 1000) would make 17000 kg/m³" in note


def notes_of(report):
    return [fault.message for fault in report.outcome.faults if fault.severity == "note"]


YOUNG = """1 0 0 0 0 0 0 0 0 0 0 0
0 0 0 1 0 0 0
0 0.2 0.1
DYNAMICS forward
MASS 1 1 0 0 0 1 1 1
GRAVITY 0 0 -9810
"""
NOTE = "gravity 9810 looks like mm/s²; decks are in SI units, m/s²"


def in_millimetres(folder):
    """Yield a deck of every dialect with gravity in mm/s², and what `--set` needs for that."""
    (folder / "IN.dat").write_text(YOUNG)
    (folder / "links.vsdf").write_text(RIGID)
    yield folder / "IN.dat", ()
    yield DECKS / "dafms/pendulum.DAT", ("gravity.g3=9810", "time.IT=2")
    yield folder / "links.vsdf", ("gravity.g.y=-9810", "time.end=0.02")


@pytest.mark.long_motion
def test_runs_tell_of_units_and_keep_it_in_the_notes(tmp_path):
    for k, (deck, changes) in enumerate(in_millimetres(tmp_path)):
        options = RunOptions(changes=changes, folder=str(tmp_path), no_out=True, h5=f"{tmp_path}/{k}.h5")
        outcome = run_deck(str(deck), options)
        assert outcome.exit_code == 0, outcome.faults
        assert [fault.message for fault in outcome.faults if fault.severity == "note"] == [NOTE]
        with h5py.File(tmp_path / f"{k}.h5") as result:
            assert NOTE in result.attrs["notes"]


def test_modes_tell_of_units(tmp_path):
    for deck, changes in in_millimetres(tmp_path):
        report = modes_of_deck(str(deck), Wish(), RunOptions(changes=changes), Listener())
        assert NOTE in notes_of(report)
