"""One step of the generalised-α method for constrained mechanisms, on the group of positions and attitudes.

Arnold, Brüls and Cardona, Numerische Mathematik 129 (2015), section 2: with the accelerations ud and
their means a,

    (1 - α_m) a' + α_m a = (1 - α_f) ud' + α_f ud,
    q' = q exp(h (u + h ((1/2 - β) a + β a'))),   u' = u + h ((1 - γ) a + γ a'),

parameters after Chung and Hulbert (1993) for the spectral radius ρ at infinity.  Unlike there, ud' meets
the constraints on accelerations, and positions and speeds are brought onto theirs within the same
iteration, by the shortest way: no constraint force oscillates for ρ = 1 or when the step changes.

Every iteration takes constraints and forces as they are; the matrix Zᵀ (M + γ' h D + β' h² K) Z of the
free motions is that of the first.
"""

import math
from typing import TYPE_CHECKING

import numpy as np

from .._jit import kernel, part
from ..constrained.accelerations import (
    SMALLEST_INERTIA,
    factorise_constraints,
    fill_column,
    fill_forces,
    reduce_mass,
    solve_rows,
)
from ..constrained.angle_unwrapping import EXPECTED, expect_angles
from ..constrained.dry_friction import has_friction
from ..constrained.mass_matrix import mass_matrices, mass_times
from ..constrained.projection import fill_residual, rate_gap
from ..constrained.report import TRIED, coordinates_and_speeds, fill_load_powers
from ..constrained.speeds import move
from ..constrained.system import (
    CORRECTION,
    FORCES,
    GAMMA,
    NO_INERTIA,
    PHI,
    PRODUCT,
    SOLVED,
    UNKNOWN,
    System,
    Work,
)
from ..constrained.tangent import tangent_times
from ..linalg.cholesky import cholesky
from ..linalg.rank_revealing_lu import row_times
from .error_norm import CAUTION
from .generalised_alpha_control import left_over, share_of
from .generalised_alpha_error import (
    ACCELERATION_GAP,
    BEFORE,
    LAST,
    MEAN,
    NEW,
    NEW_MEAN,
    POSITION_GAP,
    SPEED_GAP,
    correction_size,
    fastest_change,
    step_error,
)

if TYPE_CHECKING:
    from .generalised_alpha import AlphaIntegration


MOST_ITERATIONS = 12
STILL_ITERATIONS = 3  # of a state: positions, speeds, and accelerations that belong to both
FLOOR = 1e-13  # of the speeds: round-off
LEAST = 1e-2  # contraction that is trusted: the first of a step is better than those that follow
CLOSED_BY_ONE_MORE = 1e-10  # scaled gap that one more correction brings to round-off
GAP_OF_SHARE = (
    0.03  # of the root of the share of the tolerance: one more correction leaves a thousandth of it
)


@kernel
def parameters(rho: float) -> tuple[float, float, float, float]:
    """α_m, α_f, β, γ for the spectral radius rho at infinity."""
    alpha_m, alpha_f = (2.0 * rho - 1.0) / (rho + 1.0), rho / (rho + 1.0)
    gamma = 0.5 + alpha_f - alpha_m
    return alpha_m, alpha_f, 0.25 * (gamma + 0.5) ** 2, gamma


@part
def solve_step(system: System, work: Work, integration: "AlphaIntegration", h: float) -> bool:
    """Find the state `trial` at the end of a step of length h from z; returns whether it was found."""
    clock = integration.clock[0]
    alpha_m, alpha_f, beta, gamma = parameters(integration.memory[0]["rho"])
    share = (1.0 - alpha_f) / (1.0 - alpha_m)
    _predict(system, work, integration, h)
    if not iterate(system, work, integration, clock["t"] + h, share * beta * h * h, share * gamma * h, h):
        return False
    _finish(integration, alpha_m, alpha_f)
    return True


@kernel
def iterate(
    system: System,
    work: Work,
    integration: "AlphaIntegration",
    t: float,
    by_position: float,
    by_speed: float,
    h: float,
) -> bool:
    """Bring `trial` and the accelerations NEW to the equations at t; returns whether they came there.

    An acceleration moves positions and speeds by so much.  With h = 0 by nothing: the state is the one at
    t, and is brought onto the constraints.
    """
    clock, memory = integration.clock[0], integration.memory[0]
    # The first correction is trusted somewhat less than the last of the step before was.
    quality, left, before, gap_before = 0.0, memory["left"] ** CAUTION, 0.0, np.inf
    for iteration in range(MOST_ITERATIONS):
        clock["evaluations"] += 1
        clock["fault"] = _evaluate(system, work, integration, t)
        if clock["fault"] == SOLVED and (iteration == 0 or work.quality[0] != quality):
            # Other speeds are free from now on where the quality has changed.
            clock["fault"] = _set_matrix(system, work, integration, by_position, by_speed)
        if clock["fault"] != SOLVED:
            return False
        quality = work.quality[0]
        size, gap = _correct(system, work, integration, by_position, by_speed)
        if h == 0.0:
            # A row from afar needs more of them; equations that repeat others never close better.
            if iteration >= STILL_ITERATIONS - 1 and (gap < CLOSED_BY_ONE_MORE or not gap < 0.5 * gap_before):
                return True
            gap_before = gap
            continue
        if iteration > 0:
            contraction = size / before if before > 0.0 else 0.0
            # The second correction answers to the gaps that the first one closed.
            if iteration > 1 and not (contraction < 1.0 or size < FLOOR / clock["rtol"]):
                return False
            left = memory["left"] = max(contraction / (1.0 - min(contraction, 0.5)), LEAST)
        fastest = 0.0 if memory["fixed"] > 0.0 else fastest_change(system, integration)
        share = memory["share"] = share_of(clock, memory, work, h, fastest)
        clock["error"] = step_error(system, integration, h) / share
        enough = max(left_over(clock, memory, work, share), FLOOR / clock["rtol"])
        if left * size < enough and gap < _closed(clock, memory, share):
            return True
        before = size
    return False


@kernel
def _closed(clock: "np.void", memory: "np.void", share: float) -> float:
    """Return the scaled gap, before a correction, of which nothing is left that counts: it squares.

    A step of given length has no tolerance, and leaves round-off.
    """
    if memory["fixed"] > 0.0:
        return CLOSED_BY_ONE_MORE
    return max(CLOSED_BY_ONE_MORE, GAP_OF_SHARE * (share * clock["rtol"]) ** 0.5)


@part
def _predict(system: System, work: Work, integration: "AlphaIntegration", h: float) -> None:
    """The end of the step by accelerations that go on as before."""
    memory, n = integration.memory[0], system.speed_scale.shape[0]
    rates, length = integration.rates, integration.clock[0]["step_length"]
    alpha_m, alpha_f, beta, gamma = parameters(memory["rho"])
    step = work.vectors[CORRECTION, :n]
    for i in range(integration.z.shape[0]):
        integration.trial[i] = integration.z[i]
    q, u = coordinates_and_speeds(system, integration.trial)
    for k in range(n):
        last = rates[LAST, k]
        rates[NEW, k] = last
        if length > 0.0:
            ahead = (last - rates[BEFORE, k]) * h / length
            rates[NEW, k] += ahead
            if h == memory["mean_length"]:
                rates[MEAN, k] = last + (rates[MEAN, k] - last)
            else:
                # The mean belongs to a time that is a fixed part of a step away.  One that is carried over
                # would alternate, by more and more where steps grow.
                rates[MEAN, k] = last + (alpha_m - alpha_f) * ahead
        mean = rates[MEAN, k]
        new = ((1.0 - alpha_f) * rates[NEW, k] + alpha_f * last - alpha_m * mean) / (1.0 - alpha_m)
        step[k] = h * (u[k] + h * ((0.5 - beta) * mean + beta * new))
        u[k] += h * ((1.0 - gamma) * mean + gamma * new)
    memory["mean_length"] = h
    turn_exactly(system.masses.shape[0], q, step)
    expect_angles(system, work, integration, h)
    for k in range(work.angles.shape[0]):
        work.angles[k] = integration.angles[EXPECTED, k]


@part
def turn_exactly(bodies: int, q: np.ndarray, step: np.ndarray) -> None:
    """Move q by the displacements and rotation vectors (body axes) `step` (n,), of any size."""
    for body in range(bodies):
        k, s = 7 * body, 6 * body
        for i in range(3):
            q[k + i] += step[s + i]
        x, y, z = step[s + 3], step[s + 4], step[s + 5]
        angle = (x * x + y * y + z * z) ** 0.5
        c = math.cos(0.5 * angle)
        f = math.sin(0.5 * angle) / angle if angle > 1e-8 else 0.5
        x, y, z = f * x, f * y, f * z
        e0, e1, e2, e3 = q[k + 3], q[k + 4], q[k + 5], q[k + 6]
        q[k + 3] = c * e0 - e1 * x - e2 * y - e3 * z
        q[k + 4] = c * e1 + e0 * x - e3 * y + e2 * z
        q[k + 5] = c * e2 + e3 * x + e0 * y - e1 * z
        q[k + 6] = c * e3 - e2 * x + e1 * y + e0 * z
    for k in range(6 * bodies, step.shape[0]):
        q[k + bodies] += step[k]


@part
def _evaluate(system: System, work: Work, integration: "AlphaIntegration", t: float) -> int:
    """Everything that the equations of motion say of `trial` at t: forces and gaps; a code."""
    n = system.speed_scale.shape[0]
    q, u = coordinates_and_speeds(system, integration.trial)
    code = factorise_constraints(system, work, q)
    if code != SOLVED:
        return code
    mass_matrices(system, work, q)
    if has_friction(system.loads):
        code = reduce_mass(system, work)
        if code != SOLVED:
            return code
    gaps, ud = integration.gaps, integration.rates[NEW]
    fill_residual(system, work, q, t, integration.angles[EXPECTED])
    rate_gap(system, work, u, t)
    for row in range(gaps.shape[1]):
        gaps[POSITION_GAP, row] = -work.rows[PHI, row]
        gaps[SPEED_GAP, row] = work.rows[GAMMA, row]
    power = fill_forces(system, work, q, u, t)
    for row in range(gaps.shape[1]):
        total = row_times(work.jacobian, work.columns, row, ud, system.speed_scale)
        gaps[ACCELERATION_GAP, row] = work.rows[GAMMA, row] - total * system.row_scale[row]
    forces, product = integration.missing[ACCELERATION_GAP], work.vectors[PRODUCT]
    mass_times(system, work, ud, product)
    for k in range(n):
        forces[k] = work.vectors[FORCES, k] - product[k]
        # Constraints that do not move do no work: what is left of their power is the drivers'.
        power -= forces[k] * u[k]
    integration.memory[0]["new_power"] = power
    fill_load_powers(work, integration.load_powers[TRIED])
    return code


@part
def _set_matrix(
    system: System, work: Work, integration: "AlphaIntegration", by_position: float, by_speed: float
) -> int:
    """Zᵀ (M + by_speed D + by_position K) Z where everything stands, and its Cholesky factor; a code."""
    n = system.speed_scale.shape[0]
    rank, matrix, Z = work.rank[0], integration.newton.reduced, work.motions
    column, product = work.vectors[UNKNOWN], work.vectors[PRODUCT]
    for f in range(n - rank):
        for k in range(n):
            column[k] = Z[k, f] * system.speed_scale[k]
        tangent_times(system, work, by_position, by_speed, column, product)
        fill_column(system, work, product, f, matrix)
    return NO_INERTIA if cholesky(matrix, n - rank, SMALLEST_INERTIA) else SOLVED


@part
def _correct(
    system: System, work: Work, integration: "AlphaIntegration", by_position: float, by_speed: float
) -> tuple[float, float]:
    """Newton's correction; returns its size in tolerances and the largest scaled gap before it."""
    n = system.speed_scale.shape[0]
    q, u = coordinates_and_speeds(system, integration.trial)
    gaps, corrections = integration.gaps, integration.corrections
    found, kinds = _largest(system, work, gaps), 3 if gaps.shape[1] > 0 else 1
    for row in range(gaps.shape[1]):
        gaps[SPEED_GAP, row] -= by_speed * gaps[ACCELERATION_GAP, row]
        gaps[POSITION_GAP, row] -= by_position * gaps[ACCELERATION_GAP, row]
    solve_rows(
        system, integration.newton, integration.missing, gaps, corrections[:kinds], integration.free[:kinds]
    )
    step = corrections[ACCELERATION_GAP]
    for k in range(n):
        integration.rates[NEW, k] += step[k]
        u[k] += by_speed * step[k]
    size = correction_size(system, integration, by_speed)
    for k in range(n):
        step[k] *= by_position
        if kinds > 1:
            u[k] += corrections[SPEED_GAP, k]
            step[k] += corrections[POSITION_GAP, k]
    move(system.masses.shape[0], q, step)
    return size, found


@part
def _largest(system: System, work: Work, gaps: np.ndarray) -> float:
    """The largest scaled gap of positions and speeds, of the independent equations."""
    found = 0.0
    for kind in (SPEED_GAP, POSITION_GAP):
        for k in range(work.rank[0]):
            row = work.order[k]
            found = max(found, abs(gaps[kind, row]) / system.row_scale[row])
    return found


@part
def _finish(integration: "AlphaIntegration", alpha_m: float, alpha_f: float) -> None:
    """The means that belong to the accelerations found."""
    rates = integration.rates
    for k in range(rates.shape[1]):
        new = (1.0 - alpha_f) * rates[NEW, k] + alpha_f * rates[LAST, k] - alpha_m * rates[MEAN, k]
        rates[NEW_MEAN, k] = new / (1.0 - alpha_m)
