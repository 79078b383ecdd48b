"""One step of Radau's method IIA of order 5 for constrained mechanisms, stiff in modes, springs and dampers.

Hairer and Wanner, Solving Ordinary Differential Equations II (second edition), section IV.8, for u̇ = a(q, u,
t), the accelerations of the index-1 equations.  Attitudes are rotation vectors θ from the start of the step,

    θ̇ = ω + ½ θ × ω + (1/|θ|² - cot(|θ|/2) / (2 |θ|)) θ × (θ × ω)

in body axes, the inverse of the derivative of the exponential map.
Newton's matrix is that of the free motions at the start of the step, with ⊗ by the stages' weights A

    1 ⊗ Zᵀ M Z + h A ⊗ Zᵀ D Z + h² A² ⊗ Zᵀ K Z,

which the eigenvectors of A part into a real matrix and a complex one.  What else accelerations depend on
is left to the iteration.  Projection onto positions and speeds takes the shortest way in the metric of the
matrix of the step, so that stiff motions stay at rest.
"""

import math
from typing import TYPE_CHECKING

import numpy as np

from .._jit import allocating, kernel
from ..constrained.accelerations import (
    SMALLEST_INERTIA,
    accelerations,
    add_free,
    factorise_constraints,
    factorise_for_forces,
    fill_column,
    missing_forces,
    split,
)
from ..constrained.angle_unwrapping import EXPECTED
from ..constrained.forces import add_stiff
from ..constrained.mass_matrix import mass_matrices, mass_times
from ..constrained.projection import close_gaps, close_rates
from ..constrained.report import TRIED, coordinates_and_speeds, fill_load_powers
from ..constrained.speeds import coordinate_accelerations, coordinate_rates, normalise, speeds_of_rates
from ..constrained.system import GAMMA, PRODUCT, SOLVED, UNKNOWN, System, Work
from ..linalg.cholesky import cholesky, cholesky_solve
from ..linalg.number_rows import copy
from ..linalg.profile_ldl import factorise_symmetric, solve_symmetric
from ..signals import take_states
from .constrained_equations import first_speed, works_between
from .error_norm import CAUTION, displacement_tolerance, scaled_norm, tolerance
from .generalised_alpha_step import turn_exactly
from .hermite import cubic, quintic
from .rotation_increments import LONGEST_TURN, largest_turn, set_slope
from .signal_states import error_of_stages, first_state, know_stage, place_states
from .singular_ahead import blur

if TYPE_CHECKING:
    from .integrations import RadauIntegration


STAGES = 3
_R = 6.0**0.5
TIMES = np.array([(4.0 - _R) / 10.0, (4.0 + _R) / 10.0, 1.0])
WEIGHTS = np.array(
    [
        [(88.0 - 7.0 * _R) / 360.0, (296.0 - 169.0 * _R) / 1800.0, (-2.0 + 3.0 * _R) / 225.0],
        [(296.0 + 169.0 * _R) / 1800.0, (88.0 + 7.0 * _R) / 360.0, (-2.0 - 3.0 * _R) / 225.0],
        [(16.0 - _R) / 36.0, (16.0 + _R) / 36.0, 1.0 / 9.0],
    ]
)

# Of the powers of loads, rows NOW, BEHIND and the stages, in the work of a step.
QUADRATURE = np.array([0.0, 0.0, *WEIGHTS[STAGES - 1]])

# Eigenvalues of WEIGHTS: one is real, the others are a complex one and its conjugate.
_C = 9.0 ** (1.0 / 3.0)
REAL = (6.0 + _C * (_C - 1.0)) / 30.0
COMPLEX = complex(12.0 - _C * (_C - 1.0), _C * (_C + 1.0) * 3.0**0.5) / 60.0


def _eigenvectors(value: complex) -> tuple[np.ndarray, np.ndarray]:
    """Right and left eigenvector of WEIGHTS (3,) each, their product 1."""
    left = WEIGHTS - value * np.eye(STAGES)
    right, transposed = np.cross(left[0], left[1]), np.cross(left[:, 0], left[:, 1])
    return right, transposed / np.sum(transposed * right)


REAL_RIGHT, REAL_LEFT = _eigenvectors(REAL)
COMPLEX_RIGHT, COMPLEX_LEFT = _eigenvectors(COMPLEX)

# What the stages' increments contribute to the error, besides REAL h times the slope at the start.
ERROR = REAL / 3.0 * np.array([-13.0 - 7.0 * _R, -13.0 + 7.0 * _R, -1.0])


# Rows of the accelerations kept (8, n): of the start and the stages of a step, the one that is tried and
# that before.
START, LAST_STEP = 0, 4
# Of the rates of the states of signals (5, s): after START and the stages that of the start of the last step.
BEHIND_STEP = 4
# Layers of the matrices (3, n, n): M, D and K of the free motions, lower parts.
MASS_LAYER, DAMPING_LAYER, STIFFNESS_LAYER = 0, 1, 2

MOST_ITERATIONS = 10
LEAST = 1e-3  # contraction that is trusted
SECOND = 2.0  # contraction with which the second correction continues
FLOOR = 1e-14  # of the speeds: round-off


@kernel
def renew_matrices(system: System, work: Work, matrices: np.ndarray) -> None:
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
            know_stage(system, integration, integration.state_rates[1 : 1 + STAGES], WEIGHTS, stage, h)
            clock["fault"] = _evaluate(system, work, integration, stage, clock["t"] + TIMES[stage] * h)
            system.signals.ahead[0] = 0.0
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
        accelerations_between(integration, 1.0 + ratio * TIMES[stage], rates[1 + stage])
    integration.shifts[:] = 0.0
    _forget_failure(system, integration)
    for stage in range(STAGES):
        copy(integration.state_rates[START], integration.state_rates[1 + stage])
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
    first = first_speed(system)
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
    total += place_states(system, integration, integration.state_rates[1 : 1 + STAGES], WEIGHTS, h)
    return (total / (2.0 * STAGES * n)) ** 0.5


@kernel
def place_trial(system: System, integration: "RadauIntegration", stage: int) -> None:
    """The state of a stage in `trial`."""
    copy(integration.z, integration.trial)
    q, u = coordinates_and_speeds(system, integration.trial)
    turn_exactly(system.masses.shape[0], q, integration.shifts[stage])
    copy(integration.speeds[stage], u)
    first = first_state(system)
    for k in range(integration.states.shape[1]):
        integration.trial[first + k] = integration.states[stage, k]


@kernel
def _evaluate(system: System, work: Work, integration: "RadauIntegration", stage: int, t: float) -> int:
    """Evaluate the residual of the equations of motion at a stage, by independent speeds; return a code."""
    place_trial(system, integration, stage)
    q, u = coordinates_and_speeds(system, integration.trial)
    code = factorise_for_forces(system, work, q)
    if code != SOLVED:
        return code
    n, rank, ud = u.shape[0], work.rank[0], integration.rates[1 + stage]
    gaps, missing = work.rows[GAMMA], integration.missing
    take_states(system.signals, integration.trial, q.shape[0] + n)
    integration.powers[stage] = missing_forces(system, work, q, u, t, ud, gaps, missing)
    copy(system.signals.rates, integration.state_rates[1 + stage])
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


SAFETY, FASTEST = 0.9, 6.0
CALM = 1e-2  # error in tolerances below which it has not grown
STEEPEST = 3.0 / (25.0 * 5.0**0.5)  # slope of x³ (1 - x)³


@kernel
def step_error(system: System, work: Work, integration: "RadauIntegration", h: float):
    """Error of the step in tolerances, of order 3: stiff motions are taken out by the matrix."""
    clock, n, rank, m = integration.clock[0], integration.rates.shape[1], work.rank[0], work.jacobian.shape[0]
    u = coordinates_and_speeds(system, integration.z)[1]
    of_speed, of_position, y = integration.rest[0], integration.rest[1], integration.real_part
    for f in range(n - rank):
        k = work.order[m + rank + f]
        of_speed[f], of_position[f] = REAL * h * integration.rates[START, k], REAL * h * u[k]
        for stage in range(STAGES):
            of_speed[f] += ERROR[stage] * (integration.speeds[stage, k] - u[k])
            of_position[f] += ERROR[stage] * integration.shifts[stage, k]
        of_speed[f] /= system.speed_scale[k]
        of_position[f] /= system.speed_scale[k]
    for f in range(n - rank):
        y[f] = 0.0
        for g in range(n - rank):
            i, j = max(f, g), min(f, g)
            y[f] += integration.matrices[MASS_LAYER, i, j] * of_speed[g]
            y[f] -= REAL * h * integration.matrices[STIFFNESS_LAYER, i, j] * of_position[g]
    cholesky_solve(integration.newton.reduced, n - rank, y)
    speeds, shifts = integration.steps[0], integration.steps[1]
    speeds[:] = 0.0
    shifts[:] = 0.0
    for f in range(n - rank):
        of_position[f] += REAL * h * y[f]
    add_free(system, work, integration.motions[STAGES - 1], y, speeds)
    add_free(system, work, integration.motions[STAGES - 1], of_position, shifts)
    total, first = 0.0, first_speed(system)
    for k in range(n):
        scale = tolerance(
            clock, integration.units[first + k], max(abs(u[k]), abs(integration.speeds[STAGES - 1, k]))
        )
        total += (speeds[k] / scale) ** 2
        total += (shifts[k] / displacement_tolerance(clock, system.speed_scale[k])) ** 2
    total += error_of_stages(system, integration, integration.state_rates[START], ERROR, REAL * h)
    return (total / (2.0 * n)) ** 0.5


@kernel
def work_error(integration: "RadauIntegration", h: float):
    """Error of the work in the step, of order 3, in tolerances: its own, and what those of speeds allow."""
    error = REAL * h * integration.memory[0]["power"]
    for stage in range(STAGES):
        for j in range(STAGES):
            error += h * ERROR[stage] * WEIGHTS[stage, j] * integration.powers[j]
    return abs(error) / work_scale(integration)


@kernel
def work_scale(integration: "RadauIntegration"):
    """The work that the tolerance allows to be wrong, J: its own, and what that of the speeds allows."""
    clock, u = integration.clock[0], integration.speeds[STAGES - 1]
    last = clock["counted"]
    first = last - u.shape[0] - integration.states.shape[1]
    scale = tolerance(clock, integration.units[last], abs(integration.z[last]))
    for k in range(u.shape[0]):
        allowed = tolerance(clock, integration.units[first + k], abs(u[k]))
        scale += abs(integration.momenta[STAGES - 1, k]) * allowed
    return scale


@kernel
def next_factor(clock: np.void, memory: np.void, h: float, error: float):
    """Factor on the step length: by the error of this step, and by its growth since the last."""
    if not error > 0.0:
        return FASTEST
    factor = SAFETY * error**-0.25
    if memory["last_error"] > 0.0:
        growth = max(memory["last_error"], CALM) / error
        factor *= min(1.0, h / clock["step_length"] * growth**0.25)
    return factor


@kernel
def steps_within_rotation_limit(system: System, integration: "RadauIntegration"):
    """Return how many steps like this one a body may turn in one, for rows between its ends.

    A turn θ leaves (θ/2)⁵ max |d/dx x³ (1 - x)³| / 720 of its rate in Hermite's quintic.
    """
    turn = largest_turn(system.masses.shape[0], integration.shifts[STAGES - 1])
    longest = min(LONGEST_TURN, 2.0 * (720.0 / STEEPEST * integration.clock[0]["rtol"]) ** 0.2)
    return longest / turn if turn > 0.0 else np.inf


@kernel
def close_trial(system: System, work: Work, integration: "RadauIntegration", t: float) -> int:
    """Bring `trial`, near to which factors and mass matrices are, onto positions and speeds at t; a code.

    They then are those of the end.
    """
    newton, bodies = integration.newton, system.masses.shape[0]
    q, u = coordinates_and_speeds(system, integration.trial)
    normalise(bodies, q)
    close_gaps(system, work, newton, q, t, integration.angles[EXPECTED])
    code = factorise_constraints(system, work, q)
    if code == SOLVED:
        mass_matrices(system, work, q)
        close_rates(system, work, newton, u, t)
    return code


@kernel
def moved(integration: "RadauIntegration", before: np.ndarray) -> float:
    """Return by how many tolerances `trial` was moved from before (N,), which becomes the difference."""
    for i in range(before.shape[0]):
        before[i] = integration.trial[i] - before[i]
    return scaled_norm(integration, integration.trial, before)


@kernel
def project_state(
    system: System, work: Work, integration: "RadauIntegration", t: float, ud: np.ndarray
) -> tuple[int, float]:
    """Bring `trial` onto everything at t and fill ud (n,); returns (code, power).

    The matrix of the last step serves: where other speeds have become free it is one more metric.
    """
    copy(integration.angles[EXPECTED], work.angles)
    q, u = coordinates_and_speeds(system, integration.trial)
    code = factorise_constraints(system, work, q)
    if code == SOLVED:
        mass_matrices(system, work, q)
        code = close_trial(system, work, integration, t)
    take_states(system.signals, integration.trial, q.shape[0] + u.shape[0])
    return accelerations(system, work, q, u, t, ud) if code == SOLVED else (code, 0.0)


@kernel
def place_row(system: System, integration: "RadauIntegration", t: float):
    """Bring `trial` to a time up to the present one; return the fraction of the last step."""
    clock, x = integration.clock[0], 1.0
    copy(integration.z, integration.trial)
    if t < clock["t"]:
        x = (t - clock["step_start"]) / clock["step_length"]
        between(system, integration, x, integration.trial)
    return x


@kernel
def accelerations_between(integration: "RadauIntegration", x: float, ud: np.ndarray) -> None:
    """Fill ud (n,) at the fraction x of the last step, through those of its start and its stages."""
    ud[:] = 0.0
    for node in range(STAGES + 1):
        weight = 1.0
        for other in range(STAGES + 1):
            if other != node:
                weight *= (x - node_time(other)) / (node_time(node) - node_time(other))
        for k in range(ud.shape[0]):
            ud[k] += weight * integration.rates[LAST_STEP + node, k]


@kernel
def node_time(node: int):
    """Time of the start of a step, 0, or of a stage, as a fraction of the step."""
    return TIMES[node - 1] if node > 0 else 0.0


@allocating
def between(system: System, integration: "RadauIntegration", x: float, point: np.ndarray) -> None:
    """Fill point with the state at the fraction x of the last step."""
    clock, old, z, n = integration.clock[0], integration.old, integration.z, system.speed_scale.shape[0]
    bodies, h = system.masses.shape[0], clock["step_length"]
    nq = n + bodies
    rates = np.empty((5, nq))
    coordinate_rates(bodies, old[:nq], old[nq : nq + n], rates[0])
    coordinate_accelerations(bodies, old[:nq], old[nq : nq + n], integration.rates[LAST_STEP], rates[1])
    coordinate_rates(bodies, z[:nq], z[nq : nq + n], rates[2])
    coordinate_accelerations(bodies, z[:nq], z[nq : nq + n], integration.rates[START], rates[3])
    for i in range(nq):
        point[i], rates[4, i] = quintic(
            x, old[i], z[i], h * rates[0, i], h * rates[2, i], h * h * rates[1, i], h * h * rates[3, i]
        )
        rates[4, i] /= h
    speeds_of_rates(bodies, point[:nq], rates[4], point[nq : nq + n])
    last = clock["counted"]
    for k in range(integration.states.shape[1]):
        i, rates_of = nq + n + k, integration.state_rates
        point[i] = cubic(x, old[i], z[i], h * rates_of[BEHIND_STEP, k], h * rates_of[START, k])
    point[last] = cubic(
        x, old[last], z[last], h * integration.memory[0]["old_power"], h * integration.memory[0]["power"]
    )
    works_between(integration, x, h, point)
