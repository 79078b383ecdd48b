"""Shapes of bodies for pictures: surfaces of triangles in body axes, from primitives or files.

Primitives have their centre at the offset and their axis along z, turned by three angles about the fixed
axes x, y, z in this order (roll, pitch, yaw of URDF).  Shapes take no part in any analysis.
"""

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from .vectors import Vector

BOX, CYLINDER, TUBE, CONE, SPHERE = "box", "cylinder", "tube", "cone", "sphere"
KINDS = (BOX, CYLINDER, TUBE, CONE, SPHERE)
# Sizes a, b, c of each primitive; those that it lacks must stay empty.
SIZES = {
    BOX: ("length along x", "length along y", "length along z"),
    CYLINDER: ("radius", "length"),
    TUBE: ("outer radius", "length", "inner radius"),
    CONE: ("radius at its lower end", "length", "radius at its upper end, 0: a tip"),
    SPHERE: ("radius",),
}
# Flat sides of a circle, and circles of a sphere between its poles.
SIDES, CIRCLES = 32, 15
# m: single precision still holds the third power; a page and a film compute with it.
LARGEST_LENGTH = 1e12
# libm differs in the last digits between processors; files must not.
DIGITS = 12
_CUBE = ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))


@dataclass(frozen=True)
class ShapeCard:
    """A primitive of one of `KINDS`, or an STL `file` in units of `unit` m, as its card gives it.

    `body` counts from 0, -1 is the ground; the middle (origin of a file) `offset`, m, and the `angles`, rad,
    about the fixed axes x, y, z in turn are in its axes.
    """

    body: int
    kind: str
    sizes: Vector
    offset: Vector
    angles: Vector
    file: str = ""
    unit: float = 1.0


@dataclass(frozen=True, eq=False)
class Shape:
    """A surface fixed to the body of number `body`, 0 the ground, as the deck counts, and its card.

    `vertices` (n, 3), m, axes of the body; `triangles` (m, 3): rows of vertices, anticlockwise
    from outside.
    """

    body: int
    vertices: np.ndarray
    triangles: np.ndarray
    card: ShapeCard | None = None


def fault_of_sizes(kind: str, sizes: Vector) -> tuple[int, str] | None:
    """Return which of the sizes a b c (m) is wrong, from 0, and the rule that it breaks; None: none is."""
    names_of_sizes = SIZES[kind]
    for k, size in enumerate(sizes):
        if k >= len(names_of_sizes):
            if size:
                return k, f"is not read: a {kind} has {len(names_of_sizes)} sizes; leave the field empty"
        elif not (size > 0 or (kind == CONE and k == 2 and size == 0)):
            return k, f"must be above zero: {names_of_sizes[k]}"
        elif size > LARGEST_LENGTH:
            return k, f"must be at most {LARGEST_LENGTH:g} m: {names_of_sizes[k]}"
    if kind == TUBE and sizes[2] >= sizes[0]:
        return 2, f"must be below the outer radius {sizes[0]:g}: inner radius"
    return None


def primitive(body: int, kind: str, sizes: Vector, offset: Vector, angles: Vector) -> Shape:
    """Return the surface of a primitive of one of `KINDS`; lengths in m, angles in rad."""
    a, b, c = sizes
    rings = {
        CYLINDER: ((0.0, -b / 2), (a, -b / 2), (a, b / 2), (0.0, b / 2)),
        TUBE: ((c, -b / 2), (a, -b / 2), (a, b / 2), (c, b / 2), (c, -b / 2)),
        CONE: ((0.0, -b / 2), (a, -b / 2), (c, b / 2)) + (((0.0, b / 2),) if c else ()),
        SPHERE: tuple(_rounded((a * s, -a * k)) for k, s in map(_turned, range(CIRCLES + 2))),
    }
    vertices, triangles = _box(sizes) if kind == BOX else _revolved(rings[kind])
    card = ShapeCard(body - 1, kind, sizes, offset, angles)
    return Shape(body, moved(vertices, offset, angles), triangles, card)


def _turned(k: int) -> tuple[Any, Any]:
    angle = math.pi * k / (CIRCLES + 1)
    return math.cos(angle), math.sin(angle)


def _rounded(pair: tuple[float, float]) -> tuple[Any, ...]:
    return tuple(round(x, DIGITS) for x in pair)


def moved(vertices: np.ndarray, offset: Vector, angles: Vector) -> np.ndarray:
    """Return vertices (n, 3) turned by the angles about the fixed axes x, y, z in turn, then shifted."""
    (cx, sx), (cy, sy), (cz, sz) = (
        (round(math.cos(angle), DIGITS), round(math.sin(angle), DIGITS)) for angle in angles
    )
    x, y, z = vertices.T
    y, z = cx * y - sx * z, sx * y + cx * z
    x, z = cy * x + sy * z, cy * z - sy * x
    x, y = cz * x - sz * y, sz * x + cz * y
    return np.column_stack([x + offset[0], y + offset[1], z + offset[2]]) + 0.0


def turning(angles: Vector) -> np.ndarray:
    """Return the rotation matrix (3, 3) of angles about the fixed axes x, y, z in turn."""
    return moved(np.eye(3), (0.0, 0.0, 0.0), angles).T


def _box(sizes: tuple[float, float, float]) -> tuple[Any, Any]:
    corners = ((-1, -1), (1, -1), (1, 1), (-1, 1))
    vertices = np.array([(x, y, z) for z in (-1, 1) for x, y in corners]) * (np.array(sizes) / 2)
    triangles = [(p, q, r) for p, q, r, _ in _CUBE] + [(p, r, s) for p, _, r, s in _CUBE]
    return vertices, np.array(triangles)


def _revolved(profile: tuple[tuple[Any, ...], ...]) -> tuple[Any, Any]:
    """Surface of revolution of the points (radius, z) of a profile about z; points on the axis are one."""
    circle = [
        _rounded((math.cos(2 * math.pi * k / SIDES), math.sin(2 * math.pi * k / SIDES))) for k in range(SIDES)
    ]
    vertices: list[tuple[float, float, float]] = []
    rings: list[list[int]] = []
    for radius, z in profile:
        ring = [(radius * x, radius * y, z) for x, y in (circle if radius else [(0.0, 0.0)])]
        rings.append([len(vertices) + k % len(ring) for k in range(SIDES + 1)])
        vertices += ring
    triangles = []
    for low, high in pairwise(rings):
        for k in range(SIDES):
            quad = low[k], low[k + 1], high[k + 1], high[k]
            triangles += [quad[:3]] * (low[k] != low[k + 1]) + [quad[:1] + quad[2:]] * (
                high[k] != high[k + 1]
            )
    return np.array(vertices), np.array(triangles)
