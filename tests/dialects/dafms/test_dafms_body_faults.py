"""Bodies and hinges of FMBD.DAT that can be read but describe no model, or a doubtful one."""

import pytest

from tests.dialects.dafms.dafms_decks import deck_text, reported

CASES = [
    pytest.param(
        deck_text("two_link_n2", ("CONN\n    0    1", "CONN\n    0    2")),
        [
            (
                "30:10: error: body 2: L = 2: parents are numbered below their children, here 0 "
                "(inertial frame) to 1"
            )
        ],
        id="a parent with a higher number",
    ),
    pytest.param(
        deck_text("two_link_n2", ("CONN\n    0    1", "CONN\n    1    1")),
        [
            (
                "30:5: error: body 1: L = 1: parents are numbered below their children, here 0, the "
                "inertial frame"
            )
        ],
        id="body 1 hangs on another",
    ),
    pytest.param(
        deck_text("pendulum_strict", ("MASS\n    1        .2\n", "")),
        ["8:8: error: card 'MASS' is missing: it stands before 'END ', with a record for each of 1 bodies"],
        id="MASS is missing",
    ),
    pytest.param(
        deck_text("spatial_rigid", ("MASS\n    1       2.0", "MASS\n    1      -2.0")),
        ["14:12: error: body 1: BM = -2.0: a mass is not negative"],
        id="a negative mass",
    ),
    pytest.param(
        deck_text("two_link_n2", ("MASS\n    1       5.0", "MASS\n    1      1.25")),
        [
            (
                "32:12: error: body 1: BM = 1.25 kg is less than the 3.75 kg of its nodes: BM is the "
                "mass of the whole body, nodes included"
            )
        ],
        id="a mass less than that of its nodes",
    ),
    pytest.param(
        deck_text("pendulum_strict", ("\n        .2\nCONN", "\n       0.0\nCONN")),
        ["15:8: error: body 1: BMI(1) = 0.0: every node needs a mass above zero"],
        id="a node without mass",
    ),
    pytest.param(
        deck_text(
            "two_link_n2",
            (
                "34285.71428613714.2857143\n       2.5      1.25\nCONN",
                "94285.71428613714.2857143\n       2.5      1.25\nCONN",
            ),
        ),
        [
            (
                "27:27: error: body 2: the stiffness is not positive definite (smallest eigenvalue "
                "-4.409e+04 N/m, most at node 2, axis 3): BKP is the matrix of the body clamped at O_k,"
                " upper triangle by columns, each from its first row down to the diagonal"
            )
        ],
        id="a stiffness that is not positive definite",
    ),
    pytest.param(
        deck_text("two_link_n2", ("INER\n    11.90104167", "INER\n    11.66666667")),
        [
            (
                "35:6: error: body 1: INER about axis 1 is 1.66666667 kg m^2, of which its nodes take "
                "sum m x^2 = 1.875: the mass matrix is not positive definite; add the inertia of the "
                "root's half element (rho h^3/24) and of any hub, or uncouple with card UNCO"
            )
        ],
        id="an inertia that its nodes use up",
    ),
    pytest.param(
        deck_text("fourbar_rigid", ("    3.041666667", "    3.010416667")),
        [
            (
                "22:6: error: body 3: INER about axis 1 is 0.010416667 kg m^2, less than m rc^2 = "
                "0.03125 of its mass centre: INER is about O_k, not about the mass centre"
            )
        ],
        id="an inertia about the mass centre",
    ),
    pytest.param(
        deck_text("sliding_mass", ("    2        .5\nINER", "    2       0.0\nINER")),
        ["15:13: error: body 2: no mass resists its hinge along axis 2: BM = 0 kg, too little at O_k"],
        id="a body that nothing resists",
    ),
    pytest.param(
        deck_text("spatial_rigid", ("    1       .25       .05", "    1      -.25       .05")),
        ["17:12: error: body 1: BII1 = -0.25: a moment of inertia is not negative"],
        id="a negative moment of inertia",
    ),
    pytest.param(
        deck_text("two_link_n2", ("NOFP\n    1    2\n    2    2", "NOFP\n    1    2\n    2    3")),
        ["45:10: error: hinge of body 2: NP = 3 is not a node of body 1, which has 2"],
        id="a node that the parent has not",
    ),
    pytest.param(
        deck_text(
            "two_link_n2",
            ("    2       0.0       1.0       0.0\nNOFP", "    2       0.0        .9       0.0\nNOFP"),
        ),
        [
            (
                "42:13: error: hinge of body 2: Q(k) = (0, 0.9, 0) is not where node 2 of body 1 lies, "
                "(0, 1, 0); NP of record 2 is the node of the parent at which this hinge sits"
            )
        ],
        id="a hinge point that is not its node",
    ),
    pytest.param(
        deck_text("two_link_n2", ("NOFP\n    1    2\n    2    2", "NOFP\n    1    2\n    2    0")),
        [
            (
                "45:10: warning: hinge of body 2: NP is 0; node 2 of body 1 is read from record 1 of "
                "NOFP, where the 1992 listing looks: write 2 in record 2 too"
            )
        ],
        id="a node given with the parent as the listing has it",
    ),
    pytest.param(
        deck_text("two_link_n2", ("NOFP\n    1    2\n    2    2", "NOFP\n    1    0\n    2    0")),
        [
            (
                "45:10: warning: hinge of body 2: Q(k) is a point of flexible body 1 but NP names no "
                "node: the hinge does not follow the body's elastic motion"
            )
        ],
        id="a hinge on a flexible body at no node",
    ),
    pytest.param(
        deck_text(
            "spatial_rigid",
            (
                "EULL\n    1       0.0       0.0       0.0       1.0",
                "EULL\n    1       0.0       0.0       0.0       0.0",
            ),
        ),
        [
            (
                "32:13: error: EULL of body 1: four zeros are not an attitude; write 0.0 0.0 0.0 "
                "1.0 for no turn, the scalar last"
            )
        ],
        id="four zeros are no attitude",
    ),
    pytest.param(
        deck_text(
            "spatial_rigid",
            (
                "EULL\n    1       0.0       0.0       0.0       1.0",
                "EULL\n    1       0.0       0.0       0.0       1.1",
            ),
        ),
        [
            (
                "32:13: warning: EULL of body 1: the Euler parameters have length 1.1, not 1; they are "
                "normalised"
            )
        ],
        id="Euler parameters of another length",
    ),
    pytest.param(
        deck_text(
            "spatial_rigid",
            (
                "EULL\n    1       0.0       0.0       0.0       1.0",
                "EULL\n    1       1.0       0.0       0.0       0.0",
            ),
        ),
        [
            (
                "32:13: note: EULL of body 1: 1.0 0.0 0.0 0.0 is half a turn about axis 1: the scalar "
                "e4 stands last"
            )
        ],
        id="the scalar first is half a turn",
    ),
    pytest.param(
        deck_text("pendulum_strict", ("EULT\n    1-.70356242", "EULT\n    1 .70356242")),
        ["29:7: warning: body 1: EULT is not used: the angle -1.5607963 rad in Y(L) applies (coordinate 1)"],
        id="an attitude that contradicts the angle",
    ),
]


@pytest.mark.parametrize(("text", "expected"), CASES)
def test_bad_decks_are_told_exactly(text, expected):
    assert reported(text) == expected
