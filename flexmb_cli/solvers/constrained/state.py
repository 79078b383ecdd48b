"""The state of a motion under constraints, which its start, its breakpoints and its failures read."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import Any

import numpy as np

from ...errors import Fault
from ...model.arrays.system import SystemArrays
from ...model.integrators import Integrator
from ...model.joint_elements import JointElements
from ...model.joints import DEPENDENT
from ...model.laws import Element
from ...model.loads import InitialVelocity
from ...model.mechanism import TimeGrid
from ..singular.mobility import Mobility
from ..step_sequence import StepSequence
from .integrators import Steps
from .system import PositionGaps, constrained_system, new_work, starts_sparse

NO_ELEMENTS = JointElements()


class ConstrainedState(ABC):
    """Equations of a mechanism, and how far their integration over the times of `grid` has come.

    The subclass for a model gives what is abstract here, the `velocities` behind `given_speeds`, and
    `springs` of the deck.  `warnings` fills while the run continues; `found` is what its start found.
    """

    velocities: Sequence[InitialVelocity] = ()
    springs: Sequence[Element] = ()
    omega_in_body_axes = False
    rest: np.ndarray | None = None  # coordinates and speeds that it begins with, in place of the deck's
    step_sequence: StepSequence | None = None  # steps to record or to make again
    continues = False  # whether it continues another motion, whose state `rest` is
    usual_words = "planar mechanism of spatial joints", "3 a loop"  # of `usual_repetitions`

    def __init__(
        self,
        arrays: SystemArrays,
        grid: TimeGrid,
        integrator: Integrator,
        elements: JointElements = NO_ELEMENTS,
    ):
        self.arrays, self.elements = arrays, elements
        self.first_angles = arrays.angles  # near which those of the first position are, rad
        self.works = len(arrays.loads) if elements else 0  # loads whose works are kept
        self.grid = grid
        self.integrator = Steps(integrator)
        self.dependent = DEPENDENT  # singular values, of the largest, of equations that repeat others
        self.system = constrained_system(arrays)
        self.work = new_work(arrays)
        self.warnings: list[Fault] = []
        self.mobility: Mobility | None = None
        self.row, self.resumed = 0, False
        self.undetermined: list[float] = []  # times of rows without constraint forces, s
        self._first = np.zeros(0)  # coordinates at the start
        self.loop_note: Fault | None = None  # on loops that close only nearly
        self._independence = 0.0  # of the equations when chosen, where loops close only nearly
        coordinates, n = arrays.coordinate_scale.size, arrays.speeds
        self.integration = self.integrator.new_integration(
            self.work, arrays.angles.size, self.works, len(arrays.signals.states)
        )
        self.integration.units[:coordinates] = arrays.coordinate_scale
        self.integration.units[coordinates : coordinates + n] = arrays.speed_scale
        self.clock = self.integration.clock
        self.clock["rtol"] = self.clock["atol"] = integrator.tolerance

    @abstractmethod
    def assembled(self, t: float) -> np.ndarray:
        """Coordinates (n + b,) at time t, s, that meet all equations; raises AnalysisError."""

    @abstractmethod
    def given_speeds(self, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return which of the speeds (n,) the deck gives, and their values (n,)."""

    def usual_repetitions(self, q: np.ndarray) -> int | None:
        """Number of equations that repeat others in every mechanism of this type; None: of no such type."""
        return None

    def given_rates(self, q: np.ndarray) -> tuple[np.ndarray, np.ndarray, tuple[Any, ...]]:
        """Rows (r, n) on speeds, right-hand sides (r,) and names of equations that hold at the start only."""
        return np.zeros((0, self.arrays.speeds)), np.zeros(0), ()

    @property
    def gaps(self) -> PositionGaps:
        """Residuals and Jacobians of the equations, by the work of the integration."""
        return PositionGaps(self.arrays, self.system, self.work)

    @property
    def starts_sparse(self) -> bool:
        """Return whether the start takes sparse matrices."""
        return self.dependent == DEPENDENT and starts_sparse(self.arrays)
