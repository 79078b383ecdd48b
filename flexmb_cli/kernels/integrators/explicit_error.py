"""Errors of explicit steps in tolerances, of which only what the constraints allow counts: DOP853.

Hairer, Nørsett and Wanner, Solving Ordinary Differential Equations I (second edition), section II.10.
"""

from typing import TYPE_CHECKING

import numpy as np

from .._jit import allocating, kernel
from ..constrained.accelerations import solve
from ..constrained.speeds import speeds_of_rates
from ..constrained.system import CORRECTION, GAMMA, QD
from ..linalg.rank_revealing_lu import row_times
from .dop853 import combined, weighted
from .dop853_table import ERROR_3, ERROR_5
from .error_norm import displacement_tolerance, tolerance

if TYPE_CHECKING:
    from ..constrained.system import System, Work
    from .constrained_dop853 import Integration


@allocating
def error_on_constraints(system: "System", work: "Work", integration: "Integration", h: float):
    """Return the error of the step from z to the projected trial; the factors are those of the projection.

    Only the part that the projection leaves counts.  Across a singular position, where the stages mix the
    two motions, the projection removes most of the error.
    """
    clock, n = integration.clock[0], system.speed_scale.shape[0]
    first = clock["counted"] - n
    q, u = integration.trial[:first], integration.trial[first : first + n]
    square_5 = square_3 = 0.0
    for order in range(2):
        change, square = np.empty(integration.z.shape[0]), 0.0
        for i in range(change.shape[0]):
            change[i] = weighted(ERROR_3 if order else ERROR_5, integration.slopes, i)
        of_q, of_speeds = change[:first], change[first : first + n]
        of_position = np.empty(n)
        speeds_of_rates(system.masses.shape[0], q, of_q, of_position)
        _keep_allowed(system, work, of_position)
        _keep_allowed(system, work, of_speeds)
        for k in range(n):
            unit = integration.units[first + k]
            square += (of_position[k] / displacement_tolerance(clock, unit)) ** 2
            square += (of_speeds[k] / tolerance(clock, unit, abs(u[k]))) ** 2
        if order:
            square_3 = square
        else:
            square_5 = square
    return combined(h, square_5, square_3, 2 * n)


@kernel
def _keep_allowed(system: "System", work: "Work", change: "np.ndarray"):
    """Leave of a change (n,) of speeds what the constraints allow."""
    zero, step, gamma = work.vectors[QD], work.vectors[CORRECTION], work.rows[GAMMA]
    for row in range(gamma.shape[0]):
        total = row_times(work.jacobian, work.columns, row, change, system.speed_scale)
        gamma[row] = -total * system.row_scale[row]
    for k in range(zero.shape[0]):
        zero[k] = 0.0
    solve(system, work, zero, gamma, step)
    for k in range(change.shape[0]):
        change[k] += step[k]
