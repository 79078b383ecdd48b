"""Content of the HDF5 result of a mechanism's dynamics beyond its kinematics, and of elements at joints."""

from dataclasses import replace
from typing import TYPE_CHECKING

from ...model.joint_elements import CompositeJoint
from ...model.laws import is_angle
from ...model.loads import DynamicModel, holders
from .applied_loads import with_applied_loads, with_load_values
from .kinematic import kinematic_layout, kinematic_values, readable_names
from .layout import (
    DRIVER,
    FORCE,
    JOINT_VECTOR,
    PATH,
    TORQUE,
    Layout,
    Series,
    Values,
    effort_series,
    element_values,
    numbered_axis,
    with_elements,
    with_units,
)
from .result_geometry import gravity

if TYPE_CHECKING:
    from ...solvers.constrained.element_rows import ElementRows
    from ...solvers.constrained.rows import DynamicRows


HELD_VECTOR = ("held/held", "xyz")
FORCES = {
    "reaction_force": Series(
        "reaction/force", JOINT_VECTOR, "N", "force on body J at the joint, global axes"
    ),
    "reaction_torque": Series(
        "reaction/torque", JOINT_VECTOR, "N m", "torque on body J at the joint, global axes"
    ),
    "driver_effort": Series(PATH, (DRIVER,), "N or N m", "force or torque along the driver's direction"),
    "holding_force": Series(
        "held/force", HELD_VECTOR, "N", "force of a holding constraint on its body, global axes"
    ),
    "holding_torque": Series(
        "held/torque",
        HELD_VECTOR,
        "N m",
        "torque of a holding constraint about the body's origin, global axes",
    ),
    "kinetic": Series("energy/kinetic", (), "J", "kinetic energy"),
    "potential": Series("energy/potential", (), "J", "potential energy of gravity and springs"),
    "applied_power": Series("energy/applied_power", (), "W", "power of drivers, forces, torques and dampers"),
}
OF_MOTION = {
    "applied_work": Series("energy/applied_work", (), "J", "work of drivers and loads since the start"),
    "total": Series("energy/total", (), "J", "kinetic + potential - applied work: constant but for errors"),
}


def dynamic_layout(model: DynamicModel) -> Layout:
    """Axes and series of a forward run, or of an inverse one, which does not know the work done."""
    motion = kinematic_layout(model.mechanism)
    units = [FORCE if driver.direction <= 3 else TORQUE for driver in model.mechanism.drivers]
    of_motion = (with_units(axis, "driver", units) if axis.path == DRIVER else axis for axis in motion.axes)
    held = [name for name, _ in holders(model.mechanism)]
    axes = (*of_motion, *([numbered_axis("held", held)] if held else []))
    present = {axis.path for axis in axes}
    forces = tuple(
        effort_series(item, units) if item.path == PATH else item
        for item in _series(model).values() if present.issuperset(item.axes)
    )  # fmt: skip
    constants = (*motion.constants, *gravity(model.gravity))
    series = (*motion.series, *forces)
    return replace(motion, analysis="dynamic", axes=axes, series=series, constants=constants)


def dynamic_values(model: DynamicModel, rows: "DynamicRows") -> Values:
    """The fields of report rows (`DynamicRows`) by the paths of their datasets."""
    values = dict(kinematic_values(rows))
    return values | {series.path: getattr(rows, field) for field, series in _series(model).items()}


def _series(model: DynamicModel) -> dict[str, Series]:
    return FORCES | OF_MOTION if model.analysis == "forward" else FORCES


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
    rows = dynamic_layout(model)
    drivers = _driver_names(model)
    axes = [axis for axis in rows.axes if axis.path != DRIVER]
    series = [item for item in rows.series if item.path != PATH]
    if drivers:
        names, units = zip(*drivers, strict=True)
        axes.append(with_units(numbered_axis("driver", names), "driver", units))
        series.append(effort_series(FORCES["driver_effort"], units))
    layout = replace(rows, axes=tuple(axes), series=tuple(series))
    rows = with_elements(layout, model.elements, model.springs)
    return with_applied_loads(_with_composites(rows, model.elements.composites), model)


def values_with_elements(model: DynamicModel, rows: "ElementRows") -> Values:
    """The fields of report rows (`ElementRows`) by the paths of their datasets."""
    own = {**dynamic_values(model, rows), **element_values(rows), **element_values(rows, COMPOSITE_SERIES)}
    return with_load_values(own, model)


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
        (item.name, TORQUE if is_angle(item.coordinate) else FORCE) for item in model.elements.drivers
    ]
