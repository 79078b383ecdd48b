"""A stop that lands where libraries turn it into exceptions of their own."""

from pathlib import Path

import pytest

from flexmb_cli.run import deck
from flexmb_cli.run.outcome import INTERRUPTED, TERMINATED, RunOptions, Stop, Terminated

DECKS = Path(__file__).resolve().parents[2] / "decks"
DECK = str(DECKS / "young/IN1-1-1.dat")


def swallowing(*arguments):
    """What numba does when it is interrupted while it compiles."""
    try:
        raise Terminated
    except Terminated:
        raise SystemError("a callback returned a result with an exception set") from None


@pytest.mark.parametrize("asked, code", [(Terminated, TERMINATED), (KeyboardInterrupt, INTERRUPTED)])
def test_a_stop_that_became_another_exception_is_still_a_stop(monkeypatch, asked, code):
    monkeypatch.setitem(deck.RUNNERS, "young", swallowing)
    monkeypatch.setattr(Stop, "asked", asked)
    assert deck.run_deck(DECK, RunOptions()).exit_code == code


@pytest.mark.parametrize("path", ["young/IN4-BAR.dat", "dafms/sliding_mass.DAT"])
def test_a_stop_that_got_lost_is_heeded_after_the_block_of_rows(tmp_path, monkeypatch, path):
    monkeypatch.setattr(Stop, "asked", KeyboardInterrupt)
    outcome = deck.run_deck(str(DECKS / path), RunOptions(folder=str(tmp_path)))
    assert outcome.exit_code == INTERRUPTED and outcome.files


def test_a_fault_without_a_stop_stays_a_fault(monkeypatch):
    monkeypatch.setitem(deck.RUNNERS, "young", swallowing)
    with pytest.raises(SystemError):
        deck.run_deck(DECK, RunOptions())
