"""The whole system: Φ, its Jacobian Φ_q, and the right-hand sides of velocity and acceleration.

Young (1996), section 5.3 (procedure FUNCT).  `constraints` is a structured array
(`model.arrays.kinematic.CONSTRAINT`).  Φ_q is kept row by row: phi_q (equations, 14) holds the derivatives
with respect to the seven coordinates of the row's body i, then those of its body j.
"""

import numpy as np

from .._jit import kernel
from .joints import (
    cylindrical,
    distance,
    driver,
    normalisation,
    revolute,
    screw,
    simplified,
    spherical,
    translational,
    universal,
)

# The codes of model.joint_types; a test compares them.
SPHERICAL, UNIVERSAL, REVOLUTE, CYLINDRICAL, TRANSLATIONAL, SCREW = 1, 2, 3, 4, 5, 6
SIMPLIFIED, DISTANCE, DRIVER, NORMALISATION = 7, 8, 9, 10


@kernel
def residual(
    constraints: np.ndarray, q: np.ndarray, t: float, expected: np.ndarray, A: np.ndarray, phi: np.ndarray
) -> None:
    """Fill phi (equations,).  expected (screws,): the angles expected, rad; A: matrices at q."""
    for k in range(constraints.size):
        c = constraints[k]
        kind = c["kind"]
        if kind == SPHERICAL:
            spherical.residual(c, q, A, phi)
        elif kind == UNIVERSAL:
            universal.residual(c, q, A, phi)
        elif kind == REVOLUTE:
            revolute.residual(c, q, A, phi)
        elif kind == CYLINDRICAL:
            cylindrical.residual(c, q, A, phi)
        elif kind == TRANSLATIONAL:
            translational.residual(c, q, A, phi)
        elif kind == SCREW:
            screw.residual(c, q, A, expected[c["screw"]], phi)
        elif kind == SIMPLIFIED:
            simplified.residual(c, q, phi)
        elif kind == DISTANCE:
            distance.residual(c, q, phi)
        elif kind == DRIVER:
            driver.residual(c, q, t, phi)
        elif kind == NORMALISATION:
            normalisation.residual(c, q, phi)


@kernel
def jacobian(constraints: np.ndarray, q: np.ndarray, A: np.ndarray, phi_q: np.ndarray) -> None:
    """Fill phi_q (equations, 14)."""
    for row in range(phi_q.shape[0]):
        for k in range(14):
            phi_q[row, k] = 0.0
    for k in range(constraints.size):
        c = constraints[k]
        kind = c["kind"]
        if kind == SPHERICAL:
            spherical.jacobian(c, q, A, phi_q)
        elif kind == UNIVERSAL:
            universal.jacobian(c, q, A, phi_q)
        elif kind == REVOLUTE:
            revolute.jacobian(c, q, A, phi_q)
        elif kind == CYLINDRICAL:
            cylindrical.jacobian(c, q, A, phi_q)
        elif kind == TRANSLATIONAL:
            translational.jacobian(c, q, A, phi_q)
        elif kind == SCREW:
            screw.jacobian(c, q, A, phi_q)
        elif kind == SIMPLIFIED:
            simplified.jacobian(c, phi_q)
        elif kind == DISTANCE:
            distance.jacobian(c, phi_q)
        elif kind == DRIVER:
            driver.jacobian(c, phi_q)
        elif kind == NORMALISATION:
            normalisation.jacobian(c, q, phi_q)


@kernel
def velocity(constraints: np.ndarray, t: float, nu: np.ndarray) -> None:
    """Fill nu = -∂Φ/∂t: only drivers depend on time."""
    nu[:] = 0.0
    for k in range(constraints.size):
        if constraints[k]["kind"] == DRIVER:
            driver.velocity(constraints[k], t, nu)


@kernel
def acceleration(
    constraints: np.ndarray, q: np.ndarray, qd: np.ndarray, t: float, rotations: np.ndarray, gamma: np.ndarray
) -> None:
    """Fill gamma, the right-hand side of Φ_q q̈ = γ.

    rotations (3, bodies, 3, 3): A, dA/dt, and the remainder of d²A/dt².
    """
    gamma[:] = 0.0
    for k in range(constraints.size):
        c = constraints[k]
        kind = c["kind"]
        if kind == SPHERICAL:
            spherical.acceleration(c, q, qd, rotations, gamma)
        elif kind == UNIVERSAL:
            universal.acceleration(c, q, qd, rotations, gamma)
        elif kind == REVOLUTE:
            revolute.acceleration(c, q, qd, rotations, gamma)
        elif kind == CYLINDRICAL:
            cylindrical.acceleration(c, q, qd, rotations, gamma)
        elif kind == TRANSLATIONAL:
            translational.acceleration(c, q, qd, rotations, gamma)
        elif kind == SCREW:
            screw.acceleration(c, q, qd, rotations, gamma)
        elif kind == DRIVER:
            driver.acceleration(c, t, gamma)
        elif kind == NORMALISATION:
            normalisation.acceleration(c, qd, gamma)


@kernel
def screw_motion(
    constraints: np.ndarray,
    states: np.ndarray,
    rotations: np.ndarray,
    expected: np.ndarray,
    motion: np.ndarray,
) -> None:
    """Fill motion (screws, 3) with θ, dθ/dt, d²θ/dt², rad.

    states (3, n): q and its derivatives; expected (screws,) picks the whole turns.
    """
    for k in range(constraints.size):
        c = constraints[k]
        if c["kind"] == SCREW:
            s = c["screw"]
            xdd = screw.second_rate(c, c["h_i"], states[0], states[2], rotations)
            ydd = screw.second_rate(c, c["g_i"], states[0], states[2], rotations)
            motion[s, 0] = screw.angle(c, rotations[0], expected[s])
            motion[s, 1], motion[s, 2] = screw.angle_rates(c, rotations, xdd, ydd)
