"""Driver: a coordinate follows f(t) = C + B t + A t²/2.  Young (1996), section 4.2.8, eqs (4.59)-(4.64).

A rotation has two rows, e_k = sin(f/2) and e0 = cos(f/2), the second in place of its body's
normalisation: (6.9), (6.12), (6.15) of the source omit the term that makes the pair consistent.
"""

import math
from typing import Any

import numpy as np

from ..._jit import kernel

EQUATIONS = 1


@kernel
def function(c: np.ndarray, t: float) -> Any:
    """f, df/dt and d²f/dt² at time t."""
    return c["C"] + (c["B"] + 0.5 * c["A"] * t) * t, c["B"] + c["A"] * t, c["A"]


@kernel
def residual(c: np.void, q: np.ndarray, t: float, phi: np.ndarray) -> None:
    """Fill phi[row], and phi[row+1] of a rotation."""
    f = function(c, t)[0]
    row, k = c["first_row"], 7 * c["body_i"]
    if c["coordinate"] < 3:
        phi[row] = q[k + c["coordinate"]] - f
    else:
        phi[row] = q[k + c["coordinate"]] - math.sin(0.5 * f)
        phi[row + 1] = q[k + 3] - math.cos(0.5 * f)


@kernel
def jacobian(c: np.void, phi_q: np.ndarray) -> None:
    """Fill one row of phi_q (equations, 14), two of a rotation."""
    phi_q[c["first_row"], c["coordinate"]] = 1.0
    if c["coordinate"] >= 3:
        phi_q[c["first_row"] + 1, 3] = 1.0


@kernel
def velocity(c: np.void, t: float, nu: np.ndarray) -> None:
    """Fill the right-hand side of the velocity equations, (4.60) and (4.63)."""
    f, rate, _ = function(c, t)
    row = c["first_row"]
    if c["coordinate"] < 3:
        nu[row] = rate
    else:
        nu[row] = 0.5 * math.cos(0.5 * f) * rate
        nu[row + 1] = -0.5 * math.sin(0.5 * f) * rate


@kernel
def acceleration(c: np.void, t: float, gamma: np.ndarray) -> None:
    """Fill the right-hand side of the acceleration equations, (4.61) and (4.64)."""
    f, rate, second = function(c, t)
    row = c["first_row"]
    if c["coordinate"] < 3:
        gamma[row] = second
    else:
        sin, cos = math.sin(0.5 * f), math.cos(0.5 * f)
        gamma[row] = 0.5 * cos * second - 0.25 * sin * rate * rate
        gamma[row + 1] = -0.5 * sin * second - 0.25 * cos * rate * rate
