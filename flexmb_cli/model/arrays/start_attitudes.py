"""Attitudes that the joints and motions of a deck name, where their equations also hold after a half turn.

The three nodes of a fixed joint place a triad on each body: origin at the first, e1 towards the second, the
third in the half-plane of e1 and e2.  The motions ROTX, ROTY and ROTZ of one body give its attitude.
"""

import math

import numpy as np

from ...errors import Place
from ...quick_dataclass import dataclass
from ..flexible_mechanism import FlexibleMechanism, NodePoint
from ..mechanism import GROUND
from ..time_functions import ROTATIONS, Motion
from ..vectors import rotation_matrix
from .node_joints import node_axes, spin_axis


@dataclass(frozen=True)
class StartAttitude:
    """Triads that must agree: columns of `of_i` and `of_j`, axes of bodies i and j.

    `groups`: of the equations that say so; they count joints, then pins, then motions from 0.
    """

    owner: str
    place: Place | None
    i: int
    j: int
    of_i: np.ndarray  # (3, 3)
    of_j: np.ndarray  # (3, 3)
    groups: tuple[int, ...]


def start_attitudes(mechanism: FlexibleMechanism) -> list[StartAttitude]:
    """Return those of fixed joints, and of bodies whose three rotations are prescribed."""
    found = [
        StartAttitude(
            joint.name, joint.place, joint.a[0].body, joint.b[0].body, triad(joint.a), triad(joint.b), (k,)
        )
        for k, joint in enumerate(mechanism.joints)
        if joint.kind == "fixed"
    ]
    first = len(mechanism.joints) + len(mechanism.pins)
    turns: dict[int, dict[int, tuple[int, Motion]]] = {}
    for k, motion in enumerate(mechanism.motions, start=first):
        if motion.kind in ROTATIONS:
            turns.setdefault(motion.target, {})[ROTATIONS.index(motion.kind)] = k, motion
    for body, by_axis in turns.items():
        if len(by_axis) == 3:
            spin = spin_axis(mechanism.motions, body)
            motion, own = by_axis[spin][1], node_axes(mechanism.bodies[body]).T
            turned, groups = _turn(spin, motion.function.at(0.0)[0]), tuple(k for k, _ in by_axis.values())
            found.append(StartAttitude(motion.name, motion.place, GROUND, body, turned, own, groups))
    return found


def _turn(axis: int, angle: float) -> np.ndarray:
    """Return the rotation matrix (3, 3) of a turn about a global axis."""
    return rotation_matrix((math.cos(angle / 2), *(math.sin(angle / 2) * np.eye(3)[axis])))


def triad(points: tuple[NodePoint, ...]) -> np.ndarray:
    """Return e1 e2 e3 of three nodes as columns, axes of their body."""
    P, Q, H = (point.r0 for point in points)
    e1 = (Q - P) / np.linalg.norm(Q - P)
    e2 = (H - P) - ((H - P) @ e1) * e1
    e2 /= np.linalg.norm(e2)
    return np.column_stack([e1, e2, np.cross(e1, e2)])
