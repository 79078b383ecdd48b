"""Loads of a tree on bodies with coordinates of their own: records of `records.LOAD`."""

from typing import TYPE_CHECKING, Any

import numpy as np

from ..arrays.constraint_table import PrimitiveTable
from ..arrays.laws import NONE
from ..arrays.records import FORCE, LOAD, RELATIVE, TORQUE, blank_load
from ..time_functions import HELD_TABLE, POLYNOMIAL, MotionFunction
from ..tree import ROTATION, Table, Tree
from ..vectors import rotation_matrix
from .frames import Frames, shape_of
from .hinges import coordinate_primitive
from .limits import has_fixed_axis, has_shared_axis

if TYPE_CHECKING:
    from ..tree import Hinge, Motor, Spring


def tree_loads(table: PrimitiveTable, tree: Tree, frames: Frames) -> np.ndarray:
    """Return all loads but gravity and elasticity."""
    found: np.ndarray = _Loads(table, tree, frames).records()
    return found


def load_names(table: PrimitiveTable, tree: Tree, frames: Frames) -> list[tuple[str, str]]:
    """Name of every load of `tree_loads`, and what it is: "force", "torque", "motor" or "spring"."""
    loads = _Loads(table, tree, frames)
    loads.records()
    return loads.names


class _Loads:
    """Collects the records, and a name of each and what it is."""

    def __init__(self, table: PrimitiveTable, tree: Tree, frames: Frames):
        self.table, self.tree, self.frames = table, tree, frames
        self.found: list[Any] = []
        self.names: list[tuple[str, str]] = []
        self.name = "", ""

    def records(self) -> Any:
        for k, body in enumerate(self.tree.bodies):
            self.name = f"{body.name} constant force", "force"
            self._add(FORCE, self.table.body_vector(k, np.zeros(3)), body.force)
            self.name = f"{body.name} constant torque", "torque"
            self._add(TORQUE, self.table.body_vector(k, np.zeros(3)), body.torque)
            self._add_nodal(k, body.elastic)
        for torque in self.tree.torques:
            self.name = f"{self.tree.bodies[torque.body].name} torque", "torque"
            body_vector = self.table.body_vector(torque.body, np.zeros(3))
            self._add(
                TORQUE, body_vector, np.eye(3)[torque.axis - 1], function=self._function(torque.function)
            )
        for motor in self.tree.motors:
            self.name = f"{self.tree.bodies[motor.body].name} {motor.motion} {motor.axis} motor", "motor"
            if has_fixed_axis(self.tree, motor):
                self._add_motor(motor)
            else:
                self._add_along_coordinate(motor)
        for spring in self.tree.springs:
            self.name = f"{self.tree.bodies[spring.body].name} {spring.motion} {spring.axis} spring", "spring"
            self._add_spring(spring)
        return np.array(self.found, dtype=LOAD).reshape(-1)

    def _add(
        self,
        kind: int,
        body_vector: int,
        vector: np.ndarray | tuple[float, float, float],
        function: int = NONE,
        following: bool = False,
    ) -> None:
        if not np.any(vector):
            return
        record = blank_load(kind)
        record["body_vector"], record["vector"] = body_vector, vector
        record["function"], record["following"] = function, following
        self._keep(record)

    def _add_nodal(self, k: int, elastic: Any) -> None:
        for node in range(len(elastic.masses) if elastic else 0):
            self.name = f"{self.tree.bodies[k].name} node {node + 1} force", "force"
            body_vector = self.table.body_vector(k, elastic.positions[node], shape_of(elastic, node))
            self._add(FORCE, body_vector, elastic.forces[node])

    def _add_motor(self, motor: "Motor") -> None:
        """Torque or force along an axis that rests or that both bodies share, and its opposite."""
        base, function = self.frames.bases[motor.body], self._function(motor.function)
        kind = TORQUE if motor.motion == ROTATION else FORCE
        axis = base.axes[:, motor.axis - 1]
        own = _axis_in_body(self.tree.hinges[motor.body], motor)
        body_vector = self.table.body_vector(motor.body, np.zeros(3))
        self._add(kind, body_vector, axis if own is None else own, function, own is not None)
        if base.body >= 0:
            place = self.table.body_vector(base.body, base.place, base.shape if base.shape.size else None)
            self._add(kind, place, -axis, function, True)

    def _add_along_coordinate(self, motor: "Motor") -> None:
        """Generalised force along the hinge coordinate, whose axes move against each other."""
        record = self._relative(motor)
        record["function"] = self._function(motor.function)
        self._keep(record)

    def _add_spring(self, spring: "Spring") -> None:
        record = self._relative(spring)
        record["stiffness"], record["damping"] = spring.stiffness, spring.damping
        record["free_length"] = spring.rest
        self._keep(record)

    def _relative(self, item: "Motor | Spring") -> Any:
        """A load that acts in the hinge coordinate of a spring or motor."""
        where = item.body, item.motion, item.axis
        expected = next(
            q
            for c, q in zip(self.tree.coordinates, self.tree.q, strict=True)
            if (c.body, c.motion, c.axis) == where
        )
        record = blank_load(RELATIVE)
        primitive = coordinate_primitive(self.table, self.tree, self.frames, *where, expected)
        record["primitive"] = self.table.spring(primitive)
        return record

    def _keep(self, record: np.ndarray) -> None:
        self.found.append(record)
        self.names.append(self.name)

    def _function(self, function: Table) -> int:
        if len(function.times) == 1:
            return int(self.table.function(MotionFunction(POLYNOMIAL, (function.values[0], 0.0, 0.0, 0.0))))
        # Past a jump at its end a table continues: the kernel divides by the length of the last piece.
        times, values = (*function.times, function.times[-1] + 1.0), (*function.values, function.values[-1])
        return int(self.table.of_knots(HELD_TABLE, np.column_stack([times, values, np.zeros(len(times))])))


def _axis_in_body(hinge: "Hinge", motor: "Motor") -> Any:
    """Axis (3,) of a motor where it is fixed in the body, as that of a second rotation is; else None."""
    axis = np.eye(3)[motor.axis - 1]
    if motor.motion == ROTATION and hinge.rotations[1:] == (motor.axis,):
        return axis
    if not has_shared_axis(hinge, motor.axis):
        return None
    return axis if hinge.rotations else rotation_matrix(hinge.attitude).T @ axis
