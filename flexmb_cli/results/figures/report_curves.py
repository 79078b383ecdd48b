"""Curves of a report as SVG: no script, sharp on paper, labels that are never cut off.

Curves with more points than the picture has columns are drawn between the smallest and the largest value of
each column, so that fast oscillations show as their envelope.
"""

import math
from html import escape
from typing import Any

import numpy as np

from .curves import Curve, Panel
from .look import COLOURS

PIXELS_WIDE, PIXELS_HIGH = 1000, 300
LEFT, RIGHT, TOP, BOTTOM = 90, 34, 14, 44
# Width of a digit in the large letters of a narrow screen, and what parts a number from the frame.
DIGIT, GAP = 23, 14
ENVELOPE_COLUMNS = 450
# More points than this for each column are an envelope.
POINTS_PER_COLUMN = 3
_DASHES = ("", "7 4", "2 3", "9 3 2 3")


def curve_figure(panel: Panel, title: str, number: int) -> str:
    """HTML of a panel: heading, SVG and a legend; `title` says what is drawn."""
    frame = _Frame(panel)
    curves = "".join(_curve(frame, curve, k) for k, curve in enumerate(panel.curves))
    legend = "".join(
        f'<li><svg width="30" height="10"><path d="M0 5H30" {_style(k)}/></svg> {escape(curve.label)}</li>'
        for k, curve in enumerate(panel.curves)
    )
    return (
        f'<figure class="curves" id="curves{number}"><figcaption>{escape(title)}</figcaption>'
        f'<svg viewBox="0 0 {PIXELS_WIDE} {PIXELS_HIGH}" role="img" aria-label="{escape(title)}">'
        f"{frame.drawn(panel.x_label)}{curves}</svg><ul>{legend}</ul></figure>"
    )


def _style(k: int, fill: str = "none") -> str:
    dash = _DASHES[k // len(COLOURS) % len(_DASHES)]
    dashed = f' stroke-dasharray="{dash}"' if dash else ""
    return f'fill="{fill}" stroke="{COLOURS[k % len(COLOURS)]}" stroke-width="1.6"{dashed}'


class _Frame:
    """The box of a panel: from values to places in the picture."""

    def __init__(self, panel: Panel):
        xs, ys = ([getattr(curve, key) for curve in panel.curves] for key in "xy")
        self.x = _range(xs, 0.0)
        self.y = _range(ys, 0.05)
        self.left = max(LEFT, DIGIT * max(len(text) for _, text in _ticks(*self.y)) + GAP)
        self.right = PIXELS_WIDE - max(RIGHT, DIGIT / 2 * len(_ticks(*self.x)[-1][1]) + GAP / 2)

    def places(self, x: float | np.ndarray, y: float | np.ndarray) -> np.ndarray:
        """Places (n, 2) of values."""
        across = self.left + (x - self.x[0]) / (self.x[1] - self.x[0]) * (self.right - self.left)
        down = PIXELS_HIGH - BOTTOM - (y - self.y[0]) / (self.y[1] - self.y[0]) * (PIXELS_HIGH - TOP - BOTTOM)
        return np.column_stack([across, down])

    def drawn(self, x_label: str) -> str:
        """Grid, ticks and the name of the x axis."""
        parts = []
        ticks = _ticks(*self.x)
        every = self.shown_when_narrow(ticks)
        for k, (value, text) in enumerate(ticks):
            x, kind = self.places(value, self.y[0])[0, 0], "below" if k % every == 0 else "below between"
            parts.append(f'<path class="grid" d="M{x:.1f} {TOP}V{PIXELS_HIGH - BOTTOM}"/>')
            parts.append(
                f'<text class="{kind}" x="{x:.1f}" y="{PIXELS_HIGH - BOTTOM + 17}"'
                f' text-anchor="middle">{text}</text>'
            )
        for value, text in _ticks(*self.y):
            y = self.places(self.x[0], value)[0, 1]
            parts.append(f'<path class="grid" d="M{self.left} {y:.1f}H{self.right:g}"/>')
            parts.append(
                f'<text class="beside" x="{self.left - 7}" y="{y + 4:.1f}" text-anchor="end">{text}</text>'
            )
        middle = (self.left + self.right) / 2
        parts.append(
            f'<text class="title" x="{middle}" y="{PIXELS_HIGH - 6}"'
            f' text-anchor="middle">{escape(x_label)}</text>'
        )
        return "".join(parts)

    def shown_when_narrow(self, ticks: list[tuple[float, str]]) -> int:
        """Return 1 where all numbers of the x axis have room in large letters, 2 for every other one, 3 …"""
        widest = DIGIT * max(len(text) for _, text in ticks) + GAP
        return max(1, math.ceil(widest * (len(ticks) - 1) / (self.right - self.left)))


def _range(arrays: list[np.ndarray], margin: float) -> tuple[float, float]:
    values = np.concatenate([array[np.isfinite(array)] for array in arrays])
    if not values.size:
        return 0.0, 1.0
    low, high = float(values.min()), float(values.max())
    size = high - low
    if size <= 1e-12 * max(abs(low), abs(high)) or size == 0.0:
        size = abs(high) or 1.0
        margin = 0.5
    return low - margin * size, high + margin * size


def _ticks(low: float, high: float) -> list[tuple[float, str]]:
    """About six round values between the ends, and their texts."""
    raw = (high - low) / 6
    power = 10.0 ** np.floor(np.log10(raw))
    step = power * next(one for one in (1, 2, 5, 10) if one * power >= raw)
    values = np.arange(np.ceil(low / step - 1e-9), np.floor(high / step + 1e-9) + 1) * step
    return [(float(value), _shown(float(value))) for value in values]


def _shown(value: float) -> Any:
    """The number as short as it can be written: 5e6."""
    mantissa, mark, power = f"{value + 0.0:.5g}".partition("e")
    return f"{mantissa}{mark}{int(power) if power else ''}".replace("-", "\N{MINUS SIGN}")


def _curve(frame: _Frame, curve: Curve, k: int) -> str:
    x, y = (np.asarray(values, float) for values in (curve.x, curve.y))
    known = np.isfinite(x) & np.isfinite(y)
    x, y = x[known], y[known]
    if not len(x):
        return ""
    if len(x) > POINTS_PER_COLUMN * ENVELOPE_COLUMNS and (np.diff(x) > 0).all():
        outline = _points(frame.places(*_envelope(x, y)))
        drawn = _style(k, COLOURS[k % len(COLOURS)])
        return f'<path class="envelope" d="M{outline}Z" {drawn} fill-opacity="0.35"/>'
    return f'<path d="M{_points(frame.places(x, y))}" {_style(k)}/>'


def _envelope(x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The outline of a curve by its extremes in columns: along the largest values and back."""
    column = np.minimum(((x - x[0]) / (x[-1] - x[0]) * ENVELOPE_COLUMNS).astype(int), ENVELOPE_COLUMNS - 1)
    first = np.flatnonzero(np.diff(column, prepend=-1))
    # A column begins with the last value of the one before, so that the outline has no gaps.
    high, low = np.maximum.reduceat(y, first), np.minimum.reduceat(y, first)
    before = np.concatenate([y[:1], y[first[1:] - 1]])
    high, low = np.maximum(high, before), np.minimum(low, before)
    return np.concatenate([x[first], x[first][::-1]]), np.concatenate([high, low[::-1]])


def _points(places: np.ndarray) -> str:
    return "L".join(f"{x:.1f} {y:.1f}" for x, y in places.tolist())
