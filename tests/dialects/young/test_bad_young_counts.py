# ruff: noqa: E501, W293 - the texts stand as a user sees them
"""Decks that end early or whose counts do not fit, and the whole text that a user gets.

The texts were settled by reading them, against the contract of messages: place, object, rule, what
was read, remedy, the line and a caret.
"""

import pytest

from tests.dialects.young.young_decks import PENDULUM, pendulum, shown

CASES = [
    (
        "a comment that is never closed",
        pendulum(2, "{ body 1\n0 0 0 1 0 0 0"),
        r"""
IN.dat:2:1: error: a comment is opened here and never closed with }
    { body 1
    ^
""",
    ),
    (
        "a closing brace alone",
        pendulum(2, "0 } 0 1 0 0 0"),
        r"""
IN.dat:2:3: error: body 1: y must be a number; read '}': a comment ends here that was not opened
    0 } 0 1 0 0 0
      ^
""",
    ),
    (
        "another comment sign",
        pendulum(4, "2 4 0 1.047 # rad/s"),
        r"""
IN.dat:4:1: warning: driver 1: needs 5 numbers; line 4 has 6
    2 4 0 1.047 # rad/s
    ^^^^^^^^^^^^^^^^^^^
IN.dat:4:13: error: driver 1: A must be a number; read '#': comments are written in braces { } (look first at line 4: driver 1 needs 5 numbers; line 4 has 6)
    2 4 0 1.047 # rad/s
                ^
IN.dat:4:15: error: revolute joint 1: I must be an integer; read 'rad/s'
    2 4 0 1.047 # rad/s
                  ^^^^^
""",
    ),
    (
        "an end within the last record",
        PENDULUM[:-3],
        r"""
IN.dat:7:4: error: time: the deck ends after 2 of its 3 numbers; by its counts the deck needs 55 numbers, it has 54
    0 6
       ^
""",
    ),
    (
        "an end before a record",
        "".join(PENDULUM.splitlines(keepends=True)[:4]),
        r"""
IN.dat:4:14: error: revolute joint 1: the deck ends before it; by its counts the deck needs 55 numbers, it has 31
    2 4 0 1.047 0
                 ^
""",
    ),
    (
        "an end within the counts",
        "2 1 0 0 0 1 0",
        r"""
IN.dat:1:14: error: counts: the deck ends after 7 of the 12 counts
    2 1 0 0 0 1 0
                 ^
""",
    ),
    (
        "an empty deck",
        "",
        r"""
IN.dat:1:1: error: the deck is empty; a YOUNG deck begins with 12 integers
    
    ^
""",
    ),
    (
        "a deck that is only a comment",
        "{ nothing }\n\n",
        r"""
IN.dat:1:12: error: the deck is empty; a YOUNG deck begins with 12 integers
    { nothing }
               ^
""",
    ),
    (
        "a count that is no integer",
        pendulum(1, "2 1 0 0 0 1 0 0 0 0 0.5 1"),
        r"""
IN.dat:1:21: error: counts: NSIMP2 must be an integer; read '0.5'
    2 1 0 0 0 1 0 0 0 0 0.5 1
                        ^^^
""",
    ),
    (
        "a negative count",
        pendulum(1, "2 -1 0 0 0 1 0 0 0 0 0 1"),
        r"""
IN.dat:1:3: error: counts: NDRIVE must be at least 0; read -1
    2 -1 0 0 0 1 0 0 0 0 0 1
      ^^
""",
    ),
    (
        "no body at all",
        pendulum(1, "0 1 0 0 0 1 0 0 0 0 0 1"),
        r"""
IN.dat:1:1: error: counts: NBODY must be at least 1; read 0
    0 1 0 0 0 1 0 0 0 0 0 1
    ^
""",
    ),
    (
        "a count of ten billion bodies",
        pendulum(1, "10000000000 0 0 0 0 0 0 0 0 0 0 0"),
        r"""
IN.dat:4:1: warning: body 3: needs 7 numbers; line 4 has 5
    2 4 0 1.047 0
    ^^^^^^^^^^^^^
IN.dat:7:6: error: body 7: the deck ends after 1 of its 7 numbers; by its counts the deck needs 70000000015 numbers, it has 55 (look first at line 4: body 3 needs 7 numbers; line 4 has 5)
    0 6 1
         ^
""",
    ),
    (
        "a count with too many digits",
        pendulum(1, "9999999999999999999 1 0 0 0 1 0 0 0 0 0 1"),
        r"""
IN.dat:1:1: error: counts: NBODY must be an integer of at most 15 digits; read '9999999999999999999'
    9999999999999999999 1 0 0 0 1 0 0 0 0 0 1
    ^^^^^^^^^^^^^^^^^^^
""",
    ),
    (
        "a joint line that lost a zero",
        pendulum(5, "1 2 0 0 0 0 -1 0 1 0 0 -1 -1"),
        r"""
IN.dat:5:1: warning: revolute joint 1: needs 14 numbers; line 5 has 13
    1 2 0 0 0 0 -1 0 1 0 0 -1 -1
    ^^^^^^^^^^^^^^^^^^^^^^^^^^^^
IN.dat:7:6: error: time: the deck ends after 2 of its 3 numbers; by its counts the deck needs 55 numbers, it has 54 (look first at line 5: revolute joint 1 needs 14 numbers; line 5 has 13)
    0 6 1
         ^
""",
    ),
    (
        "a body line that lost a zero",
        pendulum(2, "0 0 0 1 0 0"),
        r"""
IN.dat:2:1: warning: body 1: needs 7 numbers; line 2 has 6
    0 0 0 1 0 0
    ^^^^^^^^^^^
IN.dat:7:6: error: time: the deck ends after 2 of its 3 numbers; by its counts the deck needs 55 numbers, it has 54 (look first at line 2: body 1 needs 7 numbers; line 2 has 6)
    0 6 1
         ^
""",
    ),
    (
        "a counts line that lost a zero",
        pendulum(1, "2 1 0 0 0 1 0 0 0 0 1").replace("0 0 0 1 0 0 0", "0.5 0 0 1 0 0 0", 1),
        r"""
IN.dat:1:5: error: counts: NPOINT must be an integer; read '0.5' (look first at line 1: counts needs 12 numbers; line 1 has 11)
    2 1 0.5 0 0 1 0 0 0 0 1
        ^^^
""",
    ),
]


@pytest.mark.parametrize(("deck", "text"), [case[1:] for case in CASES], ids=[case[0] for case in CASES])
def test_a_deck_with(deck, text):
    assert shown(deck) == text.strip("\n")
