"""Nearest point of a mesh of triangles: through a tree of boxes, which is walked without a stack.

Nearest point of a triangle: Ericson, Real-Time Collision Detection (2005), 5.1.5; trees of boxes whose nodes
stand in depth-first order: Smits, Efficiency Issues for Ray Tracing, Journal of Graphics Tools 3 (1998).
Record fields are those of `model.arrays.meshes.MESH_BOX`.
"""

from typing import TYPE_CHECKING

import numpy as np

from ._jit import kernel
from .linalg.vec3 import dot, minus, plus, scaled, triple

if TYPE_CHECKING:
    from ..model.arrays.contacts import Contacts

Triple = tuple[float, float, float]
WIDER = 1.0 + 1e-12  # of the square of a distance: nothing nearer than the triangle found last is left out


@kernel
def nearest_on_mesh(contacts: "Contacts", c: np.void, p: Triple) -> Triple:
    """Return the point of the mesh of a TOUCH nearest to p, m, axes of the body, and keep its triangle.

    Of several that are as near it is that of the first triangle.
    """
    nearest = _nearest_on_triangle(contacts.triangles[c["triangle"]], p)
    least = WIDER * _square(minus(p, nearest))
    n, end = c["first_box"], contacts.boxes[c["first_box"]]["skip"]
    first = True
    while n < end:
        box = contacts.boxes[n]
        if _square_outside(box, p) > least:
            n = box["skip"]
            continue
        if box["triangle"] >= 0:
            q = _nearest_on_triangle(contacts.triangles[box["triangle"]], p)
            square = _square(minus(p, q))
            if square < least or (first and square <= least):
                nearest, least, first = q, square, False
                c["triangle"] = box["triangle"]
        n += 1
    return nearest


@kernel
def _square(v: Triple) -> float:
    return dot(v, v)


@kernel
def _square_outside(box: np.void, p: Triple) -> float:
    """Square of the distance of p from a box."""
    total = 0.0
    for k in range(3):
        x = p[k]
        out = max(max(box["low"][k] - x, x - box["high"][k]), 0.0)
        total += out * out
    return total


@kernel
def _nearest_on_triangle(corners: np.ndarray, p: Triple) -> Triple:
    """Return the point of a triangle (9,) that is nearest to p: at a corner, on an edge, or inside.

    By the regions of Ericson (2005), Real-Time Collision Detection, section 5.1.5.
    """
    a, b, c = triple(corners, 0), triple(corners, 3), triple(corners, 6)
    ab, ac, ap = minus(b, a), minus(c, a), minus(p, a)
    d1, d2 = dot(ab, ap), dot(ac, ap)
    if d1 <= 0.0 and d2 <= 0.0:
        return a
    bp = minus(p, b)
    d3, d4 = dot(ab, bp), dot(ac, bp)
    if d3 >= 0.0 and d4 <= d3:
        return b
    vc = d1 * d4 - d3 * d2
    if vc <= 0.0 and d1 >= 0.0 and d3 <= 0.0:
        return plus(a, scaled(d1 / (d1 - d3), ab))
    cp = minus(p, c)
    d5, d6 = dot(ab, cp), dot(ac, cp)
    if d6 >= 0.0 and d5 <= d6:
        return c
    vb = d5 * d2 - d1 * d6
    if vb <= 0.0 and d2 >= 0.0 and d6 <= 0.0:
        return plus(a, scaled(d2 / (d2 - d6), ac))
    va = d3 * d6 - d5 * d4
    if va <= 0.0 and d4 - d3 >= 0.0 and d5 - d6 >= 0.0:
        return plus(b, scaled((d4 - d3) / ((d4 - d3) + (d5 - d6)), minus(c, b)))
    whole = va + vb + vc
    if not whole > 0.0:
        return a
    return plus(a, plus(scaled(vb / whole, ab), scaled(vc / whole, ac)))
