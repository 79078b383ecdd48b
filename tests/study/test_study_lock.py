"""Two sweeps of one study, and cases that vanish: nothing is lost without a word."""

import json
import os
from pathlib import Path

import h5py
import pytest
from click.testing import CliRunner

from flexmb_cli.cli import cli
from flexmb_cli.errors import DeckError, OutputError
from flexmb_cli.study.checkpoints import StudyLock
from flexmb_cli.study.sweep import Sweep, solve_block, write_study_table
from flexmb_cli.study.workers import solve_here

DECK = Path(__file__).resolve().parents[2] / "decks/young/IN1-3-1.dat"
STUDY = f"""
deck = "{DECK}"
[parameters]
"point.1.x" = {{ from = 0.0, to = 1.0, count = 200 }}
[results]
top = "max point.1.z"
"""


@pytest.fixture
def study(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("s.toml").write_text(STUDY)
    return "s.toml"


def begun(study, **how):
    return Sweep.of(study, "s.h5.parts", **how)


def solve(sweep):
    solve_here(sweep, sweep.pending(), lambda cases: None)


@pytest.mark.parametrize("how", [(), ("--fresh",)])
def test_a_second_sweep_of_a_folder_is_refused_and_the_first_loses_nothing(study, how):
    first = begun(study)
    solve_block(first.job, 0)
    second = CliRunner().invoke(cli, ["sweep", study, *how])
    assert isinstance(second.exception, OutputError) and second.exception.exit_code == 2
    reported = str(second.exception)
    assert reported.startswith("s.toml: another sweep is writing this study, its cases are in ")
    assert "wait until it ends or stop it" in reported
    solve(first)
    write_study_table("s.h5", first)
    with h5py.File("s.h5") as table:
        assert table["case"][:].tolist() == list(range(1, 201))


def test_the_lock_goes_with_who_held_it(study):
    """A file that is left locks nothing; the table's end takes it along with the folder."""
    begun(study)
    assert Path("s.h5.parts/lock").exists()
    sweep = begun(study)
    assert sweep.restored
    solve(sweep)
    write_study_table("s.h5", sweep)
    assert sorted(os.listdir()) == ["s.h5", "s.toml"]


def test_parts_that_cannot_be_removed_make_no_wrong_command_of_a_written_table(study, monkeypatch):
    """Exit 2 would say that nothing was written."""
    sweep = begun(study)
    solve(sweep)

    def refused(*_arguments, **_how):
        raise PermissionError(13, "Permission denied")

    with monkeypatch.context() as patch:
        patch.setattr(os, "unlink", refused)
        with pytest.raises(OutputError, match=r"permission denied; the table s\.h5 is complete") as reported:
            write_study_table("s.h5", sweep)
    assert reported.value.exit_code == 1
    with h5py.File("s.h5") as table:
        assert len(table["case"]) == 200
    # It held its lock until Python threw it away: refused here, and a warning in whatever test came next.
    begun(study)


def test_a_sweep_that_found_the_lock_of_one_just_ended_takes_a_new_one(study, monkeypatch):
    """Between its look for the folder and its lock the other removed both: the lock it holds is nowhere."""
    import flexmb_cli.study.checkpoints as study_lock

    held = []

    def hold(file):
        held.append(file)
        if len(held) == 1:
            os.unlink("s.h5.parts/lock")
            os.rmdir("s.h5.parts")
        return True

    monkeypatch.setattr(study_lock, "hold", hold)
    solve(begun(study))
    assert Path("s.h5.parts/lock").exists()
    assert held[0].closed


def test_a_table_is_refused_while_cases_are_missing(study):
    """Two of a block of two are gone, and the second of another: numbered from 1, as in the table."""
    sweep = begun(study)
    solve(sweep)
    os.unlink("s.h5.parts/block-00000003.part")
    last = Path("s.h5.parts/block-00000099.part")
    last.write_bytes(last.read_bytes()[:-1])
    with pytest.raises(OutputError, match=r"3 of 200 cases are missing \(7 to 8, 200\)") as refused:
        write_study_table("s.h5", sweep)
    assert refused.value.exit_code == 1
    assert not Path("s.h5").exists()
    del sweep, refused
    again = begun(study)
    assert (len(again.pending()), again.left) == (2, 3)


def test_the_cases_of_another_block_do_not_count(study):
    sweep = begun(study)
    solve(sweep)
    os.replace("s.h5.parts/block-00000003.part", "s.h5.parts/block-00000004.part")
    with pytest.raises(OutputError, match=r"4 of 200 cases are missing \(7 to 10\)"):
        write_study_table("s.h5", sweep)


def test_a_removal_that_was_cut_short_leaves_no_study(study):
    sweep = begun(study)
    solve(sweep)
    os.replace("s.h5.parts/study.json", "s.h5.parts/.study.json")
    del sweep
    assert not begun(study).restored
    assert sorted(os.listdir("s.h5.parts")) == ["lock", "study.json"]


def test_what_is_told_of_a_stopped_study_is_right_to_the_case(study):
    """51 cases of blocks of two: a whole block less than the half of 52, and one case."""
    sweep = begun(study)
    for block in range(26):
        solve_block(sweep.job, block)
    part = Path("s.h5.parts/block-00000025.part")
    part.write_bytes(part.read_bytes()[:-1])
    del sweep
    done = CliRunner().invoke(cli, ["sweep", study])
    assert done.exit_code == 0
    assert "continuing a stopped study: 51 of 200 cases are complete" in done.output


@pytest.mark.skipif(not hasattr(os, "geteuid"), reason="owners of files")
@pytest.mark.parametrize("given_away", ["s.h5.parts", "s.h5.parts/block-00000000.part"])
def test_cases_of_another_user_are_told(study, monkeypatch, given_away):
    """Who may write a part file chooses rows of the table."""
    sweep = begun(study)
    solve_block(sweep.job, 0)
    del sweep
    owner = os.stat(given_away).st_uid
    if owner == 0:  # root gives its files away, others look as somebody else
        os.chown(given_away, 65534, -1)
    else:
        monkeypatch.setattr(os, "geteuid", lambda: owner + 1)
    done = CliRunner().invoke(cli, ["sweep", study])
    said = "belongs to another user; its cases are used, with --fresh none are"
    assert f"{study}: warning: {os.path.abspath('s.h5.parts')} {said}" in done.output


def test_a_study_of_which_nothing_is_kept_is_not_gone_on_with(study):
    """As it is left where no scheduler answers."""
    sweep = begun(study)
    assert os.path.isdir("s.h5.parts")
    del sweep
    done = CliRunner().invoke(cli, ["sweep", study])
    assert done.exit_code == 0 and "going on" not in done.output


def test_a_study_that_cannot_be_read_is_told_in_json(study):
    Path("bad.toml").write_text('deck = "nowhere.dat"\n')
    done = CliRunner().invoke(cli, ["sweep", "bad.toml", "--json"])
    reported = json.loads(done.stdout)
    assert (done.exit_code, reported["study"], reported["status"]) == (2, "bad.toml", "bad input")
    assert {fault["file"] for fault in reported["faults"]} == {"bad.toml"}


def test_a_study_that_is_refused_leaves_no_lock(study):
    """The lock was held until Python threw it away; found by fuzzing."""
    first = begun(study)
    solve_block(first.job, 0)
    first.lock.leave()
    Path(study).write_text(STUDY.replace("1.0", "2.0"))
    with pytest.raises(DeckError, match="differs in study") as refused:
        begun(study)
    assert not Path("s.h5.parts/lock").exists()
    # All that the refused one holds still lives.
    StudyLock("s.h5.parts", study).leave()
    del refused
