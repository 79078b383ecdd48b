"""The RSSR linkage in closed form: crank and rocker on two fixed axes, a rod with ball ends between them.

The crank carries A about the axis through O_in along u_in, the rocker B about O_out along u_out; the
rod keeps |A - B| = L.  At crank angle 0 the rocker angle is 0.  With C the centre of B's circle, p the
arm from C to B at angle 0 and r = u_out × p, B = C + p cos ψ + r sin ψ and the rod's condition is

    |A - C|² + p² - L² = 2 (X cos ψ + Y sin ψ),    X = (A - C) · p,  Y = (A - C) · r,

so ψ = atan2(Y, X) ± arccos(k / R), with k half the left side and R² = X² + Y²; the sign is kept from
ψ(0) = 0.  Differentiated once, with e = A - B and n = u_out × (B - C), e · (Ȧ - ψ̇ n) = 0 gives

    ψ̇ = e · Ȧ / (e · n),

and once more, with B̈ = ψ̈ n - ψ̇² (B - C),

    ψ̈ = (e · (Ä + ψ̇² (B - C)) + |Ȧ - Ḃ|²) / (e · n).
"""

from dataclasses import dataclass

import numpy as np


def turned(u, angle, v):
    """v turned by `angle` about the unit vector u (Rodrigues); angles (T,) give (T, 3)."""
    u, v = np.asarray(u), np.asarray(v)
    c, s = np.cos(angle)[..., None], np.sin(angle)[..., None]
    return c * v + s * np.cross(u, v) + (1.0 - c) * (u @ v) * u


def carried(O, u, P, angle, rate, second):
    """Position, velocity, acceleration of the point P turned by `angle` about the axis O, u."""
    arm = turned(u, np.asarray(angle), np.subtract(P, O))
    across = np.cross(u, arm)
    rate, second = np.asarray(rate)[..., None], np.asarray(second)[..., None]
    return O + arm, rate * across, second * across + rate**2 * np.cross(u, across)


@dataclass(frozen=True, eq=False)
class Rssr:
    """Axes and rod ends at crank angle 0, global axes, m; `u_in`, `u_out` unit vectors."""

    O_in: np.ndarray
    u_in: np.ndarray
    A: np.ndarray
    O_out: np.ndarray
    u_out: np.ndarray
    B: np.ndarray

    def rocker(self, angle, rate, second):
        """Rocker angle ψ (continuous in the row of angles), ψ̇ and ψ̈ for crank angles (T,)."""
        A, VA, AA = carried(self.O_in, self.u_in, self.A, angle, rate, second)
        C = self.O_out + ((self.B - self.O_out) @ self.u_out) * self.u_out
        psi = self._angle(A, C)
        arm = turned(self.u_out, psi, self.B - C)
        e, n = A - C - arm, np.cross(self.u_out, arm)
        en = np.sum(e * n, axis=-1)
        psi_d = np.sum(e * VA, axis=-1) / en
        v = VA - psi_d[:, None] * n
        psi_dd = (np.sum(e * (AA + psi_d[:, None] ** 2 * arm), axis=-1) + np.sum(v * v, axis=-1)) / en
        return psi, psi_d, psi_dd

    def _angle(self, A, C):
        p = self.B - C
        r = np.cross(self.u_out, p)
        L = self.A - self.B

        def pair(points):
            w = points - C
            X, Y = w @ p, w @ r
            k = 0.5 * (np.sum(w * w, axis=-1) + p @ p - L @ L)
            return np.arctan2(Y, X), np.arccos(k / np.hypot(X, Y))

        start, side = pair(self.A)
        sign = -1.0 if abs(start - side) < abs(start + side) else 1.0
        base, side = pair(A)
        psi = np.unwrap(base + sign * side)
        return psi - 2.0 * np.pi * np.round(psi[0] / (2.0 * np.pi))
