"""A report row exactly at a bifurcation, where two motions of a mechanism cross (a parallelogram in line).

Φ_q is singular there, and its rates are 0/0.  Where the motion is smooth, the rates are the limits from both
sides: the row is that of the polynomial of fifth degree through positions, velocities and accelerations a
little before and a little after.
"""

from typing import TYPE_CHECKING

import numpy as np

from ...kernels.kinematics import constraints as equations
from ...kernels.kinematics.continuation_clock import NEXT_LENGTH, SIGN, SPENT, TIME
from ..kinematics.position import Evaluator
from ..kinematics.rows import Rows, rows_of
from ..projection import Corrections, Instant, project
from .passed import Passed

if TYPE_CHECKING:
    from ..kinematics.analysis import KinematicAnalysis


WAY = 4e-3  # scaled way to each side: the error is of its sixth power, round-off grows with its inverse
PART_AFTER = 0.83  # of the time before: halved steps must not hit the bifurcation itself
MOST_OF_STEP = 0.4  # of the time between rows
ON_CURVE = 1e-9  # scaled residual of the polynomial; where the motion has a corner it is far off
FIRM = Corrections(met=0.0, most=1, dependent=1e-6, hopeless=ON_CURVE)


def row_across(
    analysis: "KinematicAnalysis", t: float, memory: tuple[np.ndarray, np.ndarray, np.ndarray]
) -> Rows | None:
    """The row at t of a KinematicAnalysis that was barred there, None where no smooth motion goes through.

    `memory`: state, motion and clock at an earlier time.  The analysis then stands a little behind t.
    """
    before, after = _times(analysis, t, float(memory[2][TIME]))
    if not before < t < after:
        return None
    analysis.state, analysis.motion, analysis.clock = (part.copy() for part in memory)
    integration, ends, signs = analysis.follower(), [], []
    for time in (before, after):
        if not analysis.carry(integration, analysis.state, analysis.motion, analysis.clock, time):
            return None
        ends.append(analysis.state.copy())
        signs.append(analysis.clock[SIGN])
    if signs[0] * signs[1] >= 0.0:
        return None
    row = _between(ends[0], ends[1], after - before, (t - before) / (after - before))
    expected = analysis.motion[:, 0] - (after - t) * analysis.motion[:, 1]
    gap = _closed(analysis.evaluator, row, t, expected)
    if gap > ON_CURVE:
        return None
    analysis.singularities.report(Passed(row[0], t, expected, True))
    audit = np.array([[gap, _rate_gap(analysis, row, t), analysis.clock[SPENT]]])
    analysis.clock[SPENT], analysis.clock[NEXT_LENGTH] = 0.0, np.inf
    return rows_of(analysis.mechanism, np.array([t]), row[None], audit)


def _times(analysis: "KinematicAnalysis", t: float, earlier: float) -> tuple[float, float]:
    """Times at both sides of t, a short way off."""
    speed = np.max(np.abs(analysis.state[1]) / analysis.arrays.column_scale)
    step = analysis.mechanism.time.step
    span = min(WAY / speed if speed > 0.0 else np.inf, MOST_OF_STEP * step, 0.9 * (t - earlier))
    return t - span, t + PART_AFTER * span


def _between(first: np.ndarray, last: np.ndarray, h: float, x: float) -> np.ndarray:
    """State (3, n) at the part x of a step of length h between two states: quintic Hermite interpolation."""
    q0, v0, a0 = first[0], h * first[1], h * h * first[2]
    q1, v1, a1 = last[0], h * last[1], h * h * last[2]
    way, speed, bend = q1 - q0 - v0 - 0.5 * a0, v1 - v0 - a0, a1 - a0
    c3 = 10.0 * way - 4.0 * speed + 0.5 * bend
    c4 = -15.0 * way + 7.0 * speed - bend
    c5 = 6.0 * way - 3.0 * speed + 0.5 * bend
    return np.array(
        [
            q0 + x * (v0 + x * (0.5 * a0 + x * (c3 + x * (c4 + x * c5)))),
            (v0 + x * (a0 + x * (3.0 * c3 + x * (4.0 * c4 + x * 5.0 * c5)))) / h,
            (a0 + x * (6.0 * c3 + x * (12.0 * c4 + x * 20.0 * c5))) / h**2,
        ]
    )


def _closed(evaluator: Evaluator, row: np.ndarray, t: float, expected: np.ndarray) -> float:
    """Bring the position of `row` onto the equations where they are regular; return the largest residual."""
    instant = Instant(evaluator, t, expected)
    row[0], gap = instant.at(row[0]) if evaluator.is_large else project(instant, row[0], FIRM)
    return float(np.max(np.abs(gap)))


def _rate_gap(analysis: "KinematicAnalysis", row: np.ndarray, t: float) -> float:
    """Largest rate of the constraints in the row, scaled."""
    evaluator, scale = analysis.evaluator, analysis.arrays
    evaluator.residual(row[0], t, analysis.motion[:, 0])
    moved = evaluator.sparse_matrix(row[0]) @ (row[1] / scale.column_scale)
    prescribed = np.zeros(len(moved))
    equations.velocity(analysis.system.constraints, t, prescribed)
    return float(np.max(np.abs(moved - prescribed / scale.row_scale)))
