"""`flexmb run`: solve decks and write their results."""

import json
import os
import sys
from collections.abc import Iterator, Sequence
from typing import Any

import click

from ..deck.several_models import named_model
from ..errors import ANALYSIS_FAILED, DONE, INTERNAL_FAULT
from ..model.integrators import METHOD_OPTIONS, TREE_METHODS
from ..results.files.file_names import refuse_shared
from ..run.earlier_results import EarlierResults
from ..run.outcome import SOLVER_OPTIONS, Listener, Outcome, RunOptions, Stop
from ..run.processes.signal_mask import stop_on_signals
from .options.deck_options import DECK, deck_options, refuse_strange_models, show_faults, with_models
from .options.output_file import ABSOLUTE_TOLERANCE, FORCE, RELATIVE_TOLERANCE, Finite, WrittenPlace
from .terminal.closing_lines import ClosingLines
from .terminal.screen import WrongCall, notify, show, standard_output, wants_debug


@click.command()
@DECK
@deck_options
@click.option(
    "-v",
    "--verbose",
    is_flag=True,
    help="Add solver statistics; without a terminal, print the progress every ten seconds.",
)
@click.option("-o", "--output-dir", "folder", default=".", type=WrittenPlace(), metavar="DIR",
              help="Folder of the results.")  # fmt: skip
@click.option("--out", type=WrittenPlace(), metavar="PATH|-", help="OUT table; - is standard output.")
@click.option("--h5", type=WrittenPlace(), metavar="PATH", help="HDF5 result.")
@click.option("--no-out", is_flag=True, help="Write no OUT table.")
@click.option("--no-h5", is_flag=True, help="Write no HDF5 result.")
@click.option("--only", multiple=True, metavar="NAME",
              help="Store only the datasets of this quantity as HDF5; repeatable.")  # fmt: skip
@click.option("--layout", type=click.Choice(["safe", "historic"]), default="safe", show_default=True,
              help="historic: signed zeros, fields that run together.")  # fmt: skip
@FORCE
@click.option(
    "-j", "--jobs", type=click.IntRange(1), default=1, show_default=True, help="Decks run in parallel."
)
@click.option("--feps", type=Finite(0), help="YOUNG: end Newton at this residual (historic 1e-4).")
@click.option("--epslu", type=Finite(0, 1), help="YOUNG: smallest pivot (historic 1e-5).")
@click.option("--nrmax", type=click.IntRange(1), help="YOUNG: most iterations of the assembly (250).")
@click.option("--rtol", type=RELATIVE_TOLERANCE,
              help="Relative tolerance of a step, in place of the deck's.")  # fmt: skip
@click.option("--atol", type=ABSOLUTE_TOLERANCE,
              help="Absolute tolerance of a step, in place of the deck's.")  # fmt: skip
@click.option("--method", type=click.Choice(list(dict.fromkeys((*METHOD_OPTIONS, *TREE_METHODS)))),
              help=f"Integrator, in place of the deck's: {', '.join(METHOD_OPTIONS)} for YOUNG and VSDF, "
              f"{', '.join(TREE_METHODS)} for DAFMS.")  # fmt: skip
@click.option("--formulation", type=click.Choice(["kane", "absolute"]), default="kane", show_default=True,
              help="DAFMS: Kane's equations of the tree, or bodies in absolute coordinates.")  # fmt: skip
@click.option("--resume", is_flag=True, help="Continue a stopped run, to the same results.")
@click.option("--as-printed", is_flag=True,
              help="YOUNG: repeat the errors of the program of 1996, to explain old listings.")  # fmt: skip
@click.option("--estimate-error", is_flag=True,
              help="Estimate the global error of every quantity by a second, finer run.")  # fmt: skip
@click.option("--from-equilibrium", is_flag=True,
              help="Begin at rest, in the equilibrium under the loads.")  # fmt: skip
def run(decks: Any, as_json: bool, quiet: bool, verbose: bool, jobs: int, **options: Any) -> None:
    """Solve every DECK and write its OUT table and HDF5 result.

    A folder stands for the decks in it.

    \b
    Example:
        flexmb run decks/young/IN4-BAR.dat -o results
        flexmb run decks -j 2 -o results
    """

    decks = with_models(decks)
    _refuse_mixed_output(as_json, options)
    _refuse_mixed_options(options)
    if jobs > 1 and len(decks) > 1 and "-" in decks:
        message = "standard input goes to one process only: with -j give every deck by its name"
        raise WrongCall(message, id="CLI-049")
    _note_names_behind_only(decks, options, quiet)
    solver = _given(options, **SOLVER_OPTIONS)
    integration = _given(options, rtol="rtol", atol="atol", method="method")
    choices = RunOptions(solver=solver, integration=integration, debug=wants_debug(), **options)
    refuse_strange_models(decks, choices.changes)
    earlier = {deck: EarlierResults(deck, choices) for deck in decks}
    _refuse_shared_files(earlier, decks, choices)
    stop_on_signals()
    codes = []
    closing_lines = ClosingLines(len(decks), "run")
    for outcome in _all_outcomes(earlier, choices, jobs, quiet, verbose):
        if outcome.echo:
            show(outcome.echo, err=True)
        _report_outcome(outcome, choices, quiet, verbose)
        if as_json:
            click.echo(json.dumps(outcome.as_dict()))
        closing_lines.add(outcome)
        codes.append(outcome.exit_code)
    if not quiet:
        closing_lines.show()
    sys.exit(max(codes))


def _refuse_mixed_output(as_json: bool, options: dict[Any, Any]) -> None:
    if options["out"] == "-" and as_json:
        raise WrongCall("--out - and --json both take standard output; give --out a file", id="CLI-045")
    # In the place of a closed stream (`>&-`) stands an open file, see `cli._open_closed_streams`.
    if options["out"] == "-" and getattr(sys.stdout, "name", "") == os.devnull:
        raise WrongCall("--out - writes to standard output, which is closed", id="CLI-046")
    if options["h5"] == "-":
        raise WrongCall("--h5 needs a file: an HDF5 result cannot go to standard output", id="CLI-047")
    for name in ("out", "h5"):
        if options[name] is not None and options[f"no_{name}"]:
            raise WrongCall(
                f"--no-{name} and --{name} {options[name]} exclude each other: give one", id="CLI-048"
            )


def _note_names_behind_only(decks: Sequence[str], options: dict[Any, Any], quiet: bool) -> None:
    """`--only point energy` takes the second name for a deck."""

    known = all(deck == "-" or os.path.exists(named_model(deck)[0]) for deck in decks)
    if options["only"] and not quiet and not known:
        notify("flexmb: --only takes one quantity: give it once for each, as in --only point --only energy")


def _refuse_mixed_options(options: dict[str, Any]) -> None:
    absolute, estimate = options["formulation"] == "absolute", options["estimate_error"]
    if options["resume"] and absolute:
        message = "--resume goes with --formulation kane: the other one leaves nothing to resume"
        raise WrongCall(message, id="CLI-050")
    if estimate and absolute:
        raise WrongCall("--estimate-error goes with --formulation kane", id="CLI-051")
    if estimate and options["as_printed"]:
        raise WrongCall("--estimate-error and --as-printed exclude each other: give one", id="CLI-052")


def _given(options: dict[Any, Any], **names: Any) -> dict[Any, Any]:
    """Takes the options called as the values of `names` out of `options`; those given, by the keys."""
    values = {key: options.pop(name) for key, name in names.items()}
    return {key: value for key, value in values.items() if value is not None}


def _all_outcomes(
    earlier: dict[str, EarlierResults], options: RunOptions, jobs: int, quiet: bool, verbose: bool
) -> Iterator[Any]:
    """Return what became of every deck; one that was not begun before a stop is as if stopped at its first
    row.
    """
    left = list(earlier)
    for outcome in _outcomes(earlier, options, jobs, quiet, verbose):
        left.remove(outcome.deck)
        yield outcome
    for deck in left:
        outcome = Outcome(deck, Stop.code())
        earlier[deck].set_aside(outcome)
        yield outcome


def _outcomes(
    earlier: dict[str, EarlierResults], options: RunOptions, jobs: int, quiet: bool, verbose: bool
) -> Iterator[Outcome]:
    from .terminal.progress import Progress

    if jobs > 1 and len(earlier) > 1:
        from .terminal.deck_processes import outcomes_in_parallel

        with Progress(f"{len(earlier)} decks", "decks", quiet, verbose) as progress:
            progress.begin(len(earlier))
            for outcome in outcomes_in_parallel(earlier, options, jobs, progress):
                progress.advance(1)
                progress.clear()
                yield outcome
        return
    from .. import interface

    for deck, standing in earlier.items():
        if Stop.asked is not None:
            return
        # The status line ends before anything is said of the outcome.
        with Progress(deck, "rows", quiet, verbose) as progress:
            listener = Listener(progress.begin, progress.advance, progress.notice, progress.status)
            outcome = interface.solve_to_files(deck, options, listener, standard_output(), standing)
        yield outcome


def _refuse_shared_files(
    earlier: dict[str, EarlierResults], decks: Sequence[str], options: RunOptions
) -> None:
    """Two decks that would write the same file are refused before anything is solved."""

    if len(decks) > 1 and (options.h5 or options.out not in (None, "-")):
        raise WrongCall("--out and --h5 name one file: give one deck, or use --output-dir", id="CLI-053")
    refuse_shared([(named_model(deck)[0], earlier[deck].paths) for deck in decks], decks)


def _report_outcome(outcome: Outcome, options: RunOptions, quiet: bool, verbose: bool) -> None:
    show_faults(outcome, quiet)
    if outcome.exit_code > 128:
        notify(f"{outcome.deck}: interrupted; {_kept(outcome)}")
    elif outcome.exit_code == DONE and not quiet:
        elsewhere = "standard output" if options.out == "-" else "no file"
        notify(f"{outcome.deck}: {_rows(outcome)} → {', '.join(outcome.files) or elsewhere}")
    elif (outcome.exit_code in (ANALYSIS_FAILED, INTERNAL_FAULT) or outcome.files) and not quiet:
        notify(f"{outcome.deck}: {_kept(outcome)}")
    if outcome.errors and not quiet:
        from ..run.error_estimate import estimate_text

        click.echo(estimate_text(outcome.errors), err=True)
    if verbose and not quiet and outcome.statistics:
        click.echo(f"  {outcome.statistics}", err=True)


def _rows(outcome: Outcome) -> str:
    return f"{outcome.rows} row{'' if outcome.rows == 1 else 's'}"


def _kept(outcome: Outcome) -> str:
    hint = "; --resume continues it" if outcome.resumable else ""
    if not outcome.files:
        return f"nothing was written{hint}"
    return f"{_rows(outcome)} kept, marked as failed, in {', '.join(outcome.files)}{hint}"
