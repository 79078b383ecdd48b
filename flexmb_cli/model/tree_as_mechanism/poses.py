"""Initial positions and velocities of the bodies of a tree, in coordinates of their own.

DAFMS thesis (1992), sections 2.2-2.3, walked outward body by body.

Planar trees with closed loops: how many closed directions must repeat others.

Hinges that turn about one direction, or slide across it, keep all bodies in a plane.  A loop that is closed
along this direction, too, closes what is closed already.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..tree import ELASTIC, INERTIAL, ROTATION, TRANSLATION, Hinge, Tree
from ..vectors import cross, rotation_matrix
from .frames import Base, Frames, NodeFrame, hinge_frames


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
        self.poses: dict[int, Pose] = {INERTIAL: STILL}

    def pose(self, body: int) -> Pose:
        """Pose of a body or node frame; parents come before their children."""
        if body not in self.poses:
            node_frame = body - len(self.tree.bodies)
            self.poses[body] = (
                self._hung(body) if node_frame < 0 else self._turned(self.frames.node_frames[node_frame])
            )
        return self.poses[body]

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

    def _turn(self, k: int, hinge: Hinge, at: Pose) -> tuple[Any, Any]:
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


PARALLEL = 1e-9


def repeated_in_planar_tree(tree: Tree) -> int | None:
    """Number of closed directions across the plane of a planar tree; None where it moves in no plane."""
    if any(closure.general for closure in tree.closures):
        return None  # they may hold turns, too
    frames = hinge_frames(tree)
    poses = [*first_poses(tree, frames)]
    moving = _moving_axes(tree, frames, poses)
    turning = [axis for motion, axis in moving if motion == ROTATION]
    if not turning:
        return None
    normal = turning[0]
    for motion, axis in moving:
        off = np.linalg.norm(np.cross(normal, axis)) if motion == ROTATION else abs(normal @ axis)
        if off > PARALLEL:
            return None
    return sum(
        closure.curve.lies_across(_axes_of(closure.b, poses).T @ normal)
        if closure.curve
        else len(closure.directions) == 3
        if closure.roll
        else _contains_normal(closure.directions, _axes_of(closure.b, poses), normal)
        for closure in tree.closures
    )


def _moving_axes(tree: Tree, frames: Frames, poses: list[Pose]) -> list[tuple[str, np.ndarray]]:
    """Motion and axis (3,), inertial axes, of every coordinate at the start."""
    moving = []
    for c in tree.coordinates:
        base = frames.bases[c.body]
        axes = _axes_of(c.body, poses) if c.motion == ELASTIC else _axes_of(base.body, poses) @ base.axes
        moving.append((c.motion, axes[:, c.axis - 1]))
    return moving


def _axes_of(body: int, poses: list[Pose]) -> np.ndarray:
    return np.eye(3) if body == INERTIAL else poses[body].A


def _contains_normal(directions: tuple[int, ...], axes: np.ndarray, normal: np.ndarray) -> bool:
    """Return whether the closed directions, axes 1 to 3 of a body, combine to the normal."""
    along = axes[:, [axis - 1 for axis in directions]]
    return bool(np.linalg.norm(normal - along @ (along.T @ normal)) <= PARALLEL)
