"""Elements at joints, and between bodies → equations, primitives and loads for the kernels.

What a dialect calls a joint, numbered from 0, and which coordinates it has, is left to the object `joints`:
`PointJoints`, or the hinges of a tree.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ..flexible_mechanism import NodePoint, PointJoint
from ..joint_elements import COORDINATES_OF, JointElements, parts_by_name
from ..joints import ANGLE, ANGLES_OF_CROSS, BY_NAME, PITCH, STROKE
from ..laws import FRICTION, SPRING, Along, At, Cam, Element, Frames, Line, Push, Touch, is_angle
from ..time_functions import SIGNAL, MotionFunction
from .constraint_table import PrimitiveTable
from .contacts import END, fill_contact
from .function_table import fill_bushing, fill_law
from .node_joints import JointVectors
from .records import (
    ABOUT_VECTOR,
    ALONG_VECTOR,
    ELEMENT,
    LOAD,
    NONE,
    blank_load,
    blank_primitive,
    line_primitive,
)
from .records import FRICTION as FRICTION_LOAD
from .signals import signal_arrays
from .tracks import add_curve, add_roll

if TYPE_CHECKING:
    from ..tree_as_mechanism.hinges import HingeJoints


@dataclass(frozen=True)
class JointCoordinateName:
    """A joint coordinate in results: which joint, and which of its coordinates."""

    joint: int
    coordinate: str


class PointJoints:
    """Joints between points of bodies."""

    def __init__(
        self,
        table: PrimitiveTable,
        joints: Sequence[PointJoint],
        first: Mapping[tuple[int, str], float] | None = None,
    ):
        """`first`: the coordinates that do not begin with 0, by joint and name, rad or m."""
        self.table, self.joints, self.first = table, joints, first or {}
        self._turning: dict[tuple[int, str], tuple[int, int, int]] = {}

    def _vectors(self, joint: int) -> JointVectors:
        return JointVectors(self.table, self.joints[joint])

    def primitive(self, joint: int, coordinate: str, expected: float = 0.0) -> np.ndarray:
        """The primitive of a joint coordinate; `expected`: an angle at the start, where it is not 0."""
        if coordinate == STROKE:
            return self._vectors(joint).stroke()
        if (joint, coordinate) not in self._turning:  # a deck may have thousands of elements at one joint
            vectors = self._vectors(joint)
            of_cross = coordinate in ANGLES_OF_CROSS
            turning = vectors.of_cross(coordinate) if of_cross else vectors.turning()
            self._turning[joint, coordinate] = turning
        return self.table.angle(*self._turning[joint, coordinate], expected)

    def start(self, joint: int, coordinate: str) -> float:
        """A coordinate at the start."""
        return self.first.get((joint, coordinate), 0.0)

    def bodies(self, joint: int) -> tuple[int, int]:
        """Its bodies."""
        return self.joints[joint].a[0].body, self.joints[joint].b[0].body

    def axis(self, joint: int) -> int:
        """The body vector along the axis of body a, that its parts slide about and along."""
        body_vectors = self._vectors(joint)
        if body_vectors.a[1].shape.size:
            return int(body_vectors.body_vector_of(body_vectors.a))
        return self.table.body_vector(body_vectors.i, body_vectors.s)

    def sliding(self, joint: int) -> tuple[str | None, str | None]:
        """Its angle and its stroke in which there may be friction; None where it has none."""
        kinds = COORDINATES_OF[self.joints[joint].kind]
        return ANGLE if ANGLE in kinds else None, STROKE if STROKE in kinds else None

    def pitch(self, joint: int) -> float:
        """Advance of a screw, m/rad; 0 of other joints."""
        given = self.joints[joint]
        return given.size if BY_NAME[given.kind].size == PITCH else 0.0


def coordinates_of_joints(joints: Sequence[Any]) -> list[JointCoordinateName]:
    """Return all joint coordinates in the order of the joints, which have a `kind`."""
    return [
        JointCoordinateName(k, coordinate)
        for k, joint in enumerate(joints)
        for coordinate in COORDINATES_OF[joint.kind]
    ]


def report_coordinates(
    joints: "PointJoints | HingeJoints", coordinates: Sequence[JointCoordinateName]
) -> None:
    """Enter coordinates of joints of a table's `reported()`, which report rows then hold."""
    for name in coordinates:
        joints.table.spring(joints.primitive(name.joint, name.coordinate))


class ElementTable:
    """Fills a table of primitives with elements, equations first."""

    def __init__(self, table: PrimitiveTable, joints: "PointJoints | HingeJoints", elements: JointElements):
        self.table, self.joints, self.elements = table, joints, elements
        self._bushings = 0  # so far

    def add_couplings(self) -> None:
        """The equations of what rolls, of general joints and curves, and one for every coupling."""
        for roll in self.elements.rolls:
            centre, point = self._end(roll.j, roll.P_j), self._end(roll.i, roll.P_i)
            add_roll(self.table, roll, centre, point, (roll.i, roll.j))
        for joint in self.elements.generals:
            gap = self._end(joint.j, joint.P_j), self._end(joint.i, joint.P_i)
            self.table.general_joint(joint, gap, self.table.A(joint.j).T @ self.table.A(joint.i))
        for curve in self.elements.curves:
            point, origin = self._end(curve.j, curve.P_j), self._end(curve.i, curve.P_i)
            add_curve(self.table, curve, point, origin, (curve.i, curve.j))
        self.add_sums_and_cams()

    def add_sums_and_cams(self) -> None:
        """An equation for every coupling of joint coordinates."""
        for item in self.elements.couplings:
            records = [
                self._scaled(self.joints.primitive(joint, coordinate), factor / item.scale)
                for joint, coordinate, factor in item.terms
            ]
            if item.function:
                records[-1] = self._curve(*item.terms[-1][:2], item.function)
            else:
                first = sum(factor * self.joints.start(joint, kind) for joint, kind, factor in item.terms)
                records[0]["constant"] += first / item.scale
            record = self.table.chained(records)
            ends = self.joints.bodies(item.terms[0][0])
            self.table.equations(item.name, item.place, *ends, [("coupling", not item.of_angles, record)])

    @staticmethod
    def _scaled(record: np.ndarray, factor: float) -> Any:
        for field in ("alpha", "beta", "constant"):
            record[field] *= factor
        return record

    def add_drivers(self, start: float) -> None:
        """An equation for every joint driver, whose function has a value at the time `start`."""
        for item in self.elements.drivers:
            record = self.joints.primitive(item.joint, item.coordinate, item.function.at(start)[0])
            record["function"] = self.table.function(item.function)
            part = item.coordinate, not is_angle(item.coordinate), record
            self.table.equations(item.name, item.place, *self.joints.bodies(item.joint), [part])

    def loads(self, others: Iterable[np.ndarray], springs: Iterable[Element] = ()) -> np.ndarray:
        """LOAD records: `others`, springs of the deck, force elements, parameters of curves, friction.

        All equations must have been added.
        """
        forces = self.elements.forces
        self.table.contacts.joined |= {frozenset(group[2:]) for group in self.table.groups}
        if isinstance(self.joints, PointJoints):
            joints = range(len(self.joints.joints))
            self.table.contacts.joined |= {frozenset(self.joints.bodies(k)) for k in joints}
        rows = [*others, *(self._load(item) for item in springs)]
        rows += [self._load(item) for item in forces if item.law is not FRICTION]
        rows += [self._probe(track) for track in self.table.tracks]
        rows += [self._friction(item) for item in forces if item.law is FRICTION]
        loads: np.ndarray = np.concatenate([np.zeros(0, LOAD), *map(np.atleast_1d, rows)])
        for k in np.flatnonzero(loads["function"] >= 0):
            loads["driven"][k] = self.table.functions[loads["function"][k]]["kind"] == SIGNAL
        return loads

    def signal_arrays(self, first: int) -> dict[str, Any]:
        """LOAD records of sensors, and the signals; answers of force elements begin with number `first`."""
        signals = self.elements.signals
        sensors = [self._sensor(item.measure) for item in signals if item.measure is not None]
        parts = [*(first * [""]), *parts_by_name(self.elements.forces)]
        records = signal_arrays(signals, self.table, parts, self.table.contacts.bristles)
        return {"sensors": np.array(sensors, LOAD), "signals": records}

    def _sensor(self, measure: Any) -> Any:
        if isinstance(measure, At):
            return self._at(measure)
        record = self._line(measure)
        if isinstance(measure, Along):
            head, tail = self._end(measure.j, measure.P_j), self._end(measure.i, measure.P_i)
            axis = self.table.body_vector(measure.i, np.eye(3)[measure.axis])
            record["in_line"] = 0
            record["primitive"] = self.table.spring(self.table.product((head, tail), axis))
        return record

    def _load(self, item: Element) -> Any:
        """The LOAD record of an element, or its six."""
        if isinstance(item.measure, Frames):
            self._bushings += 1
            return self._bushing(item, self._bushings - 1)
        if isinstance(item.measure, Touch):
            return self._contact(item)
        if isinstance(item.measure, Push):
            return fill_law(self._push(item.measure), item.law, item.values, self.table)
        record = self._line(item.measure) if isinstance(item.measure, Line) else self._at(item.measure)
        return fill_law(record, item.law, item.values, self.table)

    def _at(self, measure: At | Cam) -> Any:
        primitives = [self.joints.primitive(measure.joint, measure.coordinate)]
        if isinstance(measure, Cam):
            primitives.append(self._curve(*measure[2:]))
        return self._probe(primitives)

    def _probe(self, primitives: list[np.ndarray]) -> Any:
        """The LOAD record of an element in a chain of primitives, without a force."""
        record = blank_load(ELEMENT)
        record["shape"] = SPRING.code
        record["primitive"] = self.table.spring(self.table.chained(primitives))
        return record

    def _curve(self, joint: int, coordinate: str, function: MotionFunction) -> np.ndarray:
        """The primitive of a coordinate whose function is subtracted in a chain."""
        record = self.joints.primitive(joint, coordinate)
        record["curve"] = self.table.function(function, of_time=False)
        return record

    def _end(self, body: int, point: Any) -> Any:
        """The body vector of an end: a node, or a point of a rigid body."""
        return (
            self.table.point(point) if isinstance(point, NodePoint) else self.table.body_vector(body, point)
        )

    def _direction(self, body: int, point: Any, v: np.ndarray) -> int:
        """The body vector of a direction, which turns with a node that has rotations."""
        if isinstance(point, NodePoint):
            return self.table.direction(point, v)
        return self.table.body_vector(body, v)

    def _line(self, ends: Line) -> Any:
        head, tail = self._end(ends.j, ends.P_j), self._end(ends.i, ends.P_i)
        record = blank_load(ELEMENT)
        record["in_line"], record["primitive"] = 1, self.table.spring(line_primitive(head, tail))
        return record

    def _push(self, ends: Push) -> Any:
        record = blank_load(ELEMENT)
        record["in_line"] = ABOUT_VECTOR if ends.turning else ALONG_VECTOR
        turns = ends.turning and isinstance(ends.P_j, NodePoint)
        end = self._direction(ends.j, ends.P_j, np.zeros(3)) if turns else self._end(ends.j, ends.P_j)
        record["body_vector"] = end
        record["vector"], record["following"] = ends.direction, ends.follows
        return record

    def _contact(self, item: Element) -> Any:
        """A load for each of its sets."""
        records = np.repeat(blank_load(ELEMENT), len(item.parts))
        records["group"] = self.table.contacts.add(item, self._contact_end)
        return fill_contact(records, item)

    def _contact_end(self, body: int, point: Any) -> np.ndarray:
        """The END record of a shape: its place is that from the global origin."""
        origin, record = self.table.body_vector(NONE, np.zeros(3)), np.zeros((), END)
        record["frame"] = self.table.spring(line_primitive(self._end(body, point), origin))
        return record

    def _bushing(self, item: Element, number: int) -> Any:
        """Six loads, along and about the axes of body i."""
        table, ends = self.table, item.measure
        head, tail = self._end(ends.j, ends.P_j), self._end(ends.i, ends.P_i)
        turned = table.A(ends.j).T @ table.A(ends.i)
        axes = [self._direction(ends.i, ends.P_i, np.eye(3)[k]) for k in range(3)]
        records = np.repeat(blank_primitive(), 6)
        records["alpha"][:3], records["beta"][3:] = 1.0, 1.0
        records["ends"][:3, 0], records["ends"][:3, 1, 0] = (head, tail), axes
        records["f"][3:], records["g"][3:] = np.roll(axes, -1), np.roll(axes, -2)
        own = [self._direction(ends.j, ends.P_j, turned[:, k]) for k in range(3)]
        records["h"][3:], records["turn"][3:] = np.roll(own, -1), len(table.angles) + np.arange(3)
        table.angles += [0.0, 0.0, 0.0]
        loads = fill_bushing(np.repeat(blank_load(ELEMENT), 6), item)
        loads["group"], loads["primitive"] = number, table.spring(records) + np.arange(6)
        # The angle about an axis would jump where the other body's has turned through a right angle.
        resists = loads["c"].any(axis=1) & (np.arange(6) >= 3)
        loads["body_vector"], loads["tilted"] = np.where(resists, [2 * axes, 2 * own], NONE)
        return loads

    def _friction(self, item: Element) -> Any:
        record, joint = blank_load(FRICTION_LOAD), item.measure.joint
        for field, coordinate in zip(("primitive", "stroke"), self.joints.sliding(joint), strict=True):
            if coordinate is not None:
                record[field] = self.table.spring(self.joints.primitive(joint, coordinate))
        record["body_vector"], record["group"] = self.joints.axis(joint), joint
        fill_law(record, item.law, item.values)
        if item.sticks:
            record["bristle"] = self.table.contacts.new_bristles(2)
        if pitch := self.joints.pitch(joint):
            # The flank of a thread stands across its helix: its force is the axial one over the cosine.
            record["thread"] = np.hypot(item["radius"], pitch) / item["radius"]
        return record
