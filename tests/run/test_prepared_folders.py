"""A folder that somebody else has prepared with links and pipes: nothing is followed, nothing is waited for.

Each attack destroyed a file of the user's, showed one, or hung, before managed files were opened with care.
"""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from click.testing import CliRunner

from flexmb_cli.cli import cli
from flexmb_cli.errors import OutputError
from flexmb_cli.managed_files import ManagedFolder, UnsafePlace, open_managed
from flexmb_cli.results.files.replaced_file import ReplacedText, Replacement, write_whole
from flexmb_cli.run.checkpoint import ResumeFile
from flexmb_cli.study.sweep import Sweep
from flexmb_cli.study.workers import solve_here

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="links and pipes are Unix's")
DECK = Path(__file__).resolve().parents[2] / "decks/young/IN1-3-1.dat"
STUDY = f"""
deck = "{DECK}"
[parameters]
"point.1.x" = {{ from = 0.0, to = 1.0, count = 4 }}
[results]
top = "max point.1.z"
"""
PARTS = "s.h5.parts"
# What may stand in the place of a file, made so that it leads to the user's own "thesis".
OBSTACLES = {
    "link": (lambda path: os.symlink(os.path.abspath("thesis"), path), "it is a link, which is not followed"),
    "dangling link": (
        lambda path: os.symlink("/nowhere/at/all", path),
        "it is a link, which is not followed",
    ),
    "hard link": (lambda path: os.link("thesis", path), "the file has another name elsewhere"),
    "pipe": (os.mkfifo, "it is not a regular file, but a folder, a pipe or a device"),
    "folder": (os.mkdir, "it is not a regular file, but a folder, a pipe or a device"),
}


@pytest.fixture
def thesis(tmp_path, monkeypatch):
    """A file of the user's that nobody shall touch, in the current folder."""
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "thesis"
    path.write_text("years of work")
    yield path
    assert path.read_text() == "years of work"


@pytest.fixture(autouse=True)
def impatient():
    """A call that waits for a pipe fails instead of stopping the tests."""

    def late(*_):
        raise AssertionError("it waits for a pipe")

    before = signal.signal(signal.SIGALRM, late)
    signal.alarm(60)
    yield
    signal.alarm(0)
    signal.signal(signal.SIGALRM, before)


@pytest.mark.parametrize("obstacle", OBSTACLES)
@pytest.mark.parametrize("name", ["block-00000000.part", "block-00000003.part", "study.json", "lock"])
def test_a_study_opens_nothing_that_was_put_in_the_place_of_its_files(thesis, name, obstacle):
    Path("s.toml").write_text(STUDY)
    begun = Sweep.of("s.toml", PARTS)
    identity = Path(PARTS, "study.json").read_bytes()
    begun.lock.leave()
    Path(PARTS, name).unlink(missing_ok=True)
    if name != "study.json":
        Path(PARTS, "study.json").write_bytes(identity)
    make, reported = OBSTACLES[obstacle]
    make(os.path.join(PARTS, name))
    done = CliRunner().invoke(cli, ["sweep", "s.toml"])
    assert isinstance(done.exception, OutputError) and done.exception.exit_code == 2, done.output
    assert reported in str(done.exception) and name in str(done.exception)
    assert not Path("s.h5").exists()


@pytest.mark.parametrize("fresh", [False, True])
def test_a_folder_of_a_study_that_is_a_link_is_refused(thesis, fresh):
    Path("s.toml").write_text(STUDY)
    Sweep.of("s.toml", "elsewhere").lock.leave()
    before = sorted(os.listdir("elsewhere"))
    os.symlink("elsewhere", PARTS)
    with pytest.raises(OutputError, match="the folder is a link, which is not followed; remove it"):
        Sweep.of("s.toml", PARTS, fresh)
    assert sorted(os.listdir("elsewhere")) == before


def test_a_folder_exchanged_for_a_link_while_a_study_is_solved_gets_no_case(thesis):
    Path("s.toml").write_text(STUDY)
    sweep = Sweep.of("s.toml", PARTS)
    os.rename(PARTS, "aside")
    os.mkdir("elsewhere")
    Path("elsewhere/study.json").write_bytes(Path("aside/study.json").read_bytes())
    os.symlink("elsewhere", PARTS)
    with pytest.raises(OutputError, match="the folder is a link"):
        solve_here(sweep, [0], lambda cases: None)
    assert os.listdir("elsewhere") == ["study.json"]


@pytest.mark.parametrize("obstacle", OBSTACLES)
def test_no_prepared_resume_file_is_read_or_written(thesis, obstacle):
    make, reported = OBSTACLES[obstacle]
    make("x.resume")
    resume_file = ResumeFile("x.resume", {"deck": "x"})
    with pytest.raises(OutputError, match=f"x.resume: {reported}"):
        resume_file.find()
    with pytest.raises(OutputError, match=f"x.resume: {reported}"):
        resume_file.begin([])


def names_of_temporary_files(target):
    """A name that `target`'s temporary files may have."""
    stream = ReplacedText(target)
    name = stream.temporary
    stream.discard()
    return name


@pytest.mark.parametrize("obstacle", OBSTACLES)
def test_what_has_the_name_of_a_temporary_file_is_left_alone(thesis, obstacle):
    name = names_of_temporary_files("OUT")
    OBSTACLES[obstacle][0](name)
    write_whole("OUT", b"new")
    assert Path("OUT").read_bytes() == b"new"
    assert os.path.lexists(name)


def test_a_temporary_file_exchanged_for_a_link_is_not_written_through(thesis):
    """Between its making and its filling somebody else who may write in the folder puts a link there."""
    place = Replacement("OUT")
    os.unlink(place.temporary)
    os.symlink("thesis", place.temporary)
    with place.open("wb") as stream:
        stream.write(b"lost")
    place.discard()


@pytest.mark.parametrize("obstacle", ["link", "pipe", "folder"])
def test_a_prepared_draft_is_neither_read_nor_replaced(thesis, obstacle):
    make, reported = OBSTACLES[obstacle]
    make("IN-X.dat.draft")
    done = CliRunner().invoke(cli, ["new", "young", "--draft", "-o", "IN-X.dat"], input="a title\n!\n")
    assert isinstance(done.exception, UnsafePlace) and reported in str(done.exception)


def test_a_file_that_is_exchanged_behind_the_look_at_it_is_refused(thesis, monkeypatch):
    """As between two processes: the look sees nothing, the opening finds the link or the pipe."""
    os.symlink("thesis", "link")
    os.mkfifo("pipe")
    really = os.stat
    for name in ("link", "pipe"):
        looks = iter([FileNotFoundError])

        def look(path, looks=looks, **how):
            for failure in looks:
                raise failure
            return really(path, **how)

        monkeypatch.setattr(os, "stat", look)
        with pytest.raises(UnsafePlace):
            open_managed(name, os.O_RDWR)


def test_an_open_folder_is_the_same_when_its_path_leads_elsewhere(thesis):
    os.mkdir("folder")
    with ManagedFolder("folder") as folder:
        os.rename("folder", "aside")
        os.mkdir("elsewhere")
        os.symlink("elsewhere", "folder")
        os.close(folder.open("file", os.O_WRONLY | os.O_CREAT))
    assert os.listdir("aside") == ["file"] and not os.listdir("elsewhere")


@pytest.mark.processes
def test_a_run_among_pipes_ends_and_hears_sigterm(thesis):
    """A pipe with the name of a temporary file made `run` hang, deaf to SIGTERM."""
    os.mkfifo(names_of_temporary_files("OUT1-3-1.dat"))
    run = [sys.executable, "-m", "flexmb_cli", "run", str(DECK), "--no-h5", "-q"]
    done = subprocess.run(run, timeout=300, capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")
    process = subprocess.Popen(run)
    time.sleep(0.3)
    process.terminate()
    assert process.wait(timeout=60) in (0, 143, -signal.SIGTERM)
