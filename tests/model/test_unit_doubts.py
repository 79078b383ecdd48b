"""Decks that are not in SI units, and bodies without mass, are noticed; supplied decks are not.

Expected: a link of 0.5 m and 2 kg with the inertia m L²/12 of a thin rod has a radius of gyration of
L/√12 = 0.144 m; the same in kg and mm, or with the inertia alone in kg mm², is what the notes are for.
"""

from pathlib import Path

import pytest

from flexmb_cli.model.dynamics import DynamicModel, MassProperties
from flexmb_cli.model.mechanism import Body, Joint, Mechanism, TimeGrid
from flexmb_cli.model.unit_doubts import unit_doubts
from flexmb_cli.run.check import check_deck
from flexmb_cli.run.outcome import RunOptions

DECKS = Path(__file__).resolve().parents[2] / "decks"
UNTURNED = (1.0, 0.0, 0.0, 0.0)


def rod(length=0.5, mass=2.0, inertia=2.0 * 0.5**2 / 12, gravity=9.81):
    joint = Joint("spherical", "joint", 0, 0, (-length / 2, 0.0, 0.0), (length / 2, 0.0, 0.0))
    mechanism = Mechanism(
        bodies=(Body("body 1", (0.0, 0.0, 0.0), UNTURNED),), joints=(joint,), time=TimeGrid(0.0, 1.0, 0.1)
    )
    masses = (MassProperties("mass 1", 0, mass, (0.0, 0.0, 0.0), (0.0, inertia, inertia, 0.0, 0.0, 0.0)),)
    return DynamicModel(mechanism, masses=masses if mass or inertia else (), gravity=(0.0, 0.0, -gravity))


def test_a_rod_in_si_units_raises_no_doubt():
    assert unit_doubts(rod()) == []


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
    (note,) = unit_doubts(model)
    assert note.severity == "note" and words in note.message


@pytest.mark.parametrize(
    "path",
    [*sorted(DECKS.glob("young/dynamics/*.dat")), *sorted(DECKS.glob("dafms/*.DAT"))],
    ids=lambda path: path.stem,
)
def test_supplied_decks_are_in_si_units(path):
    report = check_deck(str(path), RunOptions())
    assert [f.message for f in report.outcome.faults if f.severity == "note" and "SI" in f.message] == []
