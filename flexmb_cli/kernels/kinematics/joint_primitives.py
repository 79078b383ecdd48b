"""Constraints between two vectors, the elements of which the joints are made.

Young (1996), section 4.1: orthogonal vectors (n1) and (n2), eqs (4.3) and (4.4), and the parallel
ones (p1) and (p2), eqs (4.5) and (4.6); section 4.2.1: coincident points, eq. (4.7).

A cross product of parallel vectors has only two independent components.  The source picks two of
the three in global axes at every step and can pick wrong as the mechanism turns.  Here the product
is resolved in the axes of body i, where s_i does not move: with a = e_m × s_i and b = e_n × s_i,
fixed to body i, (s_i × v)_m = v · A_i a.  m and n are the axes other than that of the largest
component of s_i, chosen once by the model; the two rows can never lose rank.

A constraint c is one record of `model.arrays.kinematic.CONSTRAINT`.  A row of the Jacobian has 14 places: the
seven coordinates of body i, then those of body j.  rotations (3, bodies, 3, 3): A, dA/dt, and the remainder
of d²A/dt² without second derivatives of coordinates.
"""

from typing import Any

import numpy as np

from .._jit import kernel
from ..linalg.rotation import add_rotation_row, dot, rotate

AXES = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


@kernel
def between(c: np.void, q: np.ndarray, A: np.ndarray) -> Any:
    """d = r_j + A_j P_j - r_i - A_i P_i, the vector from P_i to P_j (4.2), m."""
    i, j = c["body_i"], c["body_j"]
    a = rotate(A, i, c["P_i"])
    b = rotate(A, j, c["P_j"])
    return (
        q[7 * j] + b[0] - q[7 * i] - a[0],
        q[7 * j + 1] + b[1] - q[7 * i + 1] - a[1],
        q[7 * j + 2] + b[2] - q[7 * i + 2] - a[2],
    )


@kernel
def between_rate(c: np.void, qd: np.ndarray, Ad: np.ndarray) -> tuple[float, float, float]:
    """dd/dt, m/s."""
    return between(c, qd, Ad)


@kernel
def between_remainder(c: np.void, Add: np.ndarray) -> tuple[float, float, float]:
    """The part of d²d/dt² without second derivatives of coordinates, m/s²."""
    a = rotate(Add, c["body_i"], c["P_i"])
    b = rotate(Add, c["body_j"], c["P_j"])
    return (b[0] - a[0], b[1] - a[1], b[2] - a[2])


@kernel
def coincident_residual(c: np.void, q: np.ndarray, A: np.ndarray, phi: np.ndarray) -> None:
    """Points P_i and P_j coincide, (4.7): three rows."""
    d = between(c, q, A)
    row = c["first_row"]
    for k in range(3):
        phi[row + k] = -d[k]


@kernel
def coincident_jacobian(c: np.void, q: np.ndarray, phi_q: np.ndarray) -> None:
    """Rows (4.8)-(4.11)."""
    for k in range(3):
        row = phi_q[c["first_row"] + k]
        row[k] = 1.0
        row[7 + k] = -1.0
        add_rotation_row(q, c["body_i"], c["P_i"], AXES[k], row, 3)
        minus = (-AXES[k][0], -AXES[k][1], -AXES[k][2])
        add_rotation_row(q, c["body_j"], c["P_j"], minus, row, 10)


@kernel
def coincident_acceleration(c: np.void, rotations: np.ndarray, gamma: np.ndarray) -> None:
    """Right-hand side of (4.13)."""
    d = between_remainder(c, rotations[2])
    row = c["first_row"]
    for k in range(3):
        gamma[row + k] = d[k]


@kernel
def n1_residual(c: np.void, u_i: np.ndarray, u_j: np.ndarray, A: np.ndarray) -> float:
    """u_i · u_j (4.3), vectors fixed to bodies i and j."""
    return dot(rotate(A, c["body_i"], u_i), rotate(A, c["body_j"], u_j))


@kernel
def n1_jacobian(
    c: np.void, u_i: np.ndarray, u_j: np.ndarray, q: np.ndarray, A: np.ndarray, row: np.ndarray
) -> None:
    """Row (4.17)."""
    _n1_row(c, u_i, u_j, rotate(A, c["body_j"], u_j), q, A, row)


@kernel
def _n1_row(
    c: np.void,
    u_i: np.ndarray,
    u_j: np.ndarray,
    turned: tuple[float, float, float],
    q: np.ndarray,
    A: np.ndarray,
    row: np.ndarray,
) -> None:
    """Row (4.17), with u_j in global axes besides."""
    add_rotation_row(q, c["body_i"], u_i, turned, row, 3)
    add_rotation_row(q, c["body_j"], u_j, rotate(A, c["body_i"], u_i), row, 10)


@kernel
def n1_acceleration(c: np.void, u_i: np.ndarray, u_j: np.ndarray, rotations: np.ndarray) -> float:
    """Right-hand side of (4.19)."""
    j = c["body_j"]
    v = rotate(rotations[0], j, u_j), rotate(rotations[1], j, u_j), rotate(rotations[2], j, u_j)
    return _n1_remainder(c, u_i, v, rotations)


@kernel
def _n1_remainder(
    c: np.void, u_i: np.ndarray, v: tuple[tuple[float, float, float], ...], rotations: np.ndarray
) -> float:
    """Right-hand side of (4.19); v: u_j in global axes, its rate, and the remainder of its second."""
    A, Ad, Add, i = rotations[0], rotations[1], rotations[2], c["body_i"]
    remainder = dot(rotate(Add, i, u_i), v[0]) + dot(rotate(A, i, u_i), v[2])
    return -remainder - 2.0 * dot(rotate(Ad, i, u_i), v[1])


@kernel
def n2_residual(c: np.void, u_i: np.ndarray, q: np.ndarray, A: np.ndarray) -> float:
    """u_i · d (4.4), u_i fixed to body i."""
    return dot(rotate(A, c["body_i"], u_i), between(c, q, A))


@kernel
def n2_jacobian(c: np.void, u_i: np.ndarray, q: np.ndarray, A: np.ndarray, row: np.ndarray) -> None:
    """Row of u_i · d: the derivative acts on u_i and on both ends of d."""
    i, j = c["body_i"], c["body_j"]
    u = rotate(A, i, u_i)
    minus_u = (-u[0], -u[1], -u[2])
    for k in range(3):
        row[k] -= u[k]
        row[7 + k] += u[k]
    add_rotation_row(q, i, u_i, between(c, q, A), row, 3)
    add_rotation_row(q, i, c["P_i"], minus_u, row, 3)
    add_rotation_row(q, j, c["P_j"], u, row, 10)


@kernel
def n2_acceleration(
    c: np.void, u_i: np.ndarray, q: np.ndarray, qd: np.ndarray, rotations: np.ndarray
) -> float:
    """Minus the remainder of d²(u_i · d)/dt²."""
    A, Ad, Add, i = rotations[0], rotations[1], rotations[2], c["body_i"]
    remainder = dot(rotate(Add, i, u_i), between(c, q, A)) + dot(rotate(A, i, u_i), between_remainder(c, Add))
    return -remainder - 2.0 * dot(rotate(Ad, i, u_i), between_rate(c, qd, Ad))


@kernel
def p1_residual(c: np.void, row: int, A: np.ndarray, phi: np.ndarray) -> None:
    """s_i parallel to s_j (4.5): two rows from `row` on."""
    phi[row] = n1_residual(c, c["a_i"], c["s_j"], A)
    phi[row + 1] = n1_residual(c, c["b_i"], c["s_j"], A)


@kernel
def p1_jacobian(c: np.void, row: int, q: np.ndarray, A: np.ndarray, phi_q: np.ndarray) -> None:
    """Rows (4.23), resolved in the axes of body i."""
    along = rotate(A, c["body_j"], c["s_j"])
    _n1_row(c, c["a_i"], c["s_j"], along, q, A, phi_q[row])
    _n1_row(c, c["b_i"], c["s_j"], along, q, A, phi_q[row + 1])


@kernel
def p1_acceleration(c: np.void, row: int, rotations: np.ndarray, gamma: np.ndarray) -> None:
    """Right-hand side of (4.25), resolved in the axes of body i."""
    j, along = c["body_j"], c["s_j"]
    v = rotate(rotations[0], j, along), rotate(rotations[1], j, along), rotate(rotations[2], j, along)
    gamma[row] = _n1_remainder(c, c["a_i"], v, rotations)
    gamma[row + 1] = _n1_remainder(c, c["b_i"], v, rotations)


@kernel
def p2_residual(c: np.void, row: int, q: np.ndarray, A: np.ndarray, phi: np.ndarray) -> None:
    """s_i parallel to d (4.6): two rows from `row` on."""
    phi[row] = n2_residual(c, c["a_i"], q, A)
    phi[row + 1] = n2_residual(c, c["b_i"], q, A)


@kernel
def p2_jacobian(c: np.void, row: int, q: np.ndarray, A: np.ndarray, phi_q: np.ndarray) -> None:
    """Rows (4.29), resolved in the axes of body i."""
    n2_jacobian(c, c["a_i"], q, A, phi_q[row])
    n2_jacobian(c, c["b_i"], q, A, phi_q[row + 1])


@kernel
def p2_acceleration(
    c: np.void, row: int, q: np.ndarray, qd: np.ndarray, rotations: np.ndarray, gamma: np.ndarray
) -> None:
    """Right-hand side of (4.31), resolved in the axes of body i."""
    gamma[row] = n2_acceleration(c, c["a_i"], q, qd, rotations)
    gamma[row + 1] = n2_acceleration(c, c["b_i"], q, qd, rotations)
