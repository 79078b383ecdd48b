"""`flexmb modes`: frequencies of the flexible bodies of decks."""

import json
import sys

import click

from .deck_options import DECK, deck_options, show_faults


@click.command()
@DECK
@deck_options
def modes(decks, changes, echo, as_json, quiet, **options):
    """Reduce the flexible bodies of every DECK and list frequencies, effective masses and what is left out.

    \b
    Example:
        flexmb modes decks/vsdf/pendulum.vsdf
    """
    from ..run.body_modes import body_modes
    from ..run.outcome import RunOptions

    codes = []
    for path in decks:
        report = body_modes(path, RunOptions(changes=changes, **options))
        show_faults(report.outcome, quiet)
        if as_json:
            click.echo(json.dumps(report.as_dict()))
        elif report.deck:
            _print_modes(report, echo, quiet)
        codes.append(report.outcome.exit_code)
    sys.exit(max(codes))


def _print_modes(report, with_echo, quiet):
    from ..write.body_text import body_text
    from ..write.echo import echo

    if with_echo:
        click.echo(echo(report.deck), nl=False)
    if not quiet:
        click.echo(body_text(report), nl=False)
