"""Tree → records of frames, nodal masses and node frames.

A *frame* is a body or a node that carries a hinge or closure: such a node is a point mass on
translational hinges along the axes of its body, so that one recursion serves both.  The other nodes
are *nodal masses*, which end the tree and are cheaper.  Frames stand in the order of the bodies, a body's
carrying nodes right after it: a parent always comes before its children.  Frame 0 is the inertial
frame.  Hinges that turn with the slope of their node hang on *node frames* instead, see
`model.arrays.node_frames`.
"""

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ..tree import ELASTIC, INERTIAL, ROTATION, TRANSLATION, UNTURNED, Body, Tree

FRAME = np.dtype(
    [
        ("parent", np.int64),  # frame
        ("body", np.int64),  # number of the body it is, or belongs to
        ("rotations", np.int64),  # free rotations, 0-3
        ("rotation_axes", np.int64, 3),  # 0, 1, 2 in the P_k frame; the first `rotations` count
        ("first_rotation", np.int64),  # coordinate of the first rotation, the others follow
        ("ball", np.int64),  # number among the hinges with three rotations, -1 otherwise
        ("translations", np.int64),  # free translations, 0-3
        ("translation_axes", np.int64, 3),  # 0, 1, 2 in the P_k frame; the first `translations` count
        ("first_translation", np.int64),  # coordinate of the first translation, the others follow
        ("point", np.float64, 3),  # P_k from the parent's origin, parent's axes, m
        ("framed", np.int64),  # whether `frame` turns anything
        ("frame", np.float64, 9),  # P_k axes -> parent's axes, row by row
        ("turned", np.int64),  # whether `attitude` turns anything
        ("attitude", np.float64, 9),  # O_k axes -> P_k axes when no rotation is free
        ("mass", np.float64),  # without nodal masses and carrying nodes, kg
        ("moment", np.float64, 3),  # mass times centre of mass, own axes, kg m
        ("inertia", np.float64, 6),  # xx xy xz yy yz zz about the origin, without nodal masses, own axes
        ("force", np.float64, 3),  # at the origin, inertial axes, N
        ("torque", np.float64, 3),  # inertial axes, N m
        ("first_nodal_mass", np.int64),  # number of its first NODAL_MASS, the others follow
        ("nodal_masses", np.int64),  # how many it has
        ("node_frame", np.int64),  # number among the node frames, -1 otherwise
        ("flexible_parent", np.int64),  # number among the flexible parents, -1 otherwise
    ]
)

NODAL_MASS = np.dtype(
    [
        ("position", np.float64, 3),  # undeformed, in the axes of its body, m
        ("mass", np.float64),  # kg
        ("force", np.float64, 3),  # constant, inertial axes, N
        ("coordinate", np.int64, 3),  # of the displacement along axis 1, 2, 3; -1 where held
    ]
)


def rotation_matrix(attitude: np.ndarray | tuple[float, float, float, float]) -> np.ndarray:
    """Rotation matrix (3, 3) of Euler parameters e0..e3, which need not be normalised."""
    e0, *vector_part = np.array(attitude, float) / math.hypot(*attitude)
    e = np.array(vector_part)
    cross = np.array([[0, -e[2], e[1]], [e[2], 0, -e[0]], [-e[1], e[0], 0]])
    return 2 * np.outer(e, e) + (2 * e0 * e0 - 1) * np.eye(3) + 2 * e0 * cross


@dataclass(frozen=True, eq=False)
class FrameParts:
    """Records on their way into arrays, and which frame is whose."""

    frames: list[Any]
    nodal_masses: list[Any] = field(default_factory=list)
    of_body: list[Any] = field(default_factory=list)
    # By (body, node, hinge that turns with the slope or None).
    of_node: dict[tuple[int, int, int | None], int] = field(default_factory=dict)
    node_frames: list[Any] = field(default_factory=list)
    flexible_parent: list[Any] = field(default_factory=list)
    slopes: list[Any] = field(default_factory=list)


def tree_frames(tree: Tree, index: dict[Any, Any]) -> FrameParts:
    """Frames, nodal masses and node frames of all bodies; `index` finds a coordinate by (body, motion, axis,
    node).
    """
    parts = FrameParts([_blank_frame(0, INERTIAL)])
    carriers = _carriers(tree)
    balls = 0
    for k, body in enumerate(tree.bodies):
        frame = _body_frame(tree, k, index, parts)
        if frame["rotations"] == 3:
            frame["ball"] = balls
            balls += 1
        parts.of_body.append(len(parts.frames))
        parts.frames.append(frame)
        own = [carrier for carrier in carriers if carrier[0] == k]
        if any(hinge is not None for _, _, hinge in own):
            _add_node_frames(tree, k, own, index, parts)
            own = []
        for _, node, _ in own:
            parts.of_node[k, node, None] = len(parts.frames)
            parts.frames.append(_node_frame(body, k, node, parts.of_body[k], index))
        _add_nodal_masses(body, k, {node for _, node, _ in own}, index, parts)
    return parts


def _add_node_frames(
    tree: Any, k: int, carriers: list[tuple[int, int, int]], index: dict[Any, Any], parts: FrameParts
) -> None:
    """Node frames at all carrying nodes of a body; they have no slope where nothing turns."""
    elastic, frame = tree.bodies[k].elastic, parts.of_body[k]
    first, count = index[k, ELASTIC, elastic.axes[0], 0], elastic.coordinates
    parts.frames[frame]["flexible_parent"] = len(parts.flexible_parent)
    parts.flexible_parent.append((frame, len(parts.node_frames), len(carriers), first, count))
    for _, node, hinge in carriers:
        node_frame = _blank_frame(frame, k)
        node_frame["point"], node_frame["node_frame"] = elastic.positions[node], len(parts.node_frames)
        parts.of_node[k, node, hinge] = len(parts.frames)
        own = tuple(_node_coordinates(tree.bodies[k], k, node, index))
        parts.node_frames.append((len(parts.frames), own, first, count, sum(map(np.size, parts.slopes))))
        parts.frames.append(node_frame)
        still = np.zeros((3, count))
        parts.slopes.append(still if hinge is None else tree.hinges[hinge].elastic_rotation)


def _add_nodal_masses(
    body: Body, k: int, carrying: set[int], index: dict[Any, Any], parts: FrameParts
) -> None:
    """Nodal masses for the nodes that have no frame of their own."""
    nodes = range(len(body.elastic.masses) if body.elastic else 0)
    frame = parts.frames[parts.of_body[k]]
    frame["first_nodal_mass"] = len(parts.nodal_masses)
    parts.nodal_masses.extend(_nodal_mass(body, k, node, index) for node in nodes if node not in carrying)
    frame["nodal_masses"] = len(parts.nodal_masses) - frame["first_nodal_mass"]


def _carriers(tree: Tree) -> list[Any]:
    """(body, node, hinge) of all nodes that carry something, the hinge when it turns with the slope."""
    carriers = {
        (hinge.parent, hinge.node, k if hinge.elastic_rotation is not None else None)
        for k, hinge in enumerate(tree.hinges)
        if hinge.node is not None
    }
    for c in tree.closures:
        carriers |= {
            (body, node, None) for body, node in ((c.a, c.a_node), (c.b, c.b_node)) if node is not None
        }
    return sorted(carriers, key=lambda carrier: (*carrier[:2], -1 if carrier[2] is None else carrier[2]))


def _blank_frame(parent: int, body: int) -> np.ndarray:
    frame = np.zeros(1, FRAME)
    frame["parent"], frame["body"] = parent, body
    for number in ("ball", "node_frame", "flexible_parent"):
        frame[number] = -1
    return frame


def _body_frame(tree: Tree, k: int, index: dict[Any, Any], parts: FrameParts) -> np.ndarray:
    body, hinge = tree.bodies[k], tree.hinges[k]
    parent, point = _attachment(tree, k, parts)
    frame = _blank_frame(parent, k)
    frame["point"] = point
    _set_axes(frame, "rotation", hinge.rotations, index, k, ROTATION)
    _set_axes(frame, "translation", hinge.translations, index, k, TRANSLATION)
    frame["framed"] = tuple(hinge.frame) != UNTURNED
    frame["frame"] = rotation_matrix(hinge.frame).ravel()
    frame["turned"] = not hinge.rotations and tuple(hinge.attitude) != UNTURNED
    frame["attitude"] = rotation_matrix(hinge.attitude).ravel()
    frame["force"], frame["torque"] = body.force, body.torque
    _set_mass(frame, body)
    return frame


def _attachment(tree: Any, k: int, parts: FrameParts) -> tuple[int, np.ndarray | tuple[float, float, float]]:
    """Parent frame of hinge k, and P_k in it: a carrying node has its origin at P_k."""
    hinge = tree.hinges[k]
    if hinge.parent == INERTIAL:
        return 0, hinge.point
    if hinge.node is None:
        return parts.of_body[hinge.parent], hinge.point
    node = tree.bodies[hinge.parent].elastic.positions[hinge.node]
    turning = k if hinge.elastic_rotation is not None else None
    return parts.of_node[hinge.parent, hinge.node, turning], np.subtract(hinge.point, node)


def _set_axes(
    frame: np.ndarray, kind: str, axes: tuple[int, ...], index: dict[Any, Any], body: int, motion: str
) -> None:
    frame[f"{kind}s"] = len(axes)
    frame[f"{kind}_axes"][0, : len(axes)] = np.array(axes, int) - 1
    frame[f"first_{kind}"] = index[body, motion, axes[0], None] if axes else 0


def _set_mass(frame: np.ndarray, body: Body) -> None:
    """Own mass and inertia: what the nodes leave of the body's."""
    inertia, mass = np.array(body.inertia, float), body.mass
    if body.elastic is not None:
        mass -= float(np.sum(body.elastic.masses))
        for m, x in zip(body.elastic.masses, body.elastic.positions, strict=True):
            inertia -= m * (x @ x * np.eye(3) - np.outer(x, x))
    else:
        frame["moment"] = body.mass * np.array(body.centre)
    frame["mass"] = mass
    frame["inertia"] = inertia[np.triu_indices(3)]


def _node_coordinates(body: Body, k: int, node: int, index: dict[Any, Any]) -> list[int]:
    return [index.get((k, ELASTIC, axis, node), -1) for axis in (1, 2, 3)]


def _node_frame(body: Any, k: int, node: int, parent: int, index: dict[Any, Any]) -> np.ndarray:
    frame = _blank_frame(parent, k)
    elastic = body.elastic
    frame["point"] = elastic.positions[node]
    frame["translations"] = len(elastic.axes)
    frame["translation_axes"][0, : len(elastic.axes)] = np.array(elastic.axes) - 1
    frame["first_translation"] = index[k, ELASTIC, elastic.axes[0], node]
    frame["mass"] = elastic.masses[node]
    frame["force"] = elastic.forces[node]
    return frame


def _nodal_mass(body: Body, k: int, node: int, index: dict[Any, Any]) -> tuple[Any, Any, Any, Any]:
    elastic = body.elastic
    assert elastic is not None, "nodal masses are those of an elastic body"
    return (
        tuple(elastic.positions[node]),
        elastic.masses[node],
        tuple(elastic.forces[node]),
        tuple(_node_coordinates(body, k, node, index)),
    )
