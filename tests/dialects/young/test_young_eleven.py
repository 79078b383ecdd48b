"""Decks of YOUNG's earlier version: 11 counts and body estimates of three numbers, as IN1-4-3 is printed.

Liang Yong, YOUNG dissertation (1996), Appendix B, IN1-4-3: "1 1 1 0 0 0 0 0 0 5 0", then "0 0 0" for the body
and the driver "1 5 0 1.047 0" on one line, the point, the constraints, "0 3 1".
"""

from pathlib import Path

import pytest

from flexmb_cli.deck.record import DeckText
from flexmb_cli.deck.table_columns import Columns
from flexmb_cli.deck.text import read_text
from flexmb_cli.dialects.recognise import read_deck
from flexmb_cli.dialects.young.build import build_young
from flexmb_cli.dialects.young.listing_reader import row_fault
from flexmb_cli.errors import DeckError, ModelError
from tests.dialects.young.young_decks import PENDULUM

DECK = Path(__file__).resolve().parents[3] / "decks/young/IN1-4-3.dat"
PRINTED = """1 1 1 0 0 0 0 0 0 5 0
0 0 0 1 5 0 1.047 0
1 1 1 1
1 1 0 1 2 0 1 3 0 1 4 0 1 6 0
0 3 1
{***This input data is just for testing ONE ROTATING BODY***}
rotate around Y axis with one interested point
It has 1 body, 1 driver, 1 point of interest, 0 of any joints
"""
ONE_A_LINE = PRINTED.replace("0 0 0 1 5", "0 0 0\n1 5").replace("1 2 0 1 3 0 1", "1 2 0\n1 3 0\n1")


def read(text):
    return read_deck(DeckText("IN1-4-3.PAS", text, ""))


def without_places(mechanism):
    """Return what a mechanism is, but for the lines of its deck."""
    return [
        [tuple(value for key, value in vars(item).items() if key != "place") for item in items]
        for items in (mechanism.bodies, mechanism.drivers, mechanism.points, mechanism.simplified)
    ]


@pytest.mark.parametrize("text", [PRINTED, ONE_A_LINE])
def test_the_printed_deck_is_the_supplied_one(text):
    supplied, _ = build_young(read_deck(read_text(str(DECK))))
    found, _ = build_young(read(text))
    assert without_places(found) == without_places(supplied)
    assert (found.time.start, found.time.end, found.time.step) == (0.0, 3.0, 1.0)


def test_it_is_noted_at_the_counts():
    (note,) = read(PRINTED).warnings
    assert (note.severity, note.subject, note.place[:2]) == ("note", "counts", (1, 1))
    assert note.message.startswith("the deck has 11 counts, as decks of YOUNG's earlier version")


def test_a_deck_that_lost_one_of_twelve_counts_is_still_refused():
    """Its bodies have seven numbers: which count is missing cannot be known."""
    lost = PENDULUM.replace("2 1 0 0 0 1 0 0 0 0 0 1\n", "2 1 0 0 0 1 0 0 0 0 1\n")
    with pytest.raises(ModelError, match="counts needs 12 numbers; line 1 has 11"):
        build_young(read(lost))


def test_twelve_counts_on_two_lines_are_twelve():
    wrapped = PENDULUM.replace("0 0 0 0 0 1\n", "0 0 0 0 0\n1\n")
    assert read(wrapped).one("counts")["NGROUN"] == 1
    assert not [fault for fault in read(wrapped).warnings if "11 counts" in fault.message]


@pytest.mark.parametrize("counts", [PRINTED, PENDULUM])
def test_a_title_above_the_counts_is_told_to_stand_in_braces(counts):
    with pytest.raises(DeckError) as caught:
        read("SPATIAL FOUR BAR\n" + counts)
    assert str(caught.value) == "a title stands in braces: { SPATIAL FOUR BAR }"


@pytest.mark.parametrize(
    ("word", "remedy"),
    [
        ("17.O16", "letter O instead of zero?"),
        ("-4,250", "decimal comma? write a point"),
        ("–8.500", "is the minus sign a dash? write '-'"),
    ],
)
def test_slips_of_a_scan_in_a_listing_get_the_remedy_of_decks(word, remedy):
    columns = Columns("body", ("X", "Y"), ("position", "position"), (3, 3), 10)
    fault = row_fault("position", 1, f" {word} 1.000", 4, 3, columns)
    assert fault.message.endswith(f"{word!r} is not a number of this table: {remedy}")
