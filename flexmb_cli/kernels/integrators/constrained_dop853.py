"""DOP853 on the accelerations of a constrained mechanism.

The accelerations are those of the index-1 equations; every accepted step is projected onto positions
and speeds to round-off, so that nothing drifts, and judged anew if the projection moves it by more
than the tolerance allows.  Report rows come from the dense output and are projected as well.

Hairer, Nørsett and Wanner, Solving Ordinary Differential Equations I (second edition), sections
II.4-II.6 and II.10 (of the errors only what the constraints allow counts); projection: Hairer and Wanner,
volume II, section VII.2.
"""

import numpy as np

from .._jit import allocating, kernel
from ..constrained.accelerations import solve
from ..constrained.angle_unwrapping import MOST_TURNED, expect_angles, unwrap_angles
from ..constrained.report import Report, coordinates_and_speeds
from ..constrained.speeds import speeds_of_rates
from ..constrained.system import CORRECTION, GAMMA, QD, SOLVED, System, Work
from ..linalg.number_rows import copy
from ..linalg.rank_revealing_lu import row_times
from .clock import BEGIN, READY, STEP_VANISHED, crosses_singularity, new_clock
from .constrained_equations import (
    NEAR_SINGULAR,
    code_of_violation,
    contacts_of,
    fill_near_singular,
    first_speed,
    note_violation,
    projected_slope,
    report_trial,
    slope,
)
from .dop853 import (
    SLOWEST,
    Equations,
    combined,
    dop853,
    first_step,
    interpolate,
    interpolate_slopes,
    next_factor,
    weighted,
)
from .dop853_table import ALL_STAGES, DENSE_TERMS, ERROR_3, ERROR_5, STAGES
from .error_norm import MOST_MOVED, displacement_tolerance, moved_by_time, tolerance
from .integrations import Integration
from .singular_ahead import NOISE, look_ahead, round_off
from .time_loop import SHORT


@allocating
def error_on_constraints(system: System, work: Work, integration: "Integration", h: float):
    """Return the error of the step from z to the projected trial; the factors are those of the projection.

    Only the part that the projection leaves counts.  Across a singular position, where the stages mix the
    two motions, the projection removes most of the error.
    """
    clock, n = integration.clock[0], system.speed_scale.shape[0]
    first = first_speed(system)
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
def _keep_allowed(system: System, work: Work, change: np.ndarray):
    """Leave of a change (n,) of speeds what the constraints allow."""
    zero, step, gamma = work.vectors[QD], work.vectors[CORRECTION], work.rows[GAMMA]
    for row in range(gamma.shape[0]):
        total = row_times(work.jacobian, work.columns, row, change, system.speed_scale)
        gamma[row] = -total * system.row_scale[row]
    zero[:] = 0.0
    solve(system, work, zero, gamma, step)
    for k in range(change.shape[0]):
        change[k] += step[k]


MOST_BLURRED = 1e-5  # by how much the projection may move a step over a singular position, scaled


def new_integration(work: Work, angles: int, n_loads: int = 0, states: int = 0):
    """An integration at time 0 with an empty state, for the `work` of a mechanism and so many angles.

    The mechanical work of the first `n_loads` loads is integrated; `states`: those of signals.
    """
    counted = 2 * work.motions.shape[0] + work.mass.shape[0] + states
    n = counted + 1 + n_loads
    return Integration(
        new_clock(counted), np.zeros(n), np.zeros(n), np.zeros(n), np.zeros((ALL_STAGES, n)),
        np.zeros((DENSE_TERMS, n)), np.ones(n), np.zeros((3, angles)),
    )  # fmt: skip


@kernel
def _normalise(integration: Integration, system: System, work: Work):
    """Leave the Euler parameters as they are: the projection brings them to length one."""


@kernel
def _finish(integration: Integration, h: float, system: System, work: Work):
    """Project the end of a step and fill its slope; the factor on the step length, or minus that of a try."""
    clock = integration.clock[0]
    if not expect_angles(system, work, integration, h) < MOST_TURNED:
        return -0.5
    moved = projected_slope(integration, STAGES, clock["t"] + h, system, work)
    if clock["fault"] != SOLVED:
        return -SLOWEST
    if not moved < np.inf:
        return -0.5
    if not _holds(system, work, integration, h, moved):
        return -0.5
    return next_factor(clock["error"], clock["rejected"])


@kernel
def _holds(system: System, work: Work, integration: Integration, h: float, moved: float):
    """Return whether a step may be made, whose projected end is in trial and was `moved` by so much."""
    clock = integration.clock[0]
    noise = max(1.0, NOISE * round_off(work) / clock["rtol"])
    if not crosses_singularity(clock, h):
        return moved < MOST_MOVED * noise + moved_by_time(integration, h)
    clock["error"] = min(clock["error"], error_on_constraints(system, work, integration, h))
    return clock["error"] < noise and moved * clock["rtol"] < MOST_BLURRED


@kernel
def _watch(integration: Integration, system: System, work: Work):
    """Look for short steps, gaps and singular positions ahead; PHI belongs to the state."""
    clock = integration.clock[0]
    clock["longest"] = max(clock["longest"], clock["step_length"])
    if clock["step_length"] > 10.0 * SHORT * clock["longest"]:
        clock["short_step_allowed"] = 0
    unwrap_angles(system, work, integration)
    note_violation(integration, system, work)
    look_ahead(
        system,
        work,
        integration,
        coordinates_and_speeds(system, integration.slopes[STAGES])[1],
        clock["step"],
    )
    return code_of_violation(integration)


@kernel
def _close(integration: Integration, system: System, work: Work):
    """The projected end of a step is the start of the next."""
    copy(integration.slopes[STAGES], integration.slopes[0])
    return READY


@kernel
def _fill_row(integration: Integration, t: float, report: Report, system: System, work: Work):
    """Fill a report row at a time up to the present one; a code."""
    clock, rates = integration.clock[0], report.rates[integration.clock[0]["row"]]
    x = _place_row(integration, t)
    code = report_trial(integration, t, x, report, system, work)
    if code == NEAR_SINGULAR:
        _place_row(integration, t)
        interpolate_slopes(integration.dense, x, clock["step_length"], first_speed(system), rates)
        fill_near_singular(integration, t, x, report, system, work)
        return READY
    return code


@kernel
def _place_row(integration: Integration, t: float):
    """Bring `trial` to a time up to the present one; return the fraction of the last step."""
    clock, x = integration.clock[0], 1.0
    copy(integration.z, integration.trial)
    if t < clock["t"]:
        x = (t - clock["step_start"]) / clock["step_length"]
        interpolate(integration.old, integration.dense, x, integration.trial)
    return x


_advance = dop853(Equations(slope, _normalise, _finish, _watch, _close, _fill_row, contacts_of))


@kernel
def integrate_rows(
    task: int, system: System, work: Work, integration: Integration, report: Report, budget: int
):
    """Begin at the state z, or fill the rows of `report`, at most `budget` evaluations; a code.

    clock["row"] counts the rows filled.  The order of elimination must have been chosen.
    """
    if task == BEGIN:
        return _begin(integration, system, work)
    return _advance(integration, report, budget, system, work)


@kernel
def _begin(integration: Integration, system: System, work: Work):
    clock = integration.clock[0]
    copy(integration.z, integration.old)
    copy(integration.z, integration.trial)
    clock["step_start"] = clock["t"]
    if not slope(integration, 0, clock["t"], system, work):
        return STEP_VANISHED
    clock["step"] = first_step(integration, integration.slopes[0])
    return READY
