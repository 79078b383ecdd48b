"""What the HDF5 result of a YOUNG deck with elements at joints holds beyond its dynamics."""

from ...model.arrays.young_elements import reported_coordinates
from ...model.element_names import element_names
from ...model.joints import ANGLE
from ...model.loads import DynamicModel
from ...quick_dataclass import replace
from .driver_efforts import DRIVER, FORCE, PATH, TORQUE, effort_series
from .dynamic import FORCES, dynamic_layout, dynamic_values
from .kinematic import readable_names
from .result_file import Axis, Layout, Series, Values, numbered_axis

COORDINATE, ELEMENT = "coordinate/coordinate", "element/element"
SERIES = {
    "joint_coordinate": Series(
        "coordinate/q", (COORDINATE,), "rad or m", "joint coordinate, 0 at the deck's estimates"
    ),
    "joint_rate": Series("coordinate/u", (COORDINATE,), "rad/s or m/s", "rate of the joint coordinate"),
    "element_coordinate": Series("element/coordinate", (ELEMENT,), "rad or m", "length, stroke or angle"),
    "element_rate": Series(
        "element/rate", (ELEMENT,), "rad/s or m/s", "its rate; of friction the sliding speed"
    ),
    "element_effort": Series(
        "element/effort", (ELEMENT,), "N m or N", "force or torque towards larger coordinates"
    ),
    "element_power": Series("element/power", (ELEMENT,), "W", "power of what the element dissipates"),
}


def element_layout(model: DynamicModel) -> Layout:
    """Axes and series of a run with elements."""
    found = dynamic_layout(model)
    drivers = _driver_names(model)
    axes = [axis for axis in found.axes if axis.path != DRIVER]
    series = [item for item in found.series if item.path != PATH]
    if drivers:
        names, units = zip(*drivers, strict=True)
        axes.append(_with_units(numbered_axis("driver", names), "driver", units))
        series.append(effort_series(FORCES["driver_effort"], units))
    for kind, names in (("coordinate", _coordinate_names(model)), ("element", element_names(model))):
        if names:
            texts, units = zip(*names, strict=True)
            axes.append(_with_units(numbered_axis(kind, texts), kind, units))
    present = {axis.path for axis in axes}
    series += [item for item in SERIES.values() if present.issuperset(item.axes)]
    return replace(found, axes=tuple(axes), series=tuple(series))


def element_values(model: DynamicModel, rows) -> Values:
    """The fields of report rows (`element_rows.ElementRows`) by the paths of their datasets."""
    values = dict(dynamic_values(model, rows))
    return values | {series.path: getattr(rows, field) for field, series in SERIES.items()}


def _with_units(axis: Axis, kind, units) -> Axis:
    meaning = f"unit of the {kind}'s effort" if kind == "driver" else f"unit of the {kind}"
    return replace(axis, labels=(*axis.labels, (f"{kind}/unit", tuple(units), meaning)))


def _driver_names(model):
    mechanism = model.mechanism
    units = [FORCE if driver.direction <= 3 else TORQUE for driver in mechanism.drivers]
    own = list(zip(readable_names("driver", mechanism.drivers), units, strict=True))
    return own + [
        (item.name, TORQUE if item.coordinate == ANGLE else FORCE) for item in model.elements.drivers
    ]


def _coordinate_names(model):
    joints = readable_names("joint", model.mechanism.joints)
    return [
        (f"{joints[item.joint]} {item.coordinate}", "rad" if item.coordinate == ANGLE else "m")
        for item in reported_coordinates(model.mechanism)
    ]
