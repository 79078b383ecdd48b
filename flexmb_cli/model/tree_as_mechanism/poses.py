"""Initial positions and velocities of the bodies of a tree, in coordinates of their own.

DAFMS thesis (1992), sections 2.2-2.3, walked outward body by body.
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ..tree import ELASTIC, INERTIAL, ROTATION, TRANSLATION, Tree
from ..vectors import cross, rotation_matrix
from .frames import Base, Frames, NodeFrame

if TYPE_CHECKING:
    from ..tree import Hinge


@dataclass(frozen=True, eq=False)
class Pose:
    """Pose and motion of a body, global axes: r, v, angular velocity w (3,); attitude A (3, 3)."""

    r: np.ndarray
    A: np.ndarray
    v: np.ndarray
    w: np.ndarray


STILL = Pose(np.zeros(3), np.eye(3), np.zeros(3), np.zeros(3))


def first_poses(tree: Tree, frames: Frames) -> list[Pose]:
    """Poses of bodies, then node frames, at the tree's initial coordinates and speeds."""
    start = _Start(tree, frames)
    return [start.pose(k) for k in range(len(tree.bodies) + len(frames.node_frames))]


class _Start:
    """Outward walk along the tree at its initial coordinates and speeds."""

    def __init__(self, tree: Tree, frames: Frames):
        self.tree, self.frames = tree, frames
        self.state = {
            (c.body, c.motion, c.axis): (q, y)
            for c, q, y in zip(tree.coordinates, tree.q, tree.y, strict=True)
            if c.motion != ELASTIC
        }
        self.found: dict[int, Pose] = {INERTIAL: STILL}

    def pose(self, body: int) -> Pose:
        """Pose of a body or node frame; parents come before their children."""
        if body not in self.found:
            node_frame = body - len(self.tree.bodies)
            self.found[body] = (
                self._hung(body) if node_frame < 0 else self._turned(self.frames.node_frames[node_frame])
            )
        return self.found[body]

    def _at(self, base: Base) -> Pose:
        """Motion of the point of a base, with its axes."""
        on, (eta, rate) = self.pose(base.body), elastic_start(self.tree, base.body)
        shape = base.shape
        body_vector = on.A @ (base.place + (shape @ eta if shape.size else 0.0))
        slide = on.A @ (shape @ rate) if shape.size else np.zeros(3)
        return Pose(on.r + body_vector, on.A @ base.axes, on.v + cross(on.w, body_vector) + slide, on.w)

    def _turned(self, node_frame: NodeFrame) -> Pose:
        at, (eta, rate) = self._at(node_frame.base), elastic_start(self.tree, node_frame.owner)
        A = at.A @ about(node_frame.axis, node_frame.slope @ eta)
        return Pose(at.r, A, at.v, at.w + at.A[:, node_frame.axis] * (node_frame.slope @ rate))

    def _hung(self, k: int) -> Pose:
        at, hinge = self._at(self.frames.bases[k]), self.tree.hinges[k]
        slide, rate = np.zeros(3), np.zeros(3)
        for axis in hinge.translations:
            q, y = self.state[k, TRANSLATION, axis]
            slide, rate = slide + q * at.A[:, axis - 1], rate + y * at.A[:, axis - 1]
        A, w = self._turn(k, hinge, at)
        return Pose(at.r + slide, A, at.v + cross(at.w, slide) + rate, w)

    def _turn(self, k: int, hinge: "Hinge", at: Pose) -> tuple[Any, Any]:
        A, w = at.A, at.w
        for axis in hinge.rotations:
            q, y = self.state[k, ROTATION, axis]
            w = w + y * A[:, axis - 1]
            if len(hinge.rotations) < 3:
                A = A @ about(axis - 1, q)
        if len(hinge.rotations) in (0, 3):
            A = A @ rotation_matrix(hinge.attitude)
        return A, w


def elastic_start(tree: Tree, body: int) -> tuple[np.ndarray, np.ndarray]:
    """Elastic coordinates of a body and their rates at the start, both (NM,); empty for a rigid one."""
    own = np.array([c.motion == ELASTIC and c.body == body for c in tree.coordinates], bool)
    return np.array(tree.q, float)[own], np.array(tree.y, float)[own]


def about(axis: int, angle: float) -> np.ndarray:
    """Rotation (3, 3) about axis 0, 1 or 2."""
    R = np.eye(3)
    a, b = (axis + 1) % 3, (axis + 2) % 3
    R[a, a] = R[b, b] = np.cos(angle)
    R[a, b], R[b, a] = -np.sin(angle), np.sin(angle)
    return R
