"""Articulated inertia of a frame and what hangs on it: its coupling to coordinates, its share in the parent.

Featherstone's articulated bodies.  An inertia is 21 numbers, [[J, H], [Hᵀ, M]] on (al, a), ordered as in
`work`.
"""

import numpy as np

from .._jit import part
from ..linalg.vec3 import (
    accumulate,
    column,
    cross,
    dot,
    plus,
    scaled,
    store,
    symmetric,
    symmetric_times,
    triple,
)
from .work import H_, J_, M_


@part
def couple_rotation(I: np.ndarray, c: np.void) -> None:
    """Fill the coupling (6,) of a rotation: the moment and force of its unit acceleration."""
    axis = triple(c["direction"], 0)
    store(symmetric_times(symmetric(I, J_), axis), c["coupling"], 0)
    store(_transposed_H(I, axis), c["coupling"], 3)


@part
def couple_translation(I: np.ndarray, c: np.void) -> None:
    """Fill the coupling (6,) of a translation."""
    axis = triple(c["direction"], 0)
    store(_times_H(I, axis), c["coupling"], 0)
    store(symmetric_times(symmetric(I, M_), axis), c["coupling"], 3)


@part
def _times_H(I: np.ndarray, v: tuple[float, float, float]) -> tuple[float, float, float]:
    return (dot(triple(I, H_), v), dot(triple(I, H_ + 3), v), dot(triple(I, H_ + 6), v))


@part
def _transposed_H(I: np.ndarray, v: tuple[float, float, float]) -> tuple[float, float, float]:
    return (dot(column(I, H_), v), dot(column(I, H_ + 1), v), dot(column(I, H_ + 2), v))


@part
def subtract_outer(
    I: np.ndarray, n: tuple[float, float, float], f: tuple[float, float, float], c: float
) -> None:
    """I -= c U Uᵀ with U = (n, f)."""
    a = scaled(-c, n)
    b = scaled(-c, f)
    accumulate((a[0] * n[0], a[0] * n[1], a[0] * n[2]), I, J_)
    accumulate((a[1] * n[1], a[1] * n[2], a[2] * n[2]), I, J_ + 3)
    accumulate(scaled(a[0], f), I, H_)
    accumulate(scaled(a[1], f), I, H_ + 3)
    accumulate(scaled(a[2], f), I, H_ + 6)
    accumulate((b[0] * f[0], b[0] * f[1], b[0] * f[2]), I, M_)
    accumulate((b[1] * f[1], b[1] * f[2], b[2] * f[2]), I, M_ + 3)


@part
def add_to_parent(s: np.void, parent: np.void) -> None:
    """Add what is left of a frame to its parent, seen from the parent's origin."""
    I = s["inertia"]
    r = triple(s["offset"], 0)
    al, a = triple(s["remainder"], 0), triple(s["remainder"], 3)
    n = plus(symmetric_times(symmetric(I, J_), al), _times_H(I, a))
    f = plus(_transposed_H(I, al), symmetric_times(symmetric(I, M_), a))
    f = plus(f, triple(s["bias"], 3))
    accumulate(plus(n, plus(triple(s["bias"], 0), cross(r, f))), parent["bias"], 0)
    accumulate(f, parent["bias"], 3)
    _add_shifted(I, r, parent["inertia"])


@part
def _add_shifted(I: np.ndarray, r: tuple[float, float, float], out: np.ndarray) -> None:
    """Add to `out` the inertia I seen from a point that lies -r away: with R = [r x],

    M' = M, H' = H + R M, J' = J + R H'ᵀ + H Rᵀ.
    """
    m0, m1, m2 = symmetric(I, M_)
    h0, h1, h2 = triple(I, H_), triple(I, H_ + 3), triple(I, H_ + 6)
    # Columns of R M are r x (columns of M), and M is symmetric.
    c0, c1, c2 = cross(r, m0), cross(r, m1), cross(r, m2)
    s0 = plus(h0, (c0[0], c1[0], c2[0]))
    s1 = plus(h1, (c0[1], c1[1], c2[1]))
    s2 = plus(h2, (c0[2], c1[2], c2[2]))
    # Columns of R H'ᵀ are r x (rows of H'), rows of H Rᵀ are r x (rows of H).
    d0, d1, d2 = cross(r, s0), cross(r, s1), cross(r, s2)
    e0, e1, e2 = cross(r, h0), cross(r, h1), cross(r, h2)
    for i in range(6):
        out[J_ + i] += I[J_ + i]
        out[M_ + i] += I[M_ + i]
    accumulate((d0[0] + e0[0], d1[0] + e0[1], d2[0] + e0[2]), out, J_)
    accumulate((d1[1] + e1[1], d2[1] + e1[2], d2[2] + e2[2]), out, J_ + 3)
    accumulate(s0, out, H_)
    accumulate(s1, out, H_ + 3)
    accumulate(s2, out, H_ + 6)
