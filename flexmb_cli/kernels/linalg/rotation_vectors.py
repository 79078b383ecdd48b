"""Vectors that turn with a rotation vector θ, rad: exp(θ~) d, and its rate for θ(t).

With x = |θ|: exp(θ~) d = d + a θ × d + b θ × (θ × d), a = sin x / x, b = (1 - cos x) / x²; the angular
velocity is J θ̇ = θ̇ + b θ × θ̇ + c θ × (θ × θ̇), c = (x - sin x) / x³.
Bauchau and Trainelli, Nonlinear Dynamics 32 (2003) 71-92.  Series are exact to round-off up to three radians,
farther than linear deformations go.
"""

import math

from .._jit import kernel
from .vec3 import cross

_SERIES, _TERMS_OF_SERIES = 9.0, 16  # rad² up to which series are summed, and how many terms


@kernel
def coefficients(square: float) -> tuple[float, float, float, float]:
    """Return b, c, and their derivatives by x divided by x, for |θ|² = square."""
    if square > _SERIES:
        x = math.sqrt(square)
        b, c = (1.0 - math.cos(x)) / square, (x - math.sin(x)) / (square * x)
        return b, c, (1.0 - square * c - 2.0 * b) / square, (b - 3.0 * c) / square
    b, c, db, dc = 0.0, 0.0, 0.0, 0.0
    e, f = -1.0 / 24.0, -1.0 / 120.0
    for k in range(1, _TERMS_OF_SERIES):
        b, c, db, dc = b + e, c + f, db + k * e, dc + k * f
        e *= -square / ((2.0 * k + 3.0) * (2.0 * k + 4.0))
        f *= -square / ((2.0 * k + 4.0) * (2.0 * k + 5.0))
    return 0.5 + square * b, 1.0 / 6.0 + square * c, 2.0 * db, 2.0 * dc


@kernel
def turned(theta: tuple[float, float, float], d: tuple[float, float, float]) -> tuple[float, float, float]:
    """exp(θ~) d."""
    square = theta[0] * theta[0] + theta[1] * theta[1] + theta[2] * theta[2]
    b, c, _, _ = coefficients(square)
    a = 1.0 - square * c
    first = cross(theta, d)
    second = cross(theta, first)
    return (
        d[0] + a * first[0] + b * second[0],
        d[1] + a * first[1] + b * second[1],
        d[2] + a * first[2] + b * second[2],
    )


@kernel
def spin(
    theta: tuple[float, float, float], v: tuple[float, float, float], sign: float
) -> tuple[float, float, float]:
    """J v, sign 1, or Jᵀ v, sign -1."""
    b, c, _, _ = coefficients(theta[0] * theta[0] + theta[1] * theta[1] + theta[2] * theta[2])
    first = cross(theta, v)
    second = cross(theta, first)
    b *= sign
    return (
        v[0] + b * first[0] + c * second[0],
        v[1] + b * first[1] + c * second[1],
        v[2] + b * first[2] + c * second[2],
    )


@kernel
def spin_remainder(
    theta: tuple[float, float, float], rate: tuple[float, float, float]
) -> tuple[float, float, float]:
    """J̇ θ̇: the angular acceleration without that of θ."""
    _, c, db, dc = coefficients(theta[0] * theta[0] + theta[1] * theta[1] + theta[2] * theta[2])
    stretch = theta[0] * rate[0] + theta[1] * rate[1] + theta[2] * rate[2]
    first = cross(theta, rate)
    second, third = cross(theta, first), cross(rate, first)
    db, dc = db * stretch, dc * stretch
    return (
        db * first[0] + dc * second[0] + c * third[0],
        db * first[1] + dc * second[1] + c * third[1],
        db * first[2] + dc * second[2] + c * third[2],
    )
