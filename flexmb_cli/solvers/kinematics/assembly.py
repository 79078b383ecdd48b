"""First position of a mechanism when Newton from the deck's estimates fails, and what to say then."""

from typing import TYPE_CHECKING

import numpy as np

from ...errors import AnalysisError, Fault, ModelError
from ..singular.mobility import (
    RESIDUAL_MET,
    Mobility,
    about,
    gap_norms,
    motion_text,
    nearest_position,
    worst_gaps,
)
from .position import Evaluator
from .settings import KinematicSettings

if TYPE_CHECKING:
    from ...model.equations import Equation


POLISHED = 1e-13
TRIALS = 4  # estimates that are tried: the deck's, and that one nudged
NUDGE = 0.05  # of the length scale, and of Euler parameters
ASSEMBLY_STEPS = 60  # of Newton's method by least squares
MET = 1e-14  # scaled gaps
ENOUGH = KinematicSettings.most_iterations
NEARLY_CLOSED = 1e-6  # a wider gap is real: shortest corrections would only spread it


def assemble_by_search(
    evaluator: Evaluator, q: np.ndarray, t: float, expected: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """A position that meets the equations as well as can be, and its scaled residual.

    Least squares from the estimates, then from estimates a little off: axes that are exactly
    perpendicular where they should be parallel give no direction to turn.
    """
    best = _search(evaluator, q, t, expected)
    for trial in range(1, 1 if evaluator.is_large else TRIALS):
        if np.max(np.abs(best[1])) <= RESIDUAL_MET:
            break
        shift = np.random.default_rng(trial).uniform(-NUDGE, NUDGE, q.size) * evaluator.arrays.column_scale
        other = _search(evaluator, q + shift, t, expected)
        if np.max(np.abs(other[1])) < 0.5 * np.max(np.abs(best[1])):
            best = other
    return best


def _search(
    evaluator: Evaluator, q: np.ndarray, t: float, expected: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """One search, polished by the shortest corrections, which also converge among redundant equations."""
    q, gap = nearest_position(evaluator, q, t, expected)
    scale = evaluator.arrays.column_scale
    for _ in range(20):
        if evaluator.is_large or not POLISHED < np.max(np.abs(gap)) < NEARLY_CLOSED:
            break
        better = q - scale * np.linalg.lstsq(evaluator.matrix(q), gap, rcond=1e-9)[0]
        better_gap = evaluator.residual(better, t, expected)
        if not np.max(np.abs(better_gap)) < np.max(np.abs(gap)):
            break
        q, gap = better, better_gap
    return q, evaluator.residual(q, t, expected)


def assembly_failure(
    evaluator: Evaluator, gap: np.ndarray, t: float, most_iterations: int = ENOUGH
) -> AnalysisError:
    """The mechanism of the deck cannot be put together at its first time, t.

    `most_iterations`: how many Newton was allowed; fewer than usual may be the reason.
    """
    worst = worst_gaps(evaluator, gap)
    left = "; ".join(one.text for one in worst) or "no gap is left, but the position is singular"
    message = (
        f"at t = {t:.6g} s the mechanism cannot be assembled from the estimates; what is left of the worst "
        f"constraints: {left}; {_few(most_iterations)}check these joints' points and the body estimates; "
        "estimates that are too far are found by changing lengths in small steps from a mechanism that closes"
    )
    return AnalysisError(about("error", message, *(one.equation for one in worst)), t, gap_norms(worst))


def too_large_to_rank(equations: int, most: int, t: float) -> AnalysisError:
    """The position closes, but Newton finds no way there, and singular values would take hours."""
    message = (
        f"at t = {t:.6g} s equations repeat others, or something moves that nothing determines; of "
        f"{equations} equations flexmb does not look for which (of {most} at most): leave bodies out until "
        "it does"
    )
    return AnalysisError(Fault("error", message, id="SOLVE-009"), t)


def _few(iterations: int) -> str:
    if iterations >= ENOUGH:
        return ""
    plural = "s" * (iterations != 1)
    return f"--nrmax lets Newton try {iterations} iteration{plural}: allow more ({ENOUGH} if not given), or "


def free_motion_error(
    evaluator: Evaluator, q: np.ndarray, found: Mobility, motion: np.ndarray, t: float
) -> ModelError:
    """Something can move along the null vector `motion` that neither joints nor drivers determine."""
    doubled = "; ".join(_group(group) for group in found.redundant)
    message = (
        f"at t = {t:.6g} s a motion is left that nothing determines: {motion_text(evaluator, q, motion)}; "
        "constrain it (a simplified constraint or a driver) in place of an equation that repeats others: "
        f"{doubled}"
    )
    return ModelError([about("error", message, *_placed(found))])


def redundancy_warning(found: Mobility) -> Fault:
    """Some equations repeat others, yet every motion is determined."""
    groups = "; ".join(_group(group) for group in found.redundant)
    message = f"redundant equations, consistent with the others: {groups}"
    return about("warning", message, *_placed(found))


def _placed(found: Mobility) -> "list[Equation]":
    return [e for group in found.redundant for e in group if e.place]


def _group(equations: "tuple[Equation, ...]", most: int = 6) -> str:
    names = [e.name for e in equations[:most]]
    more = f" and {len(equations) - most} more" if len(equations) > most else ""
    return "one of " + ", ".join(names) + more if len(equations) > 1 else names[0]
