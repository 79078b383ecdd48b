"""Speeds of bodies in place of coordinate rates: v of the origin, global axes, ω in body axes, then η̇.

Young (1996), chapter 3: ω = 2 L ṗ in body axes as 2 G ṗ (3.35) in global ones, so ṗ = ½ Lᵀ ω, and
p̈ = ½ Lᵀ ω̇ - ¼ ω² p for |p| = 1.  A constraint row Φ_r, Φ_p on coordinate rates is Φ_r, ½ Φ_p Lᵀ on speeds.
"""

import numpy as np

from .._jit import kernel


@kernel
def parameter_rates(p: np.ndarray, at: int, w: tuple[float, float, float], out: np.ndarray, to: int) -> None:
    """Fill out[to:to+4] with ½ Lᵀ w for the Euler parameters p[at:at+4] and w = (w0, w1, w2), body axes.

    p (k,) and out (k,) may be all coordinates and their rates.
    """
    e0, e1, e2, e3 = p[at], p[at + 1], p[at + 2], p[at + 3]
    out[to] = -0.5 * (e1 * w[0] + e2 * w[1] + e3 * w[2])
    out[to + 1] = 0.5 * (e0 * w[0] - e3 * w[1] + e2 * w[2])
    out[to + 2] = 0.5 * (e3 * w[0] + e0 * w[1] - e1 * w[2])
    out[to + 3] = 0.5 * (-e2 * w[0] + e1 * w[1] + e0 * w[2])


@kernel
def coordinate_rates(bodies: int, q: np.ndarray, u: np.ndarray, qd: np.ndarray) -> None:
    """Fill qd (7 bodies + modes,) from coordinates q and speeds u (6 bodies + modes,)."""
    for mode in range(q.shape[0] - 7 * bodies):
        qd[7 * bodies + mode] = u[6 * bodies + mode]
    for body in range(bodies):
        k, s = 7 * body, 6 * body
        for i in range(3):
            qd[k + i] = u[s + i]
        parameter_rates(q, k + 3, (u[s + 3], u[s + 4], u[s + 5]), qd, k + 3)


@kernel
def coordinate_accelerations(
    bodies: int, q: np.ndarray, u: np.ndarray, ud: np.ndarray, qdd: np.ndarray
) -> None:
    """Fill qdd (7 bodies + modes,) from coordinates, speeds and the rates of the speeds."""
    coordinate_rates(bodies, q, ud, qdd)
    for body in range(bodies):
        k, s = 7 * body + 3, 6 * body + 3
        quarter = 0.25 * (u[s] ** 2 + u[s + 1] ** 2 + u[s + 2] ** 2)
        for i in range(4):
            qdd[k + i] -= quarter * q[k + i]


@kernel
def speeds_of_rates(bodies: int, q: np.ndarray, qd: np.ndarray, u: np.ndarray) -> None:
    """Give p the length 1 and fill u from qd, ω with 2 L ṗ: the inverse of `coordinate_rates`."""
    normalise(bodies, q)
    for mode in range(q.shape[0] - 7 * bodies):
        u[6 * bodies + mode] = qd[7 * bodies + mode]
    for body in range(bodies):
        k, s = 7 * body, 6 * body
        for i in range(3):
            u[s + i] = qd[k + i]
        e0, e1, e2, e3 = q[k + 3], q[k + 4], q[k + 5], q[k + 6]
        d0, d1, d2, d3 = qd[k + 3], qd[k + 4], qd[k + 5], qd[k + 6]
        u[s + 3] = 2.0 * (-e1 * d0 + e0 * d1 + e3 * d2 - e2 * d3)
        u[s + 4] = 2.0 * (-e2 * d0 - e3 * d1 + e0 * d2 + e1 * d3)
        u[s + 5] = 2.0 * (-e3 * d0 + e2 * d1 - e1 * d2 + e0 * d3)


@kernel
def speed_jacobian(
    bodies: np.ndarray, q: np.ndarray, phi_q: np.ndarray, scales: np.ndarray, jacobian: np.ndarray
) -> None:
    """Fill the first rows of jacobian (m, c) with phi_q (r, 14) turned from coordinates to speeds, scaled.

    bodies (r, 2): bodies of the two halves of each row, whose entries stand in the order of the bodies.
    scales (m, c): units of the speeds over those of the equations.
    """
    for row in range(phi_q.shape[0]):
        i, j = bodies[row, 0], bodies[row, 1]
        if i == j:
            for k in range(min(12, jacobian.shape[1])):
                jacobian[row, k] = 0.0
        for half in range(2):
            at, k = 7 * half, 7 * bodies[row, half] + 3
            s = 6 if (i > j) == (half == 0) and i != j else 0
            a0, a1, a2, a3 = (phi_q[row, at + 3], phi_q[row, at + 4], phi_q[row, at + 5], phi_q[row, at + 6])
            e0, e1, e2, e3 = q[k], q[k + 1], q[k + 2], q[k + 3]
            v = (
                phi_q[row, at],
                phi_q[row, at + 1],
                phi_q[row, at + 2],
                0.5 * (-e1 * a0 + e0 * a1 + e3 * a2 - e2 * a3),
                0.5 * (-e2 * a0 - e3 * a1 + e0 * a2 + e1 * a3),
                0.5 * (-e3 * a0 + e2 * a1 - e1 * a2 + e0 * a3),
            )
            for n in range(6):
                before = jacobian[row, s + n] if i == j else 0.0
                jacobian[row, s + n] = before + v[n]
        for k in range(min(12, jacobian.shape[1])):
            jacobian[row, k] *= scales[row, k]


@kernel
def add_turning(
    bodies: np.ndarray, q: np.ndarray, u: np.ndarray, phi_q: np.ndarray, gamma: np.ndarray
) -> None:
    """Add ¼ ω² Φ_p p to gamma (m,): what ½ Lᵀ ω̇ leaves of p̈; bodies (r, 2) and phi_q (r, 14) as in
    `speed_jacobian`.
    """
    for row in range(phi_q.shape[0]):
        for half in range(2):
            at, body = 7 * half, bodies[row, half]
            k, s = 7 * body + 3, 6 * body + 3
            along = 0.0
            for i in range(4):
                along += phi_q[row, at + 3 + i] * q[k + i]
            gamma[row] += 0.25 * (u[s] ** 2 + u[s + 1] ** 2 + u[s + 2] ** 2) * along


@kernel
def move(bodies: int, q: np.ndarray, step: np.ndarray) -> None:
    """Move q by small displacements and turns `step` (6 bodies + modes,), and give every p length 1."""
    for mode in range(q.shape[0] - 7 * bodies):
        q[7 * bodies + mode] += step[6 * bodies + mode]
    for body in range(bodies):
        k, s = 7 * body, 6 * body
        for i in range(3):
            q[k + i] += step[s + i]
        w = (0.5 * step[s + 3], 0.5 * step[s + 4], 0.5 * step[s + 5])
        e0, e1, e2, e3 = q[k + 3], q[k + 4], q[k + 5], q[k + 6]
        q[k + 3] -= e1 * w[0] + e2 * w[1] + e3 * w[2]
        q[k + 4] += e0 * w[0] - e3 * w[1] + e2 * w[2]
        q[k + 5] += e3 * w[0] + e0 * w[1] - e1 * w[2]
        q[k + 6] += -e2 * w[0] + e1 * w[1] + e0 * w[2]
    normalise(bodies, q)


@kernel
def normalise(bodies: int, q: np.ndarray) -> None:
    """Give the Euler parameters of every body length 1."""
    for body in range(bodies):
        k = 7 * body + 3
        length = (q[k] ** 2 + q[k + 1] ** 2 + q[k + 2] ** 2 + q[k + 3] ** 2) ** 0.5
        for i in range(4):
            q[k + i] /= length
