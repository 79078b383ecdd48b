"""How far the total energy of a run strays: for the statistics of -v, and as a warning."""

import numpy as np

from ..errors import Fault

WRONG = 1e-3  # share of the kinetic and strain energy: errors of the steps are a thousandth of that


class EnergyDrift:
    """How far the total energy has moved from its first value, and what it may be measured against."""

    def __init__(self):
        self.first = None
        self.largest = self.scale = 0.0

    def add(self, values):
        """Take in a block of rows, by the paths of their datasets."""
        total = values["energy/total"]
        self.first = total[0] if self.first is None else self.first
        self.largest = max(self.largest, float(np.max(np.abs(total - self.first))))
        moved = values["energy/kinetic"] + values["energy/strain"]
        self.scale = max(self.scale, float(np.max(moved)))

    @property
    def doubts(self) -> tuple[Fault, ...]:
        """A warning where the energy strays by more than errors of the steps do."""
        if not self.largest > WRONG * self.scale:
            return ()
        message = (
            f"{self}, which the equations keep constant: the motion is wrong from where it begins to stray "
            "(energy/total); a loop that passes a singular position, or too coarse a tolerance; compare with "
            "a finer TOLR and with --formulation absolute"
        )
        return (Fault("warning", message),)

    def __str__(self):
        return (
            f"total energy drifts by {self.largest:.1e} J, kinetic and strain energy reach {self.scale:.2g} J"
        )
