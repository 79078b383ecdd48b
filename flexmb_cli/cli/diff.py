"""`flexmb diff`: compare results."""

import json
import sys

import click

from ..errors import DONE, compiler_style
from .finite import Finite


@click.command()
@click.argument("a")
@click.argument("b")
@click.option("--last-digit", type=click.IntRange(0), default=0, metavar="N",
              help="Allow N units of the last printed digit.")  # fmt: skip
@click.option("--atol", type=Finite(0), help="Allow this distance.")
@click.option("--rtol", type=Finite(0), help="Allow this part of the larger value.")
@click.option("--tol", "kinds", multiple=True, metavar="KIND=ATOL[,RTOL]",
              help="Tolerance of one kind of column (acceleration=1e-3); inf leaves it out.")  # fmt: skip
@click.option("--same-attitude", is_flag=True, help="Euler parameters p and -p count as equal.")
@click.option("--json", "as_json", is_flag=True, help="One JSON object on standard output.")
@click.option("-q", "--quiet", is_flag=True, help="Print nothing; the exit code tells.")
def diff(a, b, last_digit, atol, rtol, kinds, same_attitude, as_json, quiet):
    """Compare two OUT tables, or two HDF5 results, number by number.

    A value differs when it exceeds all tolerances given; by default every printed digit counts.

    \b
    Example:
        flexmb diff OUT4-BAR.dat reference/OUT4-BAR.dat --last-digit 1
    """
    from ..write.diff import compare
    from ..write.out_table import TableError
    from ..write.tolerances import Tolerances, parse_kinds

    tolerances = Tolerances(atol, rtol, last_digit, parse_kinds(kinds))
    try:
        report = compare(a, b, tolerances, same_attitude)
    except TableError as failure:
        click.echo(compiler_style(failure.name, failure.faults, failure.lines), err=True)
        sys.exit(failure.exit_code)
    if as_json:
        click.echo(json.dumps(report.as_dict()))
    elif not quiet:
        click.echo(report.text(), nl=False)
    sys.exit(DONE if report.equal else 1)
