"""Overconstrained loops that close only nearly: their data are rounded, or an axis is off.

Equations that repeat others where the loop is exact contradict them by a little.  The others determine the
position and the motion; along what the small singular values stand for nothing is corrected.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ...errors import AnalysisError, Fault
from ...kernels.constrained.accelerations import choose_order
from ...kernels.constrained.system import Work
from ...model.by_size import first_of_largest
from ...model.joints import DEPENDENT
from ..assembly import LOOSEST, TO_GAP, Sized, nearest_of
from ..constrained.system import PositionGaps, dense_jacobian, is_large
from ..projection import RESIDUAL_MET, Corrections, Instant, Position, largest, project, shortened
from .mobility import PROBE, Gap, about, gap_norms, worst_gaps

SETTLING = 4  # corrections of that limit by the gap that it leaves
MOVES = 0.3  # part of a trial motion that remains where the mechanism is free to move


@dataclass(frozen=True)
class NearlyClosed:
    """A position with the gaps that are left (m,), and the singular value from which equations count."""

    q: np.ndarray
    gap: np.ndarray
    dependent: float

    @property
    def size(self) -> float:
        """The largest scaled gap."""
        return largest(self.gap)


def nearly_closed(
    gaps: PositionGaps, instant: Instant, sized: Sized, q: np.ndarray, columns: np.ndarray, *, near: bool
) -> NearlyClosed | None:
    """Return the position nearest to q at which overconstrained loops nearly close, None where none does.

    `near`: only one that shortest corrections find near q.
    """
    if is_large(gaps.arrays):
        return None
    sparse, gaps.sparse, sized.met = gaps.sparse, False, LOOSEST / 3.0

    def finish(start: np.ndarray, dependent: float = LOOSEST) -> Position:
        return project(instant, start, Corrections(1e-14, 60, dependent), shortened, columns)

    try:
        found = finish(q) if near else nearest_of(sized, q, finish, columns, LOOSEST)
        if near and not sized.is_near(q, found[0]):
            return None
        dependent = LOOSEST
        for _ in range(SETTLING):
            dependent = float(np.clip(TO_GAP * largest(found[1]), DEPENDENT, LOOSEST))
            found = finish(found[0], dependent)
        if RESIDUAL_MET < largest(found[1]) <= LOOSEST and _is_overconstrained(
            gaps, finish, found, dependent
        ):
            return NearlyClosed(*found, dependent)
        return None
    finally:
        gaps.sparse, sized.met = sparse, 0.0


def _is_overconstrained(
    gaps: PositionGaps, finish: Callable[..., Position], position: Position, dependent: float
) -> bool:
    """Return whether equations repeat others, and the mechanism moves along all that the others leave free.

    At a dead centre equations repeat others, too, but what they seem to leave free leads back.
    """
    q = position[0]
    finish(q, dependent)
    J = gaps.jacobian(q)
    assert isinstance(J, np.ndarray), "small"
    _, values, right = np.linalg.svd(J)
    rank = int(np.sum(values > dependent * values[0]))
    if rank == len(J):
        return False
    for motion in right[rank:]:
        there = finish(gaps.moved(q, PROBE * motion), dependent)
        back = finish(gaps.moved(q, -PROBE * motion), dependent)
        way = np.linalg.norm((there[0] - back[0]) / gaps.arrays.coordinate_scale)
        if largest(there[1]) > LOOSEST or way < MOVES * PROBE:
            return False
    return True


def choose_far_apart(work: Work, rank: int) -> int:
    """Choose `rank` equations that are far from dependent, and their order; return the rank found.

    What is left of the gap in the others grows as those chosen come to depend.  Overwrites the Jacobian.
    """
    left, chosen = dense_jacobian(work), []
    for _ in range(rank):
        chosen.append(first_of_largest(np.linalg.norm(left, axis=1)))
        direction = left[chosen[-1]] / np.linalg.norm(left[chosen[-1]])
        left -= np.outer(left @ direction, direction)
    work.jacobian[np.setdiff1d(np.arange(len(left)), chosen)] = 0.0
    return int(choose_order(work, rank))


def independence(work: Work) -> float:
    """Return the least singular value of the equations chosen; its inverse amplifies the gap left."""
    rows = dense_jacobian(work)[work.order[: work.rank[0]]]
    return float(np.linalg.svd(rows, compute_uv=False)[-1])


def gap_note(gaps: PositionGaps, loop: NearlyClosed, tolerance: float) -> Fault:
    """Return the note on a loop that closes within the tolerance only."""
    worst = worst_gaps(gaps.arrays, loop.gap)
    message = (
        f"a loop is overconstrained and closes only to {_size(worst)}, within {tolerance:.1e} (by the digits "
        "typed, or --loop-tolerance); equations that repeat others are left out, and the gap remains"
    )
    return about("note", message, worst[0].equation, id="SOLVE-080")


def gap_error(gaps: PositionGaps, loop: NearlyClosed, t: float, tolerance: float) -> AnalysisError:
    """Return the refusal of a loop that closes less well than the tolerance."""
    worst = worst_gaps(gaps.arrays, loop.gap)
    message = (
        f"at t = {t:.6g} s the mechanism cannot be assembled: a loop is overconstrained and closes only to "
        f"{_size(worst)}; the digits typed, or --loop-tolerance, allow {tolerance:.1e}: align its axes, "
        f"replace a joint by one with more freedom, or allow more (--loop-tolerance {2 * loop.size:.0e})"
    )
    return AnalysisError(about("error", message, worst[0].equation, id="SOLVE-081"), t, gap_norms(worst))


def _size(worst: list[Gap]) -> str:
    """The largest angle and the largest length of gaps, with their owners."""
    kinds = [[gap for gap in worst if gap.equation.is_length == is_length] for is_length in (False, True)]
    units = zip(kinds, ("rad", "m"), strict=True)
    return " and ".join(f"{abs(k[0].value):.1e} {unit} at {k[0].equation.owner}" for k, unit in units if k)
