"""Rigid model of a VSDF deck, in the terms of `model.exchange`."""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from ....deck.record import Deck
from ....errors import Fault, ModelError
from ....model.exchange.conversion import STILL, Conversion, Start, about_centre
from ....model.exchange.functions import constant
from ....model.exchange.rigid_model import BodyDriver, RigidBody, RigidJoint, RigidModel, vector
from ....model.flexible_mechanism import FlexibleMechanism, PointJoint
from ....model.integrators import METHODS, Integrator
from ....model.joint_elements import JointDriver
from ....model.joints import ANGLE, STROKE
from ....model.loads import AppliedForce, AppliedTorque
from ....model.mechanism import GROUND, Point
from ....model.vectors import rotation_matrix

_DIRECTIONS = {word: n for n, word in enumerate(("TRAX", "TRAY", "TRAZ", "ROTX", "ROTY", "ROTZ"), start=1)}
_COORDINATES = {"ANGL": ANGLE, "STRK": STROKE}
_TOLERANCE = 1e-9  # of a deck whose method has a radius and gives none


def rigid_model(
    deck: Deck, build: Callable[[], FlexibleMechanism], start: Callable[[FlexibleMechanism], Start]
) -> RigidModel:
    """Return the rigid model of a deck at its start; raises ModelError with all that is not converted."""
    flexible = [record for record in deck.section("body") if record["kind"] == "FLEX"]
    message = "the body is flexible (FLEX); only rigid bodies are converted"
    if flexible:
        raise ModelError([Fault("error", message, r.place, r.subject, id="VSDF-152") for r in flexible])
    mechanism = build()
    return _Conversion(mechanism, start(mechanism)).converted(mechanism.shapes, mechanism.elements)


class _Conversion(Conversion):
    """Collects the parts of the model; the ground is the last of the poses."""

    def __init__(self, mechanism: FlexibleMechanism, start: Start):
        super().__init__(start)
        self.deck = mechanism
        self.first = [*((body.r, rotation_matrix(body.p)) for body in mechanism.bodies), STILL]

    def model(self) -> RigidModel:
        deck = self.deck
        joints = [self._joint(joint) for joint in deck.joints]
        drivers = [item for item in deck.motions if item.kind in _DIRECTIONS]
        self._refuse_several_rotations(drivers)
        for pin in deck.pins:
            if any(pin.functions):
                self.refusals.add(pin, "supports that move are not converted", id="VSDF-179")
        pins, held = self._pins()
        return RigidModel(
            tuple(self._body(k) for k in range(len(deck.bodies))),
            deck.time,
            vector(deck.gravity),
            (*joints, *pins),
            (*(_body_driver(motion) for motion in drivers), *held),
            tuple(
                self.joint_drivers(
                    JointDriver(m.name, m.target, _COORDINATES[m.kind], m.function, m.place)
                    for m in deck.motions
                    if m.kind in _COORDINATES
                )
            ),
            tuple(
                AppliedForce(f.name, f.point.body, vector(f.force), vector(f.point.r0), f.follows, f.factor,
                             f.place)
                for f in deck.forces
            ),
            tuple(
                AppliedTorque(t.name, t.body, vector(t.torque), t.follows, t.factor, t.place)
                for t in deck.torques
            ),
            tuple(Point(p.name, p.body, vector(p.r0)) for p in deck.outputs if p.body != GROUND),
            self._integrator(),
            elements=self.elements((*deck.springs, *deck.elements.forces)),
            couplings=deck.elements.couplings,
        )  # fmt: skip

    def _integrator(self) -> Integrator:
        integrator = self.deck.integrator
        method = METHODS[integrator.method]
        if method.radius is None or integrator.tolerance != method.tolerance:
            return integrator
        return replace(integrator, tolerance=_TOLERANCE)

    def joint_coordinate(self, item: Any, joint: int, coordinate: str) -> tuple[int, str, float]:
        """Return the same joint and coordinate, and its value at the start."""
        given = self.deck.joints[joint]
        bodies, s = (given.a[0].body, given.b[0].body), given.a[1].r0 - given.a[0].r0
        axis = s, given.a[0].r0, given.b[0].r0
        return joint, coordinate, self.coordinate_since(coordinate, axis, *bodies)

    def _body(self, k: int) -> RigidBody:
        body = self.deck.bodies[k]
        c = body.s0 / body.m
        return self.rigid_body(k, body.name, (body.m, c, about_centre(body.m, c, body.J0)), body.place)

    def _joint(self, joint: PointJoint) -> RigidJoint:
        i, j = joint.a[0].body, joint.b[0].body
        P_i, P_j = joint.a[0].r0, joint.b[0].r0
        s_i, s_j = (ends[1].r0 - ends[0].r0 if len(ends) > 1 else np.zeros(3) for ends in (joint.a, joint.b))
        size = 0.0 if math.isnan(joint.size) else joint.size
        if joint.kind == "revolute-spherical":
            P_i, size = self._in_plane(i, j, P_i, P_j, s_i, size)
        ends = vector(P_i), vector(P_j), vector(s_i), vector(s_j)
        return RigidJoint(joint.name, joint.kind, i, j, *ends, size, joint.place)

    def _in_plane(self, i: int, j: int, P_i: Any, P_j: Any, s_i: Any, size: Any) -> tuple[Any, Any]:
        """Return the point of the axis in the plane of P_j, which VSDF keeps beside P_i, and its distance."""
        s = s_i / np.linalg.norm(s_i)
        (r_i, A_i), (r_j, A_j) = self.now[i], self.now[j]
        beside = (r_j + A_j @ P_j - r_i - A_i @ P_i) @ (A_i @ s)
        return P_i + beside * s, math.sqrt(size * size - beside * beside)

    def _pins(self) -> tuple[Any, Any]:
        """Joints with the ground, and held coordinates of origins."""
        joints, held = [], []
        for pin in self.deck.pins:
            body, r0 = pin.point.body, pin.point.r0
            if all(pin.directions):
                ends = vector(pin.target), vector(r0)
                joints.append(RigidJoint(pin.name, "spherical", GROUND, body, *ends, place=pin.place))
            elif np.any(r0):
                message = "a pin of some directions is converted at the origin of its body only"
                self.refusals.add(pin, message, id="VSDF-180")
            else:
                held += [
                    BodyDriver(pin.name, body, axis + 1, constant(float(pin.target[axis])), pin.place)
                    for axis in range(3)
                    if pin.directions[axis]
                ]
        return joints, held

    def _refuse_several_rotations(self, drivers: Any) -> None:
        turned = [item.target for item in drivers if _DIRECTIONS[item.kind] > 3]
        for item in drivers:
            if _DIRECTIONS[item.kind] > 3 and turned.count(item.target) > 1:
                self.refusals.add(
                    item, "several rotations of one body (ROTX, ROTY, ROTZ) are not converted", id="VSDF-181"
                )


def _body_driver(motion: Any) -> BodyDriver:
    return BodyDriver(motion.name, motion.target, _DIRECTIONS[motion.kind], motion.function, motion.place)
