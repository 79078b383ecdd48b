"""First position of a mechanism when Newton from the deck's estimates fails, and what to say then."""

from typing import TYPE_CHECKING

import numpy as np

from ...errors import AnalysisError, Fault, ModelError
from ...model.equations import DEPENDENT
from ..assembly import is_closed, nearest_of
from ..projection import Corrections, Instant, Position, improving, project
from ..singular.mobility import Mobility, about, gap_norms, motion_text, worst_gaps
from .estimate_gaps import slip_sentence, wide_estimates
from .nearest_position import nearest_position, sized_equations
from .position import Evaluator

if TYPE_CHECKING:
    from ...model.equations import Equation
    from ..constrained.position import PositionGaps


ADVICE = (
    "check these joints' points and the body estimates; estimates that are too far are found by changing "
    "lengths in small steps from a mechanism that closes"
)
# Shortest corrections also converge among redundant equations.  A wider gap than the last number is real:
# they would only spread it.
POLISH = Corrections(met=1e-13, most=20, dependent=DEPENDENT, hopeless=1e-6)


def assemble_by_search(
    evaluator: Evaluator, q: np.ndarray, t: float, expected: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """The position (7 n,) nearest to the estimates q (7 n,) that meets the equations, and its residual (m,).

    Where none does, that which meets them best.  `expected`: angles of screws, rad.
    """
    instant = Instant(evaluator, t, expected)

    def finish(found: np.ndarray) -> Position:
        return instant.at(found) if evaluator.is_large else project(instant, found, POLISH, improving)

    sized = sized_equations(evaluator, q, t, expected)
    found, gap = nearest_of(sized, q, finish)
    return (found, gap) if is_closed(gap) else nearest_position(evaluator, found, t, expected)


def assembly_failure(
    evaluator: "Evaluator | PositionGaps",
    gap: np.ndarray,
    t: float,
    estimates: "tuple[np.ndarray, np.ndarray] | None" = None,
) -> AnalysisError:
    """The mechanism of the deck cannot be put together at its first time, t.

    `gap` (m,): scaled residual.  `estimates`: coordinates of the deck and the angles of screws there, where a
    slip may show.
    """
    worst = worst_gaps(evaluator, gap)
    wide, rest = wide_estimates(evaluator, estimates[0], t, estimates[1]) if estimates else ([], 0.0)
    left = "; ".join(one.text for one in worst) or "no gap is left, but the position is singular"
    message = (
        f"at t = {t:.6g} s the mechanism cannot be assembled from the estimates; what is left of the worst "
        f"constraints: {left}; {slip_sentence(wide, rest) if wide else ADVICE}"
    )
    owners = (one.equation for one in (*wide, *worst))
    return AnalysisError(about("error", message, *owners, id="SOLVE-052"), t, gap_norms(worst))


def too_large_to_rank(equations: int, most: int, t: float) -> AnalysisError:
    """The position closes, but Newton finds no way there, and singular values would take hours."""
    message = (
        f"at t = {t:.6g} s equations repeat others, or something moves that nothing determines; of "
        f"{equations} equations flexmb does not look for which (of {most} at most): leave bodies out until "
        "it does"
    )
    return AnalysisError(Fault("error", message, id="SOLVE-009"), t)


def free_motion_error(
    evaluator: Evaluator, q: np.ndarray, found: Mobility, motion: np.ndarray, t: float
) -> ModelError:
    """Something can move along the null vector `motion` (7 n,) that neither joints nor drivers determine."""
    doubled = "; ".join(_group(group) for group in found.redundant)
    message = (
        f"at t = {t:.6g} s a motion is left that nothing determines: {motion_text(evaluator, q, motion)}; "
        "constrain it (a simplified constraint or a driver) in place of an equation that repeats others: "
        f"{doubled}"
    )
    return ModelError([about("error", message, *_placed(found), id="SOLVE-053")])


def redundancy_warning(found: Mobility) -> Fault:
    """Some equations repeat others, yet every motion is determined."""
    groups = "; ".join(_group(group) for group in found.redundant)
    message = f"redundant equations, consistent with the others: {groups}"
    return about("warning", message, *_placed(found), id="SOLVE-054")


def _placed(found: Mobility) -> "list[Equation]":
    return [e for group in found.redundant for e in group if e.place]


def _group(equations: "tuple[Equation, ...]", most: int = 6) -> str:
    names = [e.name for e in equations[:most]]
    more = f" and {len(equations) - most} more" if len(equations) > most else ""
    return "one of " + ", ".join(names) + more if len(equations) > 1 else names[0]
