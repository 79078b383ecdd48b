"""Joints, pins and motions between points of rigid and flexible bodies, as lists of primitives.

The equations are those of Young's joints (1996, chapter 4) with vectors that move with the nodes: points
coincide, axes stay parallel, (p1) and (p2), body vectors keep right angles, angles count about the axis of
body a.
"""

import math

import numpy as np

from ...errors import Fault, ModelError
from ..flexible_mechanism import FlexibleMechanism, FloatingBody, NodePoint, PointJoint
from ..joints import ANGLES_OF_CROSS
from ..time_functions import POLYNOMIAL, ROTATIONS, TRANSLATIONS, Motion, MotionFunction
from .constraint_table import PrimitiveTable, tilde
from .records import NONE

ACROSS = 1e-9  # of a length: what decks and assembly round off


class JointVectors:
    """The moving directions of a joint between points P, Q, H of bodies a and b."""

    def __init__(self, table: PrimitiveTable, joint: PointJoint):
        self.table, self.joint = table, joint
        self.a, self.b = joint.a, joint.b
        self.i, self.j = joint.a[0].body, joint.b[0].body
        self.gap = table.point(self.b[0]), table.point(self.a[0])

    @property
    def s(self) -> np.ndarray:
        """Unit vector along the axis of body a at t = 0, its axes."""
        return self._unit(self.a)

    def _unit(self, points: tuple[NodePoint, ...]) -> np.ndarray:
        s = points[1].r0 - points[0].r0
        return s / np.linalg.norm(s)

    def body_vector_of(self, points: tuple[NodePoint, ...]) -> int:
        """The vector from P to Q, 1 long at t = 0."""
        B = np.eye(3) / np.linalg.norm(points[1].r0 - points[0].r0)
        return self.table.between(points[0], points[1], B)

    def across(self) -> list[int]:
        """e_m × s and e_n × s of body a, m and n the axes other than that of the largest part of s."""
        size = np.linalg.norm(self.a[1].r0 - self.a[0].r0)
        largest = int(np.argmax(np.abs(self.s)))
        others = sorted({0, 1, 2} - {largest}, reverse=True)
        return [self.table.between(self.a[0], self.a[1], tilde(np.eye(3)[m]) / size) for m in others]

    @property
    def slide(self) -> float:
        """Advance of b1 along the axis from a1 at t = 0, m."""
        gap = self.table.position(self.b[0]) - self.table.position(self.a[0])
        return float(gap @ (self.table.A(self.i) @ self.s))

    def turning(self) -> tuple[int, int, int]:
        """F, G of body a and H of body b, whose angle is 0 at t = 0, of a fixed joint where third nodes meet.

        They go from P to the third nodes where there are some, else they are fixed in the bodies' frames.
        """
        table, s = self.table, self.s
        of_b, of_a = table.A(self.j), table.A(self.i)
        if len(self.a) < 3:
            f = np.cross(s, np.eye(3)[int(np.argmin(np.abs(s)))])
            f /= np.linalg.norm(f)
            h = of_b.T @ of_a @ f
            return (
                table.direction(self.a[0], f),
                table.direction(self.a[0], np.cross(s, f)),
                table.direction(self.b[0], self._off_axis(h) @ h),
            )
        h = self.b[2].r0 - self.b[0].r0
        target = of_a.T @ of_b @ h
        given = self.a[2].r0 - self.a[0].r0
        across = given - (given @ s) * s
        gamma = math.atan2(s @ np.cross(across, target), across @ target)
        if self.joint.kind == "fixed":
            gamma = 0.0
        B = math.cos(gamma) * (np.eye(3) - np.outer(s, s)) + math.sin(gamma) * tilde(s)
        B = B / np.linalg.norm(across)
        return (
            table.between(self.a[0], self.a[2], B),
            table.between(self.a[0], self.a[2], tilde(s) @ B),
            table.between(self.b[0], self.b[2], self._off_axis(h) / np.linalg.norm(h)),
        )

    def of_cross(self, coordinate: str) -> tuple[int, int, int]:
        """F, G and H of an angle of a universal joint, which is 0 at t = 0.

        Of the first F and G are of body a, across its axis, and H is the axis of body b.  Seen from body b,
        the axis of body a turns back about its own: of the second F and G are of b, and H is that axis.
        """
        first = coordinate == ANGLES_OF_CROSS[0]
        own, other, sign = (self.a, self.b, 1.0) if first else (self.b, self.a, -1.0)
        s, A = self._unit(own), self.table.A(own[0].body)
        f = A.T @ self.table.A(other[0].body) @ self._unit(other)
        f -= (f @ s) * s
        f /= np.linalg.norm(f)
        g = sign * np.cross(s, f)
        return self.table.direction(own[0], f), self.table.direction(own[0], g), self.body_vector_of(other)

    def _off_axis(self, h: np.ndarray) -> np.ndarray:
        """Return the projection (3, 3) that takes from h of body b its part along the joint's axis.

        A torque in an angle acts along the gradient of that angle. This is the axis only if H is across it,
        which estimates that miss the axis, or a third node beside the plane across it, do not give.
        """
        s = self._unit(self.b)
        along, length = abs(h @ s), np.linalg.norm(h)
        if along <= ACROSS * length or along >= (1.0 - ACROSS) * length:
            return np.eye(3)
        return np.eye(3) - np.outer(s, s)

    def stroke(self) -> np.ndarray:
        """The primitive of the stroke, 0 at t = 0."""
        return self.table.product(self.gap, self.body_vector_of(self.a), constant=self.slide)


def _coincident(body_vectors: JointVectors) -> list[tuple[str, bool, np.ndarray]]:
    return [
        (name, True, body_vectors.table.product(body_vectors.gap, body_vectors.table.axis(k)))
        for k, name in enumerate("xyz")
    ]


def _parallel(body_vectors: JointVectors) -> list[tuple[str, bool, np.ndarray]]:
    other = body_vectors.body_vector_of(body_vectors.b)
    return [
        (f"axes parallel, {word}", False, body_vectors.table.product(other, across))
        for word, across in zip(("1st", "2nd"), body_vectors.across(), strict=True)
    ]


def _on_axis(body_vectors: JointVectors) -> list[tuple[str, bool, np.ndarray]]:
    return [
        (
            f"{body_vectors.b[0].name} on the axis, {word}",
            True,
            body_vectors.table.product(body_vectors.gap, across),
        )
        for word, across in zip(("1st", "2nd"), body_vectors.across(), strict=True)
    ]


def _no_turn(body_vectors: JointVectors) -> list[tuple[str, bool, np.ndarray]]:
    _, g, h = body_vectors.turning()
    return [("angle about the axis", False, body_vectors.table.product(g, h))]


def _right_angle(body_vectors: JointVectors) -> list[tuple[str, bool, np.ndarray]]:
    return [
        (
            "arms at right angles",
            False,
            body_vectors.table.product(
                body_vectors.body_vector_of(body_vectors.a), body_vectors.body_vector_of(body_vectors.b)
            ),
        )
    ]


def _thread(body_vectors: JointVectors) -> list[tuple[str, bool, np.ndarray]]:
    record = body_vectors.stroke()
    return [
        (
            "slide and turn",
            True,
            body_vectors.table.add_angle(record, -body_vectors.joint.size, *body_vectors.turning()),
        )
    ]


def _distance(body_vectors: JointVectors) -> list[tuple[str, bool, np.ndarray]]:
    L = body_vectors.joint.size
    return [
        ("distance", True, body_vectors.table.product(body_vectors.gap, body_vectors.gap, 0.5 / L, 0.5 * L))
    ]


def _in_plane(body_vectors: JointVectors) -> list[tuple[str, bool, np.ndarray]]:
    return [("in the plane across the axis", True, body_vectors.stroke())]


EQUATIONS_OF = {
    "spherical": (_coincident,),
    "universal": (_coincident, _right_angle),
    "revolute": (_coincident, _parallel),
    "cylindrical": (_parallel, _on_axis),
    "translational": (_parallel, _on_axis, _no_turn),
    "screw": (_parallel, _on_axis, _thread),
    "fixed": (_coincident, _parallel, _no_turn),
    "revolute-spherical": (_in_plane, _distance),
    "spherical-spherical": (_distance,),
}


def add_joints(table: PrimitiveTable, mechanism: FlexibleMechanism) -> None:
    """The equations of joints and pins."""
    for joint in mechanism.joints:
        body_vectors = JointVectors(table, joint)
        parts = [part for make in EQUATIONS_OF[joint.kind] for part in make(body_vectors)]
        table.equations(joint.name, joint.place, body_vectors.i, body_vectors.j, parts)
    for pin in mechanism.pins:
        target = table.body_vector(NONE, pin.target)
        gap = table.point(pin.point), target
        records = [table.product(gap, table.axis(k)) for k in range(3)]
        for record, function in zip(records, pin.functions, strict=True):
            record["function"] = NONE if function is None else table.function(function)
        parts = [("xyz"[k], True, records[k]) for k in range(3) if pin.directions[k]]
        table.equations(pin.name, pin.place, NONE, pin.point.body, parts)


def add_motions(table: PrimitiveTable, mechanism: FlexibleMechanism) -> None:
    """The equations of prescribed motions, one each.  Raises ModelError where turns have no meaning."""
    _refuse_two_rotations(mechanism.motions)
    for motion in mechanism.motions:
        if motion.of_joint:
            body_vectors = JointVectors(table, mechanism.joints[motion.target])
            i, j = body_vectors.i, body_vectors.j
            record = (
                body_vectors.stroke()
                if motion.is_length
                else table.angle(*body_vectors.turning(), motion.function.at(0.0)[0])
            )
        else:
            i, j = NONE, motion.target
            record = _body_motion(table, mechanism, motion)
        record["function"] = table.function(motion.function)
        name = "stroke" if motion.is_length else "angle"
        table.equations(motion.name, motion.place, i, j, [(name, motion.is_length, record)])


def _body_motion(table: PrimitiveTable, mechanism: FlexibleMechanism, motion: Motion) -> np.ndarray:
    if motion.kind in TRANSLATIONS:
        origin = table.body_vector(motion.target, np.zeros(3)), table.body_vector(NONE, np.zeros(3))
        return table.product(origin, table.axis(TRANSLATIONS.index(motion.kind)))
    own = node_axes(mechanism.bodies[motion.target])
    about = ROTATIONS.index(motion.kind)
    spin = spin_axis(mechanism.motions, motion.target)
    after, last = (about + 1) % 3, (about + 2) % 3
    if about == spin:
        expected = motion.function.at(0.0)[0]
        return table.angle(
            table.axis(after), table.axis(last), table.body_vector(motion.target, own[after]), expected
        )
    # A small turn φ about `about` moves the axis of spin by φ along ±the third axis.
    sign = -1.0 if (spin + 1) % 3 == about else 1.0
    third = 3 - about - spin
    return table.product(table.body_vector(motion.target, own[spin]), table.axis(third), sign)


def node_axes(body: FloatingBody) -> np.ndarray:
    """The axes of the node table in body axes, one a row."""
    return body.flexible.axes if body.flexible else np.eye(3)


def _is_zero(function: MotionFunction) -> bool:
    return function.kind == POLYNOMIAL and not any(function.c)


def spin_axis(motions: tuple[Motion, ...], body: int) -> int:
    """The axis a body is turned about: that of the only rotation that is not held at 0."""
    own = [motion for motion in motions if motion.target == body and motion.kind in ROTATIONS]
    turned = [motion for motion in own if not _is_zero(motion.function)]
    return ROTATIONS.index((turned or own[-1:])[0].kind)


def _refuse_two_rotations(motions: tuple[Motion, ...]) -> None:
    faults = []
    for body in {motion.target for motion in motions if motion.kind in ROTATIONS}:
        turned = [m for m in motions if m.target == body and m.kind in ROTATIONS and not _is_zero(m.function)]
        for motion in turned[1:]:
            message = (
                f"{turned[0].kind} and {motion.kind} both turn body {body + 1}; one axis can be turned about "
                "while the others are held at 0; prescribe two turns by joints with ANGL"
            )
            faults.append(Fault("error", message, motion.place, motion.name, id="MODEL-001"))
    if faults:
        raise ModelError(faults)


def reaction_point(joint: PointJoint) -> NodePoint:
    """Return where the reaction of a joint acts: its first point on body b."""
    return joint.b[0]
