"""Labels and numbers of axes that fit: measured as drawn, wrapped, thinned out or made smaller."""

import re
from collections.abc import Callable, Mapping
from itertools import pairwise
from typing import TYPE_CHECKING, Any, cast

if TYPE_CHECKING:
    from matplotlib.axis import Axis
    from matplotlib.figure import Figure
    from matplotlib.text import Text
    from matplotlib.transforms import Bbox

POINTS_PER_INCH = 72
# Width of a letter by the size of letters, where LaTeX would have to run for each measurement.
LETTER = 0.55
# Labels get smaller down to this part of their size, and to so many points where they had more.
LEAST_LETTERS, LEAST_POINTS = 0.6, 5.0
# Room for a label by its size, for letters have whole pixels.
SPARE = 1.02
# Heights of panels, by those wanted, for a label that takes too many lines at its least size.
TALLER = (1.0, 1.25, 1.5, 2.0)
# Sizes that are tried for a label of many words, and the distance of its lines by the size of letters.
PARTS, LABEL_LINE = (1.0, 0.9, 0.8, 0.7, LEAST_LETTERS), 1.3
# Least distance of two numbers of an axis by the size of letters: across, and one above the other.
GAP_BESIDE, GAP_ABOVE = 0.5, 0.1
FEWEST_BINS = 1
WORD = r"\[[^\]]*\]|\S+"  # of a label: a unit such as [N m/rad] is one


class Letters:
    """Letters of the size that the settings of matplotlib have by `key`, or of the size `key`, points."""

    def __init__(self, key: str):
        from matplotlib import rcParams
        from matplotlib.figure import Figure
        from matplotlib.font_manager import FontProperties

        known = cast("Mapping[str, Any]", rcParams)
        self.points = FontProperties(size=known.get(key, key)).get_size_in_points()
        self._latex = rcParams["text.usetex"]
        self._figure = Figure()

    @property
    def inches(self) -> float:
        """The size, in."""
        return self.points / POINTS_PER_INCH

    @property
    def least(self) -> float:
        """The smallest size that labels may get, points."""
        return max(LEAST_LETTERS * self.points, min(LEAST_POINTS, self.points))

    def width(self, text: str) -> float:
        """Return the width of a line, in."""
        if self._latex:
            return LETTER * self.inches * len(text)
        drawn = self._figure.text(0, 0, text, fontsize=self.points)
        width = drawn.get_window_extent().width / self._figure.dpi
        drawn.remove()
        return float(width)

    def wrapped(self, text: str, room: float, shown: Callable[[str], str] = str) -> str:
        """Return the words, as `shown`, in lines that are at most `room` in long; units stay whole."""
        lines: list[str] = []
        for word in re.findall(WORD, text):
            longer = f"{lines[-1]} {word}" if lines else word
            if lines and self.width(shown(longer)) <= room:
                lines[-1] = longer
            else:
                lines.append(word)
        return "\n".join(map(shown, lines))

    def fitted(
        self, text: str, room: float, depth: float, shown: Callable[[str], str] = str
    ) -> tuple[str, float]:
        """Return a text in lines of at most `room`, and the size of its letters, points.

        They are as large as possible where the lines take at most `depth`, in, and of the `least` size else;
        then the lines may be longer, by `TALLER`.
        """
        smallest = self.least / self.points
        trials = [(part, room) for part in PARTS if part > smallest]
        for part, length in trials + [(smallest, taller * room) for taller in TALLER]:
            lines = self.wrapped(text, length / part, shown)
            if LABEL_LINE * (lines.count("\n") + 1) * part * self.inches <= depth:
                break
        return lines, part * self.points


def fit_labels(figure: "Figure") -> bool:
    """Make labels smaller and numbers fewer where the figure, laid out, has no room; return whether it did.

    Where labels beside panels have no room at their least size the figure gets higher.
    Raises ValueError where letters across would get too small.
    """
    changed, part, least = False, 1.0, Letters("axes.labelsize").least
    for axes in figure.axes:
        across, up = axes.bbox.width, axes.bbox.height
        beside, half = axes.yaxis.label, figure.bbox.width / 2
        # Its height when its letters have the least size, or are smaller.
        height = beside.get_window_extent().height
        shrunk = SPARE * height * min(1.0, least / float(beside.get_fontsize()))
        if shrunk > 2 * half:
            raise ValueError("no room for a label")
        part = max(part, shrunk / up)
        changed |= _shrink(beside, height, max(up, shrunk), least)
        box, middle = axes.xaxis.label.get_window_extent(), (axes.bbox.x0 + axes.bbox.x1) / 2
        changed |= _shrink(axes.xaxis.label, box.width, 2 * (half - abs(half - middle)), least)
        changed |= _thin_out(axes.xaxis, across, 0) | _thin_out(axes.yaxis, up, 1)
    return _heighten(figure, part) or changed


def _heighten(figure: "Figure", part: float) -> bool:
    """Make the panels of a figure `part` times as high; return whether this is more than before."""
    if part <= 1.0:
        return False
    width, height = figure.get_size_inches()
    panels = sum(axes.bbox.height for axes in figure.axes) / figure.dpi
    figure.set_size_inches(width, height + (part - 1.0) * panels)
    return True


def _shrink(label: "Text", size: float, room: float, least: float) -> bool:
    """Make the letters of a label, `least` points at least, smaller when its `size` exceeds its `room`."""
    if size <= room:
        return False
    points = float(label.get_fontsize()) * room / size / SPARE
    if points < (1 - 1e-9) * least:
        raise ValueError("no room for a label")
    label.set_fontsize(points)
    return True


def _thin_out(axis: "Axis", room: float, direction: int) -> bool:
    """Give an axis fewer numbers where two of them meet; direction 0: across, 1: upwards."""
    boxes = number_boxes(axis)
    low, high = (("x0", "x1"), ("y0", "y1"))[direction]
    if not boxes:
        return False
    gap = (GAP_BESIDE, GAP_ABOVE)[direction] * min(box.height for box in boxes)
    if all(getattr(one, high) + gap <= getattr(other, low) for one, other in pairwise(boxes)):
        return False
    size = max(getattr(box, high) - getattr(box, low) for box in boxes)
    bins = min(int(room / (size + gap)), len(boxes) - 2)
    if bins < FEWEST_BINS:
        return False
    axis.axes.locator_params(axis="y" if direction else "x", nbins=bins)
    return True


def number_boxes(axis: "Axis") -> "list[Bbox]":
    """Return the boxes of the numbers that an axis shows, pixels, in their order."""
    low, high = sorted(axis.get_view_interval())
    shown = zip(axis.get_majorticklocs(), axis.get_majorticklabels(), strict=False)
    margin = 1e-9 * (high - low)
    return [
        text.get_window_extent()
        for at, text in shown
        if low - margin <= at <= high + margin and text.get_text()
    ]
