"""Joints, pins and motions between points of rigid and flexible bodies, as lists of measures.

The equations are those of Young's joints (1996, chapter 4) with vectors that move with the nodes: points
coincide, axes stay parallel, (p1) and (p2), arms keep right angles, angles count about the axis of body a.
"""

import math

import numpy as np

from ...errors import Fault, ModelError
from ..flexible_mechanism import FlexibleMechanism, NodePoint, PointJoint
from ..time_functions import POLYNOMIAL, Motion
from .constraint_table import MeasureTable, tilde
from .records import NONE

TRANSLATIONS, ROTATIONS = ("TRAX", "TRAY", "TRAZ"), ("ROTX", "ROTY", "ROTZ")


class JointArms:
    """The moving directions of a joint between points P, Q, H of bodies a and b."""

    def __init__(self, table: MeasureTable, joint: PointJoint):
        self.table, self.joint = table, joint
        self.a, self.b = joint.a, joint.b
        self.i, self.j = joint.a[0].body, joint.b[0].body
        self.gap = table.point(self.b[0]), table.point(self.a[0])

    @property
    def s(self) -> np.ndarray:
        """Unit vector along the axis of body a at t = 0, its axes."""
        return self._unit(self.a)

    def _unit(self, points):
        s = points[1].r0 - points[0].r0
        return s / np.linalg.norm(s)

    def arm_of(self, points) -> int:
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
        """F, G of body a and H of body b, whose angle is 0 at t = 0.

        They go from P to the third nodes where there are some, else they are fixed in the bodies' frames.
        """
        table, s = self.table, self.s
        of_b, of_a = table.A(self.j), table.A(self.i)
        if len(self.a) < 3:
            f = np.cross(s, np.eye(3)[int(np.argmin(np.abs(s)))])
            f /= np.linalg.norm(f)
            h = of_b.T @ of_a @ f
            return table.arm(self.i, f), table.arm(self.i, np.cross(s, f)), table.arm(self.j, h)
        h = self.b[2].r0 - self.b[0].r0
        target = of_a.T @ of_b @ h
        given = self.a[2].r0 - self.a[0].r0
        across = given - (given @ s) * s
        gamma = math.atan2(s @ np.cross(across, target), across @ target)
        B = math.cos(gamma) * (np.eye(3) - np.outer(s, s)) + math.sin(gamma) * tilde(s)
        B = B / np.linalg.norm(across)
        f = table.between(self.a[0], self.a[2], B)
        g = table.between(self.a[0], self.a[2], tilde(s) @ B)
        return f, g, table.between(self.b[0], self.b[2], np.eye(3) / np.linalg.norm(h))

    def stroke(self) -> np.ndarray:
        """The measure of the stroke, 0 at t = 0."""
        return self.table.product(self.gap, self.arm_of(self.a), constant=self.slide)


def _coincident(arms):
    return [(name, True, arms.table.product(arms.gap, arms.table.axis(k))) for k, name in enumerate("xyz")]


def _parallel(arms):
    other = arms.arm_of(arms.b)
    return [
        (f"axes parallel, {word}", False, arms.table.product(other, across))
        for word, across in zip(("1st", "2nd"), arms.across(), strict=True)
    ]


def _on_axis(arms):
    return [
        (f"{arms.b[0].name} on the axis, {word}", True, arms.table.product(arms.gap, across))
        for word, across in zip(("1st", "2nd"), arms.across(), strict=True)
    ]


def _no_turn(arms):
    _, g, h = arms.turning()
    return [("angle about the axis", False, arms.table.product(g, h))]


def _right_angle(arms):
    return [("arms at right angles", False, arms.table.product(arms.arm_of(arms.a), arms.arm_of(arms.b)))]


def _thread(arms):
    record = arms.stroke()
    return [("slide and turn", True, arms.table.add_angle(record, -arms.joint.size, *arms.turning()))]


def _distance(arms):
    L = arms.joint.size
    return [("distance", True, arms.table.product(arms.gap, arms.gap, 0.5 / L, 0.5 * L))]


def _in_plane(arms):
    return [("in the plane across the axis", True, arms.stroke())]


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


def add_joints(table: MeasureTable, mechanism: FlexibleMechanism) -> None:
    """The equations of joints and pins."""
    for joint in mechanism.joints:
        arms = JointArms(table, joint)
        parts = [part for make in EQUATIONS_OF[joint.kind] for part in make(arms)]
        table.equations(joint.name, joint.place, arms.i, arms.j, parts)
    for pin in mechanism.pins:
        target = table.arm(NONE, pin.target)
        gap = table.point(pin.point), target
        records = [table.product(gap, table.axis(k)) for k in range(3)]
        for record, law in zip(records, pin.laws, strict=True):
            record["law"] = NONE if law is None else table.law(law)
        parts = [("xyz"[k], True, records[k]) for k in range(3) if pin.directions[k]]
        table.equations(pin.name, pin.place, NONE, pin.point.body, parts)


def add_motions(table: MeasureTable, mechanism: FlexibleMechanism) -> None:
    """The equations of prescribed motions, one each.  Raises ModelError where turns have no meaning."""
    _refuse_two_turns(mechanism.motions)
    for motion in mechanism.motions:
        if motion.kind in ("ANGL", "STRK"):
            arms = JointArms(table, mechanism.joints[motion.target])
            i, j = arms.i, arms.j
            is_length = motion.kind == "STRK"
            record = arms.stroke() if is_length else table.angle(*arms.turning(), motion.law.at(0.0)[0])
        else:
            i, j, is_length = NONE, motion.target, motion.kind in TRANSLATIONS
            record = _body_motion(table, mechanism, motion)
        record["law"] = table.law(motion.law)
        name = "stroke" if is_length else "angle"
        table.equations(motion.name, motion.place, i, j, [(name, is_length, record)])


def _body_motion(table, mechanism, motion: Motion):
    if motion.kind in TRANSLATIONS:
        origin = table.arm(motion.target, np.zeros(3)), table.arm(NONE, np.zeros(3))
        return table.product(origin, table.axis(TRANSLATIONS.index(motion.kind)))
    own = _node_axes(mechanism.bodies[motion.target])
    about = ROTATIONS.index(motion.kind)
    spin = _spin(mechanism.motions, motion.target)
    after, last = (about + 1) % 3, (about + 2) % 3
    if about == spin:
        near = motion.law.at(0.0)[0]
        return table.angle(table.axis(after), table.axis(last), table.arm(motion.target, own[after]), near)
    # A small turn φ about `about` moves the axis of spin by φ along ±the third axis.
    sign = -1.0 if (spin + 1) % 3 == about else 1.0
    third = 3 - about - spin
    return table.product(table.arm(motion.target, own[spin]), table.axis(third), sign)


def _node_axes(body):
    """The axes of the node table in body axes, one a row."""
    return body.flexible.axes if body.flexible else np.eye(3)


def _is_zero(law):
    return law.kind == POLYNOMIAL and not any(law.c)


def _spin(motions, body):
    """The axis a body is turned about: that of the only rotation that is not held at 0."""
    own = [motion for motion in motions if motion.target == body and motion.kind in ROTATIONS]
    turned = [motion for motion in own if not _is_zero(motion.law)]
    return ROTATIONS.index((turned or own[-1:])[0].kind)


def _refuse_two_turns(motions):
    faults = []
    for body in {motion.target for motion in motions if motion.kind in ROTATIONS}:
        turned = [m for m in motions if m.target == body and m.kind in ROTATIONS and not _is_zero(m.law)]
        for motion in turned[1:]:
            message = (
                f"{turned[0].kind} and {motion.kind} both turn body {body + 1}; one axis can be turned about "
                "while the others are held at 0; prescribe two turns by joints with ANGL"
            )
            faults.append(Fault("error", message, motion.place, motion.name, id="MODEL-001"))
    if faults:
        raise ModelError(faults)


def spring_measure(table: MeasureTable, joint: PointJoint) -> np.ndarray:
    """The stroke of a translational joint, the angle of the others."""
    arms = JointArms(table, joint)
    return arms.stroke() if joint.kind == "translational" else table.angle(*arms.turning())


def reaction_point(joint: PointJoint) -> NodePoint:
    """Return where the reaction of a joint acts: its first point on body b."""
    return joint.b[0]
