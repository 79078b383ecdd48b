"""Hinges, closures, prescribed motions and loads of a tree between bodies in absolute coordinates.

What a hinge leaves free is what no equation forbids: of the gap from P_k to O_k its components along
the P_k axes that do not slide, of the attitude the products of axes that no free rotation changes.
"""

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from ..arrays.constraint_table import PrimitiveTable
from ..arrays.records import FORCE, TORQUE, vector_load
from ..arrays.tracks import add_curve, add_roll
from ..time_functions import POLYNOMIAL, MotionFunction
from ..tree import INERTIAL, ROTATION, TRANSLATION, Hinge, Tree
from ..vectors import rotation_matrix
from .frames import Base, Frames, NodeFrame, shape_of


class HingeVectors(NamedTuple):
    """Body vectors of a hinge, by their numbers."""

    p: tuple[int, int, int]  # axes of P_k
    e: tuple[int, int, int]  # axes of O_k
    gap: tuple[int, int]  # head and tail of the vector from P_k to O_k


def hinge_vectors(table: PrimitiveTable, base: Base, body: int) -> HingeVectors:
    """Body vectors of the hinge of `body` on its base."""
    place = table.body_vector(base.body, base.place, base.shape if base.shape.size else None)
    p = [table.body_vector(base.body, axis) for axis in base.axes.T]
    e = [table.body_vector(body, axis) for axis in np.eye(3)]
    return HingeVectors((p[0], p[1], p[2]), (e[0], e[1], e[2]), (table.body_vector(body, np.zeros(3)), place))


def add_hinges(table: PrimitiveTable, tree: Tree, frames: Frames) -> None:
    """Equations of all hinges, then of all node frames, a group each."""
    for k, (hinge, base) in enumerate(zip(tree.hinges, frames.bases, strict=True)):
        body_vectors = hinge_vectors(table, base, k)
        held = [axis for axis in (1, 2, 3) if axis not in hinge.translations]
        parts = [_slide(table, body_vectors, axis) for axis in held]
        parts += [("axes", False, record) for record in _attitude(table, body_vectors, hinge, k)]
        table.equations(f"hinge of {tree.bodies[k].name}", hinge.place, base.body, k, parts)
    for n, node_frame in enumerate(frames.node_frames):
        _add_node_frame(table, node_frame, len(tree.bodies) + n)


def _slide(table: PrimitiveTable, body_vectors: HingeVectors, axis: int) -> tuple[Any, Any, Any]:
    return f"translation {axis}", True, table.product(body_vectors.gap, body_vectors.p[axis - 1])


def _attitude(table: PrimitiveTable, body_vectors: HingeVectors, hinge: Hinge, body: int) -> Any:
    """Products of axes that stay zero."""
    turned = [axis - 1 for axis in hinge.rotations]
    if len(turned) == 3:
        return []
    if len(turned) == 2:
        return [table.product(body_vectors.p[turned[0]], body_vectors.e[turned[1]])]
    if len(turned) == 1:
        others = [axis for axis in range(3) if axis != turned[0]]
        return [table.product(body_vectors.p[turned[0]], body_vectors.e[axis]) for axis in others]
    return _welded(table, body_vectors, body, rotation_matrix(hinge.attitude))


def _welded(table: PrimitiveTable, body_vectors: HingeVectors, body: int, T: np.ndarray) -> list[Any]:
    """Axes of the body that lie where those of P_k do are at right angles to the others of these."""
    e = [table.body_vector(body, T[axis]) for axis in range(3)]
    return [table.product(body_vectors.p[i], e[j]) for i, j in ((0, 1), (0, 2), (1, 2))]


def _add_node_frame(table: PrimitiveTable, node_frame: NodeFrame, body: int) -> None:
    """Six equations: place, two axes, and the angle that is the slope of the node."""
    body_vectors = hinge_vectors(table, node_frame.base, body)
    parts = [_slide(table, body_vectors, axis) for axis in (1, 2, 3)]
    i, j, k = ((node_frame.axis + n) % 3 for n in range(3))
    parts += [("axes", False, table.product(body_vectors.p[i], body_vectors.e[axis])) for axis in (j, k)]
    # The slope is a vector along axis 1 of its body, as long as the angle.
    shape = np.vstack([node_frame.slope, np.zeros((2, node_frame.slope.size))])
    slope = table.body_vector(node_frame.owner, np.zeros(3), shape)
    record = table.product(slope, table.body_vector(node_frame.owner, np.eye(3)[0]), -1.0)
    parts.append(
        (
            "slope",
            False,
            table.add_angle(record, 1.0, body_vectors.p[j], body_vectors.p[k], body_vectors.e[j]),
        )
    )
    table.equations(node_frame.name, None, node_frame.base.body, body, parts)


def coordinate_primitive(
    table: PrimitiveTable, tree: Tree, frames: Frames, body: int, motion: str, axis: int, expected: float
) -> np.ndarray:
    """The primitive of a hinge coordinate, not one of three free rotations; `expected`: its value at the
    start.
    """
    hinge, base = tree.hinges[body], frames.bases[body]
    body_vectors = hinge_vectors(table, base, body)
    if motion == TRANSLATION:
        return table.product(body_vectors.gap, body_vectors.p[axis - 1])
    a = axis - 1
    if len(hinge.rotations) == 1:
        i, j = (a + 1) % 3, (a + 2) % 3
        return table.angle(body_vectors.p[i], body_vectors.p[j], body_vectors.e[i], expected)
    first, second = (turned - 1 for turned in hinge.rotations)
    across = np.cross(np.eye(3)[first], np.eye(3)[second])
    if a == first:
        # It alone moves the axis of the second rotation.
        g = table.body_vector(base.body, base.axes @ across)
        return table.angle(body_vectors.p[second], g, body_vectors.e[second], expected)
    # Seen from the body, the axis of the first rotation turns back.
    return table.angle(
        body_vectors.e[first], table.body_vector(body, across), body_vectors.p[first], expected
    )


def add_prescribed(table: PrimitiveTable, tree: Tree, frames: Frames) -> None:
    """An equation for every prescribed coordinate, a group each."""
    for drive in tree.prescribed:
        record = coordinate_primitive(table, tree, frames, drive.body, drive.motion, drive.axis, drive.C)
        record["function"] = table.function(
            MotionFunction(POLYNOMIAL, (drive.C, drive.B, 0.5 * drive.A, 0.0))
        )
        name = f"prescribed {drive.motion} {drive.axis} of {tree.bodies[drive.body].name}"
        part = drive.motion, drive.motion != ROTATION, record
        table.equations(name, drive.place, frames.bases[drive.body].body, drive.body, [part])


def add_closures(table: PrimitiveTable, tree: Tree) -> None:
    """The closed directions of the cut joints, a group each."""
    for closure in tree.closures:
        gap = (
            _closure_point(table, tree, closure.a, closure.a_point, closure.a_node),
            _closure_point(table, tree, closure.b, closure.b_point, closure.b_node),
        )
        if closure.curve:
            add_curve(table, closure.curve, *gap, (closure.b, closure.a))
            continue
        if closure.general:
            table.general_joint(closure.general, gap, closure.turned)
            continue
        if closure.roll:
            add_roll(table, closure.roll, *gap, (closure.b, closure.a))
            continue
        parts = [
            (f"direction {axis}", True, table.product(gap, table.body_vector(closure.b, np.eye(3)[axis - 1])))
            for axis in closure.directions
        ]
        table.equations(closure.name, closure.place, closure.b, closure.a, parts)


def _closure_point(table: Any, tree: Tree, body: Any, point: tuple[float, float, float], node: Any) -> Any:
    if node is None or body == INERTIAL:
        return table.body_vector(body, point)
    elastic = tree.bodies[body].elastic
    return table.body_vector(body, elastic.positions[node], shape_of(elastic, node))


class HingeJoints:
    """Hinges, numbered as their bodies, with coordinates "rotation 1" to "translation 3"."""

    def __init__(self, table: PrimitiveTable, tree: Tree, frames: Frames):
        self.table, self.tree, self.frames = table, tree, frames

    def start(self, joint: int, coordinate: str) -> float:
        """A coordinate at the start."""
        return float(
            next(
                q
                for c, q in zip(self.tree.coordinates, self.tree.q, strict=True)
                if (c.body, f"{c.motion} {c.axis}") == (joint, coordinate)
            )
        )

    def primitive(self, joint: int, coordinate: str, expected: float = 0.0) -> np.ndarray:
        """The primitive of a hinge coordinate, which begins with that of the tree."""
        motion, axis = coordinate.split()
        first = self.start(joint, coordinate)
        return coordinate_primitive(self.table, self.tree, self.frames, joint, motion, int(axis), first)

    def bodies(self, joint: int) -> tuple[int, int]:
        """The body of its base, and its own."""
        return self.frames.bases[joint].body, joint

    def axis(self, joint: int) -> int:
        """The body vector along the only axis that its hinge is free about or along."""
        hinge, base = self.tree.hinges[joint], self.frames.bases[joint]
        axis = (*hinge.rotations, *hinge.translations)[0]
        return self.table.body_vector(base.body, base.axes[:, axis - 1])

    def sliding(self, joint: int) -> tuple[str | None, str | None]:
        """Its rotation and its translation."""
        hinge = self.tree.hinges[joint]
        turn, slide = (
            f"{motion} {axes[0]}" if axes else None
            for motion, axes in (("rotation", hinge.rotations), ("translation", hinge.translations))
        )
        return turn, slide

    def pitch(self, joint: int) -> float:
        """No hinge is a screw."""
        return 0.0


def tree_loads(table: PrimitiveTable, tree: Tree) -> Iterator[np.ndarray]:
    """Yield all loads but gravity, elasticity and elements."""
    for k, body in enumerate(tree.bodies):
        origin = table.body_vector(k, np.zeros(3))
        given = [(FORCE, origin, body.force), (TORQUE, origin, body.torque)]
        if elastic := body.elastic:
            for node, position in enumerate(elastic.positions):
                place = table.body_vector(k, position, shape_of(elastic, node))
                given.append((FORCE, place, elastic.forces[node]))
        yield from (vector_load(*load) for load in given if np.any(load[2]))
    for torque in tree.torques:
        origin, axis = table.body_vector(torque.body, np.zeros(3)), np.eye(3)[torque.axis - 1]
        yield vector_load(TORQUE, origin, axis, function=table.function(torque.function))
