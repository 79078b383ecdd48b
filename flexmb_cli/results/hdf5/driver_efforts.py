"""Efforts of drivers in a result: a force along a coordinate, or a torque about an axis."""

from collections.abc import Sequence
from dataclasses import replace

from .layout import Axis, Series

FORCE, TORQUE = "N", "N m"
DRIVER, PATH = "driver/driver", "driver/effort"
_UNIT = "unit of the driver's effort"


def effort_series(series: Series, units: Sequence[str]) -> Series:
    """The series of efforts in the unit of all drivers, or in either where they differ."""
    return replace(series, units=" or ".join(unit for unit in (FORCE, TORQUE) if unit in units))


def driver_axis_with_units(axis: Axis, units: Sequence[str]) -> Axis:
    """The axis of drivers with the unit of each along it, `/driver/unit`; another axis as it is."""
    if axis.path != DRIVER:
        return axis
    return replace(axis, labels=(*axis.labels, ("driver/unit", tuple(units), _UNIT)))
