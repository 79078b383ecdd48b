"""The body frame: three nodes (100)-(103), clamped nodes, or mean axes; displacements of a body held in it.

Vlasenko and Kasper (2008), section VIII.  The equations of motion hold for every constant basis that
excludes rigid motion; x0 and A then mean the frame so defined.  Under forces at its nodes a body is held in
its frame or, in mean axes, balanced by its acceleration.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..model.flexible_body import FlexibleInput
from .input_checks import rigid_motions
from .linear_algebra import Singular, all_but, as_array, is_small, solver
from .massless_shapes import FreeMotion


@dataclass(frozen=True)
class Frame:
    """Origin (3,) and axes (3, 3, columns e1 e2 e3) in the node table's axes; nodes `r0` (n, 3) in the frame.

    `held`: rows of qf that are zero, () for mean axes; `clamped`: whether these are a clamped set.  `rigid`
    (size, 6) and `labels` (size, 2) are those of matrices whose rows are not x y z node by node; see `rows`.
    """

    origin: np.ndarray
    axes: np.ndarray
    r0: np.ndarray
    held: np.ndarray
    clamped: bool
    rigid: np.ndarray | None = None
    labels: np.ndarray | None = None

    @property
    def motions(self) -> np.ndarray:
        """Rows (size, 6) of unit translations along, and rotations about, the axes of the frame."""
        return rigid_motions(self.r0) if self.rigid is None else self.rigid

    def places(self, rows: np.ndarray) -> np.ndarray | None:
        """Return where the nodes of rows are (k, 3); None if some rows have no node."""
        return self.r0[rows // 3] if self.rigid is None else None

    @property
    def mean(self) -> bool:
        """Return whether the frame is that of mean axes."""
        return not len(self.held)

    def shifted(self, shapes: np.ndarray, S: np.ndarray) -> np.ndarray:
        """`shapes` (3 n, k) less the rigid motion that keeps them from fulfilling the frame's conditions."""
        if self.clamped:
            return shapes
        if self.mean:
            return without_momentum(self, shapes, S)
        rigid = self.motions
        return shapes - rigid @ np.linalg.solve(rigid[self.held], shapes[self.held])


def without_momentum(frame: Frame, shapes: np.ndarray, S: np.ndarray) -> np.ndarray:
    """`shapes` (3 n, k) less the rigid motion that has their momentum and moment of momentum."""
    rigid = frame.motions
    weighted = (S @ rigid).T
    return shapes - rigid @ np.linalg.solve(weighted @ rigid, weighted @ shapes)


def reference_frame(given: FlexibleInput, centre: np.ndarray) -> Frame:
    """The frame that `given` asks for; `centre` (3,) is the mass centre, the origin of mean axes."""
    rows = {int(number): row for row, number in enumerate(given.numbers)}
    origin, axes = origin_and_axes(given, rows, centre)
    r0 = (given.positions - origin) @ axes
    return Frame(origin, axes, r0, _held(given, rows), bool(given.clamped))


def origin_and_axes(
    given: FlexibleInput, rows: dict[int, int], centre: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Origin (3,) and axes (3, 3) of the frame; `rows`: places of the nodes in the table by their numbers."""
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


class FreeBody:
    """Static shapes of a body that nothing holds: forces are balanced by the acceleration they cause."""

    def __init__(self, K: np.ndarray, S: np.ndarray, frame: Frame):
        self.S, self.frame = S, frame
        self._free = all_but(K.shape[0], _supports(frame))
        self._solve = held_solver(K, self._free, frame)
        self._rigid = frame.motions
        self._weighted = S @ self._rigid
        self._mass = self._rigid.T @ self._weighted

    def shapes(self, forces: np.ndarray) -> np.ndarray:
        """Displacements in mean axes under `forces`, both (3 n, k) or (3 n,)."""
        balanced = forces - self._weighted @ np.linalg.solve(self._mass, self._rigid.T @ forces)
        shapes = np.zeros(forces.shape)
        shapes[self._free] = self._solve(balanced[self._free])
        return self.frame.shifted(shapes, self.S)


def as_solved(frame: Frame, shapes: np.ndarray) -> np.ndarray:
    """Return `shapes` (3 n, k) less the rigid motion by which they differ from what K was solved for.

    In mean axes that is a body held at six degrees of freedom; the forces by which an imprecise K resists
    rigid motion then do no work on the shapes as they are.
    """
    if not frame.mean:
        return shapes
    rows, rigid = _supports(frame), frame.motions
    return shapes - rigid @ np.linalg.solve(rigid[rows], shapes[rows])


def unit_forces(size: int, rows: np.ndarray) -> np.ndarray:
    """Return unit forces in each of the degrees of freedom `rows`, (size, k)."""
    forces = np.zeros((size, len(rows)))
    forces[rows, np.arange(len(rows))] = 1.0
    return forces


def static_shapes(K: np.ndarray, S: np.ndarray, frame: Frame, forces: np.ndarray) -> np.ndarray:
    """Displacements (3 n, k) of the body held in its frame under `forces` (3 n, k).

    In mean axes it is free, and the forces are balanced by those of the rigid acceleration they cause.
    """
    if frame.mean:
        return FreeBody(K, S, frame).shapes(forces)
    free = all_but(K.shape[0], frame.held)
    shapes = np.zeros(forces.shape)
    shapes[free] = held_solver(K, free, frame)(forces[free])
    return shapes


def _supports(frame: Frame) -> np.ndarray:
    """Six rows that hold the body: a node, one far from it, and one far from their line."""
    if frame.rigid is not None:
        return _independent_rows(frame.rigid)
    r0 = frame.r0
    first = int(np.argmax(np.linalg.norm(r0 - r0.mean(axis=0), axis=1)))
    relative = r0 - r0[first]
    second = int(np.argmax(np.linalg.norm(relative, axis=1)))
    third = int(np.argmax(np.linalg.norm(np.cross(relative, relative[second]), axis=1)))
    normal = np.cross(relative[second], relative[third])
    along = int(np.argmax(np.abs(relative[second])))
    others = [axis for axis in range(3) if axis != along]
    last = max(others, key=lambda axis: abs(normal[axis]))
    rows = [
        3 * first,
        3 * first + 1,
        3 * first + 2,
        *(3 * second + axis for axis in others),
        3 * third + last,
    ]
    return np.array(rows)


def _independent_rows(rigid: np.ndarray) -> np.ndarray:
    """Six rows whose rigid motions (size, 6) differ most: always the one that the others say least of."""
    left, rows = rigid / np.abs(rigid).max(axis=0), []
    for _ in range(6):
        rows.append(int(np.argmax(np.einsum("ij,ij->i", left, left))))
        unit = left[rows[-1]] / np.linalg.norm(left[rows[-1]])
        left = left - np.outer(left @ unit, unit)
    return np.array(rows)


def held_solver(K: np.ndarray, free: np.ndarray, frame: Frame) -> Callable[..., Any]:
    """The solution of K x = b with all degrees of freedom but `free` at rest, as a function of b.

    Raises FreeMotion, then or at once: whether a pivot of exactly 0 is met depends on the processor.
    """

    def solve(b: np.ndarray) -> np.ndarray:
        try:
            return solution(b)
        except Singular:
            raise FreeMotion(_weakest(K, free)) from None

    try:
        solution = solver(K[free][:, free], frame.places(free))
    except Singular:
        raise FreeMotion(_weakest(K, free)) from None
    return solve


def _weakest(K: np.ndarray, free: np.ndarray) -> np.ndarray:
    """The shape of the degrees of freedom `free` with the least strain energy; 0 where finding it takes too
    long.
    """
    shape = np.zeros(K.shape[0])
    if is_small(len(free), 1):
        shape[free] = np.linalg.eigh(as_array(K[free][:, free]))[1][:, 0]
    return shape
