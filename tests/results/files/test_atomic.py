"""Results appear whole or not at all."""

import errno
import os
import stat
import subprocess
import sys

import pytest

from flexmb_cli.errors import OutputError
from flexmb_cli.results.files.disk_failures import output_error
from flexmb_cli.results.files.replaced_file import (
    ReplacedText,
    Replacement,
    make_folder,
    put_in_place,
    write_whole,
)
from flexmb_cli.results.hdf5.result_file import ResultFile


def test_the_old_file_stands_until_the_new_one_is_complete(tmp_path):
    path = tmp_path / "OUT1.dat"
    path.write_text("old")
    stream = ReplacedText(path)
    stream.write("new\n")
    stream.flush()
    assert path.read_text() == "old"
    stream.commit()
    assert path.read_bytes() == b"new\n"
    assert os.listdir(tmp_path) == ["OUT1.dat"]


def test_a_discarded_result_leaves_the_old_file_and_no_rest(tmp_path):
    path = tmp_path / "OUT1.dat"
    path.write_text("old")
    stream = ReplacedText(path)
    stream.write("half")
    stream.discard()
    assert path.read_text() == "old"
    assert os.listdir(tmp_path) == ["OUT1.dat"]


def test_a_replaced_file_keeps_its_permissions(tmp_path):
    path = tmp_path / "OUT1.dat"
    path.write_text("old")
    path.chmod(0o640)
    ReplacedText(path).commit()
    assert stat.S_IMODE(path.stat().st_mode) == 0o640


def test_a_new_file_has_the_permissions_the_user_asks_for(tmp_path):
    before = os.umask(0o027)
    try:
        ReplacedText(tmp_path / "new").commit()
    finally:
        os.umask(before)
    assert stat.S_IMODE((tmp_path / "new").stat().st_mode) == 0o640


def test_a_link_stays_a_link(tmp_path):
    (tmp_path / "results").mkdir()
    link = tmp_path / "OUT1.dat"
    link.symlink_to(tmp_path / "results" / "OUT1.dat")
    stream = ReplacedText(link)
    stream.write("new")
    stream.commit()
    assert link.is_symlink()
    assert (tmp_path / "results" / "OUT1.dat").read_text() == "new"


def test_a_link_that_leads_back_to_itself_is_left_alone(tmp_path):
    link = tmp_path / "OUT1.dat"
    link.symlink_to(link)
    with pytest.raises(OutputError, match="Too many levels of symbolic links"):
        ReplacedText(link)
    assert link.is_symlink() and os.listdir(tmp_path) == ["OUT1.dat"]


@pytest.mark.parametrize("opened", [ReplacedText, lambda path: ResultFile(path, None, None)])
def test_where_too_many_files_are_open_no_temporary_file_stays(tmp_path, monkeypatch, opened):
    """One descriptor is left: it reserves the file, and none is left to write it."""
    resource = pytest.importorskip("resource")
    limits = resource.getrlimit(resource.RLIMIT_NOFILE)
    monkeypatch.setattr("flexmb_cli.results.hdf5.result_file.chunk_rows", lambda layout: 1)
    # Modules are loaded and folders listed before.
    ReplacedText(tmp_path / "first").commit()
    spare = os.dup(0)
    resource.setrlimit(resource.RLIMIT_NOFILE, (spare + 1, limits[1]))
    os.close(spare)
    try:
        with pytest.raises(OutputError, match="too many files are open") as refused:
            opened(tmp_path / "second")
    finally:
        resource.setrlimit(resource.RLIMIT_NOFILE, limits)
    assert refused.value.exit_code == 1 and os.listdir(tmp_path) == ["first"]


def test_a_device_is_written_to_and_never_replaced(tmp_path):
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    reader = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)
    stream = ReplacedText(pipe)
    stream.write("through")
    stream.commit()
    assert os.read(reader, 100) == b"through"
    os.close(reader)
    assert stat.S_ISFIFO(os.stat(pipe).st_mode)


def test_a_name_as_long_as_the_system_allows_can_be_written(tmp_path):
    path = tmp_path / ("x" * 255)
    ReplacedText(path).commit()
    assert path.exists()


@pytest.mark.parametrize(
    ("make", "reason"),
    [
        (lambda folder: folder / "missing" / "OUT", "its folder does not exist"),
        (lambda folder: folder, "it is a folder"),
        (lambda folder: folder / ("x" * 300), "the name is too long"),
    ],
)
def test_a_wrong_place_is_bad_usage(tmp_path, make, reason):
    path = make(tmp_path)
    with pytest.raises(OutputError) as caught:
        Replacement(path)
    assert str(caught.value) == f"{path}: cannot be written: {reason}"
    assert caught.value.exit_code == 2
    assert os.listdir(tmp_path) == []


def test_a_file_in_the_way_of_the_output_folder_is_bad_usage(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(OutputError, match="a part of the path is a file, not a folder") as caught:
        make_folder(tmp_path / "file" / "out")
    assert caught.value.exit_code == 2


def test_a_missing_output_folder_is_made_with_its_parents(tmp_path):
    make_folder(tmp_path / "a" / "b")
    make_folder(tmp_path / "a" / "b")
    assert (tmp_path / "a" / "b").is_dir()


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="the device of a full disk is Linux's")
def test_a_full_disk_ends_the_run_with_exit_code_1():
    stream = ReplacedText("/dev/full")
    with pytest.raises(OutputError, match="/dev/full: no space left for the result") as caught:
        stream.write(100_000 * "x")
        stream.flush()
    assert caught.value.exit_code == 1


def test_a_folder_without_permission_is_bad_usage():
    # The tests may run as root, whom no permission stops.
    error = output_error("OUT", PermissionError(errno.EACCES, "Permission denied"))
    assert (str(error), error.exit_code) == ("OUT: cannot be written: permission denied", 2)


def test_the_loss_of_the_disk_removes_the_half_written_file(tmp_path, monkeypatch):
    stream = ReplacedText(tmp_path / "OUT")

    def full(text):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(stream, "_stream", type("Full", (), {"write": staticmethod(full)})())
    with pytest.raises(OutputError):
        stream.write("x")
    assert os.listdir(tmp_path) == []


def killed_while_writing(path):
    """A process that is killed with `path` half written; its temporary file."""
    code = (
        "import os, signal, sys\n"
        "from flexmb_cli.results.files.replaced_file import ReplacedText\n"
        "stream = ReplacedText(sys.argv[1]); stream.write('half'); stream.flush()\n"
        "os.kill(os.getpid(), signal.SIGKILL)"
    )
    subprocess.run([sys.executable, "-c", code, path], timeout=60)
    return next(path.parent.glob(".flexmb-*.tmp"))


@pytest.mark.skipif(sys.platform == "win32", reason="kills and locks of files are Unix's")
def test_what_a_killed_run_left_goes_away_when_its_output_is_written_next(tmp_path):
    left = killed_while_writing(tmp_path / "OUT")
    ReplacedText(tmp_path / "another").commit()
    assert left.exists()
    ReplacedText(tmp_path / "OUT").commit()
    assert sorted(os.listdir(tmp_path)) == ["OUT", "another"]


@pytest.mark.skipif(sys.platform == "win32", reason="locks of files are Unix's")
def test_what_another_run_is_writing_stays(tmp_path):
    first, second = ReplacedText(tmp_path / "OUT"), ReplacedText(tmp_path / "OUT")
    second.write("second")
    second.commit()
    first.write("first")
    first.commit()
    assert (tmp_path / "OUT").read_text() == "first"


def test_an_interrupted_writing_leaves_the_old_file_and_no_rest(tmp_path, monkeypatch):
    (tmp_path / "page").write_text("old")

    def interrupt(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(os, "replace", interrupt)
    with pytest.raises(KeyboardInterrupt):
        write_whole(tmp_path / "page", b"new")
    assert (tmp_path / "page").read_text() == "old"
    assert os.listdir(tmp_path) == ["page"]


def test_no_file_of_a_run_is_put_in_its_place_before_all_are_complete(tmp_path):
    """The second cannot be finished: the first one stays the old one, too."""
    (tmp_path / "OUT").write_text("old")
    first, second = ReplacedText(tmp_path / "OUT"), ReplacedText(tmp_path / "T2")
    first.write("new")

    def full():
        raise OutputError("T2: no space left")

    second.finish = full
    with pytest.raises(OutputError):
        put_in_place([first, second])
    assert (tmp_path / "OUT").read_text() == "old"
    assert os.listdir(tmp_path) == ["OUT"]


def test_a_file_that_cannot_be_moved_behind_another_is_told_and_no_wrong_command(tmp_path, monkeypatch):
    """Exit 2 promises that nothing was written; the first file of the run already is the new one."""
    first, second = ReplacedText(tmp_path / "OUT"), ReplacedText(tmp_path / "T2")
    replace = os.replace

    def refusing(old, new):
        if os.path.basename(new) == "T2":
            raise PermissionError(errno.EACCES, "Permission denied")
        replace(old, new)

    monkeypatch.setattr(os, "replace", refusing)
    with pytest.raises(OutputError, match=r"T2: cannot be written: .*already replaced: \S*OUT$") as caught:
        put_in_place([first, second])
    assert caught.value.exit_code == 1
    assert os.listdir(tmp_path) == ["OUT"]
