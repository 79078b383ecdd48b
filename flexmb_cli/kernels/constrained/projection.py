"""Positions and speeds brought onto the constraints by the shortest corrections in the metric of a matrix.

The matrix is M for the explicit method, and that of the step for Radau's, in whose metric stiff motions stay
at rest.  What is left afterwards is round-off: the drift that integration leaves never adds up.

Three other corrections have another mathematics.  The generalised-α method closes gaps, rates and
accelerations in one iteration with the equations of motion, since its forces belong to the end of the step
(`integrators.generalised_alpha_step`).  Trees have the coordinates of their hinges, so that only closed loops
are left to close: by recursion along the tree (`tree.projection`).  In kinematics the equations determine
every coordinate: Newton's correction is unique, and no metric enters (`kinematics.newton`).
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
RATE_CORRECTIONS = 2
CLOSED_GAP = 4e-16


@kernel
def largest_gap(system: System, work: Work) -> tuple[float, int]:
    """Largest scaled equation in PHI, and its row; NaN counts as infinite."""
    largest, worst = 0.0, 0
    for row in range(work.rows.shape[1]):
        gap = abs(work.rows[PHI, row]) / system.row_scale[row]
        if not gap <= largest:
            largest, worst = (gap if gap > largest else np.inf), row
    return largest, worst


@kernel
def evaluate_residual(system: System, work: Work, q: np.ndarray, t: float, expected: np.ndarray) -> float:
    """Fill PHI at q; returns the largest scaled equation of the independent ones."""
    rotation_matrices(q, work.rotations[A])
    place_vectors(geometry_of(system, work), q)
    fill_residual(system, work, q, t, expected)
    largest = 0.0
    for k in range(work.rank[0]):
        row = work.order[k]
        gap = abs(work.rows[PHI, row]) / system.row_scale[row]
        if not gap <= largest:
            largest = gap if gap > largest else np.inf
    return largest


@kernel
def fill_residual(system: System, work: Work, q: np.ndarray, t: float, expected: np.ndarray) -> None:
    """Fill PHI at q, to which rotation matrices and body vectors belong."""
    equations.residual(system.constraints, q, t, expected, work.rotations[A], work.rows[PHI])
    equation_residuals(system, work, t, expected, work.rows[PHI])


@kernel
def project_position(system: System, work: Work, q: np.ndarray, t: float, expected: np.ndarray) -> int:
    """Improve q until the independent equations are met to round-off: a code.

    The factors of the first position serve all corrections: q comes from an accurate step.
    """
    code = factorise_at(system, work, q)
    if code == SOLVED:
        close_gaps(system, work, work, q, t, expected)
    return code


@kernel
def close_gaps(
    system: System, work: Work, metric: Work, q: np.ndarray, t: float, expected: np.ndarray
) -> None:
    """Improve q until the independent equations are met to round-off or corrections no longer halve the gap.

    `metric`: the Work by whose factors each correction is the shortest; `work` itself for that of M.
    """
    zero, step, gamma = work.vectors[QD], work.vectors[CORRECTION], work.rows[GAMMA]
    zero[:] = 0.0
    before = np.inf
    for _ in range(MOST_CORRECTIONS):
        gap = evaluate_residual(system, work, q, t, expected)
        if gap <= CLOSED_GAP or not gap < 0.5 * before:
            break
        before = gap
        for row in range(gamma.shape[0]):
            gamma[row] = -work.rows[PHI, row]
        solve(system, metric, zero, gamma, step)
        move(system.masses.shape[0], q, step)


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
    largest = 0.0
    for row in range(gamma.shape[0]):
        total = row_times(work.jacobian, work.columns, row, u, system.speed_scale)
        gamma[row] -= total * system.row_scale[row]
        largest = max(largest, abs(gamma[row]) / system.row_scale[row])
    return largest


@kernel
def project_speeds(system: System, work: Work, q: np.ndarray, u: np.ndarray, t: float) -> tuple[int, float]:
    """Correct u to meet the rates of the equations at q; returns (code, largest scaled rate left)."""
    code = factorise_at(system, work, q)
    if code != SOLVED:
        return code, np.inf
    close_rates(system, work, work, u, t)
    return code, rate_gap(system, work, u, t)


@kernel
def close_rates(system: System, work: Work, metric: Work, u: np.ndarray, t: float) -> None:
    """Correct u to meet the rates of the equations where the Jacobian stands; `metric` as in `close_gaps`."""
    zero, step = work.vectors[QD], work.vectors[CORRECTION]
    zero[:] = 0.0
    for _ in range(RATE_CORRECTIONS):
        rate_gap(system, work, u, t)
        solve(system, metric, zero, work.rows[GAMMA], step)
        for k in range(u.shape[0]):
            u[k] += step[k]
