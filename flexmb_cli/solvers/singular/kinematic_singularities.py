"""Singular positions that a kinematic continuation passes: found after it, and reported as notes.

The continuation goes through a position where two motions cross when the motion is smooth, and through the
narrow place beside one.  Both cost many short steps: rows that took many iterations, or at which the
sign of det Φ_q has changed, are walked again step by step.
"""

from typing import TYPE_CHECKING, Any

import numpy as np

from ...kernels.kinematics.continuation import BUDGET, SIGN, TIME
from .conditioning import conditioning, conditioning_text, weakest_joints
from .weakest import NEARLY_SINGULAR, SingularityNotes

if TYPE_CHECKING:
    from ..kinematics.analysis import KinematicAnalysis
    from ..kinematics.rows import Rows


# Iterations of a row that are many where others take few, and many anywhere.  A bifurcation takes ten or
# more.
FEW, MANY = 8, 20
# Condition, as a multiple of that where the block began: what is reported, and what leaves accelerations
# without most of their digits.  Badly scaled mechanisms have a large one everywhere.
BLIND_CONDITION = 1e5
MOST_TRIED = 16  # of the shortest steps, among which the worst place is


class PassedKinematicSingularities:
    """Watches the blocks of a KinematicAnalysis; notes go to its warnings, `MOST_NOTES` at most.

    Not active, it looks for nothing: where equations repeat others, every position looks singular.
    """

    def __init__(self, analysis: "KinematicAnalysis", active: bool = True):
        self.analysis = analysis
        self.active = active
        self.notes = SingularityNotes(analysis.warnings)

    def memory(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return where the continuation stands, to be walked again from."""
        analysis = self.analysis
        return analysis.state.copy(), analysis.motion.copy(), analysis.clock.copy()

    def look(self, memory: tuple[np.ndarray, np.ndarray, np.ndarray], rows: "Rows") -> None:
        """Look for singular positions on the way from `memory` through the report `rows`."""
        if self.notes.full or not self.active:
            return
        changed = memory[2][SIGN] != self.analysis.clock[SIGN]
        for first, last in _busy_runs(rows.newton_iterations, changed):
            begin = memory[2][TIME] if first == 0 else rows.time[first - 1]
            self._walk(memory, float(begin), float(rows.time[last]))

    def first_without_rates(self, memory: tuple[np.ndarray, np.ndarray, np.ndarray], rows: Any) -> int:
        """The first row so near to a singular position that its rates are round-off; their number if none."""
        busy = np.flatnonzero(rows.newton_iterations > FEW) if self.active else ()
        limit = BLIND_CONDITION * self._condition_of(memory) if len(busy) else np.inf
        for k in busy:
            q = np.concatenate([rows.position[k], rows.euler_parameters[k]], axis=1).ravel()
            expected = self.analysis.motion[:, 0]
            if conditioning(self.analysis.evaluator, q, float(rows.time[k]), expected).condition > limit:
                return int(k)
        return rows.time.size

    def _condition_of(self, memory: tuple[np.ndarray, np.ndarray, np.ndarray]) -> float:
        state, motion, clock = memory
        return conditioning(self.analysis.evaluator, state[0], float(clock[TIME]), motion[:, 0]).condition

    def _walk(self, memory: tuple[np.ndarray, np.ndarray, np.ndarray], begin: float, end: float) -> None:
        """Go from `memory` to `begin`, then step by step to `end`; report bifurcations, else the worst
        place.
        """
        analysis, integration = self.analysis, self.analysis.marcher()
        state, motion, clock = (part.copy() for part in memory)
        analysis.carry(integration, state, motion, clock, begin)
        steps, crossed = [], False
        while clock[TIME] < end and not self.notes.full:
            t, sign = clock[TIME], clock[SIGN]
            analysis.carry(integration, state, motion, clock, end, 1)
            if clock[TIME] > t:
                here = state[0].copy(), float(clock[TIME]), motion[:, 0].copy()
                steps.append((clock[TIME] - t, here))
                if sign * clock[SIGN] < 0.0:
                    crossed = True
                    self.tell(*here, True)
            elif clock[BUDGET] > 0.0:
                break
        if not crossed:
            self._tell_narrowest(
                memory, [here for _, here in sorted(steps, key=lambda step: step[0])[:MOST_TRIED]]
            )

    def _tell_narrowest(
        self,
        memory: tuple[np.ndarray, np.ndarray, np.ndarray],
        places: list[tuple[np.ndarray, float, np.ndarray]],
    ) -> None:
        conditions = [conditioning(self.analysis.evaluator, *place).condition for place in places]
        if conditions and max(conditions) >= NEARLY_SINGULAR * self._condition_of(memory):
            self.tell(*places[int(np.argmax(conditions))], False)

    def tell(self, q: np.ndarray, t: float, expected: np.ndarray, bifurcation: bool) -> None:
        """Note that the continuation passes q at the time t: a bifurcation of two motions, or a narrow
        place.
        """
        if self.notes.full:
            return
        evaluator = self.analysis.evaluator
        weak = conditioning(evaluator, q, t, expected)
        what = "a singular position" if bifurcation else "close to a singular position"
        more = "; two motions cross there, and the smooth one is followed" if bifurcation else ""
        sentence = f"at t = {t:.6g} s the motion passes {what}{conditioning_text(evaluator, q, weak)}{more}"
        self.notes.add(sentence, weakest_joints(evaluator, weak))


def _busy_runs(iterations: np.ndarray, changed: bool) -> list[tuple[int, int]]:
    """First and last of consecutive rows whose way took many iterations; all rows, where none did and yet
    the sign changed."""
    usual = float(np.median(iterations))
    busy = np.flatnonzero(iterations > min(MANY, max(FEW, 3.0 * usual)))
    if not busy.size:
        return [(0, len(iterations) - 1)] if changed else []
    return [(run[0], run[-1]) for run in np.split(busy, np.flatnonzero(np.diff(busy) > 1) + 1)]
