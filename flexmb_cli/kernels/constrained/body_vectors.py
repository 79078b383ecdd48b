"""Vectors fixed to bodies, c + S η in body axes, as vectors in global axes with rate and remainder of
acceleration.

Vlasenko and Kasper (2008), (7)-(9), (28): with s = c + S η and A the body's rotation,

    body vector = A s,   rate = A (ω~ s + S η̇),   rest = A (ω~ ω~ s + 2 ω~ S η̇),

`rest` the second derivative without those of the coordinates; the body vectors of the ground (body -1) rest.
What turns with a node by the rotation vector θ = T η adds (exp(θ~) - 1) d to s.  Relative vectors are the
vectors V and W of the primitives: a body vector, or the point at the end of one less that of another.
"""

from typing import Any, NamedTuple

import numpy as np

from .._jit import kernel, plain
from ..linalg.rotation import RATE, REMAINDER, A, rotate
from ..linalg.rotation_vectors import spin, spin_remainder, turned
from ..linalg.vec3 import cross
from .system import System, Work

VECTOR = 0  # row of the vectors themselves, before those of RATE and REMAINDER
TURN = 3  # row of the rotation vectors θ of those that turn with a node, rad, body axes


class Geometry(NamedTuple):
    """Arrays of a System and its Work that body vectors and primitives need.

    A kernel called for every body vector pays for every array that it is handed.
    """

    body_vectors: np.ndarray  # BODY_VECTOR records
    shapes: np.ndarray  # their shapes S (3, N), flat, m or 1 per unit of η
    primitives: np.ndarray  # PRIMITIVE records
    axes: np.ndarray  # (b, 3, 3) A of every body, body to global axes
    placed: np.ndarray  # (4, body vectors, 3) `Work.body_vectors`, global axes, m
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
    body_vector: np.void, at: int, shapes: np.ndarray, x: np.ndarray, first: int
) -> tuple[float, float, float]:
    """S x (3,) of one body vector for the modal coordinates or rates that begin at x[first], S at `at`."""
    N = body_vector["modes"]
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
        c, d = body_vector["c"], _deformed(body_vector, body_vector["shape"], geometry.shapes, q, first)
        s = (c[0] + d[0], c[1] + d[1], c[2] + d[2])
        if body_vector["turn"] >= 0:
            theta = _deformed(body_vector, body_vector["turn"], geometry.shapes, q, first)
            arm = vector(geometry.body_vectors["arm"], p)
            end = turned(theta, arm)
            s = (s[0] + end[0] - arm[0], s[1] + end[1] - arm[1], s[2] + end[2] - arm[2])
            for i in range(3):
                geometry.placed[TURN, p, i] = theta[i]
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
        d = _deformed(body_vector, body_vector["shape"], geometry.shapes, u, first)
        more = (0.0, 0.0, 0.0)
        if body_vector["turn"] >= 0:
            arm_rate, more = _arm_motion(geometry, p, u, first)
            d = (d[0] + arm_rate[0], d[1] + arm_rate[1], d[2] + arm_rate[2])
            more = rotate(geometry.axes, b, more)
        d = rotate(geometry.axes, b, d)
        swept = cross(w, s)
        rest = cross(w, (swept[0] + 2.0 * d[0], swept[1] + 2.0 * d[1], swept[2] + 2.0 * d[2]))
        for i in range(3):
            geometry.placed[RATE, p, i] = swept[i] + d[i]
            geometry.placed[REMAINDER, p, i] = rest[i] + more[i]
    _fill_relative_vectors(geometry, RATE, u, 6)
    _fill_relative_vectors(geometry, REMAINDER, u, 0)


@kernel
def vector(rows: np.ndarray, k: int) -> Any:
    """Row k of rows (k, 3) as a triple."""
    return rows[k, 0], rows[k, 1], rows[k, 2]


@kernel
def _arm_motion(
    geometry: Geometry, p: int, u: np.ndarray, first: int
) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
    """Rate, and remainder of the second derivative, of what turns with a node, body axes."""
    record, theta = geometry.body_vectors[p], vector(geometry.placed[TURN], p)
    end = turned(theta, vector(geometry.body_vectors["arm"], p))
    rate = _deformed(record, record["turn"], geometry.shapes, u, first)
    w = spin(theta, rate, 1.0)
    swept = cross(w, end)
    by_spin, by_rest = cross(w, swept), cross(spin_remainder(theta, rate), end)
    return swept, (by_spin[0] + by_rest[0], by_spin[1] + by_rest[1], by_spin[2] + by_rest[2])


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
        along = axes[0, i] * g[0] + axes[1, i] * g[1] + axes[2, i] * g[2]
        for mode in range(N):
            row[first + mode] += geometry.shapes[at + i * N + mode] * along
    if body_vector["turn"] >= 0:
        arm = turned(vector(geometry.placed[TURN], p), vector(geometry.body_vectors["arm"], p))
        add_turn_row(geometry, p, cross(arm, in_body_axes(axes, g)), row)


@kernel
def in_body_axes(axes: np.ndarray, g: tuple[float, float, float]) -> tuple[float, float, float]:
    """Aᵀ g; axes (3, 3): A."""
    return (
        axes[0, 0] * g[0] + axes[1, 0] * g[1] + axes[2, 0] * g[2],
        axes[0, 1] * g[0] + axes[1, 1] * g[1] + axes[2, 1] * g[2],
        axes[0, 2] * g[0] + axes[1, 2] * g[1] + axes[2, 2] * g[2],
    )


@kernel
def add_turn_row(geometry: Geometry, p: int, torque: tuple[float, float, float], row: np.ndarray) -> None:
    """Add to row (n,) what a torque, body axes, does on the rotation of the node of body vector p."""
    record = geometry.body_vectors[p]
    N, at, first = record["modes"], record["turn"], 6 * geometry.axes.shape[0] + record["first"]
    work = spin(vector(geometry.placed[TURN], p), torque, -1.0)
    for i in range(3):
        for mode in range(N):
            row[first + mode] += geometry.shapes[at + i * N + mode] * work[i]
