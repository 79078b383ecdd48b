"""Joint coordinates, elements at joints and couplings in results of every dialect."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from ...model.joint_elements import Coupling
from ...model.joints import ANGLE
from ...model.laws import is_angle
from .layout import Layout, Series, Values, numbered_axis, with_units

COORDINATE, ELEMENT, COUPLING = "coordinate/coordinate", "element/element", "coupling/coupling"
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
OF_ELEMENTS = ELEMENT_SERIES | COUPLING_SERIES
SERIES = JOINT_SERIES | OF_ELEMENTS


def with_elements(
    layout: Layout,
    coordinates: Sequence[tuple[str, str]],
    elements: Sequence[tuple[str, str]],
    couplings: Sequence[Coupling],
) -> Layout:
    """The layout with axes and series of joint coordinates and elements, pairs of name and unit, and
    couplings.
    """
    axes = list(layout.axes)
    of_couplings = [(item.name, _coupling_unit(item)) for item in couplings]
    for kind, names in (("coordinate", coordinates), ("element", elements), ("coupling", of_couplings)):
        if names:
            texts, units = zip(*names, strict=True)
            axes.append(with_units(numbered_axis(kind, texts), kind, units))
    present = {axis.path for axis in axes}
    # A tree has series of its coordinates already.
    wanted = SERIES if coordinates else OF_ELEMENTS
    # What all elements together dissipate has no axis, but belongs to theirs.
    series = [item for item in wanted.values() if present.issuperset(item.axes or (ELEMENT,))]
    return replace(layout, axes=tuple(axes), series=(*layout.series, *series))


def _coupling_unit(item: Coupling) -> str:
    """Unit of the effort at a factor of 1: a coupling of a stroke is an equation of lengths."""
    return "N m" if all(is_angle(coordinate) for _, coordinate, _ in item.terms) else "N"


def joint_values(rows: Any, series: dict[str, Series] = SERIES) -> Values:
    """Fields of report rows by the paths of their datasets."""
    return {item.path: getattr(rows, field) for field, item in series.items()}


def coordinate_names(joints: Sequence[Any], names: Sequence[str]) -> list[tuple[str, str]]:
    """Names and units of all joint coordinates; `names` of the joints."""
    from ...model.arrays.element_table import coordinates_of_joints  # much that trees do without

    return [
        (f"{names[item.joint]} {item.coordinate}", "rad" if item.coordinate == ANGLE else "m")
        for item in coordinates_of_joints(joints)
    ]
