"""Rigid model of a YOUNG deck, in the terms of `model.exchange`: for conversion to other dialects."""

from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import Any

import numpy as np

from ....deck.record import Deck
from ....errors import Fault, ModelError
from ....model.arrays.dynamic import inertia_matrix
from ....model.arrays.kinematic import screw_values
from ....model.attitudes import Attitudes
from ....model.exchange.conversion import Conversion, End, Start, place_of, poses
from ....model.exchange.functions import constant
from ....model.exchange.rigid_model import BodyDriver, RigidBody, RigidJoint, RigidModel, shifted, vector
from ....model.joint_elements import Coupling
from ....model.loads import DynamicModel
from ....model.mechanism import GROUND, Driver, Point, Simplified, TimeGrid
from ....model.shapes import ShapeCard
from ....model.time_functions import POLYNOMIAL, MotionFunction
from ..dynamic_cards import analysis_of


def rigid_model(
    deck: Deck, build: Callable[[], DynamicModel], start: Callable[[DynamicModel], Start]
) -> RigidModel:
    """Return the rigid model of a deck at its start; raises ModelError with all that is not converted."""
    if analysis_of(deck) is None:
        message = (
            "the deck describes kinematics only, and other dialects need masses: add DYNAMICS forward and "
            "a card MASS for each moving body"
        )
        raise ModelError([Fault("error", message, id="YOUNG-150")])
    model = build()
    return _Conversion(model, start(model)).converted(model.mechanism.shapes, model.elements)


class _Conversion(Conversion):
    """Collects the parts, grounded bodies becoming the ground."""

    def __init__(self, model: DynamicModel, start: Start):
        super().__init__(start)
        self.deck, self.mechanism, self.t_start = model, model.mechanism, model.mechanism.time.start
        held = {ground.body for ground in self.mechanism.grounds}
        moving = [k for k in range(len(self.mechanism.bodies)) if k not in held]
        self.number = dict.fromkeys((GROUND, *held), GROUND) | {k: n for n, k in enumerate(moving)}
        self.moving = moving
        estimates = Attitudes(self.mechanism).estimates().reshape(-1, 7)
        # Joint coordinates are 0 in the estimates.
        self.first = poses(estimates[:, :3], estimates[:, 3:])
        self.joints: dict[int, int] = {}  # new numbers

    def model(self) -> RigidModel:
        deck, time = self.deck, self.mechanism.time
        self._refuse_foreign()
        return RigidModel(
            tuple(self._body(k) for k in self.moving),
            TimeGrid(0.0, time.end - time.start, time.step, time.place),
            vector(deck.gravity),
            self._joints(),
            self._drivers(),
            tuple(self.joint_drivers(deck.elements.drivers)),
            self._loads(deck.forces),
            self._loads(deck.torques),
            tuple(
                Point(p.name, self.number[p.body], vector(p.s), p.place)
                for p in self.mechanism.points if self.number[p.body] != GROUND
            ),
            self.deck.integrator,
            self._notes(),
            elements=self.elements((*deck.springs, *deck.elements.forces)),
            couplings=tuple(self.couplings(deck.elements.couplings)),
        )  # fmt: skip

    def end(self, body: int, point: Any) -> End:
        """Return a body there, and the point on it, global where the body is at rest."""
        number = self.number[body]
        if number != GROUND or body == GROUND:
            return number, place_of(point)
        r, A = self.now[body]
        return number, vector(r + A @ np.array(place_of(point)))

    def joint_of(self, joint: int) -> int | None:
        """Return the number of a joint there; None of one between grounded bodies."""
        return self.joints.get(joint)

    def joint_coordinate(self, item: Any, joint: int, coordinate: str) -> tuple[int, str, float] | None:
        """Return a joint and its coordinate there, with its value at the start."""
        if joint not in self.joints:
            if isinstance(item, Coupling):
                message = "a coupling of a joint between grounded bodies is not converted"
                self.refusals.add(item, message, id="YOUNG-163")
            return None
        given = self.mechanism.joints[joint]
        axis = given.s_i, given.P_i, given.P_j
        return self.joints[joint], coordinate, self.coordinate_since(coordinate, axis, given.i, given.j)

    def _loads(self, items: Iterable[Any]) -> tuple[Any, ...]:
        """Forces, or torques, on bodies that move."""
        return tuple(
            replace(item, body=self.number[item.body], factor=self.function(item.factor))
            for item in items
            if self.number[item.body] != GROUND
        )

    def shape(self, card: ShapeCard) -> ShapeCard:
        """Return a shape on its new body; that of a grounded body lies on the ground."""
        number = self.number[card.body]
        if number != GROUND or card.body == GROUND:
            return replace(card, body=number)
        return shifted(card, GROUND, *self.now[card.body])

    def _refuse_foreign(self) -> None:
        for item in self.mechanism.distances:
            self.refusals.add(
                item, "differences of single coordinates (NSIMP2) are not converted", id="YOUNG-166"
            )

    def _notes(self) -> tuple[Any, ...]:
        notes = []
        if self.mechanism.time.start:
            notes.append(f"t = 0 is {self.mechanism.time.start!r} s of the other deck")
        if self.moving != list(range(len(self.mechanism.bodies))):
            pairs = ", ".join(f"{n} is {k + 1}" for n, k in enumerate(self.moving, start=1))
            notes.append(f"bodies here and there: {pairs}; the ground is not a body")
        return tuple(notes)

    def _body(self, k: int) -> RigidBody:
        body = self.mechanism.bodies[k]
        mass = next((item for item in self.deck.masses if item.body == k), None)
        data = (
            (mass.mass, np.array(mass.centre, float), inertia_matrix(mass.inertia))
            if mass
            else (0.0, np.zeros(3), np.zeros((3, 3)))
        )
        return self.rigid_body(k, f"body {k + 1}", data, body.place)

    def _direction(self, body: int, s: tuple[float, float, float]) -> Any:
        if self.number[body] != GROUND or body == GROUND:
            return vector(s)
        return vector(self.now[body][1] @ np.array(s))

    def _joints(self) -> tuple[Any, ...]:
        rigid_joints: list[Any] = []
        for k, joint in enumerate(self.mechanism.joints):
            pitch = joint.pitch
            if pitch:  # YOUNG counts the distance of the points, others the advance of P_j
                pitch *= screw_values(self.mechanism, joint)["sense"]
            self._add_joint(rigid_joints, joint, joint.kind, pitch, k)
        for item in self.deck.elements.composites:
            if item.kind == "revolute-cylindrical":
                self.refusals.add(item, "a joint revcyl is not converted", id="YOUNG-167")
            else:
                self._add_joint(rigid_joints, item, item.kind, item.size, None)
        return tuple(rigid_joints)

    def _add_joint(
        self, rigid_joints: list[RigidJoint], joint: Any, kind: str, size: float, k: int | None
    ) -> None:
        i, j = self.number[joint.i], self.number[joint.j]
        if i == GROUND == j:
            return
        if k is not None:
            self.joints[k] = len(rigid_joints)
        ends = self.end(joint.i, joint.P_i)[1], self.end(joint.j, joint.P_j)[1]
        axes = self._direction(joint.i, joint.s_i), self._direction(joint.j, joint.s_j)
        rigid_joints.append(RigidJoint(joint.name, kind, i, j, *ends, *axes, size, joint.place))

    def _drivers(self) -> tuple[Any, ...]:
        """Drivers, and coordinates that are held, of bodies that move."""
        elements = self.deck.elements
        driven = {item.item: item.function for item in elements.driven}
        supported = {item.item: item.function for item in elements.supports}
        driven_parts: list[tuple[Driver | Simplified, MotionFunction]] = []
        for n, driver in enumerate(self.mechanism.drivers):
            prescribed = MotionFunction(POLYNOMIAL, (driver.C, driver.B, 0.5 * driver.A, 0.0))
            driven_parts.append((driver, driven.get(n) or prescribed))
        for n, held in enumerate(self.mechanism.simplified):
            if held.direction > 3:
                self.refusals.add(
                    held, "a held Euler parameter (directions 4 to 6) is not converted", id="YOUNG-168"
                )
            driven_parts.append((held, supported.get(n) or constant(held.value)))
        return tuple(
            BodyDriver(item.name, self.number[item.body], item.direction, self.function(function), item.place)
            for item, function in driven_parts
            if self.number[item.body] != GROUND
        )
