"""Reading YOUNG decks: order, names, meanings, units and places of the numbers."""

import tracemalloc
from pathlib import Path

import pytest

from flexmb_cli.deck.text import read_text
from flexmb_cli.dialects.young.reader import read_young
from flexmb_cli.dialects.young.sections import COUNTS, YOUNG_SECTIONS
from flexmb_cli.errors import DeckError, Place
from tests.dialects.young.young_decks import PENDULUM, faults, pendulum, read
from tests.growth import LINEAR, growth

DECKS = sorted((Path(__file__).parents[3] / "decks" / "young").glob("*.dat"))

# Numbers of each record by the table in chapter 5 of the dissertation: integers and reals.
SIZES = {
    "counts": (12, 0),
    "body": (0, 7),
    "driver": (2, 3),
    "point": (1, 3),
    "spherical": (2, 6),
    "universal": (2, 12),
    "revolute": (2, 12),
    "cylindrical": (2, 12),
    "translational": (2, 18),
    "screw": (2, 19),
    "simplified": (2, 1),
    "distance": (3, 1),
    "ground": (1, 6),
    "time": (0, 3),
}


def values(deck, section, number=1):
    (record,) = [record for record in deck.section(section) if record.number == number]
    return [number.value for number in record.numbers]


def test_sections_have_the_order_and_sizes_of_the_dissertation():
    sizes = {
        section.name: (
            sum(column.is_integer for column in section.columns),
            sum(not column.is_integer for column in section.columns),
        )
        for section in YOUNG_SECTIONS
    }
    assert list(sizes.items()) == list(SIZES.items())


def test_every_section_is_announced_by_one_count():
    announced = [section.count for section in YOUNG_SECTIONS if section.count]
    assert announced == [column.key for column in COUNTS.columns]


def test_nineteen_decks_are_supplied():
    assert len(DECKS) == 19


@pytest.mark.parametrize("path", DECKS, ids=lambda path: path.stem)
def test_a_supplied_deck_says_what_it_shows_and_is_read_and_built_without_a_warn(path):
    source = read_text(path)
    assert source.text.startswith("{ ")
    assert "Liang Yong, YOUNG dissertation (1996), Appendix" in source.text
    assert faults(source.text) == []


def test_the_four_bar_deck_is_read_as_printed_with_its_zeros_restored():
    """Dissertation, Appendix B, IN4-BAR; the restored zeros as the echo in OUT4-BAR has them."""
    deck = read_young(read_text(DECKS[0].parent / "IN4-BAR.dat"))
    assert values(deck, "counts", 0) == [4, 1, 1, 1, 1, 2, 0, 0, 0, 0, 0, 1]
    assert values(deck, "body", 2) == [-3.753, -4.2502, 4.2553, 0.87944, -0.29098, -0.2741, -0.2591]
    assert values(deck, "driver") == [1, 4, 0, 3.14159265, 0]
    assert values(deck, "point") == [1, 0, 0, 2]
    assert values(deck, "spherical") == [2, 3, 0, -6.1, 0, 0, -3.7, 0]
    assert values(deck, "universal") == [1, 2, 0, 0, 2, 0, 6.1, 0, 0.75, -0.66, 2, 0, 6.1, 1]
    assert values(deck, "revolute", 2) == [3, 4, 0, 3.7, 0, -4, -8.5, 0, 1, 3.7, 0, -4, -9.5, 0]
    assert values(deck, "ground") == [4, 0, 0, 0, 0, 0, 0]
    assert values(deck, "time", 0) == [0, 2.5, 0.1]


def test_every_number_has_a_readable_name_its_spelling_and_its_place():
    names = dict(read(PENDULUM).numbers())
    assert names["revolute.1.P_j.y"].text == "-1"
    assert names["revolute.1.P_j.y"].place == Place(5, 13, 2)
    assert names["counts.NBODY"].value == 2
    assert names["time.end"].value == 6.0
    assert names["ground.1.gamma"].unit == "rad"
    assert len(names) == 12 + 14 + 5 + 14 + 7 + 3


@pytest.mark.parametrize(
    ("direction", "units"),
    [(1, ["m", "m/s", "m/s^2"]), (3, ["m", "m/s", "m/s^2"]), (4, ["rad", "rad/s", "rad/s^2"])],
)
def test_a_drivers_units_follow_its_direction(direction, units):
    (driver,) = read(pendulum(4, f"2 {direction} 0 1.047 0")).section("driver")
    assert [number.unit for number in driver.numbers[2:]] == units


def test_integers_stay_integers_and_reals_are_reals():
    for _, number in read(PENDULUM).numbers():
        whole = number.key in ("I", "J", "body", "direction") or number.key.startswith("N")
        assert type(number.value) is (int if whole else float)


@pytest.mark.parametrize(
    "rest",
    [" and any words", "\n{ a comment without end", "\n1 2 3 4 nan", "\n0.0011905666, 0.000595", "\x1a"],
)
def test_what_follows_the_last_number_is_never_looked_at(rest):
    assert faults(PENDULUM.rstrip() + " " + rest) == []


@pytest.mark.parametrize("separator", [" ", "\n", "\t", "\r\n", " { c } ", "\n{ 1 2\n 3 }\n"])
def test_records_may_be_broken_and_joined_freely(separator):
    deck = read(separator.join(PENDULUM.split()))
    expected = [(name, number.value) for name, number in read(PENDULUM).numbers()]
    assert [(name, number.value) for name, number in deck.numbers()] == expected
    assert deck.warnings == ()


def test_a_text_that_begins_with_integers_does_not_read_for_ever():
    """Words after the counts of many bodies."""

    def refused(words):
        with pytest.raises(DeckError):
            read(f"{words // 4} 0 0 0 0 0 0 0 0 0 0 0\n" + "x " * words)

    assert growth(refused, 8000) < LINEAR


def test_a_trillion_bodies_in_a_small_file_take_no_memory():
    tracemalloc.start()
    with pytest.raises(DeckError, match="by its counts the deck needs 7000000000015 numbers, it has 12"):
        read("1000000000000 0 0 0 0 0 0 0 0 0 0 0\n")
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < 1_000_000


@pytest.mark.parametrize(
    ("end", "said"),
    [
        ("0 0 2.5 0.1", "one more number follows Ti, Te and dT = 2.5; is one before it too many?"),
        ("0 2.5 0.1 7", "one more number follows Ti, Te and dT = 0.1; is one before it too many?"),
        ("0 2.5 0.1\n0 5 0.1", "the deck is complete before this line; its numbers are ignored"),
        ("0 2.5 0.1 s, as printed", None),
        ("0 2.5 0.1\n1996, by hand", None),
    ],
)
def test_numbers_behind_the_time_are_reported_and_prose_is_not(end, said):
    """FORMAT.md: what follows the last number is ignored; numbers only are rather a slip."""
    text = (DECKS[0].parent / "IN4-BAR.dat").read_text().replace("0 2.5 0.1", end)
    deck = read(text)
    assert [fault.message for fault in deck.warnings] == ([said] if said else [])
