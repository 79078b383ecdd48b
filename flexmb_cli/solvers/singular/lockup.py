"""Reasons that a mechanism cannot be carried to the next report time."""

from typing import TYPE_CHECKING, Any

import numpy as np

from ...errors import AnalysisError
from ..kinematics.assembly import nearest_position
from ..kinematics.position import Evaluator
from ..projection import RESIDUAL_MET
from .conditioning import conditioning, conditioning_text, weakest_joints
from .mobility import about, gap_norms, worst_gaps

if TYPE_CHECKING:
    from ..kinematics.analysis import KinematicAnalysis


NUDGE = 0.05  # of the length scale, and of Euler parameters
LATER = 1e-3  # of the time between rows: behind a dead centre


def step_failure(analysis: "KinematicAnalysis", t: float) -> AnalysisError:
    """The failure of `analysis` (a KinematicAnalysis) on its way to the report time t.

    A gap that stays open at t is a lock; without a gap the mechanism passes a position at which its
    motion is not determined.
    """
    evaluator, reached = analysis.evaluator, float(analysis.clock[0])
    expected = analysis.motion[:, 0]
    gap = _least_gap(evaluator, analysis.state[0], t, expected)
    worst = worst_gaps(evaluator, gap)
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
    found: AnalysisError = _singular(analysis, reached, t)
    return found


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


def _singular(analysis: "KinematicAnalysis", reached: Any, t: float) -> AnalysisError:
    """The failure at a singular position: a dead centre, behind which a gap remains, or a branching."""
    evaluator, q, expected = analysis.evaluator, analysis.state[0], analysis.motion[:, 0]
    weak = conditioning(evaluator, q, reached, expected)
    later = t + LATER * analysis.mechanism.time.step
    worst = worst_gaps(evaluator, _least_gap(evaluator, q, later, expected), 1)
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


def singular_start(analysis: "KinematicAnalysis", q: np.ndarray, t: float) -> AnalysisError:
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
