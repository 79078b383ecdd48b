"""Nearest points of two shapes: gap, normal from i to j, and place, by the pair of shapes.

Closest points: Ericson, Real-Time Collision Detection (2005), 5.1.
Record fields are those of `model.arrays.contacts.TOUCH`.
"""

import math
from typing import TYPE_CHECKING

import numpy as np

from ._jit import kernel
from .contact_mesh import nearest_on_mesh
from .laws import NO_LENGTH
from .linalg.vec3 import cross, dot, minus, plus, scaled, triple

if TYPE_CHECKING:
    from ..model.arrays.contacts import Contacts

Triple = tuple[float, float, float]
Axes = tuple[Triple, Triple, Triple]  # unit vectors of a body, in global axes
# Pairs of shapes: that of body i, and that of body j.
PLANE_BALL, PLANE_RIM, CORES, BOX_BALL, CYLINDER_BALL, MESH_BALL = 0, 1, 2, 3, 4, 5


@kernel
def outward(axes: Axes, v: Triple) -> Triple:
    """Return v, in the axes of a body, in global axes."""
    return plus(plus(scaled(v[0], axes[0]), scaled(v[1], axes[1])), scaled(v[2], axes[2]))


@kernel
def across(n: Triple) -> Triple:
    """Return a unit vector across n."""
    a = (1.0, 0.0, 0.0) if abs(n[0]) < 0.7 else (0.0, 1.0, 0.0)
    b = cross(n, a)
    return scaled(1.0 / math.sqrt(dot(b, b)), b)


@kernel
def nearest(c: np.void, contacts: "Contacts", d: Triple, axes_i: Axes, axes_j: Axes):
    """Gap, its unit normal from i to j, and the point of the core of j nearest to i less its point, m."""
    pair, radii, none = c["pair"], c["radius_i"] + c["radius_j"], (0.0, 0.0, 0.0)
    a = outward(axes_i, triple(c["axis_i"], 0))
    if pair == PLANE_BALL:
        return dot(a, d) - radii, a, none
    if pair == PLANE_RIM:
        axis = outward(axes_j, triple(c["axis_j"], 0))
        down = minus(scaled(dot(a, axis), axis), a)
        length = math.sqrt(dot(down, down))
        arm = scaled(c["size"][0] / length if length > NO_LENGTH else 0.0, down)
        return dot(a, plus(d, arm)), a, arm
    if pair == BOX_BALL:
        sd, n = _outside_box(c["size"], (dot(axes_i[0], d), dot(axes_i[1], d), dot(axes_i[2], d)))
        return sd - radii, outward(axes_i, n), none
    if pair == CYLINDER_BALL:
        sd, n = _outside_cylinder(a, c["size"][0], d)
        return sd - radii, n, none
    if pair == MESH_BALL:
        p = (dot(axes_i[0], d), dot(axes_i[1], d), dot(axes_i[2], d))
        apart = outward(axes_i, minus(p, nearest_on_mesh(contacts, c, p)))
        length = math.sqrt(dot(apart, apart))
        return length - radii, scaled(1.0 / length, apart) if length > NO_LENGTH else axes_i[2], none
    b = outward(axes_j, triple(c["axis_j"], 0))
    s, t = _closest(a, b, d)
    arm = scaled(t, b)
    apart = plus(minus(d, scaled(s, a)), arm)
    length = math.sqrt(dot(apart, apart))
    n = scaled(1.0 / length, apart) if length > NO_LENGTH else (0.0, 0.0, 1.0)
    return length - radii, n, arm


@kernel
def _closest(a: Triple, b: Triple, d: Triple):
    """Shares s and t, 0 to 1, of the nearest points s a and d + t b of two segments, or points."""
    aa, bb, ab, ad, bd = dot(a, a), dot(b, b), dot(a, b), dot(a, d), dot(b, d)
    square = aa * bb - ab * ab
    s = _share(ad * bb - ab * bd, square) if square > 1e-14 * aa * bb else 0.0
    t = _share(ab * s - bd, bb)
    return _share(ad + ab * t, aa), t


@kernel
def _share(x: float, y: float):
    return min(max(x / y, 0.0), 1.0) if y > 0.0 else 0.0


@kernel
def _outside_box(size: np.ndarray, p: Triple):
    """Distance of p from a box of half edges size (3,) about 0, negative inside, and the normal."""
    x = minus(p, _clamped(size, p))
    length = math.sqrt(dot(x, x))
    if length > NO_LENGTH:
        return length, scaled(1.0 / length, x)
    depths = (size[0] - abs(p[0]), size[1] - abs(p[1]), size[2] - abs(p[2]))
    least = min(depths[0], min(depths[1], depths[2]))
    if depths[0] == least:
        return -least, (math.copysign(1.0, p[0]), 0.0, 0.0)
    if depths[1] == least:
        return -least, (0.0, math.copysign(1.0, p[1]), 0.0)
    return -least, (0.0, 0.0, math.copysign(1.0, p[2]))


@kernel
def _clamped(size: np.ndarray, p: Triple) -> Triple:
    return (
        min(max(p[0], -size[0]), size[0]),
        min(max(p[1], -size[1]), size[1]),
        min(max(p[2], -size[2]), size[2]),
    )


@kernel
def _outside_cylinder(a: Triple, radius: float, d: Triple):
    """Distance of d from the solid cylinder about the segment from 0 to a, and the normal."""
    length = math.sqrt(dot(a, a))
    axis = scaled(1.0 / length, a)
    along = dot(axis, d) - 0.5 * length
    side = minus(d, scaled(dot(axis, d), axis))
    off = math.sqrt(dot(side, side))
    out = scaled(1.0 / off, side) if off > NO_LENGTH else across(axis)
    end = scaled(math.copysign(1.0, along), axis)
    x, y = off - radius, abs(along) - 0.5 * length
    if x > 0.0 and y > 0.0:
        sd = math.sqrt(x * x + y * y)
        return sd, plus(scaled(x / sd, out), scaled(y / sd, end))
    return (x, out) if x > y else (y, end)
