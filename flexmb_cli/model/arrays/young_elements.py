"""Elements at joints of a YOUNG deck → equations, primitives and loads for the kernels."""

import numpy as np

from ...quick_dataclass import dataclass, replace
from ..flexible_mechanism import NodePoint, PointJoint
from ..joint_elements import COORDINATES_OF, CompositeJoint, JointElements
from ..joints import ANGLE, STROKE
from ..loads import DynamicModel
from ..mechanism import Joint, Mechanism
from ..time_functions import integral_of
from .constraint_table import PrimitiveTable
from .node_joints import EQUATIONS_OF, JointVectors
from .records import CABLE, ELEMENT, FRICTION, NONE, RELATIVE, SPRING, STOP, blank_load, line_primitive

TRANSLATIONAL = 3  # directions 1 to 3 are coordinates, 4 to 6 turns


@dataclass(frozen=True)
class JointCoordinateName:
    """A joint coordinate in results: which joint, "angle" or "stroke"."""

    joint: int
    coordinate: str


def reported_coordinates(mechanism: Mechanism) -> list[JointCoordinateName]:
    """All joint coordinates in the order of the joints."""
    return [
        JointCoordinateName(k, coordinate)
        for k, joint in enumerate(mechanism.joints)
        for coordinate in COORDINATES_OF[joint.kind]
    ]


def without_driven(mechanism: Mechanism, elements: JointElements) -> Mechanism:
    """The mechanism without the drivers and supports that follow functions of their own."""
    driven, supports = ({one.item for one in items} for items in (elements.driven, elements.supports))
    return replace(
        mechanism,
        drivers=tuple(item for k, item in enumerate(mechanism.drivers) if k not in driven),
        simplified=tuple(item for k, item in enumerate(mechanism.simplified) if k not in supports),
    )


def point_joint(joint: Joint) -> PointJoint:
    """The joint between points P and P + s, as tables of primitives have it."""
    ends = [
        (_point(body, P), _point(body, np.add(P, s)))
        for body, P, s in ((joint.i, joint.P_i, joint.s_i), (joint.j, joint.P_j, joint.s_j))
    ]
    return PointJoint(joint.name, joint.kind, *ends, joint.pitch, joint.place)


def _point(body, r0):
    return NodePoint("", body, np.asarray(r0, float), np.zeros((3, 0)))


class ElementTable:
    """Fills a table of primitives with the elements of a model, equations first."""

    def __init__(self, table: PrimitiveTable, model: DynamicModel):
        self.table, self.model, self.elements = table, model, model.elements
        self.start = model.mechanism.time.start

    def body_vectors(self, joint: int) -> JointVectors:
        """The moving directions of a joint."""
        return JointVectors(self.table, point_joint(self.model.mechanism.joints[joint]))

    def coordinate(self, joint: int, coordinate: str, expected: float = 0.0) -> np.ndarray:
        """The primitive of a joint coordinate."""
        body_vectors = self.body_vectors(joint)
        return (
            body_vectors.stroke()
            if coordinate == STROKE
            else self.table.angle(*body_vectors.turning(), expected)
        )

    def add_equations(self) -> None:
        """The equations: drivers of the deck, supports, composite joints, couplings, joint drivers."""
        for item in self.elements.driven:
            self._driven(item)
        for item in self.elements.supports:
            held = self.model.mechanism.simplified[item.item]
            self._along_axis(held.name, held.body, held.direction, item)
        for item in self.elements.composites:
            self._composite(item)
        for item in self.elements.couplings:
            self._coupling(item)
        for item in self.elements.drivers:
            body_vectors, is_length = self.body_vectors(item.joint), item.coordinate == STROKE
            record = self.coordinate(item.joint, item.coordinate, item.function.at(self.start)[0])
            record["function"] = self.table.function(item.function)
            parts = [(item.coordinate, is_length, record)]
            self.table.equations(item.name, item.place, body_vectors.i, body_vectors.j, parts)

    def _driven(self, item):
        driver = self.model.mechanism.drivers[item.item]
        if driver.direction <= TRANSLATIONAL:
            self._along_axis(driver.name, driver.body, driver.direction, item)
            return
        axis = driver.direction - 4
        after, last = self.table.axis((axis + 1) % 3), self.table.axis((axis + 2) % 3)
        own = self.table.body_vector(driver.body, np.eye(3)[(axis + 1) % 3])
        record = self.table.angle(after, last, own, item.function.at(self.start)[0])
        record["function"] = self.table.function(item.function)
        self.table.equations(driver.name, item.place, NONE, driver.body, [("angle", False, record)])

    def _along_axis(self, name, body, direction, item):
        origin = self.table.body_vector(body, np.zeros(3)), self.table.body_vector(NONE, np.zeros(3))
        record = self.table.product(origin, self.table.axis(direction - 1))
        record["function"] = self.table.function(item.function)
        self.table.equations(name, item.place, NONE, body, [("xyz"[direction - 1], True, record)])

    def _composite(self, item: CompositeJoint):
        ends = [
            (_point(body, P), _point(body, np.add(P, s)))
            for body, P, s in ((item.i, item.P_i, item.s_i), (item.j, item.P_j, item.s_j))
        ]
        if item.kind == "revolute-cylindrical":
            parts = _revolute_cylindrical(self.table, *ends)
        else:
            body_vectors = JointVectors(
                self.table, PointJoint(item.name, item.kind, *ends, item.size, item.place)
            )
            parts = [part for make in EQUATIONS_OF[item.kind] for part in make(body_vectors)]
        self.table.equations(item.name, item.place, item.i, item.j, parts)

    def _coupling(self, item):
        records = [self._scaled(self.coordinate(joint, kind), factor) for joint, kind, factor in item.terms]
        is_length = any(kind == STROKE for _, kind, _ in item.terms)
        body_vectors = self.body_vectors(item.terms[0][0])
        record = self.table.chained(records)
        self.table.equations(
            item.name, item.place, body_vectors.i, body_vectors.j, [("coupling", is_length, record)]
        )

    @staticmethod
    def _scaled(record, factor):
        for field in ("alpha", "beta", "constant"):
            record[field] *= factor
        return record

    def loads(self) -> list[np.ndarray]:
        """Springs, stops, bushings, joint coordinates, motors, friction; equations must have been added."""
        found = [self._spring(item) for item in self.elements.springs]
        found += [self._line(item) for item in self.elements.lines]
        found += [self._stop(item) for item in self.elements.stops]
        for item in self.elements.bushings:
            found += self._bushing(item)
        for item in reported_coordinates(self.model.mechanism):
            found.append(self._at(item.joint, item.coordinate, SPRING))
        found += [self._motor(item) for item in self.elements.motors]
        return found + [self._friction(item) for item in self.elements.frictions]

    def _at(self, joint, coordinate, shape):
        record = blank_load(ELEMENT)
        record["shape"] = shape
        record["primitive"] = self.table.spring(self.coordinate(joint, coordinate))
        return record

    def _motor(self, item):
        record = blank_load(RELATIVE)
        record["primitive"] = self.table.spring(self.coordinate(item.joint, item.coordinate))
        record["function"] = self.table.function(item.function)
        return record

    def _spring(self, item):
        return self._with_data(self._at(item.joint, item.coordinate, SPRING), item)

    def _line(self, item):
        record = blank_load(ELEMENT)
        record["shape"], record["in_line"] = CABLE if item.slack else SPRING, 1
        head, tail = (self.table.body_vector(body, P) for body, P in ((item.j, item.P_j), (item.i, item.P_i)))
        record["primitive"] = self.table.spring(line_primitive(head, tail))
        return self._with_data(record, item)

    def _with_data(self, record, item):
        record["stiffness"], record["damping"] = item.stiffness, item.damping
        record["free_length"], record["preload"] = item.rest, item.preload
        if item.curve is not None:
            record["curve"] = self.table.function(item.curve, of_time=False)
            record["energy"] = self.table.function(integral_of(item.curve), of_time=False)
        if item.damper is not None:
            record["damper"] = self.table.function(item.damper, of_time=False)
        return record

    def _stop(self, item):
        record = self._at(item.joint, item.coordinate, STOP)
        record["stiffness"], record["damping"] = item.stiffness, item.damping
        record["lower"], record["upper"] = item.lower, item.upper
        return record

    def _bushing(self, item):
        """Six loads, along and about the axes of body i."""
        table = self.table
        head, tail = table.body_vector(item.j, item.P_j), table.body_vector(item.i, item.P_i)
        turned = table.A(item.j).T @ table.A(item.i)
        axes = [table.body_vector(item.i, np.eye(3)[k]) for k in range(3)]
        records = [table.product((head, tail), axes[k]) for k in range(3)]
        for k in range(3):
            after, last = axes[(k + 1) % 3], axes[(k + 2) % 3]
            records.append(table.angle(after, last, table.body_vector(item.j, turned[:, (k + 1) % 3])))
        for record, stiffness, damping in zip(records, item.stiffness, item.damping, strict=True):
            load = blank_load(ELEMENT)
            load["shape"], load["primitive"] = SPRING, table.spring(record)
            load["stiffness"], load["damping"] = stiffness, damping
            yield load

    def _friction(self, item):
        record = blank_load(FRICTION)
        kinds = COORDINATES_OF[self.model.mechanism.joints[item.joint].kind]
        for field, coordinate in (("primitive", ANGLE), ("stroke", STROKE)):
            if coordinate in kinds:
                record[field] = self.table.spring(self.coordinate(item.joint, coordinate))
        body_vectors = self.body_vectors(item.joint)
        record["body_vector"], record["group"] = (
            self.table.body_vector(body_vectors.i, body_vectors.s),
            item.joint,
        )
        for field in ("dynamic", "static", "stribeck", "creep", "radius", "preload"):
            record[field] = getattr(item, field)
        return record


def _revolute_cylindrical(table, a, b):
    """P_i stays on the axis of body j, and the two axes at right angles."""
    of_i, of_j = a[1].r0 - a[0].r0, b[1].r0 - b[0].r0
    s_i, s_j = of_i / np.linalg.norm(of_i), of_j / np.linalg.norm(of_j)
    first = np.cross(s_j, np.eye(3)[int(np.argmin(np.abs(s_j)))])
    first /= np.linalg.norm(first)
    gap = table.point(a[0]), table.point(b[0])
    parts = [
        (f"on the axis, {word}", True, table.product(gap, table.body_vector(b[0].body, across)))
        for word, across in (("1st", first), ("2nd", np.cross(s_j, first)))
    ]
    axes = table.body_vector(a[0].body, s_i), table.body_vector(b[0].body, s_j)
    return [*parts, ("axes at right angles", False, table.product(*axes))]
