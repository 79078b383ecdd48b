"""The examples of the three sources, run anew: index.html and its pictures in a folder."""

import argparse
import sys
import tempfile
from pathlib import Path

import dafms
import matplotlib as mpl
import vsdf
import young
import young_figures
from html_page import markdown_page, page

mpl.use("Agg")

SECTIONS = (
    young.listings,
    young.coelho,
    young_figures.figures,
    young_figures.jacobians,
    young_figures.precision,
    dafms.pendulum,
    dafms.shaft,
    dafms.manipulator,
    vsdf.pendulum,
)


HEAD = """# The sources, run anew

`scripts/reproduce` makes this page: it runs the examples of the three sources and writes what was printed
beside what flexmb computes, with the agreement measured, or the reason why the print is wrong.
`tests/scripts/test_reproduce.py` holds the numbers."""


def write_page(folder: Path, markdown: Path | None = None) -> Path:
    """Run everything and write the page, and that of the documentation if asked for; its path."""
    folder.mkdir(parents=True, exist_ok=True)
    sections = []
    for section in SECTIONS:
        with tempfile.TemporaryDirectory() as results:
            sections.append(section(Path(results), folder))
        print(f"{sections[-1].title}: done", file=sys.stderr)
    index = folder / "index.html"
    index.write_text(page("The three sources, run anew", sections), encoding="utf-8")
    if markdown:
        markdown.write_text(markdown_page(HEAD, sections), encoding="utf-8")
    return index


def arguments(words: list[str]) -> argparse.Namespace:
    """Return the folder of the page, and the file of that of the documentation."""
    parser = argparse.ArgumentParser(prog="scripts/reproduce", description=__doc__)
    parser.add_argument(
        "folder", nargs="?", type=Path, default=Path("reproduction"), help="folder of the page"
    )
    parser.add_argument(
        "--markdown", type=Path, metavar="FILE", help="write the page of the documentation, too"
    )
    return parser.parse_args(words)


if __name__ == "__main__":
    asked = arguments(sys.argv[1:])
    print(write_page(asked.folder, asked.markdown))
