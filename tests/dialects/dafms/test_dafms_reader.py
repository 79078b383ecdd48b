"""FMBD.DAT as the 1992 program reads it: DAFMS thesis (Zhao, 1992), appendix C, and the supplied decks."""

import tracemalloc

import pytest

from flexmb_cli.deck.fortran_card import fortran_format
from flexmb_cli.dialects.dafms import system_cards
from flexmb_cli.dialects.dafms.cards import EXTENSIONS, HISTORIC, KNOWN_WORDS
from flexmb_cli.errors import DeckError, compiler_style
from tests.dialects.dafms.dafms_decks import DECKS, build, deck_text, faults, read, reported

NAMES = sorted(path.stem for path in DECKS.glob("*.DAT"))


def values(deck, section, number):
    record = next(r for r in deck.section(section) if r.number == number)
    return [n.value for n in record.numbers]


@pytest.mark.parametrize("name", NAMES)
def test_supplied_decks_have_no_fault(name):
    """Two of them give a node of a rigid parent, which is not used."""
    notes = ["NP = 4 is not used: body 1 is rigid"] * (name == "fourbar_flex")
    notes += ["NP = 2 is not used: body 1 is rigid"] * (name == "slider_crank_flex")
    found = faults(deck_text(name))
    assert [(f.severity, f.message.partition(",")[0]) for f in found] == [("note", note) for note in notes]


def test_twenty_decks_are_supplied():
    assert len(NAMES) == 20


def test_a_list_goes_on_over_records():
    """Fields of two_link_n4.DAT, line by line."""
    deck = read(deck_text("two_link_n4"))
    assert values(deck, "bkp", 1) == [
        1203463.91753,
        -756123.71134,
        918432.989691,
        285030.927835,
        -613608.24742,
        633402.061856,
        -47505.154639,
        166268.041237,
        -233567.01031,
        102927.835052,
    ]
    assert [r["u"] for r in deck.section("speed")] == [0.0] * 10
    assert [r["q"] for r in deck.section("coordinate")] == [0.0, 0.087266463, *[0.0] * 8]


def test_speeds_come_before_coordinates_in_one_list():
    deck = read(deck_text("spatial_rigid"))
    assert [r["u"] for r in deck.section("speed")] == [1.0, 2.0, -0.5, 3.0]
    assert [r["q"] for r in deck.section("coordinate")] == [0.0, 0.0, 0.0, 0.4]


def test_planar_decks_give_two_components_a_node_and_spatial_ones_three():
    planar, spatial = read(deck_text("two_link_n2")), read(deck_text("spatial_flex"))
    assert [n.key for n in planar.section("node.1")[0].numbers] == ["CO2", "CO3"]
    assert [n.key for n in spatial.section("node.1")[0].numbers] == ["CO1", "CO2", "CO3"]
    assert values(spatial, "node.1", 2) == [0.0, 0.8, 0.0]


def test_every_number_has_meaning_and_place():
    for name in NAMES:
        for label, number in read(deck_text(name)).numbers():
            assert number.meaning, label
            assert number.place is not None or label == "run.STAR", label


def test_what_stands_behind_the_columns_or_after_stop_is_a_comment():
    text = deck_text("pendulum", ("         19.6\n", "         19.6  spring rate, N/m\n"))
    assert faults(text + "anything at all\n") == []


def test_line_ends_of_dos_and_its_end_of_file_mark_are_read():
    text = deck_text("pendulum").replace("\n", "\r\n") + "\x1a"
    assert [n.value for _, n in read(text).numbers()] == [
        n.value for _, n in read(deck_text("pendulum")).numbers()
    ]


def test_lines_may_end_where_blanks_begin():
    text = deck_text(
        "pendulum_strict", ("XI  \n", "XI\n"), ("END \n", "END\n"), ("    1    0    0    0    0\n", "    1\n")
    )
    assert faults(text) == []


def test_cards_may_come_in_any_order():
    text = deck_text("spatial_rigid", ("CONN\n    0    1\n", ""), ("END \n", "CONN\n    0    1\nEND \n"))
    assert build(text)[0].hinges[1].parent == 0


def test_a_repeated_card_replaces_the_first():
    text = deck_text("sliding_mass", ("END \n", "MASS\n    1       9.0\n    2        .5\nEND \n"))
    assert [r["BM"] for r in read(text).section("mass")] == [9.0, 0.5]


def test_a_faulty_field_is_shown_with_its_card_ruler_and_format():
    text = deck_text("two_link_n2", ("MASS\n    1       5.0", "MASS\n    1       5.O"))
    assert compiler_style("x.DAT", faults(text), text.split("\n")) == (
        "x.DAT:32:13: error: MASS of body 1: BM in columns 6-15 must be a real number, read '5.O' "
        "(letter O instead of zero?); FORMAT(I5,F10.5)\n"
        "    [I5-][F10.5---]\n"
        "    ----+----1----+\n"
        "        1       5.O\n"
        "                ^^^"
    )


def test_extension_records_cannot_look_like_a_card_to_the_1992_program():
    """It skips unknown cards one line at a time; every record begins with a number."""
    historic = {card.word for card in HISTORIC}
    for card in EXTENSIONS:
        assert len(card.word) == 4
        assert card.word not in historic
        assert card.layout == "switch" or fortran_format(card.format).edits[0].letter in "IE"
    assert not any(word[0] in " +-.0123456789" for word in KNOWN_WORDS)


def test_a_deck_means_the_same_to_a_reader_without_extensions(monkeypatch):
    cards = (
        "PROD\n    1       .01       .02       .03\n    2       0.0       0.0       0.0\n"
        "SPRI\n    1\n    2    5     100.0        .1\nTABL\n    1\n    1    1    2\n       0.0       1.0\n"
        "       1.0       2.0\nUNCO\nTOLR\n       1.E-08       1.E-08\nMETH\n    2\n"
    )
    text = deck_text("sliding_mass", ("END \n", cards + "END \n"))
    monkeypatch.setattr(system_cards, "CARDS", {card.word: card for card in HISTORIC})
    old, plain = read(text), read(deck_text("sliding_mass"))
    assert [(label, n.value) for label, n in old.numbers()] == [
        (label, n.value) for label, n in plain.numbers()
    ]


def test_faults_of_several_cards_are_told_together():
    text = deck_text(
        "two_link_n2", ("MASS\n    1       5.0", "MASS\n    1       5.O"), ("EULT\n    1", "EULT\n    3")
    )
    assert [line.split(":")[0] for line in reported(text)] == ["32", "47"]


@pytest.mark.parametrize(
    "counts, reported",
    [
        (" 5000    3", "unexpected end of the deck"),
        (" 5000    2", "unexpected end of the deck"),
        ("99999    3", "N = 99999 bodies, at most 5000 are taken"),
    ],
)
def test_huge_counts_in_a_short_deck_end_at_once(counts, reported):
    text = f"{counts}\nDFMB\n    1    0    0    0    0\n"
    tracemalloc.start()
    with pytest.raises(DeckError, match=reported):
        read(text)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < 1_000_000


def test_the_format_description_tells_every_card_with_its_format():
    rows = [line for line in (DECKS / "FORMAT.md").read_text().splitlines() if line.startswith("| `")]
    for card in (*HISTORIC, *EXTENSIONS):
        (row,) = [
            row
            for row in rows
            if f"`{card.word}`" in row.split("|")[1] or row.startswith(f"| `FORC`, `{card.word}`")
        ]
        assert card.format in row
        assert card.tail in row
