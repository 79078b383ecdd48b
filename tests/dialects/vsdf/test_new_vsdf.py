"""The questions of `flexmb new vsdf`: every supplied deck, given as answers, reads back the same."""

from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path

import pytest

from flexmb_cli.deck.dialogue import Dialogue
from flexmb_cli.deck.text import decode, read_text
from flexmb_cli.dialects.recognise import read_deck
from flexmb_cli.dialects.vsdf.build import build_vsdf
from flexmb_cli.dialects.vsdf.cards import CARDS, analysis
from flexmb_cli.dialects.vsdf.form import ADDED, COUNTED, NEWER, VsdfForm
from flexmb_cli.model.integrators import METHODS, Integrator

DECKS = sorted((Path(__file__).parents[3] / "decks" / "vsdf").glob("*.vsdf"))
BY_SECTION = {card.section: card for card in CARDS}
OF_ONE_BODY = ("FEMN", "RIGI")
COUNTS_OF = {"counts": COUNTED, "more": ADDED, "new": NEWER}


def record_for(deck, entry):
    """The deck's record that `entry` asks for; None when the deck leaves the card out."""
    records = deck.section(entry.section)
    if BY_SECTION[entry.section].word in OF_ONE_BODY:
        return next(record for record in records if record.number == entry.number)
    return records[max(entry.number, 1) - 1] if records else None


def line_for(deck, question):
    """What answers `question` with the deck's own words; "" where its fields are empty."""
    entry = question.entry
    if entry.section == "title":
        return deck.one("title")["title"]
    if entry.section in COUNTS_OF:
        return " ".join(str(len(deck.section(card.section))) for card in COUNTS_OF[entry.section])
    record = None if entry.section == "element_line" else record_for(deck, entry)
    if record is None:
        return ""
    if question.cells[0].key == "nodes":
        return " ".join(n.text for n in record.numbers[len(BY_SECTION[entry.section].columns) :])
    texts = [record.at(cell.key).text for cell in question.cells]
    return " ".join(text or "0" for text in texts) if any(texts) else ""


def typed(deck):
    """The dialogue at the end of the answers that give a deck."""
    dialogue = Dialogue(VsdfForm())
    while (question := dialogue.question) is not None:
        line = line_for(deck, question)
        assert [f.sentence for f in dialogue.answer(line) if f.severity == "error"] == [], (line, question)
    return dialogue


def deck_of(dialogue):
    return read_deck(decode("new", dialogue.text.encode()))


def values_of(deck):
    return {(r.section, r.number, n.key): n.value for r in deck.records for n in r.numbers}


@pytest.mark.parametrize("path", DECKS, ids=lambda path: path.stem)
def test_a_supplied_deck_typed_in_reads_back_to_the_same_values(path):
    read_back(read_deck(read_text(path)))


def read_back(given):
    """The deck as it comes back from being typed in."""
    dialogue = typed(given)
    assert dialogue.question is None
    deck = deck_of(dialogue)
    original = values_of(given)
    assert {name: value for name, value in values_of(deck).items() if name in original} == original
    assert deck.warnings == ()
    return deck


def talk(*answers):
    dialogue = Dialogue(VsdfForm())
    for line in answers:
        assert dialogue.answer(line) == [], line
    return dialogue


COUNTS = {"BODY": 1, "NODE": 1, "JOIN": 1, "OUTN": 1}
ROD = [
    "rod",
    " ".join(str(COUNTS.get(card.word, 0)) for card in COUNTED),
    *("RIGD 0 0 0 0", "2.5 0 0 0.5", "1 1 0.1"),
    *("", "", "", "1 7", "", "SPHE 0 0 0 1 7", "", "", "", ""),
]


def test_a_rigid_pendulum_asked_for():
    """2.5 kg hung from the ground by a sphere at node 7; cards and fields as in decks/vsdf/FORMAT.md."""
    none, newer = (" ".join("0" * len(cards)) for cards in (ADDED, NEWER))
    dialogue = talk(*ROD, "1 7", "0 0 -9.81", "1 0.1", "", "", "", "", "", none, "", newer)
    assert dialogue.question is None
    lines = [line.strip() for line in dialogue.text.splitlines() if not line.startswith("*")]
    assert lines == [
        *("VSDF rod", "BODY", "1,RIGD,0,0,0,0", "RIGI", "1,2.5,0,0,0.5", "1,1,0.1,,,", "NODE", "1,7,,,"),
        *("JOIN", "1,SPHE,0,0,0,1,7,,,,", "OUTN", "1,7", "GRAV", "0,0,-9.81", "TIME", "1,0.1,"),
        *("INTG", "GALF,,,", "END", "STAR", "STOP"),
    ]
    model, _ = build_vsdf(deck_of(dialogue), Path("."))
    assert (model.bodies[0].name, model.joints[0].kind, model.time.end) == ("body 1", "spherical", 1.0)
    assert model.integrator == Integrator("GALF", 0.0, 1e-6, 0.9)  # FORMAT.md: the radius by default


def test_a_method_added_does_not_become_what_is_proposed(monkeypatch):
    """Whatever its word: a deck without INTG is solved by GALF."""
    monkeypatch.setitem(METHODS, "AB4", METHODS["RK45"])
    found = spec_from_file_location(f"{analysis.__name__}_again", analysis.__file__)
    found.loader.exec_module(again := module_from_spec(found))
    (method,) = (card.columns[0] for card in again.ANALYSIS_CARDS if card.word == "INTG")
    assert method.words == ("GALF", "AB4", "RAD5", "RK45")


def test_numbers_of_bodies_and_lists_of_nodes_are_checked_at_once():
    dialogue = talk(*ROD)
    assert [f.sentence for f in dialogue.answer("2")] == ["card OUTN 1: body must be within 1..1; read 2"]
    assert "must be an integer; read '7x'" in dialogue.answer("1 5 7x")[0].sentence
    assert dialogue.answer("1 5 7 9") == []
    dialogue.back_to("node.1")
    assert [f.sentence for f in dialogue.answer("3")] == ["card NODE 1: body must be within 0..1; read 3"]


def test_a_flexible_body_is_asked_for_its_files():
    counts = " ".join("1" if card.word in ("BODY", "FEMM", "FEMK") else "0" for card in COUNTED)
    dialogue = talk("", counts, "flex 9 1 13 9", "TXT my model/nodes.txt")
    assert dialogue.question.entry.subject == "card FEMM 1"
    assert dialogue.values["node_table.1.file"] == "my model/nodes.txt"
