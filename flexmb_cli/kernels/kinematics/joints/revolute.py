"""Revolute joint: P_i and P_j coincide, s_i stays parallel to s_j.

Young (1996), section 4.2.3, eqs (4.20)-(4.25).
"""

import numpy as np

from ..._jit import kernel
from ..joint_primitives import (
    coincident_acceleration,
    coincident_jacobian,
    coincident_residual,
    p1_acceleration,
    p1_jacobian,
    p1_residual,
)

EQUATIONS = 5


@kernel
def residual(c: np.void, q: np.ndarray, A: np.ndarray, phi: np.ndarray) -> None:
    """Fill phi[row:row+5]: three of length, m, two of unit vectors."""
    coincident_residual(c, q, A, phi)
    p1_residual(c, c["first_row"] + 3, A, phi)


@kernel
def jacobian(c: np.void, q: np.ndarray, A: np.ndarray, phi_q: np.ndarray) -> None:
    """Fill the rows of phi_q (equations, 14)."""
    coincident_jacobian(c, q, phi_q)
    p1_jacobian(c, c["first_row"] + 3, q, A, phi_q)


@kernel
def acceleration(c: np.void, q: np.ndarray, qd: np.ndarray, rotations: np.ndarray, gamma: np.ndarray) -> None:
    """Fill gamma[row:row+5]."""
    coincident_acceleration(c, rotations, gamma)
    p1_acceleration(c, c["first_row"] + 3, rotations, gamma)
