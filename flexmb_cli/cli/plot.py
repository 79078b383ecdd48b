"""`flexmb plot`: curves of results as pictures."""

import contextlib
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from ..errors import Fault
from ..extras import needed
from ..results.files.file_names import refuse_foreign
from ..results.files.replaced_file import write_whole
from .options.output_file import (
    AS_JSON,
    FORCE,
    QUIET,
    RESULT,
    Finite,
    Millimetres,
    WrittenPlace,
    in_units,
    quantities,
    refuse_inputs,
    refuse_standard_output,
)
from .terminal.notices import Notices
from .terminal.screen import WrongCall

if TYPE_CHECKING:
    from ..results.figures.curves import Source
    from ..results.figures.look import Look

# Lines of the title that mark numbers of `run --as-printed`, short enough for a column of print.
EMULATION = ("With the known errors of", "the program of 1996 (--as-printed)")


@click.command()
@RESULT
@click.argument("names", metavar="[NAME]...", nargs=-1, shell_complete=quantities)
@click.option("-o", "--output", type=WrittenPlace(), metavar="FILE",
              help="A .png, .svg or .pdf file [default: the result's name with .png].")  # fmt: skip
@click.option("--with", "others", multiple=True, metavar="OTHER.h5",
              help="Overlay the same quantities of another result, dashed; repeatable.")  # fmt: skip
@click.option("--x", "across", default="time", metavar="NAME", help="Draw over this instead of the time.")
@click.option("--from", "start", type=Finite(), metavar="T", help="Begin with the row at T seconds.")
@click.option("--to", "stop", type=Finite(), metavar="T", help="End with the row at T seconds.")
@click.option("--every", type=click.IntRange(1), default=1, metavar="N", help="Take every N-th row.")
@in_units(" or get a prefix")
@click.option("--kind", type=click.Choice(["auto", "curve", "map", "scatter", "parallel", "tolerances"]),
              default="auto",
              help="Type of the picture of a study: curve over one parameter, map over two, scatter, "
              "parallel coordinates, shares of tolerances.")  # fmt: skip
@click.option("--title", default=None, help="Text above the curves [default: the names of the decks].")
@click.option("--width", type=Millimetres(20, 1000), metavar="MM",
              help="Draw for print, MM millimetres wide (or 8.5cm, 3.5in): thin lines, small letters, "
                   "no title.")  # fmt: skip
@click.option("--font", default="", metavar="FAMILY", help="Font of a picture for print, such as serif.")
@click.option(
    "--font-size",
    type=click.FloatRange(3, 40),
    default=8.0,
    metavar="PT",
    help="Size of the font [default: 8].",
)
@click.option(
    "--style", default="", metavar="FILE", help="A style file of matplotlib, or the name of a style."
)
@click.option("--latex", is_flag=True, help="Set texts by LaTeX, which must be installed.")
@FORCE
@AS_JSON
@QUIET
def plot(
    result: str,
    names: tuple[str, ...],
    output: str | None,
    force: bool,
    as_json: bool,
    quiet: bool,
    **options: Any,
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
        flexmb plot OUT4-BAR.h5 "body.*.omega" point.1.z --units rpm,mm
        flexmb plot OUT4-BAR.h5 point.1.z --width 85 --font serif -o column.pdf
    """
    from ..results.figures.plots import FORMATS
    from ..results.hdf5.stored_result import is_study

    force, output = force or bool(output), output or f"{Path(result).stem}.png"
    refuse_standard_output(output, "a picture")
    form, study = Path(output).suffix[1:].lower(), is_study(result)
    if form not in FORMATS:
        raise WrongCall(f"{output}: pictures are written as .png, .svg or .pdf files", id="CLI-028")
    refuse_foreign([output], force)
    needed("matplotlib", "matplotlib", "plot", "flexmb plot")
    if study and {key: options[key] for key in _OF_TIMES} != _OF_TIMES:
        raise WrongCall(
            "the table of a study has no times: --with, --x, --from, --to, --every and --units", id="CLI-029"
        )
    if not study and options["kind"] != "auto":
        message = f"--kind {options['kind']} is for tables of studies, but {result} is not one"
        raise WrongCall(message, id="CLI-030")
    refuse_inputs(output, [result, *options["others"]])
    notices = Notices("result", result, quiet, as_json)
    with notices.failures():
        content, what = (_study_plot if study else _plot)(names, form, options, notices)
        write_whole(output, content)
        notices.say(f"{result} → {output}, {what}")
    notices.end(file=output)


# What the options of times are where they are not given.
_OF_TIMES: dict[str, Any] = {
    "others": (),
    "across": "time",
    "start": None,
    "stop": None,
    "every": 1,
    "wishes": {},
}


def _plot(names: tuple[str, ...], form: str, options: dict[str, Any], notices: Notices) -> tuple[bytes, str]:
    """Return the picture of quantities of results over time, or across another, and what it shows."""
    from ..results.figures.curves import panels
    from ..results.figures.plots import picture
    from ..results.hdf5.stored_result import attribute

    paths, title = (notices.file, *options["others"]), options["title"]
    with contextlib.ExitStack() as open_files:
        sources = [
            _source(open_files, path, label, names, options, notices)
            for path, label in zip(paths, _labels(paths), strict=True)
        ]
        drawn = panels(sources, options["wishes"])
        if title is None:
            decks = dict.fromkeys(attribute(one.result, "deck_name") for one in sources)
            title = "" if options["width"] else ", ".join(decks)
        if any(attribute(one.result, "emulation") for one in sources):
            title = "\n".join(filter(None, [title, *EMULATION]))
    curves = sum(len(panel.curves) for panel in drawn)
    content = _drawn(picture, (drawn, form, title), options, notices)
    return content, f"{curves} curve{'s' * (curves != 1)}"


def _study_plot(
    names: tuple[str, ...], form: str, options: dict[str, Any], notices: Notices
) -> tuple[bytes, str]:
    """Return the picture of results of a study over its parameters, and what it shows."""
    from ..study.figures import (
        UnsuitedStudy,
        curve_family,
        family_picture,
        kind_for,
        names_series,
        study_picture,
    )
    from ..study.scatter import shares_picture
    from ..study.text import cases_table, open_study

    path, kind, title = notices.file, options["kind"], options["title"]
    with open_study(path) as file:
        of_series = kind == "auto" and names_series(file, names, path)
        family = curve_family(file, names, path) if of_series else None
        cases = family.cases if family else cases_table(file, names, path)
    if title is None:
        title = "" if options["width"] else cases.deck_name
    left_out = f"; {cases.failed} failed cases are left out" if cases.failed else ""
    if family:
        content = _drawn(family_picture, (family, form, title), options, notices)
        return content, f"{len(family.times)} cases of {', '.join(family.series)}{left_out}"
    kind = kind_for(cases) if kind == "auto" else kind
    try:
        if kind == "tolerances":
            with open_study(path) as file:
                return _drawn(shares_picture, (file, form, title), options, notices), "shares of tolerances"
        content = _drawn(study_picture, (cases, kind, form, title), options, notices)
    except UnsuitedStudy as fault:
        raise WrongCall(f"{path}: {fault}", id="CLI-031") from fault
    return content, f"{kind} of {', '.join(cases.results)}{left_out}"


def _drawn(
    draw: Callable[..., bytes], arguments: tuple[Any, ...], options: dict[str, Any], notices: Notices
) -> bytes:
    """The bytes of the picture that `draw` makes of its arguments and a look; print options need a width."""
    from ..results.figures.look import Look

    width = options["width"]
    given = [f"--{name.replace('_', '-')}" for name in ("font", "style", "latex") if options[name]]
    if given and not width:
        raise WrongCall(f"{', '.join(given)}: for pictures of print; give --width, too", id="CLI-032")
    if "://" in options["style"]:
        raise WrongCall(
            f"--style {options['style']}: give a file; nothing is fetched from a network", id="CLI-033"
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
    message = f"{option} {family}: no such font is installed; matplotlib's own is used"
    return Fault("warning", message, id="CLI-011")


def _source(
    open_files: Any, path: str, label: str, names: tuple[str, ...], options: dict[str, Any], notices: Notices
) -> "Source":
    from ..results.figures.curves import DefaultCurves, Source, default_curves, still_energies
    from ..results.quantities.quantities import ResultError, open_result, remarks, resolve, shortfall
    from ..results.quantities.table import chosen_rows

    file = open_files.enter_context(open_result(path))
    across = options["across"]
    abscissa = resolve(file, [across], path, "--x ")
    if len(abscissa) != 1:
        few = ", ".join(quantity.name for quantity in abscissa[:4])
        raise WrongCall(
            f"--x {across} means {len(abscissa)} quantities ({few} …); name one of them", id="CLI-037"
        )
    chosen = DefaultCurves(resolve(file, names, path), []) if names else default_curves(file)
    quantities = [quantity for quantity in chosen.quantities if quantity.name != abscissa[0].name]
    rows = chosen_rows(file, options["start"], options["stop"], options["every"])
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
    cuts = [Fault("note", f"{cut}; give NAMEs to draw others", id="CLI-012") for cut in chosen.cut]
    notices.add(cuts, path)
    still = () if names else still_energies(file)
    if still:
        message = f"not drawn, since they do not change: {', '.join(still)}"
        notices.add([Fault("note", message, id="CLI-013")], path)
    window = slice(rows.start, rows.stop, rows.step)
    return Source(label, file, window, abscissa[0], quantities, energies_change=not names)


def _labels(paths: tuple[str, ...]) -> list[str]:
    """Return labels of results: none for a single one, else file names without suffix, or whole paths."""
    if len(paths) == 1:
        return [""]
    stems = [Path(path).stem for path in paths]
    return stems if len(set(stems)) == len(stems) else list(paths)
