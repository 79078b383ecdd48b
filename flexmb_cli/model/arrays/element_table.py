"""Elements at joints, and between bodies → equations, primitives and loads for the kernels.

What a dialect calls a joint, and which coordinates it has, is left to the object `joints`: `PointJoints`, or
the hinges of a tree.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from ..flexible_mechanism import NodePoint, PointJoint
from ..joint_elements import COORDINATES_OF, JointElements, is_angle
from ..joints import ANGLE, BY_NAME, PITCH, STROKE
from .constraint_table import PrimitiveTable
from .laws import fill_friction, fill_law, fill_spring
from .node_joints import JointVectors
from .records import ELEMENT, FRICTION, blank_load, line_primitive

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ..joint_elements import Bushing, JointFriction, JointMotor, JointSpring, LineSpring
    from ..laws import JointLaw


@dataclass(frozen=True)
class JointCoordinateName:
    """A joint coordinate in results: which joint, and which of its coordinates."""

    joint: int
    coordinate: str


class Joints(Protocol):
    """Joint data of the elements; joints are numbered from 0."""

    def primitive(self, joint: int, coordinate: str, expected: float = 0.0) -> np.ndarray:
        """The primitive of a joint coordinate; `expected`: an angle at the start, where it is not 0."""

    def start(self, joint: int, coordinate: str) -> float:
        """A coordinate at the start."""

    def bodies(self, joint: int) -> tuple[int, int]:
        """Its two bodies."""

    def axis(self, joint: int) -> int:
        """The body vector along the axis that its parts slide about and along."""

    def sliding(self, joint: int) -> tuple[str | None, str | None]:
        """Its angle and its stroke in which there may be friction; None where it has none."""

    def pitch(self, joint: int) -> float:
        """Advance of a screw, m/rad; 0 of other joints."""


class PointJoints:
    """Joints between points of bodies."""

    def __init__(self, table: PrimitiveTable, joints: Sequence[PointJoint]):
        self.table, self.joints = table, joints
        self._turning: dict[int, tuple[int, int, int]] = {}

    def _vectors(self, joint: int) -> JointVectors:
        return JointVectors(self.table, self.joints[joint])

    def primitive(self, joint: int, coordinate: str, expected: float = 0.0) -> np.ndarray:
        """The primitive of a joint coordinate."""
        if coordinate == STROKE:
            found: np.ndarray = self._vectors(joint).stroke()
            return found
        if joint not in self._turning:  # a deck may have thousands of elements at one joint
            self._turning[joint] = self._vectors(joint).turning()
        return self.table.angle(*self._turning[joint], expected)

    def start(self, joint: int, coordinate: str) -> float:
        """All begin with 0."""
        return 0.0

    def bodies(self, joint: int) -> tuple[int, int]:
        """Its bodies."""
        return self.joints[joint].a[0].body, self.joints[joint].b[0].body

    def axis(self, joint: int) -> int:
        """The body vector along the axis of body a."""
        body_vectors = self._vectors(joint)
        if body_vectors.a[1].shape.size:
            return int(body_vectors.body_vector_of(body_vectors.a))
        return self.table.body_vector(body_vectors.i, body_vectors.s)

    def sliding(self, joint: int) -> tuple[str | None, str | None]:
        """Its angle and its stroke."""
        kinds = COORDINATES_OF[self.joints[joint].kind]
        return ANGLE if ANGLE in kinds else None, STROKE if STROKE in kinds else None

    def pitch(self, joint: int) -> float:
        """Advance of a screw, m/rad."""
        given = self.joints[joint]
        return given.size if BY_NAME[given.kind].size == PITCH else 0.0


def coordinates_of_joints(joints: Sequence[Any]) -> list[JointCoordinateName]:
    """Return all joint coordinates in the order of the joints, which have a `kind`."""
    return [
        JointCoordinateName(k, coordinate)
        for k, joint in enumerate(joints)
        for coordinate in COORDINATES_OF[joint.kind]
    ]


def line_load(table: PrimitiveTable, head: int, tail: int) -> Any:
    """Return the load in the length of the line from one body vector to another."""
    record = blank_load(ELEMENT)
    record["in_line"], record["primitive"] = 1, table.spring(line_primitive(head, tail))
    return record


class ElementTable:
    """Fills a table of primitives with elements, equations first."""

    def __init__(
        self,
        table: PrimitiveTable,
        joints: Joints,
        elements: JointElements,
        reported: Sequence[JointCoordinateName],
    ):
        self.table, self.joints, self.elements, self.reported = table, joints, elements, reported

    def add_couplings(self) -> None:
        """An equation for every coupling of joint coordinates."""
        for item in self.elements.couplings:
            records = [
                self._scaled(self.joints.primitive(joint, coordinate), factor / item.scale)
                for joint, coordinate, factor in item.terms
            ]
            is_length = not all(is_angle(coordinate) for _, coordinate, _ in item.terms)
            first = sum(factor * self.joints.start(joint, kind) for joint, kind, factor in item.terms)
            records[0]["constant"] += first / item.scale
            record = self.table.chained(records)
            ends = self.joints.bodies(item.terms[0][0])
            self.table.equations(item.name, item.place, *ends, [("coupling", is_length, record)])

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

    def loads(self) -> list[np.ndarray]:
        """Springs, stops, bushings, joint coordinates, motors, friction; equations must have been added."""
        found = [self._in_joint(item) for item in self.elements.springs]
        found += [self._line(item) for item in self.elements.lines]
        found += [self._in_joint(item) for item in self.elements.laws]
        for number, bushing in enumerate(self.elements.bushings):
            found += self._bushing(number, bushing)
        for name in self.reported:
            found.append(self._at(name.joint, name.coordinate))
        found += [self._in_joint(item) for item in self.elements.motors]
        return found + [self._friction(item) for item in self.elements.frictions]

    def _at(self, joint: int, coordinate: str) -> Any:
        record = blank_load(ELEMENT)
        record["primitive"] = self.table.spring(self.joints.primitive(joint, coordinate))
        return fill_spring(record, 0.0, 0.0, 0.0)

    def _in_joint(self, item: "JointSpring | JointLaw | JointMotor") -> Any:
        return fill_law(self._at(item.joint, item.coordinate), item, self.table)

    def _end(self, body: int, point: Any) -> Any:
        """The body vector of an end: a node, or a point of a rigid body."""
        return (
            self.table.point(point) if isinstance(point, NodePoint) else self.table.body_vector(body, point)
        )

    def _line(self, item: "LineSpring") -> Any:
        ends = self._end(item.j, item.P_j), self._end(item.i, item.P_i)
        return fill_law(line_load(self.table, *ends), item, self.table)

    def _bushing(self, number: int, item: "Bushing") -> "Iterator[Any]":
        """Six loads, along and about the axes of body i."""
        table = self.table
        head, tail = self._end(item.j, item.P_j), self._end(item.i, item.P_i)
        turned = table.A(item.j).T @ table.A(item.i)
        axes = [table.body_vector(item.i, np.eye(3)[k]) for k in range(3)]
        records = [table.product((head, tail), axes[k]) for k in range(3)]
        for k in range(3):
            after, last = axes[(k + 1) % 3], axes[(k + 2) % 3]
            records.append(table.angle(after, last, table.body_vector(item.j, turned[:, (k + 1) % 3])))
        for k, (record, stiffness, damping) in enumerate(
            zip(records, item.stiffness, item.damping, strict=True)
        ):
            load = blank_load(ELEMENT)
            load["group"] = number
            if k >= 3 and (stiffness or damping):
                # The angle about an axis would jump where the other body's has turned through a right angle.
                load["body_vector"] = axes[k - 3]
                load["tilted"] = table.body_vector(item.j, turned[:, k - 3])
            load["primitive"] = table.spring(record)
            yield fill_spring(load, stiffness, 0.0, damping)

    def _friction(self, item: "JointFriction") -> Any:
        record = blank_load(FRICTION)
        sliding = self.joints.sliding(item.joint)
        for field, coordinate in zip(("primitive", "stroke"), sliding, strict=True):
            if coordinate is not None:
                record[field] = self.table.spring(self.joints.primitive(item.joint, coordinate))
        record["body_vector"], record["group"] = self.joints.axis(item.joint), item.joint
        fill_friction(record, item)
        if pitch := self.joints.pitch(item.joint):
            # The flank of a thread stands across its helix: its force is the axial one over the cosine.
            record["thread"] = np.hypot(item.radius, pitch) / item.radius
        return record
