"""Options of `flexmb run` that mean nothing to a deck's dialect are told, never passed over."""

from flexmb_cli.read.dialects import read_deck
from flexmb_cli.read.text import decode
from flexmb_cli.run.deck import warn_of_foreign_options
from flexmb_cli.run.outcome import Outcome, RunOptions
from tests.read.vsdf_decks import RIGID


def test_a_vsdf_deck_has_its_own_tolerance_and_is_not_resumed():
    outcome = Outcome("links.vsdf")
    options = RunOptions(integration={"rtol": 1e-4}, resume=True, formulation="absolute")
    warn_of_foreign_options(read_deck(decode("links.vsdf", RIGID.encode())), options, outcome)
    assert [(fault.severity, fault.message) for fault in outcome.faults] == [
        ("warning", "--formulation is for DAFMS decks and has no effect here"),
        ("warning", "--rtol, --atol, --method and --resume are for DAFMS decks and have no effect here"),
    ]
