"""`flexmb diff`: compare results."""

import json
import sys

import click

from ..errors import DONE, compiler_style, visible
from .options.finite import Finite
from .terminal.json_faults import faults_in_json
from .terminal.screen import show


@click.command()
@click.argument("a")
@click.argument("b")
@click.option("--last-digit", type=click.IntRange(0), default=0, metavar="N",
              help="Allow N units of the last printed digit.")  # fmt: skip
@click.option("--atol", type=Finite(0), help="Allow this distance.")
@click.option("--rtol", type=Finite(0), help="Allow this part of the larger value.")
@click.option("--tol", "kinds", multiple=True, metavar="KIND=ATOL[,RTOL]",
              help="Tolerance of a kind of column (omega=1e-3); inf leaves it out.")  # fmt: skip
@click.option("--same-attitude", is_flag=True, help="Euler parameters p and -p count as equal.")
@click.option("--explain", is_flag=True,
              help="Mark differences that are known errors of the historic programs.")  # fmt: skip
@click.option("--deck", metavar="DECK",
              help="With --explain: the YOUNG deck of both, run with the errors of 1996.")  # fmt: skip
@click.option(
    "--words", is_flag=True, help="Differences in words count, too: titles, names, notes, settings."
)
@click.option("--update", is_flag=True, help="Where they differ, put a copy of B in the place of A.")
@click.option("--json", "as_json", is_flag=True, help="One JSON object on standard output.")
@click.option("-q", "--quiet", is_flag=True, help="Print nothing; the exit code tells.")
def diff(a, b, update, as_json, quiet, **options):
    """Compare two OUT tables, DAFMS echoes or series, or HDF5 results, number by number.

    A is the reference.  A value differs when it exceeds all tolerances given; by default every printed
    digit counts.  Differences in words are reported, and count with --words only.

    \b
    Example:
        flexmb diff reference/OUT4-BAR.dat OUT4-BAR.dat --last-digit 1
    """
    from ..deck.listing import TableError
    from ..results.diff.accept import accept, is_missing

    if options["deck"] and not options["explain"]:
        raise click.UsageError("--deck goes with --explain")
    if update and "-" in (a, b):
        raise click.UsageError("--update copies files; standard input is none")
    new = update and is_missing(a)
    try:
        with faults_in_json(as_json, {"a": a, "b": b, "updated": False}, b):
            # A result that can be compared with itself can be read.
            report = _compared(b if new else a, b, **options)
            updated = update and (new or not report.equal)
            if updated:
                accept(a, b)
    except TableError as failure:
        click.echo(compiler_style(failure.name, failure.faults, failure.lines), err=True)
        sys.exit(failure.exit_code)
    if as_json:
        click.echo(json.dumps(report.as_dict() | {"a": a, "updated": updated}))
    elif not quiet:
        show("" if new else report.text())
        if update:
            done = f"taken from {visible(b)}" if updated else "left as it is"
            show(f"{visible(a)}: {'new reference, ' if new else ''}{done}\n")
    sys.exit(DONE if report.equal or updated else 1)


def _compared(a, b, last_digit, atol, rtol, kinds, same_attitude, explain, words, deck):
    from ..results.diff.listings import compare
    from ..results.diff.tolerances import Tolerances, parse_kinds

    tolerances = Tolerances(atol, rtol, last_digit, parse_kinds(kinds))
    return compare(a, b, tolerances, same_attitude, explain, words, deck)
