"""Equations of rolling between two bodies in absolute coordinates, see `kernels.rolling`.

A primitive with `roll` is one of them: V leads from the point of body b to the centre on body a, W is the
normal or axle u of b, F the direction across it, H the axle of a disc, -1 of a sphere or wheel.
"""

import numpy as np

from .._jit import kernel
from ..linalg.rotation import RATE, A
from ..linalg.vec3 import centripetal, cross, dot, minus, plus, scaled
from ..rolling import contact_advance, rolling_contact, rolling_direction
from .body_vectors import REMAINDER, VECTOR, Geometry, add_vector_row, geometry_of, vector
from .system import System, Work


@kernel
def has_rolling(primitives: np.ndarray) -> bool:
    """Return whether one of primitives (k,) is of rolling, which needs rates of rotation matrices."""
    rolling = False
    for k in range(primitives.shape[0]):
        rolling = rolling or primitives[k]["roll"] > 0
    return rolling


@kernel
def rolling_gap(system: System, work: Work, k: int) -> float:
    """Gap of primitive k, m; 0 of an equation of speeds alone."""
    m = system.primitives[k]
    if m["direction"] != 0:
        return 0.0
    u, x, d = _place(work, m, k)
    return rolling_contact(m["roll"], u, x, d, m["radius"][0], m["radius"][1])[2]


@kernel
def _place(
    work: Work, m: np.void, k: int
) -> tuple[tuple[float, float, float], tuple[float, float, float], tuple[float, float, float]]:
    """Normal or axle of b, axle of a or zeros, and V, global axes."""
    x = (0.0, 0.0, 0.0)
    if m["h"] >= 0:
        x = vector(work.body_vectors[VECTOR], m["h"])
    vectors = work.relative_vectors[VECTOR, k]
    return vector(vectors, 1), x, vector(vectors, 0)


@kernel
def _angular_velocity(work: Work, body: int) -> tuple[float, float, float]:
    """That of a body, global axes, 1/s, from dA/dt A'."""
    if body < 0:
        return 0.0, 0.0, 0.0
    axes, rates = work.rotations[A, body], work.rotations[RATE, body]
    x = y = z = 0.0
    for i in range(3):
        x += rates[2, i] * axes[1, i]
        y += rates[0, i] * axes[2, i]
        z += rates[1, i] * axes[0, i]
    return x, y, z


@kernel
def rolling_rates(system: System, work: Work, k: int) -> tuple[float, float]:
    """Relative speed along the direction of primitive k, and its derivative without accelerations."""
    m, bodies = system.primitives[k], system.body_vectors["body"]
    u, x, d = _place(work, m, k)
    n, arm, _ = rolling_contact(m["roll"], u, x, d, m["radius"][0], m["radius"][1])
    wa = _angular_velocity(work, bodies[m["ends"][0, 0]])
    wb = _angular_velocity(work, bodies[m["ends"][0, 1]])
    rate, rest = vector(work.relative_vectors[RATE, k], 0), vector(work.relative_vectors[REMAINDER, k], 0)
    across = vector(work.body_vectors[VECTOR], m["f"])
    e = rolling_direction(m["roll"], m["direction"], u, across, n)
    # The contact seen from the point of b, and speeds there.
    other = plus(d, arm)
    carried = minus(rate, cross(wb, d))
    slip = minus(plus(rate, cross(wa, arm)), cross(wb, other))
    w = minus(wa, wb)
    advance = contact_advance(m["roll"], u, x, d, m["radius"][0], m["radius"][1], w, carried)
    rest = minus(plus(rest, centripetal(wa, arm)), centripetal(wb, other))
    rest = plus(minus(rest, scaled(2.0, cross(wb, slip))), cross(w, advance))
    return dot(e, slip), dot(e, rest)


@kernel
def add_rolling_row(system: System, work: Work, k: int, factor: float, row: np.ndarray) -> None:
    """Add factor times the derivative of that speed by the speeds to row (n,)."""
    m, geometry = system.primitives[k], geometry_of(system, work)
    u, x, d = _place(work, m, k)
    n, arm, _ = rolling_contact(m["roll"], u, x, d, m["radius"][0], m["radius"][1])
    across = vector(work.body_vectors[VECTOR], m["f"])
    e = rolling_direction(m["roll"], m["direction"], u, across, n)
    head, tail = m["ends"][0, 0], m["ends"][0, 1]
    add_vector_row(geometry, head, e, factor, True, row)
    add_vector_row(geometry, tail, e, -factor, True, row)
    _add_turning(geometry, head, scaled(factor, cross(arm, e)), row)
    _add_turning(geometry, tail, scaled(-factor, cross(plus(d, arm), e)), row)


@kernel
def _add_turning(geometry: Geometry, p: int, moment: tuple[float, float, float], row: np.ndarray) -> None:
    """Add a moment on the body of vector p, global axes, to row (n,)."""
    b = geometry.body_vectors[p]["body"]
    if b < 0:
        return
    axes = geometry.axes[b]
    for i in range(3):
        row[6 * b + 3 + i] += axes[0, i] * moment[0] + axes[1, i] * moment[1] + axes[2, i] * moment[2]
