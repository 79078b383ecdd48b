"""Simplified constraint: one coordinate of a body is held, q = C.  Young (1996), section 4.2.7, eq. (4.57).

`coordinate` 0-2 is x, y, z, 3-6 is e0, e1, e2, e3; the model turns an angle into sin(angle/2).
"""

import numpy as np

from ..._jit import kernel

EQUATIONS = 1


@kernel
def residual(c: np.void, q: np.ndarray, phi: np.ndarray) -> None:
    """Fill phi[row]."""
    phi[c["first_row"]] = q[7 * c["body_i"] + c["coordinate"]] - c["C"]


@kernel
def jacobian(c: np.void, phi_q: np.ndarray) -> None:
    """Fill one row of phi_q (equations, 14); the right-hand sides are zero, (4.58)."""
    phi_q[c["first_row"], c["coordinate"]] = 1.0
