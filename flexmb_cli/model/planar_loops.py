"""Planar mechanisms built of spatial joints: how many of their equations must repeat others.

A revolute or translational joint has five equations where the plane needs two: the other three, one
displacement and two turns, are given once too often for every closed loop.
"""

import numpy as np

from .mechanism import Joint, Mechanism
from .vectors import rotation_matrix

PARALLEL = 1e-9
REPEATED = 3  # equations of a loop


def repeated_in_plane(mechanism: Mechanism, attitudes: np.ndarray) -> int | None:
    """Number of repeated equations of a planar mechanism; None unless all its joints move in one plane.

    attitudes (bodies, 4): Euler parameters at the start.
    """
    if not mechanism.joints or any(j.kind not in ("revolute", "translational") for j in mechanism.joints):
        return None
    axes = [_axis(joint, attitudes[joint.i]) for joint in mechanism.joints]
    turning = [axis for axis, joint in zip(axes, mechanism.joints, strict=True) if joint.kind == "revolute"]
    if not turning:
        return None
    normal = turning[0]
    for axis, joint in zip(axes, mechanism.joints, strict=True):
        off = abs(normal @ axis) if joint.kind == "translational" else np.linalg.norm(np.cross(normal, axis))
        if off > PARALLEL:
            return None
    return REPEATED * _loops(mechanism)


def _axis(joint: Joint, p: np.ndarray) -> np.ndarray:
    s = rotation_matrix(p) @ np.array(joint.s_i)
    return s / np.linalg.norm(s)


def _loops(mechanism: Mechanism) -> int:
    """Independent loops of the joints, all grounds being one body."""
    root = list(range(len(mechanism.bodies)))

    def find(body: int) -> int:
        while root[body] != body:
            body = root[body]
        return body

    grounds = [ground.body for ground in mechanism.grounds]
    for body in grounds[1:]:
        root[find(body)] = find(grounds[0])
    loops = 0
    for joint in mechanism.joints:
        a, b = find(joint.i), find(joint.j)
        loops += a == b
        root[a] = b
    return loops
