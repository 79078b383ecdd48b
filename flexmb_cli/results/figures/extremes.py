"""Extremes of the curves of a result, and the largest reactions of its joints."""

from collections.abc import Sequence

import h5py
import numpy as np

from ...deck.units import Wishes, with_prefix
from ..quantities.quantities import Quantity, names, read
from ..quantities.readable import readable

Row = tuple[str, str, str, str]  # what, unit, least and largest value with their times


def extremes(result: h5py.File, wishes: Wishes, quantities: Sequence[Quantity]) -> list[Row]:
    """Return the least and the largest value of each quantity, and the largest reactions.

    Values are in the units that are wanted, `wishes`.
    """
    if not len(result["time"]):
        return []
    shown = [quantity.in_units(wishes) for quantity in quantities if quantity.dataset != "time"]
    rows = []
    for one, values in zip(shown, read(result, shown).T, strict=True):
        unit, column = _prefixed(one.unit, values, wishes)
        rows.append((readable(one).label, unit, _at(result, column, False), _at(result, column, True)))
    return [*rows, *_largest_reactions(result, wishes)]


def _prefixed(unit: str, values: np.ndarray, wishes: Wishes) -> tuple[str, np.ndarray]:
    """Return values and their unit with a prefix, unless another one is wanted."""
    largest = float(np.max(np.abs(values), initial=0.0, where=np.isfinite(values)))
    shown, factor = with_prefix(unit, largest, wishes)
    return shown, values * factor


def _at(result: h5py.File, values: np.ndarray, largest: bool) -> str:
    """Return the least or the largest finite value (T,), and its time."""
    finite = np.isfinite(values)
    if not finite.any():
        return "none"
    row = int(np.argmax(np.where(finite, values if largest else -values, -np.inf)))
    return f"{values[row]:.6g} at {result['time'][row]:.6g} s"


def _largest_reactions(result: h5py.File, wishes: Wishes) -> list[Row]:
    """Return the largest size of force and torque of each joint."""
    rows = []
    for part in ("force", "torque"):
        vectors = [one.in_units(wishes) for one in names(result) if one.dataset == f"reaction/{part}"]
        if not vectors:
            continue
        sizes = np.linalg.norm(read(result, vectors).reshape(len(result["time"]), -1, 3), axis=2)
        for one, size in zip(vectors[::3], sizes.T, strict=True):
            label = f"{part} of {readable(one).thing}, its size"
            unit, values = _prefixed(one.unit, size, wishes)
            rows.append((label, unit, "", _at(result, values, largest=True)))
    return rows
