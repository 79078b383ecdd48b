"""Kinematic analysis of a mechanism: rows of positions, velocities and accelerations, block by block."""

from collections.abc import Iterator, Mapping

import numpy as np

from ...errors import AnalysisError
from ...kernels.kinematics.continuation import BUDGET
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
from ..singular.mobility import Mobility, moves_freely
from .assembly import (
    assemble_by_search,
    assembly_failure,
    free_motion_error,
    mobility,
    redundancy_warning,
    sized_equations,
    too_large_to_rank,
)
from .driver_axes import keeps_axis, refuse_contradicted_drive, refuse_off_axis_drive
from .joint_motion import WholeTurns
from .position import KinematicSettings, with_dependent_columns
from .rows import Rows, first_rows, joined_rows, rows_of
from .state import KinematicState

LARGEST_BLOCK = 1024  # rows
START_ASIDE = 1e-3  # of the time between rows: a start that is singular is no longer so


class KinematicAnalysis(KinematicState):
    """One run over the report times of a mechanism.

    `warnings` fills while the run continues.
    """

    def __init__(self, mechanism: Mechanism, settings: KinematicSettings | None = None):
        super().__init__(mechanism, settings)
        self.singularities = PassedKinematicSingularities(self)
        self.row = 0  # of the next block
        self.turns = WholeTurns(self.joints.turning)

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
        """Return whether a block holds all rows after the first: it is no chain to continue from."""
        return self.mechanism.time.rows - 1 <= self._at_once(LARGEST_BLOCK)

    @property
    def checkpoint(self) -> dict[str, np.ndarray]:
        """Return where to go on after the rows that have been yielded."""
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
        """Go on after the rows that were yielded up to a checkpoint; returns the first row.

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
        rows = min(self._at_once(LARGEST_BLOCK), self.mechanism.time.rows - row)
        memory = self.singularities.memory()
        block = self._block(row, row + rows)
        reached = 0 if block is None else block.time.size
        count, across = reached, None
        # A row so near to a bifurcation that its rates are round-off, and the one the continuation could not
        # reach.
        for k in (0 if block is None else self.singularities.first_without_rates(memory, block), reached):
            if k < rows and across is None:
                across = self._row_across(row + k, memory)
                count = reached if across is None else k
        part = None
        if block is not None and count:
            part = first_rows(block, count)
            self.singularities.look(memory, part)
            keeps_axis(self.mechanism, part)
        if across is None:
            short = count < rows
            return part, step_failure(self, self.mechanism.time.time(row + count)) if short else None
        try:
            return joined_rows(part, keeps_axis(self.mechanism, across)), None
        except AnalysisError as failure:
            return part, failure

    def _row_across(self, row: int, memory: tuple[np.ndarray, np.ndarray, np.ndarray]) -> Rows | None:
        """The report row, if it stands where two motions cross; else the continuation stays where it was."""
        before = self.state, self.motion, self.clock
        row_there = row_across(self.singularities, self.mechanism.time.time(row), memory)
        if row_there is None:
            self.state, self.motion, self.clock = before
        return row_there

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
        cache, arrays = self.arrays.of_variants, self.arrays
        if "sized" not in cache:
            start = arrays.q, self.mechanism.time.time(0), arrays.screw_angles
            cache["sized"] = sized_equations(self.evaluator, *start)
        return cache["sized"]

    def _nearer_row(self, first: Rows) -> Rows:
        """The first row on the assembly nearest to the estimates; Newton's method went far to `first`."""
        t, estimates = self.mechanism.time.time(0), self.arrays.q
        q, gap = assemble_by_search(self.evaluator, estimates, t, self.arrays.screw_angles)
        before, distance = (self.state, self.motion, self.clock), self.search.distance
        most = (1.0 - NEARER) * distance(estimates, self.state[0])
        if is_closed(gap) and distance(estimates, q) < most:
            self._restart(q)
            nearer = self._block(0, 1)
            if nearer is not None and distance(estimates, self.state[0]) < most:
                return nearer
            self.state, self.motion, self.clock = before
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
        freedom = mobility(evaluator, q, t, expected)
        for motion in freedom.motions:
            if moves_freely(evaluator, q, t, expected, motion):
                raise free_motion_error(evaluator, q, freedom, motion, t)
        if not freedom.dofs:
            self._restart(q)
            first = self._block(0, 1)
            if first is None:
                raise assembly_failure(evaluator, gap, t, (self.arrays.q, expected))
            return first
        return self._with_repetitions(q, freedom)

    def _with_repetitions(self, q: np.ndarray, at_start: Mobility) -> Rows:
        """The first row where equations repeat others, if they still do a little later.

        Raises AnalysisError if they do not: the start is a dead centre or a branching.
        """
        full, t = self.system, self.mechanism.time.time(0)
        self.system = with_dependent_columns(full, at_start.pivots)
        self._sparse, self._left_out = None, (at_start.repeated, at_start.pivots)
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
        self.warnings.append(redundancy_warning(at_start))
        return first
