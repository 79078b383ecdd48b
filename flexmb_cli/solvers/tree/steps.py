"""Report rows of a tree by steps of an integrator, and why the steps end early."""

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from ...errors import AnalysisError, Fault
from ...kernels.integrators import clock as codes
from ...kernels.integrators import tree_dop853
from ...kernels.tree.kane import SOLVED
from ...kernels.tree.report import Report
from ...kernels.tree.work import FRAME_WORK
from ...model.arrays.tree_elements import CLOSURE_ROW
from ...model.signals import SAME_SAMPLE, is_sampled
from ...model.tree import Tree
from ..step_sequence import StepSequence
from .assembly import pivot_shares, stray
from .breakpoints import why_no_step
from .rows import TreeRows, rows_by_recursion
from .state import TreeState

# Coordinate evaluations handed to the kernel at a time (about 0.1 µs each): an interrupt waits for them.
CALL_WORK = 2_000_000
LARGEST_BLOCK = 1024  # rows, of trees of a few bodies
LARGEST_FRAMES = 8192  # frames of all rows of a block, as long as it has 256
LARGEST_ANSWERS = 1 << 18  # answers of elements in all rows of a block: 16 MB
GO_ON = tree_dop853.GO_ON  # evaluate once, without a step


class TreeSteps(TreeState):
    """Blocks of rows from the state on; `attitude` and `row` follow them."""

    @property
    def in_body_axes(self) -> bool:
        """Return whether steps hold speeds of three free rotations in axes of their body."""
        return self.tree.integration.method != "sdirk4"

    def evaluate(self) -> int:
        """Evaluate the equations at the state, as steps hold it; return the code of the kernel."""
        return self.call(tree_dop853.GO_ON_STEPS if self.in_body_axes else GO_ON)

    step_sequence: StepSequence | None = None  # steps to record or to make again

    def rows_of_steps(self, integrate_rows: Callable[[Report, int], int], budget: int) -> Iterator[TreeRows]:
        """Yield report rows up to the next breakpoint by a compiled integrator.

        integrate_rows(report, budget) makes about `budget` evaluations and returns a code.
        """
        code = codes.PAUSED
        while self.row < self.tree.time.rows and code != codes.AT_STOP:
            report = self._blank_report(self._times_of_block())
            if self.step_sequence is None:
                code = integrate_rows(report, budget)
            else:
                code = self.step_sequence.fill(integrate_rows, self.clock, report, once=False)
            filled = int(self.clock["row"][0])
            unknown = np.isnan(report.answers[:filled]).any(axis=(1, 2))
            known = int(np.argmax(unknown)) if unknown.any() else filled
            if known:
                yield self._rows_of(Report(*(part[:known] for part in report)))
            if known < filled:
                from .attached_elements import lost_force

                failure = lost_force(self.tree, report.answers[known], float(report.times[known]))
                raise failure or self.failure()
            if code not in (codes.AT_STOP, codes.PAUSED, codes.ROWS_FULL):
                raise self.failure()

    def _times_of_block(self) -> Any:
        grid = self.tree.time
        most = max(256, LARGEST_FRAMES // len(self.arrays.frames))
        most = min(most, max(1, LARGEST_ANSWERS // (1 + len(self.arrays.answers))))
        last = min(self.row + min(most, LARGEST_BLOCK), grid.rows)
        times = np.array([grid.time(k) for k in range(self.row, last)])
        times[self._is_after_sample(times)] = np.nextafter(self.clock["stop"][0], np.inf)
        return times

    def _is_after_sample(self, times: Any) -> Any:
        """Return whether rows at times are at the end of the interval, where a sample comes before them."""
        stop, signals = float(self.clock["stop"][0]), self.tree.elements.signals
        ahead = stop != self.sampled_at and is_sampled(signals, stop - self.tree.time.start)
        return ahead & (np.abs(times - stop) <= SAME_SAMPLE * abs(stop))

    def due_times(self, t: float) -> list[float]:
        """Report times that have no row yet and do not lie past t."""
        grid = self.tree.time
        times: list[float] = []
        while self.row + len(times) < grid.rows and grid.time(self.row + len(times)) <= t:
            times.append(grid.time(self.row + len(times)))
        if times and self._is_after_sample(times[-1]):
            times.pop()
        return times

    def observe(self, state_at: Callable[..., Any], times: list[float]) -> TreeRows:
        """Report rows at the next report `times` with the states (n,) that `state_at` gives."""
        t, state = self.clock["t"].copy(), self.state.copy()
        reports = []
        for time in times:
            report = self._blank_report(np.array([time]))
            self.clock["t"], self.state[:] = time, state_at(time)
            self.integrate_rows(report, self.budget)
            reports.append(report)
        self.clock["t"], self.state[:] = t, state
        return self._rows_of(Report(*map(np.concatenate, zip(*reports, strict=True))))

    def _rows_of(self, report: Any) -> TreeRows:
        block = rows_by_recursion(self.tree, self.arrays, report, self.attitude)
        self.attitude = block.euler_parameters[-1]
        self.row += len(block.time)
        if not self.tree.elements:
            return block
        from ..constrained.tree_element_rows import with_answers

        return with_answers(self.tree, block, report)

    @property
    def budget(self) -> int:
        """Evaluations handed to DOP853 at a time."""
        return 1 + CALL_WORK // (1 + len(self.coordinates))

    def integrate_rows(self, report: Report, budget: int) -> int:
        """Fill report rows by DOP853; its code."""
        return int(
            tree_dop853.integrate_rows(
                self.arrays, self.work, self.coordinates, self.integration, report, budget
            )
        )

    def _blank_report(self, times: np.ndarray) -> Report:
        rows, n = times.size, len(self.coordinates)
        return Report(
            times,
            np.zeros((rows, self.state.size)),
            np.zeros((rows, self.work.size), FRAME_WORK),
            np.zeros((rows, n)),
            np.zeros((rows, self.arrays.closures.size), CLOSURE_ROW),
            np.zeros((rows, 5)),
            np.zeros((rows, *self.arrays.answers.shape)),
            np.zeros((rows, self.arrays.prescribed.size)),
            np.zeros((rows, len(self.arrays.signals.values))),
            np.zeros((rows, *self.arrays.reactions.shape)),
        )

    def failure(self) -> AnalysisError:
        """Return what the clock says went wrong."""
        clock = self.clock[0]
        t = float(clock["t"])
        norms = {"step": float(clock["step"]), "evaluations": int(clock["evaluations"])}
        if clock["fault"] != SOLVED:
            return AnalysisError(_no_inertia(self.tree, t, int(clock["fault"])), t, norms)
        if clock["projection_too_large"]:
            assert self.repeated is not None, "the tree has begun to move"
            shares, worst = pivot_shares(self.arrays), int(clock["worst"])
            return AnalysisError(stray(self.tree, shares, self.repeated, t, worst), t, norms)
        if failure := self.force_failure():
            return failure
        return AnalysisError(
            _step_vanished(self.tree, t, float(clock["step"]), int(clock["worst"])), t, norms
        )

    def force_failure(self) -> AnalysisError | None:
        """Return why elements have no force at the state, or where its speeds lead in a moment, or None."""
        if not self.tree.elements:
            return None
        from ..constrained.failures import MOMENTS
        from .attached_elements import lost_force

        t, z = float(self.clock["t"][0]), self.state.copy()
        ahead, failure = np.zeros(z.size), None
        for share in (0.0, *MOMENTS):
            self.state[:] = z + share * ahead
            if not np.isfinite(self.state).all():
                break
            self.evaluate()
            if failure := lost_force(self.tree, self.arrays.answers, t):
                break
            if not ahead.any():
                ahead = (self.tree.time.end - self.tree.time.start) * self.integration.slopes[0]
        self.state[:] = z
        return failure


def _no_inertia(tree: Tree, t: float, coordinate: Any) -> Fault:
    c = tree.coordinates[coordinate]
    body = tree.bodies[c.body]
    message = (
        f"at t = {t:.6g} s the mass matrix is not positive definite: no inertia is left that would resist "
        f"'{c.name}' while all that hangs on it moves freely; give {body.name} more inertia about its "
        "origin than its nodes account for"
    )
    return Fault("error", message, body.place, body.name, id="SOLVE-025")


def _step_vanished(tree: Tree, t: float, step: float, worst: int) -> Fault:
    n = len(tree.coordinates)
    c = tree.coordinates[worst % n] if worst < 2 * n else None
    place, name = (tree.bodies[c.body].place, c.name) if c else (None, "an Euler parameter")
    kind = "speed" if worst < n else "coordinate"
    message = (
        f"at t = {t:.6g} s the step length fell to {step:.1e} s; the {kind} with the largest error is "
        f"'{name}'; {why_no_step(tree, t)}"
    )
    return Fault("error", message, place, tree.bodies[c.body].name if c else "", id="SOLVE-026")
