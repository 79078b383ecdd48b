"""A folder stands for the decks in it; the last lines say what failed, and GitHub gets marks."""

import pickle
import shutil
from pathlib import Path

import pytest
from click.testing import CliRunner

from flexmb_cli.cli.check import check
from flexmb_cli.cli.run import run
from flexmb_cli.errors import AnalysisError, DeckError, Fault, Place

DECKS = Path(__file__).resolve().parents[2] / "decks"


@pytest.fixture
def folder(tmp_path):
    """Two good decks, one of them in a folder below, a bad one, a result, and a listing of CalculiX."""
    for name in ("IN1-1-1.dat", "IN1-2-1.dat"):
        place = tmp_path / "decks" / ("inner" if "2" in name else "")
        place.mkdir(parents=True, exist_ok=True)
        shutil.copy(DECKS / "young" / name, place)
    (tmp_path / "decks" / "BAD.DAT").write_text("nonsense\n")
    for other in ("OUT1-1-1.dat", "plate.dat", "plate.inp", ".hidden.dat", "notes.txt"):
        (tmp_path / "decks" / other).write_text("no deck\n")
    return tmp_path / "decks"


def test_run_and_check_take_the_decks_of_a_folder_and_close_with_what_failed(folder):
    results = folder.parent / "results"
    for command, passed, options in ((run, "run", ["-o", str(results)]), (check, "passed", [])):
        done = CliRunner().invoke(command, [str(folder), *options])
        *_, head, failure = done.stderr.splitlines()
        assert done.exit_code == 2
        assert head.startswith(f"3 decks: 2 {passed}, 1 failed; ") and head.endswith(" s")
        assert failure.startswith(f"  {folder / 'BAD.DAT'}: no dialect begins like this")
    assert {file.name for file in results.glob("*.dat")} == {"OUT1-1-1.dat", "OUT1-2-1.dat"}


def test_quiet_and_a_single_deck_have_no_closing_lines(folder):
    (folder / "BAD.DAT").unlink()
    assert CliRunner().invoke(check, ["-q", str(folder)]).stderr == ""
    assert " decks: " not in CliRunner().invoke(check, [str(folder / "IN1-1-1.dat")]).stderr


def test_a_folder_without_decks_is_refused(tmp_path):
    done = CliRunner().invoke(check, [str(tmp_path)])
    assert "no deck in this folder: their names end in .dat, .pas, .vsdf" in done.stderr
    assert done.exit_code == 2


def test_faults_are_marked_in_the_files_of_a_pull_request_only_in_jobs_of_github(folder, monkeypatch):
    """Form: GitHub, "Workflow commands": `::error file={name},line={line},title={title}::{message}`."""
    bad = folder / "BAD.DAT"
    assert "::error" not in CliRunner().invoke(check, [str(bad)]).stderr
    monkeypatch.setenv("GITHUB_ACTIONS", "true")
    marks = [line for line in CliRunner().invoke(check, [str(bad)]).stderr.splitlines() if line[:2] == "::"]
    (mark,) = marks
    assert mark.startswith(f"::error file={bad},title=DECK-013,line=1,col=1::no dialect begins like this")


def test_errors_survive_pickling_whole():
    """Processes of `diff -j` and of users' own pools send them."""
    fault = Fault("error", "a rule", Place(3, 4, 2), id="DECK-001")
    for error in (DeckError([fault]), AnalysisError(fault, 0.5, {"gap": 1.0})):
        error.file = "a.dat"
        copy = pickle.loads(pickle.dumps(error))
        assert (type(copy), str(copy), vars(copy)) == (type(error), str(error), vars(error))
