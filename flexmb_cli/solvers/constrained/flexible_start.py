"""The first position of a mechanism of flexible bodies: found by rigid motion, by deformation if it must."""

from typing import TYPE_CHECKING

import numpy as np

from ...model.equations import DEPENDENT
from ..assembly import TRIALS, assemble, is_closed, nudged
from ..kinematics.assembly import assembly_failure
from ..projection import Corrections, Instant, Position, project, shortened
from ..start_attitudes import refuse_half_turns, turned_right

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from ..start_attitudes import StartAttitude
    from .position import PositionGaps


SHORTEST = Corrections(met=1e-14, most=60, dependent=DEPENDENT)


def assemble_flexible(
    gaps: "PositionGaps", t: float, attitudes: "Sequence[StartAttitude]" = ()
) -> np.ndarray:
    """Coordinates (n + b,) near those of the deck that meet all equations; raises AnalysisError.

    Bodies stay undeformed where their joints allow it.  `attitudes`: triads that must agree.
    """
    arrays = gaps.arrays
    rigid = np.arange(arrays.speeds) < 6 * arrays.bodies
    instant = Instant(gaps, t, arrays.angles)

    def search(q: np.ndarray) -> "Iterator[Position]":
        for columns in (rigid, np.ones_like(rigid)):
            q, gap = project(instant, q, SHORTEST, shortened, columns)
            yield q, gap

    start = turned_right(gaps, attitudes, t, rigid)
    q, gap = assemble(nudged(gaps, start, rigid, TRIALS), search)
    if is_closed(gap):
        refuse_half_turns(q, attitudes, t)
        return q
    raise assembly_failure(gaps, gap, t)
