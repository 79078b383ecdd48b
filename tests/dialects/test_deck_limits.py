"""What a deck may hold at most, so that `check` takes no more than twelve times its size and 200 MB.

The limits are lowered here; scripts/bench/large_decks.py measures decks at the limits themselves.
"""

import pytest

from flexmb_cli import errors
from flexmb_cli.deck import many_records
from flexmb_cli.deck.many_records import DeckValues
from flexmb_cli.deck.record import DeckText
from flexmb_cli.dialects.dafms import reader as dafms
from flexmb_cli.dialects.dafms import system_cards
from flexmb_cli.dialects.recognise import read_deck
from flexmb_cli.dialects.vsdf.motions import build_tables
from flexmb_cli.dialects.young import dynamic_cards as young
from flexmb_cli.errors import DeckError, Fault, FaultList
from flexmb_cli.model.diagnostics import Findings
from tests.dialects.dafms.dafms_decks import deck_text
from tests.dialects.vsdf.vsdf_decks import changed

YOUNG = (
    "2 0 0 0 0 1 0 0 0 0 0 1\n0 0 0 1 0 0 0\n0 0 0 1 0 0 0\n1 2 0 0 0 0 0 0 0 0 1 0 0 1\n1 0 0 0 0 0 0\n"
    "0 1 0.1\nDYNAMICS FORWARD\nMASS 2 1 0 0 0 1 1 1\nFORCE 2 0 0 0 1 0 0\nFORCE 2 0 0 0 1 0 0\n"
    "TORQUE 2 0 0 1\nEND\n"
)
DAFMS = deck_text("two_link_n2")


@pytest.mark.parametrize(
    ("module", "limit", "most", "dialect", "text", "reported"),
    [
        (young, "MOST_LOADS", 2, "young", YOUNG, "more than 2 cards other than MASS, VELOCITY"),
        (dafms, "MOST_TREE_BODIES", 1, "dafms", DAFMS, "N = 2 bodies, at most 1 are taken"),
        (dafms, "MOST_SHORT_NUMBERS", 30, "dafms", DAFMS, "the deck has more than 30 numbers outside lists"),
        (
            system_cards,
            "MOST_REPEATED",
            2,
            "dafms",
            DAFMS.replace("RC(K", 3 * "CONN\n    0    1\n" + "RC(K"),
            "cards that replace earlier ones: more than 2",
        ),
    ],
)  # fmt: skip
def test_a_deck_of_more_than_its_check_may_take_is_refused(
    monkeypatch, module, limit, most, dialect, text, reported
):
    assert read_deck(DeckText("x", text, ""), dialect)
    monkeypatch.setattr(module, limit, most)
    with pytest.raises(DeckError) as caught:
        read_deck(DeckText("x", text, ""), dialect)
    errors = [fault.message for fault in caught.value.faults if fault.severity == "error"]
    assert len(errors) == 1 and reported in errors[0]


def test_of_millions_of_errors_only_the_first_are_kept(monkeypatch):
    monkeypatch.setattr(errors, "MOST_LISTED_ERRORS", 3)
    found = FaultList()
    found += [Fault("error", f"number {k}", id="DECK-005") for k in range(9)]
    assert [fault.message for fault in found] == [
        *("number 0", "number 1", "number 2"),
        "3 errors are listed, the others are not",
    ]


def test_points_of_many_tables_are_sorted_by_table_whatever_their_order(monkeypatch):
    """Expected: the tables of a deck whose records are all kept."""
    points = "".join(f"{1 + k % 3},{k}.0,{k * k}.5\n" for k in range(30)) + "4,1.0,0\n4,1.0,1\n"
    text = changed(("TIME\n", f"TABL\n{points}TIME\n"))
    found, faults = [], []
    for most in (10**6, 20):
        monkeypatch.setattr(many_records, "MANY_NUMBERS", most)
        findings = Findings()
        found.append(build_tables(DeckValues(read_deck(DeckText("x", text, ""), "vsdf")), findings))
        faults.append([(fault.place.line, fault.sentence) for fault in findings.faults])
    few, many = found
    assert list(few) == list(many) == [1, 2, 3, 4]
    assert all(few[k].times == many[k].times and few[k].values == many[k].values for k in (1, 2, 3))
    assert many[2].times[:2].tolist() == [1.0, 4.0] and many[2].values[1] == 16.5
    line = text.splitlines().index("4,1.0,1") + 1
    assert faults[0] == faults[1] == [(line, "table 4: times must ascend; 1 s follows 1 s")]
