"""Layout of an HDF5 result: axes, datasets along time, and datasets that stay."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from ...model.shapes import Shape


Values = Mapping[str, np.ndarray]


@dataclass(frozen=True)
class Axis:
    """A dimension scale at `path`; `labels`: further texts along it, by the path of their dataset."""

    path: str
    values: tuple[Any, ...]
    long_name: str
    labels: tuple[tuple[str, tuple[str, ...], str], ...] = ()


@dataclass(frozen=True)
class Series:
    """A dataset along time: its path, the paths of its axes after time, unit and meaning."""

    path: str
    axes: tuple[str, ...]
    units: str
    long_name: str


@dataclass(frozen=True, eq=False)
class Constant:
    """A dataset that does not change with time: its path, the paths of its axes, values, unit, meaning."""

    path: str
    axes: tuple[str, ...]
    values: np.ndarray
    units: str
    long_name: str


@dataclass(frozen=True)
class Layout:
    """Layout of a result besides the deck: `rows` is the number of report rows of a whole run."""

    analysis: str
    rows: int
    axes: tuple[Axis, ...]
    series: tuple[Series, ...]
    constants: tuple[Constant, ...] = ()


TIME = Series("time", (), "s", "time")


XYZ = Axis("xyz", tuple("xyz"), "component along the axis")


EULER_PARAMETER = Axis("euler_parameter", ("e0", "e1", "e2", "e3"), "Euler parameter")


def numbered_axis(kind: str, names: Sequence[Any]) -> Axis:
    """The scale `/<kind>/<kind>`, numbers as in the deck, and `/<kind>/name` along it."""
    numbers = tuple(range(1, len(names) + 1))
    label = (f"{kind}/name", tuple(names), f"name of the {kind}")
    return Axis(f"{kind}/{kind}", numbers, f"number of the {kind} in the deck", (label,))


FORCE, TORQUE = "N", "N m"
DRIVER, PATH = "driver/driver", "driver/effort"


def effort_series(series: Series, units: Sequence[str]) -> Series:
    """The series of efforts in the unit of all drivers, or in either where they differ."""
    return replace(series, units=" or ".join(unit for unit in (FORCE, TORQUE) if unit in units))


def with_units(axis: Axis, kind: str, units: Sequence[str]) -> Axis:
    """Return the axis with the unit of each along it, such as `/driver/unit`."""
    meaning = f"unit of the {kind}'s effort" if kind in ("driver", "coupling") else f"unit of the {kind}"
    return replace(axis, labels=(*axis.labels, (f"{kind}/unit", tuple(units), meaning)))


BODY_VECTOR = ("body/body", "xyz")
JOINT_VECTOR = ("joint/joint", "xyz")
BODY_PARAMETERS = ("body/body", "euler_parameter")
POINT_VECTOR = ("point/point", "xyz")

BODY_MOTION = {
    name: Series(f"body/{name}", axes, units, long_name)
    for name, axes, units, long_name in (
        ("position", BODY_VECTOR, "m", "origin of the body frame, global axes"),
        ("euler_parameters", BODY_PARAMETERS, "1", "Euler parameters, body to global"),
        ("velocity", BODY_VECTOR, "m/s", "velocity of the origin, global axes"),
        ("euler_parameter_rates", BODY_PARAMETERS, "1/s", "rates of Euler parameters"),
        ("acceleration", BODY_VECTOR, "m/s2", "acceleration of the origin, global axes"),
        ("euler_parameter_accelerations", BODY_PARAMETERS, "1/s2", "second derivatives of Euler parameters"),
        ("angular_velocity", BODY_VECTOR, "rad/s", "angular velocity, global axes"),
        ("angular_acceleration", BODY_VECTOR, "rad/s2", "angular acceleration, global axes"),
    )
}
POINT_MOTION = {
    f"point_{name}": Series(f"point/{name}", POINT_VECTOR, units, f"{name} of the point, global axes")
    for name, units in (("position", "m"), ("velocity", "m/s"), ("acceleration", "m/s2"))
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
