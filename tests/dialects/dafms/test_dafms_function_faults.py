"""Loads, drives, closures and start of FMBD.DAT that cannot be meant, or are doubtful."""

import pytest

from tests.dialects.dafms.dafms_decks import deck_text, reported

CASES = [
    pytest.param(
        deck_text(
            "pendulum_strict",
            ("\n 6000\n", "\n    0\n"),
        ),
        [
            "7:5: error: time: IT = 0 integration steps, need at least 1",
        ],
        id="no step at all",
    ),
    pytest.param(
        deck_text(
            "pendulum_strict",
            ("       .01\n", "       0.0\n"),
        ),
        [
            "8:8: error: time: H = 0.0 s: the length of a step must be above zero",
        ],
        id="a step without length",
    ),
    pytest.param(
        deck_text(
            "pendulum_strict",
            ("RC(K\n    1       0.0", "RC(K\n    1        .1"),
        ),
        [
            "37:14: warning: body 1: RC is not used: the nodes of a flexible body say where its mass is",
        ],
        id="a mass centre of a flexible body",
    ),
    pytest.param(
        deck_text(
            "shaft_beam_n2",
            ("       1.0       .05\nGRAV", "       1.0       0.0\nGRAV"),
        ),
        [
            "42:28: error: DESN of body 1: TIME = 0.0: the pulse must last longer than zero",
        ],
        id="a pulse without length",
    ),
    pytest.param(
        deck_text(
            "shaft_beam_n2",
            ("DESN\n    1    1", "DESN\n    1    2"),
        ),
        [
            (
                "42:10: warning: DESN of body 1: IDS = 2: only law 1, the pulse, is known; it is taken,"
                " as DAFMS does"
            ),
        ],
        id="an unknown law of torque",
    ),
    pytest.param(
        deck_text(
            "shaft_beam_n2",
            ("END \n", "TOQU\n    1       2.0       0.0       0.0\nEND \n"),
        ),
        [
            "46:13: warning: body 1: HM1 = 2.0 of TOQU is replaced by the pulse of DESN",
        ],
        id="a torque replaced by a pulse",
    ),
    pytest.param(
        deck_text(
            "spatial_rigid",
            ("END \n", "SPRI\n    1\n    2    1      10.0\nEND \n"),
        ),
        [
            "44:10: error: spring 1: A = 1: rotation 1 of the hinge of body 2 is not free",
        ],
        id="a spring on a held axis",
    ),
    pytest.param(
        deck_text(
            "spatial_rigid",
            ("END \n", "SPRI\n    1\n    1    1      10.0\nEND \n"),
        ),
        [
            ("44:5: error: spring 1: the hinge of body 1 has three free rotations: none of them is an angle"),
        ],
        id="a spring on a hinge of three rotations",
    ),
    pytest.param(
        deck_text(
            "spatial_rigid",
            ("END \n", "DAMP\n    1\n    1    7      10.0\nEND \n"),
        ),
        [
            "44:10: error: damper 1: A = 7: 1-3 are rotations, 4-6 translations of a hinge",
        ],
        id="a damper on a freedom that does not exist",
    ),
    pytest.param(
        deck_text(
            "spatial_rigid",
            ("END \n", "MOTR\n    1\n    3    1      10.0\nEND \n"),
        ),
        [
            "44:5: error: motor 1: K = 3: there are bodies 1 to 2",
        ],
        id="a motor on a body that does not exist",
    ),
    pytest.param(
        deck_text(
            "sliding_mass",
            ("END \n", "PRES\n    2\n    2    5        .1\n    2    5        .1\nEND \n"),
        ),
        [
            "44:5: error: PRES: translation 2 of the hinge of body 2 is prescribed twice",
        ],
        id="a coordinate prescribed twice",
    ),
    pytest.param(
        deck_text(
            "sliding_mass",
            ("END \n", "PRES\n    1\n    2    5        .2\nEND \n"),
        ),
        [
            (
                "37:17: warning: Y(L): speed 2 (body 2 translation 2) is -1.0 in Y(L), but PRES starts "
                "it at 0.0"
            ),
            (
                "37:39: warning: Y(L): coordinate 2 (body 2 translation 2) is 0.1 in Y(L), but PRES "
                "starts it at 0.2"
            ),
        ],
        id="a prescribed start that Y(L) contradicts",
    ),
    pytest.param(
        deck_text(
            "spatial_rigid",
            ("END \n", "TABM\n    1\n    2    3    2\n       0.0       1.0\n      -1.0       2.0\nEND \n"),
        ),
        [
            "46:7: error: motor table 1: t(2) = -1.0 lies before t(1) = 0.0",
        ],
        id="a table that runs backwards",
    ),
    pytest.param(
        deck_text(
            "spatial_rigid",
            ("END \n", "TABL\n    1\n    2    4    1\n       0.0       1.0\nEND \n"),
        ),
        [
            "44:10: error: torque table 1: A = 4: the torque acts about inertial axis 1, 2 or 3",
        ],
        id="a torque table about no axis",
    ),
    pytest.param(
        deck_text(
            "fourbar_rigid",
            ("    3    0    0    0    0    1    1", "    3    0    3    0    0    1    1"),
        ),
        [
            "54:15: error: closure 1: KA = KB = 3: a closure joins two bodies",
        ],
        id="a closure of a body with itself",
    ),
    pytest.param(
        deck_text(
            "fourbar_rigid",
            ("    3    0    0    0    0    1    1", "    4    0    0    0    0    1    1"),
        ),
        [
            "54:5: error: closure 1: KA = 4: there are bodies 1 to 3",
        ],
        id="a closure of a body that does not exist",
    ),
    pytest.param(
        deck_text(
            "fourbar_rigid",
            ("    3    0    0    0    0    1    1", "    0    0    3    0    0    1    1"),
        ),
        [
            "54:5: error: closure 1: KA = 0: there are bodies 1 to 3; "
            "the inertial frame goes second, as KB = 0",
        ],
        id="a closure whose first body is the inertial frame",
    ),
    pytest.param(
        deck_text(
            "fourbar_rigid",
            ("    3    0    0    0    0    1    1", "    3    0    0    0    0    0    0"),
        ),
        [
            "54:25: error: closure 1: C1, C2, C3 are all 0: nothing is closed",
        ],
        id="a closure that closes nothing",
    ),
    pytest.param(
        deck_text(
            "fourbar_rigid",
            ("    3    0    0    0    0    1    1", "    3    0    0    0    0    1    2"),
        ),
        [
            "54:35: error: closure 1: C3 is a flag, 0 or 1, read 2",
        ],
        id="a closure flag other than 0 and 1",
    ),
    pytest.param(
        deck_text(
            "fourbar_rigid",
            ("    3    0    0    0    0    1    1", "    3    1    0    0    0    1    1"),
        ),
        [
            "54:10: error: closure 1: NA = 1, but body 3 has 0 nodes; 0 takes the vector",
        ],
        id="a closure at a node of a rigid body",
    ),
    pytest.param(
        deck_text(
            "pendulum_strict",
            ("END \n", "METH\n    5\nEND \n"),
        ),
        [
            "39:5: error: METH: METH = 5 is no integrator: 1 dop853, 2 radau, 3 lsoda, 4 sdirk4",
        ],
        id="an integrator that does not exist",
    ),
    pytest.param(
        deck_text(
            "pendulum_strict",
            ("END \n", "TOLR\n     -1.0E-06       1.E-09\nEND \n"),
        ),
        [
            "39:6: error: TOLR: RTOL = -1e-06, ATOL = 1e-09: tolerances lie above 0, RTOL below 1",
        ],
        id="a negative tolerance",
    ),
    pytest.param(
        deck_text(
            "pendulum_strict",
            ("END \n", "ELDA\n    1      -0.1       0.0\nEND \n"),
        ),
        [
            "39:12: error: body 1: ALPHA = -0.1, BETA = 0.0: negative damping feeds energy in",
        ],
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
            ),
        ],
        id="products of inertia larger than any mass has",
    ),
    pytest.param(
        deck_text(
            "spatial_rigid",
            ("END \n", "DAMP\n    1\n    2    3      -0.5\nEND \n"),
        ),
        [
            "44:17: warning: damper 1: CS = -0.5: a negative damper feeds energy in",
        ],
        id="a negative damper",
    ),
    pytest.param(
        deck_text(
            "shaft_beam_n2",
            ("END \n", "GSTF\n    1    1       0.4\nEND \n"),
        ),
        [
            (
                "46:10: error: GSTF of body 1: IGS = 1: geometric stiffening is that of a straight beam: its"
                " nodes have to lie apart on one line from O_k, all farther out than the clamped end, RA ="
                " 0.4 m"
            ),
        ],
        id="stiffening of a beam that is clamped beyond its first node",
    ),
    pytest.param(
        deck_text(
            "pendulum_strict",
            ("END \n", "NROT\n    1\n    1    2\n          1.0\n          0.0\n          0.0\nEND \n"),
        ),
        [
            "40:10: error: nodal rotation 1: I = 2: body 1 has nodes 1 to 1",
        ],
        id="a rotation of a node that does not exist",
    ),
    pytest.param(
        deck_text(
            "pendulum_strict",
            ("END \n", "FORC\n    1    1.E+60\nEND \n"),
        ),
        [
            "39:10: error: force.1.HF1: 1e+60 is too large: numbers end at 1e+50",
        ],
        id="a number too large to compute with",
    ),
    pytest.param(
        deck_text(
            "pendulum_strict",
            ("Y(L)\n       0.0       0.0-1.5607963       .14\n", ""),
        ),
        [
            "1:5: warning: card 'Y(L)' is missing: the motion starts at rest from zero coordinates",
            "29:6: warning: body 1: EULT is not used: the angle 0.0 rad in Y(L) rules (coordinate 1)",
            "33:1: warning: X(L): X(1) = -1.5607963 is not used: Y(L) gives 0.0 for this coordinate",
        ],
        id="Y(L) is missing",
    ),
    pytest.param(
        deck_text(
            "pendulum_strict",
            ("X(L)\n-1.5607963       .14", "X(L)\n-1.5607963       .15"),
        ),
        [
            "33:18: warning: X(L): X(2) = 0.15 is not used: Y(L) gives 0.14 for this coordinate",
        ],
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
