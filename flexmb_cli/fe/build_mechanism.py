"""VsdfModel → FlexibleMechanism: bodies reduced, nodes turned into points with shapes in body axes."""

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from ..deck.lazy import Made
from ..errors import Fault, ModelError, Place
from ..model.fe_model import BodyTorque, End, NodeForce, NodeJoint, Pin, VsdfBody, VsdfModel
from ..model.flexible_body import FlexibleInput
from ..model.flexible_mechanism import (
    FlexibleMechanism,
    FloatingBody,
    NodePoint,
    PointForce,
    PointJoint,
    PointPin,
)
from ..model.general_joints import GeneralJoint
from ..model.laws import Element, Frames, Line, Push, Touch
from ..model.mechanism import GROUND
from ..model.vectors import euler_parameters
from .flexible_bodies import flexible_body

STEPS_A_PERIOD = 20
MANY_PARTS = 10_000  # of a type: as many points, each a kilobyte, are kept


def flexible_mechanism(model: VsdfModel, cached: bool = True) -> tuple[FlexibleMechanism, list[Fault]]:
    """The mechanism of `model`, and what was doubtful about its finite-element files.

    Raises ModelError with the faults of all bodies.
    """
    flexible, faults = {}, []
    for k, body in enumerate(model.bodies):
        if body.flexible is None:
            continue
        try:
            flexible[k], warnings = _flexible_body(body, body.flexible, cached)
            faults += warnings
        except ModelError as stopped:
            faults += stopped.faults
    if any(fault.severity == "error" for fault in faults):
        raise ModelError(faults)
    faults += _step_warnings(model, flexible.values())
    bodies = _all_bodies(model.bodies, flexible)
    stresses = _stresses(model, bodies)
    return replace(_Points(model, bodies).mechanism(), stresses=stresses, shapes=model.shapes), faults


def _all_bodies(given: Sequence[VsdfBody], flexible: dict[int, FloatingBody]) -> Sequence[FloatingBody]:
    """Return all bodies, given the flexible ones by their numbers; many are made when they are looked at."""

    def made(k: int) -> FloatingBody:
        return flexible[k] if k in flexible else _rigid_body(given[k])

    numbers = range(len(given))
    return Made(numbers, made) if len(given) > MANY_PARTS else tuple(map(made, numbers))


def _stresses(model: VsdfModel, bodies: Any) -> Any:
    """Return what is reported of stresses; most decks ask for none, and need no elements."""
    if not model.stresses:
        return ()
    from .elements.stress_shapes import stress_outputs

    return stress_outputs(model, bodies)


def _step_warnings(model: VsdfModel, bodies: Iterable[FloatingBody]) -> Iterator[Fault]:
    """A step that is longer than a twentieth of the shortest period retained damps or distorts it."""
    for body in bodies:
        highest = body.flexible.frequencies.max(initial=0.0) if body.flexible else 0.0
        if highest and model.integrator.step > 1 / (STEPS_A_PERIOD * highest):
            message = (
                f"a step of {model.integrator.step:g} s is longer than 1/{STEPS_A_PERIOD} of the period of "
                f"the highest mode, {1 / highest:.3g} s; take a step of at most "
                f"{1 / (STEPS_A_PERIOD * highest):.2g} s, or fewer modes"
            )
            yield Fault("warning", message, model.time.place, body.name, id="FE-007")


def _flexible_body(given: VsdfBody, content: FlexibleInput, cached: bool) -> tuple[FloatingBody, list[Fault]]:
    reduced, warnings = flexible_body(content, cached)
    pose = np.array(given.r) + given.A @ reduced.origin, euler_parameters(given.A @ reduced.axes)
    return _body(given, pose, reduced.m, reduced.s0, reduced.J0, reduced, given.stiffened), warnings


def _rigid_body(given: VsdfBody) -> FloatingBody:
    assert given.rigid is not None, "a body is flexible or rigid"
    m, c = given.rigid.mass, np.array(given.rigid.centre)
    about_origin = given.rigid.inertia + m * (c @ c * np.eye(3) - np.outer(c, c))
    return _body(given, (np.array(given.r), np.array(given.p)), m, m * c, about_origin)


def _body(given: VsdfBody, pose: tuple[np.ndarray, np.ndarray], *inertia: Any) -> FloatingBody:
    motion = np.array(given.velocity), np.array(given.omega)
    places: dict[str, Any] = {"place": given.place, "velocity_place": given.velocity_place}
    return FloatingBody(given.name, *pose, *motion, *inertia, **places)


def _turns_against(bushing: Element) -> bool:
    """Return whether a bushing has stiffness or damping about axes."""
    return any(any(bushing[name]) for name in ("kr", "cr"))


class _Points:
    """The model's ends as points of the bodies built."""

    def __init__(self, model: VsdfModel, bodies: Sequence[FloatingBody]):
        self.model = model
        self.bodies = bodies
        self.points: dict[End, NodePoint] = {}

    def mechanism(self) -> FlexibleMechanism:
        """The mechanism, item by item."""
        model = self.model
        return FlexibleMechanism(
            self.bodies,
            model.time,
            model.integrator,
            model.gravity,
            self._all(self._joint, model.joints),
            self._all(self._pin, model.pins),
            model.motions,
            self._all(self._force, model.forces),
            tuple(replace(item, at=self._turning(item)) for item in model.torques),
            tuple(map(self._spring, model.springs)),
            self._all(self.point, model.outputs),
            elements=self._elements(),
        )

    def _all(self, make: Callable[[Any], Any], items: Sequence[Any]) -> Sequence[Any]:
        """Return what `make` makes of each item, at once or, of many items, when it is looked at."""
        return Made(items, make) if len(items) > MANY_PARTS else tuple(map(make, items))

    def point(self, end: End) -> NodePoint:
        """The point of an end, one for all that are attached there: a deck may have 200,000 loads."""
        if end not in self.points:
            if len(self.points) > MANY_PARTS:
                self.points.clear()
            self.points[end] = self._point(end)
        return self.points[end]

    def _point(self, end: End) -> NodePoint:
        """The point of an end; that of a node set is the mean of its nodes."""
        if end.body == GROUND:
            return NodePoint(
                f"ground node {end.node}", GROUND, self.model.global_position(end), np.zeros((3, 0))
            )
        body, given = self.bodies[end.body], self.model.bodies[end.body]
        name = f"{body.name} node {end.node}"
        if body.flexible is None:
            return NodePoint(name, end.body, given.position(end.node), np.zeros((3, 0)))
        members = given.members(end.node)
        if len(members) == 1:
            return self._node(name, end, given, members[0])
        r0 = np.mean([body.flexible.position(node) for node in members], axis=0)
        shape = np.mean([body.flexible.shape(node) for node in members], axis=0)
        return NodePoint(name, end.body, r0, shape)

    def _node(self, name: str, end: End, given: VsdfBody, node: int) -> NodePoint:
        """The point of a node, or of an arm on it, which turns where the matrices have its rotations."""
        body, arm = self.bodies[end.body].reduced, given.arms.get(end.node)
        try:
            r0, shape, turn = body.position(node), body.shape(node), body.rotation(node)
        except KeyError:
            message = f"the matrices have no rows of all three displacements of node {node}; take another"
            raise ModelError([Fault("error", message, given.place, given.name, id="MODEL-060")]) from None
        if arm is None:
            return NodePoint(name, end.body, r0, shape, turn)
        if turn is None:
            message = (
                f"the matrices have no rotations of node {node} (components 4, 5, 6), which would turn arm "
                f"{end.node}; take nodes, or matrices with them"
            )
            raise ModelError([Fault("error", message, arm.place, given.name, id="MODEL-061")])
        offset = body.axes.T @ arm.offset
        return NodePoint(name, end.body, r0 + offset, shape, turn, offset)

    def _turning(self, item: BodyTorque) -> NodePoint | None:
        """The point on whose rotation a torque acts."""
        if item.at is None:
            return None
        point = self.point(item.at)
        self._check_turning(point, item.name, item.place)
        return point

    def _check_turning(self, point: NodePoint, owner: str, place: Place | None) -> None:
        if point.body != GROUND and self.bodies[point.body].flexible and point.turn is None:
            message = (
                f"{point.name} does not turn: the matrices of its body have no rotations there (components "
                "4, 5, 6); give a pair of forces, or several elements at nodes apart"
            )
            raise ModelError([Fault("error", message, place, owner, id="MODEL-062")])

    def _elements(self) -> Any:
        """The elements between nodes as such between points."""
        given = self.model.elements
        if not given:
            return given
        curves = tuple(replace(c, P_i=self.point(c.P_i), P_j=self.point(c.P_j)) for c in given.curves)
        rolls = tuple(replace(r, P_i=self.point(r.P_i), P_j=self.point(r.P_j)) for r in given.rolls)
        generals, later = (tuple(map(self._joined, joints)) for joints in (given.generals, given.later))
        forces = tuple(map(self._attached, given.forces))
        return replace(given, forces=forces, curves=curves, rolls=rolls, generals=generals, later=later)

    def _joined(self, item: Any) -> Any:
        """Return a general joint between points; a motion, which may be caught later, as it is."""
        if not isinstance(item, GeneralJoint):
            return item
        return replace(item, P_i=self.point(item.P_i), P_j=self.point(item.P_j))

    def _attached(self, item: Element) -> Element:
        ends = item.measure
        if not isinstance(ends, Line | Frames | Push | Touch):
            return item
        ends = ends._replace(P_i=self.point(ends.P_i), P_j=self.point(ends.P_j))
        turns = isinstance(ends, Push) and ends.turning
        if turns or (isinstance(ends, Frames) and _turns_against(item)):
            for point in (ends.P_i, ends.P_j):
                if isinstance(point, NodePoint):
                    self._check_turning(point, item.name, item.place)
        if isinstance(ends, Touch):
            more = (tuple((i, self.point(P)) for i, P in more) for more in (ends.more_i, ends.more_j))
            ends = ends._replace(more_i=next(more), more_j=next(more))
        return replace(item, measure=ends)

    def _joint(self, joint: NodeJoint) -> PointJoint:
        a, b = (tuple(self.point(end) for end in side) for side in (joint.a, joint.b))
        return PointJoint(joint.name, joint.kind, a, b, joint.size, joint.place)

    def _pin(self, pin: Pin) -> PointPin:
        target = self.model.global_position(pin.end) if pin.point is None else np.array(pin.point)
        return PointPin(pin.name, self.point(pin.end), pin.directions, target, pin.place, pin.functions)

    def _force(self, force: NodeForce) -> PointForce:
        return PointForce(
            force.name, self.point(force.end), force.force, force.follows, force.factor, force.place
        )

    def _spring(self, spring: Element) -> Element:
        """The spring between points; its length at rest may be that at t = 0."""
        if math.isnan(spring["rest"]):
            a, b = map(self.model.global_position, (spring.measure.P_i, spring.measure.P_j))
            spring = spring.with_values(rest=float(np.linalg.norm(b - a)))
        return self._attached(spring)
