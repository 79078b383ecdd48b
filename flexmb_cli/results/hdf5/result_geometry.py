"""Geometry of a model that the result keeps, so that it can be drawn without its deck.

Where joints and points sit on their bodies is constant in body axes; the motion of the bodies does the
rest.  Bodies are numbered from 1 as in decks, 0 is the ground (the inertial frame of a tree).
"""

from typing import TYPE_CHECKING, Any

import numpy as np

from ...model.mechanism import Mechanism
from .layout import XYZ, Axis, Constant

if TYPE_CHECKING:
    from ...model.tree import Body, Closure, Tree

SIDE = Axis("side", ("I", "J"), "first and second body of a joint")
OF_JOINT = ("joint/joint", SIDE.path)


def gravity(acceleration: tuple[float, float, float]) -> tuple[Constant, ...]:
    """Return the acceleration of gravity (3,), global axes, where there is any; pictures show it as down."""
    g = np.array(acceleration, float)
    constants = (Constant("gravity", (XYZ.path,), g, "m/s2", "acceleration of gravity, global axes"),)
    return constants if g.any() else ()


def mechanism_geometry(mechanism: Mechanism) -> tuple[Constant, ...]:
    """Bodies, points and axes of the joints, bodies of the points of interest."""
    constants = []
    if mechanism.joints:
        joints = mechanism.joints
        axis = np.array([(joint.s_i, joint.s_j) for joint in joints], float)
        meaning = "vector along the joint's axis (arm of a universal joint's cross; 0: spherical), body axes"
        constants = joint_geometry(
            [(joint.i, joint.j) for joint in joints], [(joint.P_i, joint.P_j) for joint in joints]
        )
        constants.append(Constant("joint/axis", (*OF_JOINT, XYZ.path), axis, "m", meaning))
    if mechanism.points:
        constants.append(point_bodies([point.body for point in mechanism.points]))
    return tuple(constants)


def tree_geometry(tree: "Tree") -> tuple[Constant, ...]:
    """Gravity, centres of mass, nodes, bodies of hinge points and nodes, bodies and points of closures."""
    bodies = [hinge.parent for hinge in tree.hinges]
    centres = np.array([_centre(body) for body in tree.bodies], float)
    meaning = "centre of mass of the undeformed body, body axes"
    constants = [
        *gravity(tree.gravity),
        Constant("body/centre", ("body/body", XYZ.path), centres, "m", meaning),
    ]
    for k, body in enumerate(tree.bodies):
        if body.elastic is not None:
            bodies += len(body.elastic.masses) * [k]
            constants.append(node_geometry(body.name, body.elastic.positions))
    constants.append(point_bodies(bodies))
    if tree.closures:
        pairs = [(closure.a, closure.b) for closure in tree.closures]
        constants += joint_geometry(pairs, [_closed_points(tree, closure) for closure in tree.closures])
    return tuple(constants)


def joint_geometry(pairs: list[tuple[int, int]], points: list[Any]) -> list[Constant]:
    """Bodies `pairs` (joint, 2), -1 for the ground, and `points` (joint, 2, 3) of joints, body axes."""
    return [
        Constant(
            "joint/body", OF_JOINT, 1 + np.array(pairs, np.int32), "1", "number of the body, 0 for the ground"
        ),
        Constant(
            "joint/point",
            (*OF_JOINT, XYZ.path),
            np.array(points, float),
            "m",
            "point of the joint on its body, undeformed, body axes",
        ),
    ]


def point_bodies(bodies: list[int]) -> Constant:
    """Bodies of all points, -1 for the ground."""
    numbers = 1 + np.array(bodies, np.int32)
    return Constant(
        "point/body", ("point/point",), numbers, "1", "number of the point's body, 0 for the ground"
    )


def node_geometry(body: str, positions: np.ndarray) -> Constant:
    """Undeformed nodes (node, 3) of a flexible body, along the axis of its displacements."""
    axes = (f"elastic/{body}/node", XYZ.path)
    meaning = f"undeformed position of the nodes of {body}, axes of the body"
    return Constant(f"elastic/{body}/node_position", axes, np.array(positions, float), "m", meaning)


def shape_geometry(body: str, r0: np.ndarray, Phi: np.ndarray) -> tuple[Constant, ...]:
    """Undeformed nodes `r0` (n, 3) and the modes `Phi` (3 n, N) of a body whose amplitudes are kept.

    shape @ amplitude is the displacement of the nodes, body axes.
    """
    axes = (f"elastic/{body}/node", XYZ.path, f"modal/{body}/mode")
    meaning = f"displacement of the nodes of {body} per unit of each mode, axes of the body"
    shape = Phi.reshape(len(r0), 3, -1)
    return (node_geometry(body, r0), Constant(f"elastic/{body}/shape", axes, shape, "1 or m", meaning))


def _centre(body: "Body") -> np.ndarray | tuple[float, float, float]:
    """Return what a flexible body's nodes leave of its mass sits at its origin."""
    if body.elastic is None:
        return body.centre
    return body.elastic.masses @ body.elastic.positions / max(body.mass, body.elastic.masses.sum())


def _closed_points(tree: "Tree", closure: "Closure") -> list[tuple[float, float, float]]:
    sides = ((closure.a, closure.a_node, closure.a_point), (closure.b, closure.b_node, closure.b_point))
    return [_point_on(tree.bodies[body], node, point) for body, node, point in sides]


def _point_on(body: "Body", node: int | None, point: tuple[float, float, float]) -> Any:
    """Return a point of a body, or its undeformed node."""
    return point if node is None or body.elastic is None else body.elastic.positions[node]
