"""Curves of a result that are drawn, and their panels: one for each unit."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import takewhile

import h5py
import numpy as np

from ...deck.units import AS_STORED, Wishes, in_si, with_prefix
from ...dialects import DIALECTS
from ...dialects.recognise import dialect_named
from ..hdf5.stored_result import attribute
from ..quantities.quantities import Quantity, names, read
from ..quantities.readable import Readable, readable

# What is drawn of a result of no dialect, such as a study's.
OF_ANY = ("point/position", "body/position", "driver/effort")
ENERGIES = ("energy/kinetic", "energy/potential", "energy/strain", "energy/applied_work", "energy/dissipated")
TOTAL = "energy/total"
# Drawn of every result with elements.
OF_ELEMENTS = ("coordinate/q", "element/effort", "driver/effort")
# More curves than these in a panel cannot be distinguished.
MOST_CURVES = 12
# A coordinate that moves less than this part of the farthest moving one is not drawn by default.
STILL = 1e-9
# Names of panels by the unit of their quantities, where these have nothing else in common.
OF_UNIT = {
    "m": "lengths", "rad": "angles", "m/s": "velocities", "rad/s": "angular velocities",
    "m/s2": "accelerations", "rad/s2": "angular accelerations", "N": "forces", "N m": "torques",
    "Pa": "stresses", "J": "energies", "W": "powers",
}  # fmt: skip


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
    words: Readable | None = None


@dataclass(frozen=True, eq=False)
class Panel:
    """Curves of one `unit` on common axes over what `x_label` says.

    `same_unit`: x has the unit, too; `of_changes`: the curves are changes since their first values.
    """

    x_label: str
    unit: str
    curves: tuple[Curve, ...]
    same_unit: bool = False
    of_changes: bool = False

    def readable(self, wishes: Wishes) -> "Panel":
        """Return the panel with a prefix of its unit, unless that is wanted: values have few digits."""
        values = [curve.y[np.isfinite(curve.y)] for curve in self.curves]
        largest = max((float(np.abs(y).max()) for y in values if y.size), default=0.0)
        unit, factor = self.unit, 1.0
        if not self.same_unit:
            unit, factor = with_prefix(self.unit, largest, wishes)
        if factor == 1.0:
            return self
        return replace(self, unit=unit, curves=tuple(replace(c, y=c.y * factor) for c in self.curves))

    @property
    def y_label(self) -> str:
        """Return what all curves have in common, with the unit: "velocity of body 3 [m/s]"."""
        words = [curve.words for curve in self.curves if curve.words]
        labels, quantities, things = (
            {getattr(each, key) for each in words} for key in ("label", "quantity", "thing")
        )
        energies = quantities and all("energy" in each or "work" in each for each in quantities)
        common = "energy" if energies else ""
        common = common or _common_ending(quantities)
        if len(labels) == 1:
            (common,) = labels
        elif len(quantities) == 1:
            (common,) = quantities
            if len(things) == 1 and all(things):
                common += f" of {next(iter(things))}"
        changed = "change of " if self.of_changes else ""
        common = common or OF_UNIT.get(in_si(self.unit)[0], "")
        return f"{changed}{common} [{self.unit}]" if common else f"[{self.unit}]"


def _common_ending(texts: set[str]) -> str:
    """The words that all texts end with: "von Mises stress" of those and of the largest one."""
    endings = [text.split()[::-1] for text in texts]
    if not endings:
        return ""
    same = list(takewhile(lambda words: len(set(words)) == 1, zip(*endings, strict=False)))
    return " ".join(words[0] for words in reversed(same))


@dataclass(frozen=True, eq=False)
class Source:
    """An open `result` with its `label` ("" when it is the only one) and `rows`, and what to draw of it.

    `energies_change`: energies are drawn as their changes since the first row, that of their sum by itself:
    the zero of the potential, which means nothing, would flatten what moves.
    """

    label: str
    result: h5py.File
    rows: slice
    abscissa: Quantity
    quantities: Sequence[Quantity]
    energies_change: bool = False


@dataclass(frozen=True)
class DefaultCurves:
    """The quantities that are drawn when none is named, and a sentence on each crowd that is cut short."""

    quantities: list[Quantity]
    cut: list[str]


def default_curves(result: h5py.File) -> DefaultCurves:
    """Return what is drawn when nothing is named: the dialect's main quantities that move, and energies.

    Of these those that change, and their sum; `still_energies` are the others.
    """
    known = names(result)
    chosen: list[Quantity] = []
    cut: list[str] = []
    dialect = attribute(result, "dialect")
    datasets = list(dialect_named(dialect).curves if dialect in DIALECTS else OF_ANY)
    if any(quantity.dataset == "element/effort" for quantity in known):
        datasets += [dataset for dataset in OF_ELEMENTS if dataset not in datasets]
    for dataset in datasets:
        of_dataset = [quantity for quantity in known if quantity.dataset == dataset]
        moving = _moving(result, of_dataset)
        # Bodies are drawn where there are no points that show the motion.
        if moving and not (dataset == "body/position" and chosen):
            chosen += _few_of_each_unit(result, moving, cut)
    stresses = [one for one in known if one.dataset.startswith("stress/") and one.name.endswith("von_mises")]
    chosen += _few_of_each_unit(result, _moving(result, stresses), cut)
    totals = [quantity for quantity in known if quantity.dataset == TOTAL]
    return DefaultCurves(chosen + _energies(result) + totals, cut)


def still_energies(result: h5py.File) -> list[str]:
    """Return the names of the energies that `default_curves` leaves out because they stay at zero."""
    drawn = _energies(result)
    return [one.name for one in names(result) if one.dataset in ENERGIES and one not in drawn]


def _energies(result: h5py.File) -> list[Quantity]:
    return _moving(result, [quantity for quantity in names(result) if quantity.dataset in ENERGIES])


def panels(sources: Sequence[Source], wishes: Wishes = AS_STORED) -> list[Panel]:
    """One panel for every unit, in the order in which the units come first, and more for energies.

    Values are in the units that are wanted; others have prefixes.
    """
    curves_of_panel: dict[tuple[str, bool, bool], list[Curve]] = {}
    for number, source in enumerate(sources):
        x, *drawn = (one.in_units(wishes) for one in (source.abscissa, *source.quantities))
        values = read(source.result, [x, *drawn], source.rows)
        count: dict[tuple[str, bool, bool], int] = {}
        for column, quantity in enumerate(drawn, start=1):
            changes = source.energies_change and quantity.dataset in (*ENERGIES, TOTAL)
            key = quantity.unit, changes, changes and quantity.dataset == TOTAL
            rank = count[key] = count.get(key, -1) + 1
            words = readable(quantity)
            name = f"{source.label}: {words.label}" if source.label else words.label
            y = values[:, column] - (values[0, column] if changes else 0.0)
            curves_of_panel.setdefault(key, []).append(Curve(name, values[:, 0], y, rank, number, words))
    x = sources[0].abscissa.in_units(wishes)
    x_label = f"{readable(x).label} [{x.unit}]"
    return [
        Panel(x_label, unit, tuple(curves), unit == x.unit, changes).readable(wishes)
        for (unit, changes, _), curves in curves_of_panel.items()
    ]


def _moving(result: h5py.File, quantities: list[Quantity]) -> list[Quantity]:
    if not quantities or not len(result["time"]):
        return []
    ranges = np.ptp(read(result, quantities), axis=0)
    return [q for q, size in zip(quantities, ranges, strict=True) if size > STILL * ranges.max()]


def _few_of_each_unit(result: h5py.File, quantities: list[Quantity], cut: list[str]) -> list[Quantity]:
    """Return at most `MOST_CURVES` of each unit, in their order; `cut` gets a sentence where it has more.

    Of stresses those with the largest values are kept, of others those that change most.
    """
    chosen: list[Quantity] = []
    for unit in dict.fromkeys(quantity.unit for quantity in quantities):
        of_unit = [quantity for quantity in quantities if quantity.unit == unit]
        if len(of_unit) > MOST_CURVES:
            of_stress = all(quantity.dataset.startswith("stress/") for quantity in of_unit)
            cut.append(_cut_short(of_unit, of_stress))
            of_unit = _largest(result, of_unit, of_stress)
        chosen += of_unit
    return [quantity for quantity in quantities if quantity in chosen]


def _largest(result: h5py.File, quantities: list[Quantity], by_value: bool) -> list[Quantity]:
    values = read(result, quantities)
    sizes = np.abs(values).max(axis=0) if by_value else np.ptp(values, axis=0)
    order = np.argsort(-np.nan_to_num(sizes), kind="stable")[:MOST_CURVES]
    return [quantities[k] for k in sorted(order.tolist())]


def _cut_short(quantities: list[Quantity], by_value: bool) -> str:
    """Return which curves of a unit are left out."""
    unit = quantities[0].unit
    what = _common_ending({readable(one).quantity for one in quantities}) or OF_UNIT.get(unit, "")
    chosen = "with the largest values" if by_value else "that change most"
    return (
        f"of {len(quantities)} curves of {what} [{unit}] the {MOST_CURVES} {chosen} are drawn, "
        f"{len(quantities) - MOST_CURVES} are left out"
    ).replace(" of  [", " [")
