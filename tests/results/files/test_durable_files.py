"""Files are on the disk before they take their places."""

import errno
import os
import stat
import sys

import pytest

from flexmb_cli.errors import OutputError
from flexmb_cli.results.files.replaced_file import ReplacedText, put_in_place, write_whole

linux = pytest.mark.skipif(sys.platform != "linux", reason="/proc tells the path of a descriptor")


class Watched:
    """What happens to files, in its order: ("sync", name), ("move", name), ("sync", "folder")."""

    def __init__(self, monkeypatch, folder):
        self.deeds = []
        fsync, replace = os.fsync, os.replace

        def watched_fsync(number):
            path = os.readlink(f"/proc/self/fd/{number}")
            self.deeds.append(("sync", "folder" if path == str(folder) else os.path.basename(path)))
            fsync(number)

        def watched_replace(old, new):
            self.deeds.append(("move", os.path.basename(old)))
            replace(old, new)

        monkeypatch.setattr(os, "fsync", watched_fsync)
        monkeypatch.setattr(os, "replace", watched_replace)


@linux
def test_files_are_on_the_disk_before_they_are_moved_and_their_folder_behind_that(tmp_path, monkeypatch):
    """Without, a loss of power leaves empty files in the places of whole ones (rename(2), ext4 and XFS)."""
    files = [ReplacedText(tmp_path / name) for name in ("one", "two")]
    names = [os.path.basename(file.temporary) for file in files]
    for file in files:
        file.write("new")
    watched = Watched(monkeypatch, tmp_path)
    put_in_place(files)
    expected = [("sync", name) for name in names] + [("move", name) for name in names] + [("sync", "folder")]
    assert watched.deeds == expected
    watched.deeds.clear()
    write_whole(tmp_path / "three", b"new")
    assert [deed for deed, _ in watched.deeds] == ["sync", "move", "sync"]


def test_a_disk_that_fails_to_sync_leaves_the_old_file(tmp_path, monkeypatch):
    def fails(number):
        raise OSError(errno.EIO, os.strerror(errno.EIO))

    path = tmp_path / "OUT1.dat"
    path.write_text("old")
    monkeypatch.setattr(os, "fsync", fails)
    with pytest.raises(OutputError, match="the disk reports a failure") as reported:
        write_whole(path, b"new")
    assert reported.value.exit_code == 1
    assert path.read_text() == "old"
    assert os.listdir(tmp_path) == ["OUT1.dat"]


def test_a_file_system_that_cannot_sync_is_written_all_the_same(tmp_path, monkeypatch):
    def refuses(number):
        raise OSError(errno.EINVAL, os.strerror(errno.EINVAL))

    monkeypatch.setattr(os, "fsync", refuses)
    write_whole(tmp_path / "OUT1.dat", b"new")
    assert (tmp_path / "OUT1.dat").read_bytes() == b"new"


def test_a_folder_that_the_disk_does_not_confirm_is_told(tmp_path, monkeypatch):
    fsync = os.fsync

    def fails_for_folders(number):
        if stat.S_ISDIR(os.fstat(number).st_mode):
            raise OSError(errno.EACCES, os.strerror(errno.EACCES))
        fsync(number)

    monkeypatch.setattr(os, "fsync", fails_for_folders)
    with pytest.raises(OutputError, match=r"OUT1\.dat: written, but the disk does not confirm") as reported:
        write_whole(tmp_path / "OUT1.dat", b"new")
    assert reported.value.exit_code == 1
    assert (tmp_path / "OUT1.dat").read_bytes() == b"new"


def test_a_failing_lock_leaves_no_unfinished_file(tmp_path, monkeypatch):
    """It was taken for the lock of somebody else, and another file was begun beside it."""
    fcntl = pytest.importorskip("fcntl")
    lock, failing = fcntl.flock, [OSError(errno.EACCES, os.strerror(errno.EACCES))]

    def fails_once(file, how):
        if failing:
            raise failing.pop()
        lock(file, how)

    monkeypatch.setattr(fcntl, "flock", fails_once)
    write_whole(tmp_path / "OUT1.dat", b"new")
    assert os.listdir(tmp_path) == ["OUT1.dat"]
