"""Worker processes, when the process that started them is killed or stopped."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from flexmb_cli.cli.run import _ended
from flexmb_cli.run.outcome import Outcome

DECKS = Path(__file__).parents[2] / "decks"

pytestmark = [
    pytest.mark.skipif(sys.platform == "win32", reason="groups of processes are Unix's"),
    pytest.mark.processes,
]

PARENT = """
import sys, time
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from flexmb_cli.run.orphans import end_with_parent

if __name__ == "__main__":
    pool = ProcessPoolExecutor(1, get_context("spawn"), initializer=end_with_parent)
    print(pool.submit(abs, -1).result(), flush=True)
    pool.submit(time.sleep, 60)
    time.sleep(60)
"""


def group_ends(group, within=10.0):
    until = time.monotonic() + within
    while time.monotonic() < until:
        try:
            os.killpg(group, 0)
        except ProcessLookupError:
            return True
        time.sleep(0.05)
    os.killpg(group, signal.SIGKILL)
    return False


def test_workers_end_with_a_parent_that_is_killed(tmp_path):
    script = tmp_path / "parent.py"
    script.write_text(PARENT)
    parent = subprocess.Popen([sys.executable, script], stdout=subprocess.PIPE, start_new_session=True)
    assert parent.stdout.readline() == b"1\n"
    parent.kill()
    parent.wait()
    assert group_ends(parent.pid)


def test_only_outcomes_of_stopped_decks_are_told_after_a_stop():
    class Told:
        def __init__(self, outcome=None, fault=None):
            self.outcome, self.fault = outcome, fault

        def done(self):
            return self.outcome is not None or self.fault is not None

        def cancelled(self):
            return False

        def exception(self):
            return self.fault

        def result(self):
            return self.outcome

    stopped = Outcome("stopped.dat", exit_code=143)
    waiting = [Told(Outcome("whole.dat")), Told(stopped), Told(fault=OSError()), Told()]
    assert list(_ended(waiting)) == [stopped]


@pytest.mark.parametrize("sent", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_to_the_parent_alone_stops_decks_that_run_at_once(tmp_path, sent):
    """The decks would take minutes; both keep the rows that they have, and what to do next is said."""
    decks = [str(DECKS / "dafms" / name) for name in ("pendulum.DAT", "sliding_mass.DAT")]
    command = [
        sys.executable,
        "-m",
        "flexmb_cli",
        "run",
        *decks,
        "-j",
        "2",
        "-o",
        tmp_path,
        "--set",
        "time.IT=9000000",
    ]
    process = subprocess.Popen(
        command, stderr=subprocess.PIPE, text=True, start_new_session=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )  # fmt: skip
    journals = [tmp_path / "pendulum.resume", tmp_path / "sliding_mass.resume"]
    until = time.monotonic() + 200
    while not all(path.exists() and path.stat().st_size > 50_000 for path in journals):
        assert process.poll() is None and time.monotonic() < until
        time.sleep(0.05)
    process.send_signal(sent)
    said = process.communicate(timeout=60)[1]
    assert process.returncode == 128 + sent
    assert "--resume goes on with it" in said
    assert all(path.exists() for path in journals)
    assert group_ends(process.pid)


def test_a_dead_worker_does_not_end_its_parent(tmp_path):
    """`flexmb … | head` needs SIGPIPE as it is; writing to a dead worker must be an error instead."""
    code = (
        "import os, signal\n"
        "from flexmb_cli.run.orphans import outlive_workers\n"
        "signal.signal(signal.SIGPIPE, signal.SIG_DFL)\n"
        "outlive_workers()\n"
        "read, write = os.pipe()\n"
        "os.close(read)\n"
        "try:\n    os.write(write, b'work')\nexcept BrokenPipeError:\n    print('alive')\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert done.stdout == "alive\n"


def test_several_decks_at_once_end_quietly_when_nobody_reads(tmp_path):
    decks = [str(DECKS / "young" / name) for name in ("IN1-1-1.dat", "IN1-2-1.dat")]
    command = [sys.executable, "-m", "flexmb_cli", "run", *decks, "-j", "2", "-q", "--json", "-o", tmp_path]
    read, write = os.pipe()
    os.close(read)
    done = subprocess.run(command, stdout=write, stderr=subprocess.PIPE, text=True, timeout=200)
    os.close(write)
    assert (done.returncode, done.stderr) == (1, "")
