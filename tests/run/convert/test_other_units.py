"""Kinematic YOUNG decks in other units of length: the deck's own text, its lengths scaled, all else kept.

Expected numbers: closed forms of the supplied decks, and 1 in = 25.4 mm.
"""

import re
from pathlib import Path

import pytest

from flexmb_cli.errors import ModelError
from flexmb_cli.interface import solve
from flexmb_cli.run.convert import converted

YOUNG = Path(__file__).resolve().parents[3] / "decks/young"


def in_units(deck, *units, changes=()):
    return converted(str(deck), "young", changes, *units)


def numbers(text):
    """The words of a deck without its comments."""
    return [float(word) for word in re.sub(r"\{.*?\}", "", text, flags=re.DOTALL).split()]


def test_a_screw_in_millimetres_advances_by_its_closed_form(tmp_path):
    """IN2-6-1: y = 2 m + 0.5 m/rad · 1.047 rad/s · t, at 3 s 3570.5 mm."""
    deck = tmp_path / "IN-MM.dat"
    deck.write_text(in_units(YOUNG / "IN2-6-1.dat", "m", "mm"), encoding="utf-8")
    values = solve(str(deck))
    assert values["body/position"][-1, 1, 1] == pytest.approx(2000 + 523.5 * 3, abs=1e-9)
    assert values["body/velocity"][:, 1, 1] == pytest.approx(523.5, abs=1e-9)
    assert values["body/angular_velocity"][:, 1, 1] == pytest.approx(1.047, abs=1e-12)


def test_comments_and_numbers_without_length_stay_as_they_are():
    """IN4-BAR: the crank of 2 m, the coupler's ball at -6.1 m, the driver in rad/s."""
    lines = in_units(YOUNG / "IN4-BAR.dat", "m", "mm").splitlines()
    old = (YOUNG / "IN4-BAR.dat").read_text(encoding="utf-8").splitlines()
    assert lines[:2] == ["{ converted from the YOUNG deck IN4-BAR.dat }", "{ Units: mm, s }"]
    assert lines[2:8] == old[:6]
    assert lines[13:17] == [
        "1 0 0 2000",
        "2 3 0 -6100 0 0 -3700 0",
        "1 2 0 0 2000 0 6100 0 750 -660 2000 0 6100 1000",
        "1 4 0 0 0 0 0 0 1000 0 0 1000 0 0",
    ]
    assert (lines[12], lines[-1]) == (old[10], old[-1])


def test_a_translation_is_scaled_where_a_rotation_is_not(tmp_path):
    """Directions 1 to 3 of drivers and constraints are lengths, 4 to 6 angles or Euler parameters."""
    deck = tmp_path / "IN-BOTH.dat"
    text = "2 2 0 0 0 0 0 0 0 7 2 0\n0 0 0 1 0 0 0\n0 0 0 1 0 0 0\n1 2 1 2 3\n2 6 1 2 3\n"
    text += "1 1 7\n1 3 7\n1 4 7\n1 5 7\n1 6 7\n2 4 7\n2 5 7\n1 2 1 9\n1 2 6 .9\n0 1 1\n"
    deck.write_text(text, encoding="utf-8")
    found = in_units(deck, "cm", "mm").splitlines()[5:]
    assert found[:2] == ["1 2 10 20 30", "2 6 1 2 3"]
    assert found[2:5] == ["1 1 70", "1 3 70", "1 4 7"]
    assert found[9:] == ["1 2 1 90", "1 2 6 .9", "0 1 1"]


def test_inches_and_back_give_the_same_numbers(tmp_path):
    deck = tmp_path / "IN-INCH.dat"
    deck.write_text(in_units(YOUNG / "IN5BODY.dat", "m", "in"), encoding="utf-8")
    text = deck.read_text(encoding="utf-8")
    assert "{ Units: in, s }" in text and "3.1496062992125986" in text  # 0.08 m / 0.0254
    old = numbers((YOUNG / "IN5BODY.dat").read_text(encoding="utf-8"))
    assert numbers(in_units(deck, "in", "m")) == pytest.approx(old, rel=1e-15)


def test_a_setting_stands_in_the_new_deck_in_its_units():
    """The number of a setting is in the units of the old deck, as its name in --echo says."""
    changes = ("point.1.z=1.5", "driver.1.B=3")
    lines = in_units(YOUNG / "IN4-BAR.dat", "m", "mm", changes=changes).splitlines()
    assert lines[12:14] == ["1 4 0 3 0", "1 0 0 1500"]


def test_the_same_units_are_refused_with_the_way_to_others():
    with pytest.raises(ModelError) as refused:
        in_units(YOUNG / "IN4-BAR.dat", "m", "m")
    assert "a YOUNG deck already; --unit and --to-unit write it in other units" in str(refused.value)


def test_a_deck_with_masses_gets_its_masses_and_forces_in_the_new_units():
    """IN-ARM: a link of 1.5 kg = 0.0015 t, its mass centre at 0.4 m; gravity 9.81 m/s² = 9810 mm/s²."""
    text = in_units(YOUNG / "dynamics/IN-ARM.dat", "m", "mm")
    assert "{ Units: mm, t, s, N }" in text
    assert re.search(r"^GRAVITY 0\S* -9810\b", text, re.MULTILINE)
    assert re.search(r"^MASS 1 0\.0015 400\.0 ", text, re.MULTILINE)
