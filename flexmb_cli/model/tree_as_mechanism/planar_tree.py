"""Planar trees with closed loops: how many closed directions must repeat others.

Hinges that turn about one direction, or slide across it, keep all bodies in a plane.  A loop that is closed
along this direction, too, closes what is closed already.
"""

import numpy as np

from ..tree import ELASTIC, INERTIAL, ROTATION, Tree
from .frames import Frames, hinge_frames
from .poses import Pose, first_poses

PARALLEL = 1e-9


def repeated_in_planar_tree(tree: Tree) -> int | None:
    """Number of closed directions across the plane of a planar tree; None where it moves in no plane."""
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
        _contains_normal(closure.directions, _axes_of(closure.b, poses), normal) for closure in tree.closures
    )


def _moving_axes(tree: Tree, frames: Frames, poses: list[Pose]) -> list[tuple[str, np.ndarray]]:
    """Motion and axis (3,), inertial axes, of every coordinate at the start."""
    found = []
    for c in tree.coordinates:
        base = frames.bases[c.body]
        axes = _axes_of(c.body, poses) if c.motion == ELASTIC else _axes_of(base.body, poses) @ base.axes
        found.append((c.motion, axes[:, c.axis - 1]))
    return found


def _axes_of(body: int, poses: list[Pose]) -> np.ndarray:
    return np.eye(3) if body == INERTIAL else poses[body].A


def _contains_normal(directions: tuple[int, ...], axes: np.ndarray, normal: np.ndarray) -> bool:
    """Return whether the closed directions, axes 1 to 3 of a body, combine to the normal."""
    along = axes[:, [axis - 1 for axis in directions]]
    return bool(np.linalg.norm(normal - along @ (along.T @ normal)) <= PARALLEL)
