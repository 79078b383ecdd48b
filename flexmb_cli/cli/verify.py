"""`flexmb verify`: one deck by two formulations."""

import json
import sys
from typing import TYPE_CHECKING, Any

import click

from ..errors import visible
from ..run.outcome import Listener, RunOptions
from .options.deck_options import DECK, deck_options, every_deck, show_faults
from .options.output_file import ABSOLUTE_TOLERANCE, RELATIVE_TOLERANCE, VERBOSE
from .terminal.progress import Progress
from .terminal.screen import show, wants_debug

if TYPE_CHECKING:
    pass


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
@VERBOSE
def verify(
    decks: tuple[str, ...], as_json: bool, quiet: bool, verbose: bool, tolerance: float, **options: Any
) -> None:
    """Run every DECK by two formulations and compare the motions; writes nothing.

    DAFMS: Kane's equations and absolute coordinates.  YOUNG: Euler parameters and natural coordinates.
    VSDF, all modes: two floating frames.

    \b
    Example:
        flexmb verify decks/dafms/two_link_n2.DAT
    """
    from ..run.verify.verify import verify_deck

    given = {name: options.pop(name) for name in ("rtol", "atol")}
    steps = {name: value for name, value in given.items() if value is not None}
    choices = RunOptions(integration=steps, debug=wants_debug(), **options)
    progress = Progress("verify", "decks", quiet, verbose)
    listener = Listener(notice=progress.notice, status=progress.status)
    codes = []
    for verified in every_deck(
        decks, choices, quiet, lambda deck: verify_deck(deck, choices, tolerance, listener)
    ):
        progress.clear()
        if verified.outcome.echo:
            show(verified.outcome.echo, err=True)
        show_faults(verified.outcome, quiet)
        if as_json:
            click.echo(json.dumps(verified.as_dict()))
        elif verified.differences and not quiet:
            show(verify_text(verified), prose=True)
        codes.append(verified.outcome.exit_code)
    sys.exit(max(codes))


def verify_text(verification: Any) -> str:
    """A line for each quantity of a `run.verify.verify.Verification`, then the largest difference."""
    outcome = verification.outcome
    lines = [f"{visible(outcome.deck)}: {verification.formulations}, {outcome.rows} rows"]
    lines.append(f"  {'quantity':<26}{'difference':>12}{'of':>12} {'unit':<6}{'share':>10}{'at':>12}")
    for each in verification.differences:
        lines.append(
            f"  {each.name:<26}{each.difference:>12.2e}{each.scale:>12.4g} {each.unit:<6}"
            f"{each.relative:>10.1e}{each.time:>10.4g} s"
        )
    worst = verification.largest
    limit = verification.tolerance
    relation = "within" if worst.relative <= limit else "beyond"
    lines.append(f"  largest: {worst.name}, {worst.relative:.1e} of the largest value, {relation} {limit:g}")
    return "\n".join(lines) + "\n"
