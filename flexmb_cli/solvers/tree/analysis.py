"""Dynamic analysis of a tree: report rows of its motion, block by block.

The integration stops at the breakpoints of functions of time, so that no step straddles a jump.
"""

from collections.abc import Callable, Iterator, Mapping
from typing import Any

import numpy as np

from ...errors import AnalysisError, Fault
from ...kernels.contact import AT_START, CONTACT_COLUMNS, END, TOUCHES
from ...kernels.integrators import clock as codes
from ...kernels.integrators import tree_dop853
from ...kernels.tree.kane import SOLVED
from ...kernels.tree.report import Report
from ...kernels.tree.work import FRAME_WORK, tree_work
from ...model.arrays.tree import TreeArrays, initial_attitudes, tree_arrays
from ...model.arrays.tree_elements import CLOSURE_ROW
from ...model.integrators import LIBRARY_TREE_METHODS, steps_at_limit
from ...model.joint_elements import names_of
from ...model.tree import Tree
from ..checkpoint import row_of, taken, taken_clock
from .assembly import assemble_tree, pivot_shares, stray
from .breakpoints import breakpoints, refuse_jumps, why_no_step
from .rows import TreeRows, rows_by_recursion

# Coordinate evaluations handed to the kernel at a time (about 0.1 µs each): an interrupt waits for them.
CALL_WORK = 2_000_000
LARGEST_BLOCK = 1024  # rows, of trees of a few bodies
LARGEST_FRAMES = 8192  # frames of all rows of a block, as long as it has 256
LARGEST_ANSWERS = 1 << 18  # answers of elements in all rows of a block: 16 MB


GO_ON = tree_dop853.GO_ON  # evaluate once, without a step


class TreeAnalysis:
    """One run over the report times of a tree, from the start or from the `checkpoint` of a stopped run."""

    def __init__(self, tree: Tree, checkpoint: Mapping[str, np.ndarray] | None = None):
        self.tree = tree
        self.arrays: TreeArrays = tree_arrays(tree)
        self.work, self.coordinates = tree_work(len(self.arrays.frames), len(tree.coordinates))
        start = initial_state(tree)
        self.coordinates["held"] = self.arrays.given
        works = 1 + len(self.arrays.answers)
        if works > 1 and self.arrays.given.all() and tree.integration.method == "dop853":
            works = 0  # where nothing is free to move, errors of works alone show what a step passes over
        self.integration = tree_dop853.new_integration(start.size, works)
        self.integration.z[:] = start
        self.clock = self.integration.clock
        self.clock["t"] = self.clock["step_start"] = tree.time.start
        self.clock["rtol"], self.clock["atol"] = tree.integration.rtol, tree.integration.atol
        self.row = 0
        self.attitude: np.ndarray | None = None  # (N, 4) Euler parameters of the last row
        self.repeated: np.ndarray | None = None  # (R,) closed directions that depend on others at the start
        self.warnings: list[Fault] = []  # fills at the start
        self.loop_note: Fault | None = None  # on loops that close only nearly
        self.resumed = False
        answers = self.arrays.answers
        self._contacts = answers[:, TOUCHES:].copy() if answers.shape[1] == CONTACT_COLUMNS else None
        if checkpoint is not None:
            self.restore(checkpoint)

    @property
    def state(self) -> np.ndarray:
        """State (n,) at the end of the last step: speeds, coordinates, Euler parameters, work."""
        return self.integration.z

    @property
    def checkpoint(self) -> dict[str, np.ndarray]:
        """Return where to go on after the rows that have been yielded: the start of the last step.

        The same steps follow.  The integrators of scipy keep a memory of steps: with them it is the last
        breakpoint.  `clock` is one record of CLOCK, `state` (n,) the state at that time,
        in the axes of the steps, `attitude` (N, 4) the Euler parameters of the last row, whose
        signs the next ones continue.
        """
        assert self.attitude is not None, "rows have been yielded"
        clock = self.clock.copy()
        clock["t"], clock["step"] = clock["step_start"], clock["step_tried"]
        clock["rejected"] = clock["step_rejected"]
        # The step that is made again is no second try of itself.
        clock["length"] = np.inf
        return {
            "row": np.array(self.row),
            "clock": clock,
            "state": self.integration.old.copy(),
            "attitude": self.attitude,
            **self._attachments(),
            **self._contacts_to_go_on(),
        }

    def restore(self, checkpoint: Mapping[str, np.ndarray]) -> None:
        """Go on behind the rows that were yielded up to a checkpoint."""
        self.resumed = True
        self.row = row_of(checkpoint)
        self.attitude = taken(checkpoint, "attitude", (len(self.tree.bodies), 4))
        size = self.integration.z.size
        self.clock[:] = taken_clock(checkpoint, "clock", self.clock, size, size)
        self.integration.z[:] = taken(checkpoint, "state", self.integration.z.shape)
        for name, values in self._attachments().items():
            values[:] = taken(checkpoint, name, values.shape)
        if self._contacts is not None:
            self.arrays.answers[:, TOUCHES:] = taken(checkpoint, "contacts", self._contacts.shape)

    def _attachments(self) -> dict[str, np.ndarray]:
        """Return what elements keep of the motion before, by names in resume files."""
        if not self.tree.elements:
            return {}
        elements, values = self.arrays.elements, self.arrays.closures["value"]
        names = {"bushing_axes": elements["turned"], "bushing_angles": elements["expected"]}
        return {**names, "coupling_values": values}

    def _contacts_to_go_on(self) -> dict[str, np.ndarray]:
        """Return touches, states and gaps (elements, …) of contacts from which a resumed run continues."""
        if self._contacts is None:
            return {}
        found = self._contacts.copy()
        if self.tree.integration.method == "dop853":
            found[:] = self.arrays.answers[:, TOUCHES:]
            found[:, END - TOUCHES :] = found[:, AT_START - TOUCHES : END - TOUCHES]
        return {"contacts": found}

    @property
    def stopped_at(self) -> tuple[float, float, float, float, np.ndarray]:
        """Return where a run ends: tolerance, time aimed at, step, time, and speeds and coordinates (2
        n,).
        """
        clock, grid = self.clock[0], self.tree.time
        aim = grid.time(min(self.row, grid.rows - 1))
        state = self.state[: 2 * len(self.tree.coordinates)]
        return float(clock["rtol"]), aim, float(clock["step"]), float(clock["t"]), state

    def rows(self) -> Iterator[TreeRows]:
        """Yield the report rows in blocks.

        Raises AnalysisError where a loop cannot be closed, the mass matrix is not positive definite
        or the step length falls to round-off; all rows before have been yielded.
        """
        grid = self.tree.time
        end = grid.time(grid.rows - 1)
        refuse_jumps(self.tree)
        for stop in [*breakpoints(self.tree, float(self.clock["t"][0]), end), end]:
            self._start_interval(stop)
            try:
                yield from self._rows_up_to(stop)
            finally:
                if self.in_body_axes:
                    self.call(tree_dop853.LEAVE_STEPS)
            if self.tree.closures and self.tree.integration.method in LIBRARY_TREE_METHODS:
                self.call(tree_dop853.CLOSE)
        self.warnings += steps_at_limit(self.clock[0], "--method sdirk4 or radau (METH 4, 2)")

    @property
    def in_body_axes(self) -> bool:
        """Return whether steps hold speeds of three free rotations in axes of their body."""
        return self.tree.integration.method != "sdirk4"

    def _rows_up_to(self, stop: float) -> Iterator[TreeRows]:
        method = self.tree.integration.method
        if method == "dop853":
            return self.rows_of_steps(self.integrate_rows)
        if method == "sdirk4":
            from .scipy_integrators import implicit_rows

            return implicit_rows(self)
        from .scipy_integrators import library_rows

        return library_rows(self, stop)

    def evaluate(self) -> int:
        """Evaluate the equations at the state, as steps hold it; return the code of the kernel."""
        return self.call(tree_dop853.GO_ON_STEPS if self.in_body_axes else GO_ON)

    def rows_of_steps(self, integrate_rows: Callable[..., Any]) -> Iterator[TreeRows]:
        """Yield report rows up to the next breakpoint by a compiled integrator, `integrate_rows(report)`."""
        code = codes.PAUSED
        while self.row < self.tree.time.rows and code != codes.AT_STOP:
            report = self._blank_report(self._times_of_block())
            code = integrate_rows(report)
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
        return grid.start + np.arange(self.row, last) * grid.step

    def due_times(self, t: float) -> list[float]:
        """Report times that have no row yet and do not lie past t."""
        grid = self.tree.time
        times: list[float] = []
        while self.row + len(times) < grid.rows and grid.time(self.row + len(times)) <= t:
            times.append(grid.time(self.row + len(times)))
        return times

    def observe(self, state_at: Callable[..., Any], times: list[float]) -> TreeRows:
        """Report rows at the next report `times` with the states (n,) that `state_at` gives."""
        t, state = self.clock["t"].copy(), self.state.copy()
        reports = []
        for time in times:
            report = self._blank_report(np.array([time]))
            self.clock["t"], self.state[:] = time, state_at(time)
            self.integrate_rows(report)
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

    def call(self, task: int) -> int:
        """Have the kernel do one of the tasks of `tree_dop853` that make no steps; its code."""
        return int(tree_dop853.begin(task, self.arrays, self.work, self.coordinates, self.integration))

    def integrate_rows(self, report: Report) -> int:
        """Fill report rows by DOP853; its code."""
        budget = 1 + CALL_WORK // (1 + len(self.coordinates))
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
            np.zeros((rows, *self.arrays.reactions.shape)),
        )

    def _start_interval(self, stop: float) -> None:
        hold_functions(self.arrays, stop)
        self.clock["stop"] = stop
        if self.row == 0 and not self.resumed:
            assemble_tree(self)
        begin = tree_dop853.BEGIN_STEPS if self.in_body_axes else codes.BEGIN
        code = self.evaluate() if self.resumed else self.call(begin)
        if self._contacts is not None and code != codes.NO_INERTIA:
            # The first step begins with the contacts of the state, not with those of the probe before it.
            code = self.evaluate()
            self._contacts = self.arrays.answers[:, TOUCHES:].copy()
        self.resumed = False
        self.integration.old[:] = self.integration.z
        if code == codes.NO_INERTIA:
            raise self.failure()
        if self.repeated is None:
            self.repeated = pivot_shares(self.arrays) == 0.0
            if self.repeated.any():
                self._warn_of_repetition(self.repeated)

    def _warn_of_repetition(self, repeated: np.ndarray) -> None:
        from .loop_assembly import repetition

        self.warnings += filter(None, [repetition(self.tree, repeated)])

    def failure(self) -> AnalysisError:
        """Return what the clock says went wrong."""
        clock = self.clock[0]
        t = float(clock["t"])
        norms = {"step": float(clock["step"]), "evaluations": int(clock["evaluations"])}
        if clock["fault"] != SOLVED:
            return AnalysisError(_no_inertia(self.tree, t, int(clock["fault"])), t, norms)
        if clock["strayed"]:
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


def initial_state(tree: Tree) -> np.ndarray:
    """State (n,) at the start: speeds, coordinates, Euler parameters, works of elements, applied work."""
    works = np.zeros(1 + len(list(names_of(tree.elements))))
    return np.concatenate([tree.y, tree.q, initial_attitudes(tree).ravel(), works])


def hold_functions(arrays: TreeArrays, end: float) -> None:
    """Have functions of time, which may jump at the end of an interval, hold what they are just before it."""
    for records in (arrays.elements, arrays.prescribed, arrays.torques):
        records["until"] = np.nextafter(end, -np.inf)


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
