"""Stepping of a constrained mechanism through time by the generalised-α method in compiled code.

Steps have a given length, or one that keeps the error of a step within the tolerance; they do not
depend on how the report rows are cut into calls.  Rows inside a step come from Hermite's cubic through
both ends; every row is brought onto the constraints to round-off, and its accelerations and forces are
those of the equations of motion there.

What a call is asked for and what it answers is reported in `constrained_dop853`.
"""

from collections import namedtuple

import numpy as np

from .._jit import allocating, kernel
from ..constrained.angle_unwrapping import EXPECTED, OLD, unwrap_angles
from ..constrained.angle_unwrapping import NEW as TURNED
from ..constrained.body_vectors import geometry_of, place_vectors
from ..constrained.projection import largest_gap
from ..constrained.report import complete, coordinates_and_speeds
from ..constrained.system import A
from ..linalg.rotation import rotation_matrices
from .constrained_dop853 import (
    BEGIN,
    CONTRADICTION,
    PAUSED,
    READY,
    REPEATED_GAP,
    ROWS_FULL,
    SMALLEST_STEP,
    STEP_VANISHED,
)
from .generalised_alpha_control import SAME, SLOWEST, advance, factor_of, next_length, retreat
from .generalised_alpha_step import (
    BEFORE,
    LAST,
    MEAN,
    NEW,
    NEW_MEAN,
    fastest_change,
    iterate,
    solve_step,
    turn_exactly,
)
from .rotation_increments import FAR_TURN, LONGEST_TURN, largest_turn, set_slope, shift_between
from .singular_ahead import look_ahead

CLOCK = np.dtype(
    [
        ("t", np.float64),  # s
        ("step", np.float64),  # length the next step will try, s
        ("fixed", np.float64),  # length that all steps have, s, 0: chosen
        ("rho", np.float64),  # spectral radius at infinity
        ("start", np.float64),  # first time, s
        ("whole", np.int64),  # steps of given length that are behind
        ("rejected", np.int64),  # whether the attempt before it failed
        ("step_start", np.float64),  # the last accepted step: where it began,
        ("step_length", np.float64),  # how long it was, 0 before the first
        ("mean_length", np.float64),  # step that the means of the accelerations belong to
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
        ("error", np.float64),  # of the step that is tried, in tolerances, of the share of chosen ones,
        ("share", np.float64),  # that share,
        ("span", np.float64),  # of the whole run, s
        ("turned", np.float64),  # and how far a body turns in it, of the longest turn
        ("left", np.float64),  # error that an iteration leaves, as a share of its size, seen last
        ("power", np.float64),  # of drivers and loads that store no energy, at t, W
        ("new_power", np.float64),  # and at the end of the step that is tried
        ("old_power", np.float64),  # and at the start of the last step
        ("pivot_order", np.float64),  # quality of the order of the pivots at a step's end,
        ("pivot_time", np.float64),  # and that time, s
        ("singular", np.float64),  # time of the singular position ahead, s, infinity: none near,
        ("passing", np.float64),  # and length of the step over it, s
    ]
)

AlphaIntegration = namedtuple(
    "AlphaIntegration", "clock z old trial units angles rates missing step shift gaps newton"
)
AlphaIntegration.__doc__ = """What an integration keeps from call to call, for n speeds, states of N numbers,
m equations.

clock (1,) CLOCK.  z, old, trial, units (N,): state, that at the start of the last step, the one
tried or reported, a state's unit.  angles (3, screws): see `screw_turns`.  rates (5, n): see
`generalised_alpha`.  missing, step, shift (n,), gaps (3, m):
of an iteration.  newton: the Work whose `reduced` is the matrix.
"""


def new_integration(work, angles):
    """An integration at time 0 with an empty state, for the `work` of a mechanism and so many angles."""
    m, n = work.jacobian.shape
    size = 2 * n + work.mass.shape[0] + 1
    states = [np.zeros(size) for _ in range(3)]
    return AlphaIntegration(
        np.zeros(1, CLOCK),
        *states,
        np.ones(size),
        np.zeros((3, angles)),
        np.zeros((5, n)),
        *(np.zeros(n) for _ in range(3)),
        np.zeros((3, m)),
        work._replace(reduced=np.zeros_like(work.reduced)),
    )


@kernel
def integrate_rows(task, system, work, integration, report, budget):
    """Begin at the state z, or fill the rows of `report`, at most `budget` evaluations; an answer.

    clock["row"] counts the rows filled.  The order of elimination must have been chosen.
    """
    clock = integration.clock[0]
    clock["row"] = 0
    if task == BEGIN:
        return _begin(system, work, integration)
    spent = clock["evaluations"] + budget
    while clock["row"] < report.times.shape[0]:
        t = report.times[clock["row"]]
        if t <= clock["t"] + SAME * clock["step"]:
            if not _fill_row(system, work, integration, t, report):
                return STEP_VANISHED
        elif clock["evaluations"] >= spent:
            return PAUSED
        else:
            answer = _step(system, work, integration)
            if answer != READY:
                return answer
    return ROWS_FULL


@kernel
def _begin(system, work, integration):
    clock, rates = integration.clock[0], integration.rates
    clock["start"] = clock["step_start"] = clock["t"]
    clock["left"], clock["singular"], clock["span"] = 1.0, np.inf, clock["stop"] - clock["t"]
    _copy(integration.z, integration.trial)
    if not iterate(system, work, integration, clock["t"], 0.0, 0.0, 0.0):
        return STEP_VANISHED
    clock["power"] = clock["new_power"]
    _copy(integration.trial, integration.z)
    _copy(integration.z, integration.old)
    for kind in (LAST, BEFORE, MEAN):
        _copy(rates[NEW], rates[kind])
    clock["step"] = clock["passing"] = (
        clock["fixed"] if clock["fixed"] > 0.0 else _first_step(system, integration)
    )
    return READY


@kernel
def _first_step(system, integration):
    """A hundredth of the time in which the accelerations make the speeds."""
    clock, fastest = integration.clock[0], fastest_change(system, integration)
    return 0.01 * min(1.0 / fastest if fastest > 0.0 else 1.0, clock["stop"] - clock["t"])


@kernel
def _copy(a, b):
    """b = a."""
    for i in range(a.shape[0]):
        b[i] = a[i]


@kernel
def _step(system, work, integration):
    """One accepted step; an answer."""
    clock = integration.clock[0]
    while True:
        h = next_length(clock)
        if not h > SMALLEST_STEP * max(abs(clock["t"]), 1e-3):
            return STEP_VANISHED
        if not solve_step(system, work, integration, h):
            retreat(clock, h, h / 4.0)
        elif clock["fixed"] == 0.0 and not _holds(system, integration, h):
            retreat(clock, h, h * (factor_of(clock) if clock["error"] < 1e10 else SLOWEST))
        else:
            _accept(system, work, integration, h)
            return READY if clock["gap"] <= REPEATED_GAP else CONTRADICTION


@kernel
def _holds(system, integration, h):
    """Return whether a step of length h is within the tolerance, and turns no body too far."""
    clock, bodies, first = (
        integration.clock[0],
        system.masses.shape[0],
        integration.z.shape[0] - 1 - integration.rates.shape[1],
    )
    fastest = max(
        largest_turn(bodies, integration.z[first:-1]), largest_turn(bodies, integration.trial[first:-1])
    )
    clock["turned"] = h * fastest / LONGEST_TURN
    return clock["error"] < 1.0 and clock["turned"] < 1.0


@kernel
def _accept(system, work, integration, h):
    """Make the end of a step the state."""
    clock, rates, z = integration.clock[0], integration.rates, integration.z
    last = z.shape[0] - 1
    _copy(z, integration.old)
    _copy(integration.trial, z)
    z[last] = integration.old[last] + 0.5 * h * (clock["power"] + clock["new_power"])
    clock["old_power"], clock["power"] = clock["power"], clock["new_power"]
    _copy(rates[LAST], rates[BEFORE])
    _copy(rates[NEW], rates[LAST])
    _copy(rates[NEW_MEAN], rates[MEAN])
    advance(clock, h)
    clock["gap"], clock["worst"] = largest_gap(system, work)
    if integration.angles.shape[1] > 0:
        q = coordinates_and_speeds(system, z)[0]
        rotation_matrices(q, work.rotations[A])
        place_vectors(geometry_of(system, work), q)
        unwrap_angles(system, work, integration)
    if clock["fixed"] == 0.0:
        look_ahead(system, work, integration, rates[LAST], clock["passing"])


@kernel
def _fill_row(system, work, integration, t, report):
    """A report row at a time up to the present one; returns whether there is one."""
    clock, angles, row, x = integration.clock[0], integration.angles, integration.clock[0]["row"], 1.0
    _copy(integration.z, integration.trial)
    if t < clock["t"] - SAME * clock["step_length"]:
        x = (t - clock["step_start"]) / clock["step_length"]
        _between(system, integration, x, integration.trial)
    for s in range(angles.shape[1]):
        angles[EXPECTED, s] = (1.0 - x) * angles[OLD, s] + x * angles[TURNED, s]
    _copy(angles[EXPECTED], work.angles)
    if not iterate(system, work, integration, t, 0.0, 0.0, 0.0):
        return False
    _copy(integration.trial, report.states[row])
    _copy(integration.rates[NEW], report.rates[row])
    complete(system, work, integration.trial, t, angles[EXPECTED], clock["new_power"], report, row)
    clock["row"] += 1
    return True


@allocating
def _between(system, integration, x, point):
    """Fill point with the state at the fraction x of the last step."""
    clock, old, z, n = integration.clock[0], integration.old, integration.z, system.speed_scale.shape[0]
    nq, h, bodies = z.shape[0] - 1 - n, clock["step_length"], system.masses.shape[0]
    shift, before, after, mean = np.empty(n), np.empty(n), np.empty(n), np.empty(n)
    for k in range(n):
        before[k] = old[nq + k]
        mean[k] = 0.5 * h * (old[nq + k] + z[nq + k])
    shift_between(bodies, old[:nq], z[:nq], mean, shift)
    set_slope(bodies, shift, z[nq : nq + n], after)
    for body in range(bodies if largest_turn(bodies, shift) > FAR_TURN else 0):
        for k in range(6 * body + 3, 6 * body + 6):
            before[k] = after[k] = shift[k] / h
    for k in range(n):
        shift[k] = _cubic(x, 0.0, shift[k], h * before[k], h * after[k])
    for i in range(nq):
        point[i] = old[i]
    turn_exactly(bodies, point[:nq], shift)
    for k in range(n):
        i = nq + k
        point[i] = _cubic(x, old[i], z[i], h * integration.rates[BEFORE, k], h * integration.rates[LAST, k])
    last = nq + n
    point[last] = _cubic(x, old[last], z[last], h * clock["old_power"], h * clock["power"])


@kernel
def _cubic(x, a, b, da, db):
    change = b - a
    return a + x * (da + x * (3.0 * change - 2.0 * da - db + x * (da + db - 2.0 * change)))
