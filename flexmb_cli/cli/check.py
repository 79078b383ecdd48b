"""`flexmb check`: diagnose decks without solving them."""

import json
import sys
from math import isfinite
from typing import TYPE_CHECKING, Any

import click

from ..run.outcome import RunOptions
from .options.deck_options import DECK, deck_options, every_deck, show_faults
from .terminal.screen import show, wants_debug

if TYPE_CHECKING:
    from ..run.check.check import CheckReport


@click.command()
@DECK
@deck_options
@click.option("--jacobian", metavar="TIME|estimate", help="Print the Jacobian, rows and columns labelled.")
def check(
    decks: tuple[str, ...], echo: bool, as_json: bool, quiet: bool, jacobian: str | None, **options: Any
) -> None:
    """Read and assemble every DECK and report its faults and counts, without solving; writes nothing.

    \b
    Example:
        flexmb check decks/young/IN4-BAR.dat --echo
    """
    from .. import interface

    _check_jacobian_option(jacobian)
    codes = []
    choices = RunOptions(debug=wants_debug(), **options)
    for report in every_deck(decks, choices, quiet, lambda deck: interface.check(deck, choices, jacobian)):
        show_faults(report.outcome, quiet)
        if as_json:
            if echo and report.deck and not quiet:
                _print_echo(report, err=True)
            click.echo(json.dumps(report.as_dict()))
        elif report.deck and not quiet:
            _print_check(report, echo)
        codes.append(report.outcome.exit_code)
        del report  # before the next deck is read, see `every_deck`
    sys.exit(max(codes))


def _check_jacobian_option(jacobian: str | None) -> None:

    if jacobian in (None, "estimate"):
        return
    try:
        # Python also reads 1_000, and digits of other scripts.
        good = isfinite(float(jacobian)) and jacobian.isascii() and "_" not in jacobian
    except ValueError:
        good = False
    if not good:
        raise click.BadParameter(
            f"{jacobian!r} is neither a time in s nor 'estimate'", param_hint="--jacobian"
        )


def _print_check(report: "CheckReport", with_echo: bool) -> None:
    from ..results.texts.check_text import check_text, jacobian_text

    if with_echo:
        _print_echo(report)
    if report.counts:
        show(check_text(report), prose=True)
    if report.jacobian:
        show(jacobian_text(report.jacobian))


def _print_echo(report: Any, err: Any = False) -> None:
    from ..results.texts.echo import echo

    show(echo(report.deck), err)
