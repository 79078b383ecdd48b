"""`flexmb docs`: the documentation of this installation, in a browser."""

from pathlib import Path

import click

from .terminal.screen import WrongCall

INSTALLED, CHECKOUT = Path(__file__).resolve().parents[1:3]
# In a wheel the pages lie in the package, in a checkout where `scripts/docs` builds them.
PLACES = (INSTALLED / "docs", CHECKOUT / "docs" / "_build" / "html")
MARKDOWN = CHECKOUT / "docs" / "index.md"


@click.command()
@click.argument("page", default="index", metavar="[PAGE]")
@click.option("--where", is_flag=True, help="Print the address of the page, and open nothing.")
def docs(page: str, where: bool) -> None:
    """Open the documentation, or a PAGE of it, in a browser; it needs no network.

    \b
    Example:
        flexmb docs
        flexmb docs reference/young
        flexmb docs --where
    """
    path = _path(page)
    click.echo(path)
    if where:
        return
    import webbrowser

    if not webbrowser.open(path.as_uri()):
        click.echo("no browser can be started here: open this file in one", err=True)


def _path(page: str) -> Path:
    """Return the file of a page: "reference/young", "reference/young.md" and ".html" are the same."""
    folder = next((place for place in PLACES if (place / "index.html").is_file()), None)
    if folder is None:
        remedy = (
            f"read {MARKDOWN}, or" if MARKDOWN.is_file() else "take a wheel that has them, or a checkout:"
        )
        raise WrongCall(
            f"this installation has no built pages: {remedy} build them by scripts/docs", id="CLI-185"
        )
    name = page.removesuffix(".html").removesuffix(".md").strip("/")
    for path in (folder / f"{name}.html", folder / name / "index.html"):
        if path.is_file():
            return path
    raise WrongCall(f"there is no page {page!r}; {_similar(name, folder)}", id="CLI-186")


def _similar(name: str, folder: Path) -> str:
    from difflib import get_close_matches

    pages = [path.relative_to(folder).with_suffix("").as_posix() for path in sorted(folder.rglob("*.html"))]
    word = name.rpartition("/")[2].lower()
    close = [page for page in pages if word in page.lower()][:5] or get_close_matches(name, pages)
    return (
        f"is one of these meant: {', '.join(close)}?" if close else "`flexmb docs index` opens the first one"
    )
