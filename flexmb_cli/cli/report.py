"""`flexmb report`: a page on a result."""

import click

from .options.completion import files
from .terminal.screen import tell
from .terminal.written_place import WrittenPlace


@click.command()
@click.argument("result", metavar="RESULT.h5", shell_complete=files)
@click.option("-o", "--output", type=WrittenPlace(), metavar="PAGE.html",
              help="The page; - is standard output [default: the result's name with .html].")  # fmt: skip
@click.option("-q", "--quiet", is_flag=True, help="Say nothing but errors.")
def report(result, output, quiet):
    """Write a self-contained HTML page: motion in 3-D, curves, audit and deck of RESULT.h5.

    The page needs no network and shows the motion in any browser with WebGL 2: play, scrub, turn.

    Of the table of a study: parallel coordinates and each result over the parameters; this needs plotly
    (the extra `report`).

    \b
    Example:
        flexmb report OUT4-BAR.h5 -o four-bar.html
    """
    from pathlib import Path

    from ..results.files.replaced_file import write_whole
    from ..study.text import is_study
    from .options.output_file import STANDARD_OUTPUT, refuse_inputs, reported

    output = output or f"{Path(result).stem}.html"
    refuse_inputs(output, [result])
    if is_study(result):
        page, lacking = _study_page(result), ""
    else:
        page, lacking = _result_page(result)
    if output == STANDARD_OUTPUT:
        click.echo(page, nl=False)
    else:
        write_whole(output, page)
    if lacking and not quiet:
        tell(f"{result}: note: {lacking}")
    if not quiet:
        tell(f"{result} → {reported(output)}, {_size(len(page))}")


def _size(count: int) -> str:
    return f"{count / 1e6:.1f} MB" if count >= 1e6 else f"{count / 1e3:.0f} kB"


def _result_page(path):
    from ..results.figures.report_page import report_page
    from ..results.quantities.quantities import open_result, refuse_uneven, shortfall

    with open_result(path) as file:
        refuse_uneven(file)
        return report_page(file).encode("utf-8"), shortfall(file)


def _study_page(path):
    from ..extras import needed
    from ..study.cases_table import cases_table
    from ..study.page import study_page
    from ..study.text import open_study

    library = needed("plotly.offline", "plotly", "report", "flexmb report of a study").get_plotlyjs()
    with open_study(path) as file:
        return study_page(cases_table(file, (), path), file["study"].asstr()[()], library).encode("utf-8")
