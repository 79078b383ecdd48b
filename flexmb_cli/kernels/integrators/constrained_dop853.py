"""DOP853 on the accelerations of a constrained mechanism.

The accelerations are those of the index-1 equations; every accepted step is projected onto positions
and speeds to round-off, so that nothing drifts, and judged anew if the projection moves it by more
than the tolerance allows.  Report rows come from the dense output and are projected as well.

Hairer, Nørsett and Wanner, Solving Ordinary Differential Equations I (second edition), sections
II.4-II.6; projection: Hairer and Wanner, volume II, section VII.2.

The state z (2 n + b + 1,) of b bodies with n speeds holds coordinates, speeds and the work of drivers and
loads since the start.
"""

from collections import namedtuple

import numpy as np

from .._jit import kernel
from ..constrained.accelerations import accelerate, factorise_at
from ..constrained.angle_unwrapping import EXPECTED, MOST_TURNED, NEW, OLD, expect_angles, unwrap_angles
from ..constrained.projection import largest_gap, project_position, project_speeds
from ..constrained.report import complete, coordinates_and_speeds
from ..constrained.speeds import coordinate_rates, normalise
from ..constrained.system import SOLVED
from ..linalg.copying import copy
from .clock import BEGIN, CONTRADICTION, READY, STEP_VANISHED, new_clock
from .dop853 import Equations, dop853, first_step
from .dop853_table import ALL_STAGES, DENSE_TERMS, STAGES
from .explicit_error import error_on_constraints, scaled_norm
from .runge_kutta import SLOWEST, interpolate, next_factor
from .singular_ahead import NOISE, leads_over, look_ahead, round_off
from .time_loop import SHORT

MOST_MOVED = 10.0  # tolerances by which a projection may move an accepted step
REPEATED_GAP = 1e-7  # what equations that repeat others may be off, scaled
MOST_BLURRED = 1e-5  # by how much the projection may move a step over a singular position, scaled

Integration = namedtuple("Integration", "clock z old trial slopes dense units angles")
Integration.__doc__ = """What an integration keeps from call to call, for states of N numbers.

clock (1,) CLOCK.  z, old, trial (N,): state, that at the start of the last step, the one tried or reported.
slopes (16, N).  dense (7, N).  units (N,): a state's unit.  angles (3, angles): see `angle_unwrapping`.
"""


def new_integration(n, angles):
    """An integration at time 0 with an empty state of n numbers."""
    return Integration(
        new_clock(),
        np.zeros(n),
        np.zeros(n),
        np.zeros(n),
        np.zeros((ALL_STAGES, n)),
        np.zeros((DENSE_TERMS, n)),
        np.ones(n),
        np.zeros((3, angles)),
    )


@kernel
def _slope(integration, stage, t, system, work):
    """Fill the slope at `trial`; return whether there is one."""
    clock = integration.clock[0]
    clock["evaluations"] += 1
    copy(integration.angles[NEW], work.angles)
    clock["fault"] = factorise_at(system, work, coordinates_and_speeds(system, integration.trial)[0])
    if clock["fault"] == SOLVED:
        _differentiate(integration, stage, t, system, work)
    return clock["fault"] == SOLVED


@kernel
def _differentiate(integration, stage, t, system, work):
    """Fill the slope at `trial`, whose factors are at hand."""
    out = integration.slopes[stage]
    q, u = coordinates_and_speeds(system, integration.trial)
    qd, ud = coordinates_and_speeds(system, out)
    power = accelerate(system, work, q, u, t, ud)
    coordinate_rates(system.masses.shape[0], q, u, qd)
    out[out.shape[0] - 1] = power


@kernel
def _normalise(integration, system, work):
    """Leave the Euler parameters as they are: the projection brings them to length one."""


@kernel
def _finish(integration, h, system, work):
    """Project the end of a step and fill its slope; the factor on the step length, or minus that of a try."""
    clock = integration.clock[0]
    if not expect_angles(system, work, integration, h) < MOST_TURNED:
        return -0.5
    clock["evaluations"] += 1
    copy(integration.angles[EXPECTED], work.angles)
    moved = _project(system, work, integration, integration.trial, clock["t"] + h)
    if clock["fault"] != SOLVED:
        return -SLOWEST
    if not moved < np.inf:
        return -0.5
    _differentiate(integration, STAGES, clock["t"] + h, system, work)
    if not _holds(system, work, integration, h, moved):
        return -0.5
    return next_factor(clock["error"], clock["rejected"])


@kernel
def _holds(system, work, integration, h, moved):
    """Return whether a step may be made, whose projected end is in trial and was `moved` by so much."""
    clock = integration.clock[0]
    noise = max(1.0, NOISE * round_off(work) / clock["rtol"])
    if not leads_over(clock, h):
        return moved < MOST_MOVED * noise
    clock["error"] = min(clock["error"], error_on_constraints(system, work, integration, h))
    return clock["error"] < noise and moved * clock["rtol"] < MOST_BLURRED


@kernel
def _project(system, work, integration, z, t):
    """Bring a state onto the constraints at t, with the factors there.

    Returns by how many tolerances it moved, or infinity.
    """
    clock = integration.clock[0]
    q, u = coordinates_and_speeds(system, z)
    before = z.copy()
    normalise(system.masses.shape[0], q)
    clock["fault"] = project_position(system, work, q, t, integration.angles[EXPECTED])
    if clock["fault"] == SOLVED:
        clock["fault"] = project_speeds(system, work, q, u, t)[0]
    if clock["fault"] != SOLVED:
        return np.inf
    for i in range(z.shape[0]):
        before[i] -= z[i]
    return scaled_norm(integration, before)


@kernel
def _watch(integration, system, work):
    """Look for short steps, gaps and singular positions ahead; PHI belongs to the state."""
    clock = integration.clock[0]
    clock["longest"] = max(clock["longest"], clock["step_length"])
    if clock["step_length"] > 10.0 * SHORT * clock["longest"]:
        clock["excused"] = 0
    unwrap_angles(system, work, integration)
    clock["gap"], clock["equation"] = largest_gap(system, work)
    look_ahead(
        system,
        work,
        integration,
        coordinates_and_speeds(system, integration.slopes[STAGES])[1],
        clock["step"],
    )
    return READY if clock["gap"] <= REPEATED_GAP else CONTRADICTION


@kernel
def _close(integration, system, work):
    """The projected end of a step is the start of the next."""
    copy(integration.slopes[STAGES], integration.slopes[0])
    return READY


@kernel
def _fill_row(integration, t, report, system, work):
    """Fill a report row at a time up to the present one; a code."""
    clock, angles, row, x = integration.clock[0], integration.angles, integration.clock[0]["row"], 1.0
    copy(integration.z, integration.trial)
    if t < clock["t"]:
        x = (t - clock["step_start"]) / clock["step_length"]
        interpolate(integration.old, integration.dense, x, integration.trial)
    for s in range(angles.shape[1]):
        angles[EXPECTED, s] = (1.0 - x) * angles[OLD, s] + x * angles[NEW, s]
    clock["evaluations"] += 1
    copy(angles[EXPECTED], work.angles)
    q, u = coordinates_and_speeds(system, integration.trial)
    if x < 1.0:
        _project(system, work, integration, integration.trial, t)
    else:
        clock["fault"] = factorise_at(system, work, q)
    if clock["fault"] != SOLVED:
        return STEP_VANISHED
    power = accelerate(system, work, q, u, t, report.rates[row])
    complete(system, work, integration.trial, t, angles[EXPECTED], power, report, row)
    copy(integration.trial, report.states[row])
    clock["row"] += 1
    return READY


_advance = dop853(Equations(_slope, _normalise, _finish, _watch, _close, _fill_row))


@kernel
def integrate_rows(task, system, work, integration, report, budget):
    """Begin at the state z, or fill the rows of `report`, at most `budget` evaluations; a code.

    clock["row"] counts the rows filled.  The order of elimination must have been chosen.
    """
    if task == BEGIN:
        return _begin(integration, system, work)
    return _advance(integration, report, budget, system, work)


@kernel
def _begin(integration, system, work):
    clock = integration.clock[0]
    copy(integration.z, integration.old)
    copy(integration.z, integration.trial)
    clock["step_start"] = clock["t"]
    if not _slope(integration, 0, clock["t"], system, work):
        return STEP_VANISHED
    clock["step"] = first_step(integration, integration.slopes[0])
    return READY
