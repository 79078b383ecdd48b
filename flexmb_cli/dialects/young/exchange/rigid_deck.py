"""A rigid model as a YOUNG deck with DYNAMICS forward, every number with all of its digits."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from ....deck.units import Units
from ....model.exchange.function_cards import FunctionCards
from ....model.exchange.functions import constant, polynomial_of, value_of
from ....model.exchange.rigid_model import Refusals, RigidJoint, RigidModel, across, notes_of
from ....model.mechanism import GROUND
from ....model.shapes import KINDS, ShapeCard
from ...elements_block.writer import BlockWriter, block, numbers
from ..cards import CARDS
from ..integration_cards import LEAST_TOLERANCE, MOST_TOLERANCE
from ..sections import COUNT_OF, COUNTS, YOUNG_JOINTS, YOUNG_SECTIONS

_LINKS = {"revolute-spherical": "revsph", "spherical-spherical": "sphsph"}
_KIND = {"fixed": "revolute"}  # whose angle a driver holds


def rigid_deck(model: RigidModel, title: str, units: Units) -> str:
    """Return the deck's text; raises ModelError with all that YOUNG does not know."""
    deck = _Deck(model, units)
    lines = deck.lines()
    deck.refusals.raise_faults()
    notes = [title, f"Units: {units.reported}", *model.notes, *notes_of(model.shapes)]
    head = [f"{{ {note.replace('{', '(').replace('}', ')')} }}" for note in notes]
    return "\n".join([*head, *lines, ""])


class _Deck(BlockWriter):
    """Numbers joints and functions while the sections are made; the ground is the last body."""

    dialect, function_id = "YOUNG", "YOUNG-165"
    reserved = frozenset([*(section.name for section in YOUNG_SECTIONS), *(card.section for card in CARDS)])

    def __init__(self, model: Any, units: Units):
        self.model, self.refusals, self.units = model, Refusals(), units
        self.functions = FunctionCards()
        proper = [joint for joint in model.joints if joint.kind not in _LINKS]
        self.with_ground = any(GROUND in (joint.i, joint.j) for joint in proper)
        self.sorted = {
            kind.name: [joint for joint in proper if _KIND.get(joint.kind, joint.kind) == kind.name]
            for kind in YOUNG_JOINTS
        }
        unknown = [joint for joint in proper if _KIND.get(joint.kind, joint.kind) not in self.sorted]
        for joint in unknown:
            self.refusals.add(joint, f"YOUNG has no {joint.kind} joint", id="YOUNG-164")
        order = [joint for joints in (*self.sorted.values(), unknown) for joint in joints]
        self.joint_number = {id(joint): n for n, joint in enumerate(order, start=1)}

    def lines(self) -> list[Any]:
        """The numbers of the 1996 program, then the cards of dynamics."""
        model, time = self.model, self.model.time
        drives = [self._driver(n, item) for n, item in enumerate(model.drivers, start=1)]
        loads = self._loads()
        system = [f"UNITS {self.units.name}"] if self.units.length != 1.0 else []
        elements = [*(line for _, line in drives if line), *self._joint_lines(), *self.element_lines()]
        return [
            _line(*self._counts()),
            *(_line(*body.r, *body.p) for body in model.bodies),
            *([_line(0, 0, 0, 1, 0, 0, 0)] if self.with_ground else []),
            *(line for line, _ in drives),
            *(_line(point.body + 1, *point.s) for point in model.points),
            *(self._joint(joint) for joints in self.sorted.values() for joint in joints),
            *([_line(len(model.bodies) + 1, *[0] * 6)] if self.with_ground else []),
            _line(time.start, time.end, time.step),
            "",
            "DYNAMICS forward",
            *self._masses(),
            f"GRAVITY {_line(*model.gravity)}",
            *loads,
            *block([*system, *self.function_lines(), *elements]),
            *self._method(),
            *map(_shape, model.shapes),
            "END",
        ]

    def _counts(self) -> list[Any]:
        counts = {
            "NBODY": len(self.model.bodies) + self.with_ground,
            "NDRIVE": len(self.model.drivers),
            "NPOINT": len(self.model.points),
            "NGROUN": int(self.with_ground),
        }
        counts |= {COUNT_OF[kind.name]: len(self.sorted[kind.name]) for kind in YOUNG_JOINTS}
        return [counts.get(column.key, 0) for column in COUNTS.columns]

    def _body(self, body: int) -> Any:
        """Number of a body of a joint proper, which the ground is, too."""
        return len(self.model.bodies) + 1 if body == GROUND else body + 1

    def _joint(self, joint: RigidJoint) -> Any:
        kind = next(each for each in YOUNG_JOINTS if each.name == _KIND.get(joint.kind, joint.kind))
        axes = {joint.i: np.array(joint.s_i), joint.j: np.array(joint.s_j)}
        if joint.kind == "fixed":
            axes = {body: self.model.axes(body).T[:, 2] for body in (joint.i, joint.j)}
        points = {"P": {joint.i: np.array(joint.P_i), joint.j: np.array(joint.P_j)}}
        if joint.kind == "screw":
            # YOUNG turns the thread the other way if P_j lies before P_i: they must coincide.
            place = self.model.position(joint.j, joint.P_j) - self.model.position(joint.i, np.zeros(3))
            points["P"][joint.i] = self.model.axes(joint.i).T @ place
        if len(kind.points) > 2:
            points["Q"] = {body: points["P"][body] + s for body, s in axes.items()}
        if len(kind.points) > 4:
            axis = self.model.axis(joint)
            g = across(axis)
            # YOUNG keeps the two vectors across the axis at right angles.
            sides = {joint.i: g, joint.j: np.cross(axis, g)}
            points["H"] = {
                body: points["P"][body] + self.model.axes(body).T @ side for body, side in sides.items()
            }
        numbers = [x for name in points for body in (joint.i, joint.j) for x in points[name][body]]
        pitch = [joint.size] if joint.kind == "screw" else []
        return _line(self._body(joint.i), self._body(joint.j), *numbers, *pitch)

    def _driver(self, n: int, item: Any) -> tuple[Any, Any]:
        """The record of a driver, and the card of one that follows a function."""
        c = polynomial_of(item.function)
        if c is not None and len(c) <= 3:
            C, B, half = (*c, 0.0, 0.0)[:3]
            return _line(item.body + 1, item.direction, C, B, 2.0 * half), ""
        driven = self.driver_line(item, f"driver={n}")
        return _line(item.body + 1, item.direction, item.function.at(0.0)[0], 0, 0), driven

    def _masses(self) -> Iterator[Any]:
        for k, body in enumerate(self.model.bodies, start=1):
            yield f"MASS {_line(k, body.mass, *body.centre, *body.moments)}"
        for k, body in enumerate(self.model.bodies, start=1):
            if any((*body.velocity, *body.omega)):
                yield f"VELOCITY {_line(k, *body.velocity, *body.omega)}"

    def _loads(self) -> Any:
        """The cards of loads."""
        model, cards = self.model, []
        for item in model.forces:
            force, factor = self._factor(item.force, item)
            numbers = _line(item.body + 1, *item.point, *force, int(item.following), factor)
            cards.append(f"FORCE {numbers}")
        for item in model.torques:
            torque, factor = self._factor(item.torque, item)
            cards.append(f"TORQUE {_line(item.body + 1, *torque, int(item.following), factor)}")
        return cards

    def _joint_lines(self) -> Iterator[str]:
        """Lines of links, of welds, whose angle a driver holds, and of drivers at joints."""
        for item in self.model.joints:
            if item.kind in _LINKS:
                axis = f"axis_from=({numbers(item.s_i, ',')}) " if item.kind == "revolute-spherical" else ""
                ends = f"from={self.end(item.i, item.P_i)} to={self.end(item.j, item.P_j)}"
                size = f"length={numbers([item.size])}"
                yield f"JOINT {self.name(item)} {_LINKS[item.kind]} {ends} {axis}{size}"
            elif item.kind == "fixed":
                function = self.function_number(constant(0.0), item)
                yield f"DRIVE {self.name(item)} at={self.joint_number[id(item)]}.angle value={function}"
        for item in self.model.joint_drivers:
            yield self.driver_line(item, f"at={self.coordinate(item.joint, item.coordinate)}")

    def coordinate(self, joint: int, coordinate: str) -> str:
        """Return the spelling of a coordinate."""
        return f"{self.joint(joint)}.{coordinate}"

    def joint(self, joint: int) -> int:
        """Return the number of a joint of the model in the deck."""
        return self.joint_number[id(self.model.joints[joint])]

    def end(self, body: int, point: Any) -> str:
        """Return the spelling of an end."""
        return f"{body + 1}({numbers(point, ',')})"

    def _factor(self, load: Any, item: Any) -> tuple[Any, Any]:
        value = value_of(item.factor)
        if value is not None:
            return [value * x for x in load], 0
        return load, self.function_number(item.factor, item)

    def _method(self) -> Iterator[Any]:
        integrator = self.model.integrator
        yield f"TOLERANCE {_line(min(max(integrator.tolerance, LEAST_TOLERANCE), MOST_TOLERANCE))}"
        if integrator.method == "GALF":
            yield f"GALF {_line(integrator.step, integrator.radius)}"
        elif integrator.method == "RAD5":
            yield "RAD5"


def _shape(shape: ShapeCard) -> str:
    place = _line(*shape.offset, *shape.angles)
    if shape.file:
        return f"STL {shape.file} {_line(shape.body + 1, shape.unit)} {place}"
    return f"GEOM {_line(shape.body + 1, KINDS.index(shape.kind) + 1, *shape.sizes)} {place}"


def _line(*values: Any) -> str:
    return " ".join(str(v) if isinstance(v, int) else repr(float(v) + 0.0) for v in values)
