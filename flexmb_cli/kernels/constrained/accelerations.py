"""Accelerations, projections and multipliers of a mechanism at one position, by its free speeds.

The speeds of a mechanism are split by elimination into dependent ones and free ones.  With Z the
motions that the constraints leave free, J x = γ and M x = f + Jᵀ λ give

    x = x_p + Z y,   Zᵀ M Z y = Zᵀ (f - M x_p),   J x_p = γ.

Only the mass matrix of the free motions must be positive definite: massless couplers are allowed.
With f = 0 the same solution is the shortest correction in the metric of M: one set of factors serves
accelerations and projections.
"""

from typing import Any

import numpy as np

from .._jit import allocating, kernel, part
from ..kinematics import constraints as equations
from ..laws import DAMPING, EFFORT, NORMAL, POWER, STIFFNESS
from ..linalg.cholesky import cholesky, cholesky_solve, cholesky_solve_rows
from ..linalg.local_order import choose_by_rows
from ..linalg.number_rows import copy
from ..linalg.pivot_order import choose
from ..linalg.rank_revealing_lu import WORN, dependent_speeds, factorise, free_motions, row_times
from ..linalg.rotation import RATE, REMAINDER, A, rotation_matrices, rotation_rates
from .body_vectors import geometry_of, move_vectors, place_vectors
from .constraint_primitives import equation_accelerations, equation_rows
from .dry_friction import (
    COMPONENTS,
    fill_feedback,
    fill_joint_forces,
    fill_normal_forces,
    first_friction,
    has_friction,
)
from .elements import add_unit_friction
from .forces import add_applied_forces
from .mass_matrix import inertia_and_elastic_forces, mass_matrices, mass_times
from .multipliers import fill_multipliers
from .rolling_rows import has_rolling
from .speeds import add_turning, coordinate_rates, speed_jacobian
from .system import (
    FORCES,
    FREE,
    GAMMA,
    NO_INERTIA,
    PRODUCT,
    QD,
    SCALED,
    SINGULAR,
    SOLVED,
    UNKNOWN,
    System,
    Work,
    factors_of,
)

SMALLEST_INERTIA = 1e-13  # pivot of a reduced mass matrix, of its diagonal entry
DENSE_START = 10  # up to them the zeros of one position decide on the order of elimination


@kernel
def evaluate_jacobian(system: System, work: Work, q: np.ndarray) -> None:
    """Fill A, the body vectors, Φ_q and the scaled Jacobian on speeds of `work` at q."""
    rotation_matrices(q, work.rotations[A])
    place_vectors(geometry_of(system, work), q)
    equations.jacobian(system.constraints, q, work.rotations[A], work.phi_q)
    speed_jacobian(system.bodies, q, work.phi_q, work.scales, work.jacobian)
    equation_rows(system, work, work.jacobian)
    for row in range(work.phi_q.shape[0], work.jacobian.shape[0]):
        for p in range(work.columns[row, 0]):
            work.jacobian[row, p] *= work.scales[row, p]


@kernel
def choose_order(work: Work, most: int) -> int:
    """Find which equations and speeds are independent from now on; returns the rank found."""
    work.rank[0] = _choose(work, most)
    work.quality[0] = factorise_order(work)
    return work.rank[0]


@allocating
def _choose(work: Work, most: int) -> int:
    """Fill the order by the Jacobian at hand; returns the rank, at most `most`."""
    if work.mass.shape[0] > DENSE_START:
        return choose_by_rows(work.jacobian, work.columns, work.order, most)
    J = np.zeros((work.jacobian.shape[0], work.motions.shape[0]))
    for i in range(J.shape[0]):
        for p in range(work.columns[i, 0]):
            J[i, work.columns[i, 1 + p]] = work.jacobian[i, p]
    return choose(J, work.order, most)


@kernel
def factorise_order(work: Work):
    """Factors of the Jacobian in the order at hand; returns their quality, 0 where a pivot vanishes."""
    return factorise(work.jacobian, work.columns, work.order, work.rank[0], factors_of(work))


@kernel
def factorise_at(system: System, work: Work, q: np.ndarray) -> int:
    """Factors at q of the constraints and of the mass matrix of the free motions: a code."""
    code = factorise_constraints(system, work, q)
    if code != SOLVED:
        return code
    mass_matrices(system, work, q)
    return reduce_mass(system, work)


@kernel
def factorise_constraints(system: System, work: Work, q: np.ndarray) -> int:
    """Factors at q of the constraints, and the motions they leave free: a code."""
    evaluate_jacobian(system, work, q)
    rank = work.rank[0]
    quality = factorise_order(work)
    if not quality > WORN * work.quality[0]:
        if _choose(work, rank) < rank:
            return SINGULAR
        quality = work.quality[0] = factorise_order(work)
        if not quality > 0.0:
            return SINGULAR
    free_motions(factors_of(work), work.order, rank, work.motions)
    return SOLVED


@kernel
def factorise_for_forces(system: System, work: Work, q: np.ndarray) -> int:
    """Factors at q of the constraints, mass matrices, and what the forces there need besides: a code."""
    code = factorise_constraints(system, work, q)
    if code != SOLVED:
        return code
    mass_matrices(system, work, q)
    return reduce_mass(system, work) if has_friction(system.loads) else SOLVED


@part
def reduce_mass(system: System, work: Work) -> int:
    """Zᵀ M Z and its Cholesky factor."""
    free = work.motions.shape[0] - work.rank[0]
    column, product = work.vectors[UNKNOWN], work.vectors[PRODUCT]
    for f in range(free):
        for k in range(work.motions.shape[0]):
            column[k] = work.motions[k, f] * system.speed_scale[k]
        mass_times(system, work, column, product)
        fill_column(system, work, product, f, work.reduced)
    return NO_INERTIA if cholesky(work.reduced, free, SMALLEST_INERTIA) else SOLVED


@kernel
def fill_column(system: System, work: Work, product: np.ndarray, f: int, matrix: np.ndarray) -> None:
    """Fill column f of the lower part of matrix (n, n) with Zᵀ product, product (n,).

    A free motion moves one free speed and dependent ones: only these are visited.  Overwrites FREE.
    """
    rank, m, n = work.rank[0], work.jacobian.shape[0], work.motions.shape[0]
    order, Z, scale, total = work.order, work.motions, system.speed_scale, work.vectors[FREE]
    for g in range(f, n - rank):
        k = order[m + rank + g]
        total[g] = scale[k] * product[k]
    for d in range(rank):
        k = order[m + d]
        amount = scale[k] * product[k]
        if amount != 0.0:
            for g in range(f, n - rank):
                total[g] += Z[k, g] * amount
    for g in range(f, n - rank):
        matrix[g, f] = total[g]


@kernel
def solve(system: System, work: Work, forces: np.ndarray, gamma: np.ndarray, x: np.ndarray) -> None:
    """Fill x (n,) with J x = gamma and M x = forces + Jᵀ λ, by the factors at hand."""
    y = work.vectors[FREE]
    split(system, work, forces, gamma, x, y)
    cholesky_solve(work.reduced, work.motions.shape[0] - work.rank[0], y)
    add_free(system, work, work.motions, y, x)


@kernel
def solve_rows(
    system: System, work: Work, forces: np.ndarray, gamma: np.ndarray, x: np.ndarray, free: np.ndarray
) -> None:
    """Fill each row of x (r, n) as `solve` does for a row of forces (r, n) and one of gamma (r, m).

    free (r, n) is work.
    """
    count = work.motions.shape[0] - work.rank[0]
    for k in range(x.shape[0]):
        split(system, work, forces[k], gamma[k], x[k], free[k])
    cholesky_solve_rows(work.reduced, count, free)
    for k in range(x.shape[0]):
        add_free(system, work, work.motions, free[k], x[k])


@kernel
def split(
    system: System, work: Work, forces: np.ndarray, gamma: np.ndarray, x: np.ndarray, y: np.ndarray
) -> Any:
    """Fill x (n,) with x_p, by dependent speeds alone, and y (n - rank,) with Zᵀ (forces - M x_p)."""
    rank, m, n = work.rank[0], work.jacobian.shape[0], work.motions.shape[0]
    right_side, scaled, product = work.rows[SCALED], work.vectors[UNKNOWN], work.vectors[PRODUCT]
    order, Z, scale = work.order, work.motions, system.speed_scale
    for row in range(m):
        right_side[row] = gamma[row] / system.row_scale[row]
    dependent_speeds(factors_of(work), order, rank, right_side, scaled)
    for k in range(n):
        x[k] = scaled[k] * scale[k]
    mass_times(system, work, x, product)
    for f in range(n - rank):
        k = order[m + rank + f]
        y[f] = scale[k] * (forces[k] - product[k])
    for d in range(rank):
        k = order[m + d]
        amount = scale[k] * (forces[k] - product[k])
        if amount != 0.0:
            for f in range(n - rank):
                y[f] += Z[k, f] * amount


@kernel
def add_free(system: System, work: Work, Z: np.ndarray, y: np.ndarray, x: np.ndarray) -> None:
    """Add Z y to x (n,): y (n - rank,), Z (n, n - rank) the free motions of some position.

    The order is that of the work.
    """
    rank, m, n = work.rank[0], work.jacobian.shape[0], work.motions.shape[0]
    order, scale = work.order, system.speed_scale
    for f in range(n - rank):
        k = order[m + rank + f]
        x[k] += scale[k] * y[f]
    for d in range(rank):
        k, total = order[m + d], 0.0
        for f in range(n - rank):
            total += Z[k, f] * y[f]
        x[k] += scale[k] * total


@part
def accelerations(
    system: System, work: Work, q: np.ndarray, u: np.ndarray, t: float, ud: np.ndarray
) -> tuple[int, float]:
    """Fill ud (n,), the rates of the speeds u at q; returns (code, power), the power that of `accelerate`."""
    code = factorise_at(system, work, q)
    return code, accelerate(system, work, q, u, t, ud) if code == SOLVED else 0.0


@part
def accelerate(system: System, work: Work, q: np.ndarray, u: np.ndarray, t: float, ud: np.ndarray) -> float:
    """Fill ud (n,), the rates of the speeds u at q, whose factors are at hand.

    Returns the power of the drivers and of the applied forces that store no energy, W.  FORCES of the
    work then holds all forces but those of the constraints.
    """
    power = fill_forces(system, work, q, u, t)
    solve(system, work, work.vectors[FORCES], work.rows[GAMMA], ud)
    return add_power_of_drivers(system, work, u, ud, power)


@part
def add_power_of_drivers(system: System, work: Work, u: np.ndarray, ud: np.ndarray, power: float) -> float:
    """Return a power and that of the drivers at accelerations ud (n,): all other constraints do no work."""
    forces, product = work.vectors[FORCES], work.vectors[PRODUCT]
    mass_times(system, work, ud, product)
    for k in range(u.shape[0]):
        power += (product[k] - forces[k]) * u[k]
    return power


@part
def fill_forces(system: System, work: Work, q: np.ndarray, u: np.ndarray, t: float) -> float:
    """Fill GAMMA, and FORCES with all but the constraint forces; returns the power of those that store no
    energy.

    Mass matrices, body vectors and factors of the constraints belong to q, where there is friction those of
    `reduce_mass` too.
    """
    move_vectors(geometry_of(system, work), u)
    _fill_gamma(system, work, q, u, t)
    power = inertia_and_elastic_forces(system, work, q, u, work.vectors[FORCES])
    power += add_applied_forces(system, work, u, t, work.vectors[FORCES])
    if has_friction(system.loads):
        power += _add_friction(system, work)
    return power


@part
def missing_forces(
    system: System,
    work: Work,
    q: np.ndarray,
    u: np.ndarray,
    t: float,
    ud: np.ndarray,
    gaps: np.ndarray,
    missing: np.ndarray,
) -> float:
    """Fill gaps (m,), γ - J ud, and missing (n,), f - M ud, of accelerations ud (n,); returns the power.

    Factors are those of `factorise_for_forces`; FORCES and the power are those of `accelerate`.
    """
    power = fill_forces(system, work, q, u, t)
    for row in range(gaps.shape[0]):
        total = row_times(work.jacobian, work.columns, row, ud, system.speed_scale)
        gaps[row] = work.rows[GAMMA, row] - total * system.row_scale[row]
    mass_times(system, work, ud, work.vectors[PRODUCT])
    for k in range(ud.shape[0]):
        missing[k] = work.vectors[FORCES, k] - work.vectors[PRODUCT, k]
        # Constraints that do not move do no work: what is left of their power is the drivers'.
        power -= missing[k] * u[k]
    return power


@allocating
def _add_friction(system: System, work: Work) -> float:
    """Add the friction of all joints to FORCES, on which it depends, and on GAMMA; returns its power."""
    m, n, first = work.jacobian.shape[0], work.motions.shape[0], first_friction(system.loads)
    count, applied = system.loads.shape[0] - first, work.vectors[FORCES]
    sides, gamma, ud = np.zeros((1 + count, n)), np.zeros((2, m)), np.empty(n)
    forces, normals = np.empty((1 + count, count, COMPONENTS)), np.empty(count)
    feedback = np.empty(count)
    copy(work.rows[GAMMA], gamma[0])
    for k in range(1 + count):
        if k == 0:
            copy(applied[:n], sides[k])
        else:
            add_unit_friction(system, work, first + k - 1, sides[k])
            copy(sides[k], applied)
        solve(system, work, applied, gamma[min(k, 1)], ud)
        fill_multipliers(system, work, ud, work.rows[SCALED])
        fill_joint_forces(system, work, first, work.rows[SCALED], forces[k])
    fill_normal_forces(forces, normals)
    fill_feedback(forces, normals, feedback)
    copy(sides[0], applied)
    power = 0.0
    for k in range(count):
        answer = work.responses[first + k]
        for column in (EFFORT, POWER, STIFFNESS, DAMPING, NORMAL):
            answer[column] *= normals[k]
        answer[STIFFNESS] *= feedback[k]
        answer[DAMPING] *= feedback[k]
        power += answer[POWER]
        for i in range(n):
            applied[i] += normals[k] * sides[1 + k, i]
    return power


@part
def _fill_gamma(system: System, work: Work, q: np.ndarray, u: np.ndarray, t: float) -> None:
    """Fill GAMMA, the right-hand side of J u̇ = γ, where phi_q and the moved body vectors belong to q and
    u.
    """
    qd, gamma = work.vectors[QD], work.rows[GAMMA]
    if system.constraints.shape[0] > 0 or has_rolling(system.primitives):
        coordinate_rates(system.masses.shape[0], q, u, qd)
        rotation_rates(q, qd, work.rotations[RATE], work.rotations[REMAINDER])
    if system.constraints.shape[0] > 0:
        equations.acceleration(system.constraints, q, qd, t, work.rotations, gamma)
        add_turning(system.bodies, q, u, work.phi_q, gamma)
    equation_accelerations(system, work, t, gamma)
