"""Elements of a YOUNG deck that are equations of their own: functions of drivers, supports, composite
joints.
"""

from dataclasses import replace
from typing import Any

import numpy as np

from ..flexible_mechanism import NodePoint, PointJoint
from ..joint_elements import CompositeJoint, DrivenItem, JointElements
from ..loads import DynamicModel
from ..mechanism import Joint, Mechanism
from .constraint_table import PrimitiveTable
from .element_table import ElementTable, PointJoints, coordinates_of_joints, report_coordinates
from .node_joints import EQUATIONS_OF, JointVectors
from .records import NONE

LAST_TRANSLATION = 3  # directions 1 to 3 are coordinates, 4 to 6 turns


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
    a, b = _ends(joint)
    return PointJoint(joint.name, joint.kind, a, b, joint.pitch, joint.place)


def _ends(joint: Joint | CompositeJoint) -> tuple[tuple[NodePoint, ...], tuple[NodePoint, ...]]:
    """Points P and P + s on bodies i and j."""
    return (
        (rigid_point(joint.i, joint.P_i), rigid_point(joint.i, np.add(joint.P_i, joint.s_i))),
        (rigid_point(joint.j, joint.P_j), rigid_point(joint.j, np.add(joint.P_j, joint.s_j))),
    )


def rigid_point(body: int, r0: np.ndarray | tuple[float, float, float]) -> NodePoint:
    """A point of a rigid body, in its axes."""
    return NodePoint("", body, np.asarray(r0, float), np.zeros((3, 0)))


def young_elements(table: PrimitiveTable, model: DynamicModel) -> ElementTable:
    """The elements of a model, whose equations are in the table already."""
    joints = [point_joint(joint) for joint in model.mechanism.joints]
    elements = ElementTable(table, PointJoints(table, joints, model.elements.first_values), model.elements)
    report_coordinates(PointJoints(table.reported(), joints), coordinates_of_joints(joints))
    _Equations(table, model).add()
    elements.add_couplings()
    elements.add_drivers(model.mechanism.time.start)
    return elements


class _Equations:
    """The equations of drivers of the deck, supports and composite joints."""

    def __init__(self, table: PrimitiveTable, model: DynamicModel):
        self.table, self.model, self.elements = table, model, model.elements
        self.start = model.mechanism.time.start

    def add(self) -> None:
        for item in self.elements.driven:
            self._driven(item)
        for item in self.elements.supports:
            held = self.model.mechanism.simplified[item.item]
            self._along_axis(held.name, held.body, held.direction, item)
        for composite in self.elements.composites:
            self._composite(composite)

    def _driven(self, item: DrivenItem) -> None:
        driver = self.model.mechanism.drivers[item.item]
        if driver.direction <= LAST_TRANSLATION:
            self._along_axis(driver.name, driver.body, driver.direction, item)
            return
        axis = driver.direction - 4
        after, last = self.table.axis((axis + 1) % 3), self.table.axis((axis + 2) % 3)
        own = self.table.body_vector(driver.body, np.eye(3)[(axis + 1) % 3])
        record = self.table.angle(after, last, own, item.function.at(self.start)[0])
        record["function"] = self.table.function(item.function)
        self.table.equations(driver.name, item.place, NONE, driver.body, [("angle", False, record)])

    def _along_axis(self, name: str, body: int, direction: int, item: DrivenItem) -> None:
        origin = self.table.body_vector(body, np.zeros(3)), self.table.body_vector(NONE, np.zeros(3))
        record = self.table.product(origin, self.table.axis(direction - 1))
        record["function"] = self.table.function(item.function)
        self.table.equations(name, item.place, NONE, body, [("xyz"[direction - 1], True, record)])

    def _composite(self, item: CompositeJoint) -> Any:
        a, b = _ends(item)
        if item.kind == "revolute-cylindrical":
            parts = _revolute_cylindrical(self.table, a, b)
        else:
            body_vectors = JointVectors(
                self.table, PointJoint(item.name, item.kind, a, b, item.size, item.place)
            )
            parts = [part for make in EQUATIONS_OF[item.kind] for part in make(body_vectors)]
        self.table.equations(item.name, item.place, item.i, item.j, parts)


def _revolute_cylindrical(table: PrimitiveTable, a: Any, b: Any) -> list[Any]:
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
