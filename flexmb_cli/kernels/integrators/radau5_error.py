"""Errors of a step of Radau's method in tolerances, and the length of the next step by them.

Hairer and Wanner, Solving Ordinary Differential Equations II (second edition), section IV.8.
"""

from typing import TYPE_CHECKING

import numpy as np

from .._jit import kernel
from ..constrained.accelerations import add_free
from ..constrained.report import coordinates_and_speeds
from ..linalg.cholesky import cholesky_solve
from .error_norm import displacement_tolerance, tolerance
from .radau5_step import MASS_LAYER, START, STIFFNESS_LAYER
from .radau5_table import ERROR, REAL, STAGES, WEIGHTS
from .rotation_increments import LONGEST_TURN, largest_turn

if TYPE_CHECKING:
    from ..constrained.system import System, Work
    from .radau5 import RadauIntegration

SAFETY, FASTEST = 0.9, 6.0
CALM = 1e-2  # error in tolerances below which it has not grown
STEEPEST = 3.0 / (25.0 * 5.0**0.5)  # slope of x³ (1 - x)³


@kernel
def step_error(system: "System", work: "Work", integration: "RadauIntegration", h: float):
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
    total, first = 0.0, clock["counted"] - n
    for k in range(n):
        scale = tolerance(
            clock, integration.units[first + k], max(abs(u[k]), abs(integration.speeds[STAGES - 1, k]))
        )
        total += (speeds[k] / scale) ** 2
        total += (shifts[k] / displacement_tolerance(clock, system.speed_scale[k])) ** 2
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
    first = last - u.shape[0]
    scale = tolerance(clock, integration.units[last], abs(integration.z[last]))
    for k in range(u.shape[0]):
        allowed = tolerance(clock, integration.units[first + k], abs(u[k]))
        scale += abs(integration.momenta[STAGES - 1, k]) * allowed
    return scale


@kernel
def next_factor(clock: np.void, memory: "np.void", h: float, error: float):
    """Factor on the step length: by the error of this step, and by its growth since the last."""
    if not error > 0.0:
        return FASTEST
    factor = SAFETY * error**-0.25
    if memory["last_error"] > 0.0:
        growth = max(memory["last_error"], CALM) / error
        factor *= min(1.0, h / clock["step_length"] * growth**0.25)
    return factor


@kernel
def steps_within_rotation_limit(system: "System", integration: "RadauIntegration"):
    """Return how many steps like this one a body may turn in one, for rows between its ends.

    A turn θ leaves (θ/2)⁵ max |d/dx x³ (1 - x)³| / 720 of its rate in Hermite's quintic.
    """
    turn = largest_turn(system.masses.shape[0], integration.shifts[STAGES - 1])
    longest = min(LONGEST_TURN, 2.0 * (720.0 / STEEPEST * integration.clock[0]["rtol"]) ** 0.2)
    return longest / turn if turn > 0.0 else np.inf
