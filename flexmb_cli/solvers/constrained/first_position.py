"""The first position of a mechanism: found by rigid motion, by deformation of flexible bodies if it must."""

from typing import TYPE_CHECKING

import numpy as np

from ...kernels.constrained.speeds import normalise
from ...model.equations import DEPENDENT
from ..assembly import Sized, is_closed, nearest_of
from ..kinematics.assembly import assembly_failure
from ..projection import Corrections, Instant, Position, largest, project, shortened
from ..singular.overconstrained_loops import NearlyClosed, gap_error, nearly_closed

if TYPE_CHECKING:
    from .position import PositionGaps


OTHER_ASSEMBLY = 0.5  # of the size, or rad: a body moved more is in another one
SHORTEST = Corrections(met=1e-14, most=60, dependent=DEPENDENT)


def assemble(
    gaps: "PositionGaps", t: float, tolerance: float, start: np.ndarray, *, estimates: bool = False
) -> tuple[np.ndarray, NearlyClosed | None]:
    """Return coordinates (n + b,) near those of `start` that meet the equations; raises AnalysisError.

    And what overconstrained loops leave, at most `tolerance`, where they close only nearly.  Bodies stay
    undeformed where their joints allow it.  `estimates`: the deck's positions are estimates.
    """
    arrays, q = gaps.arrays, start.copy()
    normalise(arrays.bodies, q)
    if not len(arrays.equations):
        return q, None
    instant, rigid = Instant(gaps, t, arrays.angles), np.arange(arrays.speeds) < 6 * arrays.bodies
    sized = Sized(instant, gaps, q, arrays.bodies)
    found = project(instant, q, SHORTEST, shortened, rigid)
    if is_closed(found[1]) and sized.is_near(q, found[0]):
        return found[0], None
    loose = nearly_closed(gaps, instant, sized, q, rigid, near=True)
    is_loose = loose is not None and loose.size <= tolerance
    for columns in (rigid, np.ones_like(rigid))[: 0 if is_loose else 1 + (not rigid.all())]:
        tried = _closest(sized, instant, q, columns)
        # Far away there may be positions where loops that nearly close here close, but cannot move.
        if is_closed(tried[1]) and (loose is None or sized.is_near(q, tried[0], OTHER_ASSEMBLY)):
            return tried[0], None
        found = min(found, tried, key=lambda one: largest(one[1]))
    loose = loose or nearly_closed(gaps, instant, sized, q, rigid, near=False)
    if loose and loose.size <= tolerance:
        return loose.q, loose
    if loose:
        raise gap_error(gaps, loose, t, tolerance)
    raise assembly_failure(gaps, found[1], t, estimates=(arrays.q, arrays.angles) if estimates else None)


def _closest(sized: Sized, instant: Instant, q: np.ndarray, columns: np.ndarray) -> Position:
    """Return the position near q (n + b,) that meets the equations best by changes of `columns` (n,)."""

    def finish(found: np.ndarray) -> Position:
        return project(instant, found, SHORTEST, shortened, None if columns.all() else columns)

    found = finish(q)
    if is_closed(found[1]) and sized.is_near(q, found[0]):
        return found
    return nearest_of(sized, q, finish, columns)
