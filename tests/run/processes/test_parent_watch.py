"""Worker processes, when the process that started them is killed or stopped."""

import json
import os
import signal
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path

import pytest

DECKS = Path(__file__).parents[3] / "decks"

pytestmark = [
    pytest.mark.skipif(sys.platform == "win32", reason="groups of processes are Unix's"),
    pytest.mark.processes,
]

knows_children = pytest.mark.skipif(
    not Path("/proc/self/task").is_dir(), reason="needs to know the children of a process"
)

PARENT = """
import sys, time
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from flexmb_cli.run.processes.signal_mask import end_with_parent

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


def long_deck(folder):
    """A deck of so many rows that it is certainly being solved."""
    text = (DECKS / "dafms/pendulum.DAT").read_text()
    path = folder / "long.DAT"
    path.write_text(text.replace("\n 6000\n", "\n99999\n"))
    return path


def started(command, **options):
    """A process in a group of its own that hears Ctrl-C, whatever the shell after the tests ignores."""
    return subprocess.Popen(
        [sys.executable, "-m", "flexmb_cli", *map(str, command)],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL), **options,
    )  # fmt: skip


def wait_until(process, holds):
    until = time.monotonic() + 200
    while not holds():
        assert process.poll() is None and time.monotonic() < until
        time.sleep(0.05)


def workers_of(process):
    """Ids of the processes that solve decks."""
    children = Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text().split()
    return [int(pid) for pid in children if b"spawn_main" in Path(f"/proc/{pid}/cmdline").read_bytes()]


@knows_children
def test_a_killed_process_loses_its_own_deck_only_and_every_deck_has_its_record(tmp_path):
    short = [DECKS / "young" / name for name in ("IN1-1-1.dat", "IN1-2-1.dat", "IN4-BAR.dat")]
    decks = [str(path) for path in (short[0], long_deck(tmp_path), *short[1:])]
    process = started(["run", *decks, "-j", 2, "--json", "-o", tmp_path])
    resume_file, last = tmp_path / "long.resume", tmp_path / "OUT4-BAR.h5"
    wait_until(
        process, lambda: last.exists() and resume_file.exists() and resume_file.stat().st_size > 50_000
    )
    for pid in workers_of(process):
        os.kill(pid, signal.SIGKILL)
    printed, said = process.communicate(timeout=60)
    records = [json.loads(line) for line in printed.splitlines()]
    assert [(record["deck"], record["exit_code"]) for record in records] == list(
        zip(decks, (0, 1, 0, 0), strict=True)
    )
    assert "killed from outside" in records[1]["faults"][0]["message"]
    assert process.returncode == 1 and "Traceback" not in said
    assert resume_file.exists() and group_ends(process.pid)


@pytest.mark.parametrize("sent", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_to_the_parent_alone_stops_decks_that_run_at_once(tmp_path, sent):
    """The decks would take minutes; both keep the rows that they have, and what to do next is said."""
    decks = [str(DECKS / "dafms" / name) for name in ("pendulum.DAT", "sliding_mass.DAT")]
    grid = ["--set", "time.IT=9000000"]
    process = started(["run", *decks, "-j", 2, "--json", "-o", tmp_path, *grid])
    resume_files = [tmp_path / "pendulum.resume", tmp_path / "sliding_mass.resume"]
    wait_until(process, lambda: all(path.exists() and path.stat().st_size > 50_000 for path in resume_files))
    process.send_signal(sent)
    printed, said = process.communicate(timeout=60)
    assert process.returncode == 128 + sent
    assert said.count("--resume continues it") == 2 and "Traceback" not in said
    records = [json.loads(line) for line in printed.splitlines()]
    assert [(record["deck"], record["status"]) for record in records] == [(d, "interrupted") for d in decks]
    assert all(path.exists() for path in resume_files)
    assert group_ends(process.pid)


@knows_children
def test_a_process_that_was_stopped_from_outside_solves_the_next_deck(tmp_path):
    """It was meant for the deck then; the command goes on."""
    first, second = str(long_deck(tmp_path)), str(DECKS / "young/IN4-BAR.dat")
    other = tmp_path / "other.DAT"
    other.write_text(Path(first).read_text())
    process = started(["run", first, str(other), second, "-j", 2, "--json", "-o", tmp_path])
    resume_files = [tmp_path / "long.resume", tmp_path / "other.resume"]
    wait_until(process, lambda: all(path.exists() and path.stat().st_size > 50_000 for path in resume_files))
    for pid in workers_of(process):
        os.kill(pid, signal.SIGTERM)
    printed, _ = process.communicate(timeout=60)
    assert [json.loads(line)["exit_code"] for line in printed.splitlines()] == [143, 143, 0]
    assert process.returncode == 143


@knows_children
def test_a_process_that_was_stopped_amid_an_import_solves_no_other_deck(tmp_path):
    """What was being imported stays half done.  Every run of a tree imports the package of this test."""
    pendulum, second = str(DECKS / "dafms/pendulum.DAT"), str(DECKS / "dafms/two_link_n2.DAT")
    third = str(DECKS / "young/IN1-1-1.dat")
    script = tmp_path / "importing.py"
    script.write_text(
        "import os, signal, sys\n"
        "from flexmb_cli.cli import main\n"
        "from flexmb_cli.run import solution as deck\n"
        "class Finder:\n"
        "    def find_spec(self, name, path, target=None):\n"
        "        if name == 'flexmb_cli.kernels' and 'pendulum' in deck.asked:\n"
        "            os.kill(os.getpid(), signal.SIGTERM)\n"
        "run = deck.run_deck\n"
        "def noted(path, *rest):\n"
        "    deck.asked = path\n"
        "    print(os.path.basename(path), os.getpid(), file=open(sys.path[0] + '/seen', 'a'))\n"
        "    return run(path, *rest)\n"
        "deck.run_deck = noted\n"
        "sys.meta_path.insert(0, Finder())\n"
        "if __name__ == '__main__': main()\n"
    )
    command = [sys.executable, script, "run", pendulum, third, second, "-j", "2", "--json", "-o", tmp_path]
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True, timeout=200)
    codes = [json.loads(line)["exit_code"] for line in done.stdout.splitlines()]
    seen = dict(line.split() for line in (tmp_path / "seen").read_text().splitlines())
    assert codes == [143, 0, 0] and "Traceback" not in done.stderr
    assert seen["pendulum.DAT"] not in (seen["IN1-1-1.dat"], seen["two_link_n2.DAT"])


FAULTY = """
import sys, time
from flexmb_cli.cli import main
from flexmb_cli.run import solution as deck

class Odd(Exception):
    def __init__(self, first, second):
        super().__init__("planted")

def broken(*given):
    time.sleep(1.0)
    raise Odd(1, 2)

deck.solve_deck = broken
if __name__ == "__main__":
    main()
"""


def test_with_debug_faults_of_several_processes_at_once_end_the_command(tmp_path):
    """They are told as they were raised, also one that cannot be sent as it is."""
    script = tmp_path / "faulty.py"
    script.write_text(FAULTY)
    decks = [DECKS / "young" / name for name in ("IN1-1-1.dat", "IN1-2-1.dat", "IN4-BAR.dat", "IN1-3-1.dat")]
    command = [sys.executable, script, "--debug", "run", *decks, "-j", "3", "-o", tmp_path]
    done = subprocess.run(command, capture_output=True, text=True, timeout=100)
    assert done.returncode == 1
    assert "Odd: planted" in done.stderr and "in broken" in done.stderr


def test_decks_wait_for_the_processes_that_a_limit_allows(tmp_path):
    """Of eight processes not all can have their lines."""
    decks = []
    for k in range(16):
        decks.append(tmp_path / f"IN{k}.dat")
        decks[-1].write_text((DECKS / "young/IN1-1-1.dat").read_text())
    limit = "import resource, sys; resource.setrlimit(resource.RLIMIT_NOFILE, (20, 20)); "
    command = [sys.executable, "-c", f"{limit}from flexmb_cli.cli import main; main()", "run", *decks]
    done = subprocess.run(
        [*command, "-j", "8", "-q", "-o", tmp_path], capture_output=True, text=True, timeout=200
    )
    assert (done.returncode, done.stderr) == (0, "")


@knows_children
@pytest.mark.parametrize("begun", [False, True], ids=["while processes start", "while they solve"])
def test_ctrl_c_at_a_terminal_reaches_every_process_and_ends_without_a_traceback(tmp_path, begun):
    """The terminal tells the whole group, the parent passes it on, and the user does it again."""
    decks = [str(long_deck(tmp_path)), str(DECKS / "young/IN4-BAR.dat"), str(DECKS / "young/IN1-1-1.dat")]
    process = started(["run", *decks, "-j", 2, "--json", "-o", tmp_path])
    resume_file = tmp_path / "long.resume"
    if begun:
        wait_until(process, lambda: resume_file.exists() and resume_file.stat().st_size > 200_000)
    else:
        wait_until(process, lambda: workers_of(process))
    for _ in range(3):
        with suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGINT)
        time.sleep(0.03)
    printed, said = process.communicate(timeout=60)
    assert process.returncode == 130 and "interrupted" in said and "Traceback" not in said
    records = [json.loads(line) for line in printed.splitlines()]
    assert [record["deck"] for record in records] == decks
    assert (records[0]["rows"] > 0) == begun and records[0]["status"] == "interrupted"
    assert group_ends(process.pid)


@knows_children
def test_decks_that_were_not_begun_before_a_stop_are_not_called_complete(tmp_path):
    """Those that run may come to their end; the others are to be seen in the exit code."""
    decks = [str(DECKS / "young" / name) for name in ("IN1-1-1.dat", "IN1-2-1.dat", "IN4-BAR.dat")]
    script = tmp_path / "stopped.py"
    script.write_text(
        "import signal, sys; from flexmb_cli.cli import main\n"
        "from flexmb_cli.cli.terminal import deck_processes\n"
        "take = deck_processes._Work._take\n"
        "def stopped(work, *ended):\n"
        "    take(work, *ended); signal.raise_signal(signal.SIGTERM)\n"
        "deck_processes._Work._take = stopped\n"
        "if __name__ == '__main__': main()\n"
    )
    command = [sys.executable, str(script), "run", *decks, "-j", "2", "--json", "-o", str(tmp_path)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=200)
    records = [json.loads(line) for line in done.stdout.splitlines()]
    assert sorted(record["deck"] for record in records) == sorted(decks), done.stderr
    assert done.returncode == 143 and records[-1]["status"] == "interrupted"


def test_a_dead_worker_does_not_end_its_parent(tmp_path):
    """`flexmb … | head` needs SIGPIPE as it is; writing to a dead worker must be an error instead."""
    code = (
        "import os, signal\n"
        "from flexmb_cli.run.processes.signal_mask import outlive_workers\n"
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
