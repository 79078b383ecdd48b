"""The process ends by itself, without taking Python down: nothing that waited may be lost by that."""

import subprocess
import sys

import pytest

pytestmark = pytest.mark.processes
AT_EXIT = "import atexit; atexit.register(print, 'told at exit'); "
PROGRAM = (
    "import sys; sys.argv = ['flexmb', *sys.argv[1:]]; from flexmb_cli.__main__ import program; program()"
)


def run(code, *words, options=()):
    """Run Python's `code` with `words`; its exit code and what it printed."""
    done = subprocess.run([sys.executable, *options, "-c", code, *words], capture_output=True, text=True)
    return done.returncode, done.stdout, done.stderr


def test_what_is_printed_and_what_waits_for_the_end_comes_out():
    code, out, _ = run(AT_EXIT + PROGRAM, "--version")
    assert code == 0
    assert out.startswith("flexmb") and out.endswith("told at exit\n")


def test_the_exit_code_of_a_fault_arrives():
    code, _, error = run(PROGRAM, "check", "nowhere.dat")
    assert code == 2 and "nowhere.dat" in error


def test_a_profiler_that_watches_reports():
    done = subprocess.run(
        [sys.executable, "-m", "cProfile", "-m", "flexmb_cli", "--version"], capture_output=True, text=True
    )
    assert done.returncode == 0 and "function calls" in done.stdout


@pytest.mark.skipif(sys.platform != "linux", reason="needs /dev/full")
def test_a_stream_that_takes_nothing_is_told_and_is_no_success():
    with open("/dev/full", "w") as full:
        done = subprocess.run(
            [sys.executable, "-m", "flexmb_cli", "--version"], stdout=full, stderr=subprocess.PIPE, text=True
        )
    assert done.returncode != 0 and "No space left" in done.stderr
