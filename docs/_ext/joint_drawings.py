"""Draw every joint with its points P, Q, H, its vectors s and h, and the directions that it leaves free.

    python docs/_ext/joint_drawings.py

writes docs/pictures/joints/NAME.svg.  `POINTS` holds the points that decks would give for what is drawn:
`tests/house/test_joint_drawings.py` solves these decks.
"""

from pathlib import Path

from line_drawing import FAINT, FIRST, INK, SECOND, Drawing, Point

FOLDER = Path(__file__).resolve().parents[1] / "pictures" / "joints"
O, X = (0.0, 0.0, 0.0), (1.0, 0.0, 0.0)
# Points of a joint by name, along the axis x: H stands across it.
_TURNING = {"P_i": O, "P_j": O, "Q_i": (1.1, 0, 0), "Q_j": (1.75, 0, 0)}
_SLIDING = {"P_i": (-0.2, 0, 0), "Q_i": (0.45, 0, 0), "P_j": (1.2, 0, 0), "Q_j": (1.9, 0, 0)}
POINTS: dict[str, dict[str, Point]] = {
    "spherical": {"P_i": O, "P_j": O},
    "universal": {"P_i": O, "P_j": O, "Q_i": (0, 1.0, 0), "Q_j": (0, 0, 0.85)},
    "revolute": _TURNING,
    "cylindrical": _SLIDING,
    "translational": _SLIDING | {"H_i": (-0.2, 0, 0.75), "H_j": (1.2, -0.8, 0)},
    "screw": _SLIDING | {"H_i": (-0.2, 0, 0.75), "H_j": (1.2, 0, 0.75)},
    "fixed": {
        "P_i": O, "P_j": O, "Q_i": (1.1, 0, 0), "Q_j": (1.1, 0, 0), "H_i": (0, 0, 0.8), "H_j": (0, 0, 0.8),
    },
    "revolute-spherical": {"P_i": O, "Q_i": (0, 0, 0.8), "P_j": (1.5, 0, 0)},
    "spherical-spherical": {"P_i": O, "P_j": (1.6, 0, 0)},
}  # fmt: skip
NAMES = (*POINTS, "inline", "inplane", "parallel", "angle", "hinge")


def draw(name: str) -> str:
    """Return the drawing of a joint as the text of an SVG file."""
    drawing = Drawing(f"{name} joint" if name in POINTS else TITLES[name])
    DRAWN[name](drawing, POINTS.get(name, {}))
    return drawing.svg()


def _body(drawing, name, *points, colour):
    """Draw a bar to the frame of a body, and its name."""
    drawing.line(*points, colour=colour, width=6)
    x, y, z = points[-1]
    drawing.box((x - 0.2, y - 0.2, z - 0.2), (x + 0.2, y + 0.2, z + 0.2), colour)
    drawing.label(points[-1], name, -20 if colour == FIRST else 20, 5, colour)


def _first(drawing, start=(0, 0, -0.3), end=(-0.35, 0, -1.15)):
    _body(drawing, "i", start, end, colour=FIRST)


def _second(drawing, start=(2.2, 0, 0), end=(2.2, 0, -0.75)):
    _body(drawing, "j", start, end, colour=SECOND)


def _axis(drawing, low=-1.0, high=2.45):
    drawing.line((low, 0, 0), (high, 0, 0), colour=FAINT, dash="7 3 1 3")


def _mark(drawing, points, **labels):
    """Draw points and their names; `labels` says where a name stands, px from its point."""
    colours = {"i": FIRST, "j": SECOND}
    for name, (text, dx, dy) in labels.items():
        drawing.dot(points[name], colours[name[-1]] if "=" not in text else INK)
        drawing.label(points[name], text, dx, dy, colours[name[-1]] if "=" not in text else INK)


def _vector(drawing, start, end, name, colour, up=0.17, dx=-3, dy=-6):
    """Draw a vector beside its points."""
    start, end = ((x, y, z + up) for x, y, z in (start, end))
    drawing.arrow(start, end, colour)
    drawing.label([(a + b) / 2 for a, b in zip(start, end, strict=True)], name, dx, dy, colour)


def _spherical(drawing, points):
    _first(drawing, (-0.2, 0, -0.1), (-0.35, 0, -1.0))
    drawing.ball(O, 0.36, FIRST)
    drawing.ball(O, 0.26, SECOND)
    _second(drawing, (0.2, 0, 0.08), (1.7, 0, -0.2))
    for axis in (X, (0, 1, 0), (0, 0, 1)):
        drawing.turn([0.75 * each for each in axis], axis, 0.16)
    _mark(drawing, points, P_i=("P_i = P_j", -26, 4))


def _universal(drawing, points):
    _first(drawing, (-1.15, 0, 0), (-1.15, 0, -0.8))
    drawing.line((-1.15, 0, 0), (-0.6, 0, 0), colour=FIRST, width=6)
    drawing.line((0, 0.5, 0), (-0.6, 0.5, 0), (-0.6, -0.5, 0), (0, -0.5, 0), colour=FIRST, width=5)
    drawing.line((0, 0, 0.5), (0.6, 0, 0.5), (0.6, 0, -0.5), (0, 0, -0.5), colour=SECOND, width=5)
    drawing.line((0, -0.5, 0), (0, 0.5, 0), width=3)
    drawing.line((0, 0, -0.5), (0, 0, 0.5), width=3)
    _second(drawing, (0.6, 0, 0), (1.7, 0, 0))
    drawing.arrow(O, points["Q_i"], FIRST)
    drawing.arrow(O, points["Q_j"], SECOND)
    drawing.label((0, 0.8, 0), "s_i", 6, 16, FIRST)
    drawing.label((0, 0, 0.62), "s_j", -5, 2, SECOND)
    _mark(drawing, points, Q_i=("Q_i", 5, -6), Q_j=("Q_j", 7, -2), P_i=("P_i = P_j", -9, 38))


def _hub(drawing, low, high):
    drawing.cylinder((-0.75, 0, 0), (low, 0, 0), 0.11, SECOND)
    _first(drawing)
    drawing.cylinder((low, 0, 0), (high, 0, 0), 0.3, FIRST)


def _revolute(drawing, points):
    _axis(drawing)
    _hub(drawing, -0.35, 0.35)
    drawing.cylinder((0.35, 0, 0), (0.42, 0, 0), 0.2, SECOND)
    drawing.cylinder((0.42, 0, 0), (2.2, 0, 0), 0.11, SECOND)
    _second(drawing)
    drawing.turn((-0.6, 0, 0), X, 0.32)
    _vector(drawing, points["P_i"], points["Q_i"], "s_i", FIRST, 0.42, 4)
    _vector(drawing, points["P_j"], points["Q_j"], "s_j", SECOND, -0.4, 0, 14)
    _mark(drawing, points, P_i=("P_i = P_j", -6, -40), Q_i=("Q_i", -2, -9), Q_j=("Q_j", 0, -9))


def _slider(drawing, points):
    _axis(drawing)
    _hub(drawing, -0.5, 0.6)
    drawing.cylinder((0.6, 0, 0), (2.2, 0, 0), 0.11, SECOND)
    _second(drawing)
    _along(drawing, points)


def _along(drawing, points):
    """Draw vectors along the axis of a joint that slides, and the arrow of its stroke."""
    drawing.arrow((0.75, 0, -0.62), (1.6, 0, -0.62), both=True)
    _vector(drawing, points["P_i"], points["Q_i"], "s_i", FIRST, 0.46, 3)
    _vector(drawing, points["P_j"], points["Q_j"], "s_j", SECOND, 0.26, 5)
    _mark(drawing, points, P_i=("P_i", -3, 17), Q_i=("Q_i", -3, 17), P_j=("P_j", -2, 20), Q_j=("Q_j", -2, 20))


def _cylindrical(drawing, points):
    _slider(drawing, points)
    drawing.turn((-0.75, 0, 0), X, 0.32)


def _across(drawing, points):
    drawing.arrow(points["P_i"], points["H_i"], FIRST)
    drawing.label(points["H_i"], "H_i", -7, 2, FIRST)
    drawing.label(points["H_i"], "h_i", -7, 20, FIRST)
    drawing.arrow(points["P_j"], points["H_j"], SECOND)


def _translational(drawing, points):
    _axis(drawing)
    drawing.box((-0.75, -0.12, -0.12), (-0.5, 0.12, 0.12), SECOND)
    _first(drawing)
    drawing.box((-0.5, -0.32, -0.32), (0.6, 0.32, 0.32), FIRST)
    drawing.box((0.6, -0.12, -0.12), (2.2, 0.12, 0.12), SECOND)
    _second(drawing)
    _across(drawing, points)
    drawing.label(points["H_j"], "H_j", -3, 14, SECOND)
    drawing.label(points["H_j"], "h_j", 2, -9, SECOND)
    _along(drawing, points)


def _screw(drawing, points):
    _slider(drawing, points)
    for k in range(9):
        x = 0.68 + 0.13 * k
        drawing.line((x, -0.1, 0.02), (x + 0.06, 0.1, 0.06), colour=SECOND, width=1.4)
    _across(drawing, points)
    drawing.label(points["H_j"], "H_j", 6, 0, SECOND)
    drawing.label(points["H_j"], "h_j", 4, 14, SECOND)
    drawing.turn((-0.75, 0, 0), X, 0.32)


def _fixed(drawing, points):
    _first(drawing, (-0.4, 0, 0), (-0.85, 0, -0.75))
    drawing.box((-0.6, -0.32, -0.32), (0, 0.32, 0.32), FIRST)
    drawing.box((0, -0.32, -0.32), (0.6, 0.32, 0.32), SECOND)
    _second(drawing, (0.6, 0, 0), (1.8, 0, -0.3))
    drawing.arrow(O, points["Q_i"])
    drawing.arrow(O, points["H_i"])
    _mark(
        drawing, points,
        Q_i=("Q_i = Q_j", 4, -10), H_i=("H_i = H_j", 7, 2), P_i=("P_i = P_j", -30, -28),
    )  # fmt: skip


def _link(drawing, points, axis):
    end = points["P_j"]
    if axis:
        drawing.cylinder((0, 0, -0.3), (0, 0, 0.3), 0.2, FIRST)
        drawing.arrow(O, points["Q_i"], FIRST)
        drawing.label(points["Q_i"], "Q_i", -7, 3, FIRST)
        drawing.label(points["Q_i"], "s_i", 6, 4, FIRST)
        drawing.turn((0, 0, 0.48), (0, 0, 1), 0.26)
    else:
        drawing.ball(O, 0.24, FIRST)
    drawing.line(O, end, width=4)
    drawing.ball(end, 0.24, SECOND)
    drawing.label([each / 2 for each in end], "size", -2, 20)
    _mark(drawing, points, P_i=("P_i", -16, 4), P_j=("P_j", 8, -16))


def _revolute_spherical(drawing, points):
    _first(drawing)
    _second(drawing, (1.5, 0, 0), (2.3, 0, -0.5))
    _link(drawing, points, axis=True)


def _spherical_spherical(drawing, points):
    _first(drawing, O)
    _second(drawing, (1.6, 0, 0), (2.3, 0, -0.5))
    _link(drawing, points, axis=False)


def _inline(drawing, points):
    _body(drawing, "1", (-0.8, 0, 0), (-0.8, 0, -0.85), colour=FIRST)
    drawing.cylinder((-0.8, 0, 0), (1.9, 0, 0), 0.06, FIRST)
    drawing.ball((0.7, 0, 0), 0.2, SECOND)
    _body(drawing, "2", (0.7, 0, 0), (1.2, 0, 0.75), colour=SECOND)
    drawing.arrow((0.2, 0, -0.42), (1.3, 0, -0.42), both=True)
    drawing.arrow((1.9, 0, 0), (2.4, 0, 0), FIRST)
    drawing.label((2.1, 0, 0), "axis", 2, -12, FIRST)
    drawing.dot((0.7, 0, 0))


def _inplane(drawing, points):
    _body(drawing, "1", (-0.4, -0.6, 0), (-0.4, -0.6, -0.75), colour=FIRST)
    drawing.plane([(-0.7, -0.9, 0), (1.9, -0.9, 0), (1.9, 0.9, 0), (-0.7, 0.9, 0)], FIRST)
    drawing.arrow((0, 0.2, 0), (0, 0.2, 0.85), FIRST)
    drawing.label((0, 0.2, 0.85), "axis", -7, 8, FIRST)
    drawing.arrow((0.35, -0.45, 0), (1.5, -0.45, 0), both=True)
    drawing.arrow((1.55, -0.5, 0), (1.55, 0.55, 0), both=True)
    _body(drawing, "2", (0.8, 0.1, 0), (1.3, 0.1, 0.8), colour=SECOND)
    drawing.dot((0.8, 0.1, 0))


def _parallel(drawing, points):
    _body(drawing, "1", O, (0, 0, -0.85), colour=FIRST)
    _body(drawing, "2", (1.7, 0, 0.2), (1.7, 0, -0.55), colour=SECOND)
    drawing.arrow(O, (0, 0, 0.95), FIRST)
    drawing.arrow((1.7, 0, 0.2), (1.7, 0, 1.15), SECOND)
    drawing.turn((1.7, 0, 0.8), (0, 0, 1), 0.25)
    drawing.label((0, 0, 0.95), "axis", -7, 8, FIRST)
    drawing.line(O, (1.7, 0, 0.2), colour=FAINT, dash="4 3")


def _angle(drawing, points):
    _body(drawing, "1", O, (-0.4, 0, -0.85), colour=FIRST)
    _body(drawing, "2", O, (1.5, 0, -0.3), colour=SECOND)
    drawing.arrow(O, (0, 0, 1.1), FIRST)
    drawing.arrow(O, (0.95, 0, 0.85), SECOND)
    drawing.line((0, 0, 0.75), (0.3, 0, 0.72), (0.56, 0, 0.5), width=1.4)
    drawing.label((0, 0, 1.1), "axis_from", -7, 8, FIRST)
    drawing.label((0.95, 0, 0.85), "axis_to", 4, -4, SECOND)
    drawing.label((0.28, 0, 0.72), "α", 1, -3)


def _hinge(drawing, points):
    _body(drawing, "parent", O, (-0.5, 0, -0.95), colour=FIRST)
    _frame(drawing, O, FIRST)
    origin = (1.35, 0.1, 0.25)
    drawing.arrow(O, origin)
    drawing.label((0.7, 0.05, 0.12), "t", -4, 14)
    _frame(drawing, origin, SECOND)
    drawing.turn((1.35, 0.1, 0.75), (0, 0, 1), 0.18)
    _body(drawing, "K", origin, (2.2, 0.1, -0.45), colour=SECOND)
    drawing.dot(O, FIRST)
    drawing.dot(origin, SECOND)
    drawing.label(O, "P_K", -7, 2, FIRST)
    drawing.label(origin, "O_K", -2, 20, SECOND)


def _frame(drawing, origin, colour):
    for k, (axis, dx, dy) in enumerate((((0.7, 0, 0), 3, 10), ((0, 0.75, 0), 3, -2), ((0, 0, 0.75), 4, 2))):
        end = [a + b for a, b in zip(origin, axis, strict=True)]
        drawing.arrow(origin, end, colour, 1.3)
        drawing.label(end, f"{k + 1}", dx, dy, colour)


TITLES = {
    "inline": "inline: a point on a line",
    "inplane": "inplane: a point in a plane",
    "parallel": "parallel: axes keep their direction",
    "angle": "angle: axes keep their angle",
    "hinge": "hinge of body K on its parent",
}
DRAWN = {
    "spherical": _spherical, "universal": _universal, "revolute": _revolute, "cylindrical": _cylindrical,
    "translational": _translational, "screw": _screw, "fixed": _fixed, "inline": _inline,
    "revolute-spherical": _revolute_spherical, "spherical-spherical": _spherical_spherical,
    "inplane": _inplane, "parallel": _parallel, "angle": _angle, "hinge": _hinge,
}  # fmt: skip


def main() -> None:
    """Write all drawings."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    for name in NAMES:
        (FOLDER / f"{name}.svg").write_text(draw(name), encoding="utf-8")


if __name__ == "__main__":
    main()
