"""Closures, integrators, masses and starts of FMBD.DAT that cannot be meant, or are doubtful."""

import pytest

from tests.dialects.dafms.dafms_decks import deck_text, reported

CASES = [
    pytest.param(
        deck_text(
            "fourbar_rigid", ("    3    0    0    0    0    1    1", "    3    0    3    0    0    1    1")
        ),
        ["54:15: error: closure 1: KA = KB = 3: a closure joins two bodies"],
        id="a closure of a body with itself",
    ),
    pytest.param(
        deck_text(
            "fourbar_rigid", ("    3    0    0    0    0    1    1", "    4    0    0    0    0    1    1")
        ),
        ["54:5: error: closure 1: KA = 4: there are bodies 1 to 3"],
        id="a closure of a body that does not exist",
    ),
    pytest.param(
        deck_text(
            "fourbar_rigid", ("    3    0    0    0    0    1    1", "    0    0    3    0    0    1    1")
        ),
        [
            "54:5: error: closure 1: KA = 0: there are bodies 1 to 3; "
            "the inertial frame goes second, as KB = 0"
        ],
        id="a closure whose first body is the inertial frame",
    ),
    pytest.param(
        deck_text(
            "fourbar_rigid", ("    3    0    0    0    0    1    1", "    3    0    0    0    0    0    0")
        ),
        ["54:25: error: closure 1: C1, C2, C3 are all 0: nothing is closed"],
        id="a closure that closes nothing",
    ),
    pytest.param(
        deck_text(
            "fourbar_rigid", ("    3    0    0    0    0    1    1", "    3    0    0    0    0    1    2")
        ),
        ["54:35: error: closure 1: C3 is a flag, 0 or 1, read 2"],
        id="a closure flag other than 0 and 1",
    ),
    pytest.param(
        deck_text(
            "fourbar_rigid", ("    3    0    0    0    0    1    1", "    3    1    0    0    0    1    1")
        ),
        ["54:10: error: closure 1: NA = 1, but body 3 has 0 nodes; 0 takes the vector"],
        id="a closure at a node of a rigid body",
    ),
    pytest.param(
        deck_text("pendulum_strict", ("END \n", "METH\n    5\nEND \n")),
        ["39:5: error: METH: METH = 5 is not an integrator: 1 dop853, 2 radau, 3 lsoda, 4 sdirk4"],
        id="an integrator that does not exist",
    ),
    pytest.param(
        deck_text("pendulum_strict", ("END \n", "TOLR\n     -1.0E-06       1.E-09\nEND \n")),
        ["39:6: error: TOLR: RTOL = -1e-06, ATOL = 1e-09: tolerances lie above 0, RTOL below 1"],
        id="a negative tolerance",
    ),
    pytest.param(
        deck_text("pendulum_strict", ("END \n", "ELDA\n    1      -0.1       0.0\nEND \n")),
        ["39:12: error: body 1: ALPHA = -0.1, BETA = 0.0: negative damping feeds energy in"],
        id="negative damping",
    ),
    pytest.param(
        deck_text(
            "spatial_rigid",
            ("END \n", "ELDA\n    1       0.1\n    2       0.0\nGSTF\n    1    0\n    2    1\nEND \n"),
        ),
        [
            "43:13: warning: body 1: ELDA is not used: the body is rigid, NUMNP = 0",
            "47:10: warning: body 2: GSTF is not used: the body is rigid, NUMNP = 0",
        ],
        id="cards of flexible bodies for rigid ones",
    ),
    pytest.param(
        deck_text(
            "spatial_rigid",
            (
                "END \n",
                "PROD\n    1        .2       0.0       0.0\n    2       0.0       0.0       0.0\nEND \n",
            ),
        ),
        [
            (
                "43:14: error: body 1: PROD and INER give a principal moment of inertia of -0.07361 kg m^2,"
                " and no mass has a negative one: both are about O_k, I12 is -∫ x1 x2 dm"
            )
        ],
        id="products of inertia larger than any mass has",
    ),
    pytest.param(
        deck_text("spatial_rigid", ("END \n", "DAMP\n    1\n    2    3      -0.5\nEND \n")),
        ["44:17: warning: damper 1: CS = -0.5: a negative damper feeds energy in"],
        id="a negative damper",
    ),
    pytest.param(
        deck_text("shaft_beam_n2", ("END \n", "GSTF\n    1    1       0.4\nEND \n")),
        [
            (
                "46:10: error: GSTF of body 1: IGS = 1: geometric stiffening is that of a straight beam: its"
                " nodes have to lie apart on one line from O_k, all farther out than the clamped end, RA ="
                " 0.4 m"
            )
        ],
        id="stiffening of a beam that is clamped beyond its first node",
    ),
    pytest.param(
        deck_text(
            "pendulum_strict",
            ("END \n", "NROT\n    1\n    1    2\n          1.0\n          0.0\n          0.0\nEND \n"),
        ),
        ["40:10: error: nodal rotation 1: I = 2: body 1 has nodes 1 to 1"],
        id="a rotation of a node that does not exist",
    ),
    pytest.param(
        deck_text("pendulum_strict", ("END \n", "FORC\n    1    1.E+60\nEND \n")),
        ["39:10: error: force.1.HF1: 1e+60 is too large: numbers end at 1e+50"],
        id="a number too large to compute with",
    ),
    pytest.param(
        deck_text("pendulum_strict", ("Y(L)\n       0.0       0.0-1.5607963       .14\n", "")),
        [
            "1:5: warning: card 'Y(L)' is missing: the motion starts at rest from zero coordinates",
            "29:6: warning: body 1: EULT is not used: the angle 0.0 rad in Y(L) applies (coordinate 1)",
            "33:1: warning: X(L): X(1) = -1.5607963 is not used: Y(L) gives 0.0 for this coordinate",
        ],
        id="Y(L) is missing",
    ),
    pytest.param(
        deck_text("pendulum_strict", ("X(L)\n-1.5607963       .14", "X(L)\n-1.5607963       .15")),
        ["33:18: warning: X(L): X(2) = 0.15 is not used: Y(L) gives 0.14 for this coordinate"],
        id="X(L) that Y(L) contradicts",
    ),
    pytest.param(
        deck_text(
            "sliding_mass",
            ("    2    1    0    1    0\n", "    2    0    0    0    0\n"),
            ("    1    1    1    0    0\n", "    1    0    0    0    0\n"),
            ("Y(L)\n       2.0      -1.0       1.0        .1\n", ""),
            ("X(L)\n       1.0        .1\n", ""),
        ),
        [
            "1:5: warning: card 'Y(L)' is missing: the motion starts at rest from zero coordinates",
            "1:5: error: counts: no hinge is free and no body is flexible: nothing can move",
        ],
        id="nothing that can move",
    ),
]


@pytest.mark.parametrize(("text", "expected"), CASES)
def test_bad_decks_are_told_exactly(text, expected):
    assert reported(text) == expected
