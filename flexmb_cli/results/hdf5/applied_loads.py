"""Applied forces and torques in results: of lines FORCE and TORQUE, and of cards FORC and TOQU of trees.

Their directions follow from the attitudes of bodies in the same rows.
"""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ...model.laws import FORCE, TORQUE, Push
from ...model.vectors import Vector, global_axes
from .layout import ELEMENT_SERIES, Layout, Series, Values, numbered_axis

LOAD_AXIS = "load/load"
NO_LOAD: Vector = (0.0, 0.0, 0.0)
LOAD_FORCE, LOAD_TORQUE, LOAD_POWER = (
    Series("load/force", (LOAD_AXIS, "xyz"), "N", "applied force, global axes; 0 of a torque"),
    Series("load/torque", (LOAD_AXIS, "xyz"), "N m", "applied torque, global axes; 0 of a force"),
    Series("load/power", (LOAD_AXIS,), "W", "power of the applied force or torque"),
)


@dataclass(frozen=True)
class AppliedLoad:
    """A force, N, and a torque, N m, on a body, from 0, in global axes or, if it `follows`, in the body's.

    Of an element they are those at an effort of 1, and `column` is its place among elements.
    """

    name: str
    body: int
    force: Vector = NO_LOAD
    torque: Vector = NO_LOAD
    follows: bool = False
    column: int | None = None


def applied_loads(model: Any) -> list[AppliedLoad]:
    """Return the applied loads of a model, those of elements last."""
    loads = []
    for k, body in enumerate(model.bodies if hasattr(model, "coordinates") else ()):
        if any((*body.force, *body.torque)):
            loads.append(AppliedLoad(f"load on {body.name}", k, body.force, body.torque))
    column = len(getattr(model, "springs", ()))
    for item in model.elements.forces:
        if item.law in (FORCE, TORQUE):
            loads.append(_of_element(item.name, item.measure, column))
        column += len(item.parts)
    return loads


def _of_element(name: str, push: Push, column: int) -> AppliedLoad:
    force, torque = (NO_LOAD, push.direction) if push.turning else (push.direction, NO_LOAD)
    return AppliedLoad(name, push.j, force, torque, push.follows, column)


def with_applied_loads(layout: Layout, model: Any) -> Layout:
    """Return the layout with the applied loads of the model, if there are any."""
    loads = applied_loads(model)
    if not loads:
        return layout
    axis = numbered_axis("load", [load.name for load in loads])
    series = (*layout.series, LOAD_FORCE, LOAD_TORQUE, LOAD_POWER)
    return replace(layout, axes=(*layout.axes, axis), series=series)


def with_load_values(values: Values, model: Any) -> Values:
    """Return the values of rows, by the paths of their datasets, with the applied loads of the model."""
    loads = applied_loads(model)
    if not loads:
        return values
    force, torque = np.zeros((2, len(values["time"]), len(loads), 3))
    power = np.zeros(force.shape[:2])
    for k, load in enumerate(loads):
        force[:, k], torque[:, k] = (_vector(load, vector, values) for vector in (load.force, load.torque))
        power[:, k] = _power(load, force[:, k], torque[:, k], values)
    return {**values, LOAD_FORCE.path: force, LOAD_TORQUE.path: torque, LOAD_POWER.path: power}


def _vector(load: AppliedLoad, vector: Vector, values: Values) -> np.ndarray:
    """Return a force or torque (T, 3) in global axes."""
    rows = np.tile(np.array(vector), (len(values["time"]), 1))
    if load.follows:
        rows = global_axes(values["body/euler_parameters"][:, load.body], rows)
    if load.column is not None:
        rows = rows * values[ELEMENT_SERIES["element_effort"].path][:, load.column, None]
    return rows + 0.0  # a part of none is 0, not -0


def _power(load: AppliedLoad, force: np.ndarray, torque: np.ndarray, values: Values) -> np.ndarray:
    """Return the power (T,) of the force at the body's origin and the torque, or of an element, W."""
    if load.column is not None:
        return values[ELEMENT_SERIES["element_power"].path][:, load.column]
    at = (slice(None), load.body)
    along, about = force * values["body/velocity"][at], torque * values["body/angular_velocity"][at]
    return np.sum(along + about, axis=1) + 0.0
