"""Translational (prismatic) joint: a cylindrical joint that cannot turn, h_i · h_j = 0.

Young (1996), section 4.2.5, eqs (4.31)-(4.39).
"""

import numpy as np

from ..._jit import kernel
from ..joint_primitives import n1_acceleration, n1_jacobian, n1_residual
from . import cylindrical

EQUATIONS = 5


@kernel
def residual(c: np.void, q: np.ndarray, A: np.ndarray, phi: np.ndarray) -> None:
    """Fill phi[row:row+5]: two of unit vectors, two of length, m, one of unit vectors."""
    cylindrical.residual(c, q, A, phi)
    phi[c["first_row"] + 4] = n1_residual(c, c["h_i"], c["h_j"], A)


@kernel
def jacobian(c: np.void, q: np.ndarray, A: np.ndarray, phi_q: np.ndarray) -> None:
    """Fill the rows of phi_q (equations, 14)."""
    cylindrical.jacobian(c, q, A, phi_q)
    n1_jacobian(c, c["h_i"], c["h_j"], q, A, phi_q[c["first_row"] + 4])


@kernel
def acceleration(c: np.void, q: np.ndarray, qd: np.ndarray, rotations: np.ndarray, gamma: np.ndarray) -> None:
    """Fill gamma[row:row+5]."""
    cylindrical.acceleration(c, q, qd, rotations, gamma)
    gamma[c["first_row"] + 4] = n1_acceleration(c, c["h_i"], c["h_j"], rotations)
