"""VSDF decks read: fixed columns, commas, defaults, names of numbers."""

import pytest

from flexmb_cli.deck.many_records import DeckValues
from flexmb_cli.deck.record import DeckText
from flexmb_cli.deck.text import read_text
from flexmb_cli.dialects.recognise import read_deck
from flexmb_cli.dialects.vsdf import bodies
from flexmb_cli.dialects.vsdf.cards import BY_WORD, CARDS
from flexmb_cli.errors import DeckError, Place
from tests.dialects.vsdf.vsdf_decks import DECKS, RIGID, build, changed, read
from tests.growth import LINEAR, growth


@pytest.mark.parametrize("path", sorted(DECKS.glob("*.vsdf")), ids=lambda path: path.stem)
def test_supplied_decks_are_recognised_and_read_without_warn(path):
    deck = read_deck(read_text(path))
    assert deck.dialect == "vsdf"
    assert deck.warnings == ()


def test_numbers_have_names_places_and_units():
    deck = read(RIGID)
    named = dict(deck.numbers())
    number = named["rigid.2.c.x"]
    assert (number.value, number.unit, number.place, number.text) == (0.25, "m", Place(8, 22, 4), "0.25")
    assert named["joint.2.kind"].value == "REVO"
    assert named["body.1.modes"].value == 0
    assert named["gravity.g.y"].value == -9.81
    assert len(named) == sum(len(record.numbers) for record in deck.records)


def test_the_title_is_what_follows_the_first_word():
    assert read(RIGID).one("title")["title"] == "TWO LINKS"


def test_a_card_with_commas_is_free_of_columns():
    fixed = read(RIGID)
    free = read(
        changed(
            ("    1       2.0       0.5\n", "1, 2.0, 0.5\n"),
            ("       0.1       0.2       0.2\n", "0.1,0.2,  0.2\n"),
            ("    2 REVO    1    3    4    2    1    2\n", "2,revo,1,3,4,2,1,2\n"),
        )
    )
    assert [(n, v.value) for n, v in free.numbers()] == [(n, v.value) for n, v in fixed.numbers()]


def test_commas_give_room_for_all_digits():
    deck = read(changed(("    2       1.0      0.25\n", "2,-0.06171389001427649635,0.25\n")))
    assert deck.section("rigid")[1]["mass"] == -0.06171389001427649635


def test_commas_leave_empty_fields_to_their_defaults():
    joint = read(changed(("    2 REVO    1    3    4    2    1    2\n", "2,REVO,1,3,4,2,1,2,,,\n")))
    record = joint.section("joint")[1]
    assert (record["a3"], record["b3"], record["size"]) == (0, 0, 0.0)


def test_a_file_name_may_hold_commas_and_blanks():
    text = "VSDF\nBODY\n    1 FLEX\nFEMN\n    1 TXT  my nodes, v2.txt\nTIME\n 1.0, 0.1\nEND\nSTAR\n"
    assert read(text).one("node_table")["file"] == "my nodes, v2.txt"
    text = text.replace("    1 TXT  my", "1,TXT,my")
    assert read(text).one("node_table")["file"] == "my nodes, v2.txt"


def test_touching_fields_are_cut_by_column():
    deck = read(changed(("       0.1       0.2       0.2\n", "1.0000E-012.0000E-01    0.2E+0\n")))
    record = deck.section("rigid")[0]
    assert [record[f"J{ij}"] for ij in ("xx", "yy", "zz")] == [0.1, 0.2, 0.2]


def test_comments_blank_lines_lower_case_and_d_exponents_are_read():
    text = changed(
        ("BODY\n", "* a comment\n\nbody\n"),
        ("      0.05", "    5.0D-2"),
        ("GRAV\n", "grav  of the earth\n"),
        (
            "    2 REVO    1    3    4    2    1    2\n",
            "    2 REVO    1    3    4    2    1    2                    the elbow\n",
        ),
    )
    deck = read(text)
    assert deck.section("rigid")[1]["Jxx"] == 0.05
    assert deck.warnings == ()


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"], ids=repr)
def test_every_line_end_and_a_missing_one_at_the_last_are_read(end):
    wanted = [(name, number.value) for name, number in read(RIGID).numbers()]
    found = read(RIGID.rstrip("\n").replace("\n", end))
    assert [(name, number.value) for name, number in found.numbers()] == wanted


def test_what_follows_stop_is_never_read():
    assert read(RIGID + "anything ~ goes\nBODY\n").warnings == ()


def test_a_list_of_nodes_goes_on_to_the_end_of_the_card():
    record = read(changed(("    2    3\n", "    2    1    2    3\n"))).one("output")
    assert [number.key for number in record.numbers] == ["body", "node1", "node2", "node3"]
    assert [number.value for number in record.numbers] == [2, 1, 2, 3]


def test_a_block_may_repeat():
    deck = read(changed(("END\n", "OUTN\n    1    3\nEND\n")))
    assert [record.number for record in deck.section("output")] == [1, 2]


def test_a_deck_without_star_is_read_with_a_warn():
    (warning,) = read(changed(("STAR\nSTOP\n", ""))).warnings
    assert warning.sentence == "no STAR card after END: the deck asks for no run"


def test_every_card_has_a_word_of_four_letters_of_its_own():
    assert len(BY_WORD) == len(CARDS)
    assert all(len(card.word) == 4 and card.word.isupper() for card in CARDS)


def test_every_card_is_looked_up_by_a_builder(monkeypatch):
    """A card that no builder reads would do nothing, silently; checks of body numbers do not count."""
    asked = set()

    def noting(look_up):
        return lambda self, section, *rest: asked.add(section) or look_up(self, section, *rest)

    for name in ("section", "record", "places_of_body", "column"):
        monkeypatch.setattr(DeckValues, name, noting(getattr(DeckValues, name)))
    for name in ("_check_body_numbers", "_refuse_cards_of_others"):
        monkeypatch.setattr(bodies, name, lambda *given: None)
    build(RIGID)
    build((DECKS / "pendulum.vsdf").read_text())
    unread = [card.word for card in CARDS if card.section not in asked]
    assert not unread, "the builder of its topic in dialects/vsdf/ must ask for its section"


def test_every_card_is_described_in_the_format_page():
    page = (DECKS / "FORMAT.md").read_text()
    for card in CARDS:
        assert f"| `{card.word}` |" in page, (
            f"decks/vsdf/FORMAT.md needs a row | `{card.word}` | fields | meaning |"
        )


def test_a_table_is_read_in_time_in_proportion_to_its_length():
    def read_table(count):
        points = "".join(f"    1{i * 1e-3:10.3f}{i % 7:10.1f}\n" for i in range(count))
        read(changed(("END\n", f"TABL\n{points}END\n")))

    assert growth(read_table, 800) < LINEAR


def test_an_empty_deck_is_refused():
    with pytest.raises(Exception, match="must begin with VSDF"):
        read_vsdf_text("")


def read_vsdf_text(text):
    from flexmb_cli.dialects.vsdf.reader import read_vsdf

    return read_vsdf(DeckText("x", text, ""))


def test_a_card_of_many_nodes_takes_time_in_proportion_to_its_length():
    """Counting each key among all others took an hour for a megabyte of nodes."""

    def read_nodes(count):
        record = read(changed(("TIME\n", f"OUTN\n1,{'1,' * count}2\nTIME\n"))).section("output")[0]
        assert record[f"node{count + 1}"] == 2

    assert growth(read_nodes, 3000) < LINEAR


def test_a_card_of_more_nodes_than_memory_allows_is_refused():
    with pytest.raises(DeckError) as caught:
        read(changed(("TIME\n", f"OUTN\n1,{'1,' * 100_001}2\nTIME\n")))
    assert [fault.message for fault in caught.value.faults] == [
        "a card has at most 100000 fields; continue on a further one"
    ]
