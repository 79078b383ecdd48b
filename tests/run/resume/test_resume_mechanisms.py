"""Mechanisms whose runs are stopped, and go on to the same bytes as those of a run without a stop."""

import json
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from flexmb_cli.run.checkpoint import LONGEST_UNSAVED, ResumeFile
from flexmb_cli.run.outcome import RunOptions
from flexmb_cli.run.solution import run_deck
from flexmb_cli.solvers.constrained import analysis as constrained
from flexmb_cli.solvers.kinematics import analysis as kinematic
from tests.dialects.vsdf.vsdf_decks import RIGID, changed
from tests.run.dafms_runs import stop_after
from tests.solvers.kinematics.young_linkages import AT_REST, turned, young

DECKS = Path(__file__).parents[3] / "decks"


def pendulum(cards):
    """A bar of 1 kg about a hinge, let go level."""
    return young(
        (turned(0, 0, 0), turned(0, 0, 0)), (0, 0.6, 0.02),
        f"DYNAMICS forward\nMASS 2 1 0.5 0 0 0.01 0.1 0.1\nGRAVITY 0 -9.81 0\n{cards}END\n",
        revolute=[(1, 2, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 1)], ground=[AT_REST],
    )  # fmt: skip


def links(method):
    """Rigid links of a VSDF deck, 101 rows, by a method of its INTG card."""
    return changed(("1.0      0.01\n", f"1.0      0.01\nINTG\n {method}\n"))


FLOOR = """ELEMENTS
  CONTACT floor plane-point from=0(0,-0.3,0) normal=(0,1,0) to=2(1,0,0) stiffness=1e4 damping=0.2 friction=0.2
"""
PASSES = (DECKS / "young/IN4-BAR.dat").read_text(encoding="utf-8")
TEXTS = {
    "IN-KINEMATIC.dat": PASSES,
    "IN-INVERSE.dat": (DECKS / "young/dynamics/IN4-BAR-MASS.dat").read_text(encoding="utf-8"),
    "IN-DOP853.dat": pendulum(""),
    "IN-GALF.dat": pendulum("GALF 0 0.8\n"),
    "IN-FIXED.dat": pendulum("GALF 0.007 0.8\n"),
    "IN-RAD5.dat": pendulum("RAD5\n"),
    "IN-CONTACT-DOP853.dat": pendulum(FLOOR),
    "IN-CONTACT-RAD5.dat": pendulum(f"RAD5\n{FLOOR}"),
    "IN-CONTACT-GALF.dat": pendulum(f"GALF 0.002 0.9\n{FLOOR}"),
    "IN-BREAK.dat": (DECKS / "young/dynamics/IN-BREAK.dat").read_text(encoding="utf-8"),
    "rk45.vsdf": links("RK45    1.0E-8"),
    "rad5.vsdf": links("RAD5    1.0E-6"),
    "galf.vsdf": RIGID,
}


@pytest.fixture(autouse=True)
def short_blocks(monkeypatch):
    """Blocks of five rows, so that short runs have several."""
    for module in (constrained, kinematic):
        monkeypatch.setattr(module, "LARGEST_BLOCK", 5)


def run(deck, folder, listener=None, **options):
    return run_deck(str(deck), RunOptions(folder=str(folder), **options), listener)


def files(folder):
    return {path.name: path.read_bytes() for path in folder.iterdir()}


# Interpreted kernels take minutes for steps that forward runs choose.
QUICK = ("IN-KINEMATIC.dat", "IN-INVERSE.dat", "IN-DOP853.dat", "IN-CONTACT-RAD5.dat", "IN-BREAK.dat")


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=() if name in QUICK else pytest.mark.long_motion) for name in TEXTS]
)
def test_a_mechanism_stopped_twice_and_resumed_gives_the_bytes_of_an_uninterrupted_run(tmp_path, name):
    """Every integrator goes on with the steps it would have taken, and its memory of those before."""
    deck, whole, stopped = tmp_path / name, tmp_path / "whole", tmp_path / "stopped"
    deck.write_text(TEXTS[name], encoding="utf-8")
    assert run(deck, whole).exit_code == 0
    first = run(deck, stopped, stop_after(2))
    assert (first.exit_code, first.resumable) == (130, True)
    second = run(deck, stopped, stop_after(3), resume=True)
    assert second.exit_code == 130 and second.rows > first.rows
    last = run(deck, stopped, resume=True)
    assert (last.exit_code, last.rows) == (0, run(deck, tmp_path / "again").rows)
    assert files(stopped) == files(whole)


def test_a_resumed_run_computes_only_the_rows_that_are_missing(tmp_path, monkeypatch):
    deck, computed = tmp_path / "IN-DOP853.dat", []
    deck.write_text(TEXTS[deck.name])
    run(deck, tmp_path, stop_after(3))
    plain = constrained.ConstrainedMotion._reports
    monkeypatch.setattr(
        constrained.ConstrainedMotion, "_reports",
        lambda self, times: (computed.append(report.times.size) or report for report in plain(self, times)),
    )  # fmt: skip
    outcome = run(deck, tmp_path, resume=True)
    assert (outcome.rows, sum(computed)) == (31, 31 - 3 * 5)


def test_what_was_told_before_the_stop_is_told_again(tmp_path):
    """Notes of the result, too: a parallelogram passes a position where two motions cross."""
    deck = DECKS / "young/IN4-BAR.dat"
    whole = run(deck, tmp_path / "whole", changes=("time.step=0.01",))
    run(deck, tmp_path / "stopped", stop_after(20), changes=("time.step=0.01",))
    again = run(deck, tmp_path / "stopped", changes=("time.step=0.01",), resume=True)
    assert [fault.message for fault in again.faults] == [fault.message for fault in whole.faults]


def test_a_changed_file_of_a_body_is_another_run(tmp_path):
    """A deck names the files of its bodies; the text of the deck alone does not tell the run."""
    deck = tmp_path / "x.vsdf"
    deck.write_text(RIGID)
    run(deck, tmp_path, stop_after(1))
    assert b'"bodies": ' in (tmp_path / "x.resume").read_bytes().split(b"\n", 1)[0]


def test_a_kinematic_run_of_one_block_keeps_no_resume_file(tmp_path, monkeypatch):
    monkeypatch.setattr(kinematic, "LARGEST_BLOCK", 1024)
    outcome = run(DECKS / "young/IN4-BAR.dat", tmp_path, stop_after(1))
    assert (outcome.exit_code, outcome.resumable) == (130, False)
    assert not list(tmp_path.glob("*.resume"))


def state_of(path):
    # Of a copy, as a kill would leave it: the file itself is held by the run.
    copy = shutil.copy(path, path.with_suffix(".copy"))
    resume_file = ResumeFile(str(copy), {})
    resume_file.find()
    return resume_file.last_checkpoint, [len(values["time"]) for values, _ in resume_file.stored()]


def test_a_checkpoint_larger_than_the_rows_is_left_out_until_the_run_ends(tmp_path):
    """A kill then costs the rows after the last one, a signal none."""
    path = tmp_path / "x.resume"
    resume_file = ResumeFile(str(path), {})
    resume_file.begin([])
    for k in range(5):
        resume_file.append({"time": [k]}, {"row": k + 1, "matrix": bytes(24)})
    killed, rows = state_of(path)
    assert (int(killed["row"]), rows) == (4, [1, 1, 1, 1])
    resume_file.close()
    ended, rows = state_of(path)
    assert (int(ended["row"]), rows) == (5, [1, 1, 1, 1, 1])
    assert LONGEST_UNSAVED <= 60.0


def rewritten(path, change):
    """Write a resume file anew, with right checksums, whose arrays `change(arrays)` has changed."""
    identity = json.loads(path.read_bytes().partition(b"\n")[0])
    found = ResumeFile(str(path), identity)
    found.find()
    blocks, state = [change(values) for values, _ in found.stored()], change(found.last_checkpoint)
    path.unlink()
    forged = ResumeFile(str(path), identity)
    forged.begin([])
    for values in blocks:
        forged.append(values, state)
    forged.close()


def without(name):
    return lambda arrays: {key: array for key, array in arrays.items() if key != name}


def as_one_number(name):
    """What numpy would spread over any shape without a word."""
    return lambda arrays: {
        key: np.resize(array, (1,) * (array.ndim + 1)) if key == name else array
        for key, array in arrays.items()
    }


def with_number(name, number):
    """The last number of an array is another."""

    def changed(array):
        array = np.array(array)
        array.reshape(-1)[-1:] = number
        return array

    return lambda arrays: {key: changed(array) if key == name else array for key, array in arrays.items()}


@pytest.mark.parametrize("name", ["IN-KINEMATIC.dat", "IN-DOP853.dat", "pendulum.DAT"])
def test_a_resume_file_with_arrays_of_another_run_is_refused(tmp_path, name):
    """Also with right checksums, as of a file that was put together by hand; the file stays."""
    deck = tmp_path / name
    deck.write_text(TEXTS[name] if name in TEXTS else (DECKS / f"dafms/{name}").read_text(encoding="utf-8"))
    run(deck, tmp_path, stop_after(2))
    (path,) = tmp_path.glob("*.resume")
    stopped, (state, _) = path.read_bytes(), state_of(path)
    stored = {"time", "body/position", *state}
    position = "body/position"
    changes = [form(key) for key in sorted(stored) for form in (without, as_one_number)]
    for change in (
        *changes,
        with_number("time", np.inf),
        with_number("time", -1.0),
        with_number(position, np.nan),
    ):
        path.write_bytes(stopped)
        rewritten(path, change)
        forged = path.read_bytes()
        outcome = run(deck, tmp_path, resume=True)
        assert [outcome.exit_code, *(fault.id for fault in outcome.faults if fault.severity == "error")] == [
            2,
            "RUN-040",
        ]
        assert path.read_bytes() == forged
    path.write_bytes(stopped)
    assert run(deck, tmp_path, resume=True).exit_code == 0


@pytest.mark.processes
@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="kill is Unix's")
def test_a_killed_run_of_a_mechanism_goes_on_to_the_same_bytes(tmp_path):
    deck, whole, killed = tmp_path / "IN-RAD5.dat", tmp_path / "whole", tmp_path / "killed"
    deck.write_text(pendulum("RAD5\n"))
    command = [sys.executable, "-m", "flexmb_cli", "run", "-q", "--set", "time.step=2e-5", str(deck), "-o"]
    subprocess.run([*command, str(whole)], check=True, timeout=300)
    process, resume_file = subprocess.Popen([*command, str(killed)]), killed / "OUT-RAD5.resume"
    while process.poll() is None and not (resume_file.exists() and resume_file.stat().st_size > 1_000_000):
        time.sleep(0.002)
    assert process.poll() is None
    process.kill()
    process.wait()
    subprocess.run([*command, str(killed), "--resume"], check=True, timeout=300)
    assert files(killed) == files(whole)
