"""Accelerations, projections and multipliers of a mechanism at one position, by its free speeds.

The speeds of a mechanism are split by elimination into dependent ones and free ones.  With Z the
motions that the constraints leave free, J x = γ and M x = f + Jᵀ λ give

    x = x_p + Z y,   Zᵀ M Z y = Zᵀ (f - M x_p),   J x_p = γ.

Only the mass matrix of the free motions must be positive definite: massless couplers are allowed.
With f = 0 the same solution is the shortest correction in the metric of M: one set of factors serves
accelerations and projections.
"""

from . import constraints as equations
from ._jit import kernel, part
from .arms import move_arms, place_arms
from .constrained_system import (
    FORCES,
    FREE,
    GAMMA,
    NO_INERTIA,
    PRODUCT,
    QD,
    RATE,
    REMAINDER,
    SCALED,
    SINGULAR,
    SOLVED,
    UNKNOWN,
    A,
)
from .forces import add_applied_forces
from .independent_rows import (
    WORN,
    cholesky,
    cholesky_solve,
    choose,
    dependent_speeds,
    factorise,
    free_motions,
)
from .mass_matrix import inertia_and_elastic_forces, mass_matrices, mass_times
from .measures import equation_accelerations, equation_rows
from .rotation import rotation_matrices, rotation_rates
from .speeds import add_turning, coordinate_rates, speed_jacobian

SMALLEST_INERTIA = 1e-13  # pivot of the reduced mass matrix, of its diagonal entry


@kernel
def evaluate_jacobian(system, work, q):
    """Fill A, the arms, Φ_q and the scaled Jacobian on speeds of `work` at q."""
    rotation_matrices(q, work.rotations[A])
    place_arms(system, work, q)
    equations.jacobian(system.constraints, q, work.rotations[A], work.phi_q)
    speed_jacobian(system.bodies, q, work.phi_q, work.jacobian)
    equation_rows(system, work, work.jacobian)
    for row in range(work.jacobian.shape[0]):
        for k in range(work.jacobian.shape[1]):
            if work.jacobian[row, k] != 0.0:
                work.jacobian[row, k] *= system.speed_scale[k] / system.row_scale[row]


@kernel
def choose_order(work, most):
    """Find which equations and speeds are independent from now on; returns the rank found."""
    work.rank[0] = choose(work.jacobian, work.left, work.order, most)
    work.quality[0] = factorise(work.jacobian, work.order, work.rank[0], work.factors)
    return work.rank[0]


@kernel
def factorise_at(system, work, q):
    """Factors at q of the constraints and of the mass matrix of the free motions: a code."""
    code = factorise_constraints(system, work, q)
    if code != SOLVED:
        return code
    mass_matrices(system, work, q)
    return _reduce_mass(system, work, work.jacobian.shape[1] - work.rank[0])


@kernel
def factorise_constraints(system, work, q):
    """Factors at q of the constraints, and the motions they leave free: a code."""
    evaluate_jacobian(system, work, q)
    rank, m = work.rank[0], work.jacobian.shape[0]
    quality = factorise(work.jacobian, work.order, rank, work.factors)
    if not quality > WORN * work.quality[0]:
        if choose(work.jacobian, work.left, work.order, rank) < rank:
            return SINGULAR
        quality = work.quality[0] = factorise(work.jacobian, work.order, rank, work.factors)
        if not quality > 0.0:
            return SINGULAR
    free_motions(work.factors, work.order, rank, m, work.motions)
    return SOLVED


@part
def _reduce_mass(system, work, free):
    """Zᵀ M Z and its Cholesky factor."""
    n = work.jacobian.shape[1]
    column, product = work.vectors[UNKNOWN], work.vectors[PRODUCT]
    for f in range(free):
        for k in range(n):
            column[k] = work.motions[k, f] * system.speed_scale[k]
        mass_times(system, work, column, product)
        for g in range(f, free):
            total = 0.0
            for k in range(n):
                if work.motions[k, g] != 0.0:
                    total += work.motions[k, g] * system.speed_scale[k] * product[k]
            work.reduced[g, f] = total
    return NO_INERTIA if cholesky(work.reduced, free, SMALLEST_INERTIA) else SOLVED


@kernel
def solve(system, work, forces, gamma, x):
    """Fill x (n,) with J x = gamma and M x = forces + Jᵀ λ, by the factors at hand."""
    rank, (m, n) = work.rank[0], work.jacobian.shape
    right_side, scaled, product = work.rows[SCALED], work.vectors[UNKNOWN], work.vectors[PRODUCT]
    y = work.vectors[FREE]
    for row in range(m):
        right_side[row] = gamma[row] / system.row_scale[row]
    dependent_speeds(work.factors, work.order, rank, m, right_side, scaled)
    for k in range(n):
        x[k] = scaled[k] * system.speed_scale[k]
    mass_times(system, work, x, product)
    for f in range(n - rank):
        y[f] = 0.0
        for k in range(n):
            if work.motions[k, f] != 0.0:
                y[f] += work.motions[k, f] * system.speed_scale[k] * (forces[k] - product[k])
    cholesky_solve(work.reduced, n - rank, y)
    for k in range(n):
        for f in range(n - rank):
            x[k] += work.motions[k, f] * y[f] * system.speed_scale[k]


@part
def accelerations(system, work, q, u, t, ud):
    """Fill ud (n,), the rates of the speeds u at q; returns (code, power).

    `power`: of the drivers and of the applied forces that store no energy, W.  FORCES of the work
    then holds all forces but those of the constraints.
    """
    code = factorise_at(system, work, q)
    if code != SOLVED:
        return code, 0.0
    power = fill_forces(system, work, q, u, t)
    fill_gamma(system, work, q, u, t)
    forces, product = work.vectors[FORCES], work.vectors[PRODUCT]
    solve(system, work, forces, work.rows[GAMMA], ud)
    # Constraints that do not move do no work: what is left of their power is the drivers'.
    mass_times(system, work, ud, product)
    for k in range(u.shape[0]):
        power += (product[k] - forces[k]) * u[k]
    return code, power


@part
def fill_forces(system, work, q, u, t):
    """Fill FORCES with all but the constraint forces; returns the power of those that store no energy.

    Mass matrices and arms belong to q.
    """
    move_arms(system, work, u)
    power = inertia_and_elastic_forces(system, work, q, u, work.vectors[FORCES])
    return power + add_applied_forces(system, work, u, t, work.vectors[FORCES])


@part
def fill_gamma(system, work, q, u, t):
    """Fill GAMMA, the right-hand side of J u̇ = γ, where phi_q and the moved arms belong to q and u."""
    qd, gamma = work.vectors[QD], work.rows[GAMMA]
    coordinate_rates(system.masses.shape[0], q, u, qd)
    rotation_rates(q, qd, work.rotations[RATE], work.rotations[REMAINDER])
    equations.acceleration(system.constraints, q, qd, t, work.rotations, gamma)
    add_turning(system.bodies, q, u, work.phi_q, gamma)
    equation_accelerations(system, work, t, gamma)
