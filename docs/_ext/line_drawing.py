"""Drawings of bodies in space as SVG: lines, arrows, cylinders and boxes in one view, without shadows."""

import math
import re
from collections.abc import Sequence
from html import escape

import numpy as np

from flexmb_cli.results.figures.look import COLOURS

Point = Sequence[float]
FIRST, SECOND = COLOURS[:2]  # bodies i and j
INK, FAINT, PAPER = "#333333", "#8a8a8a", "#ffffff"
AZIMUTH, ELEVATION = math.radians(-58), math.radians(24)
UNIT = 64.0  # of a length 1, in px
HEAD = 6.0  # of an arrow
TURN = np.radians(np.arange(-150, 151, 10))  # of the arrow about an axis
_EYE = np.array(
    [math.cos(ELEVATION) * math.cos(AZIMUTH), math.cos(ELEVATION) * math.sin(AZIMUTH), math.sin(ELEVATION)]
)
_RIGHT = np.array([-math.sin(AZIMUTH), math.cos(AZIMUTH), 0.0])
_UP = np.cross(_EYE, _RIGHT)


class Drawing:
    """A picture that grows by parts; what comes later lies in front.  Coordinates are those of space."""

    def __init__(
        self, title: str, width: int = 270, height: int = 205, middle: tuple[float, float] = (92, 92)
    ):
        self.title, self.width, self.height, self.middle = title, width, height, middle
        self.parts: list[str] = []

    def place(self, point: Point) -> np.ndarray:
        """Return where a point lies in the picture, in px from its upper left corner."""
        x, y = UNIT * (_RIGHT @ point), UNIT * (_UP @ point)
        return np.array([self.middle[0] + x, self.middle[1] - y])

    def line(self, *points: Point, colour: str = INK, width: float = 1.2, dash: str = "") -> None:
        """Draw a line through points."""
        dashed = f' stroke-dasharray="{dash}"' if dash else ""
        self.parts.append(
            f'<polyline points="{self._list(points)}" fill="none" stroke="{colour}" stroke-width="{width}"'
            f' stroke-linecap="round" stroke-linejoin="round"{dashed}/>'
        )

    def arrow(
        self, start: Point, end: Point, colour: str = INK, width: float = 1.6, both: bool = False
    ) -> None:
        """Draw an arrow; `both`: with a head at its start, too."""
        self.line(start, end, colour=colour, width=width)
        for tail, tip in ((start, end), (end, start))[: 1 + both]:
            self._head(self.place(tail), self.place(tip), colour)

    def turn(self, middle: Point, axis: Point, radius: float, colour: str = INK) -> None:
        """Draw an arrow that turns about an axis."""
        first, second = _across(axis)
        ring = [np.asarray(middle) + radius * (math.cos(a) * first + math.sin(a) * second) for a in TURN]
        self.line(*ring, colour=colour, width=1.6)
        self._head(self.place(ring[-2]), self.place(ring[-1]), colour)

    def dot(self, point: Point, colour: str = INK, radius: float = 3.2) -> None:
        """Draw a point."""
        x, y = self.place(point)
        self.parts.append(
            f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{radius}" fill="{colour}" stroke="{PAPER}"/>'
        )

    def ball(self, point: Point, radius: float, colour: str) -> None:
        """Draw a ball."""
        x, y = self.place(point)
        self.parts.append(
            f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{UNIT * radius:.1f}" fill="{_pale(colour)}"'
            f' stroke="{colour}" stroke-width="1.6"/>'
        )

    def cylinder(self, start: Point, end: Point, radius: float, colour: str) -> None:
        """Draw a cylinder between two points, with the end that is seen."""
        axis = np.subtract(end, start)
        first, second = _across(axis)
        circle = [
            radius * (math.cos(a) * first + math.sin(a) * second) for a in np.linspace(0, 2 * np.pi, 37)
        ]
        near, far = (end, start) if axis @ _EYE > 0 else (start, end)
        rims = [np.asarray(place) + each for place in (near, far) for each in circle]
        self._face(hull([self.place(each) for each in rims]), colour)
        self._face([self.place(each) for each in rims[: len(circle)]], colour)

    def box(self, low: Point, high: Point, colour: str) -> None:
        """Draw a box along the axes between two corners."""
        ends = np.array([low, high], float)
        for k in range(3):
            corners = np.repeat(ends[[int(_EYE[k] > 0)]], 4, axis=0)
            others = [n for n in range(3) if n != k]
            corners[:, others[0]] = ends[[0, 1, 1, 0], others[0]]
            corners[:, others[1]] = ends[[0, 0, 1, 1], others[1]]
            self._face([self.place(each) for each in corners], colour)

    def plane(self, corners: Sequence[Point], colour: str) -> None:
        """Draw a face."""
        self._face([self.place(each) for each in corners], colour)

    def label(self, point: Point, text: str, dx: float = 6, dy: float = -6, colour: str = INK) -> None:
        """Write a text beside a point; what follows `_` is lowered: "s_i"."""
        x, y = self.place(point) + (dx, dy)
        anchor = "start" if dx >= 0 else "end"
        self.parts.append(self._text(x, y, text, anchor, colour))

    def svg(self) -> str:
        """Return the picture as a file."""
        head = (
            f'<svg xmlns="http://www.w3.org/2000/svg" width="{self.width}" height="{self.height}"'
            f' viewBox="0 0 {self.width} {self.height}" font-family="sans-serif" font-size="13">'
        )
        paper = f'<rect width="{self.width}" height="{self.height}" rx="8" fill="{PAPER}"/>'
        title = self._text(self.width / 2, self.height - 9, self.title, "middle", INK)
        return "\n".join(
            [head, f"<title>{escape(self.title)}</title>", paper, *self.parts, title, "</svg>", ""]
        )

    def _text(self, x, y, text, anchor, colour):
        lowered = re.sub(
            r"_(\w+)", r'<tspan dy="3" font-size="10">\1</tspan><tspan dy="-3">&#8203;</tspan>', escape(text)
        )
        return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" fill="{colour}">{lowered}</text>'

    def _face(self, corners, colour):
        listed = " ".join(f"{x:.1f},{y:.1f}" for x, y in corners)
        self.parts.append(
            f'<polygon points="{listed}" fill="{_pale(colour)}" stroke="{colour}" stroke-width="1.4"'
            ' stroke-linejoin="round"/>'
        )

    def _head(self, tail, tip, colour):
        along = (tip - tail) / max(float(np.hypot(*(tip - tail))), 1e-9)
        side = HEAD / 2.4 * np.array([-along[1], along[0]])
        corners = (tip, tip - HEAD * along + side, tip - HEAD * along - side)
        listed = " ".join(f"{x:.1f},{y:.1f}" for x, y in corners)
        self.parts.append(f'<polygon points="{listed}" fill="{colour}" stroke="{colour}"/>')

    def _list(self, points):
        return " ".join("{:.1f},{:.1f}".format(*self.place(point)) for point in points)


def hull(points: list[np.ndarray]) -> list[np.ndarray]:
    """Return the corners of the convex hull of points in a plane (Andrew's monotone chain, 1979)."""
    ordered = sorted(points, key=tuple)

    def chain(those):
        corners: list[np.ndarray] = []
        for each in those:
            while len(corners) > 1 and _turns_right(corners[-2], corners[-1], each):
                corners.pop()
            corners.append(each)
        return corners[:-1]

    return chain(ordered) + chain(ordered[::-1])


def _turns_right(a, b, c):
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]) <= 0


def _across(axis: Point) -> tuple[np.ndarray, np.ndarray]:
    """Return two unit vectors at right angles to an axis; about it the second follows the first."""
    unit = np.asarray(axis, float) / np.linalg.norm(axis)
    other = np.eye(3)[int(np.argmin(np.abs(unit)))]
    first = np.cross(unit, other)
    first /= np.linalg.norm(first)
    return first, np.cross(unit, first)


def _pale(colour: str) -> str:
    """Return a colour mixed with four parts of white."""
    channels = (int(colour[k : k + 2], 16) for k in (1, 3, 5))
    return "#" + "".join(f"{round(0.2 * each + 0.8 * 255):02x}" for each in channels)
