"""Runs that are stopped between blocks of rows and resumed."""

from flexmb_cli.run.outcome import RunOptions
from flexmb_cli.run.solution import run_deck
from tests.run.dafms_runs import stop_after


def resumed(folder, name, text, stops, **options):
    """Files of a run without a stop, and of one that is stopped after so many blocks each time."""
    deck = folder / name
    deck.write_text(text)
    whole, stopped = folder / "whole", folder / "stopped"

    def run(place, listener=None, resume=False):
        return run_deck(str(deck), RunOptions(folder=str(place), resume=resume, **options), listener)

    assert run(whole).exit_code == 0
    for k, blocks in enumerate(stops):
        outcome = run(stopped, stop_after(blocks), resume=k > 0)
        assert (outcome.exit_code, outcome.resumable) == (130, True)
    last = run(stopped, resume=True)
    assert last.exit_code == 0
    return [{path.name: path.read_bytes() for path in place.iterdir()} for place in (whole, stopped)]
