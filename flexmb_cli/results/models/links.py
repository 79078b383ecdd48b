"""Links of a robot, as URDF and MJCF files have them, as a rigid model.

A link lies in the frame of its parent; its joints move it one after the other from there.  Links without
joints are one body with their parent.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from ...errors import Fault, ModelError
from ...model.exchange.rigid_model import RigidBody, RigidJoint, RigidModel, shifted, vector
from ...model.joint_elements import Coupling
from ...model.joints import ANGLE, STROKE
from ...model.laws import SPRING, At, Element
from ...model.mechanism import GROUND, TimeGrid
from ...model.shapes import ShapeCard
from ...model.vectors import euler_parameters

HINGE, SLIDE, BALL, FREE = "hinge", "slide", "ball", "free"
_KINDS = {(HINGE,): "revolute", (SLIDE,): "translational", (BALL,): "spherical", (): "fixed"}
# Neither format says how long a motion lasts.
TIMES = TimeGrid(0.0, 1.0, 0.01)
_SAME_PLACE = 1e-9  # of sines and, in m, of distances

Frame = tuple[np.ndarray, np.ndarray]  # origin (3,), m, and rotation matrix (3, 3) to the frame outside


class Mass(NamedTuple):
    """A mass, kg, its centre (3,), m, and its inertia (3, 3) about it, kg m², in the axes of the link."""

    mass: float  # kg
    centre: np.ndarray  # (3,) axes of the link, m
    inertia: np.ndarray  # (3, 3) about the centre, axes of the link, kg m²


@dataclass
class LinkJoint:
    """A joint of `kind` at `point` (3,), m, about or along `axis` (3,), in the axes of the link.

    `q`, `u`: coordinate and rate at the start; of a ball the turn (3, 3) and the angular velocity (3,), of a
    free joint the frame and both velocities (2, 3).  Its spring has the length `rest` at q = `rest`.
    """

    name: str
    kind: str
    axis: np.ndarray
    point: np.ndarray
    q: Any = 0.0
    u: Any = 0.0
    stiffness: float = 0.0
    damping: float = 0.0
    rest: float = 0.0

    def moved(self) -> Frame:
        """Return the frame of the link in its frame before this joint."""
        if self.kind == SLIDE:
            return self.q * self.axis, np.eye(3)
        if self.kind == FREE:
            return self.q
        turned = self.q if self.kind == BALL else rotation(self.axis, self.q)
        return self.point - turned @ self.point, turned


@dataclass
class Link:
    """A link: number of its `parent`, GROUND for none, and its `frame` there at q = 0."""

    name: str
    parent: int
    frame: Frame
    joints: list[LinkJoint] = field(default_factory=list)
    masses: list[Mass] = field(default_factory=list)
    shapes: list[ShapeCard] = field(default_factory=list)


class Gear(NamedTuple):
    """The change of a joint's coordinate is `ratio` times that of another joint, both by name."""

    name: str  # of the gear
    joint: str  # whose coordinate follows
    other: str  # whose coordinate it follows
    ratio: float  # no unit, m or 1/m


class Tie(NamedTuple):
    """A closed loop: a joint of `kind` between points (3,) of two links, in their axes; numbers of links."""

    name: str  # of the loop
    kind: str  # of its joint
    i: int  # number of the first link
    j: int  # number of the second link
    P_i: np.ndarray  # (3,) in axes of the first link, m
    P_j: np.ndarray  # (3,) in axes of the second link, m


def rotation(axis: np.ndarray, angle: float) -> np.ndarray:
    """Return the rotation matrix (3, 3) about a unit vector (3,) by an angle, rad (Rodrigues)."""
    x, y, z = axis
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + np.sin(angle) * cross + (1.0 - np.cos(angle)) * cross @ cross


def refuse(name: str, message: str, id: str) -> ModelError:
    """Return the error about a part of a file."""
    return ModelError([Fault("error", message, None, name, id=id)])


def joined(outer: Frame, inner: Frame) -> Frame:
    """Return the frame of `inner`, which is in `outer`, outside of both."""
    return outer[0] + outer[1] @ inner[0], outer[1] @ inner[1]


class Assembly:
    """Gathers links into bodies at the start; raises ModelError for what flexmb does not have."""

    def __init__(self, links: list[Link]):
        self.links = links
        self.owner: dict[int, int] = {GROUND: GROUND}  # body of each link
        self.inside: dict[int, Frame] = {GROUND: (np.zeros(3), np.eye(3))}  # its frame in that body
        self.poses: dict[int, Frame] = {GROUND: (np.zeros(3), np.eye(3))}  # of the links
        self.speeds: dict[int, tuple[np.ndarray, np.ndarray]] = {GROUND: (np.zeros(3), np.zeros(3))}
        self.heads: list[int] = []  # the link whose axes are those of each body
        for k, link in enumerate(links):
            self._place(k, link)

    def _place(self, k: int, link: Link) -> None:
        """Find pose, velocity and body of a link, whose parent is placed."""
        frame = link.frame
        for joint in link.joints:
            frame = joined(frame, joint.moved())
        self.poses[k] = joined(self.poses[link.parent], frame)
        self.speeds[k] = self._speed(k, link)
        if link.joints:
            self.owner[k], self.inside[k] = len(self.heads), (np.zeros(3), np.eye(3))
            self.heads.append(k)
        else:
            self.owner[k] = self.owner[link.parent]
            self.inside[k] = joined(self.inside[link.parent], frame)

    def _speed(self, k: int, link: Link) -> tuple[np.ndarray, np.ndarray]:
        """Return the velocity of a link's origin and its angular velocity, global axes."""
        v, omega = self.speeds[link.parent]
        here, frame = self.poses[link.parent], link.frame
        for joint in link.joints:
            if joint.kind == FREE:
                return joint.u[0], self.poses[k][1] @ joint.u[1]
            frame = joined(frame, joint.moved())
            origin, axes = joined(here, frame)
            along = axes @ joint.axis
            arm = here[0] - (origin + axes @ joint.point)
            if joint.kind == SLIDE:
                v = v + along * joint.u
            else:
                turn = axes @ joint.u if joint.kind == BALL else along * joint.u
                # The origin of the parent, as if it were fixed to what turns.
                omega, v = omega + turn, v + np.cross(turn, arm)
        return v + np.cross(omega, self.poses[k][0] - here[0]), omega

    def bodies(self) -> Iterator[RigidBody]:
        """Yield the bodies, with the masses of all links that belong to them."""
        for body, head in enumerate(self.heads):
            (r, A), (v, omega) = self.poses[head], self.speeds[head]
            own = (k for k, owner in self.owner.items() if owner == body)
            parts = [self._moved(k, part) for k in own for part in self.links[k].masses]
            mass = together(parts)
            yield RigidBody(
                self.links[head].name,
                r,
                np.array(euler_parameters(A)),
                v,
                omega,
                mass.mass,
                mass.centre,
                mass.inertia,
            )

    def _moved(self, k: int, part: Mass) -> Mass:
        place, axes = self.inside[k]
        return Mass(part.mass, place + axes @ part.centre, axes @ part.inertia @ axes.T)

    def shapes(self) -> Iterator[ShapeCard]:
        """Yield the shapes on their bodies."""
        for k, link in enumerate(self.links):
            yield from (shifted(shape, self.owner[k], *self.inside[k]) for shape in link.shapes)

    def joints(self) -> Iterator[tuple[RigidJoint, list[LinkJoint]]]:
        """Yield the joints, and those of the link that each stands for."""
        for k in self.heads:
            link = self.links[k]
            kinds = tuple(joint.kind for joint in link.joints)
            if FREE not in kinds:
                yield self._joint(k, link, _KINDS.get(kinds) or self._pair(link, kinds)), link.joints

    def _pair(self, link: Link, kinds: tuple[str, ...]) -> str:
        """Return the type of joint that two of a link make."""
        if len(kinds) == 2:
            (a, b), first, second = kinds, *link.joints
            away = np.linalg.norm(np.cross(first.axis, first.point - second.point))
            if {a, b} == {HINGE, SLIDE} and np.linalg.norm(np.cross(first.axis, second.axis)) < _SAME_PLACE:
                return "cylindrical"
            if a == b == HINGE and abs(first.axis @ second.axis) < _SAME_PLACE and away < _SAME_PLACE:
                return "universal"
        message = (
            f"{' and '.join(kinds)} of one body are not a joint of flexmb: give it bodies between "
            "them, with one joint each"
        )
        raise refuse(link.name, message, "RESULT-160")

    def _joint(self, k: int, link: Link, kind: str) -> RigidJoint:
        first, last = link.joints[0], link.joints[-1]
        (r, A), parent = self.poses[k], self.owner[link.parent]
        r_i, A_i = self._body_pose(parent)
        at = next((joint.point for joint in link.joints if joint.kind != SLIDE), first.point)
        before = joined(self.poses[link.parent], link.frame)
        s = (before if kind == "universal" else (r, A))[1] @ first.axis
        P = r + A @ at
        P_i = before[0] + before[1] @ at if kind in ("translational", "cylindrical") else P
        s_j = last.axis if kind == "universal" else first.axis
        ends = vector(A_i.T @ (P_i - r_i)), vector(at)
        return RigidJoint(first.name, kind, parent, self.owner[k], *ends, vector(A_i.T @ s), vector(s_j))

    def _body_pose(self, body: int) -> Frame:
        return self.poses[GROUND] if body == GROUND else self.poses[self.heads[body]]

    def tie(self, tie: Tie) -> RigidJoint:
        """Return the joint that closes a loop."""
        places = [joined(self.inside[k], (P, np.eye(3))) for k, P in ((tie.i, tie.P_i), (tie.j, tie.P_j))]
        ends = [vector(place) for place, _ in places]
        bodies = self.owner[tie.i], self.owner[tie.j]
        gap = np.subtract(
            *(joined(self._body_pose(b), place)[0] for b, place in zip(bodies, places, strict=True))
        )
        if np.linalg.norm(gap) > 1e-3:
            message = (
                f"its points are {np.linalg.norm(gap):.3g} m apart at the start; begin with a closed loop"
            )
            raise refuse(tie.name, message, "RESULT-161")
        return RigidJoint(tie.name, tie.kind, bodies[0], bodies[1], ends[0], ends[1])


def together(parts: list[Mass]) -> Mass:
    """Return several masses of one body as one."""
    total = sum(part.mass for part in parts)
    centre = sum((part.mass * part.centre for part in parts), np.zeros(3)) / (total or 1.0)
    inertia = np.zeros((3, 3))
    for part in parts:
        d = part.centre - centre
        inertia += part.inertia + part.mass * (d @ d * np.eye(3) - np.outer(d, d))
    return Mass(total, centre, inertia)


def model_of_links(
    links: list[Link],
    gravity: np.ndarray,
    gears: Iterable[Gear] = (),
    ties: Iterable[Tie] = (),
    notes: tuple[str, ...] = (),
) -> RigidModel:
    """Return the rigid model of links at their start, whose joint coordinates count from there."""
    assembly = Assembly(links)
    pairs = list(assembly.joints())
    number = {joint.name: k for k, (_, joints) in enumerate(pairs) for joint in joints}
    by_name = {joint.name: joint for _, joints in pairs for joint in joints}

    def at(name: str) -> At:
        return At(number[name], ANGLE if by_name[name].kind == HINGE else STROKE)

    springs = []
    for rigid, joints in pairs:
        for joint in joints:
            if not (joint.stiffness or joint.damping):
                continue
            if joint.kind == BALL or rigid.kind == "universal":
                message = f"springs and dampers of a {rigid.kind} joint do not convert; set them to 0"
                raise refuse(joint.name, message, "RESULT-162")
            values = SPRING.values(
                stiffness=joint.stiffness, rest=joint.rest - joint.q, damping=joint.damping
            )
            springs.append(Element(f"spring of {joint.name}", SPRING, at(joint.name), values))
    couplings = []
    for gear in gears:
        terms = tuple((*at(name), factor) for name, factor in ((gear.joint, 1.0), (gear.other, -gear.ratio)))
        couplings.append(Coupling(gear.name, terms))
    return RigidModel(
        tuple(assembly.bodies()),
        TIMES,
        vector(gravity),
        (*(rigid for rigid, _ in pairs), *map(assembly.tie, ties)),
        elements=tuple(springs),
        couplings=tuple(couplings),
        shapes=tuple(assembly.shapes()),
        notes=(*notes, f"times are flexmb's: 0 to {TIMES.end:g} s by {TIMES.step:g} s"),
    )
