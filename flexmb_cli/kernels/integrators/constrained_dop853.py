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
from ..constrained.angle_unwrapping import MOST_TURNED, NEAR, NEW, OLD, expect_turns, note_turns
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

March = namedtuple("March", "clock z old trial slopes dense units turns")
March.__doc__ = """What an integration keeps from call to call, for states of N numbers.

clock (1,) CLOCK.  z, old, trial (N,): state, that at the start of the last step, the one tried or reported.
slopes (16, N).  dense (7, N).  units (N,): a state's unit.  turns (3, angles): see `angle_unwrapping`.
"""


def new_march(n, turns):
    """A march at time 0 with an empty state of n numbers."""
    return March(
        new_clock(),
        np.zeros(n),
        np.zeros(n),
        np.zeros(n),
        np.zeros((ALL_STAGES, n)),
        np.zeros((DENSE_TERMS, n)),
        np.ones(n),
        np.zeros((3, turns)),
    )


@kernel
def _slope(march, stage, t, system, work):
    """Fill the slope at `trial`; return whether there is one."""
    clock = march.clock[0]
    clock["evaluations"] += 1
    copy(march.turns[NEW], work.turns)
    clock["fault"] = factorise_at(system, work, coordinates_and_speeds(system, march.trial)[0])
    if clock["fault"] == SOLVED:
        _differentiate(march, stage, t, system, work)
    return clock["fault"] == SOLVED


@kernel
def _differentiate(march, stage, t, system, work):
    """Fill the slope at `trial`, whose factors are at hand."""
    out = march.slopes[stage]
    q, u = coordinates_and_speeds(system, march.trial)
    qd, ud = coordinates_and_speeds(system, out)
    power = accelerate(system, work, q, u, t, ud)
    coordinate_rates(system.masses.shape[0], q, u, qd)
    out[out.shape[0] - 1] = power


@kernel
def _normalise(march, system, work):
    """Leave the Euler parameters as they are: the projection brings them to length one."""


@kernel
def _finish(march, h, system, work):
    """Project the end of a step and fill its slope; the factor on the step length, or minus that of a try."""
    clock = march.clock[0]
    if not expect_turns(system, work, march, h) < MOST_TURNED:
        return -0.5
    clock["evaluations"] += 1
    copy(march.turns[NEAR], work.turns)
    moved = _project(system, work, march, march.trial, clock["t"] + h)
    if clock["fault"] != SOLVED:
        return -SLOWEST
    if not moved < np.inf:
        return -0.5
    _differentiate(march, STAGES, clock["t"] + h, system, work)
    if not _holds(system, work, march, h, moved):
        return -0.5
    return next_factor(clock["error"], clock["rejected"])


@kernel
def _holds(system, work, march, h, moved):
    """Return whether a step may be made, whose projected end is in trial and was `moved` by so much."""
    clock = march.clock[0]
    noise = max(1.0, NOISE * round_off(work) / clock["rtol"])
    if not leads_over(clock, h):
        return moved < MOST_MOVED * noise
    clock["error"] = min(clock["error"], error_on_constraints(system, work, march, h))
    return clock["error"] < noise and moved * clock["rtol"] < MOST_BLURRED


@kernel
def _project(system, work, march, z, t):
    """Bring a state onto the constraints at t, with the factors there.

    Returns by how many tolerances it moved, or infinity.
    """
    clock = march.clock[0]
    q, u = coordinates_and_speeds(system, z)
    before = z.copy()
    normalise(system.masses.shape[0], q)
    clock["fault"] = project_position(system, work, q, t, march.turns[NEAR])
    if clock["fault"] == SOLVED:
        clock["fault"] = project_speeds(system, work, q, u, t)[0]
    if clock["fault"] != SOLVED:
        return np.inf
    for i in range(z.shape[0]):
        before[i] -= z[i]
    return scaled_norm(march, before)


@kernel
def _watch(march, system, work):
    """Look for short steps, gaps and singular positions ahead; PHI belongs to the state."""
    clock = march.clock[0]
    clock["longest"] = max(clock["longest"], clock["step_length"])
    if clock["step_length"] > 10.0 * SHORT * clock["longest"]:
        clock["excused"] = 0
    note_turns(system, work, march)
    clock["gap"], clock["equation"] = largest_gap(system, work)
    look_ahead(system, work, march, coordinates_and_speeds(system, march.slopes[STAGES])[1], clock["step"])
    return READY if clock["gap"] <= REPEATED_GAP else CONTRADICTION


@kernel
def _close(march, system, work):
    """The projected end of a step is the start of the next."""
    copy(march.slopes[STAGES], march.slopes[0])
    return READY


@kernel
def _fill_row(march, t, report, system, work):
    """Fill a report row at a time up to the present one; a code."""
    clock, turns, row, x = march.clock[0], march.turns, march.clock[0]["row"], 1.0
    copy(march.z, march.trial)
    if t < clock["t"]:
        x = (t - clock["step_start"]) / clock["step_length"]
        interpolate(march.old, march.dense, x, march.trial)
    for s in range(turns.shape[1]):
        turns[NEAR, s] = (1.0 - x) * turns[OLD, s] + x * turns[NEW, s]
    clock["evaluations"] += 1
    copy(turns[NEAR], work.turns)
    q, u = coordinates_and_speeds(system, march.trial)
    if x < 1.0:
        _project(system, work, march, march.trial, t)
    else:
        clock["fault"] = factorise_at(system, work, q)
    if clock["fault"] != SOLVED:
        return STEP_VANISHED
    power = accelerate(system, work, q, u, t, report.rates[row])
    complete(system, work, march.trial, t, turns[NEAR], power, report, row)
    copy(march.trial, report.states[row])
    clock["row"] += 1
    return READY


_advance = dop853(Equations(_slope, _normalise, _finish, _watch, _close, _fill_row))


@kernel
def march_rows(task, system, work, march, report, budget):
    """Begin at the state z, or fill the rows of `report`, at most `budget` evaluations; a code.

    clock["row"] counts the rows filled.  The order of elimination must have been chosen.
    """
    if task == BEGIN:
        return _begin(march, system, work)
    return _advance(march, report, budget, system, work)


@kernel
def _begin(march, system, work):
    clock = march.clock[0]
    copy(march.z, march.old)
    copy(march.z, march.trial)
    clock["step_start"] = clock["t"]
    if not _slope(march, 0, clock["t"], system, work):
        return STEP_VANISHED
    clock["step"] = first_step(march, march.slopes[0])
    return READY
