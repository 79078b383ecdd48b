"""Kinematic analysis of a mechanism: rows of positions, velocities and accelerations, block by block."""

from collections.abc import Callable, Iterator, Mapping
from typing import Any

import numpy as np

from ...errors import AnalysisError, Fault
from ...kernels.kinematics import continuation
from ...kernels.kinematics.continuation import BUDGET, CLOCK_SIZE, TIME
from ...kernels.kinematics.newton import SparseWork, make_sparse_work
from ...model.arrays.kinematic import KinematicArrays, kinematic_arrays
from ...model.mechanism import Mechanism
from ..assembly import NEARER, Sized, is_closed
from ..checkpoint import faults_reported, reported, row_of, taken
from ..projection import RESIDUAL_MET
from ..singular.kinematic_singularities import (
    PassedKinematicSingularities,
    row_across,
    singular_start,
    step_failure,
)
from ..singular.mobility import Mobility, mobility, moves_freely
from .assembly import (
    assemble_by_search,
    assembly_failure,
    free_motion_error,
    redundancy_warning,
    sized_equations,
    too_large_to_rank,
)
from .driver_axes import keeps_axis, refuse_contradicted_drive, refuse_off_axis_drive
from .joint_motion import JointMotion, WholeTurns
from .position import Evaluator, KinematicSettings, kinematic_system, with_dependent_columns
from .rows import Rows, first_rows, joined_rows, rows_of

KINEMATIC_CALL_WORK = 2_000_000  # steps x equations² handed to the kernel at a time
DENSE_ELIMINATION = 140  # equations: above, only entries other than zero are kept
LARGEST_BLOCK = 1024  # rows
MOST_STEPS_A_ROW = 5000
START_ASIDE = 1e-3  # of the time between rows: a start that is singular is no longer so


class KinematicAnalysis:
    """One run over the report times of a mechanism.

    `warnings` fills while the run continues.
    """

    def __init__(self, mechanism: Mechanism, settings: KinematicSettings | None = None):
        self.mechanism = mechanism
        self.arrays: KinematicArrays = kinematic_arrays(mechanism)
        self.settings = settings or KinematicSettings()
        self.system = kinematic_system(self.arrays, self.settings)
        self.warnings: list[Fault] = []
        self.singularities = PassedKinematicSingularities(self)
        self._sparse: SparseWork | None = None
        self._left_out: tuple[tuple[int, ...], tuple[int, ...]] = (), ()
        self.row = 0  # of the next block
        self.joints = JointMotion(mechanism)
        self.turns = WholeTurns(self.joints.turning)
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

    def rows(self) -> Iterator[Rows]:
        """Yield the report rows in blocks.

        Raises ModelError when something can move that nothing determines, AnalysisError when a
        position cannot be reached; all rows before have been yielded.
        """
        return self.joints.continued(self._blocks(), self.turns)

    def _blocks(self) -> Iterator[Rows]:
        if self.row == 0:
            first, self.row = self._first_row(), 1
            yield first
        while self.row < self.mechanism.time.rows:
            block, failure = self._next_block(self.row)
            if block is not None:
                self.row += block.time.size
                yield block
            if failure is not None:
                raise failure

    def _first_row(self) -> Rows:
        first = self._block(0, 1)
        if first is None:
            first = self._assemble_otherwise()
        elif not self.search.is_near(self.arrays.q, self.state[0]):
            first = self._nearer_row(first)
        refuse_off_axis_drive(self.mechanism, first)
        return first

    @property
    def one_block(self) -> bool:
        """Return whether a block holds all rows behind the first: it is no chain to continue from."""
        return self.mechanism.time.rows - 1 <= self._at_once(LARGEST_BLOCK)

    @property
    def checkpoint(self) -> dict[str, np.ndarray]:
        """Return where to go on behind the rows that have been yielded."""
        return {
            "row": np.array(self.row),
            "state": self.state,
            "motion": self.motion,
            "clock": self.clock,
            "reported": np.array(self.singularities.notes.count),
            "warnings": reported(self.warnings),
            **self.turns.checkpoint,
        }

    def restore(self, checkpoint: Mapping[str, np.ndarray]) -> Rows:
        """Go on behind the rows that were yielded up to a checkpoint; returns the first row.

        That is solved anew, because it decides which equations repeat others.
        """
        first = self._first_row()
        self.row = row_of(checkpoint)
        self.state, self.motion, self.clock = (
            np.array(taken(checkpoint, name, like.shape))
            for name, like in (("state", self.state), ("motion", self.motion), ("clock", self.clock))
        )
        self.singularities.notes.count = int(taken(checkpoint, "reported", (), np.int64))
        self.warnings[:] = faults_reported(checkpoint)
        self.turns.restore(checkpoint)
        return first

    def _next_block(self, row: int) -> tuple[Rows | None, AnalysisError | None]:
        """The next report rows, and why none follow; the last may stand at a bifurcation of two motions."""
        wanted = min(self._at_once(LARGEST_BLOCK), self.mechanism.time.rows - row)
        memory = self.singularities.memory()
        block = self._block(row, row + wanted)
        reached = 0 if block is None else block.time.size
        count, across = reached, None
        # A row so near to a bifurcation that its rates are round-off, and the one the continuation could not
        # reach.
        for k in (0 if block is None else self.singularities.first_without_rates(memory, block), reached):
            if k < wanted and across is None:
                across = self._row_across(row + k, memory)
                count = reached if across is None else k
        part = None
        if block is not None and count:
            part = first_rows(block, count)
            self.singularities.look(memory, part)
            keeps_axis(self.mechanism, part)
        if across is None:
            short = count < wanted
            return part, step_failure(self, self.mechanism.time.time(row + count)) if short else None
        try:
            return joined_rows(part, keeps_axis(self.mechanism, across)), None
        except AnalysisError as failure:
            return part, failure

    def _row_across(self, row: int, memory: tuple[np.ndarray, np.ndarray, np.ndarray]) -> Rows | None:
        """The report row, if it stands where two motions cross; else the continuation stays where it was."""
        kept = self.state, self.motion, self.clock
        found = row_across(self, self.mechanism.time.time(row), memory)
        if found is None:
            self.state, self.motion, self.clock = kept
        return found

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

    def _follow(self, times: np.ndarray, out: np.ndarray, audit: np.ndarray) -> int:
        """Fill rows until all are reached or the way is barred; returns how many were."""
        reached, follow = 0, self.follower()
        while reached < times.size:
            self.clock[BUDGET] = self._budget
            rest = slice(reached, None)
            reached += follow(self.state, self.motion, self.clock, times[rest], out[rest], audit[rest])
            if self.clock[BUDGET] > 0.0:
                break
        return reached

    def _block(self, start: int, end: int) -> Rows | None:
        """Report rows start … end - 1, fewer where one cannot be reached, None where none can."""
        times = np.array([self.mechanism.time.time(k) for k in range(start, end)])
        out = np.zeros((times.size, 3, self.arrays.q.size))
        audit = np.zeros((times.size, 3))
        reached = self._follow(times, out, audit)
        if not reached:
            return None
        return rows_of(self.mechanism, times[:reached], out[:reached], audit[:reached], self.joints.of)

    @property
    def search(self) -> Sized:
        """Sizes and distances, which the functions of the drivers do not change."""
        kept, arrays = self.arrays.of_variants, self.arrays
        if "sized" not in kept:
            start = arrays.q, self.mechanism.time.time(0), arrays.screw_angles
            kept["sized"] = sized_equations(self.evaluator, *start)
        sized: Sized = kept["sized"]
        return sized

    def _nearer_row(self, first: Rows) -> Rows:
        """The first row on the assembly nearest to the estimates; Newton's method went far to `first`."""
        t, estimates = self.mechanism.time.time(0), self.arrays.q
        q, gap = assemble_by_search(self.evaluator, estimates, t, self.arrays.screw_angles)
        kept, distance = (self.state, self.motion, self.clock), self.search.distance
        most = (1.0 - NEARER) * distance(estimates, self.state[0])
        if is_closed(gap) and distance(estimates, q) < most:
            self._restart(q)
            nearer = self._block(0, 1)
            if nearer is not None and distance(estimates, self.state[0]) < most:
                return nearer
            self.state, self.motion, self.clock = kept
        return first

    def _assemble_otherwise(self) -> Rows:
        """The first row where plain Newton fails: by search, and past equations that repeat others."""
        evaluator, t = self.evaluator, self.mechanism.time.time(0)
        expected = self.arrays.screw_angles
        q, gap = assemble_by_search(evaluator, self.arrays.q, t, expected)
        if np.max(np.abs(gap)) > RESIDUAL_MET:
            refuse_contradicted_drive(self.mechanism, self.settings)
            raise assembly_failure(evaluator, gap, t, (self.arrays.q, expected))
        if q.size > self.settings.most_ranked:
            raise too_large_to_rank(q.size, self.settings.most_ranked, t)
        found = mobility(evaluator, q, t, expected)
        for motion in found.motions:
            if moves_freely(evaluator, q, t, expected, motion):
                raise free_motion_error(evaluator, q, found, motion, t)
        if not found.dofs:
            self._restart(q)
            first = self._block(0, 1)
            if first is None:
                raise assembly_failure(evaluator, gap, t, (self.arrays.q, expected))
            return first
        return self._with_repetitions(q, found)

    def _with_repetitions(self, q: np.ndarray, found: Mobility) -> Rows:
        """The first row where equations repeat others, if they still do a little later.

        Raises AnalysisError if they do not: the start is a dead centre or a branching.
        """
        full, t = self.system, self.mechanism.time.time(0)
        self.system = with_dependent_columns(full, found.pivots)
        self._sparse, self._left_out = None, (found.repeated, found.pivots)
        self.singularities = PassedKinematicSingularities(self, active=False)
        self._restart(q)
        first, start = self._block(0, 1), self.singularities.memory()
        later = t + START_ASIDE * self.mechanism.time.step
        arrived = first is not None and self.carry(
            self.follower(), self.state, self.motion, self.clock, later
        )
        if (
            first is None
            or not arrived
            or mobility(self.evaluator, self.state[0], later, self.motion[:, 0]).dofs == 0
        ):
            self.system = full
            raise singular_start(self, q, t)
        self.state, self.motion, self.clock = start
        self.warnings.append(redundancy_warning(found))
        return first
