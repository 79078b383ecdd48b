# ruff: noqa: E501 - the texts stand as a user sees them
"""Decks that are well formed but give no model, and the whole text that a user gets.

The texts were settled by reading them, against the contract of messages: place, object, rule, what
was read, remedy, the line and a caret.
"""

import pytest

from tests.dialects.young.young_decks import pendulum, shown

CASES = [
    (
        "a body number above NBODY",
        pendulum(5, "1 9 0 0 0 0 -1 0 1 0 0 -1 -1 0"),
        r"""
IN.dat:5:3: error: revolute joint 1: body number 9 is outside 1..2
    1 9 0 0 0 0 -1 0 1 0 0 -1 -1 0
      ^
""",
    ),
    (
        "body number 0",
        pendulum(4, "0 4 0 1.047 0"),
        r"""
IN.dat:4:1: error: driver 1: body number 0 is outside 1..2
    0 4 0 1.047 0
    ^
""",
    ),
    (
        "a joint between a body and itself",
        pendulum(5, "2 2 0 0 0 0 -1 0 1 0 0 -1 -1 0"),
        r"""
IN.dat:5:3: error: revolute joint 1: I and J are both body 2; two bodies are needed
    2 2 0 0 0 0 -1 0 1 0 0 -1 -1 0
      ^
""",
    ),
    (
        "a direction above 6",
        pendulum(4, "2 7 0 1.047 0"),
        r"""
IN.dat:4:3: error: driver 1: direction 7 is outside 1..6 (1 2 3: along x y z; 4 5 6: about x y z)
    2 7 0 1.047 0
      ^
""",
    ),
    (
        "two bad body numbers and a bad direction",
        pendulum(5, "3 -1 0 0 0 0 -1 0 1 0 0 -1 -1 0").replace("2 4 0", "2 0 0"),
        r"""
IN.dat:4:3: error: driver 1: direction 0 is outside 1..6 (1 2 3: along x y z; 4 5 6: about x y z)
    2 0 0 1.047 0
      ^
IN.dat:5:1: error: revolute joint 1: body number 3 is outside 1..2
    3 -1 0 0 0 0 -1 0 1 0 0 -1 -1 0
    ^
IN.dat:5:3: error: revolute joint 1: body number -1 is outside 1..2
    3 -1 0 0 0 0 -1 0 1 0 0 -1 -1 0
      ^^
""",
    ),
    (
        "an axis without length",
        pendulum(5, "1 2 0 0 0 0 -1 0 0 0 0 -1 -1 0"),
        r"""
IN.dat:5:18: error: revolute joint 1: Q_i and P_i are the same point, so the vector between them has no direction
    1 2 0 0 0 0 -1 0 0 0 0 -1 -1 0
                     ^
""",
    ),
    (
        "an h along the axis of a screw",
        """2 0 0 0 0 0 0 0 1 1 0 1
0 0 0 1 0 0 0
0 2 0 1 0 0 0
1 2 0 0 0 0 0 0 0 1 0 0 1 0 0 2 0 0 0 1 0.5
2 5 0
1 0 0 0 0 0 0
0 1 1
""",
        r"""
IN.dat:4:29: error: screw joint 1: H_i lies on the axis from P_i to Q_i; h_i must point across it
    1 2 0 0 0 0 0 0 0 1 0 0 1 0 0 2 0 0 0 1 0.5
                                ^
""",
    ),
    (
        "Euler parameters that are all zero",
        pendulum(2, "0 0 0 0 0 0 0"),
        r"""
IN.dat:2:7: error: body 1: the Euler parameters are all zero; write 1 0 0 0 for a body that is not turned
    0 0 0 0 0 0 0
          ^
""",
    ),
    (
        "Euler parameters of another length",
        pendulum(3, "0 1 0 1 0.1 0 0"),
        r"""
IN.dat:3:7: warning: body 2: the Euler parameters have length 1.00499 and are scaled to length 1
    0 1 0 1 0.1 0 0
          ^
""",
    ),
    (
        "an end before the start",
        pendulum(7, "6 0 1"),
        r"""
IN.dat:7:3: error: time: the end Te = 0 s lies before the start Ti = 6 s
    6 0 1
      ^
""",
    ),
    (
        "a step of zero",
        pendulum(7, "0 6 0"),
        r"""
IN.dat:7:5: error: time: the step dT must be greater than zero; read 0
    0 6 0
        ^
""",
    ),
    (
        "a negative step",
        pendulum(7, "0 6 -1"),
        r"""
IN.dat:7:5: error: time: the step dT must be greater than zero; read -1
    0 6 -1
        ^^
""",
    ),
    (
        "too many rows",
        pendulum(7, "0 6 1e-7"),
        r"""
IN.dat:7:5: error: time: Ti, Te and dT give 60000001 rows; at most 10000000 are computed; a larger dT is needed
    0 6 1e-7
        ^^^^
""",
    ),
    (
        "too many rows to count",
        pendulum(7, "0 6 1e-300"),
        r"""
IN.dat:7:5: error: time: Ti, Te and dT give 6e+300 rows; at most 10000000 are computed; a larger dT is needed
    0 6 1e-300
        ^^^^^^
""",
    ),
    (
        "a step lost in round-off",
        pendulum(7, "1e17 1.00000000000001e17 1"),
        r"""
IN.dat:7:26: error: time: the step dT = 1 s is lost in the round-off of Ti = 1e+17 s
    1e17 1.00000000000001e17 1
                             ^
""",
    ),
    (
        "an angle in degrees",
        pendulum(6, "1 0 0 0 0 90 0"),
        r"""
IN.dat:6:11: warning: ground 1: angles are in rad; beta 90 would be 14.3 turns
    1 0 0 0 0 90 0
              ^^
""",
    ),
    (
        "points too far apart to subtract",
        pendulum(5, "1 2 -1e308 0 0 0 -1 0 1e308 0 0 -1 -1 0"),
        r"""
IN.dat:5:5: error: revolute joint 1: P_i.x is -1e308; numbers beyond 1e+50 cannot be computed with
    1 2 -1e308 0 0 0 -1 0 1e308 0 0 -1 -1 0
        ^^^^^^
IN.dat:5:23: error: revolute joint 1: Q_i.x is 1e308; numbers beyond 1e+50 cannot be computed with
    1 2 -1e308 0 0 0 -1 0 1e308 0 0 -1 -1 0
                          ^^^^^
""",
    ),
    (
        "a surplus number in a body line",
        pendulum(2, "0 0 0 1 0 0 0 0"),
        r"""
IN.dat:2:1: warning: body 1: needs 7 numbers; line 2 has 8
    0 0 0 1 0 0 0 0
    ^^^^^^^^^^^^^^^
IN.dat:3:13: error: driver 1: body number 0 is outside 1..2 (look first at line 2: body 1 needs 7 numbers; line 2 has 8)
    0 1 0 1 0 0 0
                ^
IN.dat:4:13: error: revolute joint 1: body number 0 is outside 1..2
    2 4 0 1.047 0
                ^
IN.dat:5:30: error: ground 1: body number 0 is outside 1..2
    1 2 0 0 0 0 -1 0 1 0 0 -1 -1 0
                                 ^
""",
    ),
    (
        "a surplus number in the counts line",
        pendulum(1, "2 1 0 0 0 1 0 0 0 0 0 0 1"),
        r"""
IN.dat:1:1: warning: counts: needs 12 numbers; line 1 has 13
    2 1 0 0 0 1 0 0 0 0 0 0 1
    ^^^^^^^^^^^^^^^^^^^^^^^^^
IN.dat:3:13: error: driver 1: body number 0 is outside 1..2 (look first at line 1: counts needs 12 numbers; line 1 has 13)
    0 1 0 1 0 0 0
                ^
IN.dat:4:13: error: revolute joint 1: body number 0 is outside 1..2
    2 4 0 1.047 0
                ^
IN.dat:6:3: error: time: the step dT must be greater than zero; read 0
    1 0 0 0 0 0 0
      ^
""",
    ),
]


@pytest.mark.parametrize(("deck", "text"), [case[1:] for case in CASES], ids=[case[0] for case in CASES])
def test_a_model_with(deck, text):
    assert shown(deck) == text.strip("\n")
