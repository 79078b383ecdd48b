"""Modes over a parameter, each tracked by its shape: root loci, and Campbell diagrams over a speed.

Shapes are compared by the modal assurance criterion (Allemang, Brown 1982, A correlation coefficient for
modal vector analysis, 1st International Modal Analysis Conference): |a*b|²/(a*a b*b), 1 for the same shape.
Forward and backward whirl of a rotor have 0.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from .constrained import Modes

LEAST_LIKE = 0.1  # assurance of two shapes that may be of one mode
WEIGHT_OF_DISTANCE = 0.5  # of the distance of eigenvalues by their size, against that of shapes


@dataclass(frozen=True)
class ModeLoci:
    """Modes over the number `name`, whose `values` are (v,) in the unit `unit`.

    `eigenvalues` (v, k), 1/s: those above the real axis of the modes that oscillate, a column for each mode,
    in the order of their frequencies at the first value; nan where there is none.
    """

    name: str
    unit: str
    values: np.ndarray
    eigenvalues: np.ndarray

    @property
    def frequency(self) -> np.ndarray:
        """Return the damped frequencies (v, k), Hz."""
        return self.eigenvalues.imag / (2.0 * np.pi)

    @property
    def damping(self) -> np.ndarray:
        """Return the damping ratios (v, k)."""
        return -self.eigenvalues.real / np.abs(self.eigenvalues)

    def within(self, low: float, high: float) -> "ModeLoci":
        """Return the modes that have a frequency from `low` to `high`, Hz, somewhere."""
        inside = (self.frequency >= low) & (self.frequency <= high)
        return replace(self, eigenvalues=self.eigenvalues[:, inside.any(axis=0)])

    def critical(self, order: float) -> Iterator[tuple[int, float]]:
        """Yield modes and values at which a frequency is `order` turns by 2π, the number being in rad/s."""
        from scipy.interpolate import CubicSpline

        for k, curve in enumerate(self.frequency.T):
            known = np.isfinite(curve)
            if np.count_nonzero(known) > 1:
                excess = curve[known] - order * self.values[known] / (2.0 * np.pi)
                for value in CubicSpline(self.values[known], excess).roots(extrapolate=False):
                    yield k, float(value)

    def record(self, orders: Sequence[float] = ()) -> dict[str, Any]:
        """Return the record that `--json` prints, with values critical at `orders`; no mode is null."""
        columns = {"frequency": self.frequency, "damping": self.damping,
                   "real": self.eigenvalues.real, "imaginary": self.eigenvalues.imag}  # fmt: skip
        lists = {
            key: [[x if np.isfinite(x) else None for x in row] for row in rows.tolist()]
            for key, rows in columns.items()
        }
        critical = [
            {"order": order, "mode": k + 1, "value": value}
            for order in orders
            for k, value in self.critical(order)
        ]
        head = {"name": self.name, "unit": self.unit, "values": self.values.tolist()}
        return {**head, **lists, "critical": critical}


class Tracks:
    """Eigenvalues of modes, a column for each, with the last shape of each."""

    def __init__(self, rows: int):
        self.rows = rows
        self.columns: list[np.ndarray] = []
        self._last: list[tuple[complex, np.ndarray]] = []

    def add(self, row: int, modes: Modes) -> None:
        """Add the modes at a value to those that they continue; others begin a column."""
        real = -modes.damping * 2.0 * np.pi * modes.frequency / np.sqrt(1.0 - modes.damping**2)
        new = list(zip(real + 2j * np.pi * modes.frequency, modes.shapes, strict=True))
        places = dict(self._matched(new))
        for k, (eigenvalue, shape) in enumerate(new):
            if k not in places:
                places[k] = len(self.columns)
                self.columns.append(np.full(self.rows, np.nan + 0j))
                self._last.append((eigenvalue, shape))
            self.columns[places[k]][row] = eigenvalue
            self._last[places[k]] = eigenvalue, shape

    def _matched(self, new: list[tuple[complex, np.ndarray]]) -> Iterator[tuple[int, int]]:
        """Yield numbers of new modes, and of the columns that they continue."""
        from scipy.optimize import linear_sum_assignment

        if not (new and self._last):
            return
        assurance = np.array([[_assurance(a, b) for _, b in self._last] for _, a in new])
        apart = np.array([[abs(x - y) / (abs(x) + abs(y)) for y, _ in self._last] for x, _ in new])
        for k, column in zip(*linear_sum_assignment(WEIGHT_OF_DISTANCE * apart - assurance), strict=True):
            if assurance[k, column] > LEAST_LIKE:
                yield int(k), int(column)


def _assurance(a: np.ndarray, b: np.ndarray) -> float:
    """Return the modal assurance criterion of two shapes (n,)."""
    if a.shape != b.shape:
        return 0.0
    return float(abs(np.vdot(a, b)) ** 2 / (np.vdot(a, a).real * np.vdot(b, b).real))
