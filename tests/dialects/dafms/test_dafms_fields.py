"""Fields of FMBD.DAT that hold no number, or one that was hardly meant: place, FORMAT, remedy."""

import pytest

from tests.dialects.dafms.dafms_decks import deck_text, reported

CASES = [
    pytest.param(
        deck_text("two_link_n2", ("MASS\n    1       5.0", "MASS\n    1       5.O")),
        [
            (
                "32:13: error: MASS of body 1: BM in columns 6-15 must be a real number, read '5.O' "
                "(letter O instead of zero?); FORMAT(I5,F10.5)"
            )
        ],
        id="a letter O in a real is pointed at",
    ),
    pytest.param(
        deck_text("two_link_n2", ("CONN\n    0    1", "CONN\n    0    l")),
        [
            (
                "30:10: error: CONN: L in columns 6-10 must be an integer, read 'l' (letter l or I "
                "instead of one?); FORMAT(10I5)"
            )
        ],
        id="a letter l in an integer is pointed at",
    ),
    pytest.param(
        deck_text("two_link_n2", ("MASS\n    1       5.0", "MASS\n    1,      5.0")),
        [
            (
                "32:6: error: MASS of body 1: BM in columns 6-15 must be a real number, read ',      "
                "5.0' (a comma ends no field: cards are cut by column); FORMAT(I5,F10.5)"
            )
        ],
        id="a comma ends no field",
    ),
    pytest.param(
        deck_text("two_link_n2", ("MASS\n    1       5.0", "MASS\n1\t5.0")),
        [
            (
                "32:1: error: MASS of body 1: KK in columns 1-5 must be an integer, read '1\t5.0' (a tab"
                " counts as one column: use blanks); FORMAT(I5,F10.5)"
            )
        ],
        id="a tab counts as one column",
    ),
    pytest.param(
        deck_text("two_link_n2", ("\n  500\n", "\n500.0\n")),
        [
            (
                "9:1: error: time: IT in columns 1-5 must be an integer, read '500.0' (write it without"
                " point and exponent); FORMAT(I5)"
            )
        ],
        id="a real does not fit an integer field",
    ),
    pytest.param(
        deck_text("two_link_n2", ("NOFP\n    1    2", "NOFP\n     1  2")),
        [
            (
                "44:6: warning: NOFP of body 1: NP in columns 6-10: '1  2' is read as 12: blanks inside"
                " a number are ignored; FORMAT(I5,I5)"
            ),
            "44:1: warning: NOFP of body 1: the record's number is blank, taken as 1",
        ],
        id="a number over the edge of its field is cut and told",
    ),
    pytest.param(
        deck_text("two_link_n2", ("XI  \n    1       0.0", "XI  \n    1   0.0 1.0")),
        [
            (
                "38:9: error: XI of body 1: XI1 in columns 6-15 must be a real number, read '0.0 1.0' "
                "(two numbers in one field?); FORMAT(I5,3F10.5)"
            )
        ],
        id="a real with two points is two numbers",
    ),
    pytest.param(
        deck_text("two_link_n2", ("Q(k)\n    1       0.0", "Q(k)\n    1      1.0E")),
        [
            (
                "41:12: error: Q(k) of body 1: PH1 in columns 6-15 must be a real number, read '1.0E'; "
                "FORMAT(I5,3F10.5)"
            )
        ],
        id="an exponent needs digits",
    ),
    pytest.param(
        deck_text("two_link_n2", ("Q(k)\n    1       0.0", "Q(k)\n    1    1.5N/m")),
        [
            (
                "41:10: error: Q(k) of body 1: PH1 in columns 6-15 must be a real number, read '1.5N/m' "
                "(write the number without its unit); FORMAT(I5,3F10.5)"
            )
        ],
        id="a unit stands after a number",
    ),
    pytest.param(
        deck_text("two_link_n2", ("Q(k)\n    1       0.0", "Q(k)\n    1    180deg")),
        [
            (
                "41:10: error: Q(k) of body 1: PH1 in columns 6-15 must be a real number, read '180deg' "
                "(angles are in rad; 180 degrees are 3.14159265358979); FORMAT(I5,3F10.5)"
            )
        ],
        id="degrees stand after a number",
    ),
    pytest.param(
        deck_text("two_link_n2", ("Q(k)\n    1       0.0", "Q(k)\n    1    1.E999")),
        [
            (
                "41:10: error: Q(k) of body 1: PH1 in columns 6-15 must be a real number, read "
                "'1.E999'; FORMAT(I5,3F10.5)"
            )
        ],
        id="a number beyond the doubles is none",
    ),
    pytest.param(
        deck_text("two_link_n2", ("Q(k)\n    1       0.0", "Q(k)\n    1      zero")),
        [
            (
                "41:12: error: Q(k) of body 1: PH1 in columns 6-15 must be a real number, read 'zero'; "
                "FORMAT(I5,3F10.5)"
            )
        ],
        id="a word is no number",
    ),
    pytest.param(
        deck_text("two_link_n2", ("Q(k)\n    1       0.0", "Q(k)\n    1         -")),
        [
            (
                "41:15: error: Q(k) of body 1: PH1 in columns 6-15 must be a real number, read '-'; "
                "FORMAT(I5,3F10.5)"
            )
        ],
        id="a sign alone is no number",
    ),
    pytest.param(
        deck_text("shaft_beam_n5", ("-6563.535911622972.3756906", "-6563.535911622972.37x6906")),
        [
            (
                "23:14: error: BKP of body 1: BKP(8) in columns 14-26 must be a real number, read "
                "'22972.37x6906'; FORMAT(6E13.5)"
            )
        ],
        id="a bad stiffness is located on its continuation line",
    ),
    pytest.param(
        deck_text("two_link_n2", ("MASS\n    1       5.0", "MASS\n    1         5")),
        [
            (
                "32:15: warning: MASS of body 1: BM in columns 6-15: '5' is read as 5e-05: no decimal "
                "point is typed, so F10.5 takes 5 decimals; FORMAT(I5,F10.5)"
            ),
            (
                "32:15: error: body 1: BM = 5e-05 kg is less than the 3.75 kg of its nodes: BM is the "
                "mass of the whole body, nodes included"
            ),
        ],
        id="an implied decimal point is warned of",
    ),
    pytest.param(
        deck_text("two_link_n2", ("MASS\n    1       5.0", "MASS\n    1     1 5.0")),
        [
            (
                "32:11: warning: MASS of body 1: BM in columns 6-15: '1 5.0' is read as 15.0: blanks "
                "inside a number are ignored; FORMAT(I5,F10.5)"
            )
        ],
        id="blanks inside a number are warned of",
    ),
    pytest.param(
        deck_text("two_link_n2", ("CONN\n    0    1", "CONN\n    0    1    2")),
        ["30:15: warning: CONN: '2' stands after column 10 and is not read; FORMAT(10I5)"],
        id="a number after the list is warned of",
    ),
    pytest.param(
        deck_text("two_link_n2", ("MASS\n    1       5.0", "MASS\n   12.5")),
        [
            (
                "32:4: warning: MASS of body 1: '12' and '.5' touch at column 6: two numbers are read, "
                "one is typed?; FORMAT(I5,F10.5)"
            ),
            (
                "32:4: error: MASS of body 1: the record is numbered 12, expected 1: records are stored"
                " in the order of the bodies"
            ),
        ],
        id="a number cut in two is warned of",
    ),
    pytest.param(
        deck_text(
            "two_link_n2",
            ("MASS\n    1       5.0\n    2       5.0", "MASS\n    1       5,0\n    2       5;0"),
        ),
        [
            (
                "32:13: error: MASS of body 1: BM in columns 6-15 must be a real number, read '5,0' (a "
                "comma ends no field: cards are cut by column); FORMAT(I5,F10.5)"
            ),
            (
                "33:13: error: MASS of body 2: BM in columns 6-15 must be a real number, read '5;0'; "
                "FORMAT(I5,F10.5)"
            ),
        ],
        id="all bad fields are told at once",
    ),
]


@pytest.mark.parametrize(("text", "expected"), CASES)
def test_bad_decks_are_told_exactly(text, expected):
    assert reported(text) == expected
