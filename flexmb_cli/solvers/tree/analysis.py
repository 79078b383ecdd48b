"""Dynamic analysis of a tree: report rows of its motion, block by block.

The integration stops at the breakpoints of functions of time, so that no step straddles a jump.
"""

from collections.abc import Iterator, Mapping

import numpy as np

from ...errors import Fault
from ...kernels.integrators import clock as codes
from ...kernels.integrators import tree_dop853
from ...model.arrays.signals import set_due
from ...model.arrays.tree import TreeArrays
from ...model.integrators import LIBRARY_TREE_METHODS, steps_at_limit
from ...model.laws import CONTACT
from ...model.signals import is_sampled
from ...model.tree import Tree
from ..checkpoint import contacts_in, faults_reported, reported, restore_contacts, row_of, taken, taken_clock
from ..curve_ends import on_curves
from .assembly import assemble_tree, pivot_shares
from .breakpoints import breakpoints, refuse_jumps
from .rows import TreeRows
from .steps import TreeSteps


class TreeAnalysis(TreeSteps):
    """One run over the report times of a tree, from the start or from the `checkpoint` of a stopped run."""

    rest: np.ndarray | None = None  # state (n,) that it begins with, in place of the deck's
    continues = False  # whether it continues another motion, whose state `rest` is

    def __init__(self, tree: Tree, checkpoint: Mapping[str, np.ndarray] | None = None):
        super().__init__(tree)
        self._contacts = contacts_in(self.arrays.contacts)  # at the last breakpoint
        if checkpoint is not None:
            self.restore(checkpoint)

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
            "warnings": reported(self.warnings),
            "clock": clock,
            "state": self.integration.old.copy(),
            "attitude": self.attitude,
            **self._attachments(),
            **(contacts_in(self.arrays.contacts, at_start=True) if self._by_steps else self._contacts),
        }

    def restore(self, checkpoint: Mapping[str, np.ndarray]) -> None:
        """Go on after the rows that were yielded up to a checkpoint."""
        self.resumed = True
        self.row = row_of(checkpoint)
        self.warnings[:] = faults_reported(checkpoint)
        self.attitude = taken(checkpoint, "attitude", (len(self.tree.bodies), 4))
        size = self.integration.z.size
        self.clock[:] = taken_clock(checkpoint, "clock", self.clock, size, size)
        self.integration.z[:] = taken(checkpoint, "state", self.integration.z.shape)
        for name, values in self._attachments().items():
            values[:] = taken(checkpoint, name, values.shape)
        restore_contacts(checkpoint, self.arrays.contacts)

    def _attachments(self) -> dict[str, np.ndarray]:
        """Return what elements keep of the motion before, by names in resume files."""
        if not self.tree.elements:
            return {}
        elements, values = self.arrays.elements, self.arrays.closures["value"]
        names = {"bushing_axes": elements["turned"], "bushing_angles": elements["expected"]}
        return {**names, "coupling_values": values, "parameters": self.arrays.closures["parameter"]}

    @property
    def _by_steps(self) -> bool:
        """Return whether a stopped run continues from its last step, not from the last breakpoint."""
        return self.tree.integration.method == "dop853"

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
        if self.row == 0 and not self.resumed:
            self.warnings += self._notes_of_contacts()
        stops = [*breakpoints(self.tree, float(self.clock["t"][0]), end), end]
        if is_sampled(self.tree.elements.signals, end - grid.start):
            stops.append(end)
        for stop in stops:
            self._start_interval(stop)
            try:
                yield from on_curves(self.tree.elements, self._rows_up_to(stop))
            finally:
                if self.in_body_axes:
                    self.call(tree_dop853.LEAVE_STEPS)
            if self.tree.closures and self.tree.integration.method in LIBRARY_TREE_METHODS:
                self.call(tree_dop853.CLOSE)
        self.warnings += steps_at_limit(self.clock[0], "--method sdirk4 or radau (METH 4, 2)")

    def _notes_of_contacts(self) -> Iterator[Fault]:
        """Yield a note if contacts begin and end within steps of a method of scipy."""
        method, contacts = self.tree.integration.method, self.tree.elements.of(CONTACT)
        if contacts and method in LIBRARY_TREE_METHODS:
            message = (
                f"begins and ends within steps of {method}, whose error control must resolve it, and touches "
                "are not counted; --method dop853 or sdirk4 stops there"
            )
            yield Fault("note", message, contacts[0].place, contacts[0].name, id="SOLVE-232")

    def _rows_up_to(self, stop: float) -> Iterator[TreeRows]:
        method = self.tree.integration.method
        if method == "dop853":
            return self.rows_of_steps(self.integrate_rows, self.budget)
        if method == "sdirk4":
            from .scipy_integrators import implicit_rows

            return implicit_rows(self)
        from .scipy_integrators import library_rows

        return library_rows(self, stop)

    def _start_interval(self, stop: float) -> None:
        hold_functions(self.arrays, stop)
        self.clock["stop"] = stop
        if self.row == 0 and not self.resumed:
            if not self.continues:
                assemble_tree(self)
            if self.rest is not None:
                self.state[:] = self.rest
        if not self.resumed:
            self._sample()
        begin = tree_dop853.BEGIN_STEPS if self.in_body_axes else codes.BEGIN
        code = self.evaluate() if self.resumed else self.call(begin)
        if self._contacts and code != codes.NO_INERTIA:
            # The first step begins with the contacts of the state, not with those of the probe before it.
            code = self.evaluate()
            self._contacts = contacts_in(self.arrays.contacts)
        resumed, self.resumed = self.resumed, False
        self.integration.old[:] = self.integration.z
        if code == codes.NO_INERTIA:
            raise self.failure()
        if self.repeated is None:
            self.repeated = pivot_shares(self.arrays) == 0.0
            if self.repeated.any() and not resumed:
                self._warn_of_repetition(self.repeated)

    def _sample(self) -> None:
        """Take the samples of signals that are due at the state, which is in axes of the hinges."""
        signals, t = self.arrays.signals, float(self.clock["t"][0])
        if not set_due(signals, self.tree.elements.signals, self.tree.time.start, t):
            return
        self.call(tree_dop853.GO_ON)
        self.sampled_at = t
        first = 2 * len(self.coordinates) + 4 * self.arrays.balls
        self.state[first : first + signals.states.size] = signals.states
        signals.records["due"] = 0

    def _warn_of_repetition(self, repeated: np.ndarray) -> None:
        from .loop_assembly import repetition

        self.warnings += filter(None, [repetition(self.tree, repeated)])


def hold_functions(arrays: TreeArrays, end: float) -> None:
    """Have functions of time, which may jump at the end of an interval, hold what they are just before it."""
    for records in (arrays.elements, arrays.prescribed, arrays.torques, arrays.signals.records):
        records["until"] = np.nextafter(end, -np.inf)
