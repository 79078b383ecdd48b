"""The examples of the three sources, run anew: index.html and its pictures in a folder."""

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
`tests/test_reproduce.py` holds the numbers."""


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


if __name__ == "__main__":
    folder, *rest = sys.argv[1:] or ["reproduction"]
    print(write_page(Path(folder), Path(rest[1]) if rest[:1] == ["--markdown"] else None))
