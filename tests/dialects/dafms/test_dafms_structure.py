"""Decks of FMBD.DAT whose counts and lists do not fit together, or which end early."""

import pytest

from tests.dialects.dafms.dafms_decks import deck_text, reported

CASES = [
    pytest.param(
        deck_text("two_link_n2", ("    2    2\nDFMB", "    0    2\nDFMB")),
        ["1:5: error: counts: N = 0 bodies, need at least 1"],
        id="no body at all",
    ),
    pytest.param(
        deck_text("two_link_n2", ("    2    2\nDFMB", "    2    4\nDFMB")),
        ["1:10: error: counts: NDM = 4, the dimension is 2 or 3"],
        id="a dimension other than 2 and 3",
    ),
    pytest.param(
        deck_text(
            "two_link_n2", ("    2    1    1    0    0\n    2    2", "    2    2    1    0    0\n    2    2")
        ),
        ["6:10: error: NR of body 2: NR = 2, but 1 of its three flags are 1: they must agree"],
        id="a count that differs from its flags",
    ),
    pytest.param(
        deck_text(
            "two_link_n2", ("    2    1    1    0    0\n    2    2", "    2    2    2    0    0\n    2    2")
        ),
        ["6:15: error: NR of body 2: NR1 is a flag, 0 or 1, read 2"],
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
            )
        ],
        id="nodes out of order",
    ),
    pytest.param(
        deck_text("two_link_n2", ("    1    1\n  500", "    1    4\n  500")),
        [
            "8:10: error: body 2: NDF = 4: a node has 1 (axis 3), 2 (axes 2, 3) or 3 "
            "elastic degrees of freedom"
        ],
        id="more than three degrees of freedom of a node",
    ),
    pytest.param(
        deck_text("two_link_n2", ("    2    2\n    1    1\n  500", "    2   -2\n    1    1\n  500")),
        ["7:9: error: body 2: NUMNP = -2: a body has 0 nodes (rigid) or more"],
        id="a negative number of nodes",
    ),
    pytest.param(
        deck_text("two_link_n2", ("    1    2\n    1    3\n109714", "    1    2\n    2    3\n109714")),
        [
            (
                "17:5: error: JDI of body 1: JDI(1) = 2 is not the address of a diagonal, expected 1: a "
                "column holds at most as many entries as its number, the diagonal last"
            )
        ],
        id="a first address other than 1",
    ),
    pytest.param(
        deck_text("two_link_n2", ("    1    2\n    1    3\n109714", "    1    2\n    1    4\n109714")),
        [
            (
                "17:10: error: JDI of body 1: JDI(2) = 4 is not the address of a diagonal, expected 2 to 3: "
                "a column holds at most as many entries as its number, the diagonal last"
            )
        ],
        id="an address that skips too far",
    ),
    pytest.param(
        "",
        ["1:1: error: counts: unexpected end of the deck, expected N, NDM; FORMAT(2I5)"],
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
        deck_text("two_link_n2", ("DFMB FLEX", "STOP FLEX")),
        ["2:1: error: card 'STOP' stands before any model; a model begins with a DFMB card"],
        id="STOP before any model",
    ),
    pytest.param(
        "    2    2\nDFMB\n    1    0    0    0    0\n",
        ["3:26: error: NT of body 2: unexpected end of the deck, expected KK ... NT3; FORMAT(10I5)"],
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
            )
        ],
        id="the deck ends among the stiffness",
    ),
]


@pytest.mark.parametrize(("text", "expected"), CASES)
def test_bad_decks_are_told_exactly(text, expected):
    assert reported(text) == expected
