"""`flexmb plot`: curves of results as pictures."""

import contextlib
from pathlib import Path

import click

from .options.completion import files, quantities
from .options.finite import AnyFinite
from .terminal.screen import tell
from .terminal.written_place import WrittenPlace


@click.command()
@click.argument("result", metavar="RESULT.h5", shell_complete=files)
@click.argument("names", metavar="[NAME]...", nargs=-1, shell_complete=quantities)
@click.option("-o", "--output", type=WrittenPlace(), metavar="FILE",
              help="A .png, .svg or .pdf file [default: the result's name with .png].")  # fmt: skip
@click.option("--with", "others", multiple=True, metavar="OTHER.h5",
              help="Draw the same of another result, with other dashes; can be given again.")  # fmt: skip
@click.option("--x", "across", default="time", metavar="NAME", help="Draw over this instead of the time.")
@click.option("--from", "start", type=AnyFinite(), metavar="T", help="Begin with the row at T seconds.")
@click.option("--to", "stop", type=AnyFinite(), metavar="T", help="End with the row at T seconds.")
@click.option("--every", type=click.IntRange(1), default=1, metavar="N", help="Every N-th row of these.")
@click.option("--title", default=None, help="Text above the curves [default: the names of the decks].")
@click.option("-q", "--quiet", is_flag=True, help="Say nothing but errors.")
def plot(result, names, output, others, across, start, stop, every, title, quiet):
    """Draw quantities of RESULT.h5 over time, a panel for each unit.

    NAMEs are those of flexmb table; without any, what tells most of a result is drawn: points or bodies and
    driver efforts of a YOUNG deck, coordinates of a DAFMS deck, and how energies change.
    Needs matplotlib (the extra `plot`).

    \b
    Example:
        flexmb plot OUT4-BAR.h5 "body.3.velocity" point.1.z -o four-bar.svg
        flexmb plot OUT4-BAR.h5 point.1.z --x point.1.y -o path.png
    """
    from ..extras import needed
    from ..results.figures.curves import panels
    from ..results.figures.plots import FORMATS, picture
    from ..results.files.replaced_file import write_whole
    from ..results.hdf5.stored_result import attribute
    from .options.output_file import refuse_inputs, refuse_standard_output

    output = output or f"{Path(result).stem}.png"
    refuse_standard_output(output, "a picture")
    form = Path(output).suffix[1:].lower()
    if form not in FORMATS:
        raise click.UsageError(f"{output}: pictures are written as .png, .svg or .pdf files")
    needed("matplotlib", "matplotlib", "plot", "flexmb plot")
    paths = (result, *others)
    refuse_inputs(output, paths)
    with contextlib.ExitStack() as open_files:
        sources = [
            _source(open_files, path, label, names, across, (start, stop, every), quiet)
            for path, label in zip(paths, _labels(paths), strict=True)
        ]
        drawn = panels(sources)
        if title is None:
            title = ", ".join(dict.fromkeys(attribute(one.result, "deck_name") for one in sources))
    write_whole(output, picture(drawn, form, title))
    if not quiet:
        curves = sum(len(panel.curves) for panel in drawn)
        tell(f"{result} → {output}, {curves} curve{'s' * (curves != 1)}")


def _source(open_files, path, label, names, across, window, quiet):
    from ..results.figures.curves import Source, default_quantities, still_energies
    from ..results.quantities.quantities import ResultError, open_result, resolve, shortfall
    from ..results.quantities.table import chosen_rows

    file = open_files.enter_context(open_result(path))
    abscissa = resolve(file, [across], path, "--x ")
    if len(abscissa) != 1:
        few = ", ".join(quantity.name for quantity in abscissa[:4])
        raise click.UsageError(f"--x {across} means {len(abscissa)} quantities ({few} …); name one of them")
    quantities = resolve(file, names, path) if names else default_quantities(file)
    quantities = [quantity for quantity in quantities if quantity.name != abscissa[0].name]
    rows, told = chosen_rows(file, *window), shortfall(file)
    if not rows:
        reason = "no rows in this window of time" if len(file["time"]) else told or "it has no rows"
        raise ResultError(path, f"nothing to draw: {reason}", id="CLI-006")
    if not quantities:
        raise ResultError(
            path, f"nothing to draw over {abscissa[0].name}: name another quantity", id="CLI-007"
        )
    if told and not quiet:
        tell(f"{path}: note: {told}")
    still = () if names or quiet else still_energies(file)
    if still:
        tell(f"{path}: note: not drawn, for they do not change: {', '.join(still)}")
    window = slice(rows.start, rows.stop, rows.step)
    return Source(label, file, window, abscissa[0], quantities, energies_change=not names)


def _labels(paths):
    """Return labels of results: none for a single one, else file names without suffix, or whole paths."""
    if len(paths) == 1:
        return [""]
    stems = [Path(path).stem for path in paths]
    return stems if len(set(stems)) == len(stems) else list(paths)
