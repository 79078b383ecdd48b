"""`flexmb verify`: one deck by two formulations."""

import json
import sys
from typing import Any

import click

from .options.deck_options import DECK, deck_options, every_deck, show_faults
from .options.finite import ABSOLUTE_TOLERANCE, RELATIVE_TOLERANCE
from .terminal.progress import Progress
from .terminal.screen import show, wants_debug


@click.command()
@DECK
@deck_options
@click.option("--tol", "tolerance", type=ABSOLUTE_TOLERANCE, default=1e-6, show_default=True,
              help="Largest difference, as a share of the largest value of its type.")  # fmt: skip
@click.option(
    "--rtol",
    type=RELATIVE_TOLERANCE,
    help="Relative tolerance of a step (1e-11; VSDF 1e-9; METH 2 and 4 1e-10).",
)
@click.option(
    "--atol", type=ABSOLUTE_TOLERANCE, help="Absolute tolerance of a step (1e-13; METH 2 and 4 1e-12)."
)
@click.option(
    "-v", "--verbose", is_flag=True, help="Without a terminal, print the progress every ten seconds."
)
def verify(
    decks: tuple[str, ...],
    changes: "tuple[Any, ...]",
    echo: bool,
    as_json: bool,
    quiet: bool,
    verbose: bool,
    tolerance: float,
    rtol: None,
    atol: None,
    **options: Any,
) -> None:
    """Run every DECK by two formulations and compare the motions; writes nothing.

    DAFMS: Kane's equations and absolute coordinates.  YOUNG: Euler parameters and natural coordinates.
    VSDF, all modes: two floating frames.

    \b
    Example:
        flexmb verify decks/dafms/two_link_n2.DAT
    """
    from ..results.texts.verify_text import verify_text
    from ..run.outcome import Listener, RunOptions
    from ..run.verify.verify import verify_deck

    steps = {name: value for name, value in (("rtol", rtol), ("atol", atol)) if value is not None}
    choices = RunOptions(changes=changes, integration=steps, echo=echo, debug=wants_debug(), **options)
    progress = Progress("verify", "decks", quiet, verbose)
    listener = Listener(notice=progress.notice, status=progress.status)
    codes = []
    for found in every_deck(decks, changes, lambda deck: verify_deck(deck, choices, tolerance, listener)):
        progress.clear()
        if found.outcome.echo:
            show(found.outcome.echo, err=True)
        show_faults(found.outcome, quiet)
        if as_json:
            click.echo(json.dumps(found.as_dict()))
        elif found.differences and not quiet:
            show(verify_text(found), prose=True)
        codes.append(found.outcome.exit_code)
    sys.exit(max(codes))
