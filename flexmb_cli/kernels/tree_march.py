"""Stepping of a tree through time in compiled code, DOP853 with dense output at the report times.

The steps do not depend on how the report rows are cut into calls: a call ends between two steps and
the next goes on from there, so that a resumed run walks the same steps as an uninterrupted one.
"""

import numpy as np

from ._jit import kernel
from .dop853_table import ALL_STAGES, STAGE_TIMES, STAGES
from .kane_tree import SOLVED
from .runge_kutta import interpolate, next_factor, set_dense, set_stage, step_error
from .tree_energy import energies
from .tree_motion import derivative, normalise_attitudes, parts
from .tree_projection import largest_gap, largest_rate, project

ROWS_FULL, AT_STOP, PAUSED, STEP_VANISHED = 0, 1, 2, 3

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
        ("rejections", np.int64),
        ("fault", np.int64),  # coordinate without inertia at the last failed attempt, or SOLVED
        ("worst", np.int64),  # place in z of the largest error of the last attempt
        ("rtol", np.float64),
        ("atol", np.float64),
    ]
)


@kernel
def first_slope(tree, work, coordinates, clock, z, slopes):
    """Evaluate the slope at clock["t"] to go on from a checkpoint; returns as `start`."""
    return derivative(tree, work, coordinates, clock["t"], z, slopes[0])


@kernel
def start(tree, work, coordinates, clock, z, slopes, trial):
    """Evaluate the first slope and choose a first step (Hairer et al., section II.4).

    slopes (16, n), trial (n,).  Returns SOLVED or the coordinate without inertia.
    """
    t = clock["t"]
    fault = derivative(tree, work, coordinates, t, z, slopes[0])
    if fault != SOLVED:
        return fault
    counted = z.shape[0] - 1
    size, slope = _scaled_norms(z, slopes[0], slopes[0], clock, counted)
    first = 0.01 * size / slope if size > 1e-5 and slope > 1e-5 else 1e-6
    for i in range(z.shape[0]):
        trial[i] = z[i] + first * slopes[0, i]
    fault = derivative(tree, work, coordinates, t + first, trial, slopes[1])
    if fault != SOLVED:
        return fault
    for i in range(z.shape[0]):
        slopes[2, i] = slopes[1, i] - slopes[0, i]
    _size, bend = _scaled_norms(z, slopes[2], slopes[2], clock, counted)
    steepest = max(slope, bend / first)
    second = (0.01 / steepest) ** 0.125 if steepest > 1e-15 else max(1e-6, 1e-3 * first)
    clock["step"] = min(100.0 * first, second)
    clock["evaluations"] += 2
    clock["step_start"] = t
    clock["step_length"] = clock["step"]
    clock["rejected"] = clock["step_rejected"] = 0
    return SOLVED


@kernel
def _scaled_norms(z, a, b, clock, counted):
    """Root mean squares of z and of a, place by place against the tolerance at z."""
    size = slope = 0.0
    for i in range(counted):
        scale = clock["atol"] + clock["rtol"] * abs(z[i])
        size += (z[i] / scale) ** 2
        slope += (a[i] / scale) ** 2
    return (size / counted) ** 0.5, (slope / counted) ** 0.5


@kernel
def march(tree, work, coordinates, clock, z, old, slopes, dense, trial, stop, times, rows, budget):
    """Go on until all `times` have their row, `stop` is reached, or `budget` evaluations are spent.

    z (n,) is the state at clock["t"], old (n,) that at the start of the last step; slopes (16, n),
    dense (7, n) and trial (n,) keep their contents between calls; rows (T, n).
    """
    spent = clock["evaluations"] + budget
    clock["row"] = 0
    while True:
        _fill_rows(tree, clock, z, old, dense, times, rows)
        if clock["row"] == times.shape[0]:
            return ROWS_FULL
        if clock["t"] >= stop:
            return AT_STOP
        if clock["evaluations"] >= spent:
            return PAUSED
        if not _step(tree, work, coordinates, clock, z, old, slopes, trial, stop):
            return STEP_VANISHED
        if times[clock["row"]] < clock["t"]:
            _prepare_dense(tree, work, coordinates, clock, z, old, slopes, dense, trial)
        slopes[0] = slopes[STAGES]
        if tree.closures.shape[0] > 0:
            _close_loops(tree, work, coordinates, clock["t"], z, slopes[0])


@kernel
def _fill_rows(tree, clock, z, old, dense, times, rows):
    """Write the report rows up to the present time."""
    while clock["row"] < times.shape[0] and times[clock["row"]] <= clock["t"]:
        row = rows[clock["row"]]
        t = times[clock["row"]]
        if t == clock["t"]:
            row[:] = z
        else:
            interpolate(old, dense, (t - clock["step_start"]) / clock["step_length"], row)
            normalise_attitudes(tree, row)
        clock["row"] += 1


@kernel
def _step(tree, work, coordinates, clock, z, old, slopes, trial, stop):
    """One accepted step; False when the step length falls to round-off."""
    while True:
        t = clock["t"]
        last = clock["step"] >= stop - t
        h = stop - t if last else clock["step"]
        if not h > 1e-15 * max(abs(t), 1e-3):
            return False
        clock["fault"] = _stages(tree, work, coordinates, clock, h, z, slopes, trial)
        error = 1e10
        if clock["fault"] == SOLVED:
            counted = z.shape[0] - 1
            error, clock["worst"] = step_error(z, trial, slopes, h, clock["rtol"], clock["atol"], counted)
        rejected = clock["rejected"]
        # `not <` rejects a nan as well.
        clock["rejected"] = 0 if error < 1.0 else 1
        clock["step"] = h * (next_factor(error, rejected) if error < 1e10 else 0.2)
        if error < 1.0:
            break
        clock["rejections"] += 1
    clock["step_start"], clock["step_length"], clock["step_rejected"] = t, h, rejected
    clock["t"] = stop if last else t + h
    old[:] = z
    z[:] = trial
    return True


@kernel
def _stages(tree, work, coordinates, clock, h, z, slopes, trial):
    """All stages of a step and the slope at its end, the new state in `trial`."""
    for stage in range(1, STAGES + 1):
        set_stage(z, slopes, stage, h, trial)
        if stage == STAGES:
            normalise_attitudes(tree, trial)
        t = clock["t"] + h * STAGE_TIMES[stage]
        fault = derivative(tree, work, coordinates, t, trial, slopes[stage])
        clock["evaluations"] += 1
        if fault != SOLVED:
            return fault
    return SOLVED


@kernel
def _close_loops(tree, work, coordinates, t, z, slope):
    """Project a state onto the closures, and evaluate its slope anew."""
    derivative(tree, work, coordinates, t, z, slope)
    project(tree, work, coordinates, z)
    derivative(tree, work, coordinates, t, z, slope)


@kernel
def _prepare_dense(tree, work, coordinates, clock, z, old, slopes, dense, trial):
    """Evaluate the stages of the dense output, and its polynomial."""
    h = clock["step_length"]
    for stage in range(STAGES + 1, ALL_STAGES):
        set_stage(old, slopes, stage, h, trial)
        t = clock["step_start"] + h * STAGE_TIMES[stage]
        # The end points of the step had inertia; a point between them that has none is not worth
        # a failure, the polynomial then takes the slope as it stands.
        derivative(tree, work, coordinates, t, trial, slopes[stage])
        clock["evaluations"] += 1
    set_dense(old, z, slopes, h, dense)


@kernel
def observe(tree, work, coordinates, times, rows, frames, rates, audit, closures):
    """Accelerations, energies and closure forces of report rows, whose loops are closed first.

    frames (T, F) of FRAME_WORK, rates (T, NS) y', closures (T, R) of CLOSURE_ROW; audit (T, 5)
    kinetic, potential, strain energy, J, largest gap, m, and largest rate of a gap, m/s.
    """
    slope = np.zeros(rows.shape[1])
    for i in range(times.shape[0]):
        y, q, _attitudes = parts(tree, rows[i])
        derivative(tree, work, coordinates, times[i], rows[i], slope)
        if tree.closures.shape[0] > 0:
            _close_loops(tree, work, coordinates, times[i], rows[i], slope)
        for k in range(work.shape[0]):
            frames[i, k] = work[k]
        for m in range(y.shape[0]):
            rates[i, m] = coordinates[m]["rate"]
        for j in range(tree.closures.shape[0]):
            closures[i, j] = tree.closures[j]
        audit[i, 0], audit[i, 1], audit[i, 2] = energies(tree, work, q, y)
        audit[i, 3] = largest_gap(tree.closures)
        audit[i, 4] = largest_rate(tree.closures)
