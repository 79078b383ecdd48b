"""The state of the kinematics of a mechanism, and how it is carried on; its singular positions read both."""

from collections.abc import Callable
from typing import Any

import numpy as np

from ...errors import Fault
from ...kernels.kinematics import continuation
from ...kernels.kinematics.continuation import BUDGET, CLOCK_SIZE, TIME
from ...kernels.kinematics.newton import SparseWork, make_sparse_work
from ...model.arrays.kinematic import KinematicArrays, kinematic_arrays
from ...model.mechanism import Mechanism
from .joint_motion import JointMotion
from .position import Evaluator, KinematicSettings, kinematic_system

KINEMATIC_CALL_WORK = 2_000_000  # steps x equations² handed to the kernel at a time
DENSE_ELIMINATION = 140  # equations: above, only entries other than zero are kept
MOST_STEPS_A_ROW = 5000


class KinematicState:
    """Equations of a mechanism, and how far the continuation of their solution has come.

    `warnings` fills while the run continues.
    """

    def __init__(self, mechanism: Mechanism, settings: KinematicSettings | None = None):
        self.mechanism = mechanism
        self.arrays: KinematicArrays = kinematic_arrays(mechanism)
        self.settings = settings or KinematicSettings()
        self.system = kinematic_system(self.arrays, self.settings)
        self.warnings: list[Fault] = []
        self.joints = JointMotion(mechanism)
        self._sparse: SparseWork | None = None
        self._left_out: tuple[tuple[int, ...], tuple[int, ...]] = (), ()
        self._restart(self.arrays.q)

    def _restart(self, q: np.ndarray) -> None:
        """Begin at the estimates q, which are assembled by the first step (a step of 0)."""
        self.state = np.zeros((3, q.size))
        self.state[0] = q
        self.motion = np.zeros((self.arrays.screw_angles.size, 3))
        self.motion[:, 0] = self.arrays.screw_angles
        self.clock = np.zeros(CLOCK_SIZE)
        self.clock[TIME] = self.mechanism.time.time(0)

    @property
    def evaluator(self) -> Evaluator:
        """Residuals and Jacobians of this mechanism."""
        return Evaluator.of(self.arrays, self.system)

    def _at_once(self, most: int) -> int:
        """Return how many steps or rows the kernel is given at a time: an interrupt waits for them."""
        n = self.arrays.q.size
        return int(min(max(KINEMATIC_CALL_WORK / (n * min(n, DENSE_ELIMINATION)), 1), most))

    @property
    def steps_at_once(self) -> int:
        """Return how many steps the kernel is given at a time."""
        return self._at_once(MOST_STEPS_A_ROW)

    @property
    def _budget(self) -> int:
        """Attempts of a call; that the way is barred shows in what is left, and an assembly takes one."""
        return self.steps_at_once + 1

    def follower(self) -> Callable[..., Any]:
        """The continuation of this mechanism, by dense or by sparse factors: see `continuation.follow`."""
        if not self.arrays.q.size > DENSE_ELIMINATION:
            return lambda *arguments: continuation.follow(self.system, *arguments)
        if self._sparse is None:
            self._sparse = make_sparse_work(self.system, *self._left_out)
        return lambda *arguments: continuation.follow_sparse(self.system, self._sparse, *arguments)

    def carry(
        self,
        follow: Callable[..., Any],
        state: np.ndarray,
        motion: np.ndarray,
        clock: np.ndarray,
        t: float,
        attempts: int | None = None,
    ) -> bool:
        """Move state, motion and clock to the time t, or by so many attempts at a step; whether there."""
        out, audit = np.empty((1, *state.shape)), np.empty((1, 3))
        while clock[TIME] < t:
            clock[BUDGET] = attempts or self._budget
            follow(state, motion, clock, np.array([t]), out, audit)
            if attempts or clock[BUDGET] > 0.0:
                break
        return bool(clock[TIME] >= t)
