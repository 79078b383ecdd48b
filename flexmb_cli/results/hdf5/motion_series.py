"""Datasets of the motion of bodies and points, by the names that analyses give these quantities."""

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from .layout import XYZ, Axis, Constant, Layout, Series

if TYPE_CHECKING:
    from ...model.shapes import Shape


BODY_VECTOR = ("body/body", "xyz")
JOINT_VECTOR = ("joint/joint", "xyz")
BODY_PARAMETERS = ("body/body", "euler_parameter")
POINT_VECTOR = ("point/point", "xyz")

BODY_MOTION = {
    "position": Series("body/position", BODY_VECTOR, "m", "origin of the body frame, global axes"),
    "euler_parameters": Series(
        "body/euler_parameters", BODY_PARAMETERS, "1", "Euler parameters, body to global"
    ),
    "velocity": Series("body/velocity", BODY_VECTOR, "m/s", "velocity of the origin, global axes"),
    "euler_parameter_rates": Series(
        "body/euler_parameter_rates", BODY_PARAMETERS, "1/s", "rates of Euler parameters"
    ),
    "acceleration": Series(
        "body/acceleration", BODY_VECTOR, "m/s2", "acceleration of the origin, global axes"
    ),
    "euler_parameter_accelerations": Series(
        "body/euler_parameter_accelerations",
        BODY_PARAMETERS,
        "1/s2",
        "second derivatives of Euler parameters",
    ),
    "angular_velocity": Series(
        "body/angular_velocity", BODY_VECTOR, "rad/s", "angular velocity, global axes"
    ),
    "angular_acceleration": Series(
        "body/angular_acceleration", BODY_VECTOR, "rad/s2", "angular acceleration, global axes"
    ),
}
POINT_MOTION = {
    "point_position": Series("point/position", POINT_VECTOR, "m", "position of the point, global axes"),
    "point_velocity": Series("point/velocity", POINT_VECTOR, "m/s", "velocity of the point, global axes"),
    "point_acceleration": Series(
        "point/acceleration", POINT_VECTOR, "m/s2", "acceleration of the point, global axes"
    ),
}


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
