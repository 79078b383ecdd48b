"""Normalisation of a body's Euler parameters: pᵀp = 1.  Young (1996), eq. (3.14)."""

import numpy as np

from ..._jit import kernel

EQUATIONS = 1


@kernel
def residual(c: np.void, q: np.ndarray, phi: np.ndarray) -> None:
    """Fill phi[row]."""
    k = 7 * c["body_i"] + 3
    phi[c["first_row"]] = q[k] ** 2 + q[k + 1] ** 2 + q[k + 2] ** 2 + q[k + 3] ** 2 - 1.0


@kernel
def jacobian(c: np.void, q: np.ndarray, phi_q: np.ndarray) -> None:
    """Fill one row of phi_q (equations, 14)."""
    k = 7 * c["body_i"] + 3
    for e in range(4):
        phi_q[c["first_row"], 3 + e] = 2.0 * q[k + e]


@kernel
def acceleration(c: np.void, qd: np.ndarray, gamma: np.ndarray) -> None:
    """Fill gamma[row] = -2 ṗᵀṗ."""
    k = 7 * c["body_i"] + 3
    gamma[c["first_row"]] = -2.0 * (qd[k] ** 2 + qd[k + 1] ** 2 + qd[k + 2] ** 2 + qd[k + 3] ** 2)
