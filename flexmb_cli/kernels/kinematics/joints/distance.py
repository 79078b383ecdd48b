"""Distance constraint: the difference of one coordinate of two bodies is held, q_i - q_j = C.

Young (1996), section 5.3 (DO_DISTAN) and the listing: a difference of coordinates, for directions
4-6 of Euler parameters, not a length.
"""

import numpy as np

from ..._jit import kernel

EQUATIONS = 1


@kernel
def residual(c: np.void, q: np.ndarray, phi: np.ndarray) -> None:
    """Fill phi[row]."""
    k = c["coordinate"]
    phi[c["first_row"]] = q[7 * c["body_i"] + k] - q[7 * c["body_j"] + k] - c["C"]


@kernel
def jacobian(c: np.void, phi_q: np.ndarray) -> None:
    """Fill one row of phi_q (equations, 14); the right-hand sides are zero."""
    phi_q[c["first_row"], c["coordinate"]] = 1.0
    phi_q[c["first_row"], 7 + c["coordinate"]] = -1.0
