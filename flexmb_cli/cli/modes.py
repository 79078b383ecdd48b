"""`flexmb modes`: frequencies of mechanisms, and of the flexible bodies in them."""

import json
import sys

import click

from .deck_options import DECK, deck_options, every_deck, show_faults
from .finite import AnyFinite
from .terminal import show, tell, wants_debug


@click.command()
@DECK
@deck_options
@click.option(
    "--at",
    "time",
    type=AnyFinite(),
    metavar="TIME",
    help="Linearise the mechanism about its motion at TIME, s (default: its start).",
)
@click.option(
    "--equilibrium",
    is_flag=True,
    help="Linearise it about the static equilibrium it can fall into, and tell where that is.",
)
def modes(decks, changes, echo, as_json, quiet, time, equilibrium, **options):
    """List eigenfrequencies and damping of the mechanism of every DECK, and of its flexible bodies.

    A VSDF deck's flexible bodies are reduced, with effective masses and what is left out; its mechanism
    is looked at when --at or --equilibrium is given, or where all bodies are rigid.

    \b
    Example:
        flexmb modes decks/vsdf/pendulum.vsdf --equilibrium
    """  # fmt: skip
    from ..run.mechanism_modes import Wish
    from ..run.modes import modes_of_deck
    from ..run.outcome import Listener, RunOptions

    listener = Listener(notice=lambda sentence: quiet or tell(f"flexmb: {sentence}"))
    codes = []
    choices = RunOptions(changes=changes, debug=wants_debug(), **options)
    wish = Wish(time, equilibrium)
    for report in every_deck(decks, lambda deck: modes_of_deck(deck, wish, choices, listener)):
        show_faults(report.outcome, quiet)
        if as_json:
            click.echo(json.dumps(report.as_dict()))
        elif report.deck:
            _print_modes(report, echo, quiet)
        codes.append(report.outcome.exit_code)
    sys.exit(max(codes))


def _print_modes(report, with_echo, quiet):
    from ..write.echo import echo
    from ..write.modes_text import modes_text

    if with_echo:
        show(echo(report.deck))
    if not quiet:
        show(modes_text(report))
