"""Times, loads and prescribed coordinates of FMBD.DAT that cannot be meant, or are doubtful."""

import pytest

from tests.dialects.dafms.dafms_decks import deck_text, reported

CASES = [
    pytest.param(
        deck_text("pendulum_strict", ("\n 6000\n", "\n    0\n")),
        ["7:5: error: time: IT = 0 integration steps, need at least 1"],
        id="no step at all",
    ),
    pytest.param(
        deck_text("pendulum_strict", ("       .01\n", "       0.0\n")),
        ["8:8: error: time: H = 0.0 s: the length of a step must be above zero"],
        id="a step without length",
    ),
    pytest.param(
        deck_text("pendulum_strict", ("RC(K\n    1       0.0", "RC(K\n    1        .1")),
        ["37:14: warning: body 1: RC is not used: the nodes of a flexible body say where its mass is"],
        id="a mass centre of a flexible body",
    ),
    pytest.param(
        deck_text("shaft_beam_n2", ("       1.0       .05\nGRAV", "       1.0       0.0\nGRAV")),
        ["42:28: error: DESN of body 1: TIME = 0.0: the pulse must last longer than zero"],
        id="a pulse without length",
    ),
    pytest.param(
        deck_text("shaft_beam_n2", ("DESN\n    1    1", "DESN\n    1    2")),
        [
            (
                "42:10: warning: DESN of body 1: IDS = 2: only law 1, the pulse, is known; it is taken,"
                " as DAFMS does"
            )
        ],
        id="an unknown law of torque",
    ),
    pytest.param(
        deck_text("shaft_beam_n2", ("END \n", "TOQU\n    1       2.0       0.0       0.0\nEND \n")),
        ["46:13: warning: body 1: HM1 = 2.0 of TOQU is replaced by the pulse of DESN"],
        id="a torque replaced by a pulse",
    ),
    pytest.param(
        deck_text("spatial_rigid", ("END \n", "SPRI\n    1\n    2    1      10.0\nEND \n")),
        ["44:10: error: spring 1: A = 1: rotation 1 of the hinge of body 2 is not free"],
        id="a spring on a held axis",
    ),
    pytest.param(
        deck_text("spatial_rigid", ("END \n", "SPRI\n    1\n    1    1      10.0\nEND \n")),
        [("44:5: error: spring 1: the hinge of body 1 has three free rotations: none of them is an angle")],
        id="a spring on a hinge of three rotations",
    ),
    pytest.param(
        deck_text("spatial_rigid", ("END \n", "DAMP\n    1\n    1    7      10.0\nEND \n")),
        ["44:10: error: damper 1: A = 7: 1-3 are rotations, 4-6 translations of a hinge"],
        id="a damper on a freedom that does not exist",
    ),
    pytest.param(
        deck_text("spatial_rigid", ("END \n", "MOTR\n    1\n    3    1      10.0\nEND \n")),
        ["44:5: error: motor 1: K = 3: there are bodies 1 to 2"],
        id="a motor on a body that does not exist",
    ),
    pytest.param(
        deck_text(
            "sliding_mass", ("END \n", "PRES\n    2\n    2    5        .1\n    2    5        .1\nEND \n")
        ),
        ["44:5: error: PRES: translation 2 of the hinge of body 2 is prescribed twice"],
        id="a coordinate prescribed twice",
    ),
    pytest.param(
        deck_text("sliding_mass", ("END \n", "PRES\n    1\n    2    5        .2\nEND \n")),
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
        ["46:7: error: motor table 1: t(2) = -1.0 lies before t(1) = 0.0"],
        id="a table that runs backwards",
    ),
    pytest.param(
        deck_text("spatial_rigid", ("END \n", "TABL\n    1\n    2    4    1\n       0.0       1.0\nEND \n")),
        ["44:10: error: torque table 1: A = 4: the torque acts about inertial axis 1, 2 or 3"],
        id="a torque table about no axis",
    ),
]


@pytest.mark.parametrize(("text", "expected"), CASES)
def test_bad_decks_are_told_exactly(text, expected):
    assert reported(text) == expected
