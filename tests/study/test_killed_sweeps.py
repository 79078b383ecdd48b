"""Sweeps that are killed, workers that end, and the checkpoints of both."""

import contextlib
import json
import os
import random
import signal
import struct
import subprocess
import time
import zlib
from pathlib import Path

import pytest

from flexmb_cli.run.outcome import Stop, Terminated
from flexmb_cli.run.processes.signal_mask import stop_on_signals
from flexmb_cli.study import sweep as study_sweep
from flexmb_cli.study import workers as study_workers
from flexmb_cli.study.checkpoints import Parts, RecordForm
from flexmb_cli.study.sweep import Sweep, give_up_case, next_case, solve_block
from flexmb_cli.study.table import write_table
from tests.study.studies import FLEXMB, OWN_MODELS, SAMPLED, flexmb, written
from tests.study.test_sweep import table

pytestmark = pytest.mark.processes


class Killed:
    """A sweep in a process group of its own, killed after a while."""

    def __init__(self, study, folder, *arguments):
        self.process = subprocess.Popen(
            [*FLEXMB, "sweep", str(study), *arguments],
            cwd=folder, stderr=subprocess.DEVNULL, start_new_session=True,
        )  # fmt: skip

    def once_more_is_kept(self, parts, size):
        """Kill it when `size` bytes have come to its folder of parts, or let it end."""
        wanted = bytes_of(parts) + size
        while self.process.poll() is None and bytes_of(parts) < wanted:
            time.sleep(0.002)
        with contextlib.suppress(ProcessLookupError):
            os.killpg(self.process.pid, signal.SIGKILL)
        return self.process.wait()


def bytes_of(parts):
    with contextlib.suppress(FileNotFoundError):
        return sum(part.stat().st_size for part in parts.glob("*.part"))
    return 0


def kept_in(parts, cases, size):
    """How many cases are kept, in blocks of `size`."""
    blocks = (range(k, min(k + size, cases)) for k in range(0, cases, size))
    form = RecordForm(parameters=2, values=1, series=0, rows=0)  # of SAMPLED and OWN_MODELS
    return sum(len(list(Parts(str(parts), {}, form).stored(k, block))) for k, block in enumerate(blocks))


@pytest.mark.parametrize("jobs", [pytest.param("1", marks=pytest.mark.campaign), "2"])
def test_a_study_killed_again_and_again_ends_with_the_bytes_of_an_undisturbed_one(tmp_path, jobs):
    whole, killed = tmp_path / "whole", tmp_path / "killed"
    flexmb("sweep", written(whole, OWN_MODELS, count=400), "-q", cwd=whole)
    study, sizes = written(killed, OWN_MODELS, count=400), random.Random(11)
    parts, kept = killed / "study.h5.parts", [0]
    while not (killed / "study.h5").exists():
        Killed(study, killed, "-j", jobs).once_more_is_kept(parts, sizes.randrange(1, 8000))
        kept.append(kept_in(parts, 400, 4))
    assert kept[:-1] == sorted(kept[:-1]) and len(kept) > 5
    assert (whole / "study.h5").read_bytes() == (killed / "study.h5").read_bytes()


@pytest.mark.parametrize("jobs", ["1", "2"])
def test_the_cases_that_an_interrupted_sweep_tells_of_are_those_kept(tmp_path, jobs):
    study, parts = written(tmp_path, OWN_MODELS, count=400), tmp_path / "study.h5.parts"
    command = [*FLEXMB, "sweep", str(study), "-j", jobs, "--json"]
    # A suite that runs in the background of a shell ignores SIGINT, and so would its children.
    heeding = {"preexec_fn": lambda: signal.signal(signal.SIGINT, signal.SIG_DFL)}
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    with subprocess.Popen(command, cwd=tmp_path, **pipes, **heeding) as sweep:
        while bytes_of(parts) < 3000:
            time.sleep(0.002)
        sweep.send_signal(signal.SIGINT)
        printed, reported = sweep.communicate()
    kept = kept_in(parts, 400, 4)
    assert sweep.returncode == 130 and 0 < kept < 400
    record = json.loads(printed)
    assert (record["status"], record["exit_code"], record["file"]) == ("interrupted", 130, None)
    assert f"interrupted; {kept} of 400 cases are kept in study.h5.parts; the same" in reported
    done = flexmb("sweep", study, cwd=tmp_path)
    assert f"continuing a stopped study: {kept} of 400 cases are complete" in done.stderr


@pytest.mark.skipif(not Path("/proc/self/task").is_dir(), reason="needs to know the children of a process")
@pytest.mark.parametrize("sent", [signal.SIGINT, signal.SIGHUP])
def test_a_terminal_that_stops_a_sweep_whose_processes_begin_sees_no_traceback(tmp_path, sent):
    study = written(tmp_path, OWN_MODELS, count=400)
    # A suite in the background, or under nohup, ignores one or the other.
    heeding = {"preexec_fn": lambda: signal.signal(sent, signal.SIG_DFL)}
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    command = [*FLEXMB, "sweep", str(study), "-j", "3"]
    with subprocess.Popen(command, cwd=tmp_path, start_new_session=True, **pipes, **heeding) as sweep:
        children = Path(f"/proc/{sweep.pid}/task/{sweep.pid}/children")
        while len(children.read_text().split()) < 3:
            time.sleep(0.002)
        os.killpg(sweep.pid, sent)
        _, reported = sweep.communicate()
    assert sweep.returncode == (130 if sent == signal.SIGINT else 143)
    assert reported.startswith(f"{study}: interrupted; ") and reported.count("\n") == 1


def test_a_worker_that_is_killed_is_replaced(tmp_path):
    """Its blocks go on with the case that was being solved."""
    sweep = Sweep.of(str(written(tmp_path, OWN_MODELS, count=300)), str(tmp_path / "parts"))
    kills, reported = set(), []

    def advance(cases):
        reported.append(cases)
        children = Path(f"/proc/{os.getpid()}/task/{os.getpid()}/children").read_text().split()
        workers = {pid for pid in children if b"spawn_main" in Path(f"/proc/{pid}/cmdline").read_bytes()}
        for worker in sorted(workers - kills)[: 2 - len(kills)]:
            kills.add(worker)
            os.kill(int(worker), signal.SIGKILL)

    study_workers.solve_in_processes(sweep, sweep.pending(), advance, 2)
    assert (len(kills), sum(reported)) == (2, 300)
    assert [result.case for result in sweep.results()] == list(range(300))
    assert [result.message for result in sweep.results() if result.exit_code] == []


def ends_at_case_77(line, job):
    """In place of `_serve`, in a process of its own: case 77 ends it."""

    def solve(job, block, listener):
        def fatal(cases):
            if next_case(job, block) == 77:
                os._exit(1)

        if block == 77 // job.block_size:
            fatal(0)
        return solve_block(job, block, fatal)

    study_workers._solve = solve
    study_workers._serve(line, job)


def ends(line, job):
    """In place of `_serve`: a process that ends before it begins."""
    os._exit(1)


def cannot_begin(line, job):
    """In place of `_serve`: a process that says why it cannot begin."""
    line.send(RuntimeError("can't start new thread"))


def test_only_the_case_that_ends_its_processes_is_given_up(tmp_path, monkeypatch):
    """What was solved beside it, and was struck at the same deaths, is solved."""
    sweep = Sweep.of(str(written(tmp_path, OWN_MODELS, count=300)), str(tmp_path / "parts"))
    monkeypatch.setattr(study_workers, "_serve", ends_at_case_77)
    study_workers.solve_in_processes(sweep, sweep.pending(), lambda cases: None, 2)
    assert [result.case for result in sweep.results()] == list(range(300))
    assert [result.case for result in sweep.results() if result.exit_code] == [77]


def test_processes_that_never_begin_end_the_study(tmp_path, monkeypatch):
    sweep = Sweep.of(str(written(tmp_path, SAMPLED, count=4)), str(tmp_path / "parts"))
    monkeypatch.setattr(study_workers, "_serve", ends)
    with pytest.raises(study_workers.WorkersError, match="ended 3 times before they began one"):
        study_workers.solve_in_processes(sweep, sweep.pending(), lambda cases: None, 2)


def test_processes_that_cannot_begin_end_the_study_with_the_reason(tmp_path, monkeypatch):
    sweep = Sweep.of(str(written(tmp_path, SAMPLED, count=4)), str(tmp_path / "parts"))
    monkeypatch.setattr(study_workers, "_serve", cannot_begin)
    with pytest.raises(study_workers.WorkersError, match="no process can be started: can't start new thread"):
        study_workers.solve_in_processes(sweep, sweep.pending(), lambda cases: None, 2)


def test_a_case_that_ends_its_process_three_times_is_recorded(tmp_path):
    sweep = Sweep.of(str(written(tmp_path, SAMPLED, count=2)), str(tmp_path / "parts"))
    assert next_case(sweep.job, 0) == 0
    give_up_case(sweep.job, 0)
    assert solve_block(sweep.job, 0).failed == 1
    assert solve_block(sweep.job, 1).failed == 0
    first, second = sweep.results()
    assert (first.exit_code, second.exit_code) == (3, 0)
    assert "ended 3 times" in first.message


def test_the_torn_end_of_a_part_does_not_count(tmp_path):
    sweep = Sweep.of(str(written(tmp_path, OWN_MODELS, count=400)), str(tmp_path / "parts"))
    solve_block(sweep.job, 0)
    part = tmp_path / "parts/block-00000000.part"
    whole = part.read_bytes()
    for cut in (1, 7, 30):
        part.write_bytes(whole[:-cut])
        assert next_case(sweep.job, 0) == 3
        assert solve_block(sweep.job, 0).solved == 1
        assert part.read_bytes() == whole


def test_a_study_killed_while_its_folder_was_begun_goes_on(tmp_path):
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts/.study.json").write_text('{"versi')
    Sweep.of(str(written(tmp_path, SAMPLED, count=5)), str(tmp_path / "parts"))
    assert sorted(os.listdir(tmp_path / "parts")) == ["lock", "study.json"]


def test_a_stop_while_the_table_is_written_waits_until_it_is_whole(tmp_path, monkeypatch):
    """HDF5 calls back for every write: a stop that is raised there came out as a fault of flexmb."""
    sweep = Sweep.of(str(written(tmp_path, SAMPLED, count=5)), str(tmp_path / "parts"))
    study_workers.solve_here(sweep, sweep.pending(), lambda cases: None)
    monkeypatch.setattr(Stop, "asked", None)

    def stopped(path, head, rows):
        signal.raise_signal(signal.SIGTERM)
        write_table(path, head, rows)

    monkeypatch.setattr(study_sweep, "write_table", stopped)
    stop_on_signals()
    with pytest.raises(Terminated), Stop.released():
        study_sweep.write_study_table(str(tmp_path / "s.h5"), sweep)
    assert len(table(tmp_path / "s.h5")["case"]) == 5
    assert (tmp_path / "parts").is_dir()


def test_a_damaged_length_of_a_case_takes_no_memory(tmp_path):
    sweep = Sweep.of(str(written(tmp_path, SAMPLED, count=5)), str(tmp_path / "parts"))
    solve_block(sweep.job, 0)
    part = next((tmp_path / "parts").glob("*.part"))
    part.write_bytes(b"\xff\xff\xff\xff" + part.read_bytes()[4:])
    assert list(sweep.job.stored(0)) == []


def test_records_that_are_no_cases_count_as_torn(tmp_path):
    """Their checksums are right: zeros after a loss of power, a message beyond the end, half a number."""
    sweep = Sweep.of(str(written(tmp_path, OWN_MODELS, count=400)), str(tmp_path / "parts"))
    solve_block(sweep.job, 0)
    part = next((tmp_path / "parts").glob("*.part"))
    whole = part.read_bytes()
    second = 8 + int.from_bytes(whole[:4], "little")
    for payload in (b"", bytes(20), struct.pack("<qiiiiiI", 1, *6 * [99]), struct.pack("<q28x", 1)):
        head = struct.pack("<II", len(payload), zlib.crc32(payload))
        part.write_bytes(whole[:second] + head + payload + bytes(99))
        assert len(list(sweep.job.stored(0))) == 1
        assert next_case(sweep.job, 0) == 1
        solve_block(sweep.job, 0)
        assert part.read_bytes() == whole
