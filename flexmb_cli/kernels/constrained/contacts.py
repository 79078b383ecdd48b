"""Contacts of bodies in absolute coordinates: forces at the place of contact, and their slopes."""

import numpy as np

from .._jit import kernel
from ..contact import PLACE, answer_contact
from ..laws import DAMPING, EFFORT, POWER, STIFFNESS
from ..linalg.rotation import rotate
from ..linalg.vec3 import cross, dot, minus, plus, scaled, store, triple
from .body_vectors import RATE, VECTOR, Geometry, add_vector_row, vector

Triple = tuple[float, float, float]


@kernel
def add_contact(geometry: Geometry, load: np.void, u: np.ndarray, answer: np.ndarray, f: np.ndarray) -> float:
    """Add a contact, whose answer (21,) is filled, at the speeds u (n,) to f (n,); returns the power lost."""
    k, b_i, b_j = load["primitive"], _body(geometry, load, 1), _body(geometry, load, 0)
    d, v = (vector(geometry.relative_vectors[VECTOR, k], 0), vector(geometry.relative_vectors[RATE, k], 0))
    w_i, w_j = _spin(geometry, b_i, u), _spin(geometry, b_j, u)
    answer_contact(load, d, v, _axes(geometry, b_i), w_i, _axes(geometry, b_j), w_j, answer)
    point_j = vector(geometry.relative_vectors[VECTOR, load["stroke"]], 0)
    store(plus(point_j, triple(load["arm_j"], 0)), answer, PLACE)
    N = answer[EFFORT]
    force, torque = scaled(N, triple(load["push"], 0)), scaled(N, triple(load["roll"], 0))
    _push(geometry, load, force, torque, f)
    return answer[POWER]


@kernel
def _body(geometry: Geometry, load: np.void, side: int) -> int:
    return geometry.body_vectors[geometry.primitives[load["primitive"]]["ends"][0, side]]["body"]


@kernel
def _axes(geometry: Geometry, body: int) -> tuple[Triple, Triple, Triple]:
    if body < 0:
        return (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
    a = geometry.axes[body]
    return (a[0, 0], a[1, 0], a[2, 0]), (a[0, 1], a[1, 1], a[2, 1]), (a[0, 2], a[1, 2], a[2, 2])


@kernel
def _spin(geometry: Geometry, body: int, u: np.ndarray) -> Triple:
    """Angular velocity of a body in global axes by the speeds u."""
    if body < 0:
        return (0.0, 0.0, 0.0)
    k = 6 * body + 3
    return rotate(geometry.axes, body, (u[k], u[k + 1], u[k + 2]))


@kernel
def _push(geometry: Geometry, load: np.void, force: Triple, torque: Triple, f: np.ndarray) -> None:
    """Add to f a force on body j at the place of contact and a torque, and their opposites on body i."""
    ends = geometry.primitives[load["primitive"]]["ends"]
    for side, arm, sign in ((0, triple(load["arm_j"], 0), 1.0), (1, triple(load["arm_i"], 0), -1.0)):
        body = _body(geometry, load, side)
        if body >= 0:
            add_vector_row(geometry, ends[0, side], force, sign, True, f)
            moment, axes = plus(torque, cross(arm, force)), geometry.axes[body]
            for i in range(3):
                turned = axes[0, i] * moment[0] + axes[1, i] * moment[1] + axes[2, i] * moment[2]
                f[6 * body + 3 + i] += sign * turned


@kernel
def add_contact_slope(
    geometry: Geometry,
    load: np.void,
    answer: np.ndarray,
    by_position: float,
    by_speed: float,
    x: np.ndarray,
    y: np.ndarray,
) -> None:
    """y (n,) += (by_position K + by_speed D) x of a contact with an answer (21,), after body vectors have
    been moved by x (n,).
    """
    if answer[EFFORT] == 0.0:
        return
    v, n = vector(geometry.relative_vectors[RATE, load["primitive"]], 0), triple(load["normal"], 0)
    v = plus(v, cross(_spin(geometry, _body(geometry, load, 0), x), triple(load["arm_j"], 0)))
    v = minus(v, cross(_spin(geometry, _body(geometry, load, 1), x), triple(load["arm_i"], 0)))
    along = triple(load["along"], 0)
    across = cross(n, along)
    force = scaled((by_position * answer[STIFFNESS] + by_speed * answer[DAMPING]) * dot(n, v), n)
    force = plus(force, scaled(by_speed * load["slope_along"] * dot(along, v), along))
    force = plus(force, scaled(by_speed * load["slope_across"] * dot(across, v), across))
    _push(geometry, load, force, (0.0, 0.0, 0.0), y)
