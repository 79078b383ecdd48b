"""A stop that lands where libraries turn it into exceptions of their own."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import click
import pytest

from flexmb_cli import cli as commands
from flexmb_cli.cli.run import stop_on_signals
from flexmb_cli.run import deck
from flexmb_cli.run.outcome import INTERRUPTED, TERMINATED, Listener, RunOptions, Stop, Terminated

DECKS = Path(__file__).resolve().parents[2] / "decks"
DECK = str(DECKS / "young/IN1-1-1.dat")


def swallowing(*arguments):
    """What numba does when it is interrupted while it compiles."""
    try:
        raise Terminated
    except Terminated:
        raise SystemError("a callback returned a result with an exception set") from None


@pytest.mark.parametrize("asked, code", [(Terminated, TERMINATED), (KeyboardInterrupt, INTERRUPTED)])
def test_a_stop_that_became_another_exception_is_still_a_stop(monkeypatch, asked, code):
    monkeypatch.setitem(deck.RUNNERS, "young", swallowing)
    monkeypatch.setattr(Stop, "asked", asked)
    assert deck.run_deck(DECK, RunOptions()).exit_code == code


@pytest.mark.parametrize("path", ["young/IN4-BAR.dat", "dafms/sliding_mass.DAT"])
def test_a_stop_that_got_lost_is_heeded_after_the_block_of_rows(tmp_path, monkeypatch, path):
    monkeypatch.setattr(Stop, "asked", None)
    lost = Listener(begin=lambda rows: setattr(Stop, "asked", KeyboardInterrupt))
    outcome = deck.run_deck(str(DECKS / path), RunOptions(folder=str(tmp_path)), lost)
    assert outcome.exit_code == INTERRUPTED and outcome.files


def test_a_fault_without_a_stop_stays_a_fault(monkeypatch):
    monkeypatch.setitem(deck.RUNNERS, "young", swallowing)
    with pytest.raises(SystemError):
        deck.run_deck(DECK, RunOptions())


def test_a_stop_while_files_are_opened_or_put_in_their_places_waits(monkeypatch):
    monkeypatch.setattr(Stop, "asked", None)
    before = [signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)]
    try:
        stop_on_signals()
        with Stop.later():
            signal.raise_signal(signal.SIGTERM)
            assert Stop.asked is Terminated
        with pytest.raises(Terminated):
            Stop.heed()
        with pytest.raises(Terminated):
            signal.raise_signal(signal.SIGTERM)
    finally:
        signal.signal(signal.SIGINT, before[0])
        signal.signal(signal.SIGTERM, before[1])


@pytest.mark.skipif(sys.platform == "win32", reason="SIGTERM is Unix's")
def test_other_commands_are_stopped_without_a_traceback(tmp_path):
    """A dialogue waits for an answer; its draft is kept and the message says so."""
    command = [sys.executable, "-m", "flexmb_cli", "new", "young", "--draft", "-o", tmp_path / "IN-X.dat"]
    process = subprocess.Popen(command, stdin=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    process.stdin.write("a crank\n")
    process.stdin.flush()
    while not (tmp_path / "IN-X.dat.draft").exists():
        assert process.poll() is None
        time.sleep(0.02)
    process.send_signal(signal.SIGTERM)
    assert process.wait(timeout=60) == 143
    said = process.stderr.read()
    assert "terminated; no deck is written, the answers so far are in" in said
    assert "Traceback" not in said
    process.stdin.close(), process.stderr.close()


def test_the_end_of_a_damaged_file_is_not_taken_for_the_end_of_the_dialogue(monkeypatch, capsys):
    """click takes every EOFError for Ctrl-D."""

    def damaged(*arguments, **options):
        try:
            raise EOFError("Ran out of input")
        except EOFError as fault:
            raise click.Abort from fault

    monkeypatch.setattr(commands.cli, "main", damaged)
    monkeypatch.setattr(sys, "unraisablehook", sys.unraisablehook)
    before = signal.getsignal(signal.SIGTERM)
    try:
        with pytest.raises(SystemExit) as ended:
            commands.main()
    finally:
        signal.signal(signal.SIGTERM, before)
    assert ended.value.code == 3
    assert "Ran out of input" in capsys.readouterr().err


def test_a_command_in_a_folder_that_is_gone_says_so(tmp_path):
    code = (
        "import os, sys; os.rmdir(os.getcwd()); sys.argv = ['flexmb', 'run', sys.argv[1]]; "
        "from flexmb_cli.cli import main; main()"
    )
    gone = tmp_path / "gone"
    gone.mkdir()
    path = os.pathsep.join([str(DECKS.parent), os.environ.get("PYTHONPATH", "")])
    done = subprocess.run(
        [sys.executable, "-c", code, DECK], cwd=gone, capture_output=True, text=True, timeout=120,
        env=os.environ | {"PYTHONPATH": path},
    )  # fmt: skip
    assert (done.returncode, done.stderr) == (
        2,
        "flexmb: error: the current folder does not exist any more\n",
    )
