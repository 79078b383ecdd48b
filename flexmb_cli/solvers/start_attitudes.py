"""Bodies turned the right way round before a mechanism is assembled: half turns meet its equations, too.

The three nodes of a fixed joint place a triad on each body: origin at the first, e1 towards the second, the
third in the half-plane of e1 and e2.  The motions ROTX, ROTY and ROTZ of one body give its attitude.  The
rotation from one triad to the other, 0 in one attitude only, replaces the equations of directions here.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..errors import AnalysisError, Fault, Place
from ..model.arrays.node_joints import node_axes, spin_axis
from ..model.flexible_mechanism import FlexibleMechanism, NodePoint
from ..model.joints import DEPENDENT
from ..model.mechanism import GROUND
from ..model.time_functions import ROTATIONS
from ..model.vectors import euler_parameters, rotation_matrix
from .constrained.system import PositionGaps, is_large
from .projection import Corrections, Instant, project, shortened

TURNED = math.pi / 4  # an attitude that starts closer is found by the equations themselves
WRONG = math.pi / 2  # half-way to the other solution
_REMEDY = "check EULP, and the order of the nodes"
ROUGHLY = Corrections(met=1e-3, most=100, dependent=DEPENDENT)


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
    starts = [
        StartAttitude(
            joint.name, joint.place, joint.a[0].body, joint.b[0].body, triad(joint.a), triad(joint.b), (k,)
        )
        for k, joint in enumerate(mechanism.joints)
        if joint.kind == "fixed"
    ]
    first = len(mechanism.joints) + len(mechanism.pins)
    turns: dict[int, dict[int, Any]] = {}
    for k, motion in enumerate(mechanism.motions, start=first):
        if motion.kind in ROTATIONS:
            turns.setdefault(motion.target, {})[ROTATIONS.index(motion.kind)] = k, motion
    for body, by_axis in turns.items():
        if len(by_axis) == 3:
            spin = spin_axis(mechanism.motions, body)
            motion, own = by_axis[spin][1], node_axes(mechanism.bodies[body]).T
            half, groups = motion.function.at(0.0)[0] / 2, tuple(k for k, _ in by_axis.values())
            turned = rotation_matrix((math.cos(half), *(math.sin(half) * np.eye(3)[spin])))
            starts.append(StartAttitude(motion.name, motion.place, GROUND, body, turned, own, groups))
    return starts


def triad(points: tuple[NodePoint, ...]) -> np.ndarray:
    """Return e1 e2 e3 of three nodes as columns, axes of their body."""
    P, Q, H = (point.r0 for point in points)
    e1 = (Q - P) / np.linalg.norm(Q - P)
    e2 = (H - P) - ((H - P) @ e1) * e1
    e2 /= np.linalg.norm(e2)
    return np.column_stack([e1, e2, np.cross(e1, e2)])


class AttitudeGaps:
    """The `Equations` of `projection`, with rotation vectors in place of the equations of directions."""

    def __init__(self, gaps: PositionGaps, attitudes: Sequence[StartAttitude]):
        self.gaps, self.attitudes, self.moved = gaps, attitudes, gaps.moved
        ends = [gaps.arrays.groups[k] for item in attitudes for k in item.groups]
        rows = [row for group in ends for row in range(group["first_row"], group["end_row"])]
        self.replaced = [row for row in rows if not gaps.arrays.equations[row].is_length]

    def residual(self, q: np.ndarray, t: float, expected: np.ndarray) -> np.ndarray:
        """Return the scaled residual (m,) at q, then rotation vectors, rad, global axes."""
        gaps = self.gaps.residual(q, t, expected)
        gaps[self.replaced] = 0.0
        return np.concatenate([gaps, *(rotation_between(q, item) for item in self.attitudes)])

    def jacobian(self, q: np.ndarray) -> np.ndarray:
        """Return the scaled Jacobian on speeds; of rotation vectors its first order near 0."""
        J = np.array(self.gaps.jacobian(q))
        J[self.replaced] = 0.0
        added = np.zeros((len(self.attitudes), 3, J.shape[1]))
        for rows, item in zip(added, self.attitudes, strict=True):
            for body, sign in ((item.i, -1.0), (item.j, 1.0)):
                if body >= 0:
                    rows[:, 6 * body + 3 : 6 * body + 6] = sign * _axes(q, body)
        return np.vstack([J, *added])


def _axes(q: np.ndarray, body: int) -> np.ndarray:
    return np.eye(3) if body < 0 else rotation_matrix(q[7 * body + 3 : 7 * body + 7])


def rotation_between(q: np.ndarray, item: StartAttitude) -> np.ndarray:
    """Return the rotation vector (3,), rad, global axes, that takes the triad of i to that of j."""
    p = euler_parameters(_axes(q, item.j) @ item.of_j @ (_axes(q, item.i) @ item.of_i).T)
    size = float(np.linalg.norm(p[1:]))
    return 2.0 * math.atan2(size, p[0]) / max(size, 1e-300) * p[1:]


def turned_right(gaps: PositionGaps, attitudes: Sequence[StartAttitude], t: float) -> np.ndarray:
    """Return the deck's coordinates with bodies turned so that the triads of `attitudes` roughly agree."""
    arrays = gaps.arrays
    q: np.ndarray = arrays.q
    if is_large(arrays) or not any(_off(q, attitudes, TURNED)):
        return q
    rigid = np.arange(arrays.speeds) < 6 * arrays.bodies
    return project(Instant(AttitudeGaps(gaps, attitudes), t, arrays.angles), q, ROUGHLY, shortened, rigid)[0]


def _off(q: np.ndarray, attitudes: Sequence[StartAttitude], most: float) -> Iterator[tuple[Any, float]]:
    """Yield the attitudes that are off by more than `most`, rad, and by how many degrees."""
    for item in attitudes:
        angle = float(np.linalg.norm(rotation_between(q, item)))
        if angle > most:
            yield item, math.degrees(angle)


def refuse_half_turns(q: np.ndarray, attitudes: Sequence[StartAttitude], t: float) -> None:
    """Raise AnalysisError where an attitude is met after a half turn."""
    for item, degrees in _off(q, attitudes, WRONG):
        message = f"it is met only after a turn by {degrees:.4g} degrees; {_REMEDY}"
        raise AnalysisError(Fault("error", message, item.place, item.owner, id="SOLVE-090"), t)


def turn_warnings(q: np.ndarray, attitudes: Sequence[StartAttitude]) -> Iterator[Fault]:
    """Yield a warning for each attitude that the deck's q is far from: gaps may not show it."""
    for item, degrees in _off(q, attitudes, WRONG):
        message = f"it is off by {degrees:.4g} degrees at the start; bodies are turned to meet it; {_REMEDY}"
        yield Fault("warning", message, item.place, item.owner, id="SOLVE-091")
