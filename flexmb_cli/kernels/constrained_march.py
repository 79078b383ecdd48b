"""Stepping of a constrained mechanism through time in compiled code: DOP853 on accelerations.

The accelerations are those of the index-1 equations; every accepted step is projected onto positions
and speeds to round-off, so that nothing drifts, and judged anew if the projection moves it by more
than the tolerance allows.  Report rows come from the dense output and are projected as well.

Hairer, Nørsett and Wanner, Solving Ordinary Differential Equations I (second edition), sections
II.4-II.6; projection: Hairer and Wanner, volume II, section VII.2.

The state z (13 b + 1,) holds coordinates, speeds and the work of drivers and loads since the start.
The steps do not depend on how the report rows are cut into calls.
"""

from collections import namedtuple

import numpy as np

from ._jit import kernel
from .constrained_report import observe
from .constrained_solve import accelerations
from .constrained_system import SOLVED, A
from .constraint_projection import largest_gap, project_position, project_speeds
from .constraints import SCREW
from .dop853_table import ALL_STAGES, DENSE_TERMS, ERROR_3, ERROR_5, STAGE_TIMES, STAGES
from .joints import screw
from .rotation import rotate, rotation_matrices
from .runge_kutta import interpolate, next_factor, set_dense, set_stage
from .speeds import coordinate_rates, normalise

# What a call answers.
ROWS_FULL, PAUSED, STEP_VANISHED, CONTRADICTION = 0, 1, 2, 3
MOST_MOVED = 10.0  # tolerances by which a projection may move an accepted step
REPEATED_GAP = 1e-7  # what equations that repeat others may be off, scaled
SMALLEST_STEP = 1e-14
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
        ("worst", np.int64),  # equation with the largest gap
        ("rtol", np.float64),
        ("atol", np.float64),
    ]
)

March = namedtuple("March", "clock z old trial slopes dense units turns")
March.__doc__ = """What a march keeps from call to call, for states of N numbers.

clock (1,) CLOCK.  z, old, trial (N,).  slopes (16, N).  dense (7, N).  units (N,): a state's unit.
turns (3, screws): angles at the end of the last step, at its start, and those expected, rad.
"""
NEW, OLD, NEAR = 0, 1, 2


def new_march(bodies, screws):
    """A march at time 0 with an empty state."""
    n = 13 * bodies + 1
    return March(
        np.zeros(1, CLOCK),
        np.zeros(n),
        np.zeros(n),
        np.zeros(n),
        np.zeros((ALL_STAGES, n)),
        np.zeros((DENSE_TERMS, n)),
        np.ones(n),
        np.zeros((3, screws)),
    )


@kernel
def slope(system, work, z, t, out):
    """Fill out (N,) with dz/dt; a code."""
    bodies = z.shape[0] // 13
    q, u = z[: 7 * bodies], z[7 * bodies : 13 * bodies]
    coordinate_rates(q, u, out[: 7 * bodies])
    code, power = accelerations(system, work, q, u, t, out[7 * bodies : 13 * bodies])
    out[13 * bodies] = power
    return code


@kernel
def begin(system, work, march):
    """Slope at the state and length of the first step; a code.  Order of elimination must be chosen."""
    clock, z = march.clock[0], march.z
    code = slope(system, work, z, clock["t"], march.slopes[0])
    if code != SOLVED:
        clock["fault"] = code
        return code
    for i in range(z.shape[0]):
        march.old[i] = z[i]
        march.slopes[STAGES, i] = march.slopes[0, i]
    clock["step_start"], clock["dense"] = clock["t"], 0
    size, speed = _scaled_norm(march, z), _scaled_norm(march, march.slopes[0])
    clock["step"] = 0.01 * size / speed if size > 1e-5 and speed > 1e-5 else 1e-6
    return code


@kernel
def _scaled_norm(march, a):
    clock, total, counted = march.clock[0], 0.0, a.shape[0] - 1
    for i in range(counted):
        scale = clock["atol"] * march.units[i] + clock["rtol"] * abs(march.z[i])
        total += (a[i] / scale) ** 2
    return (total / counted) ** 0.5


@kernel
def march_rows(system, work, march, report, budget):
    """Fill the rows of `report`, at most `budget` evaluations; returns an answer.

    clock["row"] counts the rows filled.
    """
    clock = march.clock[0]
    clock["row"] = 0
    spent = clock["evaluations"] + budget
    answer = ROWS_FULL
    while answer == ROWS_FULL and clock["row"] < report.times.shape[0]:
        if report.times[clock["row"]] <= clock["t"]:
            answer = report_row(system, work, march, report)
        elif clock["evaluations"] >= spent:
            answer = PAUSED
        else:
            answer = step(system, work, march)
    return answer


@kernel
def step(system, work, march):
    """One accepted step, after as many attempts as it takes."""
    clock = march.clock[0]
    for i in range(march.z.shape[0]):
        march.slopes[0, i] = march.slopes[STAGES, i]
    while True:
        h = min(clock["step"], clock["stop"] - clock["t"])
        if not h > SMALLEST_STEP * max(abs(clock["t"]), 1e-3):
            return STEP_VANISHED
        error = _attempt(system, work, march, h)
        factor = next_factor(error, clock["rejected"]) if error < HOPELESS else 0.2
        # `not <` rejects a nan as well.
        clock["step"] = h * factor
        if not error < 1.0:
            clock["rejections"] += 1
            clock["rejected"] = 1
            continue
        return _accept(system, work, march, h)


@kernel
def _attempt(system, work, march, h):
    """Try a step: trial becomes the projected state at its end; returns its error."""
    clock, z, trial, slopes = march.clock[0], march.z, march.trial, march.slopes
    t = clock["t"]
    clock["fault"] = SOLVED
    error = 0.0
    for stage in range(1, STAGES + 1):
        set_stage(z, slopes, stage, h, trial)
        if stage == STAGES:
            error = _step_error(march, h)
            if not error < 1.0:
                return error
            _expect_turns(system, work, march, h)
            if not _project(system, work, march, trial, t + h) < MOST_MOVED:
                return HOPELESS if clock["fault"] != SOLVED else 2.0
        clock["evaluations"] += 1
        clock["fault"] = slope(system, work, trial, t + h * STAGE_TIMES[stage], slopes[stage])
        if clock["fault"] != SOLVED:
            return HOPELESS
    return error


@kernel
def _step_error(march, h):
    """Error of the step from z to trial against the tolerance."""
    clock, z, new, slopes = march.clock[0], march.z, march.trial, march.slopes
    counted = z.shape[0] - 1
    square_5 = square_3 = 0.0
    for i in range(counted):
        scale = clock["atol"] * march.units[i] + clock["rtol"] * max(abs(z[i]), abs(new[i]))
        e5 = e3 = 0.0
        for j in range(STAGES):
            e5 += ERROR_5[j] * slopes[j, i]
            e3 += ERROR_3[j] * slopes[j, i]
        square_5 += (e5 / scale) ** 2
        square_3 += (e3 / scale) ** 2
    if square_5 == 0.0:
        return 0.0
    return abs(h) * square_5 / ((square_5 + 0.01 * square_3) * counted) ** 0.5


@kernel
def _project(system, work, march, z, t):
    """Bring a state onto the constraints at t; returns by how many tolerances it moved, or infinity."""
    clock, bodies = march.clock[0], z.shape[0] // 13
    q, u = z[: 7 * bodies], z[7 * bodies : 13 * bodies]
    before = z.copy()
    normalise(q)
    code = project_position(system, work, q, t, march.turns[NEAR])
    if code == SOLVED:
        code = project_speeds(system, work, q, u, t)[0]
    if code != SOLVED:
        clock["fault"] = code
        return np.inf
    for i in range(z.shape[0]):
        before[i] -= z[i]
    return _scaled_norm(march, before)


@kernel
def _accept(system, work, march, h):
    clock, z = march.clock[0], march.z
    for i in range(z.shape[0]):
        march.old[i] = z[i]
        z[i] = march.trial[i]
    clock["step_start"], clock["step_length"] = clock["t"], h
    last = h >= clock["stop"] - clock["t"]
    clock["t"] = clock["stop"] if last else clock["t"] + h
    clock["rejected"], clock["dense"] = 0, 0
    clock["steps"] += 1
    _note_turns(system, work, march)
    gap, clock["worst"] = largest_gap(system, work)
    return ROWS_FULL if gap <= REPEATED_GAP else CONTRADICTION


@kernel
def _turn_rate(system, work, c, u):
    """Rate of a screw's angle: the relative turning along its axis, rad/s."""
    i, j = 6 * c["body_i"] + 3, 6 * c["body_j"] + 3
    axis = rotate(work.rotations[A], c["body_i"], c["s_i"])
    w_i = rotate(work.rotations[A], c["body_i"], (u[i], u[i + 1], u[i + 2]))
    w_j = rotate(work.rotations[A], c["body_j"], (u[j], u[j + 1], u[j + 2]))
    return axis[0] * (w_j[0] - w_i[0]) + axis[1] * (w_j[1] - w_i[1]) + axis[2] * (w_j[2] - w_i[2])


@kernel
def _expect_turns(system, work, march, h):
    """Angles of the screws at the end of a step, by the mean of their rates: they settle whole turns."""
    bodies = march.z.shape[0] // 13
    for s in range(march.turns.shape[1]):
        march.turns[NEAR, s] = march.turns[NEW, s]
    for end in range(2 if march.turns.shape[1] else 0):
        z = march.z if end == 0 else march.trial
        rotation_matrices(z[: 7 * bodies], work.rotations[A])
        for k in range(system.constraints.shape[0]):
            c = system.constraints[k]
            if c["kind"] == SCREW:
                rate = _turn_rate(system, work, c, z[7 * bodies : 13 * bodies])
                march.turns[NEAR, c["screw"]] += 0.5 * h * rate


@kernel
def _note_turns(system, work, march):
    for k in range(system.constraints.shape[0]):
        c = system.constraints[k]
        if c["kind"] == SCREW:
            s = c["screw"]
            march.turns[OLD, s] = march.turns[NEW, s]
            march.turns[NEW, s] = screw.angle(c, work.rotations[A], march.turns[NEAR, s])


@kernel
def _finish_dense(system, work, march):
    """The slope at the end of the step, the further stages, and the interpolating polynomial."""
    clock, slopes, trial = march.clock[0], march.slopes, march.trial
    h = clock["step_length"]
    for stage in range(STAGES + 1, ALL_STAGES):
        set_stage(march.old, slopes, stage, h, trial)
        clock["evaluations"] += 1
        slope(system, work, trial, clock["step_start"] + h * STAGE_TIMES[stage], slopes[stage])
    set_dense(march.old, march.z, slopes, h, march.dense)
    clock["dense"] = 1


@kernel
def report_row(system, work, march, report):
    """Fill the next report row, at a time up to the present one."""
    clock = march.clock[0]
    t, z = report.times[clock["row"]], report.states[clock["row"]]
    x = 1.0
    if t < clock["t"]:
        if clock["dense"] == 0:
            _finish_dense(system, work, march)
        x = (t - clock["step_start"]) / clock["step_length"]
        interpolate(march.old, march.dense, x, z)
    else:
        for i in range(z.shape[0]):
            z[i] = march.z[i]
    for s in range(march.turns.shape[1]):
        march.turns[NEAR, s] = (1.0 - x) * march.turns[OLD, s] + x * march.turns[NEW, s]
    if x < 1.0 and not _project(system, work, march, z, t) < np.inf:
        return STEP_VANISHED
    clock["fault"] = observe(system, work, z, t, march.turns[NEAR], report, clock["row"])
    if clock["fault"] != SOLVED:
        return STEP_VANISHED
    clock["row"] += 1
    return ROWS_FULL


@kernel
def screw_angles(system, work, q, near):
    """Angles (screws,) of the screws at q, those nearest to `near`, rad."""
    angles = near.copy()
    rotation_matrices(q, work.rotations[A])
    for k in range(system.constraints.shape[0]):
        c = system.constraints[k]
        if c["kind"] == SCREW:
            angles[c["screw"]] = screw.angle(c, work.rotations[A], near[c["screw"]])
    return angles
