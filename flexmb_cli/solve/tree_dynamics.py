"""Dynamic analysis of a tree: report rows of its motion, block by block.

Torque laws are linear between the breakpoints of their tables; the integration stops at each, so
that no step straddles a jump.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from ..errors import AnalysisError, Fault
from ..kernels import tree_march
from ..kernels.dop853_table import ALL_STAGES, DENSE_TERMS
from ..kernels.kane_tree import SOLVED
from ..kernels.tree_work import FRAME_WORK, tree_work
from ..model.tree import Table, Tree
from ..model.tree_arrays import CLOSURE_ROW, TreeArrays, initial_attitudes, tree_arrays
from .tree_assembly import assemble_tree
from .tree_rows import Observed, TreeRows, tree_rows

# Coordinate evaluations handed to the kernel at a time (about 0.1 µs each): an interrupt waits for them.
CALL_WORK = 2_000_000
LARGEST_BLOCK = 256  # rows


@dataclass(frozen=True, eq=False)
class Checkpoint:
    """Where a stopped run goes on: the start of the step before its next report row.

    `clock` is one record of `tree_march.CLOCK`, `state` (n,) the state at that time, `attitude`
    (N, 4) the Euler parameters of the last row, whose signs the next ones continue.
    """

    row: int
    clock: np.ndarray
    state: np.ndarray
    attitude: np.ndarray


class TreeAnalysis:
    """One run over the report times of a tree."""

    def __init__(self, tree: Tree, checkpoint: Checkpoint | None = None):
        self.tree = tree
        self.arrays: TreeArrays = tree_arrays(tree)
        self.work, self.coordinates = tree_work(len(self.arrays.frames), len(tree.coordinates))
        self.state = initial_state(tree)
        n = self.state.size
        self.old, self.trial = self.state.copy(), np.zeros(n)
        self.slopes, self.dense = np.zeros((ALL_STAGES, n)), np.zeros((DENSE_TERMS, n))
        self.clock = _clock(tree)
        self.row = 0
        self.attitude = None
        if checkpoint is not None:
            self._go_on_from(checkpoint)
        self.resumed = checkpoint is not None

    def _go_on_from(self, checkpoint):
        self.row, self.attitude = checkpoint.row, checkpoint.attitude
        self.clock[:] = checkpoint.clock
        self.state[:] = checkpoint.state

    @property
    def checkpoint(self) -> Checkpoint:
        """Where to go on after the rows that have been yielded."""
        clock = self.clock.copy()
        clock["t"], clock["step"] = clock["step_start"], clock["step_length"]
        clock["rejected"] = clock["step_rejected"]
        return Checkpoint(self.row, clock, self.old.copy(), self.attitude)

    def rows(self) -> Iterator[TreeRows]:
        """Yield the report rows in blocks.

        Raises AnalysisError where a loop cannot be closed, the mass matrix is not positive definite
        or the step length falls to round-off; all rows before have been yielded.
        """
        if not self.resumed:
            assemble_tree(self.tree, self._system(), self.state)
        grid = self.tree.time
        end = grid.time(grid.rows - 1)
        for stop in [*breakpoints(self.tree, float(self.clock["t"][0]), end), end]:
            self._start_interval(stop)
            status = tree_march.PAUSED
            while self.row < grid.rows and status != tree_march.AT_STOP:
                status, block = self._advance(stop)
                if block is not None:
                    yield block
                if status == tree_march.STEP_VANISHED:
                    raise self._failure()

    def _start_interval(self, stop):
        begin = float(self.clock["t"][0])
        set_laws(self.tree, self.arrays, begin, stop)
        if self.resumed:
            fault = tree_march.first_slope(*self._system(), self.clock[0], self.state, self.slopes)
        else:
            fault = tree_march.start(*self._system(), self.clock[0], self.state, self.slopes, self.trial)
        self.resumed = False
        self.old[:] = self.state
        if fault != SOLVED:
            self.clock["fault"] = fault
            raise self._failure()

    def _system(self):
        return self.arrays, self.work, self.coordinates

    def _advance(self, stop):
        """One call of the kernel: its status, and the rows it filled (None for none)."""
        grid = self.tree.time
        last = min(self.row + LARGEST_BLOCK, grid.rows)
        times = np.array([grid.time(k) for k in range(self.row, last)])
        states = np.zeros((times.size, self.state.size))
        scratch = (self.state, self.old, self.slopes, self.dense, self.trial)
        budget = 1 + CALL_WORK // (1 + len(self.coordinates))
        status = tree_march.march(*self._system(), self.clock[0], *scratch, stop, times, states, budget)
        filled = int(self.clock["row"][0])
        self.row += filled
        return status, self._observed(times[:filled], states[:filled]) if filled else None

    def _observed(self, times, states):
        frames = np.zeros((times.size, self.work.size), FRAME_WORK)
        rates, audit = np.zeros((times.size, self.coordinates.size)), np.zeros((times.size, 5))
        closures = np.zeros((times.size, self.arrays.closures.size), CLOSURE_ROW)
        tree_march.observe(*self._system(), times, states, frames, rates, audit, closures)
        observed = Observed(times, states, frames, rates, audit, closures)
        block = tree_rows(self.tree, self.arrays, observed, self.attitude)
        self.attitude = block.euler_parameters[-1]
        return block

    def _failure(self):
        clock = self.clock[0]
        t = float(clock["t"])
        norms = {"step": float(clock["step"]), "evaluations": int(clock["evaluations"])}
        if clock["fault"] != SOLVED:
            return AnalysisError(_no_inertia(self.tree, t, int(clock["fault"])), t, norms)
        return AnalysisError(
            _step_vanished(self.tree, t, float(clock["step"]), int(clock["worst"])), t, norms
        )


def initial_state(tree: Tree) -> np.ndarray:
    """State (n,) at the start: speeds, coordinates, Euler parameters, applied work."""
    return np.concatenate([tree.y, tree.q, initial_attitudes(tree).ravel(), [0.0]])


def _clock(tree):
    clock = np.zeros(1, tree_march.CLOCK)
    clock["t"] = clock["step_start"] = tree.time.start
    clock["rtol"], clock["atol"] = tree.integration.rtol, tree.integration.atol
    clock["fault"] = SOLVED
    return clock


def breakpoints(tree: Tree, start: float, end: float) -> list[float]:
    """Times inside (start, end) at which a law of the tree jumps or bends."""
    times = {t for item in (*tree.torques, *tree.motors) for t in item.law.times}
    return sorted(t for t in times if start < t < end)


def set_laws(tree: Tree, arrays: TreeArrays, begin: float, end: float) -> None:
    """Write the values c0 + c1 t that the laws have between two breakpoints into the arrays."""
    for record, item in zip(arrays.laws, (*tree.torques, *tree.motors), strict=True):
        record["c0"], record["c1"] = _line(item.law, (begin + end) / 2)


def _line(law: Table, t: float) -> tuple[float, float]:
    """Value at time 0 and slope of the piece of a table on which t lies."""
    after = int(np.searchsorted(law.times, t))
    if after == 0:
        return law.values[0], 0.0
    if after == len(law.times):
        return law.values[-1], 0.0
    (ta, tb), (va, vb) = law.times[after - 1 : after + 1], law.values[after - 1 : after + 1]
    slope = (vb - va) / (tb - ta)
    return va - slope * ta, slope


def _no_inertia(tree, t, coordinate):
    c = tree.coordinates[coordinate]
    body = tree.bodies[c.body]
    message = (
        f"at t = {t:.6g} s the mass matrix is not positive definite: no inertia is left that would resist "
        f"'{c.name}' while all that hangs on it moves freely; give {body.name} more inertia about its "
        "origin than its nodes account for"
    )
    return Fault("error", message, body.place, body.name)


def _step_vanished(tree, t, step, worst):
    n = len(tree.coordinates)
    c = tree.coordinates[worst % n] if worst < 2 * n else None
    place, name = (tree.bodies[c.body].place, c.name) if c else (None, "an Euler parameter")
    kind = "speed" if worst < n else "coordinate"
    message = (
        f"at t = {t:.6g} s the step length fell to {step:.1e} s; the {kind} with the largest error is "
        f"'{name}'; the motion or a load grows without bound there, or the tolerance is finer than round-off"
    )
    return Fault("error", message, place, tree.bodies[c.body].name if c else "")


def with_tolerance(tree: Tree, tolerance: float) -> Tree:
    """The same tree integrated to another relative and absolute tolerance."""
    return replace(tree, integration=replace(tree.integration, rtol=tolerance, atol=tolerance))
