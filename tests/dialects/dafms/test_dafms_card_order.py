"""Decks of FMBD.DAT whose cards do not follow one another as they should."""

import pytest

from tests.dialects.dafms.dafms_decks import deck_text, reported

CASES = [
    pytest.param(
        deck_text("two_link_n2", ("END \nSTAR\nSTOP\n", "")),
        ["61:36: error: unexpected end of the deck, expected the card 'END '"],
        id="the card END is missing",
    ),
    pytest.param(
        deck_text("two_link_n2", ("END \nSTAR", "STAR\nEND ")),
        ["62:1: error: card 'STAR' stands before END: the card 'END ' is missing"],
        id="STAR stands before END",
    ),
    pytest.param(
        deck_text("two_link_n2", ("STAR\nSTOP", "STAR\nDFMB\nSTOP")),
        [
            "64:1: error: a second DFMB card: of a file up to 100 models are solved, of standard input one; "
            "split the deck here"
        ],
        id="a second model",
    ),
    pytest.param(
        deck_text("two_link_n2", ("MASS\n    1       5.0\n    2       5.0", "MASS\n    1       5.0")),
        ["33:1: error: MASS of body 2: card 'INER' stands where KK, BM must stand; FORMAT(I5,F10.5)"],
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
        ["34:1: warning: 1 line after card 'MASS' skipped: no card reads them"],
        id="records without a card are skipped and told",
    ),
    pytest.param(
        deck_text("two_link_n2", ("RC(K", "WIND\n    1       5.0\nRC(K")),
        ["59:1: note: unknown card 'WIND' skipped, with 1 line after it"],
        id="an unknown card is skipped and noted",
    ),
    pytest.param(
        deck_text("two_link_n2", ("RC(K", "rc(k")),
        ["59:1: warning: unknown card 'rc(k' skipped, with 2 lines after it; is 'RC(K' meant?"],
        id="a card in other case is skipped with a hint",
    ),
    pytest.param(
        deck_text("two_link_n2", ("RC(K", "FROC")),
        ["59:1: warning: unknown card 'FROC' skipped, with 2 lines after it; is 'FORC' meant?"],
        id="a card with letters swapped is skipped with a hint",
    ),
    pytest.param(
        deck_text("two_link_n2", ("STAR\nSTOP", "FORC\nSTAR\nSTOP")),
        ["63:1: warning: card 'FORC' after END is not read; put it before END"],
        id="a card after END is not read",
    ),
    pytest.param(
        deck_text("two_link_n2", ("STAR\nSTOP\n", "STAR\n")),
        ["63:1: warning: the deck ends without a STOP card"],
        id="a deck without STOP",
    ),
    pytest.param(
        deck_text("two_link_n2", ("STAR\nSTOP\n", "STOP\n")),
        ["63:1: warning: no STAR card: DAFMS reads this model and integrates nothing"],
        id="a deck without STAR",
    ),
    pytest.param(
        deck_text("two_link_n2", ("RC(K", "CONN\n    0    1\nRC(K")),
        ["59:1: warning: card 'CONN' replaces the one on line 29"],
        id="a card given twice",
    ),
    pytest.param(
        deck_text("two_link_n2", ("MASS\n    1       5.0", "MASS\n            5.0")),
        ["32:1: warning: MASS of body 1: the record's number is blank, taken as 1"],
        id="a blank record number",
    ),
    pytest.param(
        deck_text("fourbar_rigid", ("LOOP\n    1", "LOOP\n   -1")),
        [
            "53:4: error: LOOP: a count of -1 entries: 0 or more",
            "54:1: warning: 2 lines after card 'LOOP' skipped: no card reads them",
        ],
        id="a negative count of entries",
    ),
    pytest.param(
        deck_text("pendulum_strict", ("END \n", "TABL\n    1\n    1    1    0\nEND \n")),
        ["40:15: error: torque table 1: NP = 0 points, a table needs at least 1"],
        id="a table without points",
    ),
    pytest.param(
        deck_text("fourbar_rigid", ("END \n", "NROT\n    1\n    1    1\nEND \n")),
        ["58:5: error: nodal rotation 1: K = 1 is not a flexible body"],
        id="rotations of a body without nodes",
    ),
]


@pytest.mark.parametrize(("text", "expected"), CASES)
def test_bad_decks_are_told_exactly(text, expected):
    assert reported(text) == expected
