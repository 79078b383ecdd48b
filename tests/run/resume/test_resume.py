"""Runs that are stopped, and go on to the same bytes."""

import os
import random
import signal
import subprocess
import sys
import time

import h5py
import pytest

from flexmb_cli.run.checkpoint import ResumeFile
from flexmb_cli.run.outcome import Listener
from flexmb_cli.solvers.tree import steps
from tests.run.dafms_runs import DECKS, ENDINGS, NAMES, altered, run, stop_after


def error_of(outcome):
    """What ended the run; notes may follow it."""
    return next(fault.message for fault in reversed(outcome.faults) if fault.severity == "error")


def same_bytes(one, other, name):
    for ending in ENDINGS:
        assert (one / f"{name}.{ending}").read_bytes() == (other / f"{name}.{ending}").read_bytes(), ending


def rows_of_two_and_three_blocks(name):
    """Rows in so many blocks of 23, which a change of a torque or the end of the run ends early."""
    if name.startswith("shaft"):
        return 46, 51  # the torque jumps at 0.05 s, row 50
    return {"motor_gear": (41, 64), "stiff_arm": (46, 61)}.get(name, (46, 69))  # motor: 0.2 s, row 40


@pytest.mark.long_motion
@pytest.mark.parametrize("name", NAMES)
def test_a_run_stopped_twice_and_resumed_gives_the_bytes_of_an_uninterrupted_one(tmp_path, monkeypatch, name):
    whole, stopped = tmp_path / "whole", tmp_path / "stopped"
    run(name, whole)
    monkeypatch.setattr(steps, "LARGEST_BLOCK", 23)
    first = run(name, stopped, stop_after(2))
    rows = rows_of_two_and_three_blocks(name)
    assert (first.exit_code, first.rows, first.resumable) == (130, rows[0], True)
    second = run(name, stopped, stop_after(3), resume=True)
    assert (second.exit_code, second.rows) == (130, rows[1])
    last = run(name, stopped, resume=True)
    assert (last.exit_code, last.status) == (0, "complete")
    assert sorted(path.name for path in stopped.iterdir()) == sorted(f"{name}.{e}" for e in ENDINGS)
    same_bytes(whole, stopped, name)


@pytest.mark.long_motion
@pytest.mark.parametrize("method", ["radau", "lsoda"])
def test_other_integrators_resume_to_the_same_bytes(tmp_path, method):
    whole, stopped = tmp_path / "whole", tmp_path / "stopped"
    settings = {"integration": {"method": method, "rtol": 1e-6, "atol": 1e-6}}
    run("shaft_beam_n2", whole, **settings)
    assert run("shaft_beam_n2", stopped, stop_after(40), **settings).exit_code == 130
    assert run("shaft_beam_n2", stopped, resume=True, **settings).exit_code == 0
    same_bytes(whole, stopped, "shaft_beam_n2")


@pytest.mark.long_motion
def test_an_interrupted_run_is_marked_and_keeps_its_rows(tmp_path):
    outcome = run("pendulum", tmp_path, stop_after(2))
    assert outcome.status == "interrupted"
    with h5py.File(tmp_path / "pendulum.h5") as file:
        assert (file.attrs["status"], file.attrs["message"]) == ("failed", "interrupted")
        assert file["coordinate/q"].shape == (2048, 2)
    assert len((tmp_path / "pendulum.T2").read_text().splitlines()) == 2048
    assert (tmp_path / "pendulum.resume").exists()


@pytest.mark.long_motion
def test_resuming_without_a_stopped_run_starts_at_the_beginning_and_says_so(tmp_path):
    said = []
    outcome = run("spatial_rigid", tmp_path, Listener(notice=said.append), resume=True)
    assert (outcome.exit_code, outcome.rows) == (0, 201)
    assert "nothing to resume; the run starts at its beginning" in [fault.sentence for fault in said]


@pytest.mark.long_motion
@pytest.mark.parametrize(
    ("options", "difference"),
    [
        ({"integration": {"rtol": 1e-8}}, "rtol was 1e-12, is 1e-08"),
        ({"integration": {"atol": 1e-8}}, "atol was 1e-14, is 1e-08"),
        ({"changes": ("time.IT=50",)}, '--set was [], is ["time.IT=50"]'),
    ],
)
def test_a_run_with_other_options_is_not_resumed(tmp_path, options, difference):
    run("pendulum", tmp_path, stop_after(1))
    resume_file = (tmp_path / "pendulum.resume").read_bytes()
    outcome = run("pendulum", tmp_path, resume=True, **options)
    assert outcome.exit_code == 2
    assert error_of(outcome) == (
        f"--resume: {tmp_path / 'pendulum.resume'} is of another run: {difference}; "
        "run without --resume to start again"
    )
    assert (tmp_path / "pendulum.resume").read_bytes() == resume_file


@pytest.mark.long_motion
def test_a_run_of_another_deck_or_version_is_not_resumed(tmp_path, monkeypatch):
    deck = altered(tmp_path, "pendulum")
    run(deck, tmp_path, stop_after(1))
    altered(tmp_path, "pendulum", ("STOP", "STOP "))
    outcome = run(deck, tmp_path, resume=True)
    assert outcome.exit_code == 2
    assert "text of the deck was " in error_of(outcome)
    altered(tmp_path, "pendulum")
    monkeypatch.setattr("flexmb_cli.run.solution.__version__", "9.9.9")
    outcome = run(deck, tmp_path, resume=True)
    assert outcome.exit_code == 2
    assert "is 9.9.9" in error_of(outcome)


@pytest.mark.long_motion
def test_a_run_without_resume_starts_anew(tmp_path):
    run("pendulum", tmp_path, stop_after(1))
    outcome = run("pendulum", tmp_path, changes=("time.IT=50",))
    assert (outcome.exit_code, outcome.rows) == (0, 51)
    assert not (tmp_path / "pendulum.resume").exists()


@pytest.mark.long_motion
def test_a_run_interrupted_before_its_first_row_sets_the_old_results_aside(tmp_path):
    run("pendulum", tmp_path)
    old = (tmp_path / "pendulum.h5").read_bytes()

    def stop(rows):
        raise KeyboardInterrupt

    outcome = run("pendulum", tmp_path, Listener(begin=stop))
    assert (outcome.exit_code, outcome.files) == (130, ())
    assert (tmp_path / "pendulum.h5.stale").read_bytes() == old


def command(folder, *more):
    deck = str(DECKS / "pendulum.DAT")
    return [sys.executable, "-m", "flexmb_cli", "run", deck, "-q", "-o", str(folder), *more]


def kill_when_grown(arguments, resume_file, growth):
    """Start a run and kill it when its resume file has grown; False when it ended before."""
    before = resume_file.stat().st_size if resume_file.exists() else 0
    process = subprocess.Popen(arguments)
    while process.poll() is None:
        if resume_file.exists() and resume_file.stat().st_size > before + growth:
            process.send_signal(signal.SIGKILL)
            process.wait()
            return True
        time.sleep(0.002)
    return False


@pytest.mark.campaign  # the fast pass kills runs in tests/scripts/test_fault_injection.py
@pytest.mark.processes
@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="kill is Unix's")
def test_a_run_killed_ten_times_goes_on_to_the_same_bytes(tmp_path):
    """Each kill comes after the journal has grown by a random amount, at whatever moment that is."""
    whole, killed = tmp_path / "whole", tmp_path / "killed"
    longer = ("--set", "time.IT=60000")
    subprocess.run(command(whole, *longer), check=True, timeout=300)
    draw = random.Random(1992)
    for _ in range(10):
        growth = draw.randint(2_000, 1_200_000)
        assert kill_when_grown(command(killed, "--resume", *longer), killed / "pendulum.resume", growth)
    assert not (killed / "pendulum.h5").exists()
    subprocess.run(command(killed, "--resume", *longer), check=True, timeout=300)
    same_bytes(whole, killed, "pendulum")
    assert sorted(os.listdir(killed)) == sorted(f"pendulum.{ending}" for ending in ENDINGS)


@pytest.mark.processes
@pytest.mark.skipif(sys.platform == "win32", reason="limits of the file size are Unix's")
def test_a_disk_that_fills_up_ends_the_run_which_goes_on_when_there_is_room(tmp_path):
    """The limit of the file size stands for the full disk; the journal or a result meets it first."""
    whole, full = tmp_path / "whole", tmp_path / "full"
    run("pendulum", whole)
    limited = "import resource; resource.setrlimit(resource.RLIMIT_FSIZE, (400_000, 400_000)); "
    code = f"{limited}from flexmb_cli.cli import main; main()"
    done = subprocess.run(
        [sys.executable, "-c", code, *command(full)[3:]], capture_output=True, text=True, timeout=300
    )
    assert done.returncode == 1
    assert "no space left for the result" in done.stderr
    assert os.listdir(full) == ["pendulum.resume"]
    assert run("pendulum", full, resume=True).exit_code == 0
    same_bytes(whole, full, "pendulum")


def hear_interrupts():
    """A suite that runs in the background of a shell ignores SIGINT, and so would its children."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


@pytest.mark.processes
@pytest.mark.parametrize("sent", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_keeps_the_rows_and_says_how_to_go_on(tmp_path, sent):
    arguments = [part for part in command(tmp_path, "--set", "time.IT=1000000") if part != "-q"]
    process = subprocess.Popen(arguments, stderr=subprocess.PIPE, text=True, preexec_fn=hear_interrupts)
    resume_file = tmp_path / "pendulum.resume"
    while process.poll() is None and not (resume_file.exists() and resume_file.stat().st_size > 300_000):
        time.sleep(0.01)
    process.send_signal(sent)
    message = process.communicate(timeout=60)[1]
    assert process.returncode == 128 + sent
    assert message.splitlines()[-1].endswith("; --resume continues it")
    with h5py.File(tmp_path / "pendulum.h5") as file:
        assert (file.attrs["status"], file.attrs["message"]) == ("failed", "interrupted")
        assert file["time"].shape[0] >= 256
    assert resume_file.exists()


def test_a_setting_that_one_of_two_runs_lacks_is_called_not_given():
    """Of a mechanism the message was `rtol was null, is 1e-05`."""
    kept = ResumeFile.__new__(ResumeFile)
    kept.path, kept.identity = "a.resume", {"rtol": 1e-5}
    assert "is of another run: rtol was not given, is 1e-05;" in kept._refusal({"rtol": None}, ["rtol"])
