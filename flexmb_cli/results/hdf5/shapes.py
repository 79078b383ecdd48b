"""Shapes of rigid bodies in a result: the surfaces of all shapes of a model, one behind the other."""

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from .layout import XYZ, Axis, Constant, Layout

if TYPE_CHECKING:  # few decks have any
    from ...model.shapes import Shape

VERTEX, TRIANGLE, CORNER = "shape/vertex", "shape/triangle", "shape/corner"
POSITION, BODY, CORNERS = "shape/position", "shape/body", "shape/vertices_of_triangle"


def with_shapes(layout: Layout, shapes: Sequence["Shape"]) -> Layout:
    """Return the layout with the surfaces of `shapes`, where there are any.

    Vertices are counted from 1 through all shapes.
    """
    if not shapes:
        return layout
    counts = [len(shape.vertices) for shape in shapes]
    firsts = np.concatenate([[0], np.cumsum(counts)[:-1]])
    triangles = [shape.triangles + first for shape, first in zip(shapes, firsts, strict=True)]
    corners = 1 + np.concatenate(triangles).astype(np.int32)
    owners = np.repeat(np.array([shape.body for shape in shapes], np.int32), counts)
    axes = (
        Axis(VERTEX, tuple(range(1, sum(counts) + 1)), "vertex of the shapes"),
        Axis(TRIANGLE, tuple(range(1, len(corners) + 1)), "triangle of the shapes"),
        Axis(CORNER, (1, 2, 3), "corner of a triangle, anticlockwise from outside"),
    )
    places = np.concatenate([shape.vertices for shape in shapes])
    constants = (
        Constant(POSITION, (VERTEX, XYZ.path), places, "m", "vertices of the shapes, axes of their bodies"),
        Constant(BODY, (VERTEX,), owners, "1", "number of the vertex's body, 0 for the ground"),
        Constant(CORNERS, (TRIANGLE, CORNER), corners, "1", "vertices of the triangles of the shapes"),
    )
    return replace(layout, axes=(*layout.axes, *axes), constants=(*layout.constants, *constants))
