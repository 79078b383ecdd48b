"""Another program exchanges or changes the resume file while a run continues from it.

The rows are those that were checked when the run began, or the run ends with a message; runs that had lost
half of their rows, or taken another user's without a word, were reported as complete.
"""

import os
import sys

import pytest

from flexmb_cli.run import resumed
from flexmb_cli.run.checkpoint import ResumeFile
from flexmb_cli.run.outcome import Listener
from flexmb_cli.solvers.tree import steps
from tests.run.dafms_runs import run, stop_after
from tests.run.resume.test_resume import error_of

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="an open file keeps its place")
NAME = "pendulum.resume"
SHORT = ("time.IT=150",)
ROWS = 151


@pytest.fixture
def stopped(tmp_path, monkeypatch):
    """The resume file of a run that was stopped after four of its seven blocks."""
    monkeypatch.setattr(steps, "LARGEST_BLOCK", 23)
    assert run("pendulum", tmp_path, stop_after(4), changes=SHORT).exit_code == 130
    return tmp_path / NAME


def emptied(path):
    os.truncate(path, 0)


def halved(path):
    os.truncate(path, path.stat().st_size // 2)


def exchanged(path):
    """A file of the same run with fewer rows takes its place."""
    content = path.read_bytes()
    path.unlink()
    path.write_bytes(content[: 2 * len(content) // 3])


def removed(path):
    path.unlink()


def calling(function, path, change):
    """Return `function` that changes the file when it is done."""

    def changing(*given):
        function(*given)
        change(path)

    return changing


@pytest.mark.parametrize("change", [emptied, halved])
def test_rows_that_vanish_after_they_were_checked_end_the_run(stopped, monkeypatch, change):
    monkeypatch.setattr(ResumeFile, "begin", calling(ResumeFile.begin, stopped, change))
    outcome = run("pendulum", stopped.parent, resume=True, changes=SHORT)
    assert outcome.exit_code == 2
    assert "another program changed it while it was read" in error_of(outcome)


@pytest.mark.parametrize("change", [exchanged, removed])
def test_a_file_exchanged_before_the_run_writes_to_it_is_refused(stopped, monkeypatch, change):
    monkeypatch.setattr(resumed, "restore", calling(resumed.restore, stopped, change))
    outcome = run("pendulum", stopped.parent, resume=True, changes=SHORT)
    assert outcome.exit_code == 2
    assert "it was exchanged or removed since it was read" in error_of(outcome)


@pytest.mark.parametrize("change", [exchanged, removed])
def test_a_file_exchanged_while_its_rows_are_read_changes_no_row(stopped, change):
    changes = [change]
    listener = Listener(advance=lambda rows: changes.pop()(stopped) if changes else None)
    outcome = run("pendulum", stopped.parent, listener, resume=True, changes=SHORT)
    assert (outcome.exit_code, outcome.rows) == (0, ROWS)
    # It is not of this run any more.
    assert stopped.exists() == (change is exchanged)


def test_an_entry_larger_than_this_run_writes_is_refused_before_it_is_read(stopped):
    """A file of 3 GB that takes no room on the disk took 2.9 GB of memory."""
    with stopped.open("r+b") as file:
        start = file.seek(0, os.SEEK_END)
        file.write((3 * 2**30).to_bytes(8, "little") + bytes(4))
        file.truncate(start + 12 + 3 * 2**30)
    outcome = run("pendulum", stopped.parent, resume=True, changes=SHORT)
    assert outcome.exit_code == 2
    assert "has an entry of 3221225472 bytes, but entries of this run have at most" in error_of(outcome)
