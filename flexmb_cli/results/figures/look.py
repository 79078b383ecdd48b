"""Style of pictures: width on paper, fonts, a style file of matplotlib, texts by LaTeX."""

import logging
import re
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ...errors import lines_visible
from .label_fitting import Letters

if TYPE_CHECKING:
    from matplotlib.typing import RcKeyType

# Okabe and Ito's colours, distinguished by everyone.
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#B22222", "#6A3D9A")

# Of scenes: the ground and its axes, joints, paths of points.
GREY, JOINT, TRACE = "#808080", "#6B6B6B", "#B06060"
GRID: "dict[str, Any]" = {"linewidth": 0.4, "color": "#cccccc"}  # lines of a panel

MILLIMETRES = 25.4
# Height of a panel by the width of the picture.
PANEL, SQUARE_PART = 0.45, 0.85
# Curves of a panel whose legend still fits into it.
ROOMY = 4
TICKS = 6
THICKNESS = 1.3  # of a line, points
LARGEST_STYLE = 2**20  # bytes; matplotlib keeps all lines of one
# Distance of a legend's lines, and width of what stands before a name, by the size of letters.
LINE_SPACING, HANDLE = 1.5, 5.0
NARROWEST = 0.75  # part of a picture's width that a panel has at least
PRINTED_PART = 0.75  # of lines in print by those on a screen
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

    def in_legend(self, label: str) -> str:
        """The label of a curve in lines that are as long as a panel is wide."""
        letters = Letters("legend.fontsize")
        return letters.wrapped(label, NARROWEST * self.inches - HANDLE * letters.inches)

    def legend_columns(self, labels: list[str]) -> int:
        """Return how many names stand side by side below a panel."""
        letters = Letters("legend.fontsize")
        widest = max(map(letters.width, labels)) + HANDLE * letters.inches
        return 2 if 2 * widest < self.inches else 1

    def legend_height(self, labels: list[str]) -> float:
        """Height of a legend below its panel, in."""
        columns = self.legend_columns(labels)
        lines = [self.in_legend(label).count("\n") + 1 for label in labels]
        # Names stand one below the other, column by column, and the longest of a row counts.
        rows = -(-len(labels) // columns)
        rows = sum(max(lines[row::rows]) for row in range(rows))
        return rows * LINE_SPACING * Letters("legend.fontsize").inches

    def apply(self) -> list[str]:
        """Set matplotlib's settings, those of the style file last; return families that are not installed.

        These are left out.  Raises OSError for a style that there is not, or that would start LaTeX unasked.
        """
        from matplotlib import rcParams, rcParamsDefault

        rcParams.update(settings() | self.settings())
        if self.style:
            _use_style(self.style)
        # A tight box would change the width that was requested.
        rcParams["savefig.bbox"] = None
        # Pictures have a resolution of their own; a style's would size the canvas of the layout at will.
        rcParams["figure.dpi"] = rcParamsDefault["figure.dpi"]
        if rcParams["text.usetex"] and not self.latex:
            raise OSError("text.usetex starts LaTeX, another program: give --latex, too")
        # LaTeX finds its own fonts.
        if rcParams["text.usetex"]:
            return []
        missing = [family for family in rcParams["font.family"] if not _is_installed(family)]
        families = [family for family in rcParams["font.family"] if family not in missing]
        rcParams["font.family"] = families or ["sans-serif"]
        return missing

    def settings(self) -> "dict[RcKeyType, Any]":
        """Settings of matplotlib that follow, for rcParams."""
        size = self.size or 8.0
        smaller = SMALLER_LETTERS * size
        values: dict[RcKeyType, Any] = {
            "font.size": size, "axes.labelsize": size, "axes.titlesize": size, "figure.titlesize": size,
            "legend.fontsize": smaller, "xtick.labelsize": smaller, "ytick.labelsize": smaller,
            "lines.linewidth": PRINTED_PART * THICKNESS,
            "axes.linewidth": 0.6, "legend.frameon": False, "xtick.direction": "in", "ytick.direction": "in",
            "pdf.fonttype": 42, "svg.fonttype": "path", "text.usetex": self.latex,
        }  # fmt: skip
        return values | ({"font.family": self.font} if self.font else {})


def settings() -> "dict[RcKeyType, Any]":
    """Return the settings of matplotlib for curves of every type, which a style file may change."""
    from cycler import cycler

    return {
        "axes.prop_cycle": cycler(color=COLOURS), "lines.linewidth": THICKNESS, "axes.xmargin": 0.02,
        "axes.grid": True, "grid.linewidth": GRID["linewidth"], "grid.color": GRID["color"],
    }  # fmt: skip


def _use_style(name: str) -> None:
    """Use a style of matplotlib or the style file `name`.  Raises OSError where there is neither."""
    from difflib import get_close_matches

    from matplotlib import style

    # Of a name with a point matplotlib would import what stands before it.
    if name in ("default", "mpl15", "mpl20", *style.library):
        style.use(name)
        return
    if not Path(name).is_file():
        near = get_close_matches(name, style.available, cutoff=0.4) or ["ggplot", "classic", "grayscale"]
        raise OSError(f"no such file, and no style of matplotlib, such as {', '.join(near)}, has this name")
    if Path(name).stat().st_size > LARGEST_STYLE:
        raise OSError("it is not a style file: it has more than a megabyte")
    messages: list[str] = []
    try:
        with _held_back(messages), warnings.catch_warnings():
            # matplotlib leaves out a backend and the like, and warns with a line of its own source.
            warnings.simplefilter("ignore", UserWarning)
            style.use(Path(name))
    except UnicodeDecodeError:
        raise OSError("it is not a style file: it is not text in UTF-8") from None
    # Of a setting that stands twice the last one counts.
    places = (re.search(r", line #?(\d+)", each) for each in messages if not each.startswith("Duplicate"))
    numbers = [int(place[1]) for place in places if place]
    if numbers:
        raise OSError(_bad_line(numbers[0], Path(name).read_text(encoding="utf-8").splitlines()))


@contextmanager
def _held_back(messages: list[str]) -> Iterator[None]:
    """Append what matplotlib logs to `messages`; it would reach the screen."""
    logger = logging.getLogger("matplotlib")

    def hold(record: logging.LogRecord) -> bool:
        messages.append(record.getMessage())
        return False

    logger.addFilter(hold)
    try:
        yield
    finally:
        logger.removeFilter(hold)


def _bad_line(number: int, lines: list[str]) -> str:
    """Return what is wrong with a line, from 1, of a style file."""
    from difflib import get_close_matches

    from matplotlib import rcParams

    key, colon, value = (part.strip() for part in lines[number - 1].partition(":"))
    if not colon:
        return f"line {number} has no colon between a setting and its value: {lines_visible(key)}"
    if key in rcParams:
        return f"line {number}: {key} cannot be {lines_visible(value)}"
    near = get_close_matches(key, rcParams, n=1, cutoff=0.6)
    meant = f"; {near[0]} is one" if near else ""
    return f"line {number}: matplotlib has no setting {lines_visible(key)}{meant}"


def _is_installed(family: str) -> bool:
    """Return whether matplotlib finds a font of the family; serif and the like stand for several."""
    from matplotlib.font_manager import FontProperties, fontManager

    try:
        fontManager.findfont(FontProperties(family=[family]), fallback_to_default=False)
    except ValueError:
        return False
    return True
