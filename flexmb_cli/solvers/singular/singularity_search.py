"""Singular positions that a motion passes: looked for between its report rows, and reported as notes.

One search for kinematics and for dynamics.  Both follow a smooth motion through a position where two motions
cross; what differs is handed in by a subclass:

- `suspected`: between which rows a position is suspected.  The continuation takes many short steps there, or
  the sign of det Φ_q changes; an integrator steps over it, and the smallest singular value has a minimum.
- `located`: the positions found there.  The continuation is walked again step by step; between the states of
  an integrator the least singular value is sought on the straight line, brought back to the equations.
- `conditioning` and `sentence`: the Jacobian there, of coordinates or of speeds, and what is said.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...errors import Fault
from ...model.equations import Equation
from .conditioning import Conditioning, SingularityNotes, weakest_owners

MOST_THIRDS = 40  # by which an interval with a minimum is narrowed


@dataclass(frozen=True)
class Passed:
    """A position q (N,) passed at the time t, s, for the angles expected there, rad.

    `crosses`: two motions cross there; else it is the place where they come nearest.
    """

    q: np.ndarray
    t: float
    expected: np.ndarray
    crosses: bool


class PassedSingularities(ABC):
    """Looks for singular positions along the rows of a motion; notes go to `warnings`.

    Not active, it looks for nothing.  `names`: the equations; `most_reported`: how many of them a note names.
    """

    most_reported = 3

    def __init__(self, warnings: list[Fault], names: tuple[Equation, ...], active: bool):
        self.notes, self.names, self.active = SingularityNotes(warnings), names, active

    def look(self, *seen: Any) -> None:
        """Look at report rows, in order; `seen` is what `suspected` takes."""
        for interval in self.suspected(*seen):
            for passed in self.located(interval):
                self.report(passed)

    @abstractmethod
    def suspected(self, *seen: Any) -> Iterable[Any]:
        """Return the intervals in which a singular position may lie."""

    @abstractmethod
    def located(self, interval: Any) -> Iterable[Passed]:
        """Return the singular positions of an interval."""

    @abstractmethod
    def conditioning(self, passed: Passed) -> Conditioning:
        """Return the conditioning of the Jacobian there."""

    @abstractmethod
    def sentence(self, passed: Passed, weak: Conditioning, owners: list[Equation]) -> str:
        """Return what is said of a position, whose weakest equations belong to `owners`."""

    def report(self, passed: Passed) -> None:
        """Note a position, unless there are notes enough."""
        if self.notes.full:
            return
        weak = self.conditioning(passed)
        owners = weakest_owners(self.names, weak.combination, self.most_reported)
        self.notes.add(self.sentence(passed, weak, owners), owners)


def least_by_thirds(value: Callable[[float], float]) -> float:
    """Return where in (0, 1) a function with one minimum is least."""
    low, high = 0.0, 1.0
    for _ in range(MOST_THIRDS):
        thirds = low + (high - low) / 3.0, high - (high - low) / 3.0
        values = [value(x) for x in thirds]
        low, high = (low, thirds[1]) if values[0] < values[1] else (thirds[0], high)
    return 0.5 * (low + high)
