"""`flexmb table`: quantities of a result as text."""

import json
import sys
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import click

from ..errors import Fault
from .options.output_file import RESULT, Finite, in_units, quantities
from .terminal.notices import Notices
from .terminal.screen import WrongCall, show, terminal_width

if TYPE_CHECKING:
    pass


@click.command()
@RESULT
@click.argument("names", metavar="NAME...", nargs=-1, shell_complete=quantities)
@click.option("--list", "listing", is_flag=True,
              help="Show the names (of NAME, or all) with unit and meaning instead of numbers.")  # fmt: skip
@click.option("--from", "start", type=Finite(), metavar="T", help="Begin with the row at T seconds.")
@click.option("--to", "stop", type=Finite(), metavar="T", help="End with the row at T seconds.")
@click.option("--every", type=click.IntRange(1), default=1, metavar="N", help="Take every N-th row.")
@click.option("-f", "--format", "style", type=click.Choice(["csv", "tsv", "jsonl", "text"]),
              help="csv (default), tsv, jsonl: JSON Lines, text: aligned (default of --list).")  # fmt: skip
@in_units()
@click.option("--as-table", "number", type=click.IntRange(1), metavar="N",
              help="Print splines as a block ELEMENTS of a deck: functions N, N + 1 and on.")  # fmt: skip
@click.option("--json", "as_json", is_flag=True,
              help="One JSON object on standard output; its rows are those of --format jsonl.")  # fmt: skip
@click.option("-q", "--quiet", is_flag=True, help="Print no notes on the result.")
def table(
    result: str, names: tuple[str, ...], style: str | None, as_json: bool, quiet: bool, **options: Any
) -> None:
    """Print quantities of RESULT.h5 over time, on a terminal and in a pipe alike.

    A NAME has the form entity.index.quantity.component; leave out the last part to get all components:
    body.3.z, body.2.omega.x, body.1.velocity, point.1.acceleration, coordinate.2, coordinate.theta2,
    reaction.4.force, driver.1.effort, energy.total, elastic.2.node3.y.  Patterns such as "body.*.z" need
    quotes in a shell; the deck's own names can replace the index: "reaction.revolute 2.force".  "*" alone
    means everything.

    The table of a study (flexmb sweep) has a row for each case, with the parameters and results as columns;
    NAMEs are the names of these columns.

    \b
    Example:
        flexmb table OUT4-BAR.h5 body.3.z point.1.velocity --every 5 --from 0.5
        flexmb table OUT4-BAR.h5 body.3.omega point.1.z --units mm,deg
        flexmb table study.h5 top --format text
        flexmb table OUT.h5 driver.1.effort --as-table 1
    """
    from ..results.hdf5.stored_result import is_study

    study, timed = is_study(result), options["start"] is not None or options["stop"] is not None
    number, listing = options["number"], options["listing"]
    if number and (listing or style or study):
        message = "--as-table prints cards of a run: it goes with neither --list, --format nor a study"
        raise WrongCall(message, id="CLI-055")
    if number and options["wishes"]:
        message = "--as-table prints cards in the units of the deck; leave out --units"
        raise WrongCall(message, id="CLI-150")
    if as_json and (style or number):
        message = "--json has rows of its own: it goes with neither --format nor --as-table"
        raise WrongCall(message, id="CLI-056")
    if study and timed:
        message = f"{result} is the table of a study, a row a case: it has no times for --from and --to"
        raise WrongCall(message, id="CLI-057")
    if not study and listing and (timed or options["every"] > 1):
        message = "--list shows names, not rows: --from, --to and --every do not go with it"
        raise WrongCall(message, id="CLI-058")
    notices = Notices("result", result, quiet, as_json)
    printed = _Printed("jsonl" if as_json else style, as_json)
    with notices.failures():
        (_print_study if study else _print_result)(names, options, printed, notices)
    notices.end(rows=printed.rows)


class _Printed:
    """The text of a table: on standard output, or kept as `rows` of an object."""

    def __init__(self, style: str | None, as_json: bool):
        self.style, self._as_json, self._kept = style, as_json, list[str]()

    @property
    def is_fitted(self) -> bool:
        """Return whether the columns are to fit a terminal."""
        return self.style == "text" and sys.stdout.isatty()

    @property
    def rows(self) -> list[dict[str, Any]]:
        """The rows that were kept."""
        return [json.loads(line) for line in "".join(self._kept).splitlines()]

    def list(self, text: str) -> None:
        """Take a list of names."""
        if self._as_json:
            self._kept.append(text)
        else:
            show(text)

    def table(self, pieces: Iterable[str]) -> None:
        """Take the pieces of a table."""
        if self._as_json:
            self._kept += pieces
            return
        for piece in pieces:
            show(piece, whole=True) if self.style == "text" else click.echo(piece, nl=False)


def _print_result(
    names: tuple[str, ...], options: dict[str, Any], printed: _Printed, notices: Notices
) -> None:
    """Print quantities of a run."""
    from ..results.hdf5.stored_result import settings_of
    from ..results.quantities.quantities import names as all_names
    from ..results.quantities.quantities import open_result, remarks, resolve
    from ..results.quantities.table import chosen_rows, fitting_groups, function_points, list_text, table_text

    result, listing = notices.file, options["listing"]
    with open_result(result) as file:
        if not names and not listing:
            raise WrongCall(
                f"name at least one quantity; flexmb table {result} --list shows them all", id="CLI-059"
            )
        in_si, wishes = resolve(file, names, result) if names else all_names(file), options["wishes"]
        quantities = [quantity.in_units(wishes) for quantity in in_si]
        if listing:
            if changes := ", ".join(settings_of(file)):
                message = f"the run changed the deck by --set: {changes}"
                notices.add([Fault("note", message, id="RESULT-079")])
            printed.list(list_text(quantities, printed.style or "text"))
            return
        rows = chosen_rows(file, options["start"], options["stop"], options["every"])
        notices.add(remarks(file))
        if not rows and len(file["time"]):
            message = "it has no rows in this window of time"
            notices.add([Fault("note", message, id="RESULT-080")])
        if number := options["number"]:
            from ..dialects.elements_block.writer import spline_block

            show(spline_block(function_points(file, quantities, rows, number)))
            return
        # Blocks of columns that fit a terminal; all in one for a pipe.
        room = terminal_width(sys.stdout) if printed.is_fitted else None
        groups = [quantities] if room is None else fitting_groups(file, quantities, room)
        for k, group in enumerate(groups):
            show("\n" * bool(k))
            printed.table(table_text(file, group, rows, printed.style or "csv", wishes))


def _print_study(
    names: tuple[str, ...], options: dict[str, Any], printed: _Printed, notices: Notices
) -> None:
    from ..results.quantities.table import list_text
    from ..study.text import chosen_columns, fitting_heads, open_study, study_columns, study_notes, study_text

    path, listing = notices.file, options["listing"]
    with open_study(path) as file:
        columns = study_columns(file)
        if names or not listing:
            columns = chosen_columns(columns, names, path)
        columns = [column.in_units(options["wishes"]) for column in columns]
        if listing:
            printed.list(list_text(columns, printed.style or "text"))
            return
        notices.add(study_notes(file, columns, bool(names)))
        # Places of the heads in blocks that fit a terminal; None, which means all, for a pipe.
        room = terminal_width(sys.stdout) if printed.is_fitted else None
        for k, heads in enumerate([None] if room is None else fitting_heads(columns, room)):
            show("\n" * bool(k))
            printed.table(study_text(file, columns, options["every"], printed.style or "csv", heads))
