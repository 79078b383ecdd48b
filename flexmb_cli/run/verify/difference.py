"""Difference between two motions of one deck, quantity by quantity."""

from dataclasses import dataclass

import numpy as np

# Shares of a mechanism's length, or of a turn, below which a motion in the time of a run may be round-off.
# In accelerations large forces cancel.
RESTING, CANCELLING = 1e-6, 1e-3


@dataclass(frozen=True)
class Size:
    """Length of a mechanism, m, duration of its motion, s, 0 of a single position, and mass, kg."""

    length: float
    time: float
    mass: float = 0.0

    def least(self, unit: str) -> float:
        """Return the least value by which a quantity of `unit` is measured; 0 where none is known.

        Of a mechanism at rest all values are round-off, of which none may be a measure of the others.
        """
        time = self.time or 1.0
        speed, turn = self.length / time, 1.0 / time
        force = self.mass * speed / time
        sizes = {
            "m": RESTING * self.length,
            "rad": RESTING,
            "m/s": RESTING * speed,
            "rad/s": RESTING * turn,
            "m/s^2": CANCELLING * speed / time,
            "rad/s^2": CANCELLING * turn / time,
            "N": CANCELLING * force,
            "N m": CANCELLING * force * self.length,
            "W": CANCELLING * force * speed,
            "J": RESTING * self.mass * speed**2,
        }
        return max(sizes.get(part, 0.0) for part in unit.split(", "))


@dataclass(frozen=True)
class Difference:
    """Largest difference of a quantity over the run, at a time, s, and the largest value of its type."""

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
    name: str,
    unit: str,
    time: np.ndarray,
    one: np.ndarray,
    other: np.ndarray,
    size: Size,
    scale: float | None = None,
) -> Difference:
    """Return the largest difference of two series (T, ...) at the times (T,), and where it is.

    Its scale is the largest value of `one`, or `scale`, and at least what `size` says.
    """
    apart = np.abs(one - other).reshape(len(one), -1).max(axis=1, initial=0.0)
    row = int(np.argmax(apart))
    scale = float(np.max(np.abs(one), initial=0.0)) if scale is None else float(scale)
    return Difference(name, unit, float(apart[row]), max(scale, size.least(unit)), float(time[row]))
