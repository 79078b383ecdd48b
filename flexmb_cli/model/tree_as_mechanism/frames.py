"""Frames that carry the hinges of a tree when every body has coordinates of its own.

A hinge sits on a *base*: a point P_k of a body, moving with a node where it has one, and the axes of
P_k.  Where P_k turns with the slope of its node (DAFMS thesis, 1992, eqs. 2.7 and 2.24), massless
*node frames* stand between the body and the base, one for each axis it turns about.  Bodies are numbered
as in the tree, node frames behind them; -1 is the inertial frame.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...errors import Fault, ModelError
from ..laws import MOTOR, At, Cam
from ..tree import INERTIAL, Hinge, Tree
from ..vectors import rotation_matrix

RIGID = np.zeros((3, 0))


@dataclass(frozen=True, eq=False)
class Base:
    """A point `place + shape @ eta` (3,) of a body, and `axes` (3, 3) in its columns, all in body axes."""

    body: int
    place: np.ndarray
    shape: np.ndarray
    axes: np.ndarray


@dataclass(frozen=True, eq=False)
class NodeFrame:
    """A massless body at the point of `base`, turned about its `axis` (0, 1, 2) by `slope @ eta`.

    `slope` (NM,): of the elastic coordinates of body `owner`.
    """

    name: str
    base: Base
    axis: int
    owner: int
    slope: np.ndarray


@dataclass(frozen=True, eq=False)
class Frames:
    """The bases of all hinges, and the node frames that some stand on."""

    bases: tuple[Base, ...]
    node_frames: tuple[NodeFrame, ...]


def hinge_frames(tree: Tree) -> Frames:
    """Bases and node frames of a tree."""
    bases, node_frames = [], []
    for k, hinge in enumerate(tree.hinges):
        base = Base(hinge.parent, np.array(hinge.point, float), node_shape(tree, hinge), np.eye(3))
        for axis in range(3):
            slope = RIGID[0] if hinge.elastic_rotation is None else hinge.elastic_rotation[axis]
            if np.any(slope):
                name = f"slope {axis + 1} at the hinge of {tree.bodies[k].name}"
                node_frames.append(NodeFrame(name, base, axis, hinge.parent, np.array(slope, float)))
                base = Base(len(tree.bodies) + len(node_frames) - 1, np.zeros(3), RIGID, np.eye(3))
        bases.append(Base(base.body, base.place, base.shape, rotation_matrix(hinge.frame)))
    return Frames(tuple(bases), tuple(node_frames))


def node_shape(tree: Tree, hinge: Hinge) -> np.ndarray:
    """Displacement (3, NM) of P_k per unit of each elastic coordinate of the parent."""
    if hinge.parent == INERTIAL:
        return RIGID
    elastic = tree.bodies[hinge.parent].elastic
    return RIGID if elastic is None else shape_of(elastic, hinge.node)


def shape_of(elastic: Any, node: int | None) -> np.ndarray:
    """Displacement (3, NM) of a node per unit of each elastic coordinate; zeros for None."""
    shape = np.zeros((3, elastic.coordinates))
    if node is not None:
        for i, axis in enumerate(elastic.axes):
            shape[axis - 1, node * len(elastic.axes) + i] = 1.0
    return shape


OTHERWISE = "run the deck by --formulation kane"


def refuse_foreign(tree: Tree) -> None:
    """Raise ModelError with every item of the tree that only Kane's equations can treat here."""
    faults = [fault for find in (_one_way, _weights, _balls) for fault in find(tree)]
    if faults:
        raise ModelError(faults)


def _one_way(tree: Tree) -> Iterator[Any]:
    if tree.one_way:
        message = (
            "the one-way assumption (UNCO) does not exist in absolute coordinates; "
            f"{OTHERWISE}, or leave out UNCO"
        )
        yield Fault("error", message, id="MODEL-006")


def _weights(tree: Tree) -> Iterator[Any]:
    """Yield a fault for geometric stiffening by gravity: the floating frame has that by rotation only."""
    for body in tree.bodies:
        stiffened = body.elastic is not None and body.elastic.stiffened_from is not None
        if stiffened and any(tree.gravity):
            message = (
                "GSTF with gravity: in absolute coordinates a beam is stiffened by turning only; set GRAV "
                f"to zero, or {OTHERWISE}"
            )
            yield Fault("error", message, body.place, body.name, id="MODEL-007")


def _balls(tree: Tree) -> Iterator[Any]:
    """Yield a fault for what acts about one of three free rotations: none is a coordinate of a position."""
    for item in tree.elements.forces:
        if (
            item.turning
            and isinstance(item.measure, At | Cam)
            and len(tree.hinges[item.measure.joint].rotations) == 3
        ):
            message = (
                f"a {'motor' if item.law is MOTOR else 'damper'} in a hinge with three free rotations is not "
                f"carried over to absolute coordinates; {OTHERWISE}"
            )
            yield Fault("error", message, item.place, item.name, id="MODEL-008")
