"""Listings that are typed from print: every slip is found at its line, in one call.

The listing is what the four-bar of the YOUNG dissertation (IN4-BAR) prints at its first two instants, with
slips of a typist put in: what is expected follows from these.
"""

import re
from pathlib import Path

import pytest
from click.testing import CliRunner

from flexmb_cli.cli.diff import diff
from flexmb_cli.interface import solve_to_files
from flexmb_cli.run.outcome import RunOptions

FOUR_BAR = Path(__file__).resolve().parents[3] / "decks/young/IN4-BAR.dat"


@pytest.fixture(scope="module")
def table(tmp_path_factory):
    """The whole table, and the text of its first two blocks."""
    folder = tmp_path_factory.mktemp("table")
    short = FOUR_BAR.read_text(encoding="utf-8").replace("0 2.5 0.1", "0 0.1 0.1")
    (folder / "IN4-BAR.dat").write_text(short, encoding="utf-8")
    solve_to_files(folder / "IN4-BAR.dat", RunOptions(folder=str(folder)))
    text = (folder / "OUT4-BAR.dat").read_text(encoding="utf-8")
    return folder / "OUT4-BAR.dat", text[text.index("TIME=") :]


@pytest.fixture
def compared(table, tmp_path, monkeypatch):
    """Exit code and output of `diff` of a listing with slips against the table."""
    monkeypatch.chdir(tmp_path)
    path, text = table

    def compare(slips, *options):
        typed = text
        for pattern, instead in slips:
            typed, count = re.subn(pattern, instead, typed, count=1, flags=re.MULTILINE)
            assert count == 1, pattern
        Path("typed").write_text(typed, encoding="utf-8")
        found = CliRunner().invoke(diff, ["typed", str(path), "--tol", "echo=inf", *options])
        return found.exit_code, found.output, typed.splitlines()

    return compare


SLIPS = [(r"-5\.746", "5.746"), (r"-4\.250", "-4.520")]


def test_all_slips_are_listed_with_their_lines(compared):
    """A lost minus and exchanged digits."""
    code, output, typed = compared(SLIPS, "--list", "10")
    assert code == 1
    lines = [1 + next(n for n, line in enumerate(typed) if word in line) for word in (" -4.520", " 5.746")]
    assert re.findall(r"^typed:.*$", output, re.MULTILINE) == [
        f"typed:{lines[0]}: position, body 2, Y at t = 0: -4.52 against -4.25",
        f"typed:{lines[1]}: position, body 3, X at t = 0: 5.746 against -5.746 (only the sign)",
    ]


def test_a_list_ends_where_it_is_asked_to(compared):
    _, output, _ = compared(SLIPS, "--list", "1")
    assert len(re.findall(r"^typed:\d+:", output, re.MULTILINE)) == 1 and "\n… and 1 more\n" in output


def test_without_the_option_nothing_is_listed(compared):
    assert not re.search(r"^typed:\d+:", compared(SLIPS)[1], re.MULTILINE)


def test_a_body_that_stands_twice_is_refused_at_its_second_line(compared):
    code, output, typed = compared([(r"^  3(    -5\.746)", r"  2\1")])
    number = 1 + next(n for n, line in enumerate(typed) if "  2    -5.746" in line)
    assert code == 2
    assert (
        f"typed:{number}:1: error: position: body 2 stands twice in this block: is it another one?" in output
    )


def test_a_lost_heading_is_guessed_from_the_count_of_numbers(compared):
    code, output, _ = compared([(r"^VELOCITY\n", "")])
    assert code == 2
    assert "10 are there, as many as of velocity or acceleration: is a heading missing above?" in output


def test_a_time_with_a_letter_gets_a_hint(compared):
    code, output, _ = compared([(r"TIME= 0\.100", "TIME= O.100")])
    assert code == 2 and "read 'TIME= O.100': letter O instead of zero?" in output


def test_headings_may_be_typed_in_small_letters(compared):
    slips = [(r"^TIME= 0\.100", "Time= 0.100"), ("^POSITION", "Position"), ("^VELOCITY", "velocity")]
    code, output, _ = compared(
        [*slips, (r"^BODY  dX", "body  dX"), (r"^POINTS OF INTEREST\nNo", "points of interest\nno")]
    )
    assert code == 0, output


def test_one_line_that_is_missing_is_one_line(compared):
    _, output, _ = compared([(r"^  3    -5\.746.*\n", "")])
    assert "position: 1 line of typed is not" not in output
    assert re.search(r"^position: 1 line of \S+ is not in typed: body 3 at t = 0$", output, re.MULTILINE)
