"""One step of Radau's method IIA of order 5 for constrained mechanisms, stiff in modes, springs and dampers.

Hairer and Wanner, Solving Ordinary Differential Equations II (second edition), section IV.8, for u̇ = a(q, u,
t), the accelerations of the index-1 equations.  Attitudes are rotation vectors θ from the start of the step,

    θ̇ = ω + ½ θ × ω + (1/|θ|² - cot(|θ|/2) / (2 |θ|)) θ × (θ × ω)

in body axes, the inverse of the derivative of the exponential map.
Newton's matrix is that of the free motions at the start of the step, with ⊗ by the stages' weights A

    1 ⊗ Zᵀ M Z + h A ⊗ Zᵀ D Z + h² A² ⊗ Zᵀ K Z,

which the eigenvectors of A part into a real matrix and a complex one.  What else accelerations depend on
is left to the iteration.
"""

import math
from typing import TYPE_CHECKING

from .._jit import kernel
from ..constrained.accelerations import (
    SMALLEST_INERTIA,
    add_free,
    factorise_constraints,
    fill_column,
    fill_forces,
    reduce_mass,
    split,
)
from ..constrained.dry_friction import has_friction
from ..constrained.mass_matrix import mass_matrices, mass_times
from ..constrained.report import TRIED, coordinates_and_speeds, fill_load_powers
from ..constrained.system import FORCES, GAMMA, PRODUCT, SOLVED, UNKNOWN, System, Work
from ..constrained.tangent import add_stiff
from ..linalg.cholesky import cholesky, cholesky_solve
from ..linalg.complex_ldl import factorise_symmetric, solve_symmetric
from ..linalg.rank_revealing_lu import row_times
from .error_norm import CAUTION, displacement_tolerance, tolerance
from .generalised_alpha_step import turn_exactly
from .radau5_table import (
    COMPLEX,
    COMPLEX_LEFT,
    COMPLEX_RIGHT,
    REAL,
    REAL_LEFT,
    REAL_RIGHT,
    STAGES,
    TIMES,
    WEIGHTS,
)
from .rotation_increments import set_slope
from .singular_ahead import blur

if TYPE_CHECKING:
    import numpy as np

    from .radau5 import RadauIntegration


# Rows of the accelerations kept (8, n): of the start and the stages of a step, the one that is tried and
# that before.
START, LAST_STEP = 0, 4
# Layers of the matrices (3, n, n): M, D and K of the free motions, lower parts.
MASS_LAYER, DAMPING_LAYER, STIFFNESS_LAYER = 0, 1, 2

MOST_ITERATIONS = 10
LEAST = 1e-3  # contraction that is trusted
SECOND = 2.0  # contraction with which the second correction continues
FLOOR = 1e-14  # of the speeds: round-off


@kernel
def renew_matrices(system: System, work: Work, matrices: "np.ndarray") -> None:
    """Fill matrices (3, n, n) with M, D and K of the free motions where everything stands."""
    free = work.motions.shape[0] - work.rank[0]
    column, product = work.vectors[UNKNOWN], work.vectors[PRODUCT]
    for f in range(free):
        for k in range(work.motions.shape[0]):
            column[k] = work.motions[k, f] * system.speed_scale[k]
        mass_times(system, work, column, product)
        fill_column(system, work, product, f, matrices[MASS_LAYER])
        for kind in (DAMPING_LAYER, STIFFNESS_LAYER):
            product[:] = 0.0
            by_position, by_speed = (1.0, 0.0) if kind == STIFFNESS_LAYER else (0.0, 1.0)
            add_stiff(system, work, by_position, by_speed, column, product)
            fill_column(system, work, product, f, matrices[kind])


@kernel
def prepare(integration: "RadauIntegration", free: int, h: float) -> bool:
    """Factors of the real and the complex matrix for steps of length h; returns whether there are any."""
    matrices, real, rest = integration.matrices, integration.newton.reduced, integration.complex
    a, c = h * REAL, h * COMPLEX
    for k in range(free):
        for f in range(k + 1):
            m, d, s = (
                matrices[MASS_LAYER, k, f],
                matrices[DAMPING_LAYER, k, f],
                matrices[STIFFNESS_LAYER, k, f],
            )
            real[k, f] = m + a * d + a * a * s
            rest[k, f] = m + c * d + c * c * s
    if cholesky(real, free, SMALLEST_INERTIA):
        return False
    factorise_symmetric(rest, free)
    return True


@kernel
def solve_step(system: System, work: Work, integration: "RadauIntegration", h: float) -> bool:
    """Find the stages of a step of length h from z, the last of which is its end; whether they were found.

    The matrices belong to z.
    """
    clock, quality = integration.clock[0], work.quality[0]
    if not prepare(integration, work.motions.shape[0] - work.rank[0], h):
        return False
    predict(system, integration, h)
    left, before = integration.memory[0]["left"] ** CAUTION, 0.0
    for iteration in range(MOST_ITERATIONS):
        for stage in range(STAGES):
            clock["evaluations"] += 1
            clock["fault"] = _evaluate(system, work, integration, stage, clock["t"] + TIMES[stage] * h)
            # Other speeds are free from now on where the quality has changed.
            if clock["fault"] != SOLVED or work.quality[0] != quality:
                return False
        _correct(system, work, integration)
        size = place_stages(system, integration, h)
        if iteration > 0:
            contraction = size / before if before > 0.0 else 0.0
            weakest = SECOND if iteration == 1 else 1.0
            if not (contraction < weakest or size < FLOOR / clock["rtol"]):
                return False
            left = integration.memory[0]["left"] = max(contraction / (1.0 - min(contraction, 0.5)), LEAST)
        enough = max(min(0.03, clock["rtol"] ** 0.5), FLOOR / clock["rtol"])
        if left * size < enough * blur(work, clock["rtol"]):
            return True
        before = size
    return False


@kernel
def predict(system: System, integration: "RadauIntegration", h: float) -> None:
    """Accelerations that go on as before: the cubic through those of the last step."""
    rates, ratio = integration.rates, 0.0
    if integration.clock[0]["step_length"] > 0.0:
        ratio = h / integration.clock[0]["step_length"]
    for stage in range(STAGES):
        x = 1.0 + ratio * TIMES[stage]
        for k in range(rates.shape[1]):
            rates[1 + stage, k] = 0.0
        for node in range(STAGES + 1):
            weight, at = 1.0, TIMES[node - 1] if node > 0 else 0.0
            for other in range(STAGES + 1):
                there = TIMES[other - 1] if other > 0 else 0.0
                if other != node:
                    weight *= (x - there) / (at - there)
            for k in range(rates.shape[1]):
                rates[1 + stage, k] += weight * rates[LAST_STEP + node, k]
    integration.shifts[:] = 0.0
    _forget_failure(system, integration)
    # θ̇ depends on θ: the second time it is a good one.
    for _ in range(2):
        place_stages(system, integration, h)


@kernel
def _forget_failure(system: System, integration: "RadauIntegration") -> None:
    """Take the speeds of the start for those of stages that are not numbers.

    Where a load had no force in the last try, as jammed friction, no change would make them numbers again.
    """
    u = coordinates_and_speeds(system, integration.z)[1]
    for stage in range(STAGES):
        for k in range(u.shape[0]):
            if not math.isfinite(integration.speeds[stage, k]):
                integration.speeds[stage, k] = u[k]


@kernel
def place_stages(system: System, integration: "RadauIntegration", h: float) -> float:
    """Speeds and shifts (displacements, rotation vectors) of the stages from their accelerations.

    Returns by how many tolerances they change.
    """
    clock, rates, speeds, slopes, shifts = (
        integration.clock[0],
        integration.rates,
        integration.speeds,
        integration.slopes,
        integration.shifts,
    )
    n, total = rates.shape[1], 0.0
    u = coordinates_and_speeds(system, integration.z)[1]
    first = clock["counted"] - n
    for stage in range(STAGES):
        for k in range(n):
            change = 0.0
            for j in range(STAGES):
                change += WEIGHTS[stage, j] * rates[1 + j, k]
            change = u[k] + h * change - speeds[stage, k]
            speeds[stage, k] += change
            scale = tolerance(clock, integration.units[first + k], abs(u[k]))
            total += (change / scale) ** 2
        set_slope(system.masses.shape[0], shifts[stage], speeds[stage], slopes[stage])
    for stage in range(STAGES):
        for k in range(n):
            change = 0.0
            for j in range(STAGES):
                change += WEIGHTS[stage, j] * slopes[j, k]
            change = h * change - shifts[stage, k]
            shifts[stage, k] += change
            total += (change / displacement_tolerance(clock, system.speed_scale[k])) ** 2
    return (total / (2.0 * STAGES * n)) ** 0.5


@kernel
def place_trial(system: System, integration: "RadauIntegration", stage: int) -> None:
    """The state of a stage in `trial`."""
    for i in range(integration.z.shape[0]):
        integration.trial[i] = integration.z[i]
    q, u = coordinates_and_speeds(system, integration.trial)
    turn_exactly(system.masses.shape[0], q, integration.shifts[stage])
    for k in range(u.shape[0]):
        u[k] = integration.speeds[stage, k]


@kernel
def _evaluate(system: System, work: Work, integration: "RadauIntegration", stage: int, t: float) -> int:
    """Evaluate the residual of the equations of motion at a stage, by independent speeds; return a code."""
    place_trial(system, integration, stage)
    q, u = coordinates_and_speeds(system, integration.trial)
    code = factorise_constraints(system, work, q)
    if code != SOLVED:
        return code
    n, rank, ud = u.shape[0], work.rank[0], integration.rates[1 + stage]
    mass_matrices(system, work, q)
    if has_friction(system.loads):
        code = reduce_mass(system, work)
        if code != SOLVED:
            return code
    power = fill_forces(system, work, q, u, t)
    gaps, product, missing = work.rows[GAMMA], work.vectors[PRODUCT], integration.missing
    for row in range(gaps.shape[0]):
        total = row_times(work.jacobian, work.columns, row, ud, system.speed_scale)
        gaps[row] -= total * system.row_scale[row]
    mass_times(system, work, ud, product)
    for k in range(n):
        missing[k] = work.vectors[FORCES, k] - product[k]
        # Constraints that do not move do no work: what is left of their power is the drivers'.
        power -= missing[k] * u[k]
    integration.powers[stage] = power
    fill_load_powers(work, integration.load_powers[TRIED + stage])
    mass_times(system, work, u, integration.momenta[stage])
    split(system, work, missing, gaps, integration.steps[stage], integration.rest[stage])
    for k in range(n):
        for f in range(n - rank):
            integration.motions[stage, k, f] = work.motions[k, f]
    return code


@kernel
def _correct(system: System, work: Work, integration: "RadauIntegration") -> None:
    """Newton's correction of the accelerations of all stages."""
    free = work.motions.shape[0] - work.rank[0]
    rest, y, w = integration.rest, integration.real_part, integration.complex_part
    for f in range(free):
        y[f], w[f] = 0.0, 0.0
        for stage in range(STAGES):
            y[f] += REAL_LEFT[stage] * rest[stage, f]
            w[f] += COMPLEX_LEFT[stage] * rest[stage, f]
    cholesky_solve(integration.newton.reduced, free, y)
    solve_symmetric(integration.complex, free, w)
    for stage in range(STAGES):
        for f in range(free):
            rest[stage, f] = REAL_RIGHT[stage] * y[f] + 2.0 * (COMPLEX_RIGHT[stage] * w[f]).real
        add_free(system, work, integration.motions[stage], rest[stage], integration.steps[stage])
        for k in range(integration.steps.shape[1]):
            integration.rates[1 + stage, k] += integration.steps[stage, k]
            integration.powers[stage] += integration.steps[stage, k] * integration.momenta[stage, k]
