"""Which curves of a result are drawn, and in which panels: one for each unit."""

from collections.abc import Sequence
from dataclasses import dataclass

import h5py
import numpy as np

from .quantities import Quantity, names, read

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
    """One line: its label and values (T,) over those of the other axis."""

    label: str
    x: np.ndarray
    y: np.ndarray


@dataclass(frozen=True, eq=False)
class Panel:
    """Curves of one unit on common axes."""

    x_label: str
    y_label: str
    curves: tuple[Curve, ...]


def default_quantities(result: h5py.File) -> list[Quantity]:
    """What to draw when nothing is named: the telling quantities of the dialect that move, and energies."""
    known = names(result)
    chosen = []
    for dataset in TELLING.get(str(result.attrs.get("dialect")), TELLING["young"]):
        wanted = [quantity for quantity in known if quantity.dataset == dataset]
        moving = _moving(result, wanted)
        # Bodies are drawn where there are no points that tell the motion.
        if moving and not (dataset == "body/position" and chosen):
            chosen += _crowd(moving)
    return chosen + [quantity for quantity in known if quantity.dataset in ALWAYS]


def panels(
    results: Sequence[tuple[str, h5py.File]],
    wanted: Sequence[Sequence[Quantity]],
    abscissae: Sequence[Quantity],
    rows: slice = slice(None),
) -> list[Panel]:
    """Panels of `wanted` quantities of every result over its abscissa, in the order of the units.

    Each of `results` is a label, "" when there is but one, and an open file.
    """
    found: dict[str, list[Curve]] = {}
    for (label, result), quantities, abscissa in zip(results, wanted, abscissae, strict=True):
        values = read(result, [abscissa, *quantities], rows)
        for column, quantity in enumerate(quantities, start=1):
            name = f"{label}: {quantity.name}" if label else quantity.name
            found.setdefault(quantity.unit, []).append(Curve(name, values[:, 0], values[:, column]))
    header = abscissae[0].header
    return [Panel(header, _y_label(curves, unit), tuple(curves)) for unit, curves in found.items()]


def _y_label(curves, unit):
    return f"{curves[0].label} [{unit}]" if len(curves) == 1 else f"[{unit}]"


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
