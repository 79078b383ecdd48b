"""VSDF decks that cannot be read, or describe no model, and what is said of them."""

import pytest

from tests.dialects.vsdf.vsdf_decks import RIGID, changed, reported

READING = [
    (
        "first word",
        changed(("VSDF TWO", "VSDD TWO")),
        ["1:1: error: the first card must begin with VSDF; read 'VSDD'"],
    ),
    (
        "unknown card",
        changed(("JOIN\n", "JION\n")),
        ["22:1: error: there is no card 'JION'; is 'JOIN' meant?"],
    ),
    (
        "letter O",
        changed(("       2.0       0.5", "       2.O       0.5")),
        ["6:13: error: RIGI: mass in columns 6-15 must be a number; read '2.O': letter O instead of zero?"],
    ),
    (
        "two numbers in a field",
        changed(("       2.0       0.5", "     2.0 0.5        ")),
        [
            "6:11: error: RIGI: mass in columns 6-15 must be a number; read '2.0 0': two numbers in "
            "one field? "
            "fields are cut by column, or by commas"
        ],
    ),
    (
        "no mass",
        changed(("    1       2.0       0.5\n", "    1\n")),
        ["6:6: error: RIGI: mass in columns 6-15 must be a number; the field is empty"],
    ),
    (
        "decimal body number",
        changed(("    2       1.0      0.25", "  2.5       1.0      0.25")),
        ["8:3: error: RIGI: body in columns 1-5 must be an integer; read '2.5'"],
    ),
    (
        "unknown joint",
        changed(("    1 REVO", "    1 HING")),
        [
            "23:7: error: JOIN: kind in columns 7-10 must be one of SPHE, UNIV, REVO, CYLI, TRAN, "
            "SCRW, FIXD, "
            "RSPH, DIST; read 'HING'"
        ],
    ),
    (
        "number after the fields",
        changed(("       1.0      0.01\n", "       1.0      0.01       0.0       5.0\n")),
        ["28:38: error: TIME: '5.0' stands after the last field and is not read"],
    ),
    (
        "second card missing",
        changed(("      0.05       0.1       0.1\nPOSI", "POSI")),
        ["8:26: error: RIGI: its second card, with Jxx ... Jzx, is missing"],
    ),
    (
        "twice",
        changed(("NODE\n", "    2       3.0\nNODE\n")),
        ["12:5: error: position of body 2: it is given on line 11 already"],
    ),
    (
        "numbers out of order",
        changed(("    2 RIGD", "    3 RIGD")),
        ["4:5: error: body 3: it is number 2 of its type; records are numbered 1, 2, ... in their order"],
    ),
    (
        "no END",
        changed(("END\nSTAR\nSTOP\n", "")),
        ["30:11: error: unexpected end of the deck, expected the card END"],
    ),
    (
        "after END",
        changed(("STAR\n", "STAR\nGRAV\n")),
        ["33:1: error: card 'GRAV' stands after END, where nothing is read"],
    ),
    (
        "BODY not first",
        "VSDF\nTIME\n 1.0,0.1\nBODY\n    1 RIGD\nEND\nSTAR\n",
        ["2:1: error: card 'TIME' stands before BODY, which must come first"],
    ),
    (
        "data before a card",
        "VSDF\n    1\nBODY\n    1 RIGD\nEND\nSTAR\n",
        ["2:1: error: a data card stands before any keyword"],
    ),
    (
        "a list without entries",
        changed(("    2    3\n", "    2\n")),
        ["30:6: error: OUTN: the card names no node or node set"],
    ),
    (
        "tab",
        changed(("    1       2.0       0.5\n", "    1\t2.0\t0.5\n")),
        ["6:7: error: RIGI: mass in columns 6-15: a tab counts as one column; use blanks or commas"],
    ),
    (
        "free field",
        changed(("       1.0      0.01\n", "1.0, 0.01x\n")),
        ["28:6: error: TIME: output in field 2 must be a number; read '0.01x'"],
    ),
    (
        "all at once",
        changed(("    1 REVO", "    1 HING"), ("       1.0      0.01\n", "       1.0      O.01\n")),
        [
            "23:7: error: JOIN: kind in columns 7-10 must be one of SPHE, UNIV, REVO, CYLI, TRAN, "
            "SCRW, FIXD, "
            "RSPH, DIST; read 'HING'",
            "28:17: error: TIME: output in columns 11-20 must be a number; read 'O.01': letter O "
            "instead of zero?",
        ],
    ),
]


@pytest.mark.parametrize("text, wanted", [case[1:] for case in READING], ids=[case[0] for case in READING])
def test_decks_that_cannot_be_read(text, wanted):
    assert reported(text) == wanted


def test_a_sound_deck_leaves_nothing_to_say():
    assert reported(RIGID) == []


def test_the_columns_of_a_card_are_drawn_above_it():
    from flexmb_cli.errors import DeckError, compiler_style
    from tests.dialects.vsdf.vsdf_decks import read

    text = changed(("       2.0       0.5", "       2.O       0.5"))
    with pytest.raises(DeckError) as stopped:
        read(text)
    shown = compiler_style("x.vsdf", stopped.value.faults, text.splitlines())
    assert shown.splitlines()[1:] == [
        "    [I5-][F10-----][F10-----][F10-----][F10-----]",
        "    ----+----1----+----2----+----3----+----4----+",
        "        1       2.O       0.5",
        "                ^^^",
    ]


def test_a_step_that_rk45_does_not_use_is_told():
    text = changed(("       1.0      0.01\n", "       1.0      0.01      0.02\nINTG\n RK45    1.0E-9\n"))
    assert reported(text) == [
        "28:27: warning: TIME: RK45 chooses its steps by the tolerance; the step of 0.02 s is not used"
    ]


def test_a_megabyte_of_faults_is_left_after_a_thousand():
    """Each unknown word is looked for among the known ones, and each fault is kept."""
    faults = reported("VSDF T\nBODY\n    1 RIGD\n" + "QQQQ\n" * 200_000)
    assert 1000 < len(faults) < 1010
    assert "not read from here on" in faults[-1]


def test_more_springs_than_memory_allows_are_refused(monkeypatch):
    """One takes 2.6 kB, a hundred times its card: 10 MB of them took 1.6 GB."""
    monkeypatch.setattr("flexmb_cli.dialects.vsdf.loads.MOST_ELEMENTS", 1)
    springs = "JSPR\n    1      10.0\n    1      10.0\nEND"
    (message,) = reported(changed(("END", springs)))
    assert message.endswith("joint spring 2: the deck has 2 springs of this card; at most 1 are taken")


def test_the_fields_of_a_card_with_a_list_are_bounded(monkeypatch):
    """Each takes some hundred bytes while its card is read."""
    text = changed(("OUTN\n    2    3\n", f"OUTN\n    2{5 * '    3'}\n"))
    monkeypatch.setattr("flexmb_cli.dialects.vsdf.data_cards._MOST_FIELDS", 6)
    assert not any("has at most" in message for message in reported(text))
    monkeypatch.setattr("flexmb_cli.dialects.vsdf.data_cards._MOST_FIELDS", 5)
    (message,) = reported(text)
    assert message.endswith("a card has at most 5 fields; continue on a further one")
