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

    The page needs no network and shows the motion in any browser with WebGL: play, scrub, turn.
    Needs plotly (the extra `report`).

    \b
    Example:
        flexmb report OUT4-BAR.h5 -o four-bar.html
    """
    from pathlib import Path

    from ..extras import needed
    from ..results.figures.report_page import report_page
    from ..results.files.replaced_file import write_whole
    from ..results.quantities.quantities import open_result, refuse_uneven, shortfall
    from .options.output_file import STANDARD_OUTPUT, refuse_inputs, told

    output = output or f"{Path(result).stem}.html"
    refuse_inputs(output, [result])
    library = needed("plotly.offline", "plotly", "report", "flexmb report").get_plotlyjs()
    with open_result(result) as file:
        refuse_uneven(file)
        lacking = shortfall(file)
        page = report_page(file, library).encode("utf-8")
    if output == STANDARD_OUTPUT:
        click.echo(page, nl=False)
    else:
        write_whole(output, page)
    if lacking and not quiet:
        tell(f"{result}: note: {lacking}")
    if not quiet:
        size, library_size = len(page) / 1e6, len(library.encode("utf-8")) / 1e6
        sizes = f"{size:.1f} MB, of them {library_size:.1f} MB plotly.js"
        tell(f"{result} → {told(output)}, {sizes}")
