"""Why a mechanism could not be carried to the next report time."""

import numpy as np

from ..errors import AnalysisError, Fault
from .diagnosis import CLOSED, mobility, nearest_position, worst_gaps

ASIDE = 0.05  # of the length scale, and of Euler parameters


def step_failure(analysis, t: float) -> AnalysisError:
    """The failure of `analysis` (a KinematicAnalysis) on its way to the report time t.

    A gap that stays open at t is a lock; without a gap the mechanism passes a position at which its
    motion is not determined.
    """
    evaluator, reached = analysis.evaluator, analysis.clock[0]
    near = analysis.motion[:, 0]
    gap = _least_gap(evaluator, analysis.state[0], t, near)
    worst = worst_gaps(evaluator, gap)
    norms = {
        "gap": float(np.max(np.abs(gap))),
        "worst": [one.equation.name for one in worst],
        "reached": reached,
    }
    if norms["gap"] > CLOSED:
        left = "; ".join(one.text for one in worst)
        message = (
            f"at t = {t:.6g} s the constraints cannot be met (motion reached t = {reached:.6g} s); what is "
            f"left of the worst ones: {left}; the mechanism locks, or a driver asks for more than it can do"
        )
        return AnalysisError(Fault("error", message, worst[0].equation.place), t, norms)
    return AnalysisError(_singular(analysis, evaluator, reached, t), t, norms)


def _least_gap(evaluator, q, t, near):
    """Residual of the position nearest to meeting the equations at t, from q and from both sides of it.

    From a dead centre the search does not leave the line of symmetry by itself.
    """
    gap = nearest_position(evaluator, q, t, near)[1]
    if np.max(np.abs(gap)) <= CLOSED or evaluator.is_large:
        return gap
    evaluator.residual(q, t, near)
    aside = ASIDE * np.linalg.svd(evaluator.matrix(q))[2][-1] * evaluator.arrays.column_scale
    others = [nearest_position(evaluator, q + side * aside, t, near)[1] for side in (1.0, -1.0)]
    return min([gap, *others], key=lambda found: np.max(np.abs(found)))


def _singular(analysis, evaluator, reached, t):
    message = (
        f"at t = {t:.6g} s there is no smooth continuation (motion reached t = {reached:.6g} s): the "
        "mechanism can be put together there, but is at or next to a singular position"
    )
    if evaluator.is_large:
        return Fault("error", message)
    found = mobility(evaluator, analysis.state[0], reached, analysis.motion[:, 0])
    weakest = found.free[0] if found.free else _weakest(evaluator, analysis.state[0])
    message += f", where {', '.join(weakest[:4])} are not determined"
    return Fault("error", message)


def _weakest(evaluator, q):
    """Names of the coordinates that the equations determine least."""
    vector = np.abs(np.linalg.svd(evaluator.matrix(q))[2][-1])
    return [evaluator.arrays.coordinate_name(int(k)) for k in np.argsort(-vector)[:4]]
