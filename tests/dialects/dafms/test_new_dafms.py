"""The questions of `flexmb new dafms`: supplied decks, given as answers, read back the same."""

from itertools import takewhile
from pathlib import Path

import numpy as np
import pytest

from flexmb_cli.deck.dialogue import Dialogue, draft_text, from_draft
from flexmb_cli.deck.text import decode, read_text
from flexmb_cli.dialects.dafms.beam import Beam, full_matrix
from flexmb_cli.dialects.dafms.build import build_dafms
from flexmb_cli.dialects.dafms.cards import CARDS
from flexmb_cli.dialects.dafms.deck_writer import OPTIONAL
from flexmb_cli.dialects.dafms.form import DafmsForm
from flexmb_cli.dialects.recognise import read_deck

DECKS = Path(__file__).parents[3] / "decks" / "dafms"
TYPED = sorted(DECKS.glob("*.DAT"))
TABLES = ("motor_table", "torque_table", "nodal_rotation", "function")
# Cards that do nothing are not asked for (X(L)), and the run is always to be integrated.
LEFT = ("first_coordinate", "counts.jdi", "id", "equations", "heading", "run", "echo", "one_way")


def line_for(deck, entry, count):
    """The deck's own words for the cells of `entry` from the first to the last."""
    section, k = entry.section, entry.number
    if section == "title":
        return deck.one("heading").numbers[0].text[5:].strip()
    if section == "counts":
        size = deck.section("counts")[0]
        given = [_count(deck, CARDS[word]) for word in OPTIONAL]
        return " ".join(map(str, [size["N"], size["NDM"], *given]))
    if section == "shapes":
        return str(_count(deck, CARDS["GEOM"]))
    if section == "element_line":
        return lines_of_block(deck)[k - 1]
    if section == "body":
        body = deck.section("counts")[k]
        flags = [body[f"{letter}{axis}"] for letter in ("NT", "NR") for axis in (1, 2, 3)]
        parent = deck.section("parent")[k - 1]["L"] if deck.section("parent") else 0
        return " ".join(map(str, [parent, *flags, "TYPED" if body["NUMNP"] else "RIGID"]))
    if section == "elastic":
        body = deck.section("counts")[k]
        return f"{body['NUMNP']} {body['NDF']}"
    if section.startswith("node."):
        forces = deck.section(section.replace("node", "nodal_force"))[k - 1]
        return _words([*deck.section(section)[k - 1].numbers, *forces.numbers])
    if section == "skyline":
        return " ".join(map(str, np.diff(_addresses(deck, k), prepend=0)))
    if section.startswith("stiffness."):
        body = int(section.split(".")[1])
        ends = [0, *_addresses(deck, body)]
        return _words(_of(deck, "bkp", body).numbers[ends[k - 1] : ends[k]])
    if section == "nodal_mass":
        return _words(_of(deck, "bmi", k).numbers)
    if section == "state":
        pair = [deck.section(name) for name in ("coordinate", "speed")]
        return _words([records[k - 1].numbers[0] for records in pair if records])
    if section.partition(".")[0] in TABLES:
        return _of_table(deck, section, k, count)
    records = deck.section(section)
    return _words(records[max(k, 1) - 1].numbers[-count:]) if records else ""


def _of_table(deck, section, k, count):
    """The head of a card with a table, or its k-th row: points are pairs, rotations a row an axis."""
    name, _, entry = section.partition(".")
    record = deck.section(name)[int(entry or k) - 1]
    head = 2 if name == "nodal_rotation" else 3
    first = head + (k - 1) * count if entry else 0
    return _words(record.numbers[first : first + count])


def _count(deck, card):
    if card.layout == "switch":
        return int(card.word in deck.source.lines)
    records = deck.section(card.section)
    return len(records) if card.layout == "entries" else int(bool(records))


def _of(deck, section, k):
    return next(record for record in deck.section(section) if record.number == k)


def _addresses(deck, k):
    return [n.value for n in _of(deck, "counts.jdi", k).numbers]


def _words(numbers):
    return " ".join(repr(n.value) for n in numbers)


def lines_of_block(deck):
    """Those of the block ELEMENTS, and an empty one."""
    lines = [line.rstrip() for line in deck.source.lines]
    first = lines.index("ELEMENTS") + 1 if "ELEMENTS" in lines else len(lines)
    return [*takewhile(lambda line: line[:1] == " ", lines[first:]), ""]


def typed(deck):
    """The dialogue at the end of the answers that give a deck."""
    dialogue = Dialogue(DafmsForm())
    while (question := dialogue.question) is not None:
        line = line_for(deck, question.entry, len(question.entry.cells))
        assert [f.sentence for f in dialogue.answer(line) if f.severity == "error"] == [], (line, question)
    return dialogue


def deck_of(dialogue):
    return read_deck(decode("new", dialogue.text.encode()))


def values_of(deck):
    records = [record for record in deck.records if record.section not in LEFT]
    values = {(r.section, r.number, i): n.value for r in records for i, n in enumerate(r.numbers)}
    rigid = [r for r in deck.section("counts")[1:] if r["NUMNP"] == 0]
    # NDF of a body without nodes means nothing.
    return values | {("counts", r.number, len(r.numbers) - 1): 0 for r in rigid}


@pytest.mark.parametrize("path", TYPED, ids=lambda path: path.stem)
def test_a_supplied_deck_typed_in_reads_back_to_the_same_values(path):
    read_back(read_deck(read_text(path)))


def read_back(original):
    """The deck as it comes back from being typed in."""
    deck = deck_of(typed(original))
    written = values_of(deck)
    assert {name: written.get(name) for name in values_of(original)} == values_of(original)
    assert [n.value for r in deck.section("counts.jdi") for n in r.numbers] == [
        n.value for r in original.section("counts.jdi") for n in r.numbers
    ]
    assert bool(deck.section("one_way")) == bool(original.section("one_way"))
    assert deck.warnings == ()
    build_dafms(deck)
    return deck


def talk(*answers):
    dialogue = Dialogue(DafmsForm())
    for line in answers:
        assert dialogue.answer(line) == [], line
    return dialogue


COUNTS = "1 2 1" + " 0" * (len(OPTIONAL) - 1)
ROD = ["rod", COUNTS, "10 0.01", "0 0 0 0 1 0 0", "RIGID"]
FLEXIBLE = [*ROD[:4], "beam", "1.2 3 40 0.5", "", "", "", ""]


def test_a_rigid_pendulum_asked_for():
    """Columns by hand from decks/dafms/FORMAT.md: I5 fields, F10.5 fields, one record a card and body."""
    dialogue = talk(*ROD, "2.5", "0.9 0 0.9", *[""] * 5, "0 0.5 0", "1.25", "", "0 0 -9.81", "0", "")
    assert dialogue.question is None
    lines = dialogue.text.splitlines()
    assert lines[:8] == [
        *("    1    2", "DFMB rod", "    1    0    0    0    0", "    1    1    1    0    0"),
        *("    0", "    0", "   10", "      0.01"),
    ]
    assert lines[8:14] == [
        *("CONN", "    0", "MASS", "    1       2.5", "INER", "    1       0.9       0.0       0.9")
    ]
    assert lines[-7:] == [
        *("Y(L)", "       0.0      1.25", "GRAV", "    0       0.0       0.0     -9.81"),
        *("END ", "STAR", "STOP"),
    ]


def test_a_beam_gives_its_block_and_offers_its_share_of_mass_and_inertia():
    dialogue = talk(*FLEXIBLE)
    beam = Beam(1.2, 3, 40, 0.5)
    assert [float(text) for text in dialogue.question.offered] == [0.6]  # 0.5 kg/m times 1.2 m
    while dialogue.question is not None:
        assert dialogue.answer("") == []
    deck = deck_of(dialogue)
    np.testing.assert_allclose(deck.section("inertia")[0]["BII1"], beam.inertia, rtol=1e-7)
    # A cantilever's tip gives way by P L^3 / (3 EI): the last diagonal of the inverse.
    packed = [n.value for n in deck.one("bkp").numbers]
    stiffness = full_matrix([n.value for n in deck.one("counts.jdi").numbers], packed)
    np.testing.assert_allclose(np.linalg.inv(stiffness)[-1, -1], 1.2**3 / (3 * 40), rtol=1e-9)
    assert [record["q"] for record in deck.section("coordinate")] == [0.0] * 4


TABLES_OF_A_BEAM = {"TABM": 1, "TABL": 1, "NROT": 1}
WITH_TABLES = "1 3 " + " ".join(str(TABLES_OF_A_BEAM.get(word, 0)) for word in OPTIONAL)


def entered(dialogue, prefix=""):
    """Enter to every question up to the record `prefix`, or to the end."""
    while dialogue.question is not None and dialogue.question.entry.prefix != prefix:
        assert dialogue.answer("") == []
    return dialogue


def with_tables(body, *answers):
    """A dialogue on one body, and the answers to its tables."""
    dialogue = entered(talk(body[0], WITH_TABLES, *body[2:]), "motor_table.1")
    for line in answers:
        assert dialogue.answer(line) == [], line
    return dialogue


def test_the_rotation_of_a_beams_node_is_offered():
    """A unit moment's tip slope of a cantilever is L/(EI), and its deflection L²/(2 EI)."""
    deck = deck_of(entered(with_tables(FLEXIBLE, "1 1 1", "0 0", "1 3 1", "0 0", "1 3")))
    row = np.array([n.value for n in deck.one("nodal_rotation").numbers[2:5]])
    stiffness = full_matrix(
        [n.value for n in deck.one("counts.jdi").numbers], [n.value for n in deck.one("bkp").numbers]
    )
    # By reciprocity the moment does to the deflections what these do to the slope.
    deflection = np.linalg.solve(stiffness, row)
    np.testing.assert_allclose(deflection[-1], 1.2**2 / (2 * 40), rtol=1e-7)
    assert [n.value for n in deck.one("nodal_rotation").numbers[5:]] == [0.0] * 6
    build_dafms(deck)


def test_a_node_that_turns_is_one_of_a_flexible_body():
    tables = "1 1 1", "0 0", "1 3 1", "0 0"
    rigid = with_tables([*ROD, "2.5", "0.3 0 0.3"], *tables)
    assert [f.sentence for f in rigid.answer("1 1")] == ["nodal rotation 1: K = 1 is not a flexible body"]
    beam = with_tables(FLEXIBLE, *tables)
    assert [f.sentence for f in beam.answer("1 4")] == ["nodal rotation 1: I = 4: body 1 has nodes 1 to 3"]


def test_points_of_a_table_come_in_the_order_of_time():
    dialogue = with_tables(FLEXIBLE, "1 1 3", "0.5 1", "0.5 2")
    (reported,) = dialogue.answer("0.4 3")
    assert reported.sentence.endswith("t(3) = 0.4 lies before t(2) = 0.5")
    assert dialogue.answer("0.6 3") == []


WRONG = [
    (["t"], "0", "N must be within 1..1000; read 0"),
    (["t"], "1 4", "NDM must be within 2..3; read 4"),
    (["t"], "1 2 2", "GRAV must be within 0..1; read 2"),
    (["t", COUNTS], "0", "IT must be within 1..99999; read 0"),
    (["t", COUNTS], "10 0.012345678901", "H must fit 10 columns; read 0.012345678901; the nearest"),
    (["t", COUNTS, "10 0.1"], "1", "L must be within 0..0; read 1"),
    (["t", COUNTS, "10 0.1"], "0 2", "NT.1 must be within 0..1; read 2"),
    (ROD[:4], "soft", "kind must be one of RIGID, BEAM, TYPED; read 'soft'"),
    ([*ROD[:4], "TYPED"], "40 2", "80 elastic coordinates are too many to type (at most 60)"),
    ([*ROD[:4], "TYPED", "2 1", "0 1 0 0", "0 2 0 0"], "1 3", "h(2) must be within 1..2; read 3"),
]


@pytest.mark.parametrize(("before", "wrong", "said"), WRONG, ids=lambda value: str(value)[-20:])
def test_a_wrong_answer_is_refused_at_once_and_costs_one_number(before, wrong, said):
    """Numbers before a misspelt one stay; what the reader refuses as a whole changes nothing."""
    dialogue = talk(*before)
    values, question = dialogue.values, dialogue.question
    found = [fault.sentence for fault in dialogue.answer(wrong)]
    assert len(found) == 1
    assert said in found[0]
    typed = [] if "too many to type" in said else wrong.split()[:-1]
    names = map(question.entry.name, question.entry.cells[question.first :])
    assert dialogue.values == values | dict(zip(names, typed, strict=False))
    assert dialogue.question.first == question.first + len(typed)


def test_a_beam_that_is_none_leads_back_to_its_length():
    dialogue = talk(*FLEXIBLE[:5], "-1.2 3 40 0.5 0", "", "")
    assert "length must be above zero" in dialogue.answer("")[0].sentence
    assert dialogue.question.cells[0].key == "length"


def test_going_back_and_a_draft_keep_the_answers():
    dialogue = talk(*ROD, "2.5", "0.3 0 0.3")
    assert dialogue.back()
    assert dialogue.question.offered == ("0.3", "0", "0.3")
    assert dialogue.back_to("body.1")
    assert dialogue.forward() == []
    again = from_draft(DafmsForm(), draft_text(dialogue))
    assert again.question == dialogue.question
    assert again.question.entry.prefix == "hinge_point.1"
