"""Cards of functions and elements in VSDF and DAFMS decks: format pages, echo, check, and every misuse."""

import re
from pathlib import Path

import pytest

from flexmb_cli.dialects.dafms.elements.cards import ELEMENT_CARDS as DAFMS
from flexmb_cli.dialects.vsdf.elements.cards import ELEMENT_CARDS as VSDF
from flexmb_cli.results.texts.echo import echo
from flexmb_cli.run.check.check import check_deck
from flexmb_cli.run.outcome import RunOptions
from tests.dialects.dafms import test_every_card as dafms
from tests.dialects.dafms.dafms_decks import read as read_dafms
from tests.dialects.dafms.dafms_decks import reported as reported_dafms
from tests.dialects.dafms.test_dafms_elements import ENDS, HELD, card, deck, function, integers, reals
from tests.dialects.vsdf import element_cases as vsdf
from tests.dialects.vsdf.vsdf_decks import read as read_vsdf
from tests.dialects.vsdf.vsdf_decks import reported as reported_vsdf

TUTORIAL = Path(__file__).parents[2] / "docs/tutorial/motors-and-springs.md"
PAGES = {name: Path(__file__).parents[2] / f"decks/{name}/FORMAT.md" for name in ("vsdf", "dafms")}


def vsdf_text(case, cards):
    return f"{case.mechanism}{cards}TIME\n 1,0.1\nEND\nSTAR\nSTOP\n"


def of_vsdf(word):
    case = vsdf.CASES[word]
    return vsdf_text(case, case.cards + case.driver)


def of_dafms(word):
    return deck(dafms.joined(dafms.CASES[word]))


TEXTS = [pytest.param("vsdf", c, of_vsdf(c.word), read_vsdf, id=c.word) for c in VSDF]
TEXTS += [pytest.param("dafms", c, of_dafms(c.word), read_dafms, id=f"DAFMS {c.word}") for c in DAFMS]


@pytest.mark.parametrize(("dialect", "card", "text", "read"), TEXTS)
def test_page_echo_and_check_know_the_card(dialect, card, text, read, tmp_path):
    rows = [line for line in PAGES[dialect].read_text().splitlines() if line.startswith("|")]
    assert any(f"`{card.word}`" in row.split("|")[1] for row in rows)
    lines = echo(read(text)).splitlines()
    for item in getattr(card, "columns", ()) or card.items:
        assert any(f".{item.key} " in line and line.endswith(item.meaning) for line in lines), item.key
    path = tmp_path / f"x.{'vsdf' if dialect == 'vsdf' else 'DAT'}"
    path.write_text(text)
    assert check_deck(str(path), RunOptions()).outcome.exit_code == 0


@pytest.mark.parametrize(("dialect", "card", "text", "read"), TEXTS)
def test_the_tutorial_names_the_card_beside_that_of_young(dialect, card, text, read):
    rows = [line.split("|") for line in TUTORIAL.read_text(encoding="utf-8").splitlines()]
    cells = [row[3 if dialect == "vsdf" else 4] for row in rows if len(row) == 6]
    assert any(f"`{card.word}`" in cell for cell in cells)


ARM = vsdf.turned("")
# Card, what is put in its place, and the message with its line and column.
WRONG_VSDF = {
    "FUNC": ("FUNC\n 5,SINE,1\nTMOT\n 1,5", ":2: error: function 1: SINE takes mean amplitude omega and"),
    "SUPP": ("FUNC\n 5,POLY,1\nSUPP\n 3,5", ":2: error: support 1: there are no pins; a card PINN"),
    "TMOT": ("TMOT\n 1,7", ":4: error: tmotor 1: there is no function 7; the deck has none; define it"),
    "AMOT": (
        "FUNC\n 5,POLY,1\nAMOT\n 1,5",
        ":2: error: amotor 1: joint 1 (joint 1) has an angle, not a stroke; take",
    ),
    "TSPR": ("TSPR\n 9,5", ":2: error: tspring 1: joint number 9 is outside 1..2"),
    "ASPR": ("ASPR\n 1,5", ":2: error: aspring 1: joint 1 (joint 1) has an angle, not a stroke; take"),
    "TSTO": ("TSTO\n 1,0.2,0.1,5", ":8: error: tstop 1: upper must be larger than lower, 0.2; read 0.1"),
    "ASTO": ("ASTO\n 1,0,1,-5", ":8: error: astop 1: stiffness must not be negative; read -5"),
    "LSPR": ("LSPR\n 0,1,0,3,5", ":6: error: lspring 1: both ends are on the ground, so nothing changes"),
    "CABL": ("CABL\n 0,9,2,3,5", ":4: error: cable 1: the ground has no node 9"),
    "BUSH": ("BUSH\n 0,3,2,3,-1", ":10: error: bushing 1: k.x must not be negative; read -1"),
    "COUP": (
        "COUP\n 1,1,1,2\n 1,1,1,3",
        ":4: error: coupling 1: names one coordinate twice; add its factors",
    ),
    "FRIC": (
        "FRIC\n 1,0.2,0.2,0,0.01,0.1",
        ":12: error: friction 1: stribeck must be above 1e-100; read 0",
    ),
    "RATE": ("RATE\n 1,3,1", ":4: error: rate 1: must be 1 (angle) or 2 (stroke); read 3"),
    "OUTJ": ("OUTJ\n 2", ":2: error: joint output 1: on is 0 or 1; read 2"),
}


def test_every_card_has_a_misuse():
    assert set(WRONG_VSDF) == {card.word for card in VSDF}
    assert set(WRONG_DAFMS) == {card.word for card in DAFMS}


@pytest.mark.parametrize("word", WRONG_VSDF)
def test_a_misuse_in_vsdf_is_told_with_place_object_and_remedy(word):
    cards, wanted = WRONG_VSDF[word]
    told = [line for line in reported_vsdf(vsdf_text(ARM, f"{cards}\n")) if ": error: " in line]
    assert any(re.sub(r"^\d+", "", line).startswith(wanted) for line in told), told


WRONG_DAFMS = {
    "FUNC": (function(1, 4, 1.0), "function 1: SINE takes mean amplitude omega and"),
    "MOTF": (
        card("MOTF", integers(1, 3, 7)),
        "function motor 1: there is no function 7; the deck has none; define it",
    ),
    "PREF": (
        card("PREF", integers(1, 3, 7, 0)),
        "function drive 1: there is no function 7; the deck has none; define it",
    ),
    "HSPR": (
        card("HSPR", integers(1, 2) + reals(20)),
        "hinge spring 1: A = 2: rotation 2 of this hinge is not free; free there: A = 3",
    ),
    "HSTO": (
        card("HSTO", integers(1, 3) + reals(1, 0, 5)),
        "hinge stop 1: upper must be larger than lower, 1; read 0",
    ),
    "LSPR": (
        card("LSPR", integers(1, 0, 1, 0, 0, 0), HELD, reals(5)),
        "lspring 1: KA = KB = 1: two bodies are needed",
    ),
    "CABL": (card("CABL", integers(0, 0, 9, 0), HELD, reals(5)), "cable 1: KB = 9: there are bodies 0 to 2"),
    "BUSH": (card("BUSH", ENDS, HELD, reals(-1), ""), "bushing 1: k.x must not be negative; read -1"),
    "COUP": (card("COUP", integers(1, 1, 3) + reals(0)), "coupling 1: a factor of 0 couples nothing"),
    "FRIC": (
        card("FRIC", integers(1) + reals(0.2, 0.2, 0.1, 0.01)),
        "friction 1: a joint that turns needs the radius",
    ),
}


@pytest.mark.parametrize("word", WRONG_DAFMS)
def test_a_misuse_in_dafms_is_told_with_place_object_and_remedy(word):
    cards, wanted = WRONG_DAFMS[word]
    told = [line for line in reported_dafms(deck(cards)) if ": error: " in line]
    assert any(re.match(rf"\d+:\d+: error: {re.escape(wanted)}", line) for line in told), told


TWICE = function(5, 3, 1), card("PREF", integers(1, 3, 5, 0)), card("PRES", integers(1, 3) + reals(0, 1, 0))
DEGREES = "upper of 90 rad is 14.3 turns; 90 degrees would be 1.5708 rad"
MORE_DAFMS = {
    "driven by two cards": (
        "\n".join(TWICE),
        "error: function drive 1: PRES already drives rotation 3 of the",
    ),
    "a polynomial of nothing": (
        "FUNC\n    1\n    5    3    0",
        "error: function 1: NP = 0 numbers, a function",
    ),
    "a negative length": (
        card("LSPR", integers(1, 0, 0, 0, 0, 0), HELD, reals(5, -0.1)),
        "note: lspring 1: rest -0.1 is negative, and lengths are not: its spring pulls at every length",
    ),
    "degrees": (card("HSTO", integers(1, 3) + reals(-1, 90, 5)), f"note: hinge stop 1: {DEGREES}"),
}


@pytest.mark.parametrize("name", MORE_DAFMS)
def test_more_slips_in_dafms(name):
    cards, wanted = MORE_DAFMS[name]
    told = reported_dafms(deck(cards))
    assert any(re.match(rf"\d+:\d+: {re.escape(wanted)}", line) for line in told), told


def test_limits_in_degrees_are_noted_for_angles_alone():
    """1.5708 is a quarter of the circle's 2 pi; a stroke of 90 m is one."""
    told = reported_vsdf(vsdf_text(ARM, "TSTO\n 1,-1,90,5\n"))
    assert any(line.endswith(f"note: tstop 1: {DEGREES}") for line in told), told
    slider = vsdf.slid("")
    assert not any(" turns;" in line for line in reported_vsdf(vsdf_text(slider, "ASTO\n 1,-1,90,5\n")))
