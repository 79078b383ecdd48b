"""Content of the HDF5 result of a YOUNG deck with elements at joints beyond its dynamics."""

from dataclasses import replace
from typing import TYPE_CHECKING

from ...model.joint_elements import CompositeJoint, element_names
from ...model.joints import ANGLE
from ...model.loads import DynamicModel
from .driver_efforts import DRIVER, FORCE, PATH, TORQUE, effort_series
from .dynamic import FORCES, dynamic_layout, dynamic_values
from .joint_coordinates import coordinate_names, joint_values, with_elements, with_units
from .kinematic import readable_names
from .layout import Layout, Series, Values, numbered_axis

if TYPE_CHECKING:
    from ...solvers.constrained.element_rows import ElementRows


COMPOSITE_VECTOR = ("composite/composite", "xyz")
COMPOSITE_SERIES = {
    "composite_force": Series(
        "composite/force", COMPOSITE_VECTOR, "N", "force on body J of the composite joint, global axes"
    ),
    "composite_torque": Series(
        "composite/torque", COMPOSITE_VECTOR, "N m", "torque on body J about its point P_j, global axes"
    ),
}


def element_layout(model: DynamicModel) -> Layout:
    """Axes and series of a run with elements."""
    found = dynamic_layout(model)
    drivers = _driver_names(model)
    axes = [axis for axis in found.axes if axis.path != DRIVER]
    series = [item for item in found.series if item.path != PATH]
    if drivers:
        names, units = zip(*drivers, strict=True)
        axes.append(with_units(numbered_axis("driver", names), "driver", units))
        series.append(effort_series(FORCES["driver_effort"], units))
    joints = model.mechanism.joints
    coordinates = coordinate_names(joints, readable_names("joint", joints))
    layout = replace(found, axes=tuple(axes), series=tuple(series))
    found = with_elements(layout, coordinates, element_names(model), model.elements.couplings)
    return _with_composites(found, model.elements.composites)


def element_values(model: DynamicModel, rows: "ElementRows") -> Values:
    """The fields of report rows (`ElementRows`) by the paths of their datasets."""
    return {**dynamic_values(model, rows), **joint_values(rows), **joint_values(rows, COMPOSITE_SERIES)}


def _with_composites(layout: Layout, composites: tuple[CompositeJoint, ...]) -> Layout:
    """The layout with the forces of composite joints, if there are any."""
    if not composites:
        return layout
    axis = numbered_axis("composite", [item.name for item in composites])
    series = (*layout.series, *COMPOSITE_SERIES.values())
    return replace(layout, axes=(*layout.axes, axis), series=series)


def _driver_names(model: DynamicModel) -> list[tuple[str, str]]:
    mechanism = model.mechanism
    units = [FORCE if driver.direction <= 3 else TORQUE for driver in mechanism.drivers]
    own = list(zip(readable_names("driver", mechanism.drivers), units, strict=True))
    return own + [
        (item.name, TORQUE if item.coordinate == ANGLE else FORCE) for item in model.elements.drivers
    ]
