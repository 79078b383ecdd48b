"""The body frame: three nodes (100)-(103), clamped nodes, or mean axes.

Vlasenko and Kasper (2008), section VIII.  The equations of motion hold for every constant basis that
excludes rigid motion; x0 and A then mean the frame so defined.
"""

from dataclasses import dataclass

import numpy as np

from ..model.flexible_body import FlexibleInput
from .input_checks import rigid_motions


@dataclass(frozen=True)
class Frame:
    """Origin (3,) and axes (3, 3, columns e1 e2 e3) in the node table's axes; nodes `r0` (n, 3) in the frame.

    `held`: rows of qf that are zero, () for mean axes; `clamped`: whether these are a clamped set.
    """

    origin: np.ndarray
    axes: np.ndarray
    r0: np.ndarray
    held: np.ndarray
    clamped: bool

    @property
    def mean(self) -> bool:
        """Return whether the frame is that of mean axes."""
        return not len(self.held)

    def shifted(self, shapes: np.ndarray, S: np.ndarray) -> np.ndarray:
        """`shapes` (3 n, k) less the rigid motion that keeps them from fulfilling the frame's conditions."""
        if self.clamped:
            return shapes
        if self.mean:
            return without_momentum(self.r0, shapes, S)
        rigid = rigid_motions(self.r0)
        found: np.ndarray = shapes - rigid @ np.linalg.solve(rigid[self.held], shapes[self.held])
        return found


def without_momentum(r0: np.ndarray, shapes: np.ndarray, S: np.ndarray) -> np.ndarray:
    """`shapes` (3 n, k) less the rigid motion that has their momentum and moment of momentum."""
    rigid = rigid_motions(r0)
    weighted = (S @ rigid).T
    found: np.ndarray = shapes - rigid @ np.linalg.solve(weighted @ rigid, weighted @ shapes)
    return found


def reference_frame(given: FlexibleInput, centre: np.ndarray) -> Frame:
    """The frame that `given` asks for; `centre` (3,) is the mass centre, the origin of mean axes."""
    rows = {int(number): row for row, number in enumerate(given.numbers)}
    origin, axes = _origin_and_axes(given, rows, centre)
    r0 = (given.positions - origin) @ axes
    return Frame(origin, axes, r0, _held(given, rows), bool(given.clamped))


def _origin_and_axes(
    given: FlexibleInput, rows: dict[int, int], centre: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    if not given.reference:
        return (np.zeros(3) if given.clamped else centre), np.eye(3)
    q1, q2, q3 = (given.positions[rows[node]] for node in given.reference)
    e1 = (q2 - q1) / np.linalg.norm(q2 - q1)
    e3 = np.cross(e1, q3 - q1)
    e3 = e3 / np.linalg.norm(e3)
    return q1, np.column_stack([e1, np.cross(e3, e1), e3])


def _held(given: FlexibleInput, rows: dict[int, int]) -> np.ndarray:
    if given.clamped:
        firsts = sorted(3 * rows[node] for node in set(given.clamped))
        return np.array([first + i for first in firsts for i in range(3)], dtype=np.int64)
    if not given.reference:
        return np.arange(0)
    n1, n2, n3 = (3 * rows[node] for node in given.reference)
    return np.array([n1, n1 + 1, n1 + 2, n2 + 1, n2 + 2, n3 + 2], dtype=np.int64)
