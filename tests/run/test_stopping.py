"""A stop that lands where libraries turn it into exceptions of their own."""

from pathlib import Path

import pytest

from flexmb_cli.run import deck
from flexmb_cli.run.outcome import TERMINATED, RunOptions, Terminated

DECK = str(Path(__file__).resolve().parents[2] / "decks/young/IN1-1-1.dat")


def swallowing(*arguments):
    """What numba does when it is interrupted while it compiles."""
    try:
        raise Terminated
    except Terminated:
        raise SystemError("a callback returned a result with an exception set") from None


def test_a_stop_that_became_another_exception_is_still_a_stop(monkeypatch):
    monkeypatch.setitem(deck.RUNNERS, "young", swallowing)
    monkeypatch.setattr(Terminated, "asked", True)
    assert deck.run_deck(DECK, RunOptions()).exit_code == TERMINATED


def test_a_fault_without_a_stop_stays_a_fault(monkeypatch):
    monkeypatch.setitem(deck.RUNNERS, "young", swallowing)
    with pytest.raises(SystemError):
        deck.run_deck(DECK, RunOptions())
