"""`flexmb diff` on the published listings: it finds any digit changed, but no spacing and no sign of zero.

Liang Yong, YOUNG dissertation (1996), Appendix B.
"""

import random
import re

import pytest

from flexmb_cli.deck.table_columns import SECTIONS
from flexmb_cli.dialects.young.listing_reader import YOUNG_ERRORS, parse_listing
from flexmb_cli.results.diff.compare import compare
from flexmb_cli.results.diff.listings import compare_listings
from flexmb_cli.results.diff.tolerances import Tolerances
from tests.dialects.young.published_listing import PRINTED, listing_text, our_listing, published_cells

ZERO = re.compile(r"-?0\.0*")


def parsed(text, name="OUT"):
    return parse_listing(name, text)


def differing(a, b):
    """Kinds with the number of differences, and the worst place."""
    report = compare_listings(a, b, Tolerances())
    assert report.missing == []
    return {kind: tally.differing for kind, tally in report.tallies.items() if tally.differing}, report.worst


def changed(word, place):
    """The number with another digit: the last one, or the first that is not after it."""
    digits = [n for n, char in enumerate(word) if char.isdigit()]
    at = digits[place]
    digit = "8" if word[at] == "9" else str(int(word[at]) + 1)
    return word[:at] + digit + word[at + 1 :]


def other_zero(word):
    """A zero with the other sign; other numbers as they are."""
    if not ZERO.fullmatch(word):
        return word
    return word[1:] if word.startswith("-") else f"-{word}"


@pytest.mark.parametrize("deck", PRINTED)
@pytest.mark.parametrize("place", [-1, 0], ids=["last digit", "first digit"])
def test_one_digit_changed_in_any_column_is_found(deck, place):
    """One cell of every column of every section, drawn by lot."""
    cells, draw = published_cells(deck), random.Random(f"{deck} {place}")
    original = parsed(listing_text(deck, cells))
    for section in {section for _, section, _ in cells}:
        lines = sorted(key for key in cells if key[1] == section)
        for column, name in enumerate(SECTIONS[section].names):
            key = draw.choice(lines)
            words = list(cells[key])
            words[column] = changed(words[column], place)
            planted = parsed(listing_text(deck, cells | {key: words}))
            found, worst = differing(original, planted)
            assert found == {SECTIONS[section].kinds[column]: 1}
            assert (worst.section, worst.column) == (section, name)
            assert worst.item.endswith(f" {key[2]}")
            assert (worst.a, worst.b) == (float(cells[key][column]), float(words[column]))


@pytest.mark.parametrize("deck", PRINTED)
def test_one_digit_changed_in_any_line_of_the_echo_or_a_time_is_found(deck):
    text = listing_text(deck, published_cells(deck))
    original = parsed(text)
    lines = text.split("\n")
    times = [n for n, line in enumerate(lines, 1) if line.startswith("TIME=")]
    for number in [*(line.line for line in original.echo), times[-1]]:
        copy = list(lines)
        copy[number - 1] = changed(lines[number - 1], -1)
        found, worst = differing(original, parsed("\n".join(copy)))
        assert found == {"time" if number in times else "echo": 1}
        assert worst.section == ("time" if number in times else "echo")


@pytest.mark.parametrize("deck", PRINTED)
def test_signs_of_zero_spacing_and_line_ends_are_no_difference(deck):
    cells = published_cells(deck)
    original = parsed(listing_text(deck, cells))
    flipped = {key: [other_zero(word) for word in words] for key, words in cells.items()}
    assert any(flipped[key] != words for key, words in cells.items())
    for text in (
        listing_text(deck, flipped),
        listing_text(deck, cells, more=3),
        listing_text(deck, cells, more=-2, blank=" "),
        listing_text(deck, flipped, more=1).replace("\n", "\r\n"),
    ):
        assert differing(original, parsed(text)) == ({}, None)


@pytest.mark.parametrize("deck", PRINTED)
def test_every_difference_to_the_published_listing_is_a_known_error(deck, tmp_path):
    """YOUNG jumps between p and -p; all else that flexmb prints in another way is explained."""
    printed, ours = tmp_path / f"OUT{deck[2:]}.PAS", tmp_path / "ours.OUT"
    printed.write_text(listing_text(deck, published_cells(deck)))
    ours.write_text(our_listing(deck))
    report = compare(printed, ours, same_attitude=True, explain=True)
    assert report.differing == report.explained
    assert report.worst is None
    assert bool(report.explained) == (deck in {error.deck for error in YOUNG_ERRORS})
    assert sum(report.causes.values()) == report.explained
    assert all(cause.startswith(f"{deck}, ") for cause in report.causes)


def test_a_change_outside_the_known_errors_is_not_explained(tmp_path):
    cells = published_cells("IN4-BAR")
    key = (3, "point", 1)
    words = list(cells[key])
    words[0] = changed(words[0], -1)
    printed, ours = tmp_path / "OUT4-BAR.PAS", tmp_path / "ours.OUT"
    printed.write_text(listing_text("IN4-BAR", cells | {key: words}))
    ours.write_text(our_listing("IN4-BAR"))
    report = compare(printed, ours, same_attitude=True, explain=True)
    assert report.differing == report.explained + 1
    assert (report.worst.section, report.worst.column) == ("point", "X")
    assert f"numbers differ, {report.explained} of them by known errors" in report.text()
    assert compare(printed, ours, same_attitude=True).explained == 0
