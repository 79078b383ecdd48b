"""Style of pictures: width on paper, fonts, a style file of matplotlib, texts by LaTeX."""

import textwrap
from pathlib import Path
from typing import Any

from ...quick_dataclass import dataclass

# Okabe and Ito's colours, distinguished by everyone.
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#B22222", "#6A3D9A")

MILLIMETRES = 25.4
# Height of a panel by the width of the picture.
PANEL, SQUARE_PART = 0.45, 0.85
# Curves of a panel whose legend still fits into it.
ROOMY = 4
TICKS = 6
# Distance of a legend's lines by the size of letters; points an inch.
LINE_SPACING, POINTS_PER_INCH = 1.5, 72
# Widths of a letter and of a line of a legend by the size of letters.
LETTER, HANDLE = 0.55, 5.0
# Width of a number below an axis by the size of letters; part of a picture's width that a panel has at least.
TICK, NARROWEST = 2.6, 0.75
SMALLER_LETTERS = 0.9  # size of a legend's letters and of numbers by that of the others


@dataclass(frozen=True)
class Look:
    """A picture for print: `width` in mm; font family and size in points, "" and 0 for matplotlib's own.

    `style`: a style file of matplotlib, or the name of a style; `latex`: texts are set by LaTeX.
    """

    width: float
    font: str = ""
    size: float = 0.0
    style: str = ""
    latex: bool = False

    @property
    def inches(self) -> float:
        """The width, in."""
        return self.width / MILLIMETRES

    def wrapped(self, label: str) -> str:
        """The label of a vertical axis in lines that are no longer than a panel is high."""
        letters = PANEL * self.inches / (LETTER * (self.size or 8.0) / POINTS_PER_INCH)
        return "\n".join(textwrap.wrap(label, max(10, int(letters))))

    def in_legend(self, label: str) -> str:
        """The label of a curve in lines that are as long as a panel is wide."""
        letter = SMALLER_LETTERS * self._letter
        letters = (NARROWEST * self.inches - HANDLE * letter) / (LETTER * letter)
        return "\n".join(textwrap.wrap(label, max(8, int(letters))))

    @property
    def ticks(self) -> int:
        """Return how many numbers stand side by side below a panel."""
        return max(1, min(TICKS, int(NARROWEST * self.inches / (TICK * self._letter))))

    def letters_below(self, columns: int) -> int:
        """Return how many small letters stand in one of `columns` below a panel."""
        return max(4, int(NARROWEST * self.inches / columns / (LETTER * SMALLER_LETTERS * self._letter)))

    @property
    def _letter(self) -> float:
        """Size of letters, in."""
        return (self.size or 8.0) / POINTS_PER_INCH

    def legend_columns(self, labels: list[str]) -> int:
        """Return how many names stand side by side below a panel."""
        size = (self.size or 8.0) / POINTS_PER_INCH
        widest = max(map(len, labels)) * LETTER * size + HANDLE * size
        return 2 if 2 * widest < self.inches else 1

    def legend_height(self, labels: list[str]) -> float:
        """Height of a legend below its panel, in."""
        columns = self.legend_columns(labels)
        lines = [self.in_legend(label).count("\n") + 1 for label in labels]
        # Names stand one below the other, column by column, and the longest of a row counts.
        rows = -(-len(labels) // columns)
        rows = sum(max(lines[row::rows]) for row in range(rows))
        return rows * LINE_SPACING * (self.size or 8.0) / POINTS_PER_INCH

    def apply(self) -> list[str]:
        """Set matplotlib's settings, those of the style file last; return families that are not installed.

        These are left out.  Raises OSError for a style that there is not, or that would start LaTeX unasked.
        """
        from matplotlib import rcParams, style

        rcParams.update(self.settings())  # type: ignore[arg-type]
        if self.style:
            # Of a name with a point matplotlib would import what stands before it.
            known = self.style in ("default", "mpl15", "mpl20", *style.library)
            style.use(self.style if known else Path(self.style))
        if rcParams["text.usetex"] and not self.latex:
            raise OSError("text.usetex starts LaTeX, another program: give --latex, too")
        # LaTeX finds its own fonts.
        if rcParams["text.usetex"]:
            return []
        missing = [family for family in rcParams["font.family"] if not _is_installed(family)]
        kept = [family for family in rcParams["font.family"] if family not in missing]
        rcParams["font.family"] = kept or ["sans-serif"]
        return missing

    def settings(self) -> dict[str, Any]:
        """Settings of matplotlib that follow, for rcParams."""
        size = self.size or 8.0
        smaller = SMALLER_LETTERS * size
        found: dict[str, Any] = {
            "font.size": size, "axes.labelsize": size, "axes.titlesize": size, "figure.titlesize": size,
            "legend.fontsize": smaller, "xtick.labelsize": smaller, "ytick.labelsize": smaller,
            "lines.linewidth": 1.0, "axes.linewidth": 0.6, "xtick.direction": "in", "ytick.direction": "in",
            "pdf.fonttype": 42, "svg.fonttype": "path", "text.usetex": self.latex,
        }  # fmt: skip
        return found | ({"font.family": self.font} if self.font else {})


def _is_installed(family: str) -> bool:
    """Return whether matplotlib finds a font of the family; serif and the like stand for several."""
    from matplotlib.font_manager import FontProperties, fontManager

    try:
        fontManager.findfont(FontProperties(family=[family]), fallback_to_default=False)
    except ValueError:
        return False
    return True
