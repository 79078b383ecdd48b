"""Simplified constraint: one coordinate of a body is held, q = C.  Young (1996), section 4.2.7, eq. (4.57).

`coordinate` 0-2 is x, y, z, 3-6 is e0, e1, e2, e3; the model turns an angle into sin(angle/2).
"""

from ..._jit import kernel

EQUATIONS = 1


@kernel
def residual(c, q, phi):
    """Fill phi[row]."""
    phi[c["first_row"]] = q[7 * c["body_i"] + c["coordinate"]] - c["C"]


@kernel
def jacobian(c, phi_q):
    """Fill one row of phi_q (equations, 14); the right-hand sides are zero, (4.58)."""
    phi_q[c["first_row"], c["coordinate"]] = 1.0
