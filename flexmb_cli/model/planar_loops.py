"""Planar mechanisms built of spatial joints: how many of their equations must repeat others.

A revolute or translational joint has five equations where the plane needs two: the other three, one
displacement and two turns, are given once too often for every closed loop.  A composite joint gives those of
them that it has once too often where joints lead from one of its bodies to the other, as a curve does the
displacement.
"""

from collections.abc import Sequence

import numpy as np

from .joint_elements import CompositeJoint, Curve, Roll
from .mechanism import SINE_OF_PARALLELS, Joint, Vector
from .vectors import cross, length, rotation_matrix

REPEATED_EQUATIONS = 3  # equations of a loop
# Equations of composite joints that hold displacements and turns out of the plane.
OUT_OF_PLANE = {"revolute-cylindrical": 2, "revolute-spherical": 1, "spherical-spherical": 0}


def repeated_in_plane(
    joints: Sequence[Joint],
    grounds: Sequence[int],
    attitudes: np.ndarray,
    composites: Sequence[CompositeJoint | Joint] = (),
    tracks: Sequence[Curve | Roll] = (),
) -> int | None:
    """Number of repeated equations of planar joints; None unless all of them move in one plane.

    `grounds`: bodies at rest, beside body -1.  attitudes (bodies, 4): Euler parameters at the start.
    """
    if not joints or any(j.kind not in ("revolute", "translational") for j in joints):
        return None
    axes = [_axis(joint, attitudes) for joint in joints]
    turning = [axis for axis, joint in zip(axes, joints, strict=True) if joint.kind == "revolute"]
    if not turning:
        return None
    normal = turning[0]
    for axis, joint in zip(axes, joints, strict=True):
        off = abs(normal @ axis) if joint.kind == "translational" else length(cross(normal, axis))
        if off > SINE_OF_PARALLELS:
            return None
    loops, parts = _loops(joints, grounds, len(attitudes))
    for item in composites:
        if OUT_OF_PLANE[item.kind] and (
            parts[item.i] != parts[item.j] or not _lies_in_plane(item, attitudes, normal)
        ):
            return None
    tied = [track for track in tracks if parts[track.i] == parts[track.j]]
    if not all(track.lies_across(_attitude(track.i, attitudes).T @ normal) for track in tied):
        return None
    return REPEATED_EQUATIONS * loops + sum(OUT_OF_PLANE[item.kind] for item in composites) + len(tied)


def _lies_in_plane(item: CompositeJoint | Joint, attitudes: np.ndarray, normal: np.ndarray) -> bool:
    """Return whether the revolute of a composite joint turns about the normal, its cylindrical across it."""
    if length(cross(normal, _turned(item.s_i, item.i, attitudes))) > SINE_OF_PARALLELS:
        return False
    slides = item.kind == "revolute-cylindrical"
    return not slides or bool(abs(normal @ _turned(item.s_j, item.j, attitudes)) <= SINE_OF_PARALLELS)


def _axis(joint: Joint, attitudes: np.ndarray) -> np.ndarray:
    return _turned(joint.s_i, joint.i, attitudes)


def _turned(axis: Vector, body: int, attitudes: np.ndarray) -> np.ndarray:
    """Return the unit vector along an axis of a body, global axes."""
    s = _attitude(body, attitudes) @ np.array(axis)
    return s / np.linalg.norm(s)


def _attitude(body: int, attitudes: np.ndarray) -> np.ndarray:
    return rotation_matrix(attitudes[body]) if body >= 0 else np.eye(3)


def _loops(joints: Sequence[Joint], grounds: Sequence[int], bodies: int) -> tuple[int, list[int]]:
    """Independent loops of the joints, and which part each body belongs to.

    All grounds are one body, which has the last place, that of body -1.
    """
    root = list(range(bodies + 1))

    def find(body: int) -> int:
        while root[body] != body:
            body = root[body]
        return body

    for body in grounds:
        root[find(body)] = find(bodies)
    loops = 0
    for joint in joints:
        a, b = (find(body if body >= 0 else bodies) for body in (joint.i, joint.j))
        loops += a == b
        root[a] = b
    return loops, [find(body) for body in range(bodies + 1)]
