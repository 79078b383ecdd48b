"""Stepping of a tree through time in compiled code, DOP853 with dense output at the report times.

The steps do not depend on how the report rows are cut into calls: a call ends between two steps and
the next goes on from there, so that a resumed run walks the same steps as an uninterrupted one.

The integration is a machine that asks for one evaluation of the slope after another, so that the equations
are called, and compiled, in one place only: `clock["phase"]` tells what the evaluation is for.
"""

from typing import NamedTuple

import numpy as np

from .._jit import kernel
from ..tree.energy import energies
from ..tree.kane import SOLVED
from ..tree.motion import derivative, normalise_attitudes, parts
from ..tree.projection import largest_gap, largest_rate, project, strayed
from .dop853_table import ALL_STAGES, DENSE_TERMS, STAGE_TIMES, STAGES
from .runge_kutta import interpolate, next_factor, scaled_norm, set_dense, set_stage, step_error

# What a call may be asked for: close the loops of z, begin at z, go on at z with a known step, integrate.
CLOSE, BEGIN, GO_ON, INTEGRATION = 0, 1, 2, 3
# What it answers.
ASKS, READY, ROWS_FULL, AT_STOP, PAUSED, STEP_VANISHED, NO_INERTIA = -1, 0, 1, 2, 3, 4, 5

# What an evaluation is for: the first slope, the probe for the first step, a stage of a step, a stage
# of its dense output; the open and the closed loops of an accepted step, and of a report row.
FIRST, PROBE, STAGE, DENSE, STEP_OPEN, STEP_CLOSED, ROW_OPEN, ROW_CLOSED = 0, 1, 2, 3, 4, 5, 6, 7
# Place in `slopes` of what is not a stage.
ASIDE = ALL_STAGES

CLOCK = np.dtype(
    [
        ("t", np.float64),  # s
        ("step", np.float64),  # length the next step will try, s
        ("rejected", np.int64),  # whether the attempt before it failed
        ("step_start", np.float64),  # the last accepted step: where it began,
        ("step_length", np.float64),  # how long it was,
        ("step_rejected", np.int64),  # and `rejected` as it was tried
        ("row", np.int64),  # report rows filled in this call
        ("evaluations", np.int64),  # since the run began
        ("spent", np.int64),  # evaluations at which this call pauses
        ("rejections", np.int64),
        ("fault", np.int64),  # coordinate without inertia at the last failed attempt, or SOLVED
        ("worst", np.int64),  # place in z of the largest error of the last attempt,
        ("strayed", np.int64),  # and whether closing the loops moved it there
        ("stop", np.float64),  # end of the interval in which all functions are linear, s
        ("gap", np.float64),  # largest gap that CLOSE left, m
        ("rtol", np.float64),
        ("atol", np.float64),
        ("phase", np.int64),  # what the evaluation is for,
        ("stage", np.int64),  # which stage,
        ("slot", np.int64),  # where its slope goes,
        ("at", np.float64),  # and for which time, s
    ]
)


class Integration(NamedTuple):
    """What an integration keeps from call to call, for states of n numbers."""

    clock: np.ndarray  # one record of CLOCK
    z: np.ndarray  # (n,) state at the time t
    old: np.ndarray  # (n,) state at the start of the last step
    trial: np.ndarray  # (n,) state whose slope is asked for
    slopes: np.ndarray  # (17, n)
    dense: np.ndarray  # (7, n)


class Report(NamedTuple):
    """Report rows of one call: T times and what is found at them."""

    times: np.ndarray  # (T,) s
    rows: np.ndarray  # (T, n) states
    frames: np.ndarray  # (T, F) of FRAME_WORK
    rates: np.ndarray  # (T, NS) y'
    closures: np.ndarray  # (T, R) of CLOSURE_ROW
    audit: np.ndarray  # (T, 5) kinetic, potential, strain energy, J, largest gap, m, its rate, m/s


def new_integration(n: int) -> Integration:
    """An integration at time 0 with an empty state."""
    clock = np.zeros(1, CLOCK)
    clock["fault"] = SOLVED
    return Integration(
        clock, np.zeros(n), np.zeros(n), np.zeros(n), np.zeros((ASIDE + 1, n)), np.zeros((DENSE_TERMS, n))
    )


@kernel
def call(task, budget, tree, work, coordinates, integration, report):
    """Do one task, for at most `budget` evaluations and the rest of a step; returns an answer."""
    clock = integration.clock[0]
    clock["row"] = 0
    clock["spent"] = clock["evaluations"] + budget
    answer = _begin(task, tree, clock, integration, report)
    while answer == ASKS:
        fault = derivative(
            tree, work, coordinates, clock["at"], integration.trial, integration.slopes[clock["slot"]]
        )
        clock["evaluations"] += 1
        answer = _digest(task, fault, tree, work, coordinates, clock, integration, report)
    return answer


@kernel
def _ask(clock, phase, stage, slot, at):
    clock["phase"], clock["stage"], clock["slot"], clock["at"] = phase, stage, slot, at
    return ASKS


@kernel
def _begin(task, tree, clock, integration, report):
    if task == INTEGRATION:
        return _next(tree, clock, integration, report)
    _copy(integration.z, integration.trial)
    return _ask(clock, STEP_OPEN if task == CLOSE else FIRST, 0, 0, clock["t"])


@kernel
def _digest(task, fault, tree, work, coordinates, clock, integration, report):
    """Use an evaluation, and ask for the next one or answer."""
    phase = clock["phase"]
    if phase == STAGE:
        return _digest_stage(fault, tree, clock, integration, report)
    if phase == DENSE:
        # The end points of the step had inertia; a point between them that has none is not worth a
        # failure, the polynomial then takes the slope as it stands.
        return _digest_dense(tree, clock, integration, report)
    if phase == ROW_CLOSED:
        _observe(tree, work, coordinates, clock, integration, report)
        return _next(tree, clock, integration, report)
    if fault != SOLVED:
        clock["fault"] = fault
        return NO_INERTIA
    if phase in (STEP_OPEN, ROW_OPEN):
        project(tree, work, coordinates, integration.trial)
        if phase == ROW_OPEN:
            return _ask(clock, ROW_CLOSED, 0, ASIDE, clock["at"])
        if task == INTEGRATION:
            place = strayed(integration.z, integration.trial, clock)
            if place >= 0:
                return _take_back(clock, integration, place)
        clock["gap"] = largest_gap(tree.closures)
        _copy(integration.trial, integration.z)
        return READY if task == CLOSE else _ask(clock, STEP_CLOSED, 0, 0, clock["at"])
    if phase == STEP_CLOSED:
        return _next(tree, clock, integration, report)
    return _digest_first(task, clock, integration)


@kernel
def _digest_first(task, clock, integration):
    """Choose the first step (Hairer et al., section II.4) from the first slope and a probe."""
    counted = integration.z.shape[0] - 1
    if task == GO_ON:
        return READY
    rtol, atol = clock["rtol"], clock["atol"]
    size = scaled_norm(integration.z, integration.z, rtol, atol, counted)
    slope = scaled_norm(integration.z, integration.slopes[0], rtol, atol, counted)
    first = 0.01 * size / slope if size > 1e-5 and slope > 1e-5 else 1e-6
    if clock["phase"] == FIRST:
        for i in range(integration.z.shape[0]):
            integration.trial[i] = integration.z[i] + first * integration.slopes[0, i]
        return _ask(clock, PROBE, 0, 1, clock["t"] + first)
    for i in range(counted):
        integration.slopes[1, i] -= integration.slopes[0, i]
    steepest = max(slope, scaled_norm(integration.z, integration.slopes[1], rtol, atol, counted) / first)
    second = (0.01 / steepest) ** 0.125 if steepest > 1e-15 else max(1e-6, 1e-3 * first)
    clock["step"] = min(100.0 * first, second)
    clock["step_start"], clock["step_length"] = clock["t"], clock["step"]
    clock["rejected"] = clock["step_rejected"] = 0
    return READY


@kernel
def _next(tree, clock, integration, report):
    """Between two steps: the next report row, an answer, or the first stage of the next step."""
    row, times = clock["row"], report.times
    if row == times.shape[0]:
        return ROWS_FULL
    if times[row] <= clock["t"]:
        return _ask_row(tree, clock, integration, times[row])
    if clock["t"] >= clock["stop"]:
        return AT_STOP
    if clock["evaluations"] >= clock["spent"]:
        return PAUSED
    return _try_step(clock, integration)


@kernel
def _ask_row(tree, clock, integration, t):
    """The state at a report time up to the present one, and what follows from it."""
    if t == clock["t"]:
        _copy(integration.z, integration.trial)
    else:
        x = (t - clock["step_start"]) / clock["step_length"]
        interpolate(integration.old, integration.dense, x, integration.trial)
        normalise_attitudes(tree, integration.trial)
    return _ask(clock, ROW_OPEN if tree.closures.shape[0] > 0 else ROW_CLOSED, 0, ASIDE, t)


@kernel
def _length(clock):
    """Length of the step to try: it ends at the stop or before."""
    return min(clock["step"], clock["stop"] - clock["t"])


@kernel
def _try_step(clock, integration):
    h, t = _length(clock), clock["t"]
    if not h > 1e-15 * max(abs(t), 1e-3):
        return STEP_VANISHED
    set_stage(integration.z, integration.slopes, 1, h, integration.trial)
    return _ask(clock, STAGE, 1, 1, t + h * STAGE_TIMES[1])


@kernel
def _digest_stage(fault, tree, clock, integration, report):
    """The next stage of a step, or the judgement of the whole step."""
    h, stage = _length(clock), clock["stage"] + 1
    error = 1e10
    clock["fault"] = fault
    if fault == SOLVED and stage <= STAGES:
        set_stage(integration.z, integration.slopes, stage, h, integration.trial)
        if stage == STAGES:
            normalise_attitudes(tree, integration.trial)
        return _ask(clock, STAGE, stage, stage, clock["t"] + h * STAGE_TIMES[stage])
    if fault == SOLVED:
        counted = integration.z.shape[0] - 1
        error, clock["worst"] = step_error(
            integration.z, integration.trial, integration.slopes, h, clock["rtol"], clock["atol"], counted
        )
    rejected = clock["rejected"]
    # `not <` and `<` both reject a nan.
    factor = next_factor(error, rejected) if error < 1e10 else 0.2
    if not error < 1.0:
        clock["rejections"] += 1
        clock["rejected"], clock["strayed"] = 1, 0
        clock["step"] = h * factor
        return _try_step(clock, integration)
    _accept(clock, integration, h, rejected)
    clock["step"] = h * factor
    if clock["row"] < report.times.shape[0] and report.times[clock["row"]] < clock["t"]:
        clock["stage"] = STAGES
        return _digest_dense(tree, clock, integration, report)
    return _close_step(tree, clock, integration, report)


@kernel
def _accept(clock, integration, h, rejected):
    last = h >= clock["stop"] - clock["t"]
    clock["step_start"], clock["step_length"], clock["step_rejected"] = clock["t"], h, rejected
    clock["t"] = clock["stop"] if last else clock["t"] + h
    clock["rejected"] = 0
    _copy(integration.z, integration.old)
    _copy(integration.trial, integration.z)


@kernel
def _take_back(clock, integration, place):
    """A shorter step from where the last one began, for closing the loops moved its end too far."""
    clock["t"], clock["step"] = clock["step_start"], 0.2 * clock["step_length"]
    # A resumed run begins with the shorter step too.
    clock["step_length"], clock["rejected"], clock["step_rejected"] = clock["step"], 1, 1
    clock["worst"], clock["strayed"] = place, 1
    clock["rejections"] += 1
    _copy(integration.old, integration.z)
    return _try_step(clock, integration)


@kernel
def _digest_dense(tree, clock, integration, report):
    """The next stage of the dense output, or its polynomial."""
    h, stage = clock["step_length"], clock["stage"] + 1
    if stage < ALL_STAGES:
        set_stage(integration.old, integration.slopes, stage, h, integration.trial)
        return _ask(clock, DENSE, stage, stage, clock["step_start"] + h * STAGE_TIMES[stage])
    set_dense(integration.old, integration.z, integration.slopes, h, integration.dense)
    return _close_step(tree, clock, integration, report)


@kernel
def _close_step(tree, clock, integration, report):
    """The slope at the end of a step is that at the start of the next, once the loops are closed."""
    if tree.closures.shape[0] == 0:
        _copy(integration.slopes[STAGES], integration.slopes[0])
        return _next(tree, clock, integration, report)
    _copy(integration.z, integration.trial)
    # slopes[0] is needed again where the step must be taken back.
    return _ask(clock, STEP_OPEN, 0, ASIDE, clock["t"])


@kernel
def _observe(tree, work, coordinates, clock, integration, report):
    """Fill a report row from the state that has just been evaluated."""
    row = clock["row"]
    _copy(integration.trial, report.rows[row])
    for k in range(work.shape[0]):
        report.frames[row, k] = work[k]
    for m in range(coordinates.shape[0]):
        report.rates[row, m] = coordinates[m]["rate"]
    for j in range(tree.closures.shape[0]):
        report.closures[row, j] = tree.closures[j]
    y, q, _attitudes = parts(tree, integration.trial)
    audit = report.audit[row]
    audit[0], audit[1], audit[2] = energies(tree, work, q, y)
    audit[3], audit[4] = largest_gap(tree.closures), largest_rate(tree.closures)
    clock["row"] = row + 1


@kernel
def _copy(a, b):
    """b = a."""
    for i in range(a.shape[0]):
        b[i] = a[i]
