"""The first position of a model: searches from several starts, until one closes all gaps.

Every formulation hands in where to start and how to search from there:

- kinematics (`kinematics.assembly`): from the estimates, then a little off; least squares, then shortest
  corrections;
- rigid dynamics (`constrained.start`): from what kinematics finds, then the estimates; whole corrections;
- flexible bodies (`constrained.flexible_start`): from the estimates, then a little off; by rigid motion, then
  by deformation too;
- trees (`tree.assembly`): with most coordinates kept, then all free; the projection of the kernels.

In kinematics Newton's method of the continuation comes first, as its step of length 0.  A tree in absolute
coordinates takes the position of the tree it was made from (`model.tree_as_mechanism.loop_assembly`): that
`verify` compares the two is why they share no search.
"""

from typing import TYPE_CHECKING, TypeVar

import numpy as np

from .projection import RESIDUAL_MET, Equations, Position, largest

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator


TRIALS = 4  # starts: the deck's estimates, and those nudged
NUDGE = 0.05  # of the length scale, and of Euler parameters or rad

Start = TypeVar("Start")


def assemble(
    starts: "Iterable[Start]",
    search: "Callable[[Start], Iterable[Position]]",
    better: float = 1.0,
    closed: float = RESIDUAL_MET,
) -> Position:
    """Return the first position with all gaps closed that `search` finds from the starts, else the best.

    `search` yields positions with their residuals; of two that stay open a later one is taken if its
    largest gap is below `better` times that of the other.  The residual returned shows whether it is closed.
    """
    best: Position | None = None
    for start in starts:
        for found in search(start):
            if is_closed(found[1], closed):
                return found
            if best is None or largest(found[1]) < better * largest(best[1]):
                best = found
    assert best is not None, "a search yields a position at least"
    return best


def is_closed(gap: np.ndarray, closed: float = RESIDUAL_MET) -> bool:
    """Return whether a residual (m,) is nowhere more than counts as met; one that is no number is."""
    return largest(gap) <= closed


def nudged(equations: Equations, q: np.ndarray, free: np.ndarray, trials: int) -> "Iterator[np.ndarray]":
    """Yield q, then positions a little off it in what `free` (n,) marks, `trials` in all.

    Axes that are exactly perpendicular where they should be parallel give no direction to turn.
    """
    for trial in range(trials):
        if not trial:
            yield q
        else:
            yield equations.moved(q, np.random.default_rng(trial).uniform(-NUDGE, NUDGE, free.size) * free)
