"""Step counts of the dynamics of a mechanism under constraints."""

from collections.abc import Mapping
from typing import TYPE_CHECKING

from ..errors import Fault
from .energy_drift import ConstrainedDrift
from .solution import NoCount

if TYPE_CHECKING:
    import numpy as np


class StepCount(NoCount):
    """Steps, residuals and drift of energy so far; an inverse run takes no steps of its own."""

    def __init__(self, clock: "np.ndarray | None" = None, drift: ConstrainedDrift | None = None):
        self.clock, self.drift = clock, drift
        self.residual = 0.0

    def add(self, values: Mapping[str, "np.ndarray"]) -> None:
        """Count a block of values."""
        self.residual = max(self.residual, float(values["audit/constraint_residual"].max()))
        if self.drift is not None:
            self.drift.add(values)

    @property
    def warnings(self) -> tuple[Fault, ...]:
        """Return what the energy of the rows makes doubtful."""
        return self.drift.warnings if self.drift else ()

    def __str__(self) -> str:
        worst = f"largest residual {self.residual:.1e}"
        if self.clock is None:
            return worst
        clock = self.clock[0]
        return (
            f"steps {clock['steps']}, evaluations {clock['evaluations']}, "
            f"rejected attempts {clock['rejections']}; {worst}{f'; {self.drift}' if self.drift else ''}"
        )
