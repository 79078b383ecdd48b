"""Runs that are stopped, and go on to the same bytes."""

import os
import random
import signal
import struct
import subprocess
import sys
import time
import zlib

import h5py
import numpy as np
import pytest

from flexmb_cli.errors import ModelError, OutputError
from flexmb_cli.run.checkpoint import ResumeFile
from flexmb_cli.run.outcome import Listener
from flexmb_cli.solvers.tree import analysis
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
    monkeypatch.setattr(analysis, "LARGEST_BLOCK", 23)
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
    assert "nothing to resume; the run starts at its beginning" in said


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
        "run without --resume to start anew"
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


@pytest.mark.parametrize("resume", [True, False])
def test_zeros_of_a_lost_power_in_the_place_of_a_journal_are_written_over(tmp_path, resume):
    """Of a file that was never synced some file systems keep the length alone."""
    (tmp_path / "pendulum.resume").write_bytes(bytes(5000))
    outcome = run("pendulum", tmp_path, resume=resume, changes=("time.IT=50",))
    assert (outcome.exit_code, outcome.rows) == (0, 51)
    assert not (tmp_path / "pendulum.resume").exists()
    assert [fault.severity for fault in outcome.faults] == ["warning"] * resume


def test_no_file_but_a_journal_is_written_over_and_no_link_to_one_is_followed(tmp_path):
    """In a folder that a stranger has packed, the journal's name could lead to any file of the user's."""
    other, resume_file = tmp_path / "other", tmp_path / "pendulum.resume"
    other.write_text('{"kept": 1}')
    resume_file.symlink_to(other)
    outcome = run("pendulum", tmp_path)
    assert outcome.exit_code == 2
    assert error_of(outcome) == f"{resume_file}: it is a link, which is not followed; remove it"
    assert other.read_text() == '{"kept": 1}'
    resume_file.unlink()
    resume_file.write_text("a life in short")
    outcome = run("pendulum", tmp_path)
    assert outcome.exit_code == 2
    assert error_of(outcome) == (
        f"{resume_file}: it is not the file of a stopped run, whose place it has; remove or rename it"
    )
    assert resume_file.read_text() == "a life in short"
    assert {path.name for path in tmp_path.iterdir()} == {"other", "pendulum.resume"}


BLOCKS = [({"time": np.arange(3.0) + k}, {"row": np.array(3 * k)}) for k in range(4)]


def kept(path):
    """A journal of four blocks."""
    resume_file = ResumeFile(str(path), {"deck": "x"})
    resume_file.begin([])
    for values, checkpoint in BLOCKS:
        resume_file.append(values, checkpoint)
    resume_file.close()


def rows_of(path):
    resume_file = ResumeFile(str(path), {"deck": "x"})
    resume_file.find()
    return [int(state["row"]) for _, state in resume_file.stored()]


def test_a_journal_cut_anywhere_gives_its_whole_entries(tmp_path):
    path = tmp_path / "x.resume"
    kept(path)
    content = path.read_bytes()
    found = []
    for length in range(0, len(content) + 1, 7):
        path.write_bytes(content[:length])
        found.append(len(rows_of(path)))
    assert found == sorted(found)
    assert {0, 1, 2, 3} <= set(found)
    path.write_bytes(content)
    assert rows_of(path) == [0, 3, 6, 9]


def test_a_damaged_entry_ends_the_journal(tmp_path):
    path = tmp_path / "x.resume"
    kept(path)
    content = bytearray(path.read_bytes())
    content[-10] ^= 1
    path.write_bytes(content)
    assert rows_of(path) == [0, 3, 6]


def test_a_journal_goes_on_behind_its_last_whole_entry(tmp_path):
    path = tmp_path / "x.resume"
    kept(path)
    path.write_bytes(path.read_bytes()[:-10])
    resume_file = ResumeFile(str(path), {"deck": "x"})
    resume_file.find()
    resume_file.begin([])
    resume_file.append(*BLOCKS[3])
    resume_file.close()
    assert rows_of(path) == [0, 3, 6, 9]


def test_what_is_no_journal_is_refused(tmp_path):
    path = tmp_path / "x.resume"
    path.write_text("shopping list\n")
    with pytest.raises(ModelError, match="is not the file of a stopped run"):
        rows_of(path)


def doubts_of(path):
    resume_file = ResumeFile(str(path), {"deck": "x"})
    resume_file.find()
    return [
        (doubt.severity, doubt.message.removeprefix(f"--resume: {path} is ")) for doubt in resume_file.doubts
    ]


@pytest.mark.parametrize("length", [0, 1, 13])
def test_a_journal_cut_in_its_first_line_says_so(tmp_path, length):
    path = tmp_path / "x.resume"
    kept(path)
    path.write_bytes(path.read_bytes()[:length])
    said = "cut in its first line, nothing of the stopped run can be used"
    assert doubts_of(path) == [("warning", said)]


def test_a_text_without_line_ends_is_no_cut_journal(tmp_path):
    path = tmp_path / "x.resume"
    path.write_text("shopping list")
    with pytest.raises(ModelError, match="is not the file of a stopped run"):
        doubts_of(path)


def test_a_damaged_entry_is_told_with_its_place(tmp_path):
    path = tmp_path / "x.resume"
    kept(path)
    assert doubts_of(path) == []
    content = path.read_bytes()
    path.write_bytes(content + b"torn")
    said = f"torn or damaged at byte {len(content)}; the 4 bytes there are not used"
    assert doubts_of(path) == [("note", said)]


@pytest.mark.skipif(not hasattr(os, "geteuid"), reason="owners of files")
def test_rows_of_another_user_are_told(tmp_path, monkeypatch):
    """Its checksums are no secret: whoever may write the file chooses the rows of the result."""
    path = tmp_path / "x.resume"
    kept(path)
    owner = path.stat().st_uid
    if owner == 0:  # root gives its files away, others look as somebody else
        os.chown(path, 65534, -1)
    else:
        monkeypatch.setattr(os, "geteuid", lambda: owner + 1)
    said = "of another user, whose rows are taken; without --resume none are"
    assert doubts_of(path) == [("warning", said)]


@pytest.mark.parametrize("entry", [b"", b"no arrays"])
def test_an_entry_without_arrays_is_told(tmp_path, entry):
    """Zeros, as behind a loss of power, are entries without content, and their checksum, 0, is right."""
    path = tmp_path / "x.resume"
    kept(path)
    content = path.read_bytes()
    path.write_bytes(content + struct.pack("<QI", len(entry), zlib.crc32(entry)) + entry)
    said = f"torn or damaged at byte {len(content)}; the {12 + len(entry)} bytes there are not used"
    assert [sentence for _, sentence in doubts_of(path)] == [said]


@pytest.mark.parametrize(
    "description",
    [
        b'[["x", "<f8", [2]]]',
        b'[["x", "<f8", [-1]]]',
        b'[["x", "|O", [1]]]',
        b'[["x", "zz", [1]]]',
        b"[[",
        b"[[5]]",
    ],
)
def test_an_entry_that_does_not_hold_what_it_describes_is_told(tmp_path, description):
    """Its checksum is right, its eight bytes are not the arrays of its first line."""
    path = tmp_path / "x.resume"
    kept(path)
    content, entry = path.read_bytes(), description + b"\n" + bytes(8)
    path.write_bytes(content + struct.pack("<QI", len(entry), zlib.crc32(entry)) + entry)
    said = f"torn or damaged at byte {len(content)}; the {12 + len(entry)} bytes there are not used"
    assert [sentence for _, sentence in doubts_of(path)] == [said]
    assert rows_of(path) == [0, 3, 6, 9]


@pytest.mark.parametrize("length", [2**31, 2**40, 2**63, 2**64 - 1])
def test_a_damaged_length_takes_no_memory(tmp_path, length):
    path = tmp_path / "x.resume"
    kept(path)
    head, _, entries = path.read_bytes().partition(b"\n")
    path.write_bytes(head + b"\n" + length.to_bytes(8, "little") + entries[8:])
    assert rows_of(path) == []
    assert len(doubts_of(path)) == 1


@pytest.mark.skipif(sys.platform == "win32", reason="locks of files are Unix's")
def test_two_runs_do_not_write_one_journal(tmp_path):
    first, second = (ResumeFile(str(tmp_path / "x.resume"), {"deck": "x"}) for _ in range(2))
    first.begin([])
    first.append(*BLOCKS[0])
    with pytest.raises(OutputError, match="another run is writing it"):
        second.begin([])
    first.close()
    assert rows_of(tmp_path / "x.resume") == [0]


@pytest.mark.long_motion
def test_results_that_cannot_be_put_in_their_places_leave_the_journal(tmp_path):
    """A folder that appears in the place of the last series while the run goes on."""

    def in_the_way(rows):
        (tmp_path / "pendulum.T3").mkdir(exist_ok=True)

    outcome = run("pendulum", tmp_path, Listener(advance=in_the_way))
    # Files before it are replaced already, so that it is no wrong command any more.
    assert (outcome.exit_code, outcome.resumable) == (1, True)
    assert "pendulum.T3: cannot be written: it is a folder" in error_of(outcome)
    assert (tmp_path / "pendulum.resume").exists()
    assert not list(tmp_path.glob(".flexmb-*"))


@pytest.mark.long_motion
def test_a_run_interrupted_before_its_first_row_leaves_the_old_results(tmp_path):
    run("pendulum", tmp_path)
    old = (tmp_path / "pendulum.h5").read_bytes()

    def stop(rows):
        raise KeyboardInterrupt

    outcome = run("pendulum", tmp_path, Listener(begin=stop))
    assert (outcome.exit_code, outcome.files) == (130, ())
    assert (tmp_path / "pendulum.h5").read_bytes() == old


def test_only_files_with_the_name_of_unfinished_results_are_removed(tmp_path):
    path = tmp_path / "x.resume"
    mine, leftover = tmp_path / "thesis.tex", tmp_path / ".flexmb-0123456789ab.tmp"
    mine.touch(), leftover.touch()
    resume_file = ResumeFile(str(path), {"deck": "x"})
    resume_file.begin([str(mine), str(leftover)])
    resume_file.close()
    rows_of(path)
    assert mine.exists()
    assert not leftover.exists()


def test_a_journal_tells_no_folder_and_removes_nothing_from_another(tmp_path):
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    foreign = elsewhere / ".flexmb-0123456789ab.tmp"
    foreign.touch()
    path, reported = tmp_path / "x.resume", "elsewhere".encode("utf-32-le")
    resume_file = ResumeFile(str(path), {"deck": "x"})
    resume_file.begin([str(foreign)])
    assert reported not in path.read_bytes()
    # As one that was written by hand may have it.
    resume_file.append({"unfinished": np.array([str(foreign)])}, {})
    resume_file.close()
    assert reported in path.read_bytes()
    rows_of(path)
    assert foreign.exists()


def command(folder, *more):
    deck = str(DECKS / "pendulum.DAT")
    return [sys.executable, "-m", "flexmb_cli", "run", deck, "-q", "-o", str(folder), *more]


def kill_when_grown(arguments, resume_file, growth):
    """Start a run and kill it when its journal has grown; False when it ended before."""
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
    assert message.splitlines()[-1].endswith("; --resume goes on with it")
    with h5py.File(tmp_path / "pendulum.h5") as file:
        assert (file.attrs["status"], file.attrs["message"]) == ("failed", "interrupted")
        assert file["time"].shape[0] >= 256
    assert resume_file.exists()
