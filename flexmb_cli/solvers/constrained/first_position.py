"""The first position of a mechanism: found by rigid motion, by deformation of flexible bodies if it must."""

from typing import TYPE_CHECKING

import numpy as np

from ...kernels.constrained.speeds import normalise
from ...model.equations import DEPENDENT
from ..assembly import Sized, is_closed, nearest_of
from ..kinematics.assembly import assembly_failure
from ..projection import Corrections, Instant, Position, project, shortened

if TYPE_CHECKING:
    from .position import PositionGaps


SHORTEST = Corrections(met=1e-14, most=60, dependent=DEPENDENT)


def assemble(gaps: "PositionGaps", t: float, *, estimates: bool = False) -> np.ndarray:
    """Coordinates (n + b,) near those of the deck that meet all equations; raises AnalysisError.

    Bodies stay undeformed where their joints allow it.  `estimates`: the deck's positions are estimates.
    """
    arrays, q = gaps.arrays, gaps.arrays.q.copy()
    normalise(arrays.bodies, q)
    if not len(arrays.equations):
        return q
    instant, sized = Instant(gaps, t, arrays.angles), None
    rigid = np.arange(arrays.speeds) < 6 * arrays.bodies
    best: Position | None = None
    for columns in (rigid, np.ones_like(rigid)) if not rigid.all() else (rigid,):

        def finish(found: np.ndarray, columns: np.ndarray = columns) -> Position:
            return project(instant, found, SHORTEST, shortened, None if columns.all() else columns)

        found = finish(q)
        sized = sized or Sized(instant, gaps, q, arrays.bodies)
        if not (is_closed(found[1]) and sized.is_near(q, found[0])):
            found = nearest_of(sized, q, finish, columns)
        if is_closed(found[1]):
            return found[0]
        best = best or found
    assert best is not None, "one search at least"
    raise assembly_failure(gaps, best[1], t, estimates=(arrays.q, arrays.angles) if estimates else None)
