"""Vectors fixed to bodies, c + S η in body axes, as vectors in global axes with rate and remainder of
acceleration.

Vlasenko and Kasper (2008), (7)-(9), (28): with s = c + S η and A the body's rotation,

    body vector = A s,   rate = A (ω~ s + S η̇),   rest = A (ω~ ω~ s + 2 ω~ S η̇),

`rest` the second derivative without those of the coordinates; the body vectors of the ground (body -1) rest.
Relative vectors are the vectors V and W of the primitives: a body vector, or the point at the end of one less
that of another.
"""

from typing import Any, NamedTuple

import numpy as np

from .._jit import kernel, plain
from ..linalg.rotation import RATE, REMAINDER, A, rotate
from .system import System, Work

VECTOR = 0  # row of the vectors themselves, before those of RATE and REMAINDER


class Geometry(NamedTuple):
    """Arrays of a System and its Work that body vectors and primitives need.

    A kernel called for every body vector pays for every array that it is handed.
    """

    body_vectors: np.ndarray  # BODY_VECTOR records
    shapes: np.ndarray  # their shapes S (3, N), flat, m or 1 per unit of η
    primitives: np.ndarray  # PRIMITIVE records
    axes: np.ndarray  # (b, 3, 3) A of every body, body to global axes
    placed: np.ndarray  # (3, body vectors, 3) `Work.body_vectors`, global axes, m
    relative_vectors: np.ndarray  # (3, primitives, 2, 3) V and W of the primitives, global axes, m


@plain
def geometry_of(system: System, work: Work) -> Geometry:
    """The geometry of a mechanism: views, which follow the work."""
    return Geometry(
        system.body_vectors,
        system.shapes,
        system.primitives,
        work.rotations[A],
        work.body_vectors,
        work.relative_vectors,
    )


@plain
def geometry_of_joints(system: System, work: Work) -> Geometry:
    """The geometry of the joint coordinates that are reported."""
    return Geometry(
        system.joint_vectors,
        system.shapes,
        system.joint_coordinates,
        work.rotations[A],
        work.joint_vectors,
        work.joint_ends,
    )


@kernel
def _deformed(
    body_vector: np.void, shapes: np.ndarray, x: np.ndarray, first: int
) -> tuple[float, float, float]:
    """S x (3,) of one body vector for the modal coordinates or rates that begin at x[first]."""
    N, at = body_vector["modes"], body_vector["shape"]
    s0 = s1 = s2 = 0.0
    for k in range(N):
        eta = x[first + body_vector["first"] + k]
        s0 += shapes[at + k] * eta
        s1 += shapes[at + N + k] * eta
        s2 += shapes[at + 2 * N + k] * eta
    return s0, s1, s2


@kernel
def place_vectors(geometry: Geometry, q: np.ndarray) -> None:
    """Fill body vectors and relative vectors at q, where the rotation matrices belong to q."""
    first = 7 * geometry.axes.shape[0]
    for p in range(geometry.body_vectors.shape[0]):
        body_vector = geometry.body_vectors[p]
        c, d = body_vector["c"], _deformed(body_vector, geometry.shapes, q, first)
        s = (c[0] + d[0], c[1] + d[1], c[2] + d[2])
        v = rotate(geometry.axes, body_vector["body"], s) if body_vector["body"] >= 0 else s
        for i in range(3):
            geometry.placed[VECTOR, p, i] = v[i]
    _fill_relative_vectors(geometry, VECTOR, q, 7)


@kernel
def move_vectors(geometry: Geometry, u: np.ndarray) -> None:
    """Fill rates and remainders at the speeds u, where the body vectors have been placed."""
    first = 6 * geometry.axes.shape[0]
    for p in range(geometry.body_vectors.shape[0]):
        body_vector, b = geometry.body_vectors[p], geometry.body_vectors[p]["body"]
        if b < 0:
            continue
        k = 6 * b + 3
        s = vector(geometry.placed[VECTOR], p)
        w = rotate(geometry.axes, b, (u[k], u[k + 1], u[k + 2]))
        d = rotate(geometry.axes, b, _deformed(body_vector, geometry.shapes, u, first))
        turned = cross(w, s)
        rest = cross(w, (turned[0] + 2.0 * d[0], turned[1] + 2.0 * d[1], turned[2] + 2.0 * d[2]))
        for i in range(3):
            geometry.placed[RATE, p, i] = turned[i] + d[i]
            geometry.placed[REMAINDER, p, i] = rest[i]
    _fill_relative_vectors(geometry, RATE, u, 6)
    _fill_relative_vectors(geometry, REMAINDER, u, 0)


@kernel
def vector(rows: np.ndarray, k: int) -> Any:
    """Row k of rows (k, 3) as a triple."""
    return rows[k, 0], rows[k, 1], rows[k, 2]


@kernel
def cross(a: tuple[float, float, float], b: tuple[float, float, float]) -> tuple[float, float, float]:
    """a × b."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@kernel
def _fill_relative_vectors(geometry: Geometry, layer: int, origins: np.ndarray, stride: int) -> None:
    """Fill one layer of the relative vectors; origins: q or u, of which a body has `stride` numbers, 0:
    none.
    """
    body_vectors, placed = geometry.body_vectors, geometry.placed
    for k in range(geometry.primitives.shape[0]):
        ends = geometry.primitives[k]["ends"]
        for side in range(2):
            head, tail = ends[side, 0], ends[side, 1]
            if head < 0:
                continue
            i = body_vectors[head]["body"]
            j = body_vectors[tail]["body"] if tail >= 0 else i
            for axis in range(3):
                d = placed[layer, head, axis]
                if tail >= 0:
                    d -= placed[layer, tail, axis]
                # The origin of one body would only cost digits.
                if i != j and stride > 0 and i >= 0:
                    d += origins[stride * i + axis]
                if i != j and stride > 0 and j >= 0:
                    d -= origins[stride * j + axis]
                geometry.relative_vectors[layer, k, side, axis] = d


@kernel
def add_vector_row(
    geometry: Geometry, p: int, w: tuple[float, float, float], factor: float, of_point: bool, row: np.ndarray
) -> None:
    """Add to row (n,) the derivative of factor w · x by the speeds; x: the body vector p, or the point at its
    end.
    """
    body_vector, b = geometry.body_vectors[p], geometry.body_vectors[p]["body"]
    if b < 0:
        return
    g = (factor * w[0], factor * w[1], factor * w[2])
    if of_point:
        for i in range(3):
            row[6 * b + i] += g[i]
    moment, axes = cross(vector(geometry.placed[VECTOR], p), g), geometry.axes[b]
    N, at, first = (
        body_vector["modes"],
        body_vector["shape"],
        6 * geometry.axes.shape[0] + body_vector["first"],
    )
    for i in range(3):
        row[6 * b + 3 + i] += axes[0, i] * moment[0] + axes[1, i] * moment[1] + axes[2, i] * moment[2]
        turned = axes[0, i] * g[0] + axes[1, i] * g[1] + axes[2, i] * g[2]
        for mode in range(N):
            row[first + mode] += geometry.shapes[at + i * N + mode] * turned
