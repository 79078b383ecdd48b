"""The box round a mechanism and the camera before it, as plotly.js takes them for a scene."""

from itertools import product

import numpy as np

from .view import view_of

# Longest side of a plane's box with the distance of the eye, and diagonal of a box in space.
FLAT, FLAT_DISTANCE, DEEP = 1.7, 1.9, 1.5
# The angle of view of plotly.js, the part of the picture's height that a box fills, and the picture's width
# by its height on a narrow screen.
ANGLE, FILLED, WIDE = np.pi / 4, 0.8, 1.4


def looked_at(places: np.ndarray, gravity: np.ndarray) -> dict:
    """Axes, camera and mouse of the scene of all `places` (N, 3) at any time, m; `gravity` (3,) tells up."""
    view = view_of(places, gravity)
    box = _box(places, view)
    return box | {"camera": _camera(view, box["aspectratio"]), "dragmode": _drag(view)}


def _box(places, view):
    """Equal axes round all places at any time."""
    low, high = places.min(axis=0), places.max(axis=0)
    extent = float((high - low).max()) or 1.0
    middle, half = (low + high) / 2, np.maximum((high - low) / 2, 0.1 * extent) + 0.05 * extent
    box = {
        f"{axis}axis": {"range": [middle[k] - half[k], middle[k] + half[k]]} | _name(axis, view.planar)
        for k, axis in enumerate("xyz")
    }
    if view.planar and max(map(abs, view.eye)) == 1.0:
        # The axis that is looked along would be a heap of numbers.
        box["xyz"[int(np.argmax(np.abs(view.eye)))] + "axis"]["visible"] = False
    ratio = FLAT * half / half.max() if view.planar else DEEP * half / np.linalg.norm(half)
    return box | {"aspectmode": "manual", "aspectratio": dict(zip("xyz", ratio.tolist(), strict=True))}


def _name(axis, planar):
    """Name and unit of an axis: its title; seen flat, where a title lies on the numbers, its last number."""
    if not planar:
        return {"title": {"text": f"{axis} [m]"}}
    words = {"tickprefix": f"{axis} = ", "ticksuffix": " m"}
    return {"title": {"text": ""}, "showtickprefix": "last", "showticksuffix": "last"} | words


def _camera(view, ratio):
    distance = _distance(view, np.array([ratio[axis] for axis in "xyz"]))
    return {
        "up": dict(zip("xyz", view.up, strict=True)),
        "eye": {axis: distance * part for axis, part in zip("xyz", view.eye, strict=True)},
        "projection": {"type": "orthographic" if view.planar else "perspective"},
    }


def _distance(view, sides):
    """Return how far the eye is from the middle of a box, so that its corners leave room for the axes' names.

    A corner c in the axes of the picture (right, up, eye) is seen at c_up / (distance - c_eye) times the
    cotangent of half the angle of view.
    """
    if view.planar:
        return FLAT_DISTANCE
    eye, up = np.array(view.eye), np.array(view.up)
    right = np.cross(up, eye) / np.linalg.norm(np.cross(up, eye))
    corners = np.array(list(product((-0.5, 0.5), repeat=3))) * sides
    high = np.abs(corners @ np.cross(eye, right)) / FILLED
    wide = np.abs(corners @ right) / (FILLED * WIDE)
    return float(np.max(np.maximum(high, wide) / np.tan(ANGLE / 2) + corners @ eye))


def _drag(view):
    """A turntable keeps z up; what is seen flat, or has another axis up, is turned freely."""
    return "turntable" if view.up == (0.0, 0.0, 1.0) and not view.planar else "orbit"
