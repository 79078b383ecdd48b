# ruff: noqa: E501 - the texts stand as a user sees them
"""Decks whose constraints and drivers give no model, and the whole text that a user gets.

The texts were settled by reading them, against the contract of messages: place, object, rule, what
was read, remedy, the line and a caret.
"""

import pytest

from tests.dialects.young.young_decks import one_body, pendulum, shown

CASES = [
    (
        "an equation too many",
        pendulum(1, "2 1 0 0 0 1 0 0 0 1 0 1").replace("-1 0\n", "-1 0\n2 1 0\n"),
        r"""
IN.dat:1:1: error: counts: 2 bodies have 12 coordinates, but the constraints and drivers give 13 equations, 1 too many
    2 1 0 0 0 1 0 0 0 1 0 1
    ^
IN.dat:3:1: note: body 2: 6 coordinates, 7 equations, 1 too many
    0 1 0 1 0 0 0
    ^
""",
    ),
    (
        "an equation too few",
        pendulum(1, "2 0 0 0 0 1 0 0 0 0 0 1").replace("2 4 0 1.047 0\n", ""),
        r"""
IN.dat:1:1: error: counts: 2 bodies have 12 coordinates, but the constraints and drivers give 11 equations, 1 too few
    2 0 0 0 0 1 0 0 0 0 0 1
    ^
IN.dat:3:1: note: body 2: 6 coordinates, 5 equations, 1 too few
    0 1 0 1 0 0 0
    ^
""",
    ),
    (
        "as many equations as coordinates, but on the wrong body",
        """3 0 0 0 0 0 0 0 0 6 0 2
0 0 0 1 0 0 0
0 0 0 1 0 0 0
0 0 0 1 0 0 0
2 1 0
2 2 0
2 3 0
2 4 0
2 5 0
3 1 0
1 0 0 0 0 0 0
1 0 0 0 0 0 0
0 1 1
""",
        r"""
IN.dat:1:1: error: counts: the equations are as many as the coordinates, but in the wrong places
    3 0 0 0 0 0 0 0 0 6 0 2
    ^
IN.dat:2:1: note: body 1: 6 coordinates, 12 equations, 6 too many
    0 0 0 1 0 0 0
    ^
IN.dat:3:1: note: body 2: 6 coordinates, 5 equations, 1 too few
    0 0 0 1 0 0 0
    ^
IN.dat:4:1: note: body 3: 6 coordinates, 1 equation, 5 too few
    0 0 0 1 0 0 0
    ^
IN.dat:12:1: warning: ground 2: body 1 is already ground 1; these six equations are redundant
    1 0 0 0 0 0 0
    ^
""",
    ),
    (
        "a chain that hangs on too few equations",
        """3 0 0 2 0 0 0 0 0 0 0 1
0 0 0 1 0 0 0
0 0 0 1 0 0 0
0 0 0 1 0 0 0
1 2 0 0 0 0 0 0
2 3 0 0 1 0 0 0
1 0 0 0 0 0 0
0 1 1
""",
        r"""
IN.dat:1:1: error: counts: 3 bodies have 18 coordinates, but the constraints and drivers give 12 equations, 6 too few
    3 0 0 2 0 0 0 0 0 0 0 1
    ^
IN.dat:3:1: note: bodies 2 and 3: 12 coordinates, 6 equations, 6 too few (a joint's equations shared between its bodies, body 2: 4.5, body 3: 1.5; 6 each are needed)
    0 0 0 1 0 0 0
    ^
""",
    ),
    (
        "two rotational drivers on one body",
        one_body(["1 4 0 1 0", "1 5 0 1 0"], ["1 1 0", "1 2 0", "1 3 0", "1 6 0"]),
        r"""
IN.dat:4:1: error: driver 2: body 1 is already turned by driver 1; a body takes one rotational driver
    1 5 0 1 0
    ^
""",
    ),
    (
        "a coordinate both driven and held",
        one_body(["1 1 0 1 0"], ["1 1 0", "1 2 0", "1 3 0", "1 4 0", "1 5 0"]),
        r"""
IN.dat:3:1: error: driver 1: x of body 1 is already held by simplified constraint 1; remove one of them
    1 1 0 1 0
    ^
""",
    ),
    (
        "an angle both driven and held",
        one_body(["1 4 0 1 0"], ["1 1 0", "1 2 0", "1 3 0", "1 4 0", "1 5 0"]),
        r"""
IN.dat:3:1: error: driver 1: the angle about x of body 1 is already held by simplified constraint 4; remove one of them
    1 4 0 1 0
    ^
""",
    ),
    (
        "a driver at rest where the coordinate is held",
        one_body(["1 1 0.5 0 0"], ["1 1 0.5", "1 2 0", "1 3 0", "1 4 0", "1 5 0"]),
        r"""
IN.dat:3:1: warning: driver 1: x of body 1 is already held at this value by simplified constraint 1; this equation is redundant
    1 1 0.5 0 0
    ^
""",
    ),
    (
        "a coordinate held twice at one value",
        one_body([], ["1 1 0", "1 1 0", "1 2 0", "1 3 0", "1 4 0", "1 5 0"]),
        r"""
IN.dat:4:1: warning: simplified constraint 2: x of body 1 is already held at this value by simplified constraint 1; this equation is redundant
    1 1 0
    ^
""",
    ),
    (
        "a coordinate held at two values",
        one_body([], ["1 1 0", "1 1 0.5", "1 2 0", "1 3 0", "1 4 0", "1 5 0"]),
        r"""
IN.dat:4:1: error: simplified constraint 2: x of body 1 is already held at 0 by simplified constraint 1; 0.5 contradicts it
    1 1 0.5
    ^
""",
    ),
    (
        "angles that no attitude has",
        one_body([], ["1 1 0", "1 2 0", "1 3 0", "1 4 2", "1 5 2", "1 6 0"]),
        r"""
IN.dat:7:1: error: simplified constraint 5: no attitude of body 1 has these angles: the squares of sin(angle/2) add up to 1.41615, more than 1
    1 5 2
    ^
""",
    ),
    (
        "a ground body held once more, elsewhere",
        one_body([], ["1 1 0.1"], ["1 0 0 0 0 0 0"]),
        r"""
IN.dat:1:1: error: counts: 1 body has 6 coordinates, but the constraints and drivers give 7 equations, 1 too many
    1 0 0 0 0 0 0 0 0 1 0 1
    ^
IN.dat:2:1: note: body 1: 6 coordinates, 7 equations, 1 too many
    0 0 0 1 0 0 0
    ^
IN.dat:3:1: error: simplified constraint 1: x of body 1 is already held at 0 by ground 1; 0.1 contradicts it
    1 1 0.1
    ^
""",
    ),
    (
        "a ground body that is driven",
        one_body(["1 1 0 1 0"], [], ["1 0 0 0 0 0 0"]),
        r"""
IN.dat:1:1: error: counts: 1 body has 6 coordinates, but the constraints and drivers give 7 equations, 1 too many
    1 1 0 0 0 0 0 0 0 0 0 1
    ^
IN.dat:2:1: note: body 1: 6 coordinates, 7 equations, 1 too many
    0 0 0 1 0 0 0
    ^
IN.dat:3:1: error: driver 1: x of body 1 is already held by ground 1; remove one of them
    1 1 0 1 0
    ^
""",
    ),
    (
        "a body that is ground twice, in two places",
        one_body([], [], ["1 0 0 0 0 0 0", "1 0 0 1 0 0 0"]),
        r"""
IN.dat:1:1: error: counts: 1 body has 6 coordinates, but the constraints and drivers give 12 equations, 6 too many
    1 0 0 0 0 0 0 0 0 0 0 2
    ^
IN.dat:2:1: note: body 1: 6 coordinates, 12 equations, 6 too many
    0 0 0 1 0 0 0
    ^
IN.dat:4:1: error: ground 2: body 1 is already ground 1, at another position; remove one of them
    1 0 0 1 0 0 0
    ^
""",
    ),
    (
        "a turned body whose other angle is not zero",
        one_body(["1 4 0 1 0"], ["1 1 0", "1 2 0", "1 3 0", "1 5 0.5", "1 6 0"]),
        r"""
IN.dat:7:1: error: simplified constraint 4: driver 1 turns body 1 about one axis, so the angle about y must be 0; read 0.5
    1 5 0.5
    ^
""",
    ),
    (
        "a coordinate driven twice by two laws",
        one_body(["1 1 0 1 0", "1 1 0 2 0"], ["1 3 0", "1 4 0", "1 5 0", "1 6 0"]),
        r"""
IN.dat:4:1: error: driver 2: x of body 1 is already moved by driver 1; remove one of them
    1 1 0 2 0
    ^
""",
    ),
    (
        "a coordinate driven twice by one law",
        one_body(["1 1 0 1 0", "1 1 0 1 0"], ["1 3 0", "1 4 0", "1 5 0", "1 6 0"]),
        r"""
IN.dat:4:1: warning: driver 2: x of body 1 is already moved the same way by driver 1; this equation is redundant
    1 1 0 1 0
    ^
""",
    ),
    (
        "a difference of Euler parameters above 2",
        """2 0 0 0 0 0 0 0 0 5 1 1
0 0 0 1 0 0 0
0 0 0 1 0 0 0
2 1 0
2 2 0
2 3 0
2 4 0
2 5 0
1 2 6 90
1 0 0 0 0 0 0
0 1 1
""",
        r"""
IN.dat:9:7: error: distance constraint 1: Euler parameters differ by 2 at most; read 90
    1 2 6 90
          ^^
""",
    ),
]


@pytest.mark.parametrize(("deck", "text"), [case[1:] for case in CASES], ids=[case[0] for case in CASES])
def test_a_model_with(deck, text):
    assert shown(deck) == text.strip("\n")


PARALLELOGRAM = """4 1 0 0 0 4 0 0 0 0 0 1
0 0 0 0.7071067812 0 0 0.7071067812
0 1 0 1 0 0 0
2 0 0 0.7071067812 0 0 0.7071067812
0 0 0 1 0 0 0
1 6 1.570796327 1 0
4 1 0 0 0 0 0 0 0 0 1 0 0 1
1 2 1 0 0 0 0 0 1 0 1 0 0 1
2 3 2 0 0 1 0 0 2 0 1 1 0 1
4 3 2 0 0 0 0 0 2 0 1 0 0 1
4 0 0 0 0 0 0
0 1 0.5
"""


def test_the_remedy_for_a_planar_loop_of_revolutes_is_named_and_holds():
    """Four revolute joints in a plane: 3 of their 20 equations repeat others (Grübler: 3 · 3 - 2 · 4 = 1 DOF).

    With one of them spherical and one cylindrical the counts balance.
    """
    text = shown(PARALLELOGRAM)
    assert "27 equations, 3 too many" in text
    assert "note: in a loop that moves in a plane, 3 equations of revolute and translational joints" in text
    counts, *rest = PARALLELOGRAM.splitlines()
    counts = counts.replace("1 0 0 0 4 0", "1 0 1 0 2 1")
    joints = ["2 3 2 0 0 1 0 0", rest[5], rest[6], rest[8]]
    remedied = "\n".join([counts, *rest[:5], *joints, *rest[9:], ""])
    assert shown(remedied) == ""


def test_three_equations_too_many_without_a_loop_get_no_advice_on_planar_loops():
    """A pendulum that three simplified constraints hold beside its driver."""
    deck = pendulum(1, "2 1 0 0 0 1 0 0 0 3 0 1").replace("-1 0\n", "-1 0\n2 1 0\n2 2 1\n2 3 0\n")
    assert "3 too many" in shown(deck) and "plane" not in shown(deck)
