"""Content of the HDF5 result of a mechanism's dynamics beyond its kinematics."""

from dataclasses import replace
from typing import TYPE_CHECKING

from ...model.loads import DynamicModel, holders
from .driver_efforts import DRIVER, FORCE, PATH, TORQUE, driver_axis_with_units, effort_series
from .kinematic import kinematic_layout, kinematic_values
from .layout import Axis, Layout, Series, Values, numbered_axis
from .motion_series import JOINT_VECTOR
from .result_geometry import gravity

if TYPE_CHECKING:
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
    axes = (*(driver_axis_with_units(axis, units) for axis in motion.axes), *_held_axis(model))
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


def _held_axis(model: DynamicModel) -> list[Axis]:
    names = [name for name, _ in holders(model.mechanism)]
    return [numbered_axis("held", names)] if names else []
