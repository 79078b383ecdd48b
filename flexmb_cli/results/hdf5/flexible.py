"""Content of the HDF5 result of a mechanism of rigid and flexible bodies."""

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from ...model.flexible_mechanism import FlexibleMechanism, FloatingBody
from .applied_loads import with_applied_loads, with_load_values
from .layout import (
    BODY_MOTION,
    DRIVER,
    EULER_PARAMETER,
    FORCE,
    JOINT_SERIES,
    JOINT_VECTOR,
    PATH,
    POINT_MOTION,
    TORQUE,
    XYZ,
    Axis,
    Constant,
    Layout,
    Series,
    Values,
    coordinate_axes,
    effort_series,
    element_values,
    numbered_axis,
    with_elements,
    with_shapes,
    with_units,
)
from .result_geometry import SIDE, gravity, joint_geometry, point_bodies, shape_geometry
from .stress import element_axes, element_constants, stress_axes, stress_series, stress_values

if TYPE_CHECKING:
    from ...solvers.constrained.flexible_rows import FlexibleRows

TURNING = "turning/turning"
NODE_TURNS = {
    "node_rotation": Series(
        "turning/rotation", (TURNING, "xyz"), "rad", "rotation vector of the node against its body, body axes"
    ),
    "node_angular_velocity": Series(
        "turning/angular_velocity", (TURNING, "xyz"), "rad/s", "angular velocity of the node, global axes"
    ),
}
FORCES = {
    "reaction_force": Series(
        "reaction/force", JOINT_VECTOR, "N", "force on body b at the joint's first point, global axes"
    ),
    "reaction_torque": Series(
        "reaction/torque", JOINT_VECTOR, "N m", "torque on body b at the joint's first point, global axes"
    ),
    "holding_force": Series("held/force", ("held/held", "xyz"), "N", "force of a pin on its node"),
    "driver_effort": Series(PATH, (DRIVER,), "N or N m", "force or torque along the prescribed coordinate"),
    "kinetic": Series("energy/kinetic", (), "J", "kinetic energy"),
    "potential": Series("energy/potential", (), "J", "potential energy of gravity and springs"),
    "strain": Series("energy/strain", (), "J", "strain energy of flexible bodies"),
    "applied_work": Series(
        "energy/applied_work", (), "J", "work of motions, forces, damping and stiffening since the start"
    ),
    "applied_power": Series("energy/applied_power", (), "W", "its rate"),
    "total": Series(
        "energy/total", (), "J", "kinetic + potential + strain - applied work: constant but for errors"
    ),
    "constraint_residual": Series(
        "audit/constraint_residual", (), "1", "largest constraint equation, max-norm, scaled"
    ),
    "velocity_residual": Series(
        "audit/velocity_residual", (), "1/s", "largest constraint rate, max-norm, scaled"
    ),
}


def flexible_layout(mechanism: FlexibleMechanism) -> Layout:
    """Axes, series and constants for what the mechanism has."""
    units = [FORCE if motion.is_length else TORQUE for motion in mechanism.motions]
    axes = [XYZ, EULER_PARAMETER, *([SIDE] if mechanism.joints else [])]
    for kind, items in (
        ("body", mechanism.bodies),
        ("point", mechanism.outputs),
        ("turning", mechanism.turning_outputs),
        ("joint", mechanism.joints),
        ("held", mechanism.pins),
        ("driver", mechanism.motions),
    ):
        if items:
            numbered = numbered_axis(kind, [item.name for item in items])
            axes.append(with_units(numbered, kind, units) if kind == "driver" else numbered)
    for body in _flexible(mechanism):
        axes += [_mode_axis(body), _node_axis(body), *element_axes(body)]
    axes += stress_axes(mechanism)
    axes += coordinate_axes(mechanism.joints, [joint.name for joint in mechanism.joints])
    present = {axis.path for axis in axes}
    series = [
        effort_series(item, units) if item.path == PATH else item
        for item in _named().values() if present.issuperset(item.axes)
    ]  # fmt: skip
    for body in _flexible(mechanism):
        axis, meaning = _mode_axis(body).path, f"modal coordinates of {body.name}"
        series.append(Series(_amplitude(body), (axis,), "m or 1", meaning))
        if body.reduced.stress or body.reduced.mesh:
            series.append(Series(_rate(body), (axis,), "m/s or 1/s", f"rates of the {meaning}"))
    series += stress_series(mechanism)
    layout = Layout("dynamic", mechanism.time.rows, tuple(axes), tuple(series), tuple(_constants(mechanism)))
    if mechanism.elements:
        layout = with_elements(layout, mechanism.elements, mechanism.springs)
    return with_shapes(with_applied_loads(layout, mechanism), mechanism.shapes)


def flexible_values(mechanism: FlexibleMechanism, rows: "FlexibleRows") -> Values:
    """The fields of report rows (`FlexibleRows`) by the paths of their datasets."""
    values = {"time": rows.time}
    values |= {series.path: getattr(rows, field) for field, series in _named().items()}
    for body, amplitude in zip(_flexible(mechanism), rows.amplitude, strict=True):
        values[_amplitude(body)] = amplitude
    for body, rate in zip(_flexible(mechanism), rows.amplitude_rate, strict=True):
        values[_rate(body)] = rate
    if mechanism.elements:
        values |= element_values(rows)
    return with_load_values(values | stress_values(mechanism, values), mechanism)


def _named() -> dict[str, Series]:
    return BODY_MOTION | POINT_MOTION | NODE_TURNS | JOINT_SERIES | FORCES


def _flexible(mechanism: FlexibleMechanism) -> list[FloatingBody]:
    return [body for body in mechanism.bodies if body.modes]


def _amplitude(body: FloatingBody) -> str:
    return f"modal/{body.name}/amplitude"


def _rate(body: FloatingBody) -> str:
    return f"modal/{body.name}/rate"


def _mode_axis(body: FloatingBody) -> Axis:
    return Axis(f"modal/{body.name}/mode", tuple(range(1, body.modes + 1)), f"mode of {body.name}")


def _node_axis(body: FloatingBody) -> Axis:
    numbers = tuple(map(int, body.reduced.numbers))
    return Axis(f"elastic/{body.name}/node", numbers, f"node of {body.name}, its number in the node table")


def _constants(mechanism: FlexibleMechanism) -> Iterator[Any]:
    yield from gravity(mechanism.gravity)
    for body in _flexible(mechanism):
        meaning = f"frequencies of the modes of {body.name}, held in its frame"
        frequencies = np.array(body.reduced.frequencies)
        yield Constant(f"modal/{body.name}/frequency", (_mode_axis(body).path,), frequencies, "Hz", meaning)
        yield from shape_geometry(body.name, body.reduced.r0, body.reduced.Phi)
        yield from element_constants(body)
    if mechanism.outputs:
        yield point_bodies([point.body for point in mechanism.outputs])
    if mechanism.joints:
        ends = [(joint.a[0], joint.b[0]) for joint in mechanism.joints]
        yield from joint_geometry([(a.body, b.body) for a, b in ends], [(a.r0, b.r0) for a, b in ends])
