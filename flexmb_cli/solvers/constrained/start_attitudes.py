"""Bodies turned the right way round before a mechanism is assembled: half turns meet its equations, too.

The rotation from one triad to the other replaces the equations of their directions here: it is 0 in one
attitude only.
"""

import math
from typing import TYPE_CHECKING

import numpy as np

from ...errors import AnalysisError, Fault
from ...model.equations import DEPENDENT
from ...model.vectors import euler_parameters, rotation_matrix
from ..projection import Corrections, Instant, project, shortened
from .large_start import is_large

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from ...model.arrays.start_attitudes import StartAttitude
    from .position import PositionGaps

TURNED = math.pi / 4  # an attitude that starts closer is found by the equations themselves
WRONG = math.pi / 2  # half-way to the other solution
ROUGHLY = Corrections(met=1e-3, most=100, dependent=DEPENDENT)


class AttitudeGaps:
    """The `Equations` of `projection`, with angles in place of the equations of directions."""

    def __init__(self, gaps: "PositionGaps", attitudes: "Sequence[StartAttitude]"):
        self.gaps, self.attitudes = gaps, attitudes
        equations, groups = gaps.arrays.equations, gaps.arrays.groups
        owned = [
            row
            for item in attitudes
            for k in item.groups
            for row in range(groups[k]["first_row"], groups[k]["end_row"])
            if not equations[row].is_length
        ]
        self.replaced = np.array(owned, int)

    def residual(self, q: np.ndarray, t: float, expected: np.ndarray) -> np.ndarray:
        """Return the scaled residual (m,) at q, then rotation vectors, rad, global axes."""
        found = self.gaps.residual(q, t, expected)
        found[self.replaced] = 0.0
        return np.concatenate([found, *(rotation_between(q, item) for item in self.attitudes)])

    def jacobian(self, q: np.ndarray) -> np.ndarray:
        """Return the scaled Jacobian (m, n) on speeds; of large rotation vectors it is an estimate."""
        J = np.array(self.gaps.jacobian(q))
        J[self.replaced] = 0.0
        added = [J]
        for item in self.attitudes:
            rows = np.zeros((3, J.shape[1]))
            for body, sign in ((item.i, -1.0), (item.j, 1.0)):
                if body >= 0:
                    rows[:, 6 * body + 3 : 6 * body + 6] = sign * _turned(q, body)
            added.append(rows)
        return np.vstack(added)

    def moved(self, q: np.ndarray, step: np.ndarray) -> np.ndarray:
        """Return the coordinates after a scaled step (n,)."""
        return self.gaps.moved(q, step)


def _turned(q: np.ndarray, body: int) -> np.ndarray:
    return np.eye(3) if body < 0 else rotation_matrix(q[7 * body + 3 : 7 * body + 7])


def rotation_between(q: np.ndarray, item: "StartAttitude") -> np.ndarray:
    """Return the rotation vector (3,), rad, global axes, that takes the triad of i to that of j."""
    of_i, of_j = _turned(q, item.i) @ item.of_i, _turned(q, item.j) @ item.of_j
    p = euler_parameters(of_j @ of_i.T)
    size = float(np.linalg.norm(p[1:]))
    found: np.ndarray = 2.0 * math.atan2(size, p[0]) / max(size, 1e-300) * p[1:]
    return found


def angle_between(q: np.ndarray, item: "StartAttitude") -> float:
    """Return the angle, rad, by which the triads of an attitude differ."""
    return float(np.linalg.norm(rotation_between(q, item)))


def turned_right(
    gaps: "PositionGaps", attitudes: "Sequence[StartAttitude]", t: float, rigid: np.ndarray
) -> np.ndarray:
    """Return the deck's coordinates with bodies turned so that the triads of `attitudes` roughly agree."""
    arrays = gaps.arrays
    q: np.ndarray = arrays.q
    if is_large(arrays) or all(angle_between(q, item) < TURNED for item in attitudes):
        return q
    return project(Instant(AttitudeGaps(gaps, attitudes), t, arrays.angles), q, ROUGHLY, shortened, rigid)[0]


def refuse_half_turns(q: np.ndarray, attitudes: "Sequence[StartAttitude]", t: float) -> None:
    """Raise AnalysisError where an attitude is met after a half turn."""
    for item in attitudes:
        angle = angle_between(q, item)
        if angle > WRONG:
            message = (
                f"it is met only after a turn by {math.degrees(angle):.4g} degrees; turn the bodies closer by "
                "EULP, and check the order of the nodes"
            )
            raise AnalysisError(Fault("error", message, item.place, item.owner), t)


def turn_warnings(q: np.ndarray, attitudes: "Sequence[StartAttitude]") -> "Iterator[Fault]":
    """Yield a warning for each attitude that the deck's coordinates q are far from: gaps may not show it."""
    for item in attitudes:
        angle = angle_between(q, item)
        if angle > WRONG:
            message = (
                f"where EULP puts the bodies, it is off by {math.degrees(angle):.4g} degrees; to close it they "
                "are turned: correct EULP or the order of the nodes if that is not meant"
            )
            yield Fault("warning", message, item.place, item.owner)
