"""Words, comments and places of free-format text."""

import pickle

import pytest

from flexmb_cli.deck.words import UNCLOSED, Words, end_of, words
from flexmb_cli.errors import Place


def found(*lines):
    """The words read one by one; read in large numbers and placed afterwards they must be the same."""
    several = Words(lines)
    several.reach(100)
    one_by_one = [tuple(word) for word in words(lines)]
    assert [tuple(word) for word in several.upto(100)] == one_by_one
    assert several.texts(0, 100) == [text for text, *_ in one_by_one]
    assert [tuple(several[k]) for k in reversed(range(len(several)))] == one_by_one[::-1]
    return one_by_one


def test_blanks_tabs_and_line_ends_separate_words_and_columns_count_characters():
    assert found("1 \t-2.5", "", " é 3") == [("1", 1, 1), ("-2.5", 1, 4), ("é", 3, 2), ("3", 3, 4)]


def test_comments_may_stand_anywhere_and_over_several_lines():
    assert found("{a} 1{b}2 { c", "d } 3 {", "4", "} 5{}") == [
        ("1", 1, 5),
        ("2", 1, 9),
        ("3", 2, 5),
        ("5", 4, 3),
    ]


def test_words_in_large_numbers_are_read_as_far_as_they_are_asked_for():
    several = Words(["1 2", "{ 3", "} 4 5", "{"])
    several.reach(3)
    assert several.texts(0, 9) == ["1", "2", "4"] and several[2] == ("4", 3, 3)
    several.reach(9)
    assert pickle.loads(pickle.dumps(several))[3] == ("5", 3, 5)
    assert several.texts(4, 9) == [UNCLOSED] and several[4] == (UNCLOSED, 4, 1)


def test_comments_do_not_nest():
    assert found("{ { } 1") == [("1", 1, 7)]


def test_a_comment_without_end_is_the_last_word_at_its_opening_brace():
    assert found("1 {2", "3") == [("1", 1, 1), (UNCLOSED, 1, 3)]


@pytest.mark.parametrize(
    ("lines", "place"),
    [(["0 3 1"], Place(1, 6)), (["0 3", "1  ", "", ""], Place(2, 2)), ([""], Place(1, 1)), ([], Place(1, 1))],
)
def test_the_end_of_a_deck_is_just_after_its_last_character(lines, place):
    assert end_of(lines) == place
