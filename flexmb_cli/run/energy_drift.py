"""Drift of the total energy of a run: for the statistics of -v, and as a warning."""

from collections.abc import Mapping

import numpy as np

from ..errors import Fault
from .solutions import NoCount
from .stiffening_notes import SpinCount

WRONG = 1e-3  # share of what moves: errors of the steps are a thousandth of that
ENERGY_ROUND_OFF = 1e-12  # of the total
UNSEEN = 1e-7  # of the potential energy: a mechanism all but at rest has only errors of the steps
STRAYS = (
    "which the equations keep constant: the motion is wrong from the row at which it drifts (energy/total); "
)
OF_TREES = (
    "a loop that passes a singular position, or too coarse a tolerance; compare with a finer TOLR and with "
    "--formulation absolute"
)


class EnergyDrift:
    """Largest distance of the total energy from its first value, and its possible scales.

    `reasons` and what to do about them end the warning; `reference` names what `scale` is.
    """

    reference = "kinetic and strain energy reach"
    reasons = OF_TREES

    def __init__(self) -> None:
        self.first = None
        self.largest = self.scale = self.lost = 0.0

    def add(self, values: Mapping[str, np.ndarray]) -> None:
        """Take in a block of rows, by the paths of their datasets."""
        self.take(values["energy/total"], values["energy/kinetic"] + values["energy/strain"])

    def take(self, total: np.ndarray, moved: np.ndarray) -> None:
        """Take in the total energy of a block of rows (T,) and that which it is measured against."""
        self.first = total[0] if self.first is None else self.first
        self.largest = max(self.largest, float(np.max(np.abs(total - self.first))))
        self.scale = max(self.scale, float(np.max(moved)))
        self.lost = max(self.lost, ENERGY_ROUND_OFF * float(np.max(np.abs(total))))

    @property
    def warnings(self) -> tuple[Fault, ...]:
        """Return a warning where the energy drifts by more than the errors of the steps explain."""
        if not self.largest > max(WRONG * self.scale, self.lost):
            return ()
        return (Fault("warning", f"{self}, {STRAYS}{self.reasons}", id="RUN-014"),)

    def __str__(self) -> str:
        return f"total energy drifts by {self.largest:.1e} J, {self.reference} {self.scale:.2g} J"


class ConstrainedDrift(EnergyDrift):
    """Energy drift of a mechanism under constraints: the work of drivers and loads is subtracted."""

    reference = "the energies and the work done reach"

    def __init__(self, reasons: str):
        super().__init__()
        self.reasons = reasons
        self.potential = None

    def add(self, values: Mapping[str, np.ndarray]) -> None:
        """Take in a block of rows, by the paths of their datasets."""
        total, work, potential = (values[f"energy/{name}"] for name in ("total", "applied_work", "potential"))
        self.potential = potential[0] if self.potential is None else self.potential
        moved = total + work - potential  # kinetic and strain energy
        gained = np.maximum(np.abs(potential - self.potential), np.abs(work))
        self.take(total, np.maximum(moved, gained))
        self.lost = max(self.lost, UNSEEN * float(np.max(np.abs(potential))))


class StepCount(NoCount):
    """Steps, residuals, drift of energy and spins so far; an inverse run takes no steps of its own."""

    def __init__(
        self, clock: np.ndarray | None = None, drift: EnergyDrift | None = None, spin: SpinCount | None = None
    ):
        self.clock, self.drift, self.spin = clock, drift, spin or SpinCount()
        self.residual = 0.0

    def add(self, values: Mapping[str, np.ndarray]) -> None:
        """Count a block of values."""
        residuals = values.get("audit/constraint_residual", np.zeros(1))
        self.residual = max(self.residual, float(residuals.max()))
        if self.drift is not None:
            self.drift.add(values)
        self.spin.add(values)

    @property
    def warnings(self) -> tuple[Fault, ...]:
        """Return what the energy of the rows makes doubtful, and notes on the spin of bodies."""
        return (*(self.drift.warnings if self.drift else ()), *self.spin.notes)

    def __str__(self) -> str:
        worst = f"largest residual {self.residual:.1e}"
        if self.clock is None:
            return worst
        clock = self.clock[0]
        return (
            f"steps {clock['steps']}, evaluations {clock['evaluations']}, "
            f"rejected attempts {clock['rejections']}; {worst}{f'; {self.drift}' if self.drift else ''}"
        )
