"""Hinges, closures and prescribed motions of a tree as equations between bodies in absolute coordinates.

What a hinge leaves free is what no equation forbids: of the gap from P_k to O_k its components along
the P_k axes that do not slide, of the attitude the products of axes that no free rotation changes.
"""

from typing import NamedTuple

import numpy as np

from ..arrays.constraint_table import MeasureTable
from ..time_functions import POLYNOMIAL, MotionLaw
from ..tree import INERTIAL, ROTATION, TRANSLATION, Hinge, Tree
from ..vectors import rotation_matrix
from .frames import Base, Frames, shape_of


class HingeArms(NamedTuple):
    """Arms of a hinge: those of the P_k axes (3), of the O_k axes (3), and the gap from P_k to O_k."""

    p: tuple[int, int, int]
    e: tuple[int, int, int]
    gap: tuple[int, int]


def hinge_arms(table: MeasureTable, base: Base, body: int) -> HingeArms:
    """Arms of the hinge of `body` on its base."""
    place = table.arm(base.body, base.place, base.shape if base.shape.size else None)
    return HingeArms(
        tuple(table.arm(base.body, axis) for axis in base.axes.T),
        tuple(table.arm(body, axis) for axis in np.eye(3)),
        (table.arm(body, np.zeros(3)), place),
    )


def add_hinges(table: MeasureTable, tree: Tree, frames: Frames) -> None:
    """Equations of all hinges, then of all riders, a group each."""
    for k, (hinge, base) in enumerate(zip(tree.hinges, frames.bases, strict=True)):
        arms = hinge_arms(table, base, k)
        held = [axis for axis in (1, 2, 3) if axis not in hinge.translations]
        parts = [_slide(table, arms, axis) for axis in held]
        parts += [("axes", False, record) for record in _attitude(table, arms, hinge, k)]
        table.equations(f"hinge of {tree.bodies[k].name}", hinge.place, base.body, k, parts)
    for n, rider in enumerate(frames.riders):
        _add_rider(table, rider, len(tree.bodies) + n)


def _slide(table, arms, axis):
    return f"translation {axis}", True, table.product(arms.gap, arms.p[axis - 1])


def _attitude(table, arms, hinge: Hinge, body):
    """Products of axes that stay zero."""
    turned = [axis - 1 for axis in hinge.rotations]
    if len(turned) == 3:
        return []
    if len(turned) == 2:
        return [table.product(arms.p[turned[0]], arms.e[turned[1]])]
    if len(turned) == 1:
        others = [axis for axis in range(3) if axis != turned[0]]
        return [table.product(arms.p[turned[0]], arms.e[axis]) for axis in others]
    return _welded(table, arms, body, rotation_matrix(hinge.attitude))


def _welded(table, arms, body, T):
    """Axes of the body that lie where those of P_k do are at right angles to the others of these."""
    e = [table.arm(body, T[axis]) for axis in range(3)]
    return [table.product(arms.p[i], e[j]) for i, j in ((0, 1), (0, 2), (1, 2))]


def _add_rider(table, rider, body):
    """Six equations: place, two axes, and the angle that is the slope of the node."""
    arms = hinge_arms(table, rider.base, body)
    parts = [_slide(table, arms, axis) for axis in (1, 2, 3)]
    i, j, k = ((rider.axis + n) % 3 for n in range(3))
    parts += [("axes", False, table.product(arms.p[i], arms.e[axis])) for axis in (j, k)]
    # The slope is a vector along axis 1 of its body, as long as the angle.
    shape = np.vstack([rider.slope, np.zeros((2, rider.slope.size))])
    slope = table.arm(rider.owner, np.zeros(3), shape)
    record = table.product(slope, table.arm(rider.owner, np.eye(3)[0]), -1.0)
    parts.append(("slope", False, table.add_angle(record, 1.0, arms.p[j], arms.p[k], arms.e[j])))
    table.equations(rider.name, None, rider.base.body, body, parts)


def coordinate_measure(
    table: MeasureTable, tree: Tree, frames: Frames, body: int, motion: str, axis: int, near: float
) -> np.ndarray:
    """The measure of a hinge coordinate, not one of three free rotations; `near`: its value at the start."""
    hinge, base = tree.hinges[body], frames.bases[body]
    arms = hinge_arms(table, base, body)
    if motion == TRANSLATION:
        return table.product(arms.gap, arms.p[axis - 1])
    a = axis - 1
    if len(hinge.rotations) == 1:
        i, j = (a + 1) % 3, (a + 2) % 3
        return table.angle(arms.p[i], arms.p[j], arms.e[i], near)
    first, second = (turned - 1 for turned in hinge.rotations)
    across = np.cross(np.eye(3)[first], np.eye(3)[second])
    if a == first:
        # It alone moves the axis of the second rotation.
        g = table.arm(base.body, base.axes @ across)
        return table.angle(arms.p[second], g, arms.e[second], near)
    # Seen from the body, the axis of the first rotation turns back.
    return table.angle(arms.e[first], table.arm(body, across), arms.p[first], near)


def add_prescribed(table: MeasureTable, tree: Tree, frames: Frames) -> None:
    """An equation for every prescribed coordinate, a group each."""
    for drive in tree.prescribed:
        record = coordinate_measure(table, tree, frames, drive.body, drive.motion, drive.axis, drive.C)
        record["law"] = table.law(MotionLaw(POLYNOMIAL, (drive.C, drive.B, 0.5 * drive.A, 0.0)))
        name = f"prescribed {drive.motion} {drive.axis} of {tree.bodies[drive.body].name}"
        part = drive.motion, drive.motion != ROTATION, record
        table.equations(name, drive.place, frames.bases[drive.body].body, drive.body, [part])


def add_closures(table: MeasureTable, tree: Tree) -> None:
    """The closed directions of the cut joints, a group each."""
    for closure in tree.closures:
        gap = (
            _closing_point(table, tree, closure.a, closure.a_point, closure.a_node),
            _closing_point(table, tree, closure.b, closure.b_point, closure.b_node),
        )
        parts = [
            (f"direction {axis}", True, table.product(gap, table.arm(closure.b, np.eye(3)[axis - 1])))
            for axis in closure.directions
        ]
        table.equations(closure.name, closure.place, closure.b, closure.a, parts)


def _closing_point(table, tree, body, point, node):
    if node is None or body == INERTIAL:
        return table.arm(body, point)
    elastic = tree.bodies[body].elastic
    return table.arm(body, elastic.positions[node], shape_of(elastic, node))
