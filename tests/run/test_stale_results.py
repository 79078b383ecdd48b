"""A run that leaves no result sets aside that of an earlier one: nothing is lost, nothing passes for new.

The command `diff` of the folders then misses the result (tests/results/diff/test_diff_folders.py).
"""

import os
import shutil
import signal
from pathlib import Path

import pytest
from click.testing import CliRunner

from flexmb_cli.cli import cli
from flexmb_cli.cli.run import run as run_command
from flexmb_cli.cli.terminal import deck_processes
from flexmb_cli.errors import OutputError
from flexmb_cli.run import solution as run_deck_module
from flexmb_cli.run.outcome import Listener, RunOptions
from flexmb_cli.run.solution import run_deck

DECKS = Path(__file__).resolve().parents[2] / "decks"
FOUR_BAR = (DECKS / "young/IN4-BAR.dat").read_text()
NAMES = ("OUT4-BAR.dat", "OUT4-BAR.h5")


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A folder with the deck, and the results of an earlier run."""
    monkeypatch.chdir(tmp_path)
    Path("IN4-BAR.dat").write_text(FOUR_BAR)
    assert run_deck("IN4-BAR.dat", RunOptions()).exit_code == 0
    return tmp_path


def flexmb(*words):
    return CliRunner().invoke(cli, [*map(str, words)], standalone_mode=False)


def contents():
    return {name: Path(name).read_bytes() for name in NAMES}


def spoilt(old="0 2.5 0.1", new="0 2.5 x"):
    Path("IN4-BAR.dat").write_text(FOUR_BAR.replace(old, new))


def vanished():
    os.unlink("IN4-BAR.dat")


@pytest.mark.parametrize(
    ("harm", "options"),
    [(spoilt, ()), (vanished, ()), (lambda: None, ("--set", "driver.9.B=1")),
     (lambda: None, ("--method", "radau", "--strict"))],
    ids=["bad deck", "no deck", "no such number", "strict"],
)  # fmt: skip
def test_what_an_earlier_run_left_is_renamed(folder, harm, options):
    before = contents()
    harm()
    done = flexmb("run", "IN4-BAR.dat", "-q", *options)
    assert done.exit_code in (1, 2)
    assert "since this one has none: OUT4-BAR.dat.stale, OUT4-BAR.h5.stale\n" in done.stderr
    assert not any(map(os.path.exists, NAMES))
    assert {name: Path(f"{name}.stale").read_bytes() for name in NAMES} == before


@pytest.mark.parametrize("jobs", ["1", "2"])
def test_faults_of_flexmb_and_of_the_disk_count_as_well(folder, monkeypatch, jobs):
    for fault, code in ((ZeroDivisionError("x"), 3), (OutputError("full", 1), 1)):

        def failing(*_, fault=fault):
            raise fault

        monkeypatch.setattr(run_deck_module, "solve_deck", failing)
        assert run_deck("IN4-BAR.dat", RunOptions()).exit_code == code
        assert not any(map(os.path.exists, NAMES))
        for name in NAMES:
            os.rename(f"{name}.stale", name)


def test_nothing_is_lost_where_a_stale_result_stands_already(folder):
    Path("OUT4-BAR.dat.stale").write_text("older")
    Path("OUT4-BAR.dat.stale.2").write_text("my notes")
    spoilt()
    outcome = run_deck("IN4-BAR.dat", RunOptions())
    assert outcome.faults[-1].message.endswith(": OUT4-BAR.dat.stale.3, OUT4-BAR.h5.stale")
    assert (Path("OUT4-BAR.dat.stale").read_text(), Path("OUT4-BAR.dat.stale.2").read_text()) == (
        "older",
        "my notes",
    )


@pytest.mark.parametrize("words", [
    ["run", "--nope", "IN4-BAR.dat"],
    ["run", "IN4-BAR.dat", "--json", "--out", "-"],
    ["run", "IN4-BAR.dat", "IN4-BAR.dat"],
    ["check", "IN4-BAR.dat", "--set", "driver.9.B=1"],
    ["run", "IN4-BAR.da"],
    ["run", "IN4-BAR"],
])  # fmt: skip
def test_a_slip_of_the_hand_renames_nothing(folder, words):
    """Nor does the name of another deck, to which the results do not belong."""
    before = contents()
    assert flexmb(*words).exit_code != 0 or flexmb(*words).exception
    assert contents() == before


def test_files_of_the_user_and_tables_of_studies_stay(folder):
    Path("OUT4-BAR.dat").write_text("my notes")
    spoilt()
    assert run_deck("IN4-BAR.dat", RunOptions()).exit_code == 2
    assert Path("OUT4-BAR.dat").read_text() == "my notes" and Path("OUT4-BAR.h5.stale").exists()


@pytest.mark.parametrize("rows", [0, 3])
def test_rows_of_a_stopped_run_are_its_result(folder, rows):
    """Without any, the earlier result is set aside; with some, it is replaced by them."""
    solved = 0

    def advance(count):
        nonlocal solved
        solved += count
        if solved > rows or not rows:
            raise MemoryError

    begin = advance if not rows else (lambda count: None)
    outcome = run_deck("IN4-BAR.dat", RunOptions(), Listener(begin=begin, advance=advance))
    assert outcome.exit_code == 1
    assert [Path(f"{name}.stale").exists() for name in NAMES] == 2 * [not rows]
    assert [Path(name).exists() for name in NAMES] == 2 * [bool(rows)]


def _killed(line, options):
    line.recv()
    os.kill(os.getpid(), signal.SIGKILL)


@pytest.mark.processes
def test_results_of_a_deck_whose_process_is_killed_are_set_aside(folder, monkeypatch):
    monkeypatch.setattr(deck_processes, "_serve", _killed)
    shutil.copy("IN4-BAR.dat", "INB.dat")
    done = CliRunner().invoke(run_command, ["IN4-BAR.dat", "INB.dat", "-j", "2", "-q"])
    assert done.exit_code == 1 and "was killed from outside" in done.stderr
    assert not any(map(os.path.exists, NAMES)) and Path("OUT4-BAR.h5.stale").exists()


def test_a_folder_that_cannot_be_changed_is_named(folder, monkeypatch):
    def refused(*_):
        raise PermissionError(1, "Operation not permitted")

    monkeypatch.setattr("flexmb_cli.run.earlier_results.os.rename", refused)
    spoilt()
    (message,) = (f.message for f in run_deck("IN4-BAR.dat", RunOptions()).faults if f.id == "RUN-072")
    assert message == "left by an earlier run, and cannot be renamed: OUT4-BAR.dat, OUT4-BAR.h5"


@pytest.mark.parametrize(("deck", "form", "suffix"), [
    ("dafms/spatial_rigid.DAT", "vsdf", ".vsdf"),
    ("dafms/spatial_rigid.DAT", "mjcf", ".xml"),
])  # fmt: skip
def test_a_failed_conversion_sets_the_earlier_one_aside(tmp_path, monkeypatch, deck, form, suffix):
    monkeypatch.chdir(tmp_path)
    shutil.copy(DECKS / deck, "c.DAT")
    words = ["convert", "c.DAT", "--to", form]
    assert flexmb(*words).exit_code == 0
    before = Path(f"c{suffix}").read_bytes()
    Path("c.DAT").write_text("DFMB nothing else\n")
    assert flexmb(*words).exception is not None
    assert Path(f"c{suffix}.stale").read_bytes() == before and not Path(f"c{suffix}").exists()
    Path(f"c{suffix}").write_text("my model")
    assert flexmb(*words).exception is not None
    assert Path(f"c{suffix}").read_text() == "my model"


def test_a_study_with_errors_sets_its_earlier_table_aside(folder):
    study = 'deck = "IN4-BAR.dat"\n[parameters]\n"driver.1.B" = [1.0]\n[results]\nlast = "last body.2.x"\n'
    Path("s.toml").write_text(study)
    assert flexmb("sweep", "s.toml", "-q").exit_code == 0
    before = Path("s.h5").read_bytes()
    Path("s.toml").write_text(study + "x =")
    assert flexmb("sweep", "s.toml", "-q").exit_code == 2
    assert Path("s.h5.stale").read_bytes() == before and not Path("s.h5").exists()


def test_a_listing_that_is_given_for_a_deck_stays(folder):
    """Its own result would have its name."""
    shutil.copy("OUT4-BAR.dat", "x.OUT")
    assert run_deck("x.OUT", RunOptions()).exit_code == 2
    assert Path("x.OUT").exists() and not Path("x.OUT.stale").exists()


def test_the_folder_of_results_lacks_what_was_set_aside(folder):
    """The sequence of a pipeline: the deck is spoilt, and the comparison with the reference fails."""
    os.mkdir("reference")
    for name in NAMES:
        shutil.copy(name, "reference")
    assert flexmb("run", "-q", "IN4-BAR.dat", "-o", "results").exit_code == 0
    assert flexmb("diff", "reference", "results").exit_code == 0
    spoilt()
    assert flexmb("run", "-q", "IN4-BAR.dat", "-o", "results").exit_code == 2
    done = flexmb("diff", "reference", "results", "--junit", "diff.xml")
    assert done.exit_code == 1 and "0 files compared, 0 differ, 2 missing" in done.stdout
    assert Path("diff.xml").read_text().count("<failure") == 2
