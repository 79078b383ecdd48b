"""Motion of the hinge points P_k and of the nodes of a tree, from its report rows.

DAFMS thesis (Zhao, 1992), eqs. (2.7) ff.: a point of body k lies at s + u from O_k in O_k axes, where
u is the elastic displacement of its node; u and its rates are coordinates, speeds and their rates.
"""

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from ...model.tree import INERTIAL, Tree
from .rows import TreeRows, nodal


class PointMotion(NamedTuple):
    """The motion of P points over T rows, global axes."""

    position: np.ndarray  # (T, P, 3) m
    velocity: np.ndarray  # (T, P, 3) m/s
    acceleration: np.ndarray  # (T, P, 3) m/s²


def point_names(tree: Tree) -> list[str]:
    """Names of the P points: the hinges of all bodies, then the nodes of the flexible ones."""
    hinges = [f"hinge {k}" for k in range(1, len(tree.bodies) + 1)]
    return hinges + [f"{tree.bodies[k].name} node {i + 1}" for k, i in _nodes(tree)]


def point_motion(tree: Tree, rows: TreeRows) -> PointMotion:
    """Motion of the points in the order of `point_names`."""
    elastic = [nodal(tree, values) for values in (rows.q, rows.y, rows.y_rate)]
    points = [_hinge_point(tree, rows, k, elastic) for k in range(len(tree.bodies))]
    for k, body in enumerate(tree.bodies):
        if body.elastic is not None:
            u, *rates = (values[k] for values in elastic)
            points.append(_carried(rows, k, body.elastic.positions + u, *rates))
    return PointMotion(*(np.concatenate(parts, axis=1) for parts in zip(*points, strict=True)))


def _nodes(tree: Tree) -> Iterator[tuple[int, int]]:
    for k, body in enumerate(tree.bodies):
        for i in range(len(body.elastic.masses) if body.elastic else 0):
            yield k, i


def _hinge_point(tree: Tree, rows: TreeRows, k: int, elastic: list[Any]) -> PointMotion:
    hinge = tree.hinges[k]
    count = len(rows.time)
    place = np.broadcast_to(np.array(hinge.point, float), (count, 1, 3))
    still = np.zeros((count, 1, 3))
    if hinge.parent == INERTIAL:
        return PointMotion(place, still, still)
    if hinge.node is None:
        return _carried(rows, hinge.parent, place, still, still)
    u, *rates = (values[hinge.parent][:, [hinge.node]] for values in elastic)
    return _carried(rows, hinge.parent, place + u, *rates)


def _carried(rows: TreeRows, k: int, place: np.ndarray, rate: np.ndarray, second: np.ndarray) -> PointMotion:
    """Motion of points at `place` (T, n, 3) in the axes of body k, moving there with `rate`, `second`."""
    axes = rotation_matrices(rows.euler_parameters[:, k])
    r, slide, push = (np.einsum("tij,tnj->tni", axes, values) for values in (place, rate, second))
    omega, alpha = rows.angular_velocity[:, None, k], rows.angular_acceleration[:, None, k]
    swept = np.cross(omega, r)
    return PointMotion(
        rows.position[:, None, k] + r,
        rows.velocity[:, None, k] + swept + slide,
        rows.acceleration[:, None, k] + np.cross(alpha, r) + np.cross(omega, swept + 2.0 * slide) + push,
    )


def rotation_matrices(p: np.ndarray) -> np.ndarray:
    """Rotation matrices (T, 3, 3), body axes to global axes, of Euler parameters (T, 4)."""
    e0, e = p[:, 0, None, None], p[:, 1:]
    turn = np.zeros((len(p), 3, 3))
    turn[:, 2, 1], turn[:, 0, 2], turn[:, 1, 0] = e.T
    turn -= turn.transpose(0, 2, 1)
    return 2.0 * e[:, :, None] * e[:, None, :] + (2.0 * e0 * e0 - 1.0) * np.eye(3) + 2.0 * e0 * turn
