"""The custom of one record a line: slips are named, decks in free form are left alone."""

import random
import textwrap
from pathlib import Path

import pytest

from flexmb_cli.deck.record import DeckText
from flexmb_cli.dialects.young.dynamic_cards import read_young_deck
from flexmb_cli.errors import DeckError
from tests.dialects.young.young_decks import PENDULUM, faults, pendulum, read

DECKS = sorted((Path(__file__).parents[2] / "decks" / "young").glob("*.dat"))


def numbers_of(path):
    """The deck without its heading, one string a line."""
    return path.read_text().partition("}\n")[2].split("\n")


@pytest.mark.parametrize("path", DECKS, ids=lambda path: path.stem)
@pytest.mark.parametrize("width", range(2, 30))
def test_a_deck_with_so_many_numbers_a_line_is_free_form(path, width):
    words = " ".join(numbers_of(path)).split()
    lines = [" ".join(words[start : start + width]) for start in range(0, len(words), width)]
    assert read("\n".join(lines)).warnings == ()


@pytest.mark.parametrize("path", DECKS, ids=lambda path: path.stem)
def test_a_deck_wrapped_at_any_column_is_free_form(path):
    wrap = textwrap.TextWrapper(break_long_words=False, break_on_hyphens=False)
    for wrap.width in range(20, 133):
        assert read(wrap.fill(" ".join(numbers_of(path)))).warnings == (), wrap.width


@pytest.mark.parametrize("seed", range(40))
def test_records_broken_over_lines_of_their_own_or_joined_are_no_slips(seed):
    chance = random.Random(seed)
    for path in DECKS:
        text = ""
        for line in filter(None, numbers_of(path)):
            words = line.split()
            if chance.random() < 0.3:
                words.insert(chance.randrange(1, len(words)), "\n")
            text += " ".join(words) + chance.choice(["\n", "\n", " "])
        assert read(text).warnings == (), text


@pytest.mark.parametrize("line", [2, 3, 4, 5, 6])
@pytest.mark.parametrize("change", [-2, -1, 1, 2])
def test_a_line_with_too_few_or_too_many_numbers_is_named(line, change):
    words = PENDULUM.split("\n")[line - 1].split()
    changed = words[:change] if change < 0 else [*words, *["0"] * change]
    found = faults(pendulum(line, " ".join(changed)))
    named = [fault for fault in found if "numbers; line" in fault.message and fault.severity == "warning"]
    assert [fault.place.line for fault in named] == [line]
    assert named[0].message == f"needs {len(words)} numbers; line {line} has {len(changed)}"


@pytest.mark.parametrize("line", [2, 3, 4, 5, 6])
def test_a_lost_number_is_named_in_the_error_that_it_leads_to(line):
    words = PENDULUM.split("\n")[line - 1].split()
    errors = [f.message for f in faults(pendulum(line, " ".join(words[:-1]))) if f.severity == "error"]
    assert sum(f"(look first at line {line}: " in message for message in errors) == 1


def test_the_four_bar_lines_as_they_stand_in_print_are_all_named():
    """Appendix B prints IN4-BAR with zeros lost; here one each in three neighbouring lines."""
    lines = numbers_of(next(path for path in DECKS if path.stem == "IN4-BAR"))
    printed = [line[: line.rindex(" ")] if number in (7, 8, 9) else line for number, line in enumerate(lines)]
    named = [fault.sentence for fault in faults("\n".join(printed)) if fault.severity == "warning"]
    assert named == [
        "spherical joint 1: needs 8 numbers; line 8 has 7",
        "universal joint 1: needs 14 numbers; line 9 has 13",
        "revolute joint 1: needs 14 numbers; line 10 has 13",
    ]


@pytest.mark.parametrize(
    ("lost", "reported"),
    [
        (10, (13, "body 5 needs 7 numbers; line 13 has 5: the line of one of body 1 to body 5")),
        (16, (16, "spherical joint 1 needs 8 numbers; line 16 has 14: the line of spherical joint 1")),
        (17, (19, "line 19 has 20: the line of revolute joint 1, revolute joint 2 or cylindrical joint 1")),
        (19, (19, "line 19 has 20: the line of revolute joint 1, revolute joint 2 or cylindrical joint 1")),
        (21, (21, "line 21 has 7: the line of distance constraint 1")),
    ],
)
def test_a_lost_line_is_named_with_the_records_that_it_may_have_held(lost, reported):
    """Records of one size follow each other: the first line that does not fit stands after them."""
    (deck,) = (path for path in DECKS if path.stem == "IN5BODY")
    lines = deck.read_text(encoding="utf-8").splitlines()
    found = faults("\n".join(lines[: lost - 1] + lines[lost:]))
    line, text = reported
    (warning,) = [fault for fault in found if fault.id == "DECK-008"]
    assert warning.place.line == line
    assert f"{text} seems to be missing" in f"{warning.subject} {warning.message}"
    errors = [fault.message for fault in found if fault.severity == "error"]
    assert sum(f"(look first at line {line}: " in message for message in errors) == 1


@pytest.mark.parametrize("lost", [10, 17, 21])
def test_cards_behind_the_numbers_hide_no_lost_line(lost):
    """The numbers reached into the cards: "ground 1: z must be a number; read 'DYNAMICS'"."""
    (deck,) = (path for path in DECKS if path.stem == "IN5BODY")
    lines = deck.read_text(encoding="utf-8").splitlines()
    short = [*lines[: lost - 1], *lines[lost:]]
    cards = ["", "DYNAMICS inverse { a comment }", "MASS 1 1.5 0 0 0 0.01 0.01 0.01", "END"]
    with pytest.raises(DeckError) as failed:
        read_young_deck(DeckText("deck", "\n".join([*short, *cards]), ""))
    assert list(failed.value.faults) == list(faults("\n".join(short)))
