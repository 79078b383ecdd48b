"""Decks of FMBD.DAT whose counts, lists or cards do not fit together."""

import pytest

from tests.dialects.dafms.dafms_decks import deck_text, reported

CASES = [
    pytest.param(
        deck_text(
            "two_link_n2",
            ("    2    2\nDFMB", "    0    2\nDFMB"),
        ),
        [
            "1:5: error: counts: N = 0 bodies, need at least 1",
        ],
        id="no body at all",
    ),
    pytest.param(
        deck_text(
            "two_link_n2",
            ("    2    2\nDFMB", "    2    4\nDFMB"),
        ),
        [
            "1:10: error: counts: NDM = 4, the dimension is 2 or 3",
        ],
        id="a dimension other than 2 and 3",
    ),
    pytest.param(
        deck_text(
            "two_link_n2",
            ("    2    1    1    0    0\n    2    2", "    2    2    1    0    0\n    2    2"),
        ),
        [
            "6:10: error: NR of body 2: NR = 2, but 1 of its three flags are 1: they must agree",
        ],
        id="a count that differs from its flags",
    ),
    pytest.param(
        deck_text(
            "two_link_n2",
            ("    2    1    1    0    0\n    2    2", "    2    2    2    0    0\n    2    2"),
        ),
        [
            "6:15: error: NR of body 2: NR1 is a flag, 0 or 1, read 2",
        ],
        id="a flag other than 0 and 1",
    ),
    pytest.param(
        deck_text(
            "two_link_n2",
            ("MASS\n    1       5.0\n    2       5.0", "MASS\n    2       5.0\n    1       5.0"),
        ),
        [
            (
                "32:5: error: MASS of body 1: the record is numbered 2, expected 1: records are stored "
                "in the order of the bodies"
            ),
            (
                "33:5: error: MASS of body 2: the record is numbered 1, expected 2: records are stored "
                "in the order of the bodies"
            ),
        ],
        id="bodies out of order",
    ),
    pytest.param(
        deck_text(
            "two_link_n2",
            (
                "    2       1.0       0.0\n    1       0.0       0.0",
                "    3       1.0       0.0\n    1       0.0       0.0",
            ),
        ),
        [
            (
                "12:5: error: CO of node 2 of body 1: the record is numbered 3, expected 2: records are"
                " stored in the order of the nodes"
            ),
        ],
        id="nodes out of order",
    ),
    pytest.param(
        deck_text(
            "two_link_n2",
            ("    1    1\n  500", "    1    4\n  500"),
        ),
        [
            "8:10: error: body 2: NDF = 4: a node has 1 (axis 3), 2 (axes 2, 3) or 3 "
            "elastic degrees of freedom",
        ],
        id="more than three degrees of freedom of a node",
    ),
    pytest.param(
        deck_text(
            "two_link_n2",
            ("    2    2\n    1    1\n  500", "    2   -2\n    1    1\n  500"),
        ),
        [
            "7:9: error: body 2: NUMNP = -2: a body has 0 nodes (rigid) or more",
        ],
        id="a negative number of nodes",
    ),
    pytest.param(
        deck_text(
            "two_link_n2",
            ("    1    2\n    1    3\n109714", "    1    2\n    2    3\n109714"),
        ),
        [
            (
                "17:5: error: JDI of body 1: JDI(1) = 2 is no diagonal's address, expected 1: a column "
                "holds at most as many entries as its number, the diagonal last"
            ),
        ],
        id="a first address other than 1",
    ),
    pytest.param(
        deck_text(
            "two_link_n2",
            ("    1    2\n    1    3\n109714", "    1    2\n    1    4\n109714"),
        ),
        [
            (
                "17:10: error: JDI of body 1: JDI(2) = 4 is no diagonal's address, expected 2 to 3: a "
                "column holds at most as many entries as its number, the diagonal last"
            ),
        ],
        id="an address that skips too far",
    ),
    pytest.param(
        "",
        [
            "1:1: error: counts: unexpected end of the deck, expected N, NDM; FORMAT(2I5)",
        ],
        id="an empty deck",
    ),
    pytest.param(
        "    1    2\nPENDULUM\n",
        [
            "2:1: note: unknown card 'PEND' skipped",
            "2:9: error: unexpected end of the deck, expected a DFMB card",
        ],
        id="a deck without a model",
    ),
    pytest.param(
        deck_text(
            "two_link_n2",
            ("DFMB FLEX", "STOP FLEX"),
        ),
        [
            "2:1: error: card 'STOP' stands before any model; a model begins with a DFMB card",
        ],
        id="STOP before any model",
    ),
    pytest.param(
        "    2    2\nDFMB\n    1    0    0    0    0\n",
        [
            "3:26: error: NT of body 2: unexpected end of the deck, expected KK ... NT3; FORMAT(10I5)",
        ],
        id="the deck ends among the counts",
    ),
    pytest.param(
        "    1    2\nDFMB\n    1    0    0    0    0\n    1    1    1    0    0\n    2\n    1\n    5\n       "
        ".01\n    1        .5       0.0\n    2       1.0       0.0\n    1       0.0       0.0\n    2       "
        "0.0       0.0\n    2\n    1    2\n    1    3\n",
        [
            (
                "15:11: error: BKP of body 1: unexpected end of the deck, expected BKP(1), BKP(2), "
                "BKP(3); FORMAT(6E13.5)"
            ),
        ],
        id="the deck ends among the stiffness",
    ),
    pytest.param(
        deck_text(
            "two_link_n2",
            ("END \nSTAR\nSTOP\n", ""),
        ),
        [
            "61:36: error: unexpected end of the deck, expected the card 'END '",
        ],
        id="the card END is missing",
    ),
    pytest.param(
        deck_text(
            "two_link_n2",
            ("END \nSTAR", "STAR\nEND "),
        ),
        [
            "62:1: error: card 'STAR' stands before END: the card 'END ' is missing",
        ],
        id="STAR stands before END",
    ),
    pytest.param(
        deck_text(
            "two_link_n2",
            ("STAR\nSTOP", "STAR\nDFMB\nSTOP"),
        ),
        [
            "64:1: error: a second DFMB card: of a file up to 100 models are solved, of standard input one; "
            "split the deck here",
        ],
        id="a second model",
    ),
    pytest.param(
        deck_text(
            "two_link_n2",
            ("MASS\n    1       5.0\n    2       5.0", "MASS\n    1       5.0"),
        ),
        [
            "33:1: error: MASS of body 2: card 'INER' stands where KK, BM must stand; FORMAT(I5,F10.5)",
        ],
        id="a card stands where a record is missing",
    ),
    pytest.param(
        deck_text(
            "two_link_n2",
            (
                "MASS\n    1       5.0\n    2       5.0",
                "MASS\n    1       5.0\n    2       5.0\n    3       5.0",
            ),
        ),
        [
            "34:1: warning: 1 line after card 'MASS' skipped: no card reads them",
        ],
        id="records without a card are skipped and told",
    ),
    pytest.param(
        deck_text(
            "two_link_n2",
            ("RC(K", "WIND\n    1       5.0\nRC(K"),
        ),
        [
            "59:1: note: unknown card 'WIND' skipped, with 1 line after it",
        ],
        id="an unknown card is skipped and noted",
    ),
    pytest.param(
        deck_text(
            "two_link_n2",
            ("RC(K", "rc(k"),
        ),
        [
            "59:1: warning: unknown card 'rc(k' skipped, with 2 lines after it; is 'RC(K' meant?",
        ],
        id="a card in other case is skipped with a hint",
    ),
    pytest.param(
        deck_text(
            "two_link_n2",
            ("RC(K", "FROC"),
        ),
        [
            "59:1: warning: unknown card 'FROC' skipped, with 2 lines after it; is 'FORC' meant?",
        ],
        id="a card with letters swapped is skipped with a hint",
    ),
    pytest.param(
        deck_text(
            "two_link_n2",
            ("STAR\nSTOP", "FORC\nSTAR\nSTOP"),
        ),
        [
            "63:1: warning: card 'FORC' after END is not read; put it before END",
        ],
        id="a card after END is not read",
    ),
    pytest.param(
        deck_text(
            "two_link_n2",
            ("STAR\nSTOP\n", "STAR\n"),
        ),
        [
            "63:1: warning: the deck ends without a STOP card",
        ],
        id="a deck without STOP",
    ),
    pytest.param(
        deck_text(
            "two_link_n2",
            ("STAR\nSTOP\n", "STOP\n"),
        ),
        [
            "63:1: warning: no STAR card: DAFMS reads this model and integrates nothing",
        ],
        id="a deck without STAR",
    ),
    pytest.param(
        deck_text(
            "two_link_n2",
            ("RC(K", "CONN\n    0    1\nRC(K"),
        ),
        [
            "59:1: warning: card 'CONN' replaces the one on line 29",
        ],
        id="a card given twice",
    ),
    pytest.param(
        deck_text(
            "two_link_n2",
            ("MASS\n    1       5.0", "MASS\n            5.0"),
        ),
        [
            "32:1: warning: MASS of body 1: the record's number is blank, taken as 1",
        ],
        id="a blank record number",
    ),
    pytest.param(
        deck_text(
            "fourbar_rigid",
            ("LOOP\n    1", "LOOP\n   -1"),
        ),
        [
            "53:4: error: LOOP: a count of -1 entries: 0 or more",
            "54:1: warning: 2 lines after card 'LOOP' skipped: no card reads them",
        ],
        id="a negative count of entries",
    ),
    pytest.param(
        deck_text(
            "pendulum_strict",
            ("END \n", "TABL\n    1\n    1    1    0\nEND \n"),
        ),
        [
            "40:15: error: torque table 1: NP = 0 points, a table needs at least 1",
        ],
        id="a table without points",
    ),
    pytest.param(
        deck_text(
            "fourbar_rigid",
            ("END \n", "NROT\n    1\n    1    1\nEND \n"),
        ),
        [
            "58:5: error: nodal rotation 1: K = 1 is no flexible body",
        ],
        id="rotations of a body without nodes",
    ),
]


@pytest.mark.parametrize(("text", "expected"), CASES)
def test_bad_decks_are_told_exactly(text, expected):
    assert reported(text) == expected
