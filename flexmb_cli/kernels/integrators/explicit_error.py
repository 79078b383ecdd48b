"""Errors of explicit steps of a constrained mechanism, in tolerances: DOP853.

Hairer, Nørsett and Wanner, Solving Ordinary Differential Equations I (second edition), section II.10.
"""

import numpy as np

from .._jit import allocating, kernel
from ..constrained.accelerations import solve
from ..constrained.speeds import speeds_of_rates
from ..constrained.system import CORRECTION, GAMMA, QD
from .dop853_table import ERROR_3, ERROR_5, STAGES


@kernel
def scaled_norm(integration, a):
    """Root mean square of a state's changes a (N,), the work left out, against the tolerance at z."""
    clock, total, counted = integration.clock[0], 0.0, a.shape[0] - 1
    for i in range(counted):
        scale = clock["atol"] * integration.units[i] + clock["rtol"] * abs(integration.z[i])
        total += (a[i] / scale) ** 2
    return (total / counted) ** 0.5


@kernel
def step_error(integration, h):
    """Error of the step from z to trial."""
    clock, z, new = integration.clock[0], integration.z, integration.trial
    counted = z.shape[0] - 1
    square_5 = square_3 = 0.0
    for i in range(counted):
        scale = clock["atol"] * integration.units[i] + clock["rtol"] * max(abs(z[i]), abs(new[i]))
        square_5 += (_weighted(ERROR_5, integration.slopes, i) / scale) ** 2
        square_3 += (_weighted(ERROR_3, integration.slopes, i) / scale) ** 2
    return _combined(h, square_5, square_3, counted)


@allocating
def error_on_constraints(system, work, integration, h):
    """Error of the step from z to trial, which has been projected, whose factors are at hand.

    Only what the projection leaves of it counts: across a singular position, where the stages tell one
    motion from another badly, it takes most of it away.
    """
    clock, n = integration.clock[0], system.speed_scale.shape[0]
    first = integration.z.shape[0] - 1 - n
    q, u = integration.trial[:first], integration.trial[first : first + n]
    square_5 = square_3 = 0.0
    for order in range(2):
        change, square = np.empty(integration.z.shape[0]), 0.0
        for i in range(change.shape[0]):
            change[i] = _weighted(ERROR_3 if order else ERROR_5, integration.slopes, i)
        of_q, of_speeds = change[:first], change[first : first + n]
        of_position = np.empty(n)
        speeds_of_rates(system.masses.shape[0], q, of_q, of_position)
        _keep_allowed(system, work, of_position)
        _keep_allowed(system, work, of_speeds)
        for k in range(n):
            unit = integration.units[first + k]
            square += (of_position[k] / ((clock["atol"] + clock["rtol"]) * unit)) ** 2
            square += (of_speeds[k] / (clock["atol"] * unit + clock["rtol"] * abs(u[k]))) ** 2
        if order:
            square_3 = square
        else:
            square_5 = square
    return _combined(h, square_5, square_3, 2 * n)


@kernel
def _keep_allowed(system, work, change):
    """Leave of a change (n,) of speeds what the constraints allow."""
    zero, step, gamma = work.vectors[QD], work.vectors[CORRECTION], work.rows[GAMMA]
    for row in range(gamma.shape[0]):
        total = 0.0
        for k in range(change.shape[0]):
            if work.jacobian[row, k] != 0.0:
                total += work.jacobian[row, k] * change[k] / system.speed_scale[k]
        gamma[row] = -total * system.row_scale[row]
    for k in range(zero.shape[0]):
        zero[k] = 0.0
    solve(system, work, zero, gamma, step)
    for k in range(change.shape[0]):
        change[k] += step[k]


@kernel
def _weighted(weights, slopes, i):
    total = 0.0
    for j in range(STAGES):
        total += weights[j] * slopes[j, i]
    return total


@kernel
def _combined(h, square_5, square_3, counted):
    if square_5 == 0.0:
        return 0.0
    return abs(h) * square_5 / ((square_5 + 0.01 * square_3) * counted) ** 0.5
