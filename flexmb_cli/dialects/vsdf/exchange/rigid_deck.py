"""A rigid model as a VSDF deck, in free form, every number with all of its digits."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from ....deck.units import Units
from ....model.exchange.function_cards import FunctionCards, without_card
from ....model.exchange.functions import points_of, polynomial_of, simple, value_of, without_jumps
from ....model.exchange.rigid_model import Refusals, RigidBody, RigidJoint, RigidModel, across, notes_of
from ....model.integrators import METHODS
from ....model.joints import ANGLE
from ....model.mechanism import GROUND
from ....model.shapes import KINDS, ShapeCard
from ....model.time_functions import POLYNOMIAL, SINE, SPIN_UP, TABLE
from ...elements_block.writer import BlockWriter, block, numbers
from ..cards import BY_WORD, FINAL, SHAPES
from ..joints import BY_WORD as JOINTS
from ..motions import BY_FUNCTION, RATE_BY_FUNCTION

_WORDS = {kind.name: (word, kind) for word, kind in JOINTS.items()}
_DIRECTIONS = ("TRAX", "TRAY", "TRAZ", "ROTX", "ROTY", "ROTZ")
_SHAPES = dict(zip(KINDS, SHAPES, strict=True))
_AT_REST = 1e-12  # rad or m
_MOVE = "lay the origin of the body where the coordinate is 0"
FIRST_FUNCTION = 1001  # numbers of tables are smaller: functions have none of theirs
_BEYOND = 1e-9  # of the largest moment of inertia


def rigid_deck(model: RigidModel, title: str, units: Units) -> str:
    """Return the deck's text; raises ModelError with all that VSDF does not know."""
    deck = _Deck(model)
    elements = deck.element_lines()  # nodes of their ends are cards
    cards = deck.cards()
    deck.refusals.raise_faults()
    lines = [
        f"VSDF {title}",
        f"* Units: {units.reported}.",
        *(f"* {note}." for note in (*model.notes, *notes_of(model.shapes))),
    ]
    for word, records in cards:
        if records:
            lines += [word, *records]
    lines += block([*deck.function_lines(), *elements])
    return "\n".join([*lines, *(word.strip() for word in FINAL), ""])


class _Deck(BlockWriter):
    """Collects nodes and tables while the cards are made."""

    dialect, function_id = "VSDF", "VSDF-170"
    reserved = frozenset(card.section for card in BY_WORD.values())

    def __init__(self, model: RigidModel):
        self.model, self.refusals = model, Refusals()
        self.functions = FunctionCards(FIRST_FUNCTION)
        # Nodes on axes are as far from joints as joints from the origins of their bodies.
        points = [P for joint in model.joints for P in (joint.P_i, joint.P_j)]
        self.arm = float(max((np.linalg.norm(P) for P in points), default=0.0)) or 1.0
        self.nodes: dict[tuple[Any, ...], int] = {}
        self.tables: list[str] = []
        self.table_count = 0

    def coordinate(self, joint: int, coordinate: str) -> str:
        """Return the spelling of a coordinate."""
        return f"{joint + 1}.{coordinate}"

    def joint(self, joint: int) -> int:
        """Return the number of a joint in the deck."""
        return joint + 1

    def end(self, body: int, point: Any) -> str:
        """Return the spelling of an end: a point of the ground, or a node."""
        return f"0({numbers(point, ',')})" if body == GROUND else f"{body + 1}:{self._node(body, point)}"

    def cards(self) -> list[Any]:
        """Words of cards and their records, in the order of the deck."""
        model, integrator = self.model, self.model.integrator
        bodies = [self._body(k) for k in range(len(model.bodies))]
        joints = [self._joint(n, joint) for n, joint in enumerate(model.joints, start=1)]
        others = [
            ("JOIN", joints),
            ("MOTN", self._motions()),
            ("FORC", self._forces()),
            ("TORQ", self._torques()),
            ("GRAV", [_record(*model.gravity)]),
            ("TIME", [_record(model.time.end, model.time.step, integrator.step)]),
            ("INTG", [_record(integrator.method, *self._parameters())]),
            ("OUTN", [_record(p.body + 1, self._node(p.body, p.s)) for p in model.points]),
        ]
        nodes = [_record(body + 1, number, *place) for (body, *place), number in self.nodes.items()]
        numbered = range(1, len(bodies) + 1)
        return [
            ("BODY", [_record(k, "RIGD") for k in numbered]),
            ("RIGI", [line for body in bodies for line in body["RIGI"]]),
            *((word, [body[word] for body in bodies if body[word]]) for word in ("POSI", "EULP", "VELO")),
            ("NODE", nodes),
            ("TABL", self.tables),
            *others,
            ("GEOM", [_shape(shape) for shape in model.shapes if not shape.file]),
            ("GSTL", [line for shape in model.shapes if shape.file for line in _file(shape)]),
        ]

    def _parameters(self) -> tuple[Any, ...]:
        integrator = self.model.integrator
        if METHODS[integrator.method].radius is None:
            return (integrator.tolerance,)
        return integrator.radius, "", integrator.tolerance

    def _body(self, k: int) -> dict[Any, Any]:
        body = self.model.bodies[k]
        self._check_mass(body)
        velocity = (*body.velocity, *(body.A.T @ body.omega))
        return {
            "RIGI": [_record(k + 1, body.mass, *body.centre), _record(*body.moments)],
            "POSI": _record(k + 1, *body.r),
            "EULP": _record(k + 1, *body.p),
            "VELO": _record(k + 1, *velocity) if any(velocity) else "",
        }

    def _check_mass(self, body: RigidBody) -> None:
        moments = np.linalg.eigvalsh(body.inertia)
        if not body.mass > 0:
            self.refusals.add(body, "a VSDF body needs a mass above zero", id="VSDF-171")
        elif moments[2] > moments[0] + moments[1] + _BEYOND * moments[2]:
            message = "the largest principal moment of inertia exceeds the sum of the others: no VSDF body"
            self.refusals.add(body, message, id="VSDF-173")

    def _node(self, body: int, place: Any) -> Any:
        """Number of the node at a place of a body."""
        key = (body, *(float(x) + 0.0 for x in place))
        if key not in self.nodes:
            self.nodes[key] = 1 + sum(1 for other in self.nodes if other[0] == body)
        return self.nodes[key]

    def _joint(self, number: int, joint: RigidJoint) -> Any:
        if joint.kind not in _WORDS:
            self.refusals.add(joint, f"VSDF has no {joint.kind} joint", id="VSDF-174")
            return ""
        word, kind = _WORDS[joint.kind]
        a, b = self._ends(joint)
        a, b = [*a[: kind.points_on("i")], "", "", ""], [*b[: kind.points_on("j")], "", "", ""]
        bodies = joint.i + 1, joint.j + 1
        return _record(
            number, word, bodies[0], a[0], a[1], bodies[1], b[0], b[1], a[2], b[2],
            *([joint.size] if kind.size else []),
        )  # fmt: skip

    def _ends(self, joint: RigidJoint) -> Any:
        """Nodes P, Q, H on both bodies, as many as there are directions."""
        (_, kind), model = _WORDS[joint.kind], self.model
        on_i, on_j = kind.points_on("i"), kind.points_on("j")
        if joint.kind == "fixed":
            axis = np.eye(3)[2]
            along = {body: model.axes(body).T @ axis for body in (joint.i, joint.j)}
        else:
            axis = model.axis(joint) if on_i > 1 else None
            along = {joint.i: np.array(joint.s_i), joint.j: np.array(joint.s_j)}
        ends = []
        for body, P, count in ((joint.i, joint.P_i, on_i), (joint.j, joint.P_j, on_j)):
            places = [np.array(P)]
            if count > 1:
                places.append(places[0] + self.arm * along[body] / np.linalg.norm(along[body]))
            if count > 2:
                places.append(places[0] + self.arm * (model.axes(body).T @ across(axis)))
            ends.append([self._node(body, place) for place in places])
        return ends

    def _motions(self) -> list[Any]:
        motions: list[tuple[Any, str, int]] = []
        turned = [item.body for item in self.model.drivers if item.direction > 3]
        for item in self.model.drivers:
            if item.direction > 3 and turned.count(item.body) > 1:
                self.refusals.add(item, "VSDF turns a body about one axis only", id="VSDF-175")
            motions.append((item, _DIRECTIONS[item.direction - 1], item.body + 1))
        for driver in self.model.joint_drivers:
            word = "ANGL" if driver.coordinate == ANGLE else "STRK"
            motions.append((driver, word, driver.joint + 1))
        return [
            _record(n, word, target, *self._function(item))
            for n, (item, word, target) in enumerate(motions, start=1)
        ]  # fmt: skip

    def _function(self, item: Any) -> Any:
        function = simple(item.function)
        c = polynomial_of(function)
        if c is not None and len(c) <= 4:
            return (POLYNOMIAL, *c, *[0.0] * (4 - len(c)))
        if function.kind in (SINE, SPIN_UP):
            return function.kind, *function.c
        if function.kind == TABLE:
            return TABLE, float(self._table(list(zip(function.times, function.values, strict=True))))
        number, rate = self.functions.driver(function)
        if not number:
            self.refusals.add(item, without_card(function, "VSDF"), id="VSDF-170")
        elif rate and abs(start := function.at(0.0)[0]) > _AT_REST:
            message = f"it begins at {start:.6g} and follows an integral; VSDF begins integrals at 0: {_MOVE}"
            self.refusals.add(item, message, id="VSDF-176")
        return RATE_BY_FUNCTION if rate else BY_FUNCTION, float(number)

    def _table(self, points: Sequence[tuple[float, float]]) -> Any:
        self.table_count += 1
        self.tables += [_record(self.table_count, float(t), float(v)) for t, v in points]
        return self.table_count

    def _factor(self, function: Any, item: Any) -> tuple[Any, Any]:
        """A constant factor, and the number of a table."""
        value = value_of(function)
        if value is not None:
            return value, 0
        points = points_of(function)
        if points is None:
            return 1.0, self.function_number(function, item)
        return 1.0, self._table(without_jumps(points))

    def _forces(self) -> Any:
        lines = []
        for item in self.model.forces:
            factor, table = self._factor(item.factor, item)
            force = [factor * x for x in item.force]
            lines.append(_record(item.body + 1, self._node(item.body, item.point), *force,
                                 int(item.following), table))  # fmt: skip
        return lines

    def _torques(self) -> Any:
        lines = []
        for item in self.model.torques:
            factor, table = self._factor(item.factor, item)
            torque = [factor * x for x in item.torque]
            lines.append(_record(item.body + 1, *torque, int(item.following), table))
        return lines


def _shape(shape: ShapeCard) -> str:
    return _record(shape.body + 1, _SHAPES[shape.kind], *shape.sizes, *shape.offset, *shape.angles)


def _file(shape: ShapeCard) -> tuple[str, str]:
    return _record(shape.body + 1, shape.unit, *shape.offset, *shape.angles), f" {shape.file}"


def _record(*values: Any) -> str:
    """Return a record in free form; the blank in front keeps a word from being read as a keyword."""
    return "    " + ",".join(str(x) if isinstance(x, str | int) else repr(float(x) + 0.0) for x in values)
