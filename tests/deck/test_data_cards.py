"""Plain data cards of large decks: read by one expression, they are what the reader of single fields finds.

Expected: `CardReader`, which cuts and spells field by field and finds all faults, is a second implementation.
"""

import pytest

from flexmb_cli.deck import many_records
from flexmb_cli.deck.record import DeckText
from flexmb_cli.dialects.vsdf import data_cards, fields, reader
from flexmb_cli.dialects.vsdf.card import WIDTHS
from flexmb_cli.dialects.vsdf.cards import CARDS
from flexmb_cli.dialects.vsdf.data_cards import CardReader
from flexmb_cli.errors import DeckError
from tests.dialects.vsdf.vsdf_decks import build, changed, read

PLAIN = [card for card in CARDS if data_cards.is_plain(card)]
SPELT = {"I": ("1", "-20", "+3"), "F": ("1.5", "-.25", "2.", "3e-4", "1E5", "7")}


def texts(card, more=3):
    """Fields of the card, each spelled differently, and of its list."""
    columns = [*card.columns, *([card.more] * (more if card.more else 0))]
    return [SPELT[column.letter][k % len(SPELT[column.letter])] for k, column in enumerate(columns)]


def by_columns(card, found):
    letters = [column.letter for column in card.columns] + ["I"] * len(found)
    return "".join(text.rjust(WIDTHS[letter]) for text, letter in zip(found, letters, strict=False))


def found_singly(card, line):
    one = CardReader(DeckText("x", line, ""))
    one.at = 1
    numbers = fields.with_own_keys(one.read_card(card, line, card.columns, card.more))
    assert not one.faults
    return numbers


@pytest.mark.parametrize("card", PLAIN, ids=lambda card: card.word)
def test_every_plain_card_has_the_numbers_and_places_of_its_fields(card):
    given = texts(card)
    lines = [",".join(given), " , ".join(given), ",".join(texts(card, 1))]
    if card.more is None:
        lines += [by_columns(card, given)]
        required = max((k for k, column in enumerate(card.columns, 1) if column.default is None), default=1)
        lines += [",".join(given[:required]), by_columns(card, given[:required])]
    for line in lines:
        assert data_cards.numbers(card, line, 1) == found_singly(card, line), line


FORCE = next(card for card in PLAIN if card.word == "FORC")


@pytest.mark.parametrize(
    "line",
    [
        "1,2,1.0D3", "1,2,1.0 comment", "1,2,1.0,0,0,0,0,9", "1,,1.0", "1.0,2,1.0", "1,2,1e400", "1,2,0x1",
        "1,2,١", "1,2,1.0\t", "    1    2       1.0       0.0       0.0    0    0 words",
        "1,1234567890123456,1", "    1    2   1.0 2.0", "1,2,1.5+3", "1" * 300,
    ],
)  # fmt: skip
def test_what_is_not_plain_is_left_to_the_reader_of_single_fields(line):
    assert data_cards.matched(FORCE, line) is None


def test_the_cards_of_a_large_deck_are_taken_apart_once_at_most(monkeypatch):
    """They were four times: twice to check them, and for each use of a number."""
    nodes = "".join(f"1,{k},1.0,0.0,0.0\n" for k in range(101, 151))
    monkeypatch.setattr(many_records, "MANY_NUMBERS", 60)
    cut, kept = [], fields.fields
    monkeypatch.setattr(fields, "fields", lambda *of: cut.append(of) or kept(*of))
    model = build(changed(("NODE\n", f"NODE\n{nodes}")))
    assert len(model.bodies[0].nodes) == 54 and tuple(model.bodies[0].nodes[150]) == (1.0, 0.0, 0.0)
    assert sum(line.startswith("1,1") for line, *_ in cut) < 25


def test_a_set_of_nodes_may_stand_on_a_thousand_cards():
    """`scripts/bench/large_decks.py` measures the time: each card copied the set so far once."""
    numbers = range(1001, 2001)
    nodes = "".join(f"1,{k},1.0,0.0,0.0\n" for k in numbers)
    cards = "".join(f"1,99,{k}\n" for k in numbers)
    text = changed(("NODE\n", f"NODE\n{nodes}"), ("TIME\n", f"NSET\n{cards}TIME\n"))
    assert build(text).bodies[0].sets[99] == tuple(numbers)


@pytest.mark.parametrize(
    ("limit", "most", "cards", "message"),
    [
        ("_MOST_CARDS", 2, "FORC\n" + 4 * "1,1,1.0\n", "there are more than 2 cards FORC"),
        ("_MOST_LISTED", 4, "OUTN\n1,1,2,3,4,1\n1,1\n", "cards with lists have more than 4 fields together"),
    ],
)
def test_more_than_the_memory_of_a_check_holds_is_refused(monkeypatch, limit, most, cards, message):
    monkeypatch.setattr(reader, limit, most)
    with pytest.raises(DeckError) as caught:
        read(changed(("TIME\n", f"{cards}TIME\n")))
    assert [fault.message for fault in caught.value.faults] == [
        f"{message}: the deck is not read from here on"
    ]
