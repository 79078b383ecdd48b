"""A motion of a study whose neighbours repeat its steps, and derivatives of what a study takes of it."""

from collections.abc import Callable

import numpy as np

from ..run.solutions import Solution
from ..solvers.linearisation.motion import differentiated
from .sensitivity import OfRun, type_of
from .solver import CaseResult, CaseSolver

DIFFERENCE = 1e-4  # of the size of a number


class RepeatedMotion:
    """The motion of the case with the parameters `row`; those by formulas follow from the others.

    `one_neighbour`: as of `OfRun`.  Raises FlexmbError.
    """

    def __init__(self, cases: CaseSolver, row: list[float], *, one_neighbour: bool = False):
        self.cases, self.row = cases, list(row)
        self._time: np.ndarray = np.zeros(0)
        self._columns: np.ndarray = np.zeros((0, 0))
        self._run: OfRun | None = None
        if cases.moving:
            solution = cases.prepared(self._changed(0, 0.0))
            self._run = type_of(solution)(self._neighbour, cases.moving, solution)
            self._run.one_neighbour = one_neighbour
            self._time, self._columns = self._run.time, self._run.values
        self._modes = self._modes_near(0, 0.0)

    def _changed(self, k: int | str, change: float) -> list[float | int]:
        changed = [value + float(change) * (j == int(k)) for j, value in enumerate(self.row)]
        return self.cases.study.complete(changed)

    def _neighbour(self, k: str, change: float) -> Solution:
        return self.cases.prepared(self._changed(k, change))

    def _modes_near(self, k: int, change: float) -> np.ndarray:
        return self.cases.modes(self._changed(k, change))

    @property
    def case(self) -> CaseResult:
        """Return what is taken of the motion."""
        return self.cases.taken_of(self.row, self._time, self._columns, self._modes)

    def derivatives(
        self, k: int, scale: float, values: Callable[[CaseResult], np.ndarray] = lambda case: case.values
    ) -> np.ndarray:
        """Return the derivatives of values(case) along the motion, by parameter k, whose size is `scale`."""
        slopes = self._run.derivative(str(k), scale) if self._run else self._columns
        h, of_modes = DIFFERENCE * scale, self._modes
        if of_modes.size:
            of_modes = (self._modes_near(k, h) - self._modes_near(k, -h)) / (2.0 * h)

        def along(change: float) -> np.ndarray:
            parts = self._columns + change * slopes, self._modes + change * of_modes
            return values(self.cases.taken_of(self.row, self._time, *parts))

        derivatives: np.ndarray = differentiated(along, h)
        return derivatives
