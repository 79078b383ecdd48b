"""Stepping of a constrained mechanism through time by Radau's method of order 5 in compiled code.

Steps keep the error of a step within the tolerance; they do not depend on how the report rows are cut into
calls.  The end of every step is brought onto positions and speeds to round-off by the shortest way in the
measure of the matrix of the step, so that stiff motions stay at rest.  Rows inside a step come from Hermite's
quintic through coordinates, their rates and accelerations at both ends, and are brought there as well.

What a call is asked for and what it answers is reported in `constrained_dop853`.
"""

from collections import namedtuple

import numpy as np

from .._jit import allocating, kernel
from ..constrained.accelerations import factorise_constraints
from ..constrained.angle_unwrapping import EXPECTED, MOST_TURNED, NEW, OLD, expect_angles, unwrap_angles
from ..constrained.mass_matrix import mass_matrices
from ..constrained.projection import largest_gap
from ..constrained.report import complete, coordinates_and_speeds
from ..constrained.system import NO_INERTIA, SOLVED
from ..linalg.rank_revealing_lu import BRANCHING, smallest_pivot
from .constrained_dop853 import (
    BEGIN,
    CONTRADICTION,
    MOST_MOVED,
    PAUSED,
    READY,
    REPEATED_GAP,
    ROWS_FULL,
    SMALLEST_STEP,
    STEP_VANISHED,
)
from .radau5_projection import close_gaps, moved, project_state
from .radau5_rows import between
from .radau5_singular_step import singular_step
from .radau5_step import LAST, START, place_trial, prepare, renew_matrices, solve_step, step_error, work_error
from .radau5_table import STAGES, WEIGHTS
from .rotation_increments import LONGEST_TURN, largest_turn
from .singular_ahead import blur, laid_out, look_ahead

SAFETY, SLOWEST, FASTEST = 0.9, 0.2, 6.0
CALM = 1e-2  # error in tolerances below which it has not grown
SLOW = 0.01  # what an iteration may leave before the matrices are renewed
STEEPEST = 3.0 / (25.0 * 5.0**0.5)  # slope of x³ (1 - x)³
BRANCHING_START = 0.1  # of the smallest pivot at the start, where that is tiny: smaller ones are singular
BLIND = 30.0  # of that pivot, in front of which a row has no accelerations but those of round-off
SHARE = 0.45  # of a step in front of a singular position
NONE = 0.0  # quality of matrices that are not those of the state

CLOCK = np.dtype(
    [
        ("t", np.float64),  # s
        ("step", np.float64),  # length the next step will try, s
        ("rejected", np.int64),  # attempts before it that failed
        ("step_start", np.float64),  # the last accepted step: where it began,
        ("step_length", np.float64),  # how long it was, 0 before the first
        ("length", np.float64),  # of the step that is tried, s
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
        ("error", np.float64),  # of the step that is tried, in tolerances,
        ("last_error", np.float64),  # and of the last accepted one, 0 before the first
        ("left", np.float64),  # error that an iteration leaves, as a share of its size, seen last
        ("quality", np.float64),  # of the order of elimination that the matrices belong to
        ("power", np.float64),  # of drivers and loads that store no energy, at t, W
        ("old_power", np.float64),  # and at the start of the last step
        ("pivot_order", np.float64),  # quality of the order of the pivots at a step's end,
        ("pivot_time", np.float64),  # and that time, s
        ("singular", np.float64),  # time of the singular position ahead, s, infinity: none near
        ("branching", np.float64),  # pivot below which a position is singular
    ]
)

RadauIntegration = namedtuple(
    "RadauIntegration",
    "clock z old trial units angles rates speeds slopes shifts steps momenta missing powers rest motions "
    "matrices complex real_part complex_part newton",
)
RadauIntegration.__doc__ = """What an integration keeps from call to call, for n speeds, states of N numbers.

clock (1,) CLOCK.  z, old, trial, units (N,): state, that at the start of the last step, the one
tried or reported, a state's unit.  angles (3, angles): see `screw_turns`.  rates (8, n): see `radau_step`.
Of the three stages: speeds, shifts and their rates slopes, steps of an iteration, momenta M u (3, n), powers
(3,), rest (3, n) in free motions, motions (3, n, n).  missing (n,).  matrices (3, n, n): see `radau_step`.
complex (n, n): factors.  real_part, complex_part (n,).  newton: the Work whose `reduced` is the real matrix.
"""


def new_integration(work, angles):
    """An integration at time 0 with an empty state, for the `work` of a mechanism and so many angles."""
    n = work.jacobian.shape[1]
    size = 2 * n + work.mass.shape[0] + 1
    states = [np.zeros(size) for _ in range(3)]
    return RadauIntegration(
        np.zeros(1, CLOCK),
        *states,
        np.ones(size),
        np.zeros((3, angles)),
        np.zeros((2 * (STAGES + 1), n)),
        *(np.zeros((STAGES, n)) for _ in range(5)),
        np.zeros(n),
        np.zeros(STAGES),
        np.zeros((STAGES, n)),
        np.zeros((STAGES, n, n)),
        np.zeros((3, n, n)),
        np.zeros((n, n), complex),
        np.zeros(n),
        np.zeros(n, complex),
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
        if t <= clock["t"]:
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
    clock["step_start"], clock["left"] = clock["t"], 1.0
    _copy(integration.z, integration.trial)
    _copy(integration.angles[NEW], integration.angles[EXPECTED])
    code = _renew(system, work, integration)
    if code == SOLVED and not prepare(integration, work.jacobian.shape[1] - work.rank[0], 0.0):
        code = NO_INERTIA
    if code == SOLVED:
        code, clock["power"] = project_state(system, work, integration, clock["t"], rates[START])
    clock["fault"] = code
    if code != SOLVED:
        return STEP_VANISHED
    _copy(integration.trial, integration.z)
    _copy(integration.z, integration.old)
    clock["singular"] = np.inf
    clock["branching"] = min(BRANCHING, BRANCHING_START * smallest_pivot(work.factors, work.rank[0]))
    for node in range(STAGES + 1):
        _copy(rates[START], rates[LAST + node])
    clock["step"] = _first_step(system, integration)
    return READY


@kernel
def _first_step(system, integration):
    """A hundredth of the time in which the accelerations make the speeds."""
    clock, n = integration.clock[0], system.speed_scale.shape[0]
    u = coordinates_and_speeds(system, integration.z)[1]
    fastest = 0.0
    for k in range(n):
        fastest = max(fastest, abs(integration.rates[START, k]) / (system.speed_scale[k] + abs(u[k])))
    return 0.01 * min(1.0 / fastest if fastest > 0.0 else 1.0, clock["stop"] - clock["t"])


@kernel
def _copy(a, b):
    """b = a."""
    for i in range(a.shape[0]):
        b[i] = a[i]


@kernel
def _renew(system, work, integration):
    """The matrices of the state z anew; a code."""
    q = coordinates_and_speeds(system, integration.z)[0]
    code = factorise_constraints(system, work, q)
    if code == SOLVED:
        mass_matrices(system, work, q)
        renew_matrices(system, work, integration.matrices)
        integration.clock[0]["quality"] = work.quality[0]
    return code


@kernel
def _step(system, work, integration):
    """One accepted step; an answer."""
    clock = integration.clock[0]
    _copy(integration.angles[NEW], work.angles)
    while True:
        if work.quality[0] != clock["quality"]:
            clock["fault"] = _renew(system, work, integration)
            if clock["fault"] != SOLVED:
                return STEP_VANISHED
        left = clock["stop"] - clock["t"]
        h = min(laid_out(clock, clock["step"], SHARE), left)
        if not h > SMALLEST_STEP * max(abs(clock["t"]), 1e-3):
            return STEP_VANISHED
        clock["length"] = h
        factor = _singular_step_or_try(system, work, integration, left)
        if factor > 0.0 and smallest_pivot(work.factors, work.rank[0]) < clock["branching"]:
            if _is_singular(work, clock):
                return STEP_VANISHED
            factor = -0.5
        if factor > 0.0:
            _accept(system, work, integration, clock["length"], clock["length"] >= left, factor)
            return READY if clock["gap"] <= REPEATED_GAP else CONTRADICTION
        clock["step"] = -h * factor
        clock["rejections"] += 1
        clock["rejected"] += 1
        clock["left"], clock["quality"] = 1.0, NONE


@kernel
def _singular_step_or_try(system, work, integration, left):
    """`_try_step` or, in front of a singular position, a step over it."""
    clock = integration.clock[0]
    way = clock["singular"] - clock["t"]
    over = min(2.0 * way, left) if 0.0 < way < clock["length"] and clock["step_length"] > 0.0 else 0.0
    if over > way:
        if singular_step(system, work, integration, over):
            clock["length"] = over
            return 1.0
        _copy(integration.angles[NEW], work.angles)
        if work.quality[0] != clock["quality"]:
            clock["fault"] = _renew(system, work, integration)
            if clock["fault"] != SOLVED:
                return -0.5
    return _try_step(system, work, integration, clock["length"])


@allocating
def _try_step(system, work, integration, h):
    """Bring `trial` to the end of a step: the factor for the next one, or, negative, for another try."""
    clock = integration.clock[0]
    if not solve_step(system, work, integration, h):
        return -0.5
    blurred = blur(work, clock["rtol"])
    clock["error"] = error = (
        max(step_error(system, work, integration, h), work_error(integration, h)) / blurred
    )
    angles = _turns_left(system, integration)
    factor = min(_factor(clock, h, error), SAFETY * angles)
    if not (error < 1.0 and angles > 1.0):
        return -max(SLOWEST, factor) if error < 1e10 else -SLOWEST
    place_trial(system, integration, STAGES - 1)
    if not expect_angles(system, work, integration, h) < MOST_TURNED:
        return -0.5
    found = integration.trial.copy()
    clock["fault"] = close_gaps(system, work, integration, clock["t"] + h)
    if clock["fault"] != SOLVED:
        return -0.25
    if not moved(integration, found) < MOST_MOVED * blurred:
        return -0.5
    return min(1.0 if clock["rejected"] else FASTEST, max(SLOWEST, factor))


@kernel
def _turns_left(system, integration):
    """Return how many steps like this one a body may turn in one, for rows between its ends.

    A turn θ leaves (θ/2)⁵ max |d/dx x³ (1 - x)³| / 720 of its rate in Hermite's quintic.
    """
    turn = largest_turn(system.masses.shape[0], integration.shifts[STAGES - 1])
    longest = min(LONGEST_TURN, 2.0 * (720.0 / STEEPEST * integration.clock[0]["rtol"]) ** 0.2)
    return longest / turn if turn > 0.0 else np.inf


@kernel
def _factor(clock, h, error):
    """Factor on the step length: by the error of this step, and by its growth since the last."""
    if not error > 0.0:
        return FASTEST
    factor = SAFETY * error**-0.25
    if clock["last_error"] > 0.0:
        growth = max(clock["last_error"], CALM) / error
        factor *= min(1.0, h / clock["step_length"] * growth**0.25)
    return factor


@kernel
def _accept(system, work, integration, h, last, factor):
    """Make the end of a step the state."""
    clock, rates, z, end = integration.clock[0], integration.rates, integration.z, integration.z.shape[0] - 1
    _copy(z, integration.old)
    _copy(integration.trial, z)
    z[end] = integration.old[end]
    for stage in range(STAGES):
        z[end] += h * WEIGHTS[STAGES - 1, stage] * integration.powers[stage]
    clock["old_power"], clock["power"] = clock["power"], integration.powers[STAGES - 1]
    for node in range(STAGES + 1):
        _copy(rates[START + node], rates[LAST + node])
    _copy(rates[LAST + STAGES], rates[START])
    clock["step_start"], clock["step_length"] = clock["t"], h
    clock["t"] = clock["stop"] if last else clock["t"] + h
    clock["step"] = h * factor
    clock["rejected"], clock["last_error"] = 0, clock["error"]
    clock["steps"] += 1
    clock["gap"], clock["worst"] = largest_gap(system, work)
    unwrap_angles(system, work, integration)
    if clock["left"] > SLOW or work.quality[0] != clock["quality"]:
        renew_matrices(system, work, integration.matrices)
        clock["quality"] = work.quality[0]
    look_ahead(system, work, integration, rates[START], clock["step"])


@kernel
def _is_singular(work, clock):
    """Return whether a pivot at the end of the last step was as good as zero."""
    for k in range(work.rank[0] if clock["steps"] > 0 else 0):
        if abs(work.pivots[k]) < 10.0 * clock["branching"]:
            return True
    return False


@kernel
def _fill_row(system, work, integration, t, report):
    """A report row at a time up to the present one; returns whether there is one."""
    clock, angles, row, x = integration.clock[0], integration.angles, integration.clock[0]["row"], 1.0
    _copy(integration.z, integration.trial)
    if t < clock["t"]:
        x = (t - clock["step_start"]) / clock["step_length"]
        between(system, integration, x, integration.trial)
    for s in range(angles.shape[1]):
        angles[EXPECTED, s] = (1.0 - x) * angles[OLD, s] + x * angles[NEW, s]
    clock["fault"], power = project_state(system, work, integration, t, report.rates[row])
    if clock["fault"] != SOLVED or smallest_pivot(work.factors, work.rank[0]) < BLIND * clock["branching"]:
        return False
    _copy(integration.trial, report.states[row])
    complete(system, work, integration.trial, t, angles[EXPECTED], power, report, row)
    clock["row"] += 1
    return True
