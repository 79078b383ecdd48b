"""Vectors of three and rotations in plain arithmetic.

numpy hands products of matrices to BLAS, whose last digits depend on the processor; what goes into
the kernels as data must not.
"""

import math
from typing import Any

import numpy as np

Vector = tuple[float, float, float]


def dot(a: Any, b: np.ndarray | tuple[float, float, float]) -> float:
    """Scalar product."""
    return float(a[0] * b[0] + a[1] * b[1] + a[2] * b[2])


def cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Vector product."""
    return np.array([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


def cross_rows(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Vector products along the last axis, with the digits of `np.cross`, which takes three times as long."""
    a0, a1, a2 = a[..., 0], a[..., 1], a[..., 2]
    b0, b1, b2 = b[..., 0], b[..., 1], b[..., 2]
    product = np.empty(np.broadcast_shapes(a.shape, b.shape))
    product[..., 0] = a1 * b2 - a2 * b1
    product[..., 1] = a2 * b0 - a0 * b2
    product[..., 2] = a0 * b1 - a1 * b0
    return product


def global_axes(p: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Vectors v (…, 3) in axes of bodies with Euler parameters p (…, 4), in global axes."""
    e0, e = p[..., :1], p[..., 1:]
    return v + 2.0 * cross_rows(e, cross_rows(e, v) + e0 * v)


def length(v: Any) -> float:
    """Euclidean length of a vector of any size."""
    return math.sqrt(sum(float(x) * float(x) for x in v))


def unit(v: Any) -> np.ndarray:
    """The vector of length one along v, which is not zero."""
    v = np.asarray(v, dtype=float)
    v = v / np.max(np.abs(v))  # squares of very long or short vectors leave the range of doubles
    return v / length(v)


def rotation_matrix(p: np.ndarray | tuple[float, float, float, float]) -> np.ndarray:
    """A (3, 3) of Young (1996), eq. (3.17), body to global axes, for p of any length but zero."""
    e0, e1, e2, e3 = unit(p)
    return 2.0 * np.array(
        [
            [e0 * e0 + e1 * e1 - 0.5, e1 * e2 - e0 * e3, e1 * e3 + e0 * e2],
            [e1 * e2 + e0 * e3, e0 * e0 + e2 * e2 - 0.5, e2 * e3 - e0 * e1],
            [e1 * e3 - e0 * e2, e2 * e3 + e0 * e1, e0 * e0 + e3 * e3 - 0.5],
        ]
    )


def rotated(A: np.ndarray, v: np.ndarray | tuple[float, float, float]) -> np.ndarray:
    """A v."""
    return np.array([dot(row, v) for row in A])


def euler_parameters(A: np.ndarray) -> np.ndarray:
    """Euler parameters (4,) of a rotation matrix, e0 not negative; from the largest of the four squares."""
    trace = np.trace(A)
    squares = np.array([1 + trace, *(1 + 2 * np.diag(A) - trace)]) / 4
    k = int(np.argmax(squares))
    skew = np.array([A[2, 1] - A[1, 2], A[0, 2] - A[2, 0], A[1, 0] - A[0, 1]])
    p = np.empty(4)
    if k == 0:
        p[0], p[1:] = 4 * squares[0], skew
    else:
        i = k - 1
        p[0] = skew[i]
        p[1:] = A[i] + A[:, i]
        p[k] = 4 * squares[k]
    p /= np.linalg.norm(p)
    return -p if p[0] < 0 else p
