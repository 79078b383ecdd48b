"""Planar mechanisms built of spatial joints: how many of their equations must repeat others.

A revolute or translational joint has five equations where the plane needs two: the other three, one
displacement and two turns, are given once too often for every closed loop.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np

from .mechanism import SINE_OF_PARALLELS, Joint
from .vectors import rotation_matrix

REPEATED_EQUATIONS = 3  # equations of a loop


def repeated_in_plane(joints: Sequence[Joint], grounds: Sequence[int], attitudes: np.ndarray) -> int | None:
    """Number of repeated equations of planar `joints`; None unless all of them move in one plane.

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
        off = abs(normal @ axis) if joint.kind == "translational" else np.linalg.norm(np.cross(normal, axis))
        if off > SINE_OF_PARALLELS:
            return None
    return REPEATED_EQUATIONS * _loops(joints, grounds, len(attitudes))


def _axis(joint: Joint, attitudes: np.ndarray) -> np.ndarray:
    s = np.array(joint.s_i)
    if joint.i >= 0:
        s = rotation_matrix(attitudes[joint.i]) @ s
    found: np.ndarray = s / np.linalg.norm(s)
    return found


def _loops(joints: Sequence[Any], grounds: Sequence[Any], bodies: int) -> int:
    """Independent loops of the joints, all grounds being one body, which has the last place."""
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
    return loops
