"""The resume file: whole entries count, torn and damaged ones do not, and no other file is touched."""

import errno
import os
import struct
import sys
import zlib

import numpy as np
import pytest

from flexmb_cli.errors import ModelError, OutputError
from flexmb_cli.run.checkpoint import ResumeFile, is_whole
from flexmb_cli.run.outcome import Listener
from tests.run.dafms_runs import run
from tests.run.resume.test_resume import error_of


@pytest.mark.parametrize("resume", [True, False])
def test_zeros_of_a_lost_power_in_the_place_of_a_resume_file_are_written_over(tmp_path, resume):
    """Of a file that was never synced some file systems keep the length alone."""
    (tmp_path / "pendulum.resume").write_bytes(bytes(5000))
    outcome = run("pendulum", tmp_path, resume=resume, changes=("time.IT=50",))
    assert (outcome.exit_code, outcome.rows) == (0, 51)
    assert not (tmp_path / "pendulum.resume").exists()
    assert [fault.severity for fault in outcome.faults] == ["warning"] * resume


def test_no_file_but_a_resume_file_is_written_over_and_no_link_to_one_is_followed(tmp_path):
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


class FullOnce:
    """A file whose disk is full for one write, of which it takes a part, or for one sync."""

    def __init__(self, file, taken):
        self.file, self.taken = file, taken

    def write(self, data):
        if self.taken is None:
            return self.file.write(data)
        taken, self.taken = self.taken, None
        self.file.write(data[:taken])
        raise OSError(errno.ENOSPC, "full")

    def __getattr__(self, name):
        return getattr(self.file, name)


@pytest.mark.parametrize("taken", [0, 40, 10**6])
def test_a_write_that_failed_leaves_the_state_of_the_rows_before_it(tmp_path, taken):
    """The state after the lost rows was kept, and the whole file refused: --resume began anew."""
    path, large = tmp_path / "x.resume", np.zeros(1000)
    resume_file = ResumeFile(str(path), {"deck": "x"})
    resume_file.begin([])
    for k in range(2):
        resume_file.append({"time": np.arange(3.0) + 3 * k}, {"row": np.array(3 * k + 3), "state": large})
    resume_file._file = FullOnce(resume_file._file, taken)
    with pytest.raises(OutputError, match="no space left"):
        resume_file.append({"time": np.arange(3.0) + 6}, {"row": np.array(9), "state": large})
    resume_file.close()
    found = ResumeFile(str(path), {"deck": "x"})
    found.find()
    rows = sum(values["time"].size for values, _ in found.stored())
    assert (rows, int(found.last_checkpoint["row"]), found.warnings) == (6, 6, [])


def rows_of(path):
    resume_file = ResumeFile(str(path), {"deck": "x"})
    resume_file.find()
    return [int(state["row"]) for _, state in resume_file.stored()]


def test_a_resume_file_cut_anywhere_gives_its_whole_entries(tmp_path):
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


def test_a_damaged_entry_ends_the_resume_file(tmp_path):
    path = tmp_path / "x.resume"
    kept(path)
    content = bytearray(path.read_bytes())
    content[-10] ^= 1
    path.write_bytes(content)
    assert rows_of(path) == [0, 3, 6]


def test_a_resume_file_goes_on_behind_its_last_whole_entry(tmp_path):
    path = tmp_path / "x.resume"
    kept(path)
    path.write_bytes(path.read_bytes()[:-10])
    resume_file = ResumeFile(str(path), {"deck": "x"})
    resume_file.find()
    resume_file.begin([])
    resume_file.append(*BLOCKS[3])
    resume_file.close()
    assert rows_of(path) == [0, 3, 6, 9]


def test_what_is_no_resume_file_is_refused(tmp_path):
    path = tmp_path / "x.resume"
    path.write_text("shopping list\n")
    with pytest.raises(ModelError, match="is not the file of a stopped run"):
        rows_of(path)


def warnings_of(path):
    resume_file = ResumeFile(str(path), {"deck": "x"})
    resume_file.find()
    return [
        (warning.severity, warning.message.removeprefix(f"--resume: {path} is "))
        for warning in resume_file.warnings
    ]


@pytest.mark.parametrize("length", [0, 1, 13])
def test_a_resume_file_cut_in_its_first_line_says_so(tmp_path, length):
    path = tmp_path / "x.resume"
    kept(path)
    path.write_bytes(path.read_bytes()[:length])
    said = "cut in its first line, nothing of the stopped run can be used"
    assert warnings_of(path) == [("warning", said)]


def test_a_text_without_line_ends_is_no_cut_resume_file(tmp_path):
    path = tmp_path / "x.resume"
    path.write_text("shopping list")
    with pytest.raises(ModelError, match="is not the file of a stopped run"):
        warnings_of(path)


def test_a_damaged_entry_is_told_with_its_place(tmp_path):
    path = tmp_path / "x.resume"
    kept(path)
    assert warnings_of(path) == []
    content = path.read_bytes()
    path.write_bytes(content + b"torn")
    said = f"torn or damaged at byte {len(content)}; the 4 bytes there are not used"
    assert warnings_of(path) == [("note", said)]


@pytest.mark.parametrize("entry", [b"", b"no arrays"])
def test_an_entry_without_arrays_is_told(tmp_path, entry):
    """Zeros, as after a loss of power, are entries without content, and their checksum, 0, is right."""
    path = tmp_path / "x.resume"
    kept(path)
    content = path.read_bytes()
    path.write_bytes(content + struct.pack("<QI", len(entry), zlib.crc32(entry)) + entry)
    said = f"torn or damaged at byte {len(content)}; the {12 + len(entry)} bytes there are not used"
    assert [sentence for _, sentence in warnings_of(path)] == [said]


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
    assert [sentence for _, sentence in warnings_of(path)] == [said]
    assert rows_of(path) == [0, 3, 6, 9]


@pytest.mark.parametrize("length", [2**31, 2**40, 2**63, 2**64 - 1])
def test_a_damaged_length_takes_no_memory(tmp_path, length):
    path = tmp_path / "x.resume"
    kept(path)
    head, _, entries = path.read_bytes().partition(b"\n")
    path.write_bytes(head + b"\n" + length.to_bytes(8, "little") + entries[8:])
    assert rows_of(path) == []
    assert len(warnings_of(path)) == 1


@pytest.mark.skipif(sys.platform == "win32", reason="locks of files are Unix's")
def test_two_runs_do_not_write_one_resume_file(tmp_path):
    first, second = (ResumeFile(str(tmp_path / "x.resume"), {"deck": "x"}) for _ in range(2))
    first.begin([])
    first.append(*BLOCKS[0])
    with pytest.raises(OutputError, match="another run is writing it"):
        second.begin([])
    first.close()
    assert rows_of(tmp_path / "x.resume") == [0]


@pytest.mark.long_motion
def test_results_that_cannot_be_put_in_their_places_leave_the_resume_file(tmp_path):
    """A folder that appears in the place of the last series while the run goes on."""

    def in_the_way(rows):
        (tmp_path / "pendulum.T3").mkdir(exist_ok=True)

    outcome = run("pendulum", tmp_path, Listener(advance=in_the_way))
    # Files before it are replaced already, so that it is no wrong command any more.
    assert (outcome.exit_code, outcome.resumable) == (1, True)
    assert "pendulum.T3: cannot be written: it is a folder" in error_of(outcome)
    assert (tmp_path / "pendulum.resume").exists()
    assert not list(tmp_path.glob(".flexmb-*"))


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


def test_a_resume_file_tells_no_folder_and_removes_nothing_from_another(tmp_path):
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
    assert warnings_of(path) == [("warning", said)]


def test_an_entry_of_no_numbers_in_an_impossible_shape_is_torn():
    """numpy multiplies the other lengths, and refuses them."""
    described = b'[["time","<f8",[0,%d,8]]]\n'
    assert is_whole(described % 1)
    assert not is_whole(described % 2**62)
