"""`flexmb export`: a result for other programs."""

from collections.abc import Callable
from functools import partial
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING

import click

from ..errors import Fault
from ..results.files.file_names import refuse_foreign
from ..results.files.replaced_file import replaced, write_whole
from .options.output_file import (
    AS_JSON,
    FORCE,
    QUIET,
    RESULT,
    STANDARD_OUTPUT,
    WrittenPlace,
    in_units,
    refuse_inputs,
    refuse_standard_output,
    reported,
)
from .terminal.notices import Notices
from .terminal.screen import WrongCall

if TYPE_CHECKING:
    import h5py

    from ..deck.units import Wishes


SUFFIX = {"vtkhdf": ".vtkhdf", "csv": ".csv", "mat": ".mat"}


@click.command()
@RESULT
@click.option("--to", "form", required=True, type=click.Choice(list(SUFFIX)), help="Form of the file.")
@click.option("-o", "--output", type=WrittenPlace(), metavar="FILE",
              help="The file; - is standard output, for csv [default: NAME.FORM].")  # fmt: skip
@in_units("; csv")
@FORCE
@AS_JSON
@QUIET
def export(
    result: str, form: str, output: str | None, wishes: "Wishes", force: bool, as_json: bool, quiet: bool
) -> None:
    """Write RESULT.h5 for ParaView (vtkhdf), spreadsheets (csv) or MATLAB and Octave (mat).

    vtkhdf holds the moving bodies as a time series for ParaView 5.12 and newer, csv all quantities with
    their units, mat everything as one struct.

    \b
    Example:
        flexmb export OUT4-BAR.h5 --to vtkhdf -o four-bar.vtkhdf
        flexmb export OUT4-BAR.h5 --to csv --units mm,deg
    """
    from ..results.hdf5.stored_result import is_study

    force, output = force or bool(output), output or f"{Path(result).stem}{SUFFIX[form]}"
    refuse_inputs(output, [result])
    if wishes and form != "csv":
        message = f"--units is for csv; names and units of a file of the form {form} are those of the result"
        raise WrongCall(message, id="CLI-151")
    check = partial(refuse_foreign, [output], force)
    if form != "csv":
        check()
        refuse_standard_output(output, f"a file of the form {form}")
    notices = Notices("result", result, quiet, as_json)
    notices.refuse_standard_output(output)
    with notices.failures():
        notes = (_export_study if is_study(result) else _export_run)(result, form, output, wishes, check)
    notices.add(notes)
    notices.say(f"{result} → {reported(output)}")
    notices.end(file=output)


def _export_run(
    path: str, form: str, output: str, wishes: "Wishes", check: Callable[..., None]
) -> list[Fault]:
    """Write the result of a run; return what its reader should know."""
    from ..results.figures.vtkhdf import vtkhdf_bytes
    from ..results.files.matlab import matlab_bytes
    from ..results.quantities.quantities import open_result, refuse_uneven, remarks

    with open_result(path) as file:
        refuse_uneven(file)
        notes = remarks(file)
        if form == "csv":
            _write_csv(file, output, wishes, check)
        else:
            write_whole(output, matlab_bytes(file) if form == "mat" else vtkhdf_bytes(file))
    return notes


def _export_study(
    path: str, form: str, output: str, wishes: "Wishes", check: Callable[..., None]
) -> list[Fault]:
    """Write the table of a study; return what its reader should know."""
    from ..results.files.matlab import matlab_bytes
    from ..study.text import failed_notes, open_study, study_columns, study_text

    if form == "vtkhdf":
        raise WrongCall(
            f"{path} is the table of a study, which has no motion to show: csv or mat", id="CLI-023"
        )
    with open_study(path) as file:
        if form == "mat":
            write_whole(output, matlab_bytes(file))
            return failed_notes(file)
        notes = failed_notes(file)
        text = "".join(study_text(file, [column.in_units(wishes) for column in study_columns(file)]))
    if output == STANDARD_OUTPUT:
        click.echo(text, nl=False)
    else:
        check(alike=text.partition("\n")[0])
        write_whole(output, text.encode("utf-8"))
    return notes


def _write_csv(file: "h5py.File", output: str, wishes: "Wishes", check: Callable[..., None]) -> None:
    from ..results.quantities.quantities import names
    from ..results.quantities.table import chosen_rows, table_text

    columns = [quantity.in_units(wishes) for quantity in names(file)]
    pieces = table_text(file, columns, chosen_rows(file, None, None, 1), "csv", wishes)
    if output == STANDARD_OUTPUT:
        for piece in pieces:
            click.echo(piece, nl=False)
        return
    heads = next(pieces)
    check(alike=heads)
    with replaced(output) as stream:
        for piece in chain([heads], pieces):
            stream.write(piece.encode())
