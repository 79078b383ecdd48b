"""Layout of an HDF5 result: axes, datasets along time, and datasets that stay.

Datasets of the motion of bodies and points have the names that analyses give these quantities; joint
coordinates, elements and couplings are those of every dialect.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ...model.joint_elements import COORDINATES_OF, JointElements, names_of
from ...model.joints import ANGLE
from ...model.laws import CONTACT, Element

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


COORDINATE, ELEMENT, COUPLING = "coordinate/coordinate", "element/element", "coupling/coupling"
CONTACTS, SIGNALS = "contact/contact", "signal/signal"
JOINT_SERIES = {
    "joint_coordinate": Series(
        "coordinate/q", (COORDINATE,), "rad or m", "joint coordinate, 0 at the deck's estimates"
    ),
    "joint_rate": Series("coordinate/u", (COORDINATE,), "rad/s or m/s", "rate of the joint coordinate"),
}
ELEMENT_SERIES = {
    f"element_{name}": Series(f"element/{name}", (ELEMENT,), units, long_name)
    for name, units, long_name in (
        ("coordinate", "rad or m", "length, stroke or angle; 0 of friction, see the coordinate of its joint"),
        ("rate", "rad/s or m/s", "its rate; of friction the sliding speed"),
        ("effort", "N m or N", "force or torque towards larger coordinates"),
        ("power", "W", "power of what the element dissipates (negative) or drives"),
        ("energy", "J", "energy that the element stores"),
        ("work", "J", "work of its power since the start: negative, what it has dissipated"),
    )
}
ELEMENT_SERIES["dissipated"] = Series(
    "energy/dissipated",
    (),
    "J",
    "what springs' dampers, stops, cables, bushings and friction have dissipated since the start",
)
COUPLING_SERIES = {
    "coupling_effort": Series(
        "coupling/effort",
        (COUPLING,),
        "N m or N",
        "effort, which acts times its factor in each coordinate, towards larger values",
    )
}
CONTACT_SERIES = {
    f"contact_{name}": Series(f"contact/{name}", axes, units, long_name)
    for name, axes, units, long_name in (
        ("force", (CONTACTS, "xyz"), "N", "force on the second body with its friction, global axes"),
        ("place", (CONTACTS, "xyz"), "m", "place where the force acts, global axes"),
        ("touches", (CONTACTS,), "1", "number of times that it has begun, by methods that stop for contacts"),
        ("changed", (CONTACTS,), "s", "time when it began or ended last; 0: it has not"),
    )
}
CURVES = "curve/curve"
CURVE_SERIES = {
    f"curve_{name}": Series(f"curve/{name}", axes, units, long_name)
    for name, axes, units, long_name in (
        ("position", (CURVES,), "m", "arc length of the curve from its beginning to the point"),
        ("speed", (CURVES,), "m/s", "rate of that arc length"),
        ("force", (CURVES, "xyz"), "N", "force of the curve on the point, global axes"),
    )
}
GENERALS = "general/general"
GENERAL_SERIES = {
    f"general_{name}": Series(f"general/{name}", (GENERALS, "xyz"), units, long_name)
    for name, units, long_name in (
        ("force", "N", "force of the joint on its second body, global axes"),
        ("torque", "N m", "torque of the joint on its second body about the point there, global axes"),
    )
}
ROLLS = "roll/roll"
ROLL_SERIES = {
    "roll_force": Series("roll/force", (ROLLS, "xyz"), "N", "force at the contact on what rolls, global axes")
}
SIGNAL_SERIES = {"signal_value": Series("signal/value", (SIGNALS,), "1", "value of the signal, SI units")}
OF_TRACKS = CURVE_SERIES | GENERAL_SERIES | ROLL_SERIES
OF_ELEMENTS = ELEMENT_SERIES | COUPLING_SERIES | CONTACT_SERIES | OF_TRACKS | SIGNAL_SERIES


def with_elements(layout: Layout, elements: JointElements, springs: Sequence[Element] = ()) -> Layout:
    """The layout with axes and series of elements."""
    axes = list(layout.axes)
    # The effort at a factor of 1: a coupling of a stroke is an equation of lengths.
    of_couplings = [(item.name, "N m" if item.of_angles else "N") for item in elements.couplings]
    named = list(names_of(elements, springs))
    for kind, names in (("element", named), ("coupling", of_couplings)):
        if names:
            texts, units = zip(*names, strict=True)
            axes.append(with_units(numbered_axis(kind, texts), kind, units))
    if contacts := [name for item in elements.of(CONTACT) for name, _ in item.parts]:
        axes.append(numbered_axis("contact", contacts))
    if elements.curves:
        axes.append(numbered_axis("curve", [curve.name for curve in elements.curves]))
    if elements.generals:
        axes.append(numbered_axis("general", [joint.name for joint in elements.generals]))
    if elements.rolls:
        axes.append(numbered_axis("roll", [roll.name for roll in elements.rolls]))
    if signals := [signal.name for signal in elements.signals if signal.name]:
        axes.append(numbered_axis("signal", signals))
    present = {axis.path for axis in axes}
    # What all elements together dissipate has no axis, but belongs to theirs.
    series = [item for item in OF_ELEMENTS.values() if present.issuperset(item.axes or (ELEMENT,))]
    return replace(layout, axes=tuple(axes), series=(*layout.series, *series))


def element_values(rows: Any, series: dict[str, Series] = OF_ELEMENTS) -> Values:
    """Fields of report rows by the paths of their datasets."""
    return {item.path: getattr(rows, field) for field, item in series.items()}


def coordinate_axes(joints: Sequence[Any], names: Sequence[str]) -> list[Axis]:
    """The axis of all joint coordinates, none without any; `names` of the joints."""
    named = [
        (f"{name} {coordinate}", "rad" if coordinate == ANGLE else "m")
        for joint, name in zip(joints, names, strict=True)
        for coordinate in COORDINATES_OF[joint.kind]
    ]
    if not named:
        return []
    texts, units = zip(*named, strict=True)
    return [with_units(numbered_axis("coordinate", texts), "coordinate", units)]
