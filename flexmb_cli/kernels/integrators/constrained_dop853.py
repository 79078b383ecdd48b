"""DOP853 on the accelerations of a constrained mechanism.

The accelerations are those of the index-1 equations; every accepted step is projected onto positions
and speeds to round-off, so that nothing drifts, and judged anew if the projection moves it by more
than the tolerance allows.  Report rows come from the dense output and are projected as well.

Hairer, Nørsett and Wanner, Solving Ordinary Differential Equations I (second edition), sections
II.4-II.6; projection: Hairer and Wanner, volume II, section VII.2.
"""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from .._jit import kernel
from ..constrained.angle_unwrapping import MOST_TURNED, expect_angles, unwrap_angles
from ..constrained.report import coordinates_and_speeds
from ..constrained.system import SOLVED
from ..linalg.copying import copy
from .clock import BEGIN, READY, STEP_VANISHED, leads_over, new_clock
from .constrained_equations import (
    IN_DOUBT,
    code_of_gap,
    fill_doubtful,
    note_gap,
    projected_slope,
    report_trial,
    slope,
)
from .dop853 import SLOWEST, Equations, dop853, first_step, interpolate, interpolate_slopes, next_factor
from .dop853_table import ALL_STAGES, DENSE_TERMS, STAGES
from .error_norm import MOST_MOVED, moved_by_time
from .explicit_error import error_on_constraints
from .singular_ahead import NOISE, look_ahead, round_off
from .time_loop import SHORT

if TYPE_CHECKING:
    from ..constrained.report import Report
    from ..constrained.system import System, Work

MOST_BLURRED = 1e-5  # by how much the projection may move a step over a singular position, scaled


class Integration(NamedTuple):
    """State of an integration between calls, for states of N numbers."""

    clock: np.ndarray  # (1,) CLOCK record
    z: np.ndarray  # (N,) state at the time t: m, 1, m/s, rad/s, J
    old: np.ndarray  # (N,) state at the start of the last step, in the same units
    trial: np.ndarray  # (N,) state that is tried or reported, in the same units
    slopes: np.ndarray  # (16, N) rates of the stages, units of the state a second
    dense: np.ndarray  # (7, N) terms of the dense output, units of the state
    units: np.ndarray  # (N,) a state's unit, of which the absolute tolerance is
    angles: np.ndarray  # (3, angles) rad, see `angle_unwrapping`


def new_integration(work: "Work", angles: int, works: int = 0):
    """An integration at time 0 with an empty state, for the `work` of a mechanism and so many angles.

    The works of the first `works` loads are kept.
    """
    counted = 2 * work.motions.shape[0] + work.mass.shape[0]
    n = counted + 1 + works
    return Integration(
        new_clock(counted),
        np.zeros(n),
        np.zeros(n),
        np.zeros(n),
        np.zeros((ALL_STAGES, n)),
        np.zeros((DENSE_TERMS, n)),
        np.ones(n),
        np.zeros((3, angles)),
    )


@kernel
def _normalise(integration: "Integration", system: "System", work: "Work"):
    """Leave the Euler parameters as they are: the projection brings them to length one."""


@kernel
def _finish(integration: "Integration", h: float, system: "System", work: "Work"):
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
def _holds(system: "System", work: "Work", integration: "Integration", h: float, moved: float):
    """Return whether a step may be made, whose projected end is in trial and was `moved` by so much."""
    clock = integration.clock[0]
    noise = max(1.0, NOISE * round_off(work) / clock["rtol"])
    if not leads_over(clock, h):
        return moved < MOST_MOVED * noise + moved_by_time(integration, h)
    clock["error"] = min(clock["error"], error_on_constraints(system, work, integration, h))
    return clock["error"] < noise and moved * clock["rtol"] < MOST_BLURRED


@kernel
def _watch(integration: "Integration", system: "System", work: "Work"):
    """Look for short steps, gaps and singular positions ahead; PHI belongs to the state."""
    clock = integration.clock[0]
    clock["longest"] = max(clock["longest"], clock["step_length"])
    if clock["step_length"] > 10.0 * SHORT * clock["longest"]:
        clock["excused"] = 0
    unwrap_angles(system, work, integration)
    note_gap(integration, system, work)
    look_ahead(
        system,
        work,
        integration,
        coordinates_and_speeds(system, integration.slopes[STAGES])[1],
        clock["step"],
    )
    return code_of_gap(integration)


@kernel
def _close(integration: "Integration", system: "System", work: "Work"):
    """The projected end of a step is the start of the next."""
    copy(integration.slopes[STAGES], integration.slopes[0])
    return READY


@kernel
def _fill_row(integration: "Integration", t: float, report: "Report", system: "System", work: "Work"):
    """Fill a report row at a time up to the present one; a code."""
    clock, rates = integration.clock[0], report.rates[integration.clock[0]["row"]]
    x = _place_row(integration, t)
    code = report_trial(integration, t, x, report, system, work)
    if code == IN_DOUBT:
        _place_row(integration, t)
        interpolate_slopes(
            integration.dense, x, clock["step_length"], clock["counted"] - rates.shape[0], rates
        )
        fill_doubtful(integration, t, x, report, system, work)
        return READY
    return code


@kernel
def _place_row(integration: "Integration", t: float):
    """Bring `trial` to a time up to the present one; return the fraction of the last step."""
    clock, x = integration.clock[0], 1.0
    copy(integration.z, integration.trial)
    if t < clock["t"]:
        x = (t - clock["step_start"]) / clock["step_length"]
        interpolate(integration.old, integration.dense, x, integration.trial)
    return x


_advance = dop853(Equations(slope, _normalise, _finish, _watch, _close, _fill_row))


@kernel
def integrate_rows(
    task: int, system: "System", work: "Work", integration: "Integration", report: "Report", budget: int
):
    """Begin at the state z, or fill the rows of `report`, at most `budget` evaluations; a code.

    clock["row"] counts the rows filled.  The order of elimination must have been chosen.
    """
    if task == BEGIN:
        return _begin(integration, system, work)
    return _advance(integration, report, budget, system, work)


@kernel
def _begin(integration: "Integration", system: "System", work: "Work"):
    clock = integration.clock[0]
    copy(integration.z, integration.old)
    copy(integration.z, integration.trial)
    clock["step_start"] = clock["t"]
    if not slope(integration, 0, clock["t"], system, work):
        return STEP_VANISHED
    clock["step"] = first_step(integration, integration.slopes[0])
    return READY
