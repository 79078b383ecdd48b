"""Euler parameters: rotation matrices, their rates, and rows of their Jacobian.

Young (1996), chapter 3: G (3.24), L (3.25).  A = G Lᵀ (3.26) is used as it stands, a quadratic form in p, not
in the form (3.16), which equals it only for |p| = 1: so 2 G s̄' (4.9) is the exact derivative of A s' for
any p, and 2 Ġ L̇ᵀ s' the exact remainder of its second time derivative.

q (7 bodies,) holds seven coordinates a body: x, y, z (m), e0, e1, e2, e3; qd (7 bodies,) their rates.
Vectors in global axes travel as triples (x, y, z), vectors in body axes, as s (3,), as arrays of three.
"""

import math
from typing import Any

import numpy as np

from .._jit import kernel

# Rows of rotations (3, bodies, 3, 3): the matrix A, its rate, and its second derivative but for what q̈ adds.
A, RATE, REMAINDER = 0, 1, 2
TURN = 2.0 * math.pi


@kernel
def dot(a: np.ndarray, b: tuple[float, float, float]) -> Any:
    """Return the scalar product of two vectors, a (3,) and the triple b."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@kernel
def rotate(
    A: np.ndarray, body: int, s: np.ndarray | tuple[float, float, float]
) -> tuple[float, float, float]:
    """Return A s in global axes for one of the matrices A (bodies, 3, 3) and s (3,), body axes."""
    return (
        A[body, 0, 0] * s[0] + A[body, 0, 1] * s[1] + A[body, 0, 2] * s[2],
        A[body, 1, 0] * s[0] + A[body, 1, 1] * s[1] + A[body, 1, 2] * s[2],
        A[body, 2, 0] * s[0] + A[body, 2, 1] * s[1] + A[body, 2, 2] * s[2],
    )


@kernel
def _quadratic(e0: float, e1: float, e2: float, e3: float, factor: float, out: np.ndarray) -> None:
    """Fill out (3, 3) with factor · G(p) L(p)ᵀ, eq. (3.26)."""
    f2 = 2.0 * factor
    out[0, 0] = factor * (e0 * e0 + e1 * e1 - e2 * e2 - e3 * e3)
    out[1, 1] = factor * (e0 * e0 - e1 * e1 + e2 * e2 - e3 * e3)
    out[2, 2] = factor * (e0 * e0 - e1 * e1 - e2 * e2 + e3 * e3)
    out[0, 1] = f2 * (e1 * e2 - e0 * e3)
    out[1, 0] = f2 * (e1 * e2 + e0 * e3)
    out[0, 2] = f2 * (e1 * e3 + e0 * e2)
    out[2, 0] = f2 * (e1 * e3 - e0 * e2)
    out[1, 2] = f2 * (e2 * e3 - e0 * e1)
    out[2, 1] = f2 * (e2 * e3 + e0 * e1)


@kernel
def rotation_matrices(q: np.ndarray, A: np.ndarray) -> None:
    """Fill A (bodies, 3, 3), body to global axes, eq. (3.26)."""
    for body in range(A.shape[0]):
        k = 7 * body + 3
        _quadratic(q[k], q[k + 1], q[k + 2], q[k + 3], 1.0, A[body])


@kernel
def rotation_rates(q: np.ndarray, qd: np.ndarray, Ad: np.ndarray, Add: np.ndarray) -> None:
    """Fill Ad (bodies, 3, 3) with dA/dt = 2 Ġ Lᵀ (3.27), 1/s, and Add (bodies, 3, 3) with 2 Ġ L̇ᵀ, the part
    of (3.28) without p̈, 1/s².
    """
    for body in range(Ad.shape[0]):
        k = 7 * body + 3
        e0, e1, e2, e3 = q[k], q[k + 1], q[k + 2], q[k + 3]
        d0, d1, d2, d3 = qd[k], qd[k + 1], qd[k + 2], qd[k + 3]
        rate = Ad[body]
        rate[0, 0] = 2.0 * (e0 * d0 + e1 * d1 - e2 * d2 - e3 * d3)
        rate[1, 1] = 2.0 * (e0 * d0 - e1 * d1 + e2 * d2 - e3 * d3)
        rate[2, 2] = 2.0 * (e0 * d0 - e1 * d1 - e2 * d2 + e3 * d3)
        rate[0, 1] = 2.0 * (e1 * d2 + d1 * e2 - e0 * d3 - d0 * e3)
        rate[1, 0] = 2.0 * (e1 * d2 + d1 * e2 + e0 * d3 + d0 * e3)
        rate[0, 2] = 2.0 * (e1 * d3 + d1 * e3 + e0 * d2 + d0 * e2)
        rate[2, 0] = 2.0 * (e1 * d3 + d1 * e3 - e0 * d2 - d0 * e2)
        rate[1, 2] = 2.0 * (e2 * d3 + d2 * e3 - e0 * d1 - d0 * e1)
        rate[2, 1] = 2.0 * (e2 * d3 + d2 * e3 + e0 * d1 + d0 * e1)
        _quadratic(d0, d1, d2, d3, 2.0, Add[body])


@kernel
def add_rotation_row(
    q: np.ndarray,
    body: int,
    s: np.ndarray | tuple[float, float, float],
    w: tuple[float, float, float],
    row: np.ndarray,
    first: int,
) -> None:
    """Add wᵀ · 2 G s̄' (4.9), the derivative of w · A s with respect to p, to row[first:first+4].

    s (3,) in body axes, w in global axes, held fixed; row (k,): a row of the Jacobian.
    """
    k = 7 * body + 3
    e0, e1, e2, e3 = q[k], q[k + 1], q[k + 2], q[k + 3]
    ws = w[0] * s[0] + w[1] * s[1] + w[2] * s[2]
    es = e1 * s[0] + e2 * s[1] + e3 * s[2]
    we = w[0] * e1 + w[1] * e2 + w[2] * e3
    # c = s × w, so that w · (e × s) = e · c
    c0 = s[1] * w[2] - s[2] * w[1]
    c1 = s[2] * w[0] - s[0] * w[2]
    c2 = s[0] * w[1] - s[1] * w[0]
    row[first] += 2.0 * (e0 * ws + e1 * c0 + e2 * c1 + e3 * c2)
    row[first + 1] += 2.0 * (es * w[0] + we * s[0] - ws * e1 + e0 * c0)
    row[first + 2] += 2.0 * (es * w[1] + we * s[1] - ws * e2 + e0 * c1)
    row[first + 3] += 2.0 * (es * w[2] + we * s[2] - ws * e3 + e0 * c2)
