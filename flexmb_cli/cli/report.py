"""`flexmb report`: a page on a result."""

import math
import re
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
    STANDARD_OUTPUT,
    Finite,
    WrittenPlace,
    in_units,
    refuse_inputs,
    refuse_standard_output,
    reported,
)
from .terminal.notices import Notices
from .terminal.screen import WrongCall

if TYPE_CHECKING:
    from ..results.figures.contours import BodyLook
    from ..results.figures.film import FilmLook


# Generic in click's newer versions only, and 8.2 will do.
class Interval(click.ParamType):  # type: ignore[type-arg]
    """Two finite numbers, the first smaller than the second."""

    name = "interval"

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> tuple[float, float]:
        """Return both numbers."""
        if isinstance(value, tuple):
            return value
        parts = value.split(",")
        try:
            low, high = map(float, parts)
        except ValueError:
            self.fail(f"{value!r}: expected two numbers, such as 0,1e8", param, ctx)
        if not (math.isfinite(low) and math.isfinite(high) and low < high):
            self.fail(f"{value!r}: the first number must be smaller than the second", param, ctx)
        return low, high


OF_RUNS = ("colours", "range", "scale", "units", "title", "note", "curves")


@click.command()
@RESULT
@click.option("-o", "--output", type=WrittenPlace(), metavar="PAGE.html",
              help="The page; - is standard output [default: the result's name with .html].")  # fmt: skip
@click.option("--movie", type=WrittenPlace(), metavar="FILE",
              help="Write a film, .mp4 or .gif, in place of the page; needs the extra `movie`.")  # fmt: skip
@click.option("--fps", type=click.IntRange(1, 100), default=25, metavar="N",
              help="Frames a second of the film [default: 25].")  # fmt: skip
@click.option(
    "--size", default="960x540", metavar="WxH", help="Width and height in pixels [default: 960x540]."
)
@click.option("--view", type=click.Choice(["start", "x", "y", "z"]), default="start",
              help="Look along this axis [default: the page's first view].")  # fmt: skip
@click.option("--colours", default="von Mises stress", metavar="NAME",
              help="Quantity that colours finite-element bodies, such as 'principal stress 1' or "
              "'body'; an unknown name lists all [default: von Mises stress].")  # fmt: skip
@click.option("--range", "ends", type=Interval(), metavar="LOW,HIGH",
              help="Values of the first and the last colour, in --units or the result's "
              "[default: smallest and largest].")  # fmt: skip
@click.option("--scale", type=Finite(), default=1.0, metavar="X",
              help="Show deformations of finite-element bodies X times as large [default: 1].")  # fmt: skip
@click.option("--title", default="", help="Heading of the page [default: the analysis and the deck].")
@click.option("--note", default="", help="Text below it; \\n\\n begins a paragraph.")
@click.option("--curves", multiple=True, metavar="NAME",
              help="Draw this quantity in place of the default ones; repeatable.")  # fmt: skip
@in_units(" or get a prefix")
@FORCE
@AS_JSON
@QUIET
def report(
    result: str, output: str | None, force: bool, as_json: bool, quiet: bool, movie: str | None, **looks: Any
) -> None:
    """Write a self-contained HTML page: motion in 3-D, curves, audit and deck of RESULT.h5.

    The page needs no network and no graphics card: play, scrub and turn the motion in any browser.  It
    has the extremes of the curves and the largest reactions, too, and prints on paper or as PDF.

    Of the table of a study: parallel coordinates and each result over the parameters; of a fit its
    numbers with their intervals, its history and paths, too.  This needs plotly (the extra `report`).

    \b
    Example:
        flexmb report OUT4-BAR.h5 -o four-bar.html
        flexmb report OUT4-BAR.h5 --title "Wiper drive" --curves body.3.z
        flexmb report OUT4-BAR.h5 --movie four-bar.mp4
    """
    from ..results.hdf5.stored_result import is_study

    bodies = _body_look(looks)
    notices = Notices("result", result, quiet, as_json)
    if movie:
        _refuse_options(("title", "note", "curves"), "for pages; leave out --movie")
        _write_film(notices, movie, output, looks, bodies)
        return
    _refuse_options(("fps", "size", "view"), "for films; give --movie, too")
    force, output = force or bool(output), output or f"{Path(result).stem}.html"
    refuse_inputs(output, [result])
    refuse_foreign([output], force)
    notices.refuse_standard_output(output)
    with notices.failures():
        if study := is_study(result):
            _refuse_options(OF_RUNS, "for results of a run; this is the table of a study")
        page, notes = (_study_page(result), list[Fault]()) if study else _result_page(result, bodies, looks)
        if output == STANDARD_OUTPUT:
            click.echo(page, nl=False)
        else:
            write_whole(output, page)
    notices.add(notes)
    notices.say(f"{result} → {reported(output)}, {_size(len(page))}")
    notices.end(file=output)


def _refuse_options(names: tuple[str, ...], why: str) -> None:
    context, parameters = click.get_current_context(), {"range": "ends", "units": "wishes"}
    given = [
        f"--{name}"
        for name in names
        if context.get_parameter_source(parameters.get(name, name)) == click.core.ParameterSource.COMMANDLINE
    ]
    if given:
        raise WrongCall(f"{', '.join(given)}: {why}", id="CLI-038")


def _body_look(looks: dict[str, Any]) -> "BodyLook":
    from ..results.figures.contours import COLOURS, OWN_COLOURS, BodyLook

    colours, ends = looks["colours"], looks["ends"]
    if colours not in COLOURS:
        raise WrongCall(f"--colours {colours}: choose one of: {', '.join(COLOURS)}", id="CLI-039")
    if ends and colours == OWN_COLOURS:
        raise WrongCall("--range: bodies that have a colour each show no values", id="CLI-040")
    return BodyLook(colours, ends, looks["scale"], looks["wishes"])


def _size(count: int) -> str:
    return f"{count / 1e6:.1f} MB" if count >= 1e6 else f"{count / 1e3:.0f} kB"


def _write_film(notices: Notices, target: Any, page: Any, looks: Any, bodies: "BodyLook") -> None:
    from ..results.figures.film import FORMATS, film_bytes
    from ..results.hdf5.stored_result import is_study
    from ..results.quantities.quantities import open_result, refuse_uneven, remarks

    path = notices.file
    refuse_standard_output(target, "a film", "--movie")
    form = Path(target).suffix[1:].lower()
    if form not in FORMATS:
        raise WrongCall(f"{target}: films are written as .mp4 or .gif files", id="CLI-041")
    if page:
        raise WrongCall("--movie writes a film in place of the page; leave out -o", id="CLI-042")
    look = _film_look(looks, bodies, form)
    _need_film_libraries(form)
    if is_study(path):
        raise WrongCall(f"{path} is the table of a study, which has no motion", id="CLI-043")
    refuse_inputs(target, [path])
    with notices.failures():
        with open_result(path) as file:
            refuse_uneven(file)
            content, notes = film_bytes(file, form, look), remarks(file)
        write_whole(target, content)
    notices.add(notes)
    if look.rate < looks["fps"]:
        message = f"{look.rate} frames a second, the most that browsers show of a GIF; MP4 has more"
        notices.add([Fault("note", message, id="RESULT-081")], file=target)
    notices.say(f"{path} → {target}, {len(content) / 1e6:.1f} MB")
    notices.end(file=target)


def _film_look(looks: dict[str, Any], bodies: "BodyLook", form: str) -> "FilmLook":
    from ..results.figures.film import MOST_OF_GIFS, FilmLook

    match = re.fullmatch(r"([0-9]{2,4})x([0-9]{2,4})", looks["size"])
    width, height = map(int, match.groups()) if match else (0, 0)
    if not (64 <= width <= 4096 and 64 <= height <= 4096):
        raise WrongCall(
            f"--size {looks['size']}: expected two numbers from 64 to 4096, such as 960x540", id="CLI-044"
        )
    rate = min(looks["fps"], MOST_OF_GIFS) if form == "gif" else looks["fps"]
    # Video has whole blocks of two pixels.
    return FilmLook(width - width % 2, height - height % 2, rate, looks["view"], bodies)


def _need_film_libraries(form: str) -> None:

    what = "flexmb report --movie"
    needed("matplotlib", "matplotlib", "movie", what)
    needed("imageio", "imageio", "movie", what)
    if form == "mp4":
        needed("imageio_ffmpeg", "imageio-ffmpeg", "movie", f"{what} of an MP4 file")


def _result_page(path: str, bodies: "BodyLook", looks: dict[str, Any]) -> tuple[bytes, list[Fault]]:
    from ..results.figures.report_page import PageWords, report_page
    from ..results.quantities.quantities import open_result, refuse_uneven, remarks

    words = PageWords(looks["title"], looks["note"], looks["curves"])
    with open_result(path) as file:
        refuse_uneven(file)
        return report_page(file, bodies, words).encode("utf-8"), remarks(file)


def _study_page(path: str) -> bytes:
    from ..study.figures import study_page
    from ..study.fit_page import fit_part
    from ..study.scatter import scatter_part
    from ..study.text import cases_table, open_study

    library = needed("plotly.offline", "plotly", "report", "flexmb report of a study").get_plotlyjs()
    with open_study(path) as file:
        cases, study = cases_table(file, (), path), file["study"].asstr()[()]
        return study_page(cases, study, library, fit_part(file) or scatter_part(file)).encode("utf-8")
