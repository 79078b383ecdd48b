"""A stop that lands where libraries turn it into exceptions of their own."""

import json
import signal
import subprocess
import sys
import time
from functools import partial
from pathlib import Path

import h5py
import pytest
from click.testing import CliRunner

from flexmb_cli import cli as commands
from flexmb_cli.errors import Fault
from flexmb_cli.results.diff.compare import compare
from flexmb_cli.run import modes
from flexmb_cli.run import solution as deck
from flexmb_cli.run.check import check
from flexmb_cli.run.outcome import INTERRUPTED, TERMINATED, Listener, RunOptions, Stop, Terminated
from flexmb_cli.run.processes.signal_mask import stop_on_signals
from flexmb_cli.run.solutions import kinematic
from flexmb_cli.run.verify import verify
from tests.run.dafms_runs import run

DECKS = Path(__file__).resolve().parents[2] / "decks"
DECK, OTHER = str(DECKS / "young/IN1-1-1.dat"), str(DECKS / "young/IN4-BAR.dat")


def swallowing(*arguments):
    """What numba does when it is interrupted while it compiles."""
    try:
        raise Terminated
    except Terminated:
        raise SystemError("a callback returned a result with an exception set") from None


@pytest.mark.parametrize("asked, code", [(Terminated, TERMINATED), (KeyboardInterrupt, INTERRUPTED)])
def test_a_stop_that_became_another_exception_is_still_a_stop(monkeypatch, asked, code):
    monkeypatch.setattr(deck, "solve_deck", swallowing)
    monkeypatch.setattr(Stop, "asked", asked)
    assert deck.run_deck(DECK, RunOptions()).exit_code == code


@pytest.mark.parametrize("path", ["young/IN4-BAR.dat", "dafms/pendulum.DAT"])
def test_a_stop_that_got_lost_is_heeded_after_the_block_of_rows(tmp_path, monkeypatch, path):
    monkeypatch.setattr(Stop, "asked", None)
    lost = Listener(begin=lambda rows: setattr(Stop, "asked", KeyboardInterrupt))
    outcome = deck.run_deck(str(DECKS / path), RunOptions(folder=str(tmp_path)), lost)
    assert outcome.exit_code == INTERRUPTED and outcome.files


class StoppedAtTheEnd:
    """Sends SIGTERM when the last row has been kept."""

    def __init__(self):
        self.left = 0
        self.listener = Listener(partial(setattr, self, "left"), self.advance)

    def advance(self, rows):
        self.left -= rows
        if not self.left:
            signal.raise_signal(signal.SIGTERM)


@pytest.mark.parametrize("path", ["young/IN4-BAR.dat", "dafms/sliding_mass.DAT"])
def test_a_stop_behind_the_last_row_leaves_a_complete_run(tmp_path, monkeypatch, path):
    """It would be marked as a stopped one; the next deck is not begun."""
    monkeypatch.setattr(Stop, "asked", None)
    stop_on_signals()
    options = RunOptions(folder=str(tmp_path))
    outcome = deck.run_deck(str(DECKS / path), options, StoppedAtTheEnd().listener)
    assert outcome.exit_code == 0 and Stop.asked is Terminated
    (found,) = tmp_path.glob("*.h5")
    with h5py.File(found) as result:
        assert result.attrs["status"] == "complete"


def test_who_stops_a_run_before_it_looks_at_its_resume_file_is_told_of_it(tmp_path, monkeypatch):
    (tmp_path / "pendulum.resume").write_text("{")
    monkeypatch.setattr("flexmb_cli.run.solution.model_of", partial(raised, KeyboardInterrupt()))
    assert run("pendulum", tmp_path, resume=True).resumable
    assert not run("pendulum", tmp_path).resumable


def test_a_stop_between_opening_a_resume_file_and_going_on_with_it_is_told_of_it(tmp_path, monkeypatch):
    run("pendulum", tmp_path, raising(KeyboardInterrupt()))
    early = Listener(begin=partial(raised, Terminated()))
    outcome = run("pendulum", tmp_path, early, resume=True)
    assert (outcome.exit_code, outcome.resumable) == (TERMINATED, True)


def raising(fault):
    def advance(rows):
        raise fault

    return Listener(advance=advance)


def raised(fault, *arguments):
    raise fault


@pytest.mark.parametrize("stop, code", [(Terminated, TERMINATED), (KeyboardInterrupt, INTERRUPTED)])
@pytest.mark.parametrize("command, home", [("check", check), ("modes", modes), ("verify", verify)])
def test_a_stopped_command_prints_records_of_all_decks_and_begins_no_other(
    monkeypatch, command, home, stop, code
):
    begun = []

    def stopped(path, *arguments):
        begun.append(path)
        Stop.asked = stop
        raise stop

    monkeypatch.setattr(Stop, "asked", None)
    monkeypatch.setattr("flexmb_cli.cli.options.deck_options.stop_on_signals", lambda: None)
    monkeypatch.setattr(home, "open_deck", stopped)
    found = CliRunner().invoke(commands.cli, [command, DECK, OTHER, "--json"])
    assert found.exit_code == code and f"{DECK}: interrupted" in found.stderr
    records = [json.loads(line) for line in found.stdout.splitlines()]
    reported = [(record["deck"], record["status"]) for record in records]
    assert reported == [(DECK, "interrupted"), (OTHER, "interrupted")] and begun == [DECK]


@pytest.mark.parametrize(("stop", "code"), [(KeyboardInterrupt, 130), (Terminated, 143)])
def test_a_study_that_is_stopped_while_it_is_read_has_its_record(monkeypatch, capsys, stop, code):
    def stopped(*given):
        raise stop

    monkeypatch.setattr("flexmb_cli.study.sweep.Sweep.of", stopped)
    monkeypatch.setattr(sys, "argv", ["flexmb", "sweep", "study.toml", "--json"])
    with pytest.raises(SystemExit) as ended:
        commands.main()
    assert ended.value.code == code
    assert json.loads(capsys.readouterr().out) == {"status": "interrupted", "exit_code": code, "faults": []}


def test_what_a_stopped_run_was_warned_of_is_told_and_kept(tmp_path, monkeypatch):
    note = Fault("note", "two motions cross")
    warned = partial(with_warning, note, kinematic.solution)
    monkeypatch.setattr(kinematic, "solution", warned)
    outcome = deck.run_deck(DECK, RunOptions(folder=str(tmp_path)), raising(KeyboardInterrupt()))
    assert note in outcome.faults
    with h5py.File(tmp_path / "OUT1-1-1.h5") as result:
        assert result.attrs["notes"] == "two motions cross"


def with_warning(note, make, *arguments):
    solution = make(*arguments)
    solution.warnings.append(note)
    return solution


@pytest.mark.parametrize(
    "path", ["young/IN4-BAR.dat", pytest.param("vsdf/pendulum.vsdf", marks=pytest.mark.long_motion)]
)
def test_the_table_of_a_stopped_run_says_so(tmp_path, path):
    """Without an HDF5 result beside it nothing else would."""
    options = RunOptions(folder=str(tmp_path), no_h5=True)
    outcome = deck.run_deck(str(DECKS / path), options, raising(KeyboardInterrupt()))
    (table,) = outcome.files
    whole, stopped = tmp_path / "whole.OUT", tmp_path / "stopped.OUT"
    stopped.write_bytes(Path(table).read_bytes())
    assert deck.run_deck(str(DECKS / path), options).exit_code == 0
    whole.write_bytes(Path(table).read_bytes())
    marks = {"young": "RUN STOPPED", "vsdf": "THE RUN ENDED BEFORE THE LAST TIME"}
    assert any(marks[path[: path.index("/")]] in reported for reported in compare(whole, stopped).missing)


@pytest.mark.parametrize("how", ["kane", pytest.param("absolute", marks=pytest.mark.long_motion), "resumed"])
def test_the_series_of_a_stopped_tree_end_with_the_note_of_a_stop(tmp_path, how):
    options = {"no_h5": True, "formulation": "absolute" if how == "absolute" else "kane"}
    outcome = run("pendulum", tmp_path, raising(KeyboardInterrupt()), **options)
    if how == "resumed":
        outcome = run("pendulum", tmp_path, raising(KeyboardInterrupt()), resume=True, **options)
    assert outcome.exit_code == INTERRUPTED
    rows = len((tmp_path / "pendulum.T2").read_text().splitlines())
    assert "TOL,XEND,H,,METH,MITER,INDEX" in (tmp_path / "pendulum.T3").read_text().splitlines()[rows]


def test_what_was_solved_before_a_warning_became_an_error_is_kept(tmp_path):
    """Steps so coarse that the energy strays, which is told at the end."""
    coarse = {"integration": {"rtol": 0.05, "atol": 0.5}}
    outcome = run("spatial_rigid", tmp_path, strict=True, **coarse)
    assert (outcome.exit_code, outcome.rows) == (2, 201)
    with h5py.File(tmp_path / "spatial_rigid.h5") as result:
        assert result.attrs["status"] == "failed" and "energy" in result.attrs["message"]
        assert len(result["time"]) == 201
    assert not (tmp_path / "spatial_rigid.resume").exists()


def test_a_stop_while_files_are_opened_or_put_in_their_places_waits(monkeypatch):
    monkeypatch.setattr(Stop, "asked", None)
    stop_on_signals()
    with pytest.raises(Terminated), Stop.released():
        with Stop.later():
            signal.raise_signal(signal.SIGTERM)
            assert Stop.asked is Terminated
        Stop.raise_if_asked()


def test_who_is_told_to_stop_twice_is_stopped_once(monkeypatch):
    """The second would come in the midst of keeping what there is."""
    monkeypatch.setattr(Stop, "asked", None)
    stop_on_signals()
    with Stop.released():
        with pytest.raises(Terminated):
            signal.raise_signal(signal.SIGTERM)
        signal.raise_signal(signal.SIGTERM)
        with pytest.raises(Terminated):
            Stop.raise_if_asked()


def test_a_stop_is_raised_only_where_it_is_released(monkeypatch):
    monkeypatch.setattr(Stop, "asked", None)
    stop_on_signals()
    signal.raise_signal(signal.SIGTERM)
    Stop.raise_if_asked()
    with pytest.raises(Terminated), Stop.released():
        pytest.fail("it had come before")
    assert Stop.held == 1


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
