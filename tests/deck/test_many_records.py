"""Records of large decks, made when they are looked at; here of small ones that are taken for large."""

import pickle
from pathlib import Path

import pytest

from flexmb_cli.deck import many_records
from flexmb_cli.deck.expansion.includes import is_expandable
from flexmb_cli.deck.record import DeckText
from flexmb_cli.deck.text import read_text
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
    monkeypatch.setattr(many_records, "MANY_NUMBERS", 0)
    return lambda text: read_deck(DeckText("x", text, ""), "young")


def test_records_come_by_section_index_and_in_the_order_of_the_deck(read):
    deck = read(DECK)
    assert not isinstance(deck.records, tuple)
    assert [record.prefix for record in deck.records] == [
        *("counts", "body.1", "body.2", "point.1", "point.2", "ground.1", "ground.2", "time")
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
    ("old", "new", "reported"),
    [
        ("2 0.4", "3 0.4", (4, "point of interest 2: body number 3 is outside 1..2")),
        ("2 3 4 5", "1 3 4 5", (6, GROUND_TWICE)),
    ],
)
def test_faults_are_those_of_small_decks(read, old, new, reported):
    with pytest.raises(ModelError) as stopped:
        build_young(read(DECK.replace(old, new)))
    assert reported in [(fault.place.line, fault.sentence) for fault in stopped.value.faults]


CARDS = (
    DECK
    + """\
DYNAMICS inverse
MASS 1 2 0.1 0.2 0.3 1 1 1 { about the axes }
force 2 0 0 0
  1 2.5 3 { along } FORCE {here} 2 0 0 0 4 5 6 1
END
"""
)


def test_cards_of_a_large_deck_are_those_of_a_small_one(read, monkeypatch):
    many = read(CARDS)
    monkeypatch.setattr(many_records, "MANY_NUMBERS", 10**6)
    few = read(CARDS)
    assert isinstance(few.records, tuple) and not isinstance(many.records, tuple)
    for one, other in zip(few.records[-4:], many.records[-4:], strict=True):
        assert (one.prefix, one.values, one.place) == (other.prefix, other.values, other.place)
        assert one.numbers == other.numbers
    assert [record.place.line for record in many.section("force")] == [10, 11]


DECKS = Path(__file__).parents[2] / "decks"
# A small deck with variables keeps their names in formulas, a large one has numbers there.
SUPPLIED = [
    path
    for pattern in ("young/**/*.dat", "vsdf/*.vsdf")
    for path in sorted(DECKS.glob(pattern))
    if not is_expandable(path.read_text())
]


@pytest.mark.parametrize("path", SUPPLIED, ids=lambda path: path.name)
def test_every_supplied_deck_has_the_same_records_when_it_is_taken_for_large(path, monkeypatch):
    few = read_deck(read_text(path))
    monkeypatch.setattr(many_records, "MANY_NUMBERS", 0)
    many = read_deck(read_text(path))
    assert isinstance(few.records, tuple) and not isinstance(many.records, tuple)
    by_name = {record.prefix: record for record in many.records}
    assert len(by_name) == len(many.records) == len(few.records)
    for record in few.records:
        found = by_name[record.prefix]
        assert (found.subject, found.values, found.place) == (record.subject, record.values, record.place)
        assert tuple(found.numbers) == record.numbers
    if few.dialect == "young":
        one, other = build_young(few)[0], build_young(many)[0]
        for name in ("bodies", "joints", "simplified", "distances", "drivers", "grounds", "points"):
            assert tuple(getattr(one, name)) == tuple(getattr(other, name))
