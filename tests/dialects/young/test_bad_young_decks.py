# ruff: noqa: E101, E501 - the texts stand as a user sees them
"""Decks with numbers that cannot be read, and the whole text that a user gets.

The texts were settled by reading them, against the contract of messages: place, object, rule, what
was read, remedy, the line and a caret.
"""

import pytest

from tests.dialects.young.young_decks import pendulum, shown

CASES = [
    (
        "a letter O for zero",
        pendulum(2, "0 0 0 1 O 0 0"),
        r"""
IN.dat:2:9: error: body 1: e1 must be a number; read 'O': letter O instead of zero?
    0 0 0 1 O 0 0
            ^
""",
    ),
    (
        "a letter l for one",
        pendulum(3, "0 l 0 1 0 0 0"),
        r"""
IN.dat:3:3: error: body 2: y must be a number; read 'l': letter l instead of one?
    0 l 0 1 0 0 0
      ^
""",
    ),
    (
        "a decimal comma",
        pendulum(4, "2 4 0 1,047 0"),
        r"""
IN.dat:4:7: error: driver 1: B must be a number; read '1,047': decimal comma? write a point
    2 4 0 1,047 0
          ^^^^^
""",
    ),
    (
        "commas between numbers",
        pendulum(6, "1, 0 0 0 0 0 0"),
        r"""
IN.dat:6:1: error: ground 1: body must be an integer; read '1,': numbers are separated by blanks, not by commas
    1, 0 0 0 0 0 0
    ^^
""",
    ),
    (
        "a dash for a minus sign",
        pendulum(5, "1 2 0 0 0 0 −1 0 1 0 0 -1 -1 0"),
        r"""
IN.dat:5:13: error: revolute joint 1: P_j.y must be a number; read '−1': is the minus sign a dash? write '-'
    1 2 0 0 0 0 −1 0 1 0 0 -1 -1 0
                ^^
""",
    ),
    (
        "a hexadecimal number",
        pendulum(3, "0 0x1 0 1 0 0 0"),
        r"""
IN.dat:3:3: error: body 2: y must be a number; read '0x1': write it in plain decimal digits
    0 0x1 0 1 0 0 0
      ^^^
""",
    ),
    (
        "an underscore in a number",
        pendulum(3, "0 1_0 0 1 0 0 0"),
        r"""
IN.dat:3:3: error: body 2: y must be a number; read '1_0': write it in plain decimal digits
    0 1_0 0 1 0 0 0
      ^^^
""",
    ),
    (
        "not a number",
        pendulum(3, "0 nan 0 1 0 0 0"),
        r"""
IN.dat:3:3: error: body 2: y must be a number; read 'nan': a finite number is needed
    0 nan 0 1 0 0 0
      ^^^
""",
    ),
    (
        "a number beyond double precision",
        pendulum(3, "0 1e999 0 1 0 0 0"),
        r"""
IN.dat:3:3: error: body 2: y must be a number of at most 1.8e308 in size; read '1e999'
    0 1e999 0 1 0 0 0
      ^^^^^
""",
    ),
    (
        "an exponent without digits",
        pendulum(3, "0 1e 0 1 0 0 0"),
        r"""
IN.dat:3:3: error: body 2: y must be a number; read '1e': digits of the exponent are missing
    0 1e 0 1 0 0 0
      ^^
""",
    ),
    (
        "a body number that is no integer",
        pendulum(5, "1 2.5 0 0 0 0 -1 0 1 0 0 -1 -1 0"),
        r"""
IN.dat:5:3: error: revolute joint 1: J must be an integer; read '2.5'
    1 2.5 0 0 0 0 -1 0 1 0 0 -1 -1 0
      ^^^
""",
    ),
    (
        "a body number written as a real",
        pendulum(5, "1 2.0 0 0 0 0 -1 0 1 0 0 -1 -1 0"),
        r"""
IN.dat:5:3: warning: revolute joint 1: J should be an integer; '2.0' is taken for 2
    1 2.0 0 0 0 0 -1 0 1 0 0 -1 -1 0
      ^^^
""",
    ),
    (
        "an exponent without its letter",
        pendulum(4, "2 4 0 1.047+0 0"),
        r"""
IN.dat:4:7: warning: driver 1: B: '1.047+0' is taken for 1.047; write the exponent with e
    2 4 0 1.047+0 0
          ^^^^^^^
""",
    ),
    (
        "a caret below a word after tabs",
        pendulum(4, "2\t4\t0\t1.04x\t0"),
        r"""
IN.dat:4:7: error: driver 1: B must be a number; read '1.04x'
    2	4	0	1.04x	0
     	 	 	^^^^^
""",
    ),
    (
        "lines that end with CR LF",
        pendulum(4, "2 4 0 1.04x 0").replace("\n", "\r\n"),
        r"""
IN.dat:4:7: error: driver 1: B must be a number; read '1.04x'
    2 4 0 1.04x 0
          ^^^^^
""",
    ),
    (
        "an escape sequence, masked",
        pendulum(4, "2 4 0 \x1b[31m 0"),
        r"""
IN.dat:4:7: error: driver 1: B must be a number; read '\x1b[31m'
    2 4 0 �[31m 0
          ^^^^^
""",
    ),
    (
        "two faults in two records",
        pendulum(2, "0 0 0 1 O 0 0").replace("1.047", "1.o47"),
        r"""
IN.dat:2:9: error: body 1: e1 must be a number; read 'O': letter O instead of zero?
    0 0 0 1 O 0 0
            ^
IN.dat:4:7: error: driver 1: B must be a number; read '1.o47': letter O instead of zero?
    2 4 0 1.o47 0
          ^^^^^
""",
    ),
]


@pytest.mark.parametrize(("deck", "text"), [case[1:] for case in CASES], ids=[case[0] for case in CASES])
def test_a_deck_with(deck, text):
    assert shown(deck) == text.strip("\n")
