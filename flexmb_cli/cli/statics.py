"""`flexmb statics`: equilibria of mechanisms under their loads."""

import json
import sys
from collections.abc import Iterator
from typing import Any

import click
import numpy as np

from ..errors import visible
from ..run.outcome import Listener, RunOptions
from .options.deck_options import DECK, deck_options, every_deck, show_faults
from .options.output_file import FORCE, VERBOSE, Finite, WrittenPlace, refuse_inputs
from .terminal.progress import Progress
from .terminal.screen import WrongCall, notify, show, wants_debug

MOST_STEPS = 10_000
PRINTED_AS_ZERO = 1e-10  # of the largest number: less is printed as 0
SHOWN_COORDINATES = 8  # up to which a matrix of stiffness is printed


@click.command()
@DECK
@deck_options
@click.option("--steps", type=click.IntRange(1, MOST_STEPS), metavar="N", default=None,
              help="Follow the equilibrium while N steps add gravity, forces and torques (default: all at "
              "once).")  # fmt: skip
@click.option("--rows", is_flag=True, help="Find the equilibrium at the time of every row of the deck.")
@click.option("--at", "time", type=Finite(), metavar="TIME",
              help="Take loads and drivers as they are at TIME, s (default: the start).")  # fmt: skip
@click.option("--h5", type=WrittenPlace(), metavar="FILE",
              help="Write the equilibria as a result, for table, plot, diff and report.")  # fmt: skip
@FORCE
@VERBOSE
def statics(
    decks: tuple[str, ...], echo: bool, as_json: bool, quiet: bool, verbose: bool, **options: Any
) -> None:
    """Find the static equilibrium of every DECK under its loads, its stability, reactions and stiffness.

    \b
    Example:
        flexmb statics decks/young/dynamics/IN-RAIL.dat --steps 10
    """  # fmt: skip
    from ..run.statics import Stepping, statics_of_deck

    stepping = Stepping(options.pop("steps") or 0, options.pop("rows"), options.pop("time"))
    _refuse_call(stepping, options["h5"], decks)
    progress = Progress("statics", "decks", quiet, verbose)
    listener = Listener(notice=progress.notice, status=progress.status)
    choices, codes = RunOptions(debug=wants_debug(), **options), []
    for report in every_deck(
        decks, choices, quiet, lambda deck: statics_of_deck(deck, stepping, choices, listener)
    ):
        progress.clear()
        show_faults(report.outcome, quiet)
        if echo and report.deck:
            from ..results.texts.echo import echo as listed

            show(listed(report.deck), err=as_json)
        if as_json:
            click.echo(json.dumps(report.as_dict()))
        elif report.equilibria and not quiet:
            show("".join(f"{line.rstrip()}\n" for line in _lines(report)), prose=True)
            if report.outcome.files:
                notify(f"{report.outcome.deck} → {report.outcome.files[0]}, equilibria")
        codes.append(report.outcome.exit_code)
    sys.exit(max(codes))


def _refuse_call(stepping: Any, h5: str | None, decks: tuple[str, ...]) -> None:
    if stepping.rows and (stepping.steps or stepping.time is not None):
        raise WrongCall("--rows takes the times and loads of all rows; leave out --steps and --at",
                        id="CLI-130")  # fmt: skip
    if h5 is None:
        return
    if len(decks) > 1:
        raise WrongCall("--h5 takes the equilibria of one deck; call statics for each deck", id="CLI-131")
    refuse_inputs(h5, decks, "--h5")


def _lines(report: Any) -> Iterator[str]:
    last, step = report.equilibria[-1], len(report.equilibria) > 1
    stiffness = last.stiffness
    yield (
        f"{visible(report.outcome.deck)}: {report.deck.dialect.upper()} deck, "
        f"equilibrium at t = {last.time:.6g} s: DOF {len(stiffness.names)}, {stiffness.stability}"
    )
    if step:
        yield f"  {'load factor':>12} {'t, s':>12} {'lowest eigenvalue, 1/s^2':>25}"
        for each in report.equilibria:
            yield f"  {each.share:12.6g} {each.time:12.6g} {each.stiffness.lowest:25.6g}"
    else:
        yield "  eigenvalues of M^-1 K, 1/s^2: " + _numbers(stiffness.eigenvalues, stiffness.eigenvalues)
    for path, names, values in report.named():
        yield f"  {path.replace('/', '.')}"
        for name, value in zip(names, values[-1], strict=True):
            yield f"    {visible(name)}: {_numbers(np.atleast_1d(value), values[-1])}"
    if 0 < len(stiffness.names) <= SHOWN_COORDINATES:
        yield "  stiffness, N or N m by m or rad"
        for name, row in zip(stiffness.names, stiffness.matrix, strict=True):
            yield f"    {visible(name)}: {_numbers(row, stiffness.matrix)}"


def _numbers(values: np.ndarray, like: np.ndarray) -> str:
    """Numbers as text; those that are round-off beside the largest of `like` are 0."""
    least = PRINTED_AS_ZERO * np.max(np.abs(like), initial=0.0)
    return " ".join(f"{value if abs(value) > least else 0.0:.6g}" for value in values)
