"""The status line of runs and studies, the lines of a log, and tables on narrow terminals."""

import io
import re
import shutil
import subprocess
import sys
import time
from pathlib import Path

import pytest

from flexmb_cli.cli.terminal import progress as module
from flexmb_cli.cli.terminal.progress import Progress
from flexmb_cli.cli.terminal.screen import fitted, say, wrapped
from flexmb_cli.errors import Fault
from tests.cli.terminal.test_terminal import at_a_terminal

DECKS = Path(__file__).resolve().parents[3] / "decks"


class Terminal(io.StringIO):
    """A stream that is a terminal, and what stands in its last line."""

    def isatty(self):
        return True

    @property
    def line(self):
        return self.getvalue().rpartition("\r\x1b[K")[2]


@pytest.fixture
def clock(monkeypatch):
    """A clock that the test sets."""
    now = [100.0]
    monkeypatch.setattr(module.time, "monotonic", lambda: now[0])
    return now


def test_a_long_path_loses_its_beginning_and_not_the_remaining_time(clock, monkeypatch):
    monkeypatch.setenv("COLUMNS", "60")
    stream = Terminal()
    with Progress("/home/professor/mechanisms/young/IN4-BAR.dat", "rows", False, False, stream) as shown:
        shown.begin(1000)
        shown.advance(10)
        clock[0] += 2
        shown.advance(100)
        assert stream.line == "…/IN4-BAR.dat: 110 of 1000 rows, 11 %, 50 rows/s, 0:18 left"


def test_the_line_tells_compiling_then_rows_with_rate_and_remaining_time(clock, monkeypatch):
    monkeypatch.setenv("COLUMNS", "100")
    stream = Terminal()
    with Progress("a.dat", "rows", False, False, stream) as shown:
        shown.status("compiling kernels")
        assert stream.line == "a.dat: compiling kernels"
        clock[0] += 20  # which is no part of the rate
        shown.begin(1000)
        # Kernels are compiled for the first rows: the line still says so, and that is no part of the rate.
        assert stream.line == "a.dat: compiling kernels"
        clock[0] += 30
        shown.advance(10)
        assert stream.line == "a.dat: 10 of 1000 rows"
        clock[0] += 2
        shown.advance(100)
        # 100 rows in 2 s are 50 a second; 890 are left for 17.8 s.
        assert stream.line == "a.dat: 110 of 1000 rows, 11 %, 50 rows/s, 0:18 left"
        shown.advance(1)
        assert "111" not in stream.line  # not more often than it can be read
        clock[0] += 98
        shown.advance(1)
        assert stream.line.endswith("112 of 1000 rows, 11 %, 1.02 rows/s, 14:31 left")
    assert stream.line == ""


def test_the_line_is_no_longer_than_the_terminal_is_wide(clock, monkeypatch):
    monkeypatch.setenv("COLUMNS", "30")
    stream = Terminal()
    shown = Progress("a-deck-of-a-long-name.dat", "rows", False, False, stream)
    shown.begin(100)
    assert stream.line == "…long-name.dat: 0 of 100 rows"


@pytest.mark.parametrize(("verbose", "lines"), [(False, 0), (True, 3)])
def test_a_log_has_a_line_every_ten_seconds_with_v_alone(clock, capsys, verbose, lines):
    shown = Progress("a.dat", "rows", False, verbose, io.StringIO())
    shown.begin(1000)
    for _ in range(35):
        clock[0] += 1
        shown.advance(10)
    reported = capsys.readouterr().err.splitlines()
    assert len(reported) == lines
    if lines:
        assert reported[0] == "a.dat: 100 of 1000 rows, 10 %, 10 rows/s, 1:30 left"


def test_a_log_tells_of_compiling_until_it_ends(capsys, monkeypatch):
    """The thread that compiles is busy: here it sleeps for several of the spans between two lines."""
    monkeypatch.setattr(module, "LOGGED_AFTER", 0.02)
    shown = Progress("a.dat", "rows", False, True, io.StringIO())
    shown.status("compiling kernels")
    time.sleep(0.15)
    shown.clear()
    first, *others = capsys.readouterr().err.splitlines()
    assert first == "a.dat: compiling kernels"
    assert len(others) >= 2 and set(others) == {"a.dat: compiling kernels: 0:00 so far"}
    time.sleep(0.06)
    assert capsys.readouterr().err == ""


def test_a_terminal_tells_of_compiling_and_for_how_long_beside_notices(capsys, monkeypatch):
    """The rows begin, and a notice comes, while the first kernel is compiled."""
    monkeypatch.setattr(module, "TICK", 0.02)
    stream = Terminal()
    with Progress("a.dat", "rows", False, False, stream) as shown:
        shown.status("compiling kernels")
        shown.begin(1000)
        time.sleep(0.15)
        assert stream.line == "a.dat: compiling kernels: 0:00 so far"
        shown.notice(Fault("note", "something else", id="RUN-064"))
        assert stream.line == ""
        time.sleep(0.15)
        assert stream.line == "a.dat: compiling kernels: 0:00 so far"
        shown.advance(10)
        shown.advance(10)
        time.sleep(0.15)
        assert "compiling" not in stream.line
    assert capsys.readouterr().err == "flexmb: note: something else\n"


@pytest.mark.parametrize("silent", [{"quiet": True, "verbose": True}, {"quiet": False, "verbose": False}])
def test_compiling_is_not_repeated_unless_asked(silent, capsys, monkeypatch):
    monkeypatch.setattr(module, "LOGGED_AFTER", 0.01)
    with Progress("a.dat", "rows", stream=io.StringIO(), **silent) as shown:
        shown.status("compiling kernels")
        time.sleep(0.05)
    assert capsys.readouterr().err == ""


def test_nothing_is_shown_with_q(clock):
    stream = Terminal()
    with Progress("a.dat", "rows", True, True, stream) as shown:
        shown.status("compiling")
        shown.begin(1000)
        clock[0] += 20
        shown.advance(10)
    assert stream.getvalue() == ""


@pytest.mark.processes
@pytest.mark.skipif(sys.platform == "win32", reason="pseudo-terminals are Unix's")
def test_a_study_shows_its_cases_and_leaves_no_status_line(tmp_path):
    shutil.copy(DECKS / "young/IN4-BAR.dat", tmp_path)
    (tmp_path / "study.toml").write_text(
        'deck = "IN4-BAR.dat"\n[parameters]\n"driver.1.B" = { from = 3.0, to = 3.2, count = 40 }\n'
        '[results]\ntop = "max body.3.z"\n'
    )
    shown = at_a_terminal("sweep", "study.toml", "-q", cwd=tmp_path, stream="stderr")
    assert shown == ""
    shown = at_a_terminal("sweep", "study.toml", cwd=tmp_path, stream="stderr")
    assert "study.toml: 0 of 40 cases" in shown
    assert shown.replace("\r\n", "\n").rpartition("\r\x1b[K")[2].startswith("study.toml: 40 cases → study.h5")


TABLE = "time [s]  body.1.x [m]  body.2.x [m]\n     0.1      -3.75312      -5.75312\n"


@pytest.mark.parametrize(
    ("width", "columns"), [(80, 3), (36, 3), (35, 2), (25, 2), (24, 2), (23, 1), (10, 1)]
)
def test_a_narrow_terminal_gets_fewer_columns_and_whole_numbers(width, columns):
    for whole, line in zip(TABLE.splitlines(), fitted(TABLE, width).splitlines(), strict=True):
        cells = re.split(r" {2,}", whole.strip())
        shown = re.split(r" {2,}", line.removesuffix(" …").strip())
        assert shown == cells[:columns]
        assert line.endswith(" …") == (columns < 3)
        assert len(line) <= width


def test_prose_is_left_to_wrap():
    sentence = "the run is not complete, its rows end at t = 1.5 s: the mechanism locks\n"
    assert fitted(sentence, 20) == sentence


def test_prose_of_check_wraps_between_words_below_its_beginning():
    """A line of columns is left to `fitted`; a name longer than the line stays whole."""
    text = "deck: YOUNG deck\n  equations 28, coordinates 28, times 26\n    driver 1   2.9e-03 →  1.8e-15 m\n"
    assert wrapped(text, 24) == (
        "deck: YOUNG deck\n  equations 28,\n    coordinates 28,\n    times 26\n"
        "    driver 1   2.9e-03 →  1.8e-15 m\n"
    )
    assert wrapped("a/path/without/any/blank.dat: it\n", 12) == "a/path/without/any/blank.dat:\n  it\n"


@pytest.mark.processes
@pytest.mark.skipif(sys.platform == "win32", reason="pseudo-terminals are Unix's")
def test_check_at_a_narrow_terminal_has_no_longer_line_and_all_words(monkeypatch):
    monkeypatch.setenv("COLUMNS", "60")
    shown = at_a_terminal("check", "IN4-BAR.dat", cwd=DECKS / "young", stream="stdout").replace("\r\n", "\n")
    assert max(map(len, shown.splitlines())) <= 60
    assert (
        "  equations 28, coordinates 28, degrees of freedom without\n    drivers 1, report times 26\n"
        in shown
    )


@pytest.mark.processes
@pytest.mark.skipif(sys.platform == "win32", reason="pseudo-terminals are Unix's")
def test_a_table_at_a_terminal_fits_and_in_a_pipe_is_whole(tmp_path, monkeypatch):
    run = [sys.executable, "-m", "flexmb_cli", "run", "-q", str(DECKS / "young/IN4-BAR.dat")]
    subprocess.run(run, cwd=tmp_path, check=True, timeout=300)
    asked = ["table", "OUT4-BAR.h5", "body.*.z", "-f", "text"]
    monkeypatch.setenv("COLUMNS", "40")
    lines = at_a_terminal(*asked, cwd=tmp_path).splitlines()
    # Four bodies, a block for each, with the time, its head and 26 rows; an empty line between two.
    assert len(lines) == 4 * 27 + 3
    assert all(len(line) <= 40 and len(line.split()) in (0, 2, 4) for line in lines)
    assert [line.split()[2] for line in lines if "time" in line] == [f"body.{k}.z" for k in (1, 2, 3, 4)]
    piped = subprocess.run(
        [sys.executable, "-m", "flexmb_cli", *asked], cwd=tmp_path, capture_output=True, text=True, timeout=60
    )
    assert all(len(line.split()) in (5, 10) for line in piped.stdout.splitlines())


def test_a_log_tells_of_waiting_for_the_first_case(monkeypatch, capsys):
    """Without it a study on a cluster, or one of long cases, was silent until its first case."""
    monkeypatch.setattr(module, "LOGGED_AFTER", 0.01)
    with Progress("s.toml", "cases", False, True, io.StringIO()) as shown:
        shown.begin(10)
        time.sleep(0.1)
        shown.advance(1)
    assert capsys.readouterr().err.startswith("s.toml: 0 of 10 cases: 0:00 so far\n")


def test_compiling_is_said_once_where_no_line_can_be_drawn(monkeypatch, capsys):
    """First runs took up to a minute in silence if standard error was a file."""
    monkeypatch.setattr(module, "SAID_AFTER", 0.05)
    monkeypatch.setattr(Progress, "said", False)
    for quiet in (True, False, False):
        with Progress("a.dat", "rows", quiet, False) as shown:
            shown.status("compiling kernels")
            time.sleep(0.4)
            shown.begin(10)
            shown.advance(10)
    said = capsys.readouterr().err.splitlines()
    assert len(said) == 1 and said[0].startswith("a.dat: compiling kernels")


def test_compiling_that_takes_less_is_not_said(monkeypatch, capsys):
    monkeypatch.setattr(Progress, "said", False)
    with Progress("a.dat", "rows", False, False) as shown:
        shown.status("compiling kernels")
        shown.begin(10)
        shown.advance(10)
    assert capsys.readouterr().err == ""


def test_messages_wrap_between_words_and_lines_of_decks_stay(monkeypatch):
    monkeypatch.setenv("COLUMNS", "40")
    stream = Terminal()
    monkeypatch.setattr(sys, "stderr", stream)
    message = "a.dat:3:1: error: universal joint 1: body number 9 is outside 1..4"
    line = "    1 9 0 0 2 0 6.10 0 0.75 -0.66 2 0 6.1 1 0 0 0"
    say(f"{message}\n{line}\n      ^")
    *sentence, deck, mark = stream.getvalue().splitlines()
    assert " ".join(part.strip() for part in sentence) == message
    assert len(sentence) == 2 and all(len(part) <= 40 for part in sentence)
    assert (deck, mark) == (line, "      ^")
