"""Loads of a tree on bodies with coordinates of their own: records of `records.LOAD`."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from ..arrays.constraint_table import PrimitiveTable
from ..arrays.laws import NONE
from ..arrays.records import FORCE, TORQUE, blank_load
from ..tree import Tree
from .frames import shape_of


def tree_loads(table: PrimitiveTable, tree: Tree) -> Iterator[np.ndarray]:
    """Yield all loads but gravity, elasticity and elements."""
    for k, body in enumerate(tree.bodies):
        yield from _load(FORCE, table.body_vector(k, np.zeros(3)), body.force)
        yield from _load(TORQUE, table.body_vector(k, np.zeros(3)), body.torque)
        if elastic := body.elastic:
            for node, position in enumerate(elastic.positions):
                place = table.body_vector(k, position, shape_of(elastic, node))
                yield from _load(FORCE, place, elastic.forces[node])
    for torque in tree.torques:
        body_vector, axis = table.body_vector(torque.body, np.zeros(3)), np.eye(3)[torque.axis - 1]
        yield from _load(TORQUE, body_vector, axis, table.function(torque.function))


def _load(kind: int, body_vector: int, vector: Any, function: int = NONE) -> Iterator[np.ndarray]:
    """The record of a force or torque along global axes; none where it is zero."""
    if np.any(vector):
        record = blank_load(kind)
        record["body_vector"], record["vector"], record["function"] = body_vector, vector, function
        yield record
