"""One step of a kinematic analysis: position by Newton, velocity and acceleration by the same factors.

Young (1996), sections 4.3 and 5.2 (procedures NEWTON, LINEAR and KINEM).  Lengths are measured in
the mechanism's length scale, so that all residuals and corrections are pure numbers of order one.

Factors of Φ_q are dense, or of many bodies those of entries other than zero.  Their order of elimination is
chosen once, and anew where its pivots have become small; the sign of the determinant is that of the pivots
and of the order as two permutations.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from ...memory import paged_zeros
from .._jit import allocating, kernel, plain, plain_allocating
from ..linalg.local_order import choose_by_rows
from ..linalg.lu import factorise, substitute
from ..linalg.rank_revealing_lu import WORN, Factors, dependent_speeds, smallest_pivot
from ..linalg.rank_revealing_lu import factorise as factorise_rows
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
def make_work(coordinates: int, factors: int) -> Work:
    """Work for a system of as many equations as coordinates, with room for as many rows of factors, or 0."""
    return Work(
        np.zeros((3, coordinates // 7, 3, 3)),
        np.zeros((6, coordinates)),
        np.zeros((coordinates, 14)),
        np.zeros((factors, factors)),
        np.zeros(factors, np.int64),
        np.zeros((factors, factors + 1), np.int64),
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
    largest_entry = 0.0
    for k in range(solution.size):
        value = unknown[system.places[k, COLUMN]]
        largest_entry = max(largest_entry, abs(value))
        solution[k] = value * system.units[OF_COORDINATE, k]
    return largest_entry


@kernel
def largest_scaled(system: System, values: np.ndarray) -> float:
    """Return the largest |value| of values (n,) of equations, each in its unit; NaN counts as infinite."""
    largest_entry = 0.0
    for row in range(values.size):
        value = abs(values[row]) * system.units[PER_ROW, row]
        if not value <= largest_entry:
            largest_entry = value if value > largest_entry else np.inf
    return largest_entry


@kernel
def largest(values: np.ndarray) -> float:
    """Return the largest magnitude in values (n,)."""
    largest_entry = 0.0
    for k in range(values.size):
        largest_entry = max(largest_entry, abs(values[k]))
    return largest_entry


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
    reach = 1.0
    for k in range(q.size):
        reach = max(reach, abs(q[k]) / system.units[OF_COORDINATE, k])
    return reach


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
def defects_of_rows(
    system: System, work: Work, states: np.ndarray, times: np.ndarray, order: int, expected: np.ndarray,
    defects: np.ndarray,
) -> None:  # fmt: skip
    """Fill defects (T, m) with Φ, Φ_q q̇ - ν or Φ_q q̈ - γ, by `order`; unscaled.

    At states (T, 3, n) and times (T,), s.
    """
    for k in range(times.size):
        q, right_side = states[k, 0], work.vectors[RIGHT_SIDE]
        evaluate_position(system, work, q, times[k], expected)
        if order > 0:
            equations.jacobian(system.constraints, q, work.rotations[A], work.phi_q)
        if order == 1:
            equations.velocity(system.constraints, times[k], right_side)
        elif order == 2:
            rotation_rates(q, states[k, 1], work.rotations[RATE], work.rotations[REMAINDER])
            equations.acceleration(system.constraints, q, states[k, 1], times[k], work.rotations, right_side)
        for row in range(defects.shape[1]):
            if order == 0:
                defects[k, row] = work.vectors[PHI, row]
            else:
                defects[k, row] = row_times(system, work, row, states[k, order]) - right_side[row]


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


ORDER_QUALITY, PARITY = 0, 1


class SparseWork(NamedTuple):
    """Arrays reused in every step, of n coordinates; the first three as in `newton.Work`."""

    rotations: np.ndarray  # (3, bodies, 3, 3) A, dA/dt, 1/s, and the remainder of d²A/dt², 1/s²
    vectors: np.ndarray  # (6, n) in units of equations or coordinates; rows PHI … REST
    phi_q: np.ndarray  # (n, 14) derivatives by the coordinates of both bodies, in units of both
    jacobian: np.ndarray  # (n, 14) its entries at the places of `columns`, in units of both
    columns: np.ndarray  # (n, 15) number of places of a row that may be other than zero, and these
    sources: np.ndarray  # (n, 14) their places in the row of phi_q
    order: np.ndarray  # (2 n,) numbers of rows, then columns, in the order of elimination
    factors: np.ndarray  # (n n,) scaled, `Factors.values`
    entries: np.ndarray  # (n n,) places, `Factors.places`
    ends: np.ndarray  # (n, 4) places, `Factors.ends`
    diagonal: np.ndarray  # (n,) `Factors.diagonal`, scaled
    chosen: np.ndarray  # (2,) no unit: ORDER_QUALITY, 0 where no order is chosen, and PARITY


@plain
def make_sparse_work(system: System, repeated: tuple[int, ...], dependent: tuple[int, ...]) -> SparseWork:
    """Work without the rows `repeated`, which repeat others; corrections of `dependent` coordinates are 0."""
    n = system.places.shape[0]
    columns, sources = np.zeros((n, 15), np.int64), np.zeros((n, 14), np.int64)
    for row in sorted(set(range(n)).difference(repeated)):
        i, j = int(system.places[row, BODY_I]), int(system.places[row, BODY_J])
        halves = [(i, 0)] if i == j else sorted([(i, 0), (j, 7)])
        entries = [
            (7 * body + k, at + k) for body, at in halves for k in range(7) if 7 * body + k not in dependent
        ]
        columns[row, 0] = len(entries)
        columns[row, 1 : 1 + len(entries)] = [place for place, _ in entries]
        sources[row, : len(entries)] = [source for _, source in entries]
    return SparseWork(
        np.zeros((3, n // 7, 3, 3)), np.zeros((6, n)), np.zeros((n, 14)), np.zeros((n, 14)), columns, sources,
        np.zeros(2 * n, np.int64), paged_zeros((n * n,)), paged_zeros((n * n,), np.int64),
        np.zeros((n, 4), np.int64), np.zeros(n), np.zeros(2),
    )  # fmt: skip


@kernel
def _fill_jacobian(system: System, work: SparseWork) -> None:
    for row in range(work.jacobian.shape[0]):
        doubled = system.places[row, BODY_I] == system.places[row, BODY_J]
        for p in range(work.columns[row, 0]):
            source, column = work.sources[row, p], work.columns[row, 1 + p]
            value = work.phi_q[row, source]
            if doubled:
                value += work.phi_q[row, source + 7]
            work.jacobian[row, p] = value * (system.units[OF_COORDINATE, column] * system.units[PER_ROW, row])


@allocating
def _choose(work: SparseWork, rank: int) -> int:
    """Choose the order by the Jacobian at hand; returns the rank, at most `rank`."""
    n, rank_and_size = work.diagonal.shape[0], choose_by_rows(work.jacobian, work.columns, work.order, rank)
    work.chosen[PARITY] = _sign(work.order[:n]) * _sign(work.order[n:])
    return rank_and_size


@allocating
def _sign(order: np.ndarray) -> int:
    """Return -1 for a permutation (n,) made of an odd number of exchanges, else 1: n less its cycles."""
    seen, sign = np.zeros(order.shape[0], np.int64), 1
    for first in range(order.shape[0]):
        k = first
        while seen[k] == 0:
            seen[k] = 1
            k = order[k]
            if k != first:
                sign = -sign
    return sign


@kernel
def factorise_sparse(system: System, work: SparseWork, q: np.ndarray) -> int:
    """Factors of Φ_q at q, where A belongs to q; returns the sign of det Φ_q, 0 where it is singular."""
    equations.jacobian(system.constraints, q, work.rotations[A], work.phi_q)
    _fill_jacobian(system, work)
    rank, quality = int(system.limits[RANK]), 0.0
    factors = Factors(work.factors, work.entries, work.ends, work.diagonal)
    if work.chosen[ORDER_QUALITY] > 0.0:
        quality = factorise_rows(work.jacobian, work.columns, work.order, rank, factors)
    if not quality > WORN * work.chosen[ORDER_QUALITY]:
        if _choose(work, rank) == rank:
            quality = factorise_rows(work.jacobian, work.columns, work.order, rank, factors)
        work.chosen[ORDER_QUALITY] = quality
    if not (quality > 0.0 and smallest_pivot(work.diagonal, rank) > system.limits[PIVOT]):
        work.chosen[ORDER_QUALITY] = 0.0
        return 0
    sign = int(work.chosen[PARITY])
    for k in range(rank):
        if work.diagonal[k] < 0.0:
            sign = -sign
    return sign


@kernel
def solve_sparse(system: System, work: SparseWork, right_side: np.ndarray, solution: np.ndarray) -> float:
    """Fill solution (n,) of Φ_q solution = right_side by the factors at hand; right_side (n,).

    Returns its largest scaled component.
    """
    scaled, unknown = work.vectors[SCALED], work.vectors[UNKNOWN]
    for row in range(scaled.size):
        scaled[row] = right_side[row] * system.units[PER_ROW, row]
    factors = Factors(work.factors, work.entries, work.ends, work.diagonal)
    dependent_speeds(factors, work.order, int(system.limits[RANK]), scaled, unknown)
    largest_entry = 0.0
    for k in range(solution.size):
        largest_entry = max(largest_entry, abs(unknown[k]))
        solution[k] = unknown[k] * system.units[OF_COORDINATE, k]
    return largest_entry


SPARSE = LinearSolver(factorise_sparse, solve_sparse)
