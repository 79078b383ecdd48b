"""Loads of a tree on bodies with coordinates of their own: records of `records.LOAD`."""

from collections.abc import Iterator

import numpy as np

from ..arrays.constraint_table import PrimitiveTable
from ..arrays.records import FORCE, TORQUE, vector_load
from ..tree import Tree
from .frames import shape_of


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
