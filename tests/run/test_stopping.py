"""A stop that lands where libraries turn it into exceptions of their own."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import click
import h5py
import pytest

from flexmb_cli import cli as commands
from flexmb_cli.cli.run import stop_on_signals
from flexmb_cli.errors import LACK_OF_MEMORY
from flexmb_cli.run import deck
from flexmb_cli.run.outcome import INTERRUPTED, TERMINATED, Listener, RunOptions, Stop, Terminated
from flexmb_cli.write.result_file import ResultFile
from tests.run.dafms_runs import ENDINGS, run

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


def raising(fault):
    def advance(rows):
        raise fault

    return Listener(advance=advance)


@pytest.mark.parametrize("path", ["young/IN4-BAR.dat", "dafms/pendulum.DAT"])
def test_what_was_solved_before_the_memory_was_used_up_is_kept(tmp_path, path):
    outcome = deck.run_deck(str(DECKS / path), RunOptions(folder=str(tmp_path)), raising(MemoryError()))
    assert (outcome.exit_code, [fault.message for fault in outcome.faults][-1:]) == (1, [LACK_OF_MEMORY])
    (found,) = (name for name in outcome.files if name.endswith(".h5"))
    with h5py.File(found) as result:
        assert (result.attrs["status"], result.attrs["message"]) == ("failed", LACK_OF_MEMORY)
        assert len(result["time"]) == outcome.rows > 0


@pytest.mark.long_motion
def test_a_run_that_lacked_memory_goes_on_with_resume(tmp_path):
    outcome = run("pendulum", tmp_path / "stopped", raising(MemoryError()))
    assert outcome.resumable
    assert run("pendulum", tmp_path / "stopped", resume=True).exit_code == 0
    run("pendulum", tmp_path / "whole")
    for ending in ENDINGS:
        one, other = (tmp_path / folder / f"pendulum.{ending}" for folder in ("stopped", "whole"))
        assert one.read_bytes() == other.read_bytes(), ending


@pytest.mark.parametrize("path", ["young/IN4-BAR.dat", "dafms/pendulum.DAT"])
def test_a_fault_of_flexmb_itself_keeps_what_was_solved(tmp_path, path):
    with pytest.raises(ZeroDivisionError):
        deck.run_deck(str(DECKS / path), RunOptions(folder=str(tmp_path)), raising(ZeroDivisionError("x")))
    (found,) = tmp_path.glob("*.h5")
    with h5py.File(found) as result:
        assert result.attrs["message"] == "a fault of flexmb itself: ZeroDivisionError: x"
        assert len(result["time"]) > 0


def test_a_fault_in_the_midst_of_writing_a_block_leaves_the_older_results(tmp_path, monkeypatch):
    """The table would have rows that the HDF5 file lacks."""
    assert deck.run_deck(DECK, RunOptions(folder=str(tmp_path))).exit_code == 0
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}

    def torn(*arguments):
        raise MemoryError

    monkeypatch.setattr(ResultFile, "rows", torn)
    assert deck.run_deck(DECK, RunOptions(folder=str(tmp_path))).exit_code == 1
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == before


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
