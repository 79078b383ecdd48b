"""Stepping of a constrained mechanism through time in compiled code: DOP853 on accelerations.

The accelerations are those of the index-1 equations; every accepted step is projected onto positions
and speeds to round-off, so that nothing drifts, and judged anew if the projection moves it by more
than the tolerance allows.  Report rows come from the dense output and are projected as well.

Hairer, Nørsett and Wanner, Solving Ordinary Differential Equations I (second edition), sections
II.4-II.6; projection: Hairer and Wanner, volume II, section VII.2.

The state z (2 n + b + 1,) of b bodies with n speeds holds coordinates, speeds and the work of drivers and
loads since the start.  The steps do not depend on how the report rows are cut into calls.  As in
`tree_dop853` the integration is a machine that asks for one evaluation after another, so that the equations
are compiled in one place.
"""

from collections import namedtuple

import numpy as np

from .._jit import allocating, kernel
from ..constrained.accelerations import accelerate, factorise_at
from ..constrained.angle_unwrapping import EXPECTED, MOST_TURNED, NEW, OLD, expect_angles, unwrap_angles
from ..constrained.projection import largest_gap, project_position, project_speeds
from ..constrained.report import complete, coordinates_and_speeds
from ..constrained.speeds import coordinate_rates, normalise
from ..constrained.system import SOLVED
from .dop853_table import ALL_STAGES, DENSE_TERMS, STAGE_TIMES, STAGES
from .explicit_error import error_on_constraints, scaled_norm, step_error
from .runge_kutta import interpolate, next_factor, set_dense, set_stage
from .singular_ahead import NOISE, laid_out, leads_over, look_ahead, round_off

# What a call may be asked for, and what it answers.
BEGIN, INTEGRATION = 0, 1
ASKS, ROWS_FULL, PAUSED, STEP_VANISHED, CONTRADICTION, READY, STEP_SHORT = -1, 0, 1, 2, 3, 4, 5
# What an evaluation is for: the first slope, a stage of a step, its projected end, a stage of its dense
# output, a report row.
FIRST, STAGE, STEP_END, DENSE, ROW = 0, 1, 2, 3, 4
MOST_MOVED = 10.0  # tolerances by which a projection may move an accepted step
REPEATED_GAP = 1e-7  # what equations that repeat others may be off, scaled
SMALLEST_STEP = 1e-14
# Of the longest step.  Where two motions cross, equations that are 1e-16 off lead from one to the other in
# some 1e-8 s: steps so short follow that blow, and the speeds jump.
SHORT = 1e-6
SHARE = 0.46  # of a step in front of a singular position: no stage is nearer than an eighth of the step
# Of a step over such a position: its error before it is projected, in tolerances or of the speeds, whichever
# is more, and by how much that may move it, scaled; on another branch it would be off by its turn.
BLURRED, BLURRED_SPEEDS, MOST_BLURRED = 1e4, 1e-6, 1e-5
HOPELESS = 1e10  # error of a step that cannot be made

CLOCK = np.dtype(
    [
        ("t", np.float64),  # s
        ("step", np.float64),  # length the next step will try, s
        ("rejected", np.int64),  # whether the attempt before it failed
        ("step_start", np.float64),  # the last accepted step: where it began,
        ("step_length", np.float64),  # how long it was
        ("dense", np.int64),  # whether its dense output is ready
        ("stop", np.float64),  # no step goes further, s
        ("row", np.int64),  # report rows filled in this call
        ("steps", np.int64),
        ("evaluations", np.int64),
        ("rejections", np.int64),
        ("fault", np.int64),  # code of the last failed evaluation, or SOLVED
        ("worst", np.int64),  # equation with the largest gap,
        ("gap", np.float64),  # and that gap, scaled
        ("rtol", np.float64),
        ("atol", np.float64),
        ("phase", np.int64),  # what the evaluation is for,
        ("stage", np.int64),  # at which stage,
        ("at", np.float64),  # for which time, s,
        ("projects", np.int64),  # whether its state is projected first,
        ("moved", np.float64),  # and by how many tolerances that moved it
        ("length", np.float64),  # of the step that is tried, s
        ("error", np.float64),  # of the step whose end is being evaluated
        ("longest", np.float64),  # step so far, s
        ("pivot_order", np.float64),  # quality of the order of the pivots at a step's end,
        ("pivot_time", np.float64),  # and that time, s
        ("singular", np.float64),  # time of the singular position ahead, s, infinity: none near
        ("excused", np.int64),  # whether the caller knows that steps are short here, and goes on
    ]
)

Integration = namedtuple("Integration", "clock z old trial slopes dense units angles")
Integration.__doc__ = """What an integration keeps from call to call, for states of N numbers.

clock (1,) CLOCK.  z, old, trial (N,).  slopes (16, N).  dense (7, N).  units (N,): a state's unit.
angles (3, angles): see `screw_turns`.
"""


def new_integration(n, angles):
    """An integration at time 0 with an empty state of n numbers."""
    return Integration(
        np.zeros(1, CLOCK),
        np.zeros(n),
        np.zeros(n),
        np.zeros(n),
        np.zeros((ALL_STAGES, n)),
        np.zeros((DENSE_TERMS, n)),
        np.ones(n),
        np.zeros((3, angles)),
    )


@kernel
def integrate_rows(task, system, work, integration, report, budget):
    """Begin at the state z, or fill the rows of `report`, at most `budget` evaluations; an answer.

    clock["row"] counts the rows filled.  The order of elimination must have been chosen.
    """
    clock = integration.clock[0]
    clock["row"] = 0
    spent = clock["evaluations"] + budget
    answer = _begin(integration) if task == BEGIN else _next(integration, report, spent)
    while answer == ASKS:
        clock["evaluations"] += 1
        clock["fault"] = _evaluate(system, work, integration, report)
        answer = _digest(system, work, integration, report, spent)
    return answer


@kernel
def _ask(clock, phase, stage, at, projects):
    clock["phase"], clock["stage"], clock["at"], clock["projects"] = phase, stage, at, projects
    return ASKS


@kernel
def _evaluate(system, work, integration, report):
    """The slope at `trial`, brought onto the constraints first where asked, or a whole report row; a code."""
    clock, z, row = integration.clock[0], integration.trial, integration.clock[0]["row"]
    q, u = coordinates_and_speeds(system, z)
    reports = clock["phase"] == ROW
    _copy(integration.angles[EXPECTED if reports or clock["phase"] == STEP_END else NEW], work.angles)
    if clock["projects"]:
        clock["moved"] = _project(system, work, integration, z, clock["at"])
        if not clock["moved"] < np.inf:
            return clock["fault"]
    else:
        code = factorise_at(system, work, q)
        if code != SOLVED:
            return code
    out = integration.slopes[clock["stage"]]
    qd, slopes = coordinates_and_speeds(system, out)
    ud = report.rates[row] if reports else slopes
    power = accelerate(system, work, q, u, clock["at"], ud)
    if reports:
        complete(system, work, z, clock["at"], integration.angles[EXPECTED], power, report, row)
    else:
        coordinate_rates(system.masses.shape[0], q, u, qd)
        out[out.shape[0] - 1] = power
    return SOLVED


@kernel
def _digest(system, work, integration, report, spent):
    """Use an evaluation, and ask for the next one or answer."""
    clock = integration.clock[0]
    phase, failed = clock["phase"], clock["fault"] != SOLVED
    if phase == STAGE:
        return _reject(integration, 0.2) if failed else _next_stage(system, work, integration)
    if phase == DENSE:
        # The ends of the step were solved; where a point between them is not, its slope stays as it is.
        return _next_dense(integration, report, spent)
    if phase == STEP_END:
        if failed or not _holds(system, work, integration):
            return _reject(integration, 0.2 if failed else 0.5)
        _accept(system, work, integration)
        return _next(integration, report, spent) if clock["gap"] <= REPEATED_GAP else CONTRADICTION
    if failed:
        return STEP_VANISHED
    if phase == FIRST:
        return _choose_first_step(integration)
    _copy(integration.trial, report.states[clock["row"]])
    clock["row"] += 1
    return _next(integration, report, spent)


@kernel
def _holds(system, work, integration):
    """Return whether a step may be made, whose projected end is in trial."""
    clock, h = integration.clock[0], integration.clock[0]["length"]
    noise = max(1.0, NOISE * round_off(work) / clock["rtol"])
    if not leads_over(clock, h):
        return clock["moved"] < MOST_MOVED * noise
    clock["error"] = min(clock["error"], error_on_constraints(system, work, integration, h))
    return clock["error"] < noise and clock["moved"] * clock["rtol"] < MOST_BLURRED


@kernel
def _copy(a, b):
    """b = a."""
    for i in range(a.shape[0]):
        b[i] = a[i]


@kernel
def _begin(integration):
    clock = integration.clock[0]
    _copy(integration.z, integration.old)
    _copy(integration.z, integration.trial)
    clock["step_start"], clock["dense"], clock["singular"] = clock["t"], 0, np.inf
    return _ask(clock, FIRST, STAGES, clock["t"], 0)


@kernel
def _choose_first_step(integration):
    clock = integration.clock[0]
    size, speed = (
        scaled_norm(integration, integration.z),
        scaled_norm(integration, integration.slopes[STAGES]),
    )
    clock["step"] = 0.01 * size / speed if size > 1e-5 and speed > 1e-5 else 1e-6
    return READY


@kernel
def _next(integration, report, spent):
    """Between two steps: the next report row, an answer, or the first stage of the next step."""
    clock = integration.clock[0]
    if clock["row"] == report.times.shape[0]:
        return ROWS_FULL
    t = report.times[clock["row"]]
    if t < clock["t"] and clock["dense"] == 0:
        return _ask_dense(integration, STAGES + 1)
    if t <= clock["t"]:
        return _ask_row(integration, t)
    if clock["evaluations"] >= spent:
        return PAUSED
    if clock["step"] < SHORT * clock["longest"] and clock["excused"] == 0:
        return STEP_SHORT
    _copy(integration.slopes[STAGES], integration.slopes[0])
    return _try_step(integration)


@kernel
def _try_step(integration):
    clock = integration.clock[0]
    h = clock["length"] = min(laid_out(clock, clock["step"], SHARE), clock["stop"] - clock["t"])
    if not h > SMALLEST_STEP * max(abs(clock["t"]), 1e-3):
        return STEP_VANISHED
    set_stage(integration.z, integration.slopes, 1, h, integration.trial)
    return _ask(clock, STAGE, 1, clock["t"] + h * STAGE_TIMES[1], 0)


@kernel
def _reject(integration, factor):
    """Try the step again, shorter."""
    clock = integration.clock[0]
    clock["rejections"] += 1
    clock["rejected"] = 1
    clock["step"] = clock["length"] * factor
    return _try_step(integration)


@kernel
def _next_stage(system, work, integration):
    """The next stage of a step, or its end where the error allows it."""
    clock, h, stage = integration.clock[0], integration.clock[0]["length"], integration.clock[0]["stage"] + 1
    set_stage(integration.z, integration.slopes, stage, h, integration.trial)
    if stage < STAGES:
        return _ask(clock, STAGE, stage, clock["t"] + h * STAGE_TIMES[stage], 0)
    error = clock["error"] = step_error(integration, h)
    blurred = max(BLURRED, BLURRED_SPEEDS / clock["rtol"])
    # `not <` rejects a nan as well.
    if not error < (blurred if leads_over(clock, h) else 1.0):
        return _reject(integration, next_factor(error, 1) if error < HOPELESS else 0.2)
    if not expect_angles(system, work, integration, h) < MOST_TURNED:
        return _reject(integration, 0.5)
    return _ask(clock, STEP_END, STAGES, clock["t"] + h, 1)


@allocating
def _project(system, work, integration, z, t):
    """Bring a state onto the constraints at t, with the factors there.

    Returns by how many tolerances it moved, or infinity.
    """
    clock, n = integration.clock[0], system.speed_scale.shape[0]
    end = n + system.masses.shape[0]
    q, u, before = z[:end], z[end : end + n], z.copy()
    normalise(system.masses.shape[0], q)
    code = project_position(system, work, q, t, integration.angles[EXPECTED])
    if code == SOLVED:
        code = project_speeds(system, work, q, u, t)[0]
    if code != SOLVED:
        clock["fault"] = code
        return np.inf
    for i in range(z.shape[0]):
        before[i] -= z[i]
    return scaled_norm(integration, before)


@kernel
def _accept(system, work, integration):
    """Make the projected end of a step the state; PHI belongs to it."""
    clock, h = integration.clock[0], integration.clock[0]["length"]
    _copy(integration.z, integration.old)
    _copy(integration.trial, integration.z)
    clock["step"] = h * next_factor(clock["error"], clock["rejected"])
    clock["step_start"], clock["step_length"] = clock["t"], h
    clock["longest"] = max(clock["longest"], h)
    if h > 10.0 * SHORT * clock["longest"]:
        clock["excused"] = 0
    last = h >= clock["stop"] - clock["t"]
    clock["t"] = clock["stop"] if last else clock["t"] + h
    clock["rejected"], clock["dense"] = 0, 0
    clock["steps"] += 1
    unwrap_angles(system, work, integration)
    clock["gap"], clock["worst"] = largest_gap(system, work)
    look_ahead(
        system,
        work,
        integration,
        coordinates_and_speeds(system, integration.slopes[STAGES])[1],
        clock["step"],
    )


@kernel
def _ask_dense(integration, stage):
    clock, h = integration.clock[0], integration.clock[0]["step_length"]
    set_stage(integration.old, integration.slopes, stage, h, integration.trial)
    return _ask(clock, DENSE, stage, clock["step_start"] + h * STAGE_TIMES[stage], 0)


@kernel
def _next_dense(integration, report, spent):
    """The next stage of the dense output, or its polynomial."""
    clock, stage = integration.clock[0], integration.clock[0]["stage"] + 1
    if stage < ALL_STAGES:
        return _ask_dense(integration, stage)
    set_dense(integration.old, integration.z, integration.slopes, clock["step_length"], integration.dense)
    clock["dense"] = 1
    return _next(integration, report, spent)


@kernel
def _ask_row(integration, t):
    """The state at a report time up to the present one, and what follows from it."""
    clock, angles = integration.clock[0], integration.angles
    x = 1.0
    if t < clock["t"]:
        x = (t - clock["step_start"]) / clock["step_length"]
        interpolate(integration.old, integration.dense, x, integration.trial)
    else:
        _copy(integration.z, integration.trial)
    for s in range(angles.shape[1]):
        angles[EXPECTED, s] = (1.0 - x) * angles[OLD, s] + x * angles[NEW, s]
    return _ask(clock, ROW, 0, t, 1 if x < 1.0 else 0)
