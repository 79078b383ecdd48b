"""Options of `flexmb run` that mean nothing, or contradict others, are told, never passed over."""

from pathlib import Path

import pytest
from click.testing import CliRunner

from flexmb_cli.cli.check import check
from flexmb_cli.cli.run import run
from flexmb_cli.deck.text import decode
from flexmb_cli.dialects.recognise import read_deck
from flexmb_cli.run.model import warn_of_foreign_options
from flexmb_cli.run.outcome import Outcome, RunOptions
from tests.dialects.vsdf.vsdf_decks import RIGID

FOUR_BAR = str(Path(__file__).resolve().parents[2] / "decks/young/IN4-BAR.dat")


def test_a_vsdf_deck_takes_a_tolerance_and_has_one_formulation():
    outcome = Outcome("links.vsdf")
    options = RunOptions(integration={"rtol": 1e-4}, formulation="absolute")
    warn_of_foreign_options(read_deck(decode("links.vsdf", RIGID.encode())), options, outcome)
    assert [(fault.severity, fault.message) for fault in outcome.faults] == [
        (
            "warning",
            "--formulation has no effect on this VSDF deck: there is one formulation; flexmb verify compares "
            "it with a second one",
        )
    ]


def test_only_the_options_given_are_named():
    outcome = Outcome("links.vsdf")
    options = RunOptions(solver={"smallest_pivot": 1e-6}, formulation="absolute")
    warn_of_foreign_options(read_deck(decode("links.vsdf", RIGID.encode())), options, outcome)
    assert [fault.message for fault in outcome.faults] == [
        "--epslu has no effect on this VSDF deck: forward dynamics solve to round-off; --rtol sets the "
        "tolerance of a step",
        "--formulation has no effect on this VSDF deck: there is one formulation; flexmb verify compares it "
        "with a second one",
    ]


@pytest.mark.parametrize("name", ["out", "h5"])
def test_a_file_that_shall_not_be_written_is_not_named(name, tmp_path):
    done = CliRunner().invoke(run, [FOUR_BAR, f"--no-{name}", f"--{name}", str(tmp_path / "x")])
    assert (
        done.exit_code == 2 and f"--no-{name} and --{name} {tmp_path / 'x'} exclude each other" in done.stderr
    )
    assert not list(tmp_path.iterdir())


def test_a_number_that_is_set_twice_is_told():
    done = CliRunner().invoke(check, [FOUR_BAR, "--set", "time.end=2", "--set", "time.end=0.5"])
    assert done.exit_code == 0
    assert "note: --set names time.end 2 times: the last counts, time.end=0.5" in done.stderr
    assert "--set names" not in CliRunner().invoke(check, [FOUR_BAR, "--set", "time.end=2"]).stderr
