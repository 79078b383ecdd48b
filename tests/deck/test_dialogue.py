"""The dialogue of `flexmb new` as a machine: questions out, answers in, no terminal."""

import re
from pathlib import Path

import pytest

from flexmb_cli.deck.dialogue import Dialogue, draft_text, from_draft
from flexmb_cli.deck.text import decode, read_text
from flexmb_cli.dialects.recognise import read_deck
from flexmb_cli.dialects.young.build import build_young
from flexmb_cli.dialects.young.form import YoungForm
from flexmb_cli.errors import DeckError

DECKS = Path(__file__).parents[2] / "decks" / "young"
COUNTS = "4 1 1 1 1 2 0 0 0 0 0 1"
KINEMATIC = sorted(DECKS.glob("*.dat"))


def answers_of(path):
    """Title and the deck's own lines; comments and the prose after dT do not answer anything."""
    text = re.sub(r"\{[^}]*\}", "", path.read_text(encoding="utf-8"))
    return ["", *(line for line in text.splitlines() if line.strip())]


def talk(*answers):
    """A dialogue that accepted all of `answers`."""
    dialogue = Dialogue(YoungForm())
    for line in answers:
        assert errors(dialogue.answer(line)) == [], line
    return dialogue


def errors(faults):
    return [fault.sentence for fault in faults if fault.severity == "error"]


def deck_of(dialogue):
    return read_deck(decode("new", dialogue.text.encode()))


def numbers_of(deck):
    return [(name, number.value) for name, number in deck.numbers()]


@pytest.mark.parametrize("path", KINEMATIC, ids=lambda path: path.stem)
def test_a_supplied_deck_typed_in_reads_back_to_the_same_numbers(path):
    dialogue = Dialogue(YoungForm())
    for line in answers_of(path):
        if dialogue.question.entry.section == "shapes":
            break  # prose after dT
        assert errors(dialogue.answer(line)) == [], line
    assert errors(dialogue.answer("")) == [] and dialogue.question is None
    deck = deck_of(dialogue)
    assert numbers_of(deck) == numbers_of(read_deck(read_text(path)))
    assert deck.warnings == ()
    build_young(deck)


def test_one_number_a_line_gives_the_same_deck():
    dialogue = Dialogue(YoungForm())
    dialogue.answer("")
    for word in " ".join(answers_of(DECKS / "IN4-BAR.dat")[1:]).split():
        assert errors(dialogue.answer(word)) == []
    assert numbers_of(deck_of(dialogue)) == numbers_of(read_deck(read_text(DECKS / "IN4-BAR.dat")))


def test_numbers_stay_as_typed_and_the_title_is_a_comment():
    dialogue = talk("Crank of J. Doe", COUNTS, "1.50D-1 0 0")
    assert dialogue.records[0]["text"] == "Crank of J. Doe"
    assert dialogue.values["body.1.x"] == "1.50D-1"


def test_components_of_a_vector_are_asked_for_together():
    dialogue = talk("", COUNTS)
    assert [cell.key for cell in dialogue.question.cells] == ["x", "y", "z"]
    assert dialogue.question.text == "x y z: estimate of x, y, z of the body's origin at the start, m"
    assert dialogue.question.prompt == "[0 0 0] > "
    dialogue.answer("1")
    assert [cell.key for cell in dialogue.question.cells] == ["y", "z"]


def test_enter_takes_what_is_offered():
    dialogue = talk("", COUNTS, "", "")
    assert dialogue.question.entry.prefix == "body.2"
    record = dialogue.records[-1]
    assert [number.value for number in record.numbers] == [0, 0, 0, 1, 0, 0, 0]


def test_enter_is_no_answer_where_nothing_is_offered():
    dialogue = talk("")
    assert errors(dialogue.answer("")) == ["counts: NBODY must be an integer; Enter gives none here"]


# Each: answers before, the wrong one, what is said.
WRONG = [
    ([""], "four", "NBODY must be an integer; read 'four'"),
    ([""], "0", "NBODY must be within 1..1000; read 0"),
    ([""], "99999999999", "NBODY must be within 1..1000"),
    (["", "4"], "-1", "NDRIVE must be within 0..1000; read -1"),
    (
        [""],
        "4 1 1 1 1 2 0 0 0 0 0 0",
        "4 bodies have 24 coordinates, but the constraints and drivers give 18",
    ),
    (["", COUNTS], "0 0 0 1 0 0 0 0", "8 values, but only 7 are left"),
    (["", COUNTS], "0,1 0 0", "decimal comma"),
    (["", COUNTS, "0 0 0"], "0 0 0 0", "the Euler parameters are all zero"),
    (["", COUNTS, *[""] * 8], "5", "driver 1: body number 5 is outside 1..4"),
    (["", COUNTS, *[""] * 8], "1 7", "driver 1: direction 7 is outside 1..6"),
    (["", COUNTS, *[""] * 8, "1 4 0 1 0", "1 0 0 2"], "2 2", "I and J are both body 2"),
    (["a"], "1e99", "NBODY must be an integer of at most"),
]


@pytest.mark.parametrize(("before", "wrong", "said"), WRONG, ids=lambda value: str(value)[-20:])
def test_a_wrong_answer_is_refused_at_once_and_changes_nothing(before, wrong, said):
    dialogue = talk(*before)
    values, question = dialogue.values, dialogue.question
    found = errors(dialogue.answer(wrong))
    assert len(found) == 1
    assert said in found[0]
    assert (dialogue.values, dialogue.question) == (values, question)


def test_a_whole_record_in_its_midst_names_the_way_back_to_its_start():
    """`<` leads to the last components of a body; its seven numbers are too many there."""
    dialogue = talk("", COUNTS, "1 2 3", "1 0 0 0")
    assert dialogue.back()
    (said,) = errors(dialogue.answer("1 2 3 1 0 0 0"))
    assert said.endswith(
        "7 values, but only 4 are left: e0 e1 e2 e3; < body.1 asks for the whole record again"
    )
    assert dialogue.back_to("body.1")
    assert errors(dialogue.answer("1 2 3 1 0 0 0")) == []
    assert dialogue.question.entry.prefix == "body.2"


def test_more_values_than_a_record_has_name_no_way_back():
    (said,) = errors(talk("", COUNTS, "1 2 3").answer("1 2 3 1 0 0 0 0"))
    assert said.endswith("are left: e0 e1 e2 e3")


def test_a_title_cannot_end_its_comment():
    assert "cannot hold }" in errors(Dialogue(YoungForm()).answer("a } b"))[0]


def test_a_title_of_control_characters_is_refused():
    assert "must be text that can be printed" in errors(Dialogue(YoungForm()).answer("a\0b"))[0]


def one_body(*held):
    return talk("", "1 0 0 0 0 0 0 0 0 6 0 0", "", "", *held)


def test_a_coordinate_held_twice_is_refused_before_the_deck_is_complete():
    dialogue = one_body("1 1 0")
    assert "already held at 0 by simplified constraint 1" in errors(dialogue.answer("1 1 2"))[0]
    assert dialogue.question.entry.prefix == "simplified.2"


def test_a_vector_without_direction_sends_the_dialogue_back_to_it():
    dialogue = talk("", "2 0 0 0 0 1 0 0 0 1 0 1", *[""] * 4, "1 2", "0 0 0", "1 1 1", "0 0 0")
    assert "Q_i and P_i are the same point" in errors(dialogue.answer("2 2 2"))[0]
    assert [cell.key for cell in dialogue.question.cells] == ["Q_i.x", "Q_i.y", "Q_i.z"]
    assert dialogue.answer("1 0 0") == []
    assert dialogue.question.offered == ("2", "2", "2")  # the answer after it is kept
    assert dialogue.answer("") == []
    assert dialogue.question.entry.prefix == "simplified.1"


def test_counts_out_of_balance_lead_back_to_the_first_count():
    dialogue = talk("", "4 1 1 1 1 2 0 0 0", "0 0")
    assert "5 too few" in errors(dialogue.answer("0"))[0].replace("6 too few", "5 too few")
    assert dialogue.question.cells[0].key == "NBODY"
    assert dialogue.question.offered == ("4",)


def test_a_doubt_is_told_and_the_answer_taken():
    dialogue = talk("", COUNTS, "0 0 0")
    faults = dialogue.answer("2 0 0 0")
    assert [fault.severity for fault in faults] == ["warning"]
    assert "scaled to length 1" in faults[0].sentence
    assert dialogue.question.entry.prefix == "body.2"


def test_an_angle_is_called_an_angle_once_the_direction_is_known():
    dialogue = talk("", COUNTS, *[""] * 8, "1 4")
    assert dialogue.question.text == "C: angle at t = 0, rad"
    dialogue.back()
    dialogue.answer("2")
    assert dialogue.question.text == "C: coordinate at t = 0, m"


def test_going_back_offers_what_was_answered():
    dialogue = talk("", COUNTS, "1 2 3", "1 0 0 0", "4 5 6")
    assert dialogue.back()
    assert dialogue.question.offered == ("4", "5", "6")
    assert dialogue.back()
    assert dialogue.back()
    assert dialogue.question.offered == ("1", "2", "3")
    dialogue.answer("7 8 9")
    assert dialogue.forward() == []
    assert dialogue.question.entry.prefix == "body.2"
    assert dialogue.question.first == 3
    assert dialogue.records[-1]["x"] == 7


def test_the_first_question_has_none_before_it():
    assert not Dialogue(YoungForm()).back()


def test_going_back_by_name():
    dialogue = talk("", COUNTS, *[""] * 4)
    assert dialogue.back_to("body.1")
    assert dialogue.question.entry.prefix == "body.1"
    assert not dialogue.back_to("driver.1")  # not asked for yet
    assert dialogue.question.entry.prefix == "body.1"


def test_other_counts_ask_for_other_records_and_keep_the_rest():
    dialogue = talk("", COUNTS, "1 2 3 1 0 0 0")
    dialogue.back_to("counts")
    dialogue.answer("1 0 0 0 0 0 0 0 0 0 0 1")
    assert dialogue.question.offered == ("1", "2", "3")
    assert dialogue.forward() == []
    assert dialogue.question.entry.prefix == "ground.1"


def test_forward_stops_where_an_earlier_answer_no_longer_fits():
    dialogue = talk("", "2 0 0 0 0 0 0 0 0 0 0 2", *[""] * 4, "2")
    dialogue.back_to("counts")
    dialogue.answer("1 0 0 0 0 0 0 0 0 0 0 1")
    assert errors(dialogue.forward()) == ["ground 1: body number 2 is outside 1..1"]
    assert dialogue.question.entry.prefix == "ground.1"
    assert dialogue.question.cells[0].key == "body"


def test_help_explains_every_value():
    dialogue = talk("", COUNTS, *[""] * 8)
    assert dialogue.question.help() == "body: number of the body; an integer"
    dialogue.answer("1")
    assert dialogue.question.help() == "direction: 1 2 3: along x y z; 4 5 6: about x y z; an integer"
    dialogue.answer("1")
    assert dialogue.question.help() == "C: coordinate at t = 0, m; a number; Enter gives 0"


@pytest.mark.parametrize("stop", range(1, 70, 7))
def test_a_draft_goes_on_where_it_was_left(stop):
    words = ["", *" ".join(answers_of(DECKS / "IN4-BAR.dat")[1:]).split()]
    first = talk(*words[:stop])
    again = from_draft(YoungForm(), draft_text(first))
    assert (again.question.entry, again.values) == (first.question.entry, first.values)
    for word in (
        words[stop:] if again.question == first.question else words[stop - again_behind(again, first) :]
    ):
        assert errors(again.answer(word)) == []
    assert numbers_of(deck_of(again)) == numbers_of(read_deck(read_text(DECKS / "IN4-BAR.dat")))


def again_behind(again, first):
    """A draft begins with the whole vector whose first components were given."""
    return first.question.first - again.question.first


@pytest.mark.parametrize(
    "text", ["", "[]", "{}", '{"flexmb new": "young", "answers": {"body.1.x": 1}}', "\0"]
)
def test_what_is_no_draft_is_refused(text):
    with pytest.raises(DeckError, match="not a draft of a deck"):
        from_draft(YoungForm(), text)


def test_a_draft_of_another_dialect_is_refused():
    with pytest.raises(DeckError, match="a draft of a dafms deck"):
        from_draft(YoungForm(), '{"flexmb new": "dafms", "answers": {}}')


def test_a_draft_with_a_spoilt_number_asks_for_it_anew():
    text = draft_text(talk("", COUNTS, "1 2 3 1 0 0 0", "4 5 6")).replace('"2"', '"2x"', 1)
    dialogue = from_draft(YoungForm(), text)
    assert dialogue.question.entry.prefix == "counts"
    assert dialogue.question.cells[0].key == "NREVOL"


def test_a_question_mark_draws_the_points_of_a_joint():
    dialogue = talk("t", "2 1 0 0 0 0 0 1 0 0 0 1", "0 0 0 1 0 0 0", "0 0 0 1 0 0 0", "1 1 0 1 0", "1 2")
    assert dialogue.question.entry.subject == "translational joint 1"
    drawn = dialogue.question.help()
    for part in ("P--------->Q   s = Q - P, along the axis", "h = H - P, across the axis", "P_i, Q_i"):
        assert part in drawn
