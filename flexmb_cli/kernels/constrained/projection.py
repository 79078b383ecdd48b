"""Positions and speeds brought onto the constraints by the shortest correction in the metric of M.

What is left afterwards is round-off: the drift that explicit integration leaves never adds up.
"""

import numpy as np

from .._jit import kernel
from ..kinematics import constraints as equations
from ..linalg.rank_revealing_lu import row_times
from ..linalg.rotation import A, rotation_matrices
from .accelerations import factorise_at, solve
from .body_vectors import geometry_of, place_vectors
from .constraint_primitives import equation_residuals, equation_velocities
from .speeds import move
from .system import CORRECTION, GAMMA, PHI, QD, SOLVED, System, Work

MOST_CORRECTIONS = 12
CLOSED_GAP = 4e-16


@kernel
def largest_gap(system: System, work: Work) -> tuple[float, int]:
    """Largest scaled equation in PHI, and its row; NaN counts as infinite."""
    found, worst = 0.0, 0
    for row in range(work.rows.shape[1]):
        gap = abs(work.rows[PHI, row]) / system.row_scale[row]
        if not gap <= found:
            found, worst = (gap if gap > found else np.inf), row
    return found, worst


@kernel
def evaluate_residual(system: System, work: Work, q: np.ndarray, t: float, expected: np.ndarray) -> float:
    """Fill PHI at q; returns the largest scaled equation of the independent ones."""
    rotation_matrices(q, work.rotations[A])
    place_vectors(geometry_of(system, work), q)
    equations.residual(system.constraints, q, t, expected, work.rotations[A], work.rows[PHI])
    equation_residuals(system, work, t, expected, work.rows[PHI])
    found = 0.0
    for k in range(work.rank[0]):
        row = work.order[k]
        gap = abs(work.rows[PHI, row]) / system.row_scale[row]
        if not gap <= found:
            found = gap if gap > found else np.inf
    return found


@kernel
def project_position(system: System, work: Work, q: np.ndarray, t: float, expected: np.ndarray) -> int:
    """Improve q until the independent equations are met to round-off: a code.

    The factors of the first position serve all corrections: q comes from an accurate step.
    """
    code = factorise_at(system, work, q)
    zero, step, gamma = work.vectors[QD], work.vectors[CORRECTION], work.rows[GAMMA]
    before = np.inf
    for _ in range(MOST_CORRECTIONS):
        gap = evaluate_residual(system, work, q, t, expected)
        if code != SOLVED or gap <= CLOSED_GAP or not gap < 0.5 * before:
            break
        before = gap
        for row in range(gamma.shape[0]):
            gamma[row] = -work.rows[PHI, row]
        for k in range(zero.shape[0]):
            zero[k] = 0.0
        solve(system, work, zero, gamma, step)
        move(system.masses.shape[0], q, step)
    return code


@kernel
def fill_nu(system: System, t: float, nu: np.ndarray) -> None:
    """Fill nu (m,), the right-hand side of J u = ν."""
    equations.velocity(system.constraints, t, nu)
    equation_velocities(system, t, nu)


@kernel
def rate_gap(system: System, work: Work, u: np.ndarray, t: float) -> float:
    """Fill GAMMA with ν - J u, where the Jacobian belongs to the position; returns the largest scaled."""
    gamma = work.rows[GAMMA]
    fill_nu(system, t, gamma)
    found = 0.0
    for row in range(gamma.shape[0]):
        total = row_times(work.jacobian, work.columns, row, u, system.speed_scale)
        gamma[row] -= total * system.row_scale[row]
        found = max(found, abs(gamma[row]) / system.row_scale[row])
    return found


@kernel
def project_speeds(system: System, work: Work, q: np.ndarray, u: np.ndarray, t: float) -> tuple[int, float]:
    """Correct u to meet the rates of the equations at q; returns (code, largest scaled rate left)."""
    code = factorise_at(system, work, q)
    if code != SOLVED:
        return code, np.inf
    zero, step = work.vectors[QD], work.vectors[CORRECTION]
    for k in range(zero.shape[0]):
        zero[k] = 0.0
    for _ in range(2):
        rate_gap(system, work, u, t)
        solve(system, work, zero, work.rows[GAMMA], step)
        for k in range(u.shape[0]):
            u[k] += step[k]
    return code, rate_gap(system, work, u, t)
