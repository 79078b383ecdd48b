"""Motion of an arm that turns with the rotation vector θ of a node, in many rows at once, axes of its body.

The same formulas as `kernels.linalg.rotation_vectors`, summed here for whole columns of rows.
"""

import numpy as np

from ...model.vectors import cross_rows

_TERMS = 24  # exact up to a turn


def _coefficients(square: np.ndarray) -> tuple[np.ndarray, ...]:
    """Return b, c and their derivatives by |θ| over |θ|, for `square` (T, 1), |θ|²."""
    sums = [np.zeros_like(square) for _ in range(4)]
    e, f = np.full_like(square, -1.0 / 24.0), np.full_like(square, -1.0 / 120.0)
    for k in range(1, _TERMS):
        for total, term in zip(sums, (e, f, k * e, k * f), strict=True):
            total += term
        e = -e * square / ((2 * k + 3) * (2 * k + 4))
        f = -f * square / ((2 * k + 4) * (2 * k + 5))
    b, c, db, dc = sums
    return 0.5 + square * b, 1.0 / 6.0 + square * c, 2.0 * db, 2.0 * dc


def node_spin(theta: np.ndarray, rate: np.ndarray) -> np.ndarray:
    """Angular velocity (T, 3) of a node against its body, axes of the body; θ, rad, and its rate (T, 3)."""
    b, c, *_ = _coefficients((theta * theta).sum(axis=1, keepdims=True))
    return _spin(theta, b, c, rate)


def _spin(theta: np.ndarray, b: np.ndarray, c: np.ndarray, v: np.ndarray) -> np.ndarray:
    first = cross_rows(theta, v)
    return v + b * first + c * cross_rows(theta, first)


def arm_motion(
    arm: np.ndarray, theta: np.ndarray, rate: np.ndarray, second: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Displacement, velocity and acceleration (T, 3) of the end of `arm` (3,); θ and derivatives (T, 3)."""
    square, stretch = ((theta * x).sum(axis=1, keepdims=True) for x in (theta, rate))
    b, c, db, dc = _coefficients(square)
    across = cross_rows(theta, np.broadcast_to(arm, theta.shape))
    end = arm + (1.0 - square * c) * across + b * cross_rows(theta, across)
    swept = cross_rows(theta, rate)
    w = _spin(theta, b, c, rate)
    alpha = _spin(theta, b, c, second) + db * stretch * swept + dc * stretch * cross_rows(theta, swept)
    alpha = alpha + c * cross_rows(rate, swept)
    velocity = cross_rows(w, end)
    return end - arm, velocity, cross_rows(w, velocity) + cross_rows(alpha, end)
