"""Beginnings of the stages of a motion in which parts are caught or let go, and their rows in one layout."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from ...model.general_joints import GeneralJoint, Switch
from ...results.hdf5.layout import Layout, Values
from .switch_parts import shifted

SAME_ROW = 1e-12  # of a time
CLOSURE_AXIS = "joint/joint"


@dataclass
class Stage:
    """The beginning of a stage: time, state, what else is kept of the motion before, and what continues.

    `kinetic`: the energy just before it, J, if something is caught there, and `caught`: notes of that.
    """

    time: float
    rest: np.ndarray | None = None
    memory: dict[str, np.ndarray] = field(default_factory=dict)
    sums: dict[str, np.ndarray] = field(default_factory=dict)
    kinetic: float | None = None
    caught: list[Switch] = field(default_factory=list)


def at_row(time: float, times: Sequence[float]) -> float:
    """Return the time of a switch, that of a report row if they differ by round-off only."""
    nearest = min(times, key=lambda t: abs(t - time))
    return nearest if abs(nearest - time) <= SAME_ROW * max(abs(time), times[1] - times[0]) else time


def whole_block(values: Values, own: Layout, layout: Layout) -> dict[str, np.ndarray]:
    """The values with 0 for the parts that hold nothing, and for quantities that they alone have."""
    rows, whole = len(values["time"]), dict(values)
    axes, own_axes = ({axis.path: axis for axis in one.axes} for one in (layout, own))
    for series in layout.series:
        shape = tuple(len(axes[path].values) for path in series.axes)
        columns = values.get(series.path, np.zeros((rows, 0)))
        if columns.shape[1:] == shape:
            whole[series.path] = np.array(columns)
            continue
        padded = np.zeros((rows, *shape))
        if columns.size:
            (_, names, _), (_, some, _) = (one[series.axes[0]].labels[0] for one in (axes, own_axes))
            padded[:, [names.index(name) for name in some]] = columns
        whole[series.path] = padded
    return whole


def with_closure_names(layout: Layout, model: Any) -> Layout:
    """Return a layout whose closures, if there are any, have names by which those of a part are known."""
    closures = getattr(model, "closures", ())
    names = tuple(c.name if c.general or c.curve else str(k) for k, c in enumerate(closures))
    label = ("joint/name", names, "name of the joint")
    axes = (
        replace(axis, labels=(label,)) if closures and axis.path == CLOSURE_AXIS else axis
        for axis in layout.axes
    )
    return replace(layout, axes=tuple(axes))


def named(prefix: str, arrays: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Return arrays under names that begin with `prefix`."""
    return {prefix + name: array for name, array in arrays.items()}


def part_of(checkpoint: Mapping[str, np.ndarray], prefix: str) -> dict[str, np.ndarray]:
    """Return the arrays of a checkpoint whose names begin with `prefix`, without it."""
    return {name[len(prefix) :]: array for name, array in checkpoint.items() if name.startswith(prefix)}


def moved(part: Any) -> np.ndarray:
    """Return the numbers in which a caught part differs from that of the deck."""
    if isinstance(part, GeneralJoint):
        point = part.P_i if isinstance(part.P_i, tuple) else part.P_i.r0
        return np.concatenate([np.array(point, float), np.ravel(part.turned)])
    return np.array([part.function.terms[-1][0].c[0]])


def restored(part: Any, numbers: np.ndarray | None) -> Any:
    """Return the caught part of which `_moved` gave the numbers."""
    if numbers is None:
        return part
    if not isinstance(part, GeneralJoint):
        return shifted(part, float(numbers[0]))
    x, y, z = numbers[:3].tolist()
    P_i = (x, y, z) if isinstance(part.P_i, tuple) else replace(part.P_i, r0=numbers[:3])
    return replace(part, P_i=P_i, turned=numbers[3:].reshape(3, 3))
