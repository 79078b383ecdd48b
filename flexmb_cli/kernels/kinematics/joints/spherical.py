"""Spherical joint: the points P_i and P_j coincide.  Young (1996), section 4.2.1, eqs (4.7)-(4.13)."""

from ..._jit import kernel
from ..joint_primitives import coincident_acceleration, coincident_jacobian, coincident_residual

EQUATIONS = 3


@kernel
def residual(c, q, A, phi):
    """Fill phi[row:row+3], m."""
    coincident_residual(c, q, A, phi)


@kernel
def jacobian(c, q, A, phi_q):
    """Fill the rows of phi_q (equations, 14)."""
    coincident_jacobian(c, q, phi_q)


@kernel
def acceleration(c, q, qd, A, Ad, Add, gamma):
    """Fill gamma[row:row+3], m/s²."""
    coincident_acceleration(c, Add, gamma)
