"""Singular positions of a kinematic continuation: passed, at a report row, or where it ends.

The continuation goes through a position where two motions cross when the motion is smooth, and through the
narrow place beside one.  Both cost many short steps: rows that took many iterations, or at which the
sign of det Φ_q has changed, are walked again step by step.

Exactly at a bifurcation (a parallelogram in line) Φ_q is singular, and its rates are 0/0.  Where the motion
is smooth, the rates are the limits from both sides: the row is that of the polynomial of fifth degree through
positions, velocities and accelerations a little before and a little after.
"""

from collections.abc import Iterator
from typing import Any

import numpy as np

from ...errors import AnalysisError
from ...kernels.kinematics import constraints as equations
from ...kernels.kinematics.continuation import BUDGET, NEXT_LENGTH, SIGN, SPENT, TIME
from ...model.joints import Equation
from ..kinematics.assembly import nearest_position
from ..kinematics.position import Evaluator
from ..kinematics.rows import Rows, rows_of
from ..kinematics.state import KinematicState
from ..projection import RESIDUAL_MET, Corrections, Instant, project
from .conditioning import (
    NEARLY_SINGULAR,
    Conditioning,
    Passed,
    PassedSingularities,
    conditioning,
    conditioning_text,
    weakest_joints,
)
from .mobility import about, gap_norms, worst_gaps

# Iterations of a row that are many where others take few, and many anywhere.  A bifurcation takes ten or
# more.
FEW, MANY = 8, 20
# Condition, as a multiple of that where the block began: what is reported, and what leaves accelerations
# without most of their digits.  Badly scaled mechanisms have a large one everywhere.
BLIND_CONDITION = 1e5
MOST_TRIED = 16  # of the shortest steps, among which the worst place is


# State, motion and clock of the continuation, to be walked again from.
Memory = tuple[np.ndarray, np.ndarray, np.ndarray]


class PassedKinematicSingularities(PassedSingularities):
    """Watches the blocks of a KinematicState; notes go to its warnings.

    To be active only where no equations repeat others: there every position looks singular.
    """

    def __init__(self, analysis: KinematicState, active: bool = True):
        super().__init__(analysis.warnings, analysis.arrays.equations, active)
        self.analysis = analysis

    def memory(self) -> Memory:
        """Return where the continuation stands, to be walked again from."""
        analysis = self.analysis
        return analysis.state.copy(), analysis.motion.copy(), analysis.clock.copy()

    def suspected(self, memory: Memory, rows: Rows) -> Iterator[tuple[Memory, float, float]]:
        """Yield `memory` and the times of ways through the report `rows` that took many iterations."""
        if self.notes.full or not self.active:
            return
        changed = memory[2][SIGN] != self.analysis.clock[SIGN]
        for first, last in _busy_runs(rows.newton_iterations, changed):
            begin = memory[2][TIME] if first == 0 else rows.time[first - 1]
            yield memory, float(begin), float(rows.time[last])

    def first_without_rates(self, memory: Memory, rows: Rows) -> int:
        """The first row so near to a singular position that its rates are round-off; their number if none."""
        busy = np.flatnonzero(rows.newton_iterations > FEW) if self.active else ()
        limit = BLIND_CONDITION * self._condition_of(memory) if len(busy) else np.inf
        for k in busy:
            q = np.concatenate([rows.position[k], rows.euler_parameters[k]], axis=1).ravel()
            expected = self.analysis.motion[:, 0]
            if conditioning(self.analysis.evaluator, q, float(rows.time[k]), expected).condition > limit:
                return int(k)
        return rows.time.size

    def _condition_of(self, memory: Memory) -> float:
        state, motion, clock = memory
        return conditioning(self.analysis.evaluator, state[0], float(clock[TIME]), motion[:, 0]).condition

    def located(self, interval: tuple[Memory, float, float]) -> Iterator[Passed]:
        """Go from `memory` to the begin, then step by step to the end.

        Yield bifurcations, else the worst place.
        """
        analysis, integration = self.analysis, self.analysis.follower()
        memory, begin, end = interval
        state, motion, clock = (part.copy() for part in memory)
        analysis.carry(integration, state, motion, clock, begin)
        steps, crossed = [], False
        while clock[TIME] < end and not self.notes.full:
            t, sign = clock[TIME], clock[SIGN]
            analysis.carry(integration, state, motion, clock, end, 1)
            if clock[TIME] > t:
                crosses = bool(sign * clock[SIGN] < 0.0)
                here = Passed(state[0].copy(), float(clock[TIME]), motion[:, 0].copy(), crosses)
                steps.append((clock[TIME] - t, here))
                if crosses:
                    crossed = True
                    yield here
            elif clock[BUDGET] > 0.0:
                break
        if not crossed:
            shortest = [here for _, here in sorted(steps, key=lambda step: step[0])[:MOST_TRIED]]
            yield from self._narrowest(memory, shortest)

    def _narrowest(self, memory: Memory, places: list[Passed]) -> Iterator[Passed]:
        conditions = [self.conditioning(place).condition for place in places]
        if conditions and max(conditions) >= NEARLY_SINGULAR * self._condition_of(memory):
            yield places[int(np.argmax(conditions))]

    def conditioning(self, passed: Passed) -> Conditioning:
        """Return the conditioning of Φ_q there."""
        return conditioning(self.analysis.evaluator, passed.q, passed.t, passed.expected)

    def sentence(self, passed: Passed, weak: Conditioning, owners: list[Equation]) -> str:
        """Say that the continuation passes a bifurcation of two motions, or a narrow place."""
        what = "a singular position" if passed.crosses else "close to a singular position"
        more = "; two motions cross there, and the smooth one is followed" if passed.crosses else ""
        weakest = conditioning_text(self.analysis.evaluator, passed.q, weak)
        return f"at t = {passed.t:.6g} s the motion passes {what}{weakest}{more}"


def _busy_runs(iterations: np.ndarray, changed: bool) -> list[tuple[int, int]]:
    """First and last of consecutive rows whose way took many iterations; all rows, where none did and yet
    the sign changed."""
    many = FEW if iterations.max() <= FEW else min(MANY, max(FEW, 3.0 * float(np.median(iterations))))
    busy = np.flatnonzero(iterations > many)
    if not busy.size:
        return [(0, len(iterations) - 1)] if changed else []
    return [(run[0], run[-1]) for run in np.split(busy, np.flatnonzero(np.diff(busy) > 1) + 1)]


WAY = 4e-3  # scaled way to each side: the error is of its sixth power, round-off grows with its inverse
PART_AFTER = 0.83  # of the time before: halved steps must not hit the bifurcation itself
MOST_OF_STEP = 0.4  # of the time between rows
ON_CURVE = 1e-9  # scaled residual of the polynomial; where the motion has a corner it is far off
FIRM = Corrections(met=0.0, most=1, dependent=1e-6, hopeless=ON_CURVE)


def row_across(
    watch: PassedKinematicSingularities, t: float, memory: tuple[np.ndarray, np.ndarray, np.ndarray]
) -> Rows | None:
    """The row at t where the analysis was barred, which `watch` notes; None if no smooth motion crosses.

    `memory`: state, motion and clock at an earlier time.  The analysis then stands a little after t.
    """
    analysis = watch.analysis
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
    watch.report(Passed(row[0], t, expected, True))
    audit = np.array([[gap, _rate_gap(analysis, row, t), analysis.clock[SPENT]]])
    analysis.clock[SPENT], analysis.clock[NEXT_LENGTH] = 0.0, np.inf
    return rows_of(analysis.mechanism, np.array([t]), row[None], audit, analysis.joints.of)


def _times(analysis: KinematicState, t: float, earlier: float) -> tuple[float, float]:
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


def _rate_gap(analysis: KinematicState, row: np.ndarray, t: float) -> float:
    """Largest rate of the constraints in the row, scaled."""
    evaluator, scale = analysis.evaluator, analysis.arrays
    evaluator.residual(row[0], t, analysis.motion[:, 0])
    moved = evaluator.sparse_matrix(row[0]) @ (row[1] / scale.column_scale)
    prescribed = np.zeros(len(moved))
    equations.velocity(analysis.system.constraints, t, prescribed)
    return float(np.max(np.abs(moved - prescribed / scale.row_scale)))


NUDGE = 0.05  # of the length scale, and of Euler parameters
LATER = 1e-3  # of the time between rows: after a dead centre


def step_failure(analysis: KinematicState, t: float) -> AnalysisError:
    """The failure of `analysis` (a KinematicState) on its way to the report time t.

    A gap that stays open at t is a lock; without a gap the mechanism passes a position at which its
    motion is not determined.
    """
    evaluator, reached = analysis.evaluator, float(analysis.clock[0])
    expected = analysis.motion[:, 0]
    gap = _least_gap(evaluator, analysis.state[0], t, expected)
    worst = worst_gaps(evaluator.arrays, gap)
    if worst:
        left = "; ".join(one.text for one in worst)
        message = (
            f"at t = {t:.6g} s the constraints cannot be met (motion reached t = {reached:.6g} s); what is "
            f"left of the worst ones: {left}; the mechanism locks, or a driver asks for more than it can do"
        )
        return AnalysisError(
            about("error", message, worst[0].equation, id="SOLVE-056"),
            t,
            gap_norms(worst) | {"reached": reached},
        )
    return _singular(analysis, reached, t)


def _least_gap(evaluator: Evaluator, q: np.ndarray, t: float, expected: np.ndarray) -> Any:
    """Residual of the position nearest to meeting the equations at t, from q and from both sides of it.

    From a dead centre the search does not leave the line of symmetry by itself.
    """
    gap = nearest_position(evaluator, q, t, expected)[1]
    if np.max(np.abs(gap)) <= RESIDUAL_MET:
        return gap
    aside = NUDGE * conditioning(evaluator, q, t, expected).motion * evaluator.arrays.column_scale
    others = [nearest_position(evaluator, q + side * aside, t, expected)[1] for side in (1.0, -1.0)]
    return min([gap, *others], key=lambda found: np.max(np.abs(found)))


def _singular(analysis: KinematicState, reached: Any, t: float) -> AnalysisError:
    """The failure at a singular position: a dead centre, after which a gap remains, or a branching."""
    evaluator, q, expected = analysis.evaluator, analysis.state[0], analysis.motion[:, 0]
    weak = conditioning(evaluator, q, reached, expected)
    later = t + LATER * analysis.mechanism.time.step
    worst = worst_gaps(evaluator.arrays, _least_gap(evaluator, q, later, expected), 1)
    if worst:
        end = f"a dead centre: at t = {later:.6g} s a gap remains, {worst[0].text}"
    else:
        end = "the motion can branch there, and no way of going on is smooth"
    message = (
        f"at t = {t:.6g} s the mechanism is at or next to a singular position"
        f"{conditioning_text(evaluator, q, weak)}; motion reached t = {reached:.6g} s; {end}"
    )
    norms = gap_norms(worst) | {"reached": reached, "condition": weak.condition}
    return AnalysisError(about("error", message, *weakest_joints(evaluator, weak), id="SOLVE-057"), t, norms)


def singular_start(analysis: KinematicState, q: np.ndarray, t: float) -> AnalysisError:
    """The failure of an analysis whose first position q (7 n,) is a dead centre or a branching."""
    evaluator = analysis.evaluator
    weak = conditioning(evaluator, q, t, analysis.arrays.screw_angles)
    message = (
        f"at t = {t:.6g} s the mechanism starts at a singular position"
        f"{conditioning_text(evaluator, q, weak)}: a "
        "dead centre, or a place where motions branch; begin a little earlier or later"
    )
    fault = about("error", message, *weakest_joints(evaluator, weak), id="SOLVE-058")
    return AnalysisError(fault, t, {"condition": weak.condition})
