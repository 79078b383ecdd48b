"""Which curves of a result are drawn, and in which panels: one for each unit."""

from collections.abc import Sequence
from dataclasses import dataclass

import h5py
import numpy as np

from .quantities import Quantity, names, read
from .stored_result import attribute

# What tells most of a result, most telling first; the rest is asked for by name.
TELLING = {
    "young": ("point/position", "body/position", "driver/effort"),
    "dafms": ("coordinate/q",),
    "vsdf": ("point/position", "body/position"),
}
ALWAYS = ("energy/kinetic", "energy/potential", "energy/strain", "energy/applied_work", "energy/total")
# More curves than these in a panel cannot be told apart.
MOST_CURVES = 12
# A coordinate that moves less than this part of the farthest moving one tells nothing.
STILL = 1e-9


@dataclass(frozen=True, eq=False)
class Curve:
    """One line: its label and values (T,) over those of the other axis.

    Curves of the same `quantity` number are the same quantity of different results, by `result` number.
    """

    label: str
    x: np.ndarray
    y: np.ndarray
    quantity: int = 0
    result: int = 0


@dataclass(frozen=True, eq=False)
class Panel:
    """Curves of one `unit` on common axes over what `x_label` says; `same_unit`: x has the unit, too."""

    x_label: str
    unit: str
    curves: tuple[Curve, ...]
    same_unit: bool = False

    @property
    def y_label(self) -> str:
        """The one quantity with its unit, or just the unit of many."""
        names = {curve.label for curve in self.curves}
        return f"{self.curves[0].label} [{self.unit}]" if len(names) == 1 else f"[{self.unit}]"


@dataclass(frozen=True, eq=False)
class Source:
    """An open `result` with its `label` ("" when it is the only one) and `rows`, and what to draw of it."""

    label: str
    result: h5py.File
    rows: slice
    abscissa: Quantity
    quantities: Sequence[Quantity]


def default_quantities(result: h5py.File) -> list[Quantity]:
    """What to draw when nothing is named: the telling quantities of the dialect that move, and energies."""
    known = names(result)
    chosen = []
    for dataset in TELLING.get(attribute(result, "dialect"), TELLING["young"]):
        wanted = [quantity for quantity in known if quantity.dataset == dataset]
        moving = _moving(result, wanted)
        # Bodies are drawn where there are no points that tell the motion.
        if moving and not (dataset == "body/position" and chosen):
            chosen += _crowd(moving)
    return chosen + [quantity for quantity in known if quantity.dataset in ALWAYS]


def panels(sources: Sequence[Source]) -> list[Panel]:
    """One panel for every unit, in the order in which the units come first."""
    found: dict[str, list[Curve]] = {}
    for number, source in enumerate(sources):
        values = read(source.result, [source.abscissa, *source.quantities], source.rows)
        count: dict[str, int] = {}
        for column, quantity in enumerate(source.quantities, start=1):
            rank = count[quantity.unit] = count.get(quantity.unit, -1) + 1
            name = f"{source.label}: {quantity.name}" if source.label else quantity.name
            curve = Curve(name, values[:, 0], values[:, column], rank, number)
            found.setdefault(quantity.unit, []).append(curve)
    x = sources[0].abscissa
    return [Panel(x.header, unit, tuple(curves), unit == x.unit) for unit, curves in found.items()]


def _moving(result, quantities):
    if not quantities or not len(result["time"]):
        return []
    ranges = np.ptp(read(result, quantities), axis=0)
    return [q for q, size in zip(quantities, ranges, strict=True) if size > STILL * ranges.max()]


def _crowd(quantities):
    """At most `MOST_CURVES` of a unit, the first ones."""
    kept, count = [], {}
    for quantity in quantities:
        count[quantity.unit] = count.get(quantity.unit, 0) + 1
        if count[quantity.unit] <= MOST_CURVES:
            kept.append(quantity)
    return kept
