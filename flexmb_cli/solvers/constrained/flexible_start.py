"""The first position of a mechanism of flexible bodies: found by rigid motion, by deformation if it must."""

from typing import TYPE_CHECKING, Any

import numpy as np

from ...kernels.constrained.accelerations import evaluate_jacobian
from ...kernels.constrained.projection import evaluate_residual
from ...kernels.constrained.speeds import move
from ...kernels.constrained.system import PHI, System, Work
from ...model.equations import DEPENDENT
from ..kinematics.assembly import ASSEMBLY_STEPS, MET, NUDGE, TRIALS, assembly_failure
from ..singular.mobility import RESIDUAL_MET

if TYPE_CHECKING:
    from ...model.arrays.system import SystemArrays


LARGEST_STEP = 0.3  # scaled: of the length scale, rad


class PositionGaps:
    """Scaled residuals of the equations, for messages and searches."""

    def __init__(self, arrays: "SystemArrays", system: System, work: Work):
        self.arrays, self.system, self.work = arrays, system, work

    def residual(self, q: np.ndarray, t: float, expected: np.ndarray) -> np.ndarray:
        """Scaled residual (m,) at q; expected: the angles expected."""
        evaluate_residual(self.system, self.work, q, t, expected)
        return self.work.rows[PHI] / self.arrays.row_scale

    def jacobian(self, q: np.ndarray) -> np.ndarray:
        """Scaled Jacobian (m, n) on speeds."""
        evaluate_jacobian(self.system, self.work, q)
        return self.work.jacobian.copy()


def assemble(gaps: PositionGaps, t: float) -> np.ndarray:
    """Coordinates near those of the deck that meet all equations; raises AnalysisError.

    Bodies stay undeformed where their joints allow it.
    """
    arrays = gaps.arrays
    rigid = np.arange(arrays.speeds) < 6 * arrays.bodies
    best, least = arrays.q.copy(), np.inf
    for trial in range(TRIALS):
        start = arrays.q.copy()
        if trial:
            # Axes exactly across where they should be along give no direction to turn.
            shift = np.random.default_rng(trial).uniform(-NUDGE, NUDGE, arrays.speeds)
            move(arrays.bodies, start, shift * arrays.speed_scale * rigid)
        for columns in (rigid, np.ones_like(rigid)):
            start, left = _search(gaps, start, t, columns)
            if left <= RESIDUAL_MET:
                return start
            if left < least:
                best, least = start, left
    raise assembly_failure(gaps, gaps.residual(best, t, arrays.angles), t)  # type: ignore[arg-type]


def _search(gaps: PositionGaps, q: np.ndarray, t: float, columns: np.ndarray) -> tuple[np.ndarray, float]:
    """Gauss-Newton with the shortest corrections in some of the columns; the position and its largest gap."""
    arrays = gaps.arrays
    gap = gaps.residual(q, t, arrays.angles)
    for _ in range(ASSEMBLY_STEPS):
        if not gap.size or np.max(np.abs(gap)) <= MET:
            break
        step = np.zeros(arrays.speeds)
        step[columns] = -np.linalg.lstsq(gaps.jacobian(q)[:, columns], gap, rcond=DEPENDENT)[0]
        better, new_gap = _shortened(gaps, q, t, step, np.linalg.norm(gap))
        if better is None:
            break
        q, gap = better, new_gap
    return q, np.max(np.abs(gap), initial=0.0)


def _shortened(gaps: PositionGaps, q: np.ndarray, t: float, step: np.ndarray, size: Any) -> Any:
    """The position after so much of the step that the gaps get smaller, or None."""
    arrays = gaps.arrays
    factor = min(1.0, LARGEST_STEP / max(np.max(np.abs(step), initial=0.0), 1e-300))
    for _ in range(10):
        trial = q.copy()
        move(arrays.bodies, trial, factor * step * arrays.speed_scale)
        gap = gaps.residual(trial, t, arrays.angles)
        if np.linalg.norm(gap) < size:
            return trial, gap
        factor *= 0.5
    return None, None
