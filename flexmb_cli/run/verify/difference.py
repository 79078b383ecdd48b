"""How far two motions of one deck lie apart, quantity by quantity."""

import numpy as np

from ...quick_dataclass import dataclass


@dataclass(frozen=True)
class Difference:
    """Largest difference of a quantity over the run, at a time, s, and the largest value of its kind."""

    name: str
    unit: str
    difference: float
    scale: float
    time: float

    @property
    def relative(self) -> float:
        """The difference as a share of the scale; of what is always zero, the difference."""
        return self.difference / self.scale if self.scale else self.difference


def largest_difference(
    name: str, unit: str, time: np.ndarray, one: np.ndarray, other: np.ndarray, scale: float | None = None
) -> Difference:
    """Return the largest difference of two series (T, ...) at the times (T,), and where it is."""
    apart = np.abs(one - other).reshape(len(one), -1).max(axis=1, initial=0.0)
    row = int(np.argmax(apart))
    scale = float(np.max(np.abs(one), initial=0.0)) if scale is None else float(scale)
    return Difference(name, unit, float(apart[row]), scale, float(time[row]))
