"""The examples of the three sources, run anew: index.html and its pictures in a folder."""

import sys
import tempfile
from pathlib import Path

import dafms
import matplotlib as mpl
import vsdf
import young
import young_figures
from html_page import page

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


def write_page(folder: Path) -> Path:
    """Run everything and write the page; its path."""
    folder.mkdir(parents=True, exist_ok=True)
    sections = []
    for section in SECTIONS:
        with tempfile.TemporaryDirectory() as results:
            sections.append(section(Path(results), folder))
        print(f"{sections[-1].title}: done", file=sys.stderr)
    index = folder / "index.html"
    index.write_text(page("The three sources, run anew", sections), encoding="utf-8")
    return index


if __name__ == "__main__":
    print(write_page(Path(sys.argv[1] if len(sys.argv) > 1 else "reproduction")))
