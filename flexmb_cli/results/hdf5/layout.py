"""Layout of an HDF5 result: axes, datasets along time, and datasets that stay."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence


Values = Mapping[str, np.ndarray]


@dataclass(frozen=True)
class Axis:
    """A dimension scale at `path`; `labels`: further texts along it, by the path of their dataset."""

    path: str
    values: tuple[Any, ...]
    long_name: str
    labels: tuple[tuple[str, tuple[str, ...], str], ...] = ()


@dataclass(frozen=True)
class Series:
    """A dataset along time: its path, the paths of its axes after time, unit and meaning."""

    path: str
    axes: tuple[str, ...]
    units: str
    long_name: str


@dataclass(frozen=True, eq=False)
class Constant:
    """A dataset that does not change with time: its path, the paths of its axes, values, unit, meaning."""

    path: str
    axes: tuple[str, ...]
    values: np.ndarray
    units: str
    long_name: str


@dataclass(frozen=True)
class Layout:
    """Layout of a result besides the deck: `rows` is the number of report rows of a whole run."""

    analysis: str
    rows: int
    axes: tuple[Axis, ...]
    series: tuple[Series, ...]
    constants: tuple[Constant, ...] = ()


TIME = Series("time", (), "s", "time")


XYZ = Axis("xyz", tuple("xyz"), "component along the axis")


EULER_PARAMETER = Axis("euler_parameter", ("e0", "e1", "e2", "e3"), "Euler parameter")


def numbered_axis(kind: str, names: "Sequence[Any]") -> Axis:
    """The scale `/<kind>/<kind>`, numbers as in the deck, and `/<kind>/name` along it."""
    numbers = tuple(range(1, len(names) + 1))
    label = (f"{kind}/name", tuple(names), f"name of the {kind}")
    return Axis(f"{kind}/{kind}", numbers, f"number of the {kind} in the deck", (label,))
