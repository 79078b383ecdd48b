"""Vectors as triples (x, y, z), which the compiler keeps in registers.

Axes of a frame are nine numbers A (9,), row by row: A[3 i + j]; A v turns a vector from the frame's axes
to inertial ones.  Symmetric matrices are six numbers xx xy xz yy yz zz.  a (k,) is a row of numbers of any
length and unit of which three, or six, from `first` on are a vector, or a symmetric matrix.
"""

from typing import Any

import numpy as np

from .._jit import part


@part
def triple(a: np.ndarray, first: int) -> tuple[float, float, float]:
    """Return three places of a (k,) from `first` on."""
    return (a[first], a[first + 1], a[first + 2])


@part
def store(v: tuple[float, float, float], a: np.ndarray, first: int) -> Any:
    """Set three places of a (k,) from `first` on to v."""
    a[first] = v[0]
    a[first + 1] = v[1]
    a[first + 2] = v[2]


@part
def accumulate(v: tuple[float, float, float], a: np.ndarray, first: int) -> None:
    """Add v to three places of a (k,) from `first` on."""
    a[first] += v[0]
    a[first + 1] += v[1]
    a[first + 2] += v[2]


@part
def plus(a: tuple[float, float, float], b: tuple[float, float, float]) -> tuple[float, float, float]:
    """Return a + b."""
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


@part
def minus(a: tuple[float, float, float], b: tuple[float, float, float]) -> tuple[float, float, float]:
    """Return a - b."""
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


@part
def scaled(c: float, a: tuple[float, float, float]) -> tuple[float, float, float]:
    """Return c a."""
    return (c * a[0], c * a[1], c * a[2])


@part
def dot(a: np.ndarray, b: tuple[float, float, float]) -> Any:
    """Return the scalar product a · b; a (3,) may be an array."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@part
def cross(a: tuple[float, float, float], b: tuple[float, float, float]) -> tuple[float, float, float]:
    """Return the vector product a × b."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


@part
def centripetal(w: tuple[float, float, float], r: tuple[float, float, float]) -> tuple[float, float, float]:
    """Return w × (w × r)."""
    along = dot(w, r)
    square = dot(w, w)
    return (along * w[0] - square * r[0], along * w[1] - square * r[1], along * w[2] - square * r[2])


@part
def outward(A: np.ndarray, v: tuple[float, float, float]) -> tuple[float, float, float]:
    """Return A v: v (3,) from the frame's axes, A (9,), to inertial ones."""
    return (
        A[0] * v[0] + A[1] * v[1] + A[2] * v[2],
        A[3] * v[0] + A[4] * v[1] + A[5] * v[2],
        A[6] * v[0] + A[7] * v[1] + A[8] * v[2],
    )


@part
def inward(A: np.ndarray, v: tuple[float, float, float]) -> tuple[float, float, float]:
    """Return Aᵀ v: v (3,) from inertial axes to the frame's, A (9,)."""
    return (
        A[0] * v[0] + A[3] * v[1] + A[6] * v[2],
        A[1] * v[0] + A[4] * v[1] + A[7] * v[2],
        A[2] * v[0] + A[5] * v[1] + A[8] * v[2],
    )


@part
def column(A: np.ndarray, axis: int) -> tuple[float, float, float]:
    """Return unit vector `axis`, 0 to 2, of the frame with axes A (9,), in inertial axes."""
    return (A[axis], A[3 + axis], A[6 + axis])


@part
def symmetric_times(
    J: tuple[tuple[float, float, float], tuple[float, float, float], tuple[float, float, float]],
    v: tuple[float, float, float],
) -> tuple[float, float, float]:
    """Return J v for a triple of rows J (3, 3), see `symmetric`."""
    return (dot(J[0], v), dot(J[1], v), dot(J[2], v))


@part
def symmetric(
    a: np.ndarray, first: int
) -> tuple[tuple[float, float, float], tuple[float, float, float], tuple[float, float, float]]:
    """Return the three rows of a symmetric matrix whose six numbers in a (k,) begin at `first`."""
    xy, xz, yz = a[first + 1], a[first + 2], a[first + 4]
    return ((a[first], xy, xz), (xy, a[first + 3], yz), (xz, yz, a[first + 5]))
