"""Universal joint: P_i and P_j coincide, the arms of the cross stay orthogonal: s_i · s_j = 0.

Young (1996), section 4.2.2, eqs (4.14)-(4.19).
"""

import numpy as np

from ..._jit import kernel
from ..joint_primitives import (
    coincident_acceleration,
    coincident_jacobian,
    coincident_residual,
    n1_acceleration,
    n1_jacobian,
    n1_residual,
)

EQUATIONS = 4


@kernel
def residual(c: np.void, q: np.ndarray, A: np.ndarray, phi: np.ndarray) -> None:
    """Fill phi[row:row+4]: three of length, m, one of unit vectors."""
    coincident_residual(c, q, A, phi)
    phi[c["first_row"] + 3] = n1_residual(c, c["s_i"], c["s_j"], A)


@kernel
def jacobian(c: np.void, q: np.ndarray, A: np.ndarray, phi_q: np.ndarray) -> None:
    """Fill the rows of phi_q (equations, 14)."""
    coincident_jacobian(c, q, phi_q)
    n1_jacobian(c, c["s_i"], c["s_j"], q, A, phi_q[c["first_row"] + 3])


@kernel
def acceleration(c: np.void, q: np.ndarray, qd: np.ndarray, rotations: np.ndarray, gamma: np.ndarray) -> None:
    """Fill gamma[row:row+4]."""
    coincident_acceleration(c, rotations, gamma)
    gamma[c["first_row"] + 3] = n1_acceleration(c, c["s_i"], c["s_j"], rotations)
