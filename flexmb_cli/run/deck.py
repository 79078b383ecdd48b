"""Run one deck of any dialect; every failure becomes an outcome with its exit code."""

from ..results.files.file_names import refuse_foreign
from .earlier_results import EarlierResults, paths_of
from .exit_status import ending_recorded
from .model import open_deck, own_options, warn_of_foreign_options
from .outcome import Listener, Outcome, Run, RunOptions, Stop, TextStream
from .solution import solve_deck


def run_deck(
    path: str, options: RunOptions, listener: Listener | None = None, stdout: TextStream | None = None
) -> Outcome:
    """Read, solve and write the deck at `path` ("-": standard input).

    `stdout` receives the OUT table of `--out -`.  Faults of the deck, a full disk and stops by signals are in
    the outcome; they raise nothing.
    """
    outcome, earlier = Outcome(path), EarlierResults(path, options)
    with ending_recorded(outcome, options):
        with Stop.released():
            deck = open_deck(path, options, outcome)
        warn_of_foreign_options(deck, options, outcome)
        run = Run(
            outcome, own_options(deck, options), (listener or Listener()).kept_in(outcome.notices), stdout
        )
        paths = paths_of(deck.source.name, deck.dialect, options, deck.model)
        try:
            refuse_foreign((file for file in paths.files if file not in paths.named), options.force)
            solve_deck(deck, paths, run)
        finally:
            if options.echo:
                from ..results.texts.echo import echo

                # Building the model has filled in the defaults of empty fields.
                outcome.echo = echo(deck)
    earlier.set_aside(outcome)
    return outcome
