"""`flexmb diff` on echoes and series of DAFMS: it finds any digit changed, but no spacing, no sign of zero.

The published echoes come from the READ and WRITE statements of the DAFMS thesis (Zhao, 1992), appendix C.
"""

import io
import re
from pathlib import Path

import numpy as np
import pytest

from flexmb_cli.deck.listing import TableError
from flexmb_cli.dialects.dafms.listing import Series
from flexmb_cli.dialects.dafms.listing_reader import parse_echo, parse_series
from flexmb_cli.results.diff.compare import compare
from flexmb_cli.results.diff.listings import compare_listings
from flexmb_cli.results.diff.tolerances import KINDS, Tolerance, Tolerances

PUBLISHED = Path(__file__).parents[2] / "published" / "dafms"
ECHOES = sorted(PUBLISHED.glob("*.OUT"))
LONGEST = "shaft_beam_n10"
NUMBER = re.compile(r"(?<!\S)-?\d+(\.\d+)?(E[-+]\d+)?(?!\S)")


def found(a, b, tolerances=None):
    report = compare_listings(a, b, tolerances or Tolerances())
    assert report.missing == []
    return {kind: tally.differing for kind, tally in report.tallies.items() if tally.differing}, report.worst


def plants(line):
    """(number, changed number, line with it) with the last digit changed, and with the exponent's, if any."""
    for match in NUMBER.finditer(line):
        word = match[0]
        for end in {len(word), word.find("E")} - {-1}:
            digit = "8" if word[end - 1] == "9" else str(int(word[end - 1]) + 1)
            other = word[: end - 1] + digit + word[end:]
            yield float(word), float(other), line[: match.start()] + other + line[match.end() :]


@pytest.mark.long_motion
@pytest.mark.parametrize(
    "path",
    [
        pytest.param(path, id=path.stem, marks=[pytest.mark.campaign] * (path.stem == LONGEST))
        for path in ECHOES
    ],
)
def test_one_digit_changed_in_any_number_of_an_echo_is_found(path):
    lines = path.read_text().splitlines()
    original = parse_echo("a", path.read_text())
    kinds = set()
    for echoed in original.echo:
        line = lines[echoed.line - 1]
        changed = list(plants(line))
        assert len(changed) >= len(echoed.values)
        for old, new, planted in changed:
            copy = [*lines[: echoed.line - 1], planted, *lines[echoed.line :]]
            kinds_found, worst = found(original, parse_echo("b", "\n".join(copy)))
            # Zero is zero whatever its exponent.
            assert kinds_found == ({} if old == new else {echoed.kind: 1})
            if old != new:
                assert (worst.section, worst.item) == (echoed.title, f"line {echoed.line}")
                assert (worst.a, worst.b) == (old, new)
                kinds.add(echoed.kind)
    assert kinds >= {"count", "time", "mass", "inertia", "length", "euler"}


@pytest.mark.parametrize("path", ECHOES, ids=lambda path: path.stem)
def test_signs_of_zero_spacing_and_line_ends_are_no_difference(path):
    text = path.read_text()
    original = parse_echo("a", text)
    minus = re.sub(r" 0\.00000(?!\d)", "-0.00000", text)
    assert minus != text
    wide = re.sub(r"(?<=\S)  +(?=-?\d)", "     ", text)
    assert wide != text
    for other in (minus, wide, text.replace("\n", "  \n"), text.replace(" 0.", "  .")):
        assert found(original, parse_echo("b", other)) == ({}, None)


def test_lists_that_are_broken_into_other_lines_are_no_difference():
    text = (PUBLISHED / "two_link_n2.OUT").read_text()
    joined = text.replace("0.00000\n     X(L)", "0.00000")
    assert joined != text
    assert found(parse_echo("a", text), parse_echo("b", joined)) == ({}, None)


def test_missing_and_further_numbers_are_told_with_their_tag():
    text = (PUBLISHED / "two_link_n2.OUT").read_text()
    a, b = (
        parse_echo("a", text),
        parse_echo("b", text.replace("     RC==    2   0.00000   0.00000   0.00000\n", "")),
    )
    assert compare_listings(a, b, Tolerances()).missing == ["RC==: 8 numbers in a, 4 in b"]
    ignoring = Tolerances(kinds={"length": Tolerance(np.inf)})
    assert compare_listings(a, b, ignoring).equal


def test_another_heading_is_told_unless_the_echo_is_left_out():
    text = (PUBLISHED / "two_link_n2.OUT").read_text()
    a, b = parse_echo("a", text), parse_echo("b", text.replace("DFMB FLEXIBLE", "DFMB RIGID"))
    assert "'DFMB FLEXIBLE TWO" in compare_listings(a, b, Tolerances()).words[0]
    assert not compare_listings(a, b, Tolerances(kinds={"echo": Tolerance(np.inf)})).words


def test_stars_stand_for_numbers_that_do_not_fit():
    text = (PUBLISHED / "pendulum_strict.OUT").read_text()
    line = "     BM==    1   0.20000"
    stars = parse_echo("a", text.replace(line, "     BM==    1**********"))
    large = parse_echo("b", text.replace(line, "     BM==    1 123456.70000"))
    fits = parse_echo("c", text)
    assert found(stars, large) == ({}, None)
    assert found(large, stars) == ({}, None)
    assert found(stars, fits)[0] == {"mass": 1}


def test_what_single_precision_may_do_is_marked_and_no_more():
    """1234.56789 has the nearest single 1234.56787109375, printed 1234.56787."""
    text = (PUBLISHED / "pendulum_strict.OUT").read_text()
    files = {}
    for mass in ("1234.56789", "1234.56787", "1234.56889"):
        files[mass] = parse_echo(mass, text.replace("     BM==    1   0.20000", f"     BM==    1{mass}"))
    first, single, other = files.values()
    assert float(np.float32(1234.56789)) == 1234.56787109375
    for b, explained in ((single, 1), (other, 0)):
        report = compare_listings(first, b, Tolerances(), explain=True)
        assert (report.differing, report.explained) == (1, explained)


STATE = np.random.default_rng(4).uniform(0.1, 1, (6, 12)) * 10.0 ** np.arange(-5, 7) / 1e3


def series(layout="safe", state=STATE):
    units = io.StringIO(), io.StringIO()
    Series(*units, 6, layout).rows(0.01 * np.arange(6), state[:, 6:], state[:, :6])
    return tuple(unit.getvalue() for unit in units)


@pytest.mark.parametrize(("unit", "name"), [(0, "x.T2"), (1, "x.T3")])
def test_one_digit_changed_in_any_number_of_a_series_is_found(unit, name):
    text = series()[unit]
    lines, original = text.splitlines(), parse_series(name, text)
    kinds = ["time", "speed" if unit == 0 else "coordinate", "coordinate", "coordinate"]
    for number in (1, 5):
        numbers = [float(word) for word in lines[number].split()]
        for old, new, planted in plants(lines[number]):
            copy = [*lines[:number], planted, *lines[number + 1 :]]
            kinds_found, worst = found(original, parse_series(name, "\n".join(copy)))
            assert kinds_found == {kinds[numbers.index(old)]: 1}
            assert (worst.a, worst.b) == (old, new)


def test_the_two_looks_of_one_series_do_not_differ():
    state = STATE * np.where(np.arange(12) % 2, 1e-12, -1.0)
    for safe, historic in zip(series("safe", state), series("historic", state), strict=True):
        assert found(parse_series("a.T2", safe), parse_series("b.T2", historic)) == ({}, None)


def test_missing_rows_of_a_series_are_told():
    text = series()[0]
    shorter = "".join(text.splitlines(keepends=True)[:-2])
    report = compare_listings(parse_series("a.T2", text), parse_series("b.T2", shorter), Tolerances())
    assert report.missing == ["2 rows of a.T2 are not in b.T2: t = 0.04, 0.05"]
    assert report.differing == 0


def test_files_of_different_kinds_are_refused(tmp_path):
    (tmp_path / "x.T2").write_text(series()[0])
    with pytest.raises(TableError, match="it is of another type") as caught:
        compare(ECHOES[0], tmp_path / "x.T2")
    assert caught.value.name == str(tmp_path / "x.T2")


def test_all_kinds_of_the_tags_can_have_tolerances():
    kinds = {line.kind for path in ECHOES for line in parse_echo("x", path.read_text()).echo}
    assert kinds <= set(KINDS)
