"""Singular positions that a kinematic continuation passes: found after it.

The continuation goes through a position where two motions cross when the motion is smooth, and through the
narrow place beside one.  Both cost many short steps: rows that took many iterations, or at which the
sign of det Φ_q has changed, are walked again step by step.
"""

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from ...kernels.kinematics.continuation_clock import BUDGET, SIGN, TIME
from ...model.equations import Equation
from ..kinematics.rows import Rows
from .conditioning import conditioning, conditioning_text
from .passed import Passed, PassedSingularities
from .weakest import NEARLY_SINGULAR, Conditioning

if TYPE_CHECKING:
    from ..kinematics.analysis import KinematicAnalysis


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
    """Watches the blocks of a KinematicAnalysis; notes go to its warnings.

    To be active only where no equations repeat others: there every position looks singular.
    """

    def __init__(self, analysis: "KinematicAnalysis", active: bool = True):
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
