"""Mass, centre and inertia of homogeneous solids, and of bodies with several of them.

Primitives have the closed forms of handbooks (a frustum of a cone by integration along its axis); a closed
surface of triangles is a sum of tetrahedra with signed volumes (Tonon, Journal of Mathematics and Statistics
1, 2005, 8-11).
"""

import math
from collections.abc import Iterable

import numpy as np

from ..model.fe_model import RigidMass
from ..model.mechanism import Vector
from ..model.shapes import BOX, CONE, CYLINDER, SPHERE, TUBE

LEAST_VOLUME = 1e-12  # of the cube of the size: a surface of less volume encloses none


def point_mass(mass: float, centre: Vector) -> RigidMass:
    """Return the properties of a point, kg, m."""
    return RigidMass(mass, centre, np.zeros((3, 3)))


def primitive_mass(kind: str, sizes: Vector) -> RigidMass:
    """Return the properties of a primitive of density 1 in its own axes; sizes as in `model.shapes`, m."""
    a, b, c = sizes
    if kind == BOX:
        m, squares = a * b * c, np.array([b * b + c * c, a * a + c * c, a * a + b * b])
        return RigidMass(m, (0.0, 0.0, 0.0), np.diag(m * squares / 12.0))
    if kind == SPHERE:
        m = 4.0 / 3.0 * math.pi * a**3
        return RigidMass(m, (0.0, 0.0, 0.0), 0.4 * m * a * a * np.eye(3))
    if kind in (CYLINDER, TUBE):
        m, square = math.pi * (a * a - c * c) * b, a * a + c * c
        across = m * (3.0 * square + b * b) / 12.0
        return RigidMass(m, (0.0, 0.0, 0.0), np.diag([across, across, 0.5 * m * square]))
    assert kind == CONE, kind
    return _frustum(a, b, c)


def _frustum(a: float, h: float, c: float) -> RigidMass:
    """Return the properties of a frustum with radius a at -h/2 and c at h/2, its axis being z."""
    slope = c - a
    m = math.pi * h / 3.0 * (a * a + a * c + c * c)
    # Moments of the radius a + slope s over the height h s from the lower end.
    first = math.pi * h**2 * (a * a / 2 + 2 * a * slope / 3 + slope**2 / 4)
    second = math.pi * h**3 * (a * a / 3 + 2 * a * slope / 4 + slope**2 / 5)
    along = math.pi * h / 10.0 * (a**4 + a**3 * c + a * a * c * c + a * c**3 + c**4)
    z = first / m
    across = 0.5 * along + second - m * z * z
    return RigidMass(m, (0.0, 0.0, z - h / 2), np.diag([across, across, along]))


def surface_fault(vertices: np.ndarray, triangles: np.ndarray) -> str:
    """Return why a surface encloses no solid, "" where it does.

    vertices (n, 3), m; triangles (m, 3) of rows of them, anticlockwise from outside.
    """
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    count = len(vertices)
    there, back = edges[:, 0] * count + edges[:, 1], edges[:, 1] * count + edges[:, 0]
    single = np.setdiff1d(there, back)
    if len(single):
        x, y, z = vertices[single[0] // count]
        where = f"one at ({x:g}, {y:g}, {z:g})"
        return f"is not closed: {len(single)} edges have a triangle on one side only, {where}"
    if len(np.unique(there)) < len(there):
        return "has edges with more than two triangles, or triangles that face opposite ways"
    size = float(np.ptp(vertices, axis=0).max())
    volume = polyhedron_mass(vertices, triangles).mass
    if volume < -LEAST_VOLUME * size**3:
        return "is inside out: its triangles are clockwise from outside; turn its normals"
    return "" if volume > LEAST_VOLUME * size**3 else "encloses no volume"


def polyhedron_mass(vertices: np.ndarray, triangles: np.ndarray) -> RigidMass:
    """Return the properties of the solid in a closed surface, density 1, in the axes of the vertices."""
    middle = vertices.mean(axis=0)
    corners = (vertices - middle)[triangles]
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    six = np.einsum("ni,ni->n", a, np.cross(b, c))  # six times the volumes
    m = float(six.sum()) / 6.0
    if m == 0.0:
        return point_mass(0.0, (0.0, 0.0, 0.0))
    whole = a + b + c
    centre = (six @ whole) / (24.0 * m)
    products = sum(np.einsum("n,ni,nj->ij", six, s, s) for s in (a, b, c, whole)) / 120.0
    products -= m * np.outer(centre, centre)
    x, y, z = (centre + middle).tolist()
    return RigidMass(m, (x, y, z), np.trace(products) * np.eye(3) - products)


def of_mass(solid: RigidMass, factor: float) -> RigidMass:
    """Return a solid of another density."""
    return RigidMass(factor * solid.mass, solid.centre, factor * solid.inertia)


def placed(solid: RigidMass, offset: Vector, angles: Vector) -> RigidMass:
    """Return a solid turned by the angles about the fixed axes x, y, z in turn, rad, then shifted, m."""
    axes = _turning(angles)
    x, y, z = (axes @ np.array(solid.centre) + offset).tolist()
    return RigidMass(solid.mass, (x, y, z), axes @ solid.inertia @ axes.T)


def _turning(angles: Vector) -> np.ndarray:
    """Return the rotation matrix (3, 3) of angles about the fixed axes x, y, z in turn, to round-off."""
    (cx, sx), (cy, sy), (cz, sz) = ((math.cos(angle), math.sin(angle)) for angle in angles)
    about_x = np.array([[1.0, 0.0, 0.0], [0.0, cx, -sx], [0.0, sx, cx]])
    about_y = np.array([[cy, 0.0, sy], [0.0, 1.0, 0.0], [-sy, 0.0, cy]])
    about_z = np.array([[cz, -sz, 0.0], [sz, cz, 0.0], [0.0, 0.0, 1.0]])
    return about_z @ about_y @ about_x


def combined(solids: Iterable[RigidMass]) -> RigidMass:
    """Return the properties of solids together, by the parallel-axis theorem."""
    parts = list(solids)
    m = sum(part.mass for part in parts)
    centre = sum(part.mass * np.array(part.centre) for part in parts) / m if m > 0 else np.zeros(3)
    inertia = np.zeros((3, 3))
    for part in parts:
        inertia += part.inertia + about(part.mass, np.array(part.centre) - centre)
    x, y, z = np.asarray(centre).tolist()
    return RigidMass(float(m), (x, y, z), inertia)


def about(mass: float, arm: np.ndarray) -> np.ndarray:
    """Return the inertia (3, 3) of a point, kg, at an arm (3,), m, about the arm's origin."""
    return mass * (float(arm @ arm) * np.eye(3) - np.outer(arm, arm))
