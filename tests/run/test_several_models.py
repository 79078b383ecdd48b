"""Several models in one FMBD.DAT: after STAR the next DFMB card, until STOP (thesis of Zhao, 1992, QCONTR).

Expected: the k-th model gives what a deck of its own gives.
"""

import pytest
from click.testing import CliRunner

from flexmb_cli.cli.check import check
from flexmb_cli.cli.modes import modes
from flexmb_cli.cli.run import run as run_command
from flexmb_cli.deck import several_models
from flexmb_cli.deck.record import DeckText
from flexmb_cli.deck.several_models import models_of, only_model
from flexmb_cli.errors import DeckError
from flexmb_cli.run.outcome import RunOptions
from flexmb_cli.run.solution import run_deck
from flexmb_cli.solvers.tree import steps
from tests.run.dafms_runs import DECKS, stop_after

TEXT = (DECKS / "pendulum.DAT").read_text().replace(" 6000\n", "   20\n")
HEAD = "    1    2\n"
HEAVY = TEXT.replace("        .2\nCONN", "        .3\nCONN").replace("    1        .2\n", "    1        .3\n")
SECOND = HEAVY.replace("DFMB ELASTIC", "DFMB HEAVIER").replace("      .018      .018", "      .027      .027")
BOTH = TEXT.replace("STOP\n", "") + SECOND.removeprefix(HEAD)


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """Both models in one deck, and each in its own."""
    monkeypatch.chdir(tmp_path)
    for name, text in (("FMBD", BOTH), ("one", TEXT), ("two", SECOND)):
        (tmp_path / f"{name}.DAT").write_text(text)
    return tmp_path


def flexmb(*arguments):
    return CliRunner().invoke(run_command, [str(argument) for argument in arguments])


def test_every_model_writes_what_its_own_deck_writes(folder):
    assert flexmb("FMBD.DAT", "one.DAT", "two.DAT", "-q").exit_code == 0
    for model, name in ((1, "one"), (2, "two")):
        for ending in ("OUT", "T2", "T3"):
            found = (folder / f"FMBD-{model}.{ending}").read_bytes()
            assert found == (folder / f"{name}.{ending}").read_bytes()
        assert (folder / f"FMBD-{model}.h5").exists()
    assert not (folder / "FMBD.OUT").exists()
    assert (folder / "one.T2").read_bytes() != (folder / "two.T2").read_bytes()


def test_settings_name_a_model_or_hold_for_all(folder):
    changes = ("--set", "2:mass.1.BM=0.35", "--set", "time.IT=3")
    assert flexmb("FMBD.DAT", "--no-h5", "-q", *changes).exit_code == 0
    echoes = [(folder / f"FMBD-{model}.OUT").read_text() for model in (1, 2)]
    assert ["BM==    1   0.35000" in echo for echo in echoes] == [False, True]
    assert [len((folder / f"FMBD-{k}.T2").read_text().splitlines()) for k in (1, 2)] == [4, 4]
    done = flexmb("FMBD.DAT", "--set", "3:time.IT=2")
    # Once, and not once a model.
    assert (done.exception.exit_code, done.exception.file) == (2, "FMBD.DAT")
    assert str(done.exception) == "--set 3:time.IT=2: the deck holds 2 models"
    done = flexmb("FMBD.DAT", "--out", "-")
    assert str(done.exception).startswith("1:FMBD.DAT and 2:FMBD.DAT would both write to standard output")


def test_one_model_is_run_by_its_name(folder):
    assert flexmb("2:FMBD.DAT", "-q").exit_code == 0
    assert sorted(path.name for path in folder.glob("FMBD-*")) == [
        f"FMBD-2.{e}" for e in ("OUT", "T2", "T3", "h5")
    ]
    done = flexmb("3:FMBD.DAT", "-q")
    assert done.exit_code == 2 and "there is no model 3: the deck holds 2" in done.stderr


def test_a_stopped_model_is_resumed_by_its_name(folder, monkeypatch):
    monkeypatch.setattr(steps, "LARGEST_BLOCK", 5)
    stopped = run_deck("2:FMBD.DAT", RunOptions(), stop_after(2))
    assert (stopped.exit_code, stopped.resumable) == (130, True)
    assert (folder / "FMBD-2.resume").exists()
    assert run_deck("2:FMBD.DAT", RunOptions(resume=True)).exit_code == 0
    assert run_deck("two.DAT", RunOptions()).exit_code == 0
    assert (folder / "FMBD-2.T2").read_bytes() == (folder / "two.T2").read_bytes()


def test_faults_are_told_with_the_model_and_the_line_of_the_deck(folder):
    (folder / "FMBD.DAT").write_text(BOTH.replace("    1        .3\n", "    1        .x\n", 1))
    done = CliRunner().invoke(check, ["FMBD.DAT"])
    assert done.exit_code == 2
    line = BOTH.splitlines().index("    1        .3") + 1
    assert f"2:FMBD.DAT:{line}:" in done.stderr
    assert "1:FMBD.DAT: DAFMS deck" in done.stdout


def test_what_stands_behind_stop_is_no_model(folder):
    (folder / "FMBD.DAT").write_text(TEXT + SECOND.removeprefix(HEAD))
    assert models_of("FMBD.DAT") == ["FMBD.DAT"]
    with pytest.raises(DeckError, match="there is no model 2"):
        only_model(DeckText("FMBD.DAT", TEXT + SECOND, ""), 2)


def test_results_of_models_and_of_other_decks_are_not_mixed_up(folder):
    (folder / "FMBD-2.DAT").write_text(TEXT)
    done = flexmb("FMBD.DAT", "FMBD-2.DAT")
    assert "would both write FMBD-2.OUT" in str(done.exception)


def test_a_setting_of_a_model_that_is_not_there_is_reported_once(folder):
    for command in (check, modes):
        found = CliRunner().invoke(command, ["FMBD.DAT", "--set", "7:mass.1.BM=3"])
        assert isinstance(found.exception, DeckError)
        assert [fault.message for fault in found.exception.faults] == [
            "--set 7:mass.1.BM=3: the deck holds 2 models"
        ]


def test_a_deck_of_more_models_than_are_solved_is_refused(folder, monkeypatch):
    """Each model reads the whole deck: ten thousand models of a kilobyte would take hours."""
    monkeypatch.setattr(several_models, "MOST_MODELS", 1)
    assert models_of("FMBD.DAT") == ["FMBD.DAT"]
    outcome = run_deck("FMBD.DAT", RunOptions())
    assert outcome.exit_code == 2 and "a second DFMB card" in outcome.faults[0].message
