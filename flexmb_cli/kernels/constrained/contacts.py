"""Contacts of bodies in absolute coordinates: ends are placed, forces at them added, and their slopes.

The place of an end is the vector V of a primitive, from the global origin to its point.
"""

import numpy as np

from .._jit import kernel
from ..contact_sets import answer_set
from ..laws import POWER
from ..linalg.rotation import rotate
from ..linalg.vec3 import cross, dot, minus, plus, scaled, store, triple
from .body_vectors import RATE, VECTOR, Geometry, add_vector_row, geometry_of, vector
from .system import System, Work

Triple = tuple[float, float, float]


@kernel
def add_contact(
    system: System, work: Work, load: np.void, u: np.ndarray, answer: np.ndarray, f: np.ndarray
) -> float:
    """Add a contact, whose answer (16,) is filled, at the speeds u (n,) to f (n,); returns the power lost."""
    geometry, contacts = geometry_of(system, work), system.contacts
    s = contacts.sets[load["group"]]
    first, end = s["first_end"], s["first_end"] + s["ends"]
    for e in range(first, end):
        _place(geometry, contacts.ends[e], u)
    answer_set(load["c"], contacts, system.signals, load["group"], answer)
    for e in range(first, end):
        one = contacts.ends[e]
        _push(geometry, one, triple(one["force"], 0), triple(one["torque"], 0), f)
    return answer[POWER]


@kernel
def _body(geometry: Geometry, end: np.void) -> int:
    return geometry.body_vectors[geometry.primitives[end["frame"]]["ends"][0, 0]]["body"]


@kernel
def _place(geometry: Geometry, end: np.void, u: np.ndarray) -> None:
    """Fill place, axes and speeds of an end at the speeds u (n,)."""
    body, k = _body(geometry, end), end["frame"]
    store(vector(geometry.relative_vectors[VECTOR, k], 0), end["position"], 0)
    store(vector(geometry.relative_vectors[RATE, k], 0), end["velocity"], 0)
    if body >= 0:
        for i in range(3):
            for axis in range(3):
                end["axes"][3 * i + axis] = geometry.axes[body, axis, i]
        store(_spin(geometry, body, u), end["angular"], 0)


@kernel
def _spin(geometry: Geometry, body: int, u: np.ndarray) -> Triple:
    """Angular velocity of a body in global axes by the speeds u."""
    if body < 0:
        return (0.0, 0.0, 0.0)
    k = 6 * body + 3
    return rotate(geometry.axes, body, (u[k], u[k + 1], u[k + 2]))


@kernel
def _push(geometry: Geometry, end: np.void, force: Triple, torque: Triple, f: np.ndarray) -> None:
    """Add to f a force at an end, and a torque."""
    body = _body(geometry, end)
    if body >= 0:
        add_vector_row(geometry, geometry.primitives[end["frame"]]["ends"][0, 0], force, 1.0, True, f)
        axes = geometry.axes[body]
        for i in range(3):
            f[6 * body + 3 + i] += axes[0, i] * torque[0] + axes[1, i] * torque[1] + axes[2, i] * torque[2]


@kernel
def add_contact_slope(
    system: System,
    work: Work,
    load: np.void,
    by_position: float,
    by_speed: float,
    x: np.ndarray,
    y: np.ndarray,
) -> None:
    """y (n,) += (by_position K + by_speed D) x of a contact, after body vectors have been moved by x (n,)."""
    geometry, contacts = geometry_of(system, work), system.contacts
    s = contacts.sets[load["group"]]
    for k in range(s["first"], s["first"] + s["count"]):
        touch = contacts.touches[k]
        if touch["effort"] != 0.0:
            i, j = contacts.ends[touch["end_i"]], contacts.ends[touch["end_j"]]
            arm_i, arm_j = triple(touch["arm_i"], 0), triple(touch["arm_j"], 0)
            v = minus(_moved(geometry, j, arm_j, x), _moved(geometry, i, arm_i, x))
            force = _slope_force(touch, v, by_position, by_speed)
            _push(geometry, j, force, cross(arm_j, force), y)
            back = scaled(-1.0, force)
            _push(geometry, i, back, cross(arm_i, back), y)


@kernel
def _moved(geometry: Geometry, end: np.void, arm: Triple, x: np.ndarray) -> Triple:
    """Rate, by the speeds x, of the point of a body at the arm from an end."""
    rate = vector(geometry.relative_vectors[RATE, end["frame"]], 0)
    return plus(rate, cross(_spin(geometry, _body(geometry, end), x), arm))


@kernel
def _slope_force(touch: np.void, v: Triple, by_position: float, by_speed: float) -> Triple:
    n, along = triple(touch["normal"], 0), triple(touch["along"], 0)
    across = cross(n, along)
    stiffness = by_position * touch["stiffness"] + by_speed * touch["damping"]
    force = scaled(stiffness * dot(n, v), n)
    hold = by_position * touch["hold"]
    force = plus(force, scaled((hold + by_speed * touch["slope_along"]) * dot(along, v), along))
    return plus(force, scaled((hold + by_speed * touch["slope_across"]) * dot(across, v), across))
