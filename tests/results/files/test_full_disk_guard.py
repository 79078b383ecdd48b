"""Disks that fill up below HDF5, and names that UTF-8 cannot hold."""

import os
import resource
import signal
import sys
from contextlib import contextmanager

import h5py
import pytest

from flexmb_cli.errors import OutputError
from flexmb_cli.results.files.disk_failures import FullDiskGuard
from flexmb_cli.results.hdf5.result_file import printable_name
from flexmb_cli.run.outcome import RunOptions
from flexmb_cli.run.solution import run_deck
from flexmb_cli.study.table import Column, TableHead, write_table

DECK = """{ a body held by its ground }
1 0 1 0 0 0 0 0 0 0 0 1
0 0 0 1 0 0 0
1 0 0 2
1 0 0 0 0 0 0
0 1 1
"""

unix = pytest.mark.skipif(sys.platform == "win32", reason="limits of the file size are Unix's")


@contextmanager
def limited(size):
    """No file may grow beyond `size`; within the test only, for pytest's own output may be a file."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    heard = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
        signal.signal(signal.SIGXFSZ, heard)


@unix
@pytest.mark.parametrize("size", range(0, 6000, 500))
def test_a_disk_that_is_full_at_any_byte_of_a_result_leaves_nothing(tmp_path, size):
    """HDF5 reads back what it has written, and trips over what the disk has refused."""
    deck = tmp_path / "IN1.dat"
    deck.write_text(DECK)
    out = tmp_path / "out"
    with limited(size):
        outcome = run_deck(str(deck), RunOptions(folder=str(out)))
    assert outcome.exit_code == 1
    assert "no space left for the result" in outcome.faults[-1].message
    assert os.listdir(out) == []


@unix
@pytest.mark.parametrize("size", [0, 700, 2500, 5000, 20_000])
def test_a_disk_that_is_full_at_any_byte_of_a_study_leaves_the_old_table(tmp_path, size):
    """HDF5 itself would crash the process when its file is closed."""
    path = tmp_path / "s.h5"
    path.write_text("old")
    head = TableHead("study", "deck", "d.dat", "0" * 64, (Column("result/x", "m", "x", 100),), 50)
    rows = [(k, 0, 1, "", [[float(k)] * 100]) for k in range(50)]
    with limited(size), pytest.raises(OutputError, match="no space left for the result"):
        write_table(str(path), head, rows)
    assert path.read_text() == "old"
    assert os.listdir(tmp_path) == ["s.h5"]


def test_what_hdf5_makes_of_a_refused_write_is_blamed_on_the_disk(tmp_path):
    with FullDiskGuard(tmp_path / "x") as disk:
        disk.failure = OSError("full")
        with pytest.raises(OSError, match="full"), disk.blamed():
            raise RuntimeError("bad heap index")
    with FullDiskGuard(tmp_path / "x") as disk, pytest.raises(RuntimeError), disk.blamed():
        raise RuntimeError("a fault of its own")


@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere all names are text")
def test_a_deck_whose_name_is_no_text_is_run(tmp_path):
    deck = os.fsencode(tmp_path) + b"/IN\xff.dat"
    with open(deck, "w") as file:
        file.write(DECK)
    outcome = run_deck(os.fsdecode(deck), RunOptions(folder=str(tmp_path)))
    assert outcome.exit_code == 0
    with h5py.File(os.fsencode(tmp_path) + b"/OUT\xff.h5") as result:
        assert result.attrs["deck_name"] == r"IN\xff.dat"


def test_names_that_are_text_stay_as_they_are():
    assert printable_name("größe.dat") == "größe.dat"


@unix
def test_what_the_disk_refused_is_read_back(tmp_path):
    """HDF5 crashed the process over bytes of its own that it did not find again."""
    with limited(10), FullDiskGuard(tmp_path / "x") as disk:
        assert disk.write(b"0123456") == 7
        assert disk.write(b"789abcdef") == 9
        disk.seek(12)
        assert disk.write(b"XY") == 2
        assert disk.failure is not None
        disk.seek(5)
        read = bytearray(14)
        assert disk.readinto(read) == 14
        assert read == b"56789abXYef\0\0\0"
        assert disk.tell() == 19


@unix
def test_a_disk_that_neither_finds_nor_reads_a_place_is_remembered(tmp_path):
    """A failing lseek below HDF5 ended the process by SIGSEGV.  A pipe in the file's place has no places."""
    with FullDiskGuard(tmp_path / "x") as disk:
        disk.write(b"0123456")
        receiver, sender = os.pipe()
        os.dup2(sender, disk.fileno())
        assert disk.seek(2) == 2
        assert disk.seek(0, os.SEEK_END) == 7
        assert disk.write(b"89") == 2
        disk.seek(5)
        read = bytearray(4)
        assert disk.readinto(read) == 4
        assert read == b"\0\x0089"  # what is on the disk cannot be had, what was refused can
        with pytest.raises(OSError, match="Illegal seek"), disk.blamed():
            pass
    os.close(receiver), os.close(sender)
