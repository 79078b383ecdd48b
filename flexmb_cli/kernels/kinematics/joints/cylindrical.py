"""Cylindrical joint: s_i is parallel to s_j and to d, the vector from P_i to P_j.

Young (1996), section 4.2.4, eqs (4.26)-(4.31).
"""

import numpy as np

from ..._jit import kernel
from ..joint_primitives import (
    p1_acceleration,
    p1_jacobian,
    p1_residual,
    p2_acceleration,
    p2_jacobian,
    p2_residual,
)

EQUATIONS = 4


@kernel
def residual(c: np.void, q: np.ndarray, A: np.ndarray, phi: np.ndarray) -> None:
    """Fill phi[row:row+4]: two of unit vectors, two of length, m."""
    p1_residual(c, c["first_row"], A, phi)
    p2_residual(c, c["first_row"] + 2, q, A, phi)


@kernel
def jacobian(c: np.void, q: np.ndarray, A: np.ndarray, phi_q: np.ndarray) -> None:
    """Fill the rows of phi_q (equations, 14)."""
    p1_jacobian(c, c["first_row"], q, A, phi_q)
    p2_jacobian(c, c["first_row"] + 2, q, A, phi_q)


@kernel
def acceleration(c: np.void, q: np.ndarray, qd: np.ndarray, rotations: np.ndarray, gamma: np.ndarray) -> None:
    """Fill gamma[row:row+4]."""
    p1_acceleration(c, c["first_row"], rotations, gamma)
    p2_acceleration(c, c["first_row"] + 2, q, qd, rotations, gamma)
