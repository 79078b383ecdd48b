"""Content of the HDF5 result of a mechanism's kinematics."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from ...model.mechanism import Mechanism
from ...solvers.kinematics.rows import Rows
from .layout import (
    BODY_MOTION,
    EULER_PARAMETER,
    JOINT_SERIES,
    POINT_MOTION,
    TIME,
    XYZ,
    Layout,
    Series,
    Values,
    coordinate_axes,
    numbered_axis,
    with_shapes,
)
from .result_geometry import SIDE, mechanism_geometry

# Fields of `Rows`, besides the time.
SERIES = {
    **BODY_MOTION,
    **POINT_MOTION,
    **JOINT_SERIES,
    "constraint_residual": Series(
        "audit/constraint_residual", (), "1", "largest constraint equation, max-norm"
    ),
    "velocity_residual": Series("audit/velocity_residual", (), "1/s", "largest constraint rate, max-norm"),
    "newton_iterations": Series("audit/newton_iterations", (), "1", "Newton iterations for the position"),
}


def kinematic_layout(mechanism: Mechanism) -> Layout:
    """Axes and series for the bodies, points, joints and drivers that the mechanism has."""
    axes = [
        numbered_axis(kind, readable_names(kind, items))
        for kind, items in (
            ("body", mechanism.bodies),
            ("point", mechanism.points),
            ("joint", mechanism.joints),
            ("driver", mechanism.drivers),
        )
        if items
    ]
    axes += coordinate_axes(mechanism.joints, readable_names("joint", mechanism.joints))
    present_axes = (XYZ, EULER_PARAMETER, *([SIDE] if mechanism.joints else []), *axes)
    present = {axis.path for axis in present_axes}
    layout = Layout(
        "kinematic",
        mechanism.time.rows,
        present_axes,
        tuple(item for item in SERIES.values() if present.issuperset(item.axes)),
        mechanism_geometry(mechanism),
    )
    return with_shapes(layout, mechanism.shapes)


_FIELDS = {series.path: field for field, series in ({"time": TIME} | SERIES).items()}


class _ValuesOfRows(Values):
    """Fields of report rows that are calculated when they are requested first: a sweep needs few."""

    def __init__(self, rows: Rows):
        self._rows = rows

    def __getitem__(self, path: str) -> np.ndarray:
        return getattr(self._rows, _FIELDS[path])

    def __iter__(self) -> Iterator[str]:
        return iter(_FIELDS)

    def __len__(self) -> int:
        return len(_FIELDS)


def kinematic_values(rows: Rows) -> Values:
    """The fields of report rows by the paths of their datasets."""
    return _ValuesOfRows(rows)


def readable_names(kind: str, items: tuple[Any, ...]) -> list[str]:
    """Names as in the settings of the deck: "body 1", "point 2"; joints count by their type: "spherical 1".

    Messages name the same items in words ("spherical joint 1"); scripts rely on the names here.
    """
    counts: dict[str, int] = {}
    names = []
    for item in items:
        word = item.kind if kind == "joint" else kind
        counts[word] = counts.get(word, 0) + 1
        names.append(f"{word} {counts[word]}")
    return names
