"""One step of a kinematic analysis: position by Newton, velocity and acceleration by the same factors.

Young (1996), sections 4.3 and 5.2 (procedures NEWTON, LINEAR and KINEM).  Lengths are measured in
the mechanism's length scale, so that all residuals and corrections are pure numbers of order one.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from .._jit import kernel, plain_allocating
from ..linalg.lu import factorise, substitute
from ..linalg.rotation import RATE, REMAINDER, A, rotation_matrices, rotation_rates
from . import constraints as equations

CONVERGED, STALLED, SINGULAR = 0, 1, 2

# Newton's error squares at each iteration: after a correction this small nothing is left but round-off.
LAST_CORRECTION = 1e-9
SOLVED_RESIDUAL = 1e-12
REFINED = 4e-15  # of the solution: what refinement cannot better


# As few arrays as possible: each one costs compile time in every function it passes through.
class System(NamedTuple):
    """The equations of n coordinates."""

    constraints: np.ndarray  # CONSTRAINT records
    # (n, 4) numbers of the bodies of the two halves of each Jacobian row, order of elimination of the rows,
    # matrix column of each coordinate
    places: np.ndarray
    units: np.ndarray  # (2, n) one over those of the rows, those of the coordinates, m or 1
    limits: np.ndarray  # (4,) scaled EARLY_END and PIVOT, numbers ITERATIONS and RANK


BODY_I, BODY_J, ORDER, COLUMN = 0, 1, 2, 3
PER_ROW, OF_COORDINATE = 0, 1
# Largest residual that ends Newton early (0: go on to round-off), smallest pivot, most iterations,
# and the rank: less than n when some equations repeat others.
EARLY_END, PIVOT, ITERATIONS, RANK = 0, 1, 2, 3


class Work(NamedTuple):
    """Arrays reused in every step, of n coordinates."""

    rotations: np.ndarray  # (3, bodies, 3, 3) A, dA/dt, 1/s, and the remainder of d²A/dt², 1/s²
    vectors: np.ndarray  # (6, n) in units of equations or coordinates; rows PHI … REST
    phi_q: np.ndarray  # (n, 14) derivatives by the coordinates of both bodies, in units of both
    matrix: np.ndarray  # (n, n) factors of Φ_q, in units of rows and coordinates
    order: np.ndarray  # (n,) numbers of the rows in the order of elimination
    pattern: np.ndarray  # (n, n + 1) nonzero places of the factors


PHI, RIGHT_SIDE, SCALED, UNKNOWN, CORRECTION, REST = 0, 1, 2, 3, 4, 5


@plain_allocating
def make_work(coordinates: int) -> Work:
    """Work for a system of as many equations as coordinates."""
    return Work(
        np.zeros((3, coordinates // 7, 3, 3)),
        np.zeros((6, coordinates)),
        np.zeros((coordinates, 14)),
        np.zeros((coordinates, coordinates)),
        np.zeros(coordinates, np.int64),
        np.zeros((coordinates, coordinates + 1), np.int64),
    )


@kernel
def fill_matrix(system: System, work: Work) -> None:
    """Spread the rows of phi_q over the scaled matrix, columns in order of elimination."""
    n = work.matrix.shape[0]
    for row in range(n):
        for k in range(n):
            work.matrix[row, k] = 0.0
        for half in range(2):
            first = 7 * system.places[row, half]
            for k in range(7):
                value = work.phi_q[row, 7 * half + k]
                if value != 0.0:
                    scale = system.units[OF_COORDINATE, first + k] * system.units[PER_ROW, row]
                    work.matrix[row, system.places[first + k, COLUMN]] += value * scale


@kernel
def solve_linear(system: System, work: Work, right_side: np.ndarray, solution: np.ndarray) -> float:
    """Fill solution (n,) of Φ_q solution = right_side by the factors at hand; right_side (n,).

    Returns its largest scaled component.
    """
    scaled, unknown = work.vectors[SCALED], work.vectors[UNKNOWN]
    for row in range(scaled.size):
        scaled[row] = right_side[row] * system.units[PER_ROW, row]
    substitute(work.matrix, work.order, work.pattern, scaled, unknown)
    found = 0.0
    for k in range(solution.size):
        value = unknown[system.places[k, COLUMN]]
        found = max(found, abs(value))
        solution[k] = value * system.units[OF_COORDINATE, k]
    return found


@kernel
def largest_scaled(system: System, values: np.ndarray) -> float:
    """Return the largest |value| of values (n,) of equations, each in its unit; NaN counts as infinite."""
    found = 0.0
    for row in range(values.size):
        value = abs(values[row]) * system.units[PER_ROW, row]
        if not value <= found:
            found = value if value > found else np.inf
    return found


@kernel
def largest(values: np.ndarray) -> float:
    """Return the largest magnitude in values (n,)."""
    found = 0.0
    for k in range(values.size):
        found = max(found, abs(values[k]))
    return found


@kernel
def evaluate_position(system: System, work: Work, q: np.ndarray, t: float, expected: np.ndarray) -> float:
    """Fill A and Φ of `work` at q; returns the largest scaled residual."""
    rotation_matrices(q, work.rotations[A])
    equations.residual(system.constraints, q, t, expected, work.rotations[A], work.vectors[PHI])
    return largest_scaled(system, work.vectors[PHI])


@kernel
def factorise_at(system: System, work: Work, q: np.ndarray) -> int:
    """Factors of Φ_q at q, where A belongs to q; returns the sign of det Φ_q, 0 where it is singular."""
    equations.jacobian(system.constraints, q, work.rotations[A], work.phi_q)
    fill_matrix(system, work)
    for row in range(work.order.size):
        work.order[row] = system.places[row, ORDER]
    return factorise(work.matrix, work.order, work.pattern, system.limits[PIVOT], int(system.limits[RANK]))


@kernel
def reach_of(system: System, q: np.ndarray) -> float:
    """Largest scaled coordinate, at least 1: round-off grows with it when a mechanism travels far."""
    found = 1.0
    for k in range(q.size):
        found = max(found, abs(q[k]) / system.units[OF_COORDINATE, k])
    return found


@kernel
def row_times(system: System, work: Work, row: int, values: np.ndarray) -> float:
    """Return one row of Φ_q times values (n,)."""
    total = 0.0
    for half in range(2):
        first = 7 * system.places[row, half]
        for k in range(7):
            total += work.phi_q[row, 7 * half + k] * values[first + k]
    return total


@kernel
def set_rest(system: System, work: Work, solution: np.ndarray) -> float:
    """Set REST to RIGHT_SIDE - Φ_q solution, solution (n,); returns its largest scaled component."""
    right_side, rest = work.vectors[RIGHT_SIDE], work.vectors[REST]
    for row in range(rest.size):
        rest[row] = right_side[row] - row_times(system, work, row, solution)
    return largest_scaled(system, rest)


@kernel
def add_correction(work: Work, factor: float, solution: np.ndarray) -> None:
    """Add factor CORRECTION to solution (n,)."""
    correction = work.vectors[CORRECTION]
    for k in range(solution.size):
        solution[k] += factor * correction[k]


class LinearSolver(NamedTuple):
    """Factors of Φ_q."""

    # (system, work, q): make the factors at q, where A belongs to q; sign of det Φ_q, 0 where it is singular
    factorise: Callable[..., Any]
    # (system, work, right_side, solution): solve by the factors at hand; largest scaled component
    solve: Callable[..., Any]


def newton_by(linear: LinearSolver) -> Callable[..., Any]:
    """Return Newton's method with these factors."""
    factorise, solve = linear

    @kernel
    def newton(
        system: System, work: Work, q: np.ndarray, t: float, expected: np.ndarray, limit: float, most: int
    ) -> tuple[int, int, int]:
        """Improve q until only round-off is left; the factors of the last iteration are kept.

        `limit` bounds the scaled correction of one iteration, `most` their number.  Returns (code,
        iterations, sign of det Φ_q).  A and Φ of `work` belong to the q returned.
        """
        sign = 0
        previous = np.inf
        for iteration in range(1, most + 1):
            gap = evaluate_position(system, work, q, t, expected)
            if not gap < np.inf:
                return STALLED, iteration, sign
            if gap <= system.limits[EARLY_END] and iteration > 1:
                return CONVERGED, iteration - 1, sign
            sign = factorise(system, work, q)
            if sign == 0:
                return SINGULAR, iteration, sign
            size = solve(system, work, work.vectors[PHI], work.vectors[CORRECTION])
            shrink = 1.0 if size <= limit else limit / size
            add_correction(work, -shrink, q)
            reach = reach_of(system, q)
            if size <= LAST_CORRECTION * reach:
                gap = evaluate_position(system, work, q, t, expected)
                return (CONVERGED if gap <= SOLVED_RESIDUAL * reach else STALLED), iteration, sign
            if iteration > 3 and shrink == 1.0 and size > previous:
                return STALLED, iteration, sign
            previous = size
        return STALLED, most, sign

    return newton


def _refinement_by(linear: LinearSolver):
    solve = linear.solve

    @kernel
    def solve_refined(system: System, work: Work, solution: np.ndarray) -> None:
        """Solve Φ_q solution = RIGHT_SIDE by the factors at hand and the true phi_q; REST is what is left.

        The factors are those of Newton's last iteration, which is nearly, but not quite, here: each
        refinement multiplies the error by that small distance.
        """
        size = solve(system, work, work.vectors[RIGHT_SIDE], solution)
        for _ in range(3):
            if set_rest(system, work, solution) <= REFINED * size:
                break
            solve(system, work, work.vectors[REST], work.vectors[CORRECTION])
            add_correction(work, 1.0, solution)

    return solve_refined


def rates_by(linear: LinearSolver) -> Callable[..., Any]:
    """Return the solution of velocities and accelerations with these factors."""
    solve_refined = _refinement_by(linear)

    @kernel
    def rates(system: System, work: Work, q: np.ndarray, t: float, qd: np.ndarray, qdd: np.ndarray) -> float:
        """Fill qd and qdd at a position found by `newton`; returns the largest |dΦ/dt|."""
        rotations, right_side = work.rotations, work.vectors[RIGHT_SIDE]
        equations.jacobian(system.constraints, q, rotations[A], work.phi_q)
        equations.velocity(system.constraints, t, right_side)
        solve_refined(system, work, qd)
        gap = largest(work.vectors[REST])
        rotation_rates(q, qd, rotations[RATE], rotations[REMAINDER])
        equations.acceleration(system.constraints, q, qd, t, rotations, right_side)
        solve_refined(system, work, qdd)
        return gap

    return rates


DENSE = LinearSolver(factorise_at, solve_linear)
