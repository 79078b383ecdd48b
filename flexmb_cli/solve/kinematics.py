"""Kinematic analysis of a mechanism: rows of positions, velocities and accelerations, block by block."""

from collections.abc import Callable, Iterator

import numpy as np

from ..errors import Fault
from ..kernels import kinematic_march
from ..model.arrays import KinematicArrays, kinematic_arrays
from ..model.mechanism import Mechanism
from .assembly import assemble_by_search, assembly_failure, free_motion_error, redundancy_warning
from .diagnosis import CLOSED, mobility, moves_freely
from .kinematic_system import kinematic_system, rows_of, with_dependent_columns
from .lockup import step_failure
from .position import Evaluator
from .rows import Rows
from .settings import KinematicSettings
from .tilt import keeps_axis, refuse_contradicted_drive, refuse_tilted_drive

CALL_WORK = 2_000_000  # steps x equations² handed to the kernel at a time
LARGEST_BLOCK = 1024  # rows
MOST_STEPS = 5000


class KinematicAnalysis:
    """One run over the report times of a mechanism.

    `warnings` fills while the run goes on.
    """

    def __init__(self, mechanism: Mechanism, settings: KinematicSettings | None = None):
        self.mechanism = mechanism
        self.arrays: KinematicArrays = kinematic_arrays(mechanism)
        self.settings = settings or KinematicSettings()
        self.system = kinematic_system(self.arrays, self.settings)
        self.warnings: list[Fault] = []
        self._restart(self.arrays.q)

    def _restart(self, q):
        """Begin at the estimates q, which are assembled by the first step (a step of 0)."""
        self.state = np.zeros((3, q.size))
        self.state[0] = q
        self.motion = np.zeros((self.arrays.screw_angles.size, 3))
        self.motion[:, 0] = self.arrays.screw_angles
        self.clock = np.zeros(kinematic_march.CLOCK_SIZE)
        self.clock[kinematic_march.TIME] = self.mechanism.time.time(0)

    @property
    def evaluator(self) -> Evaluator:
        """Residuals and Jacobians of this mechanism."""
        return Evaluator.of(self.arrays, self.system)

    def rows(self) -> Iterator[Rows]:
        """Yield the report rows in blocks.

        Raises ModelError when something can move that nothing determines, AnalysisError when a
        position cannot be reached; all rows before have been yielded.
        """
        first = self._block(0, 1)
        if first is None:
            first = self._assemble_otherwise()
        refuse_tilted_drive(self.mechanism, first)
        yield first
        grid, size = self.mechanism.time, self._at_once(LARGEST_BLOCK)
        for start in range(1, grid.rows, size):
            end = min(start + size, grid.rows)
            block = self._block(start, end)
            if block is not None:
                yield keeps_axis(self.mechanism, block)
            if block is None or block.time.size < end - start:
                reached = start + (0 if block is None else block.time.size)
                raise step_failure(self, grid.time(reached))

    def _at_once(self, most):
        """How many steps or rows the kernel is given at a time: an interrupt waits for them."""
        return int(np.clip(CALL_WORK / self.arrays.q.size**2, 1, most))

    def _marcher(self) -> Callable:
        if not self.evaluator.is_large:
            return lambda *arguments: kinematic_march.march(self.system, *arguments)
        if not hasattr(self, "_sparse"):
            from .sparse_march import SparseMarch

            self._sparse = SparseMarch(self.evaluator)
        return self._sparse.march

    def _march(self, times, out, audit):
        """Fill rows until all are reached or the way is barred; returns how many were."""
        reached, march = 0, self._marcher()
        while reached < times.size:
            self.clock[kinematic_march.BUDGET] = self._at_once(MOST_STEPS)
            rest = slice(reached, None)
            reached += march(self.state, self.motion, self.clock, times[rest], out[rest], audit[rest])
            if self.clock[kinematic_march.BUDGET] > 0.0:
                break
        return reached

    def _block(self, start, end) -> Rows | None:
        """Report rows start … end - 1, fewer where one cannot be reached, None where none can."""
        times = np.array([self.mechanism.time.time(k) for k in range(start, end)])
        out = np.zeros((times.size, 3, self.arrays.q.size))
        audit = np.zeros((times.size, 3))
        reached = self._march(times, out, audit)
        if not reached:
            return None
        return rows_of(self.mechanism, times[:reached], out[:reached], audit[:reached])

    def _assemble_otherwise(self) -> Rows:
        """The first row where plain Newton fails: by search, and past equations that repeat others."""
        evaluator, t = self.evaluator, self.mechanism.time.time(0)
        near = self.arrays.screw_angles
        q, gap = assemble_by_search(evaluator, self.arrays.q, t, near)
        if np.max(np.abs(gap)) > CLOSED:
            refuse_contradicted_drive(self.mechanism, self.settings)
            raise assembly_failure(evaluator, gap, t)
        found = mobility(evaluator, q, t, near)
        for motion in found.motions:
            if moves_freely(evaluator, q, t, near, motion):
                raise free_motion_error(evaluator, q, found, motion, t)
        if found.freedoms:
            self.warnings.append(redundancy_warning(found))
            self.system = with_dependent_columns(self.system, found.pivots)
        self._restart(q)
        first = self._block(0, 1)
        if first is None:
            raise assembly_failure(evaluator, gap, t)
        return first
