"""Closed streams, signals, and limits of memory and of rights: how the process ends."""

import json
import os
import shutil
import signal
import stat
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import h5py
import numpy as np
import pytest

from tests.cli.test_command_line import FOUR_BAR, HELD, TOP, flexmb

pytestmark = pytest.mark.processes


def test_a_closed_pipe_ends_quietly(tmp_path):
    command = f"{sys.executable} -m flexmb_cli run {FOUR_BAR} --out - --no-h5 -q | head -1"
    done = subprocess.run(command, shell=True, cwd=tmp_path, capture_output=True, text=True, timeout=300)
    assert (done.stdout, done.stderr) == ("ENTER NUMBER OF\n", "")


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs a device that is always full")
@pytest.mark.parametrize(
    "arguments", [["run", "--out", "-", "--no-h5"], ["check"], ["run", "--json", "--no-h5"]]
)
def test_a_full_standard_output_is_no_fault_of_flexmb(tmp_path, arguments):
    command = [sys.executable, "-m", "flexmb_cli", arguments[0], str(HELD), *arguments[1:]]
    with open("/dev/full", "w") as full:
        done = subprocess.run(
            command, cwd=tmp_path, stdout=full, stderr=subprocess.PIPE, text=True, timeout=300
        )
    assert done.returncode == 1
    assert "No space left on device" in done.stderr
    assert "Please report" not in done.stderr


@pytest.mark.parametrize("closed", ["<&-", "2>&-"])
def test_a_closed_stream_is_no_fault_of_flexmb(tmp_path, closed):
    command = f"{sys.executable} -m flexmb_cli check {HELD} {closed}"
    done = subprocess.run(command, shell=True, cwd=tmp_path, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0


@pytest.mark.parametrize(
    "arguments", ["--version", "--help", "check --help", f"check {HELD}", f"check {HELD} --json", "examples"]
)
def test_output_that_a_closed_stream_loses_is_a_failure(tmp_path, arguments):
    """It ended with 0, as if the output were somewhere."""
    command = f"{sys.executable} -m flexmb_cli {arguments} >&-"
    done = subprocess.run(command, shell=True, cwd=tmp_path, capture_output=True, text=True, timeout=300)
    assert done.returncode == 1
    assert "flexmb: error: standard output is closed, so nothing can be printed" in done.stderr
    assert "Please report" not in done.stderr


def test_a_command_that_prints_nothing_needs_no_standard_output(tmp_path):
    command = f"{sys.executable} -m flexmb_cli check -q {HELD} >&-"
    done = subprocess.run(command, shell=True, cwd=tmp_path, capture_output=True, text=True, timeout=300)
    assert (done.returncode, done.stderr) == (0, "")


def test_a_table_for_a_closed_stream_is_refused(tmp_path):
    command = f"{sys.executable} -m flexmb_cli run {HELD} --out - >&-"
    done = subprocess.run(command, shell=True, cwd=tmp_path, capture_output=True, text=True, timeout=300)
    assert done.returncode == 2
    assert "standard output, which is closed" in done.stderr
    assert not list(tmp_path.iterdir())


def test_one_report_step_of_many_turns_can_be_interrupted(tmp_path):
    flexmb("run", FOUR_BAR, "-q", cwd=tmp_path)
    grid = ["--set", "driver.1.B=6e5", "--set", "time.end=100", "--set", "time.step=100"]
    command = [sys.executable, "-m", "flexmb_cli", "run", str(FOUR_BAR), *grid, "--no-out"]
    process = subprocess.Popen(command, cwd=tmp_path, stderr=subprocess.PIPE, text=True)
    time.sleep(4.0)
    process.send_signal(signal.SIGTERM)
    assert "interrupted; " in process.communicate(timeout=10)[1]
    assert process.returncode == 143


def hear_interrupts():
    """A suite in the background of a shell ignores SIGINT, under nohup SIGHUP; so would its children."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    signal.signal(signal.SIGHUP, signal.SIG_DFL)


def unfinished(folder):
    """Files of runs that are not complete, whose names begin with a dot."""
    return [path for path in folder.iterdir() if path.name.startswith(".flexmb-")]


def wait_for_bytes(folder, size):
    """Wait until a run has written so much."""
    until = time.monotonic() + 120
    while sum(path.stat().st_size for path in unfinished(folder)) < size:
        assert time.monotonic() < until
        time.sleep(0.05)


@pytest.mark.parametrize(
    ("sent", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143), (signal.SIGHUP, 143)]
)
def test_an_interrupted_run_keeps_and_marks_its_rows(tmp_path, sent, code):
    command = [sys.executable, "-m", "flexmb_cli", "run", str(FOUR_BAR), "--set", "time.end=100000"]
    flexmb("run", FOUR_BAR, "-q", cwd=tmp_path)  # compiled kernels are not what is interrupted here
    process = subprocess.Popen(
        command, cwd=tmp_path, stderr=subprocess.PIPE, text=True, preexec_fn=hear_interrupts
    )
    wait_for_bytes(tmp_path, 5_000_000)
    process.send_signal(sent)
    message = process.communicate(timeout=60)[1]
    assert process.returncode == code
    assert "interrupted; " in message
    assert "rows kept, marked as failed" in message
    with h5py.File(tmp_path / "OUT4-BAR.h5") as result:
        assert result.attrs["status"] == "failed"
        assert result["time"].shape[0] > 1000
    assert not unfinished(tmp_path)


@pytest.mark.parametrize("lack", ["MemoryError()", "ImportError('lib.so')", "OSError('no libllvmlite.so')"])
def test_too_little_memory_is_no_fault_of_flexmb(tmp_path, lack):
    """What numpy, imports and llvmlite raise under `ulimit -v`; at some limits libraries crash."""
    script = f"""
import sys
from flexmb_cli import __main__
from flexmb_cli.run import solution as deck
def fails(*arguments): raise {lack}
deck.run_deck = fails
sys.argv = ["flexmb", "run", "x.dat", "--json"]
__main__.main()
"""
    done = subprocess.run(
        [sys.executable, "-c", script], cwd=tmp_path, capture_output=True, text=True, timeout=120
    )
    assert done.returncode == 1
    assert "memory" in done.stderr and "Please report" not in done.stderr
    assert json.loads(done.stdout)["status"] == "failed"


@pytest.mark.processes
@pytest.mark.skipif(sys.platform == "win32", reason="limits of memory are Unix's")
@pytest.mark.parametrize("megabytes", [110, 115, 120])
def test_a_limit_of_memory_ends_a_run_in_words_and_in_time(tmp_path, megabytes):
    """OpenBLAS asks for its buffers without end where they are refused; only a kill stopped that."""
    flexmb("run", FOUR_BAR, "-q", cwd=tmp_path)
    limited = f"import resource; resource.setrlimit(resource.RLIMIT_AS, 2 * ({megabytes} * 2**20,)); "
    code = f"{limited}from flexmb_cli.cli import main; main()"
    done = subprocess.run(
        [sys.executable, "-c", code, "run", str(FOUR_BAR)],
        cwd=tmp_path, capture_output=True, text=True, timeout=60,
    )  # fmt: skip
    if np.__version__ < "2.1" and done.returncode == 0:
        return  # numpy 2.0 is content with so much
    assert done.returncode == 1
    assert "not enough memory" in done.stderr or "for want of memory" in done.stderr


def test_a_read_only_install_without_home_runs_from_any_folder(tmp_path):
    place = tmp_path / "install"
    shutil.copytree(TOP / "flexmb_cli", place / "flexmb_cli", ignore=shutil.ignore_patterns("__pycache__"))
    for path in [place, *place.rglob("*")]:
        path.chmod(path.stat().st_mode & ~(stat.S_IWUSR | stat.S_IWGRP | stat.S_IWOTH))
    work = tmp_path / "work"
    work.mkdir()
    kept = {n: v for n, v in os.environ.items() if n in ("PATH", "LANG", "VIRTUAL_ENV")}
    environment = {**kept, "PYTHONPATH": str(place), "TMPDIR": str(work)}
    runs = [
        subprocess.run(
            [sys.executable, "-m", "flexmb_cli", "run", "-v", str(HELD)],
            cwd=work, env=environment, capture_output=True, text=True, timeout=300,
        )
        for _ in range(2)
    ]  # fmt: skip
    for path in [place, *place.rglob("*")]:
        path.chmod(path.stat().st_mode | stat.S_IWUSR)
    assert [run.returncode for run in runs] == [0, 0], runs[0].stderr
    assert "compiling kernels" in runs[0].stderr
    assert "compiling kernels" not in runs[1].stderr
    assert (work / "OUT1-1-1.dat").exists()


@pytest.mark.campaign
def test_eight_first_runs_at_once_all_succeed(tmp_path):
    def first_run(number):
        return flexmb(
            "run",
            HELD,
            "-q",
            "-o",
            tmp_path / str(number),
            cwd=tmp_path,
            XDG_CACHE_HOME=str(tmp_path / "cache"),
        )

    with ThreadPoolExecutor(8) as pool:
        runs = list(pool.map(first_run, range(8)))
    assert [run.returncode for run in runs] == [0] * 8
    tables = {(tmp_path / str(number) / "OUT1-1-1.dat").read_bytes() for number in range(8)}
    assert len(tables) == 1
