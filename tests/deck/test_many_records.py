"""Records of large decks, made when they are looked at; here of small ones that are taken for large."""

import pickle

import pytest

from flexmb_cli.deck import many_records
from flexmb_cli.deck.record import DeckText
from flexmb_cli.dialects.recognise import read_deck
from flexmb_cli.dialects.settings import apply_settings
from flexmb_cli.dialects.young.build import build_young
from flexmb_cli.errors import ModelError, Place

DECK = """\
2 0 2 0 0 0 0 0 0 0 0 2
{ bodies } 0 1 2 1 0 0 0   3 4 {a} 5
1 0 0 0
1 0.1 0.2 0.3   2 0.4 0.5 0.6
1 0 1 2 0 0 0
2 3 4 5 0 0 0
0 1 0.5
"""
GROUND_TWICE = "ground 2: body 1 is already ground 1, at another position; remove one of them"


@pytest.fixture
def read(monkeypatch):
    monkeypatch.setattr(many_records, "MANY", 0)
    return lambda text: read_deck(DeckText("x", text, ""), "young")


def test_records_come_by_section_index_and_in_the_order_of_the_deck(read):
    deck = read(DECK)
    assert not isinstance(deck.records, tuple)
    assert [record.prefix for record in deck.records] == [
        *("counts", "body.1", "body.2", "point.1", "point.2", "ground.1", "ground.2", "time"),
    ]
    assert len(deck.records) == 8 and deck.records[-1]["step"] == 0.5
    assert [record.number for record in deck.records[1:3]] == [1, 2]
    assert deck.section("point")[1].values == (2, 0.4, 0.5, 0.6)
    assert list(deck.section("driver")) == list(deck.section("none")) == []
    with pytest.raises(IndexError):
        deck.records[8]
    assert pickle.loads(pickle.dumps(deck)).one("time").values == (0.0, 1.0, 0.5)


def test_numbers_have_their_places_over_comments_and_line_ends(read):
    second = read(DECK).section("body")[1]
    assert second.place == Place(2, 28)
    assert second.at("z").place == Place(2, 36) and second.at("e0").place == Place(3, 1)


def test_a_setting_changes_one_number(read):
    deck = apply_settings(read(DECK), ["point.2.y=7"])
    assert deck.section("point")[1].values == (2, 0.4, 7.0, 0.6)


def test_parts_are_made_of_the_records(read):
    mechanism, _ = build_young(read(DECK))
    assert [body.r for body in mechanism.bodies] == [(0.0, 1.0, 2.0), (3.0, 4.0, 5.0)]
    assert mechanism.points[-1].s == (0.4, 0.5, 0.6) and len(mechanism.points[:1]) == 1
    assert mechanism.grounds[1].values == (3.0, 4.0, 5.0, 0.0, 0.0, 0.0)


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("2 0.4", "3 0.4", (4, "point of interest 2: body number 3 is outside 1..2")),
        ("2 3 4 5", "1 3 4 5", (6, GROUND_TWICE)),
    ],
)
def test_faults_are_those_of_small_decks(read, old, new, told):
    with pytest.raises(ModelError) as stopped:
        build_young(read(DECK.replace(old, new)))
    assert told in [(fault.place.line, fault.sentence) for fault in stopped.value.faults]
