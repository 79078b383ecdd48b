"""`flexmb report`: a page on a result."""

import click


@click.command()
@click.argument("result", metavar="RESULT.h5")
@click.option("-o", "--output", metavar="PAGE.html",
              help="The page [default: the result's name with .html, in the current folder].")  # fmt: skip
@click.option("-q", "--quiet", is_flag=True, help="Say nothing but errors.")
def report(result, output, quiet):
    """Write a self-contained HTML page: motion in 3-D, curves, audit and deck of RESULT.h5.

    The page needs no network and shows the motion in any browser with WebGL: play, scrub, turn.
    Needs plotly: pip install 'flexmb[report]'.

    \b
    Example:
        flexmb report OUT4-BAR.h5 -o four-bar.html
    """
    from pathlib import Path

    from ..write.atomic import write_whole
    from ..write.quantities import open_result, refuse_uneven
    from ..write.report_page import report_page
    from .extras import needed

    library = needed("plotly.offline", "plotly", "report").get_plotlyjs()
    output = output or f"{Path(result).stem}.html"
    with open_result(result) as file:
        refuse_uneven(file)
        page = report_page(file, library).encode("utf-8")
    write_whole(output, page)
    if not quiet:
        size, library_size = len(page) / 1e6, len(library.encode("utf-8")) / 1e6
        told = f"{result} → {output}, {size:.1f} MB, of them {library_size:.1f} MB plotly.js"
        click.echo(told, err=True)
