"""Runs that lack memory or meet a fault of flexmb: what was solved is kept, and the exit code says why."""

import errno
import importlib
import io
import json
import os
import signal
import subprocess
import sys
from functools import partial

import click
import h5py
import pytest
from click.testing import CliRunner

from flexmb_cli import cli as commands
from flexmb_cli import memory
from flexmb_cli.cli.terminal.screen import OutputText
from flexmb_cli.errors import OutputError
from flexmb_cli.memory import LACK_OF_MEMORY
from flexmb_cli.results.files.replaced_file import located
from flexmb_cli.results.hdf5.result_file import ResultFile
from flexmb_cli.run import modes
from flexmb_cli.run import solution as deck
from flexmb_cli.run.check import check
from flexmb_cli.run.outcome import Listener, RunOptions, StreamError
from flexmb_cli.run.verify import verify
from tests.run.dafms_runs import ENDINGS, run
from tests.run.test_stopping import DECK, DECKS, OTHER, raised, raising, swallowing


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
    """What the exception says may hold a path, and is not in the result."""
    fault = ZeroDivisionError("/home/me/x.py")
    outcome = deck.run_deck(str(DECKS / path), RunOptions(folder=str(tmp_path)), raising(fault))
    assert outcome.exit_code == 3 and "/home/me/x.py" in outcome.faults[-1].message
    (found,) = tmp_path.glob("*.h5")
    with h5py.File(found) as result:
        assert result.attrs["message"] == "a fault of flexmb itself: ZeroDivisionError"
        assert len(result["time"]) > 0


def test_a_fault_in_the_midst_of_writing_a_block_sets_the_older_results_aside(tmp_path, monkeypatch):
    """The table would have rows that the HDF5 file lacks."""
    assert deck.run_deck(DECK, RunOptions(folder=str(tmp_path))).exit_code == 0
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}

    def torn(*arguments):
        raise MemoryError

    monkeypatch.setattr(ResultFile, "rows", torn)
    assert deck.run_deck(DECK, RunOptions(folder=str(tmp_path))).exit_code == 1
    stale = {f"{name}.stale": content for name, content in before.items()}
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == stale


@pytest.mark.parametrize("fault", [MemoryError(), OutputError("X.h5: no space left", 1)])
def test_a_table_on_standard_output_that_breaks_off_says_so(monkeypatch, tmp_path, fault):
    """It has rows that the HDF5 file lacks, which is thrown away."""
    monkeypatch.setattr(ResultFile, "rows", partial(raised, fault))
    page = io.StringIO()
    options = RunOptions(folder=str(tmp_path), out="-")
    assert deck.run_deck(DECK, options, stdout=page).exit_code == 1
    assert "TIME=" in page.getvalue() and page.getvalue().endswith("-----RUN STOPPED-----\n")


def test_a_fault_before_the_first_row_leaves_standard_output_alone(monkeypatch, tmp_path):
    page = io.StringIO()
    options = RunOptions(folder=str(tmp_path), out="-")
    fails = Listener(begin=partial(raised, MemoryError()))
    assert deck.run_deck(DECK, options, fails, page).exit_code == 1
    assert page.getvalue() == ""


def test_a_fault_without_a_stop_stays_a_fault(monkeypatch):
    monkeypatch.setattr(deck, "solve_deck", swallowing)
    outcome = deck.run_deck(DECK, RunOptions())
    assert outcome.exit_code == 3
    assert outcome.faults[0].message.startswith("a fault of flexmb itself: SystemError: a callback")
    with pytest.raises(SystemError):
        deck.run_deck(DECK, RunOptions(debug=True))


@pytest.mark.parametrize(
    ("fault", "code"),
    [
        (MemoryError(), 1),
        (OSError(errno.ENOMEM, "Cannot allocate memory"), 1),
        (OSError("libllvmlite.so cannot be loaded"), 1),
        (ImportError("failed to map segment"), 1),
        (OSError("Can't write data (memory allocation failed for file family)"), 1),
        (ModuleNotFoundError("No module named 'h5py'"), 3),
        (SystemError("returned NULL without setting an exception"), 3),
    ],
)
def test_want_of_memory_is_told_from_faults(monkeypatch, fault, code):
    monkeypatch.setattr(deck, "open_deck", partial(raised, fault))
    outcome = deck.run_deck(DECK, RunOptions())
    assert outcome.exit_code == code
    assert ("memory" in outcome.faults[0].message) == (code == 1)


@pytest.mark.parametrize("fault", [ImportError("libc: not found"), OSError("libllvmlite.so: no such file")])
def test_a_library_that_cannot_be_loaded_is_named(monkeypatch, fault):
    """Whether memory is short cannot be seen from it."""
    monkeypatch.setattr(deck, "open_deck", partial(raised, fault))
    reported = deck.run_deck(DECK, RunOptions()).faults[0].message
    assert reported.endswith(f"for want of memory or a broken installation: {fault}")


def test_a_library_that_trips_where_no_memory_is_left_lacks_memory(monkeypatch):
    monkeypatch.setattr(memory, "require_memory", short_of_memory)
    monkeypatch.setattr(deck, "open_deck", partial(raised, SystemError("NULL without an exception")))
    outcome = deck.run_deck(DECK, RunOptions())
    assert (outcome.exit_code, outcome.faults[0].message) == (1, LACK_OF_MEMORY)


@pytest.mark.parametrize(
    "fault", [OSError(errno.ENOMEM, "Cannot allocate memory"), OSError("memory allocation failed")]
)
def test_a_file_that_lacks_memory_is_none_that_cannot_be_written(fault):
    with pytest.raises(MemoryError), located("OUT.h5"):
        raise fault


def test_what_the_system_refuses_one_deck_ends_that_deck_only(monkeypatch):
    monkeypatch.setattr(deck, "open_deck", partial(raised, OSError(errno.EMFILE, "Too many open files")))
    found = CliRunner().invoke(commands.cli, ["run", DECK, OTHER, "--json"])
    assert found.exit_code == 1
    records = [json.loads(line) for line in found.stdout.splitlines()]
    reported = [(record["deck"], record["faults"][0]["message"]) for record in records]
    assert reported == [(name, "the system refused: Too many open files") for name in (DECK, OTHER)]


def test_a_broken_standard_output_ends_the_call(monkeypatch, tmp_path):
    class Full(io.StringIO):
        def write(self, text):
            raise OSError(errno.ENOSPC, "No space left on device")

    options = RunOptions(folder=str(tmp_path), out="-")
    with pytest.raises(StreamError, match="No space left"):
        deck.run_deck(DECK, options, stdout=OutputText(Full()))
    assert not list(tmp_path.iterdir())


def short_of_memory(*arguments):
    raise MemoryError


@pytest.mark.parametrize(
    "command, home", [("run", deck), ("check", check), ("modes", modes), ("verify", verify)]
)
def test_every_deck_of_a_call_is_tried_where_one_ends_of_a_fault(monkeypatch, command, home):
    monkeypatch.setattr(home, "open_deck", short_of_memory)
    found = CliRunner().invoke(commands.cli, [command, DECK, OTHER, "--json"])
    assert found.exit_code == 1
    records = [json.loads(line) for line in found.stdout.splitlines()]
    assert [record["deck"] for record in records] == [DECK, OTHER]
    assert [record["faults"][0]["message"] for record in records] == [LACK_OF_MEMORY] * 2


def test_a_study_asks_for_memory_before_numpy_does(monkeypatch, capsys):
    """OpenBLAS would end the process, without a record."""
    monkeypatch.setattr(importlib.import_module("flexmb_cli.cli.sweep"), "require_memory", short_of_memory)
    monkeypatch.setattr(sys, "argv", ["flexmb", "sweep", "study.toml", "--json"])
    with pytest.raises(SystemExit) as ended:
        commands.main()
    record = json.loads(capsys.readouterr().out)
    assert (ended.value.code, record["status"], record["exit_code"]) == (1, "failed", 1)


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
