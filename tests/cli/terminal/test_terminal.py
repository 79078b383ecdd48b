"""What a stranger may have named or typed does not command the terminal that shows the message."""

import io
import os
import subprocess
import sys
from pathlib import Path

import pytest

from flexmb_cli.cli.terminal.screen import OutputText

pytestmark = pytest.mark.processes

DECKS = Path(__file__).resolve().parents[3] / "decks" / "vsdf"

ESCAPES = "\x1b[2J\x9b1m\u202e\x07"
CASES = {
    "a deck by its name": ["check", f"{ESCAPES}.dat"],
    "a result by its name": ["table", f"{ESCAPES}.h5", "time"],
    "an option's value": ["diff", "a", "b", "--tol", f"{ESCAPES}=1"],
    "a study by its name": ["sweep", f"{ESCAPES}.toml"],
}


@pytest.mark.parametrize("case", CASES)
def test_control_characters_are_shown_as_marks(tmp_path, case):
    done = subprocess.run(
        [sys.executable, "-m", "flexmb_cli", *CASES[case]], cwd=tmp_path, capture_output=True, timeout=120
    )
    message = done.stderr.decode("utf-8")
    assert done.returncode == 2
    assert "�" in message
    assert not set(ESCAPES) - set("[2J1m") & set(message)


def at_a_terminal(*arguments, cwd, stream="stdout", given=b""):
    """What a terminal gets of standard output, or of standard error."""
    import pty

    master, slave = pty.openpty()
    command = [sys.executable, "-m", "flexmb_cli", *arguments]
    streams = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL, stream: slave}
    with subprocess.Popen(command, cwd=cwd, stdin=subprocess.PIPE, **streams) as process:
        os.close(slave)
        process.stdin.write(given)
        process.stdin.close()
        shown = b""
        try:
            while piece := os.read(master, 65536):
                shown += piece
        except OSError:
            pass  # Linux tells the end of a terminal so
        assert process.wait(timeout=120) == 0
    os.close(master)
    return shown.decode("utf-8")


BEAM = [
    "beam",
    "--length",
    "1",
    "--nodes",
    "1",
    "--ei",
    "1",
    "--rho",
    "1",
    "--deck",
    "--title",
    "A \x1b[2J BEAM",
]


@pytest.mark.skipif(sys.platform == "win32", reason="pseudo-terminals are Unix's")
def test_a_title_does_not_steer_the_terminal_and_passes_a_pipe_untouched(tmp_path):
    assert "A �[2J BEAM" in at_a_terminal(*BEAM, cwd=tmp_path)
    piped = subprocess.run(
        [sys.executable, "-m", "flexmb_cli", *BEAM], cwd=tmp_path, capture_output=True, timeout=120
    )
    assert b"A \x1b[2J BEAM" in piped.stdout


def test_lines_of_a_listing_stay_lines():
    page = io.StringIO()
    page.isatty = lambda: True
    OutputText(page).write("one\ntw\x1b[31mo\rx\n")
    assert page.getvalue() == "one\ntw�[31mo�x\n"


def test_the_echo_of_a_deck_shows_marks(tmp_path):
    text = (DECKS / "spinup.vsdf").read_text().replace("SPIN-UP", "SPIN\x1b[31m-UP", 1)
    (tmp_path / "x.vsdf").write_text(text)
    (tmp_path / "fe").symlink_to(DECKS / "fe")
    done = subprocess.run(
        [sys.executable, "-m", "flexmb_cli", "check", "--echo", "x.vsdf"],
        cwd=tmp_path, capture_output=True, text=True, encoding="utf-8", timeout=120,
    )  # fmt: skip
    assert done.returncode == 0
    assert "SPIN�[31m-UP" in done.stdout
    assert "\x1b" not in done.stdout + done.stderr


NAME = "IN\x1b[31m\u202e\nx.dat"
REPORTS = {
    "check": ["check", NAME],
    "echo": ["check", "--echo", NAME],
    "run": ["run", "--no-h5", "--echo", NAME],
    "diff": ["diff", NAME, NAME],
    "update": ["diff", NAME, NAME, "--update"],
}


@pytest.mark.parametrize("report", REPORTS)
def test_file_names_are_masked_in_a_pipe_too(tmp_path, report):
    """What is piped into `less -R` or a log is shown by a terminal in the end."""
    (tmp_path / NAME).write_bytes((DECKS.parent / "young" / "IN1-1-1.dat").read_bytes())
    flexmb = [sys.executable, "-m", "flexmb_cli"]
    if report in ("diff", "update"):
        again = subprocess.run(
            [*flexmb, "run", NAME, "--no-h5", "-q", "--out", "x"], cwd=tmp_path, timeout=300
        )
        assert again.returncode == 0
        os.replace(tmp_path / "x", tmp_path / NAME)
    done = subprocess.run([*flexmb, *REPORTS[report]], cwd=tmp_path, capture_output=True, timeout=120)
    reported = (done.stdout + done.stderr).decode("utf-8")
    assert done.returncode == 0 and "IN�[31m��x.dat" in reported
    assert not set(reported) & set("\x1b\u202e")


@pytest.mark.skipif(sys.platform == "win32", reason="pseudo-terminals are Unix's")
@pytest.mark.parametrize(
    ("stream", "arguments"),
    [
        ("stderr", ["run", "--no-h5", "IN\x1b[31m\nx.dat"]),
        ("stdout", ["check", "IN\x1b[31m\nx.dat"]),
        ("stdout", ["diff", "OUT\x1b[31mx.dat", "OUT\x1b[31mx.dat"]),
    ],
)
def test_file_names_do_not_steer_the_terminal_that_is_told_of_success(tmp_path, stream, arguments):
    deck = (DECKS.parent / "young" / "IN1-1-1.dat").read_bytes()
    (tmp_path / "IN\x1b[31m\nx.dat").write_bytes(deck)
    at_a_terminal("run", "-", "--out", "OUT\x1b[31mx.dat", "--no-h5", cwd=tmp_path, given=deck)
    shown = at_a_terminal(*arguments, cwd=tmp_path, stream=stream)
    assert "�[31m" in shown
    assert "\x1b[31m" not in shown
