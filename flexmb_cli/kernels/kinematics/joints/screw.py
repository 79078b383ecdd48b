"""Screw (helical) joint: a cylindrical joint whose slide follows its turn, δ - δ0 = α (θ - θ0).

Young (1996), section 4.2.6, eqs (4.40)-(4.56), with other measures of slide and turn: the source's
|d| has a corner at d = 0, and its arc cosine loses the angle at sin θ = 0 and beyond half a turn.

δ = σ û · d along the unit axis û of body i, σ = ±1 constant.  θ is the angle from h_i to h_j about
û: with f and g = û × f the unit vectors across the axis fixed to body i, x = f · h_j and
y = g · h_j, θ = atan2(y, x) plus the whole turns that bring it next to `expected`, the angle expected.
"""

import math

import numpy as np

from ..._jit import allocating, kernel
from ...linalg.rotation import TURN, add_rotation_row, rotate
from ..joint_primitives import (
    n1_acceleration,
    n1_jacobian,
    n1_residual,
    n2_acceleration,
    n2_jacobian,
    n2_residual,
)
from . import cylindrical

EQUATIONS = 5


@kernel
def angle(c: np.void, A: np.ndarray, expected: float) -> float:
    """θ in rad, the value nearest to `expected`; any number of turns."""
    theta = math.atan2(n1_residual(c, c["g_i"], c["h_j"], A), n1_residual(c, c["h_i"], c["h_j"], A))
    return theta + TURN * math.floor((expected - theta) / TURN + 0.5)


@kernel
def angle_rates(c: np.void, rotations: np.ndarray, xdd: float, ydd: float) -> tuple[float, float]:
    """dθ/dt and d²θ/dt² for given second derivatives of x and y."""
    A, Ad = rotations[0], rotations[1]
    x, y = n1_residual(c, c["h_i"], c["h_j"], A), n1_residual(c, c["g_i"], c["h_j"], A)
    xd, yd = _n1_rate(c, c["h_i"], A, Ad), _n1_rate(c, c["g_i"], A, Ad)
    square = x * x + y * y
    cross = x * yd - y * xd
    turn = (x * ydd - y * xdd) / square - 2.0 * (x * xd + y * yd) * cross / (square * square)
    return cross / square, turn


@kernel
def _n1_rate(c: np.void, u_i: np.ndarray, A: np.ndarray, Ad: np.ndarray) -> float:
    i, j = c["body_i"], c["body_j"]
    a, b = rotate(Ad, i, u_i), rotate(A, j, c["h_j"])
    e, f = rotate(A, i, u_i), rotate(Ad, j, c["h_j"])
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + e[0] * f[0] + e[1] * f[1] + e[2] * f[2]


@kernel
def residual(c: np.void, q: np.ndarray, A: np.ndarray, expected: float, phi: np.ndarray) -> None:
    """Fill phi[row:row+5]; the last row in m."""
    cylindrical.residual(c, q, A, phi)
    slide = c["sense"] * n2_residual(c, c["s_i"], q, A)
    phi[c["first_row"] + 4] = slide - c["pitch"] * angle(c, A, expected) - c["offset"]


@kernel
def jacobian(c: np.void, q: np.ndarray, A: np.ndarray, phi_q: np.ndarray) -> None:
    """Fill the rows of phi_q (equations, 14)."""
    cylindrical.jacobian(c, q, A, phi_q)
    row = phi_q[c["first_row"] + 4]
    n2_jacobian(c, c["s_i"], q, A, row)
    sense = c["sense"]
    for k in range(14):
        row[k] *= sense
    i, j = c["body_i"], c["body_j"]
    x, y = n1_residual(c, c["h_i"], c["h_j"], A), n1_residual(c, c["g_i"], c["h_j"], A)
    # dθ = (x dy - y dx) / (x² + y²): the derivative of (x g - y f) · h_j with x and y held.
    factor = -c["pitch"] / (x * x + y * y)
    m = (
        factor * (x * c["g_i"][0] - y * c["h_i"][0]),
        factor * (x * c["g_i"][1] - y * c["h_i"][1]),
        factor * (x * c["g_i"][2] - y * c["h_i"][2]),
    )
    add_rotation_row(q, i, m, rotate(A, j, c["h_j"]), row, 3)
    add_rotation_row(q, j, c["h_j"], rotate(A, i, m), row, 10)


@kernel
def acceleration(c: np.void, q: np.ndarray, qd: np.ndarray, rotations: np.ndarray, gamma: np.ndarray) -> None:
    """Fill gamma[row:row+5]."""
    cylindrical.acceleration(c, q, qd, rotations, gamma)
    xdd = -n1_acceleration(c, c["h_i"], c["h_j"], rotations)
    ydd = -n1_acceleration(c, c["g_i"], c["h_j"], rotations)
    turn = angle_rates(c, rotations, xdd, ydd)[1]
    slide = c["sense"] * n2_acceleration(c, c["s_i"], q, qd, rotations)
    gamma[c["first_row"] + 4] = slide + c["pitch"] * turn


@allocating
def second_rate(c: np.void, u_i: np.ndarray, q: np.ndarray, qdd: np.ndarray, rotations: np.ndarray) -> float:
    """d²/dt² of u_i · h_j for second derivatives qdd of the coordinates."""
    row = np.zeros(14)
    n1_jacobian(c, u_i, c["h_j"], q, rotations[0], row)
    total = -n1_acceleration(c, u_i, c["h_j"], rotations)
    for k in range(7):
        total += row[k] * qdd[7 * c["body_i"] + k] + row[7 + k] * qdd[7 * c["body_j"] + k]
    return total
