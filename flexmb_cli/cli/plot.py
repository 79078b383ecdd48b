"""`flexmb plot`: curves of results as pictures."""

import contextlib
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from ..errors import Fault
from .options.finite import AnyFinite, Millimetres
from .options.output_file import FORCE, WrittenPlace, files, quantities
from .terminal.notices import Notices
from .terminal.screen import WrongCall

if TYPE_CHECKING:
    from ..results.figures.curves import Source
    from ..results.figures.look import Look

# Lines of the title that mark numbers of `run --as-printed`, short enough for a column of print.
EMULATION = ("With the known errors of", "the program of 1996 (--as-printed)")


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
@click.option("--kind", type=click.Choice(["auto", "curve", "map", "scatter", "parallel"]), default="auto",
              help="Type of the picture of a study: curve over one parameter, map over two, scatter, "
              "parallel coordinates.")  # fmt: skip
@click.option("--title", default=None, help="Text above the curves [default: the names of the decks].")
@click.option("--width", type=Millimetres(20, 1000), metavar="MM",
              help="Draw for print, MM millimetres wide (or 8.5cm, 3.5in): thin lines, small letters, "
                   "no title.")  # fmt: skip
@click.option("--font", default="", metavar="FAMILY", help="Font of a picture for print, such as serif.")
@click.option(
    "--font-size", type=click.FloatRange(3, 40), default=8.0, metavar="PT", help="Its size [default: 8]."
)
@click.option(
    "--style", default="", metavar="FILE", help="A style file of matplotlib, or the name of a style."
)
@click.option("--latex", is_flag=True, help="Set texts by LaTeX, which must be installed.")
@FORCE
@click.option("--json", "as_json", is_flag=True, help="One JSON object on standard output.")
@click.option("-q", "--quiet", is_flag=True, help="Say nothing but errors.")
def plot(
    result: str,
    names: tuple[str, ...],
    output: str | None,
    others: tuple[str, ...],
    across: str,
    start: None,
    stop: None,
    every: int,
    title: str | None,
    kind: str,
    width: None,
    force: bool,
    as_json: bool,
    quiet: bool,
    **print_options: Any,
) -> None:
    """Draw quantities of RESULT.h5 over time, a panel for each unit.

    NAMEs have the same form as in flexmb table.  Without names it draws a default selection: points or
    bodies and driver efforts of a YOUNG deck, coordinates of a DAFMS deck, and the change of energies.
    For the table of a study (flexmb sweep) NAMEs are results, drawn over the parameters.
    Needs matplotlib (the extra `plot`).

    \b
    Example:
        flexmb plot OUT4-BAR.h5 "body.3.velocity" point.1.z -o four-bar.svg
        flexmb plot OUT4-BAR.h5 point.1.z --x point.1.y -o path.png
        flexmb plot OUT4-BAR.h5 point.1.z --width 85 --font serif -o column.pdf
    """
    from ..extras import needed
    from ..results.figures.plots import FORMATS
    from ..results.files.own_files import refuse_foreign
    from ..results.hdf5.stored_result import is_study
    from .options.output_file import refuse_inputs, refuse_standard_output

    force, output = force or bool(output), output or f"{Path(result).stem}.png"
    refuse_standard_output(output, "a picture")
    form = Path(output).suffix[1:].lower()
    if form not in FORMATS:
        raise WrongCall(f"{output}: pictures are written as .png, .svg or .pdf files", id="CLI-028")
    refuse_foreign([output], force)
    needed("matplotlib", "matplotlib", "plot", "flexmb plot")
    notices = Notices("result", result, quiet, as_json)
    if is_study(result):
        if others or across != "time" or start is not None or stop is not None or every > 1:
            raise WrongCall(
                "the table of a study has no times: --with, --x, --from, --to and --every", id="CLI-029"
            )
        refuse_inputs(output, [result])
        with notices.failures():
            _plot_study(notices, names, output, kind, title, width, print_options)
        notices.end(file=output)
        return
    if kind != "auto":
        raise WrongCall(f"--kind {kind} is for tables of studies, and {result} is none", id="CLI-030")
    paths = (result, *others)
    refuse_inputs(output, paths)
    with notices.failures():
        _plot_results(
            paths, names, output, across, (start, stop, every), title, width, notices, print_options
        )
    notices.end(file=output)


def _plot_results(
    paths: tuple[str, ...],
    names: tuple[str, ...],
    output: str,
    across: str,
    part: Any,
    title: str | None,
    width: float | None,
    notices: Notices,
    print_options: dict[str, float | str],
) -> None:
    """Draw quantities of results over time, or across another; `part`: begin, end and stride of the rows."""
    from ..results.figures.curves import panels
    from ..results.figures.plots import picture
    from ..results.files.replaced_file import write_whole
    from ..results.hdf5.stored_result import attribute

    with contextlib.ExitStack() as open_files:
        sources = [
            _source(open_files, path, label, names, across, part, notices)
            for path, label in zip(paths, _labels(paths), strict=True)
        ]
        drawn = panels(sources)
        if title is None and width:
            title = ""
        if title is None:
            title = ", ".join(dict.fromkeys(attribute(one.result, "deck_name") for one in sources))
        if any(attribute(one.result, "emulation") for one in sources):
            title = "\n".join(filter(None, [title, *EMULATION]))
    form = Path(output).suffix[1:].lower()
    write_whole(output, _drawn(picture, (drawn, form, title), width, print_options, notices))
    curves = sum(len(panel.curves) for panel in drawn)
    notices.say(f"{paths[0]} → {output}, {curves} curve{'s' * (curves != 1)}")


def _plot_study(
    notices: Notices,
    names: tuple[str, ...],
    output: str,
    kind: str,
    title: str | None,
    width: float | None,
    print_options: dict[str, Any],
) -> None:
    from ..results.files.replaced_file import write_whole
    from ..study.figures import (
        UnsuitedStudy,
        curve_family,
        family_picture,
        kind_for,
        names_series,
        study_picture,
    )
    from ..study.text import cases_table, open_study

    form, path = Path(output).suffix[1:].lower(), notices.file
    with open_study(path) as file:
        family = (
            curve_family(file, names, path) if kind == "auto" and names_series(file, names, path) else None
        )
        cases = family.cases if family else cases_table(file, names, path)
    if title is None:
        title = "" if width else cases.deck_name
    if family:
        content = _drawn(family_picture, (family, form, title), width, print_options, notices)
        what = f"{len(family.times)} cases of {', '.join(family.series)}"
    else:
        kind = kind_for(cases) if kind == "auto" else kind
        try:
            content = _drawn(study_picture, (cases, kind, form, title), width, print_options, notices)
        except UnsuitedStudy as fault:
            raise WrongCall(f"{path}: {fault}", id="CLI-031") from fault
        what = f"{kind} of {', '.join(cases.results)}"
    write_whole(output, content)
    left_out = f"; {cases.failed} failed cases are left out" if cases.failed else ""
    notices.say(f"{path} → {output}, {what}{left_out}")


def _drawn(
    draw: Callable[..., bytes],
    arguments: tuple[Any, ...],
    width: float | None,
    options: dict[str, Any],
    notices: Notices,
) -> bytes:
    """The bytes of the picture that `draw` makes of its arguments and a look; print options need a width."""
    from ..results.figures.look import Look

    given = [f"--{name.replace('_', '-')}" for name in ("font", "style", "latex") if options[name]]
    if given and not width:
        raise WrongCall(f"{', '.join(given)}: for pictures of print; give --width, too", id="CLI-032")
    if "://" in options["style"]:
        raise WrongCall(
            f"--style {options['style']}: a file wanted; nothing is fetched from a network", id="CLI-033"
        )
    look = None
    try:
        if width:
            look = Look(width, *(options[name] for name in ("font", "font_size", "style", "latex")))
        return draw(*arguments, look, lambda family: notices.add([_unknown_font(look, family)], "flexmb"))
    except ValueError as error:
        raise WrongCall(f"--width: {error}", id="CLI-034") from None
    except OSError as error:
        raise WrongCall(f"--style {options['style']}: {error}", id="CLI-035") from None
    except (RuntimeError, FileNotFoundError) as error:
        raise WrongCall(f"--latex: LaTeX cannot be run: {str(error).splitlines()[0]}", id="CLI-036") from None


def _unknown_font(look: "Look | None", family: str) -> Fault:
    option = f"--style {look.style}: font" if look and family != look.font else "--font"
    message = f"{option} {family}: no such font is installed; matplotlib's own is taken"
    return Fault("warning", message, id="CLI-011")


def _source(
    open_files: Any,
    path: str,
    label: str,
    names: tuple[str, ...],
    across: str,
    window: Any,
    notices: Notices,
) -> "Source":
    from ..results.figures.curves import DefaultCurves, Source, default_curves, still_energies
    from ..results.quantities.quantities import ResultError, open_result, remarks, resolve, shortfall
    from ..results.quantities.table import chosen_rows

    file = open_files.enter_context(open_result(path))
    abscissa = resolve(file, [across], path, "--x ")
    if len(abscissa) != 1:
        few = ", ".join(quantity.name for quantity in abscissa[:4])
        raise WrongCall(
            f"--x {across} means {len(abscissa)} quantities ({few} …); name one of them", id="CLI-037"
        )
    chosen = DefaultCurves(resolve(file, names, path), []) if names else default_curves(file)
    quantities = [quantity for quantity in chosen.quantities if quantity.name != abscissa[0].name]
    rows = chosen_rows(file, *window)
    if not rows:
        reason = (
            "no rows in this window of time" if len(file["time"]) else shortfall(file) or "it has no rows"
        )
        raise ResultError(path, f"nothing to draw: {reason}", id="CLI-006")
    if not quantities:
        raise ResultError(
            path, f"nothing to draw over {abscissa[0].name}: name another quantity", id="CLI-007"
        )
    notices.add(remarks(file), path)
    notices.add([Fault("note", f"{cut}; NAMEs draw others", id="CLI-012") for cut in chosen.cut], path)
    still = () if names else still_energies(file)
    if still:
        message = f"not drawn, for they do not change: {', '.join(still)}"
        notices.add([Fault("note", message, id="CLI-013")], path)
    window = slice(rows.start, rows.stop, rows.step)
    return Source(label, file, window, abscissa[0], quantities, energies_change=not names)


def _labels(paths: tuple[str, ...]) -> list[str]:
    """Return labels of results: none for a single one, else file names without suffix, or whole paths."""
    if len(paths) == 1:
        return [""]
    stems = [Path(path).stem for path in paths]
    return stems if len(set(stems)) == len(stems) else list(paths)
