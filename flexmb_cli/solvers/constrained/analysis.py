"""Motion of a constrained mechanism through its report times, block by block; what all dialects share."""

from abc import abstractmethod
from collections.abc import Iterator, Mapping
from itertools import chain
from typing import TYPE_CHECKING, Any

import numpy as np

from ...kernels.constrained.accelerations import accelerations, evaluate_jacobian, factorise_order
from ...kernels.constrained.angle_unwrapping import EXPECTED, NEW, OLD, fill_angles
from ...kernels.constrained.projection import project_position, project_speeds
from ...kernels.constrained.report import Report
from ...kernels.constrained.system import System
from ...kernels.integrators import clock as codes
from ...model.arrays.signals import set_due
from ...model.arrays.system import SystemArrays
from ...model.joints import DEPENDENT
from ...model.signals import SAME_SAMPLE, initial_states, is_sampled
from ..assembly import TO_GAP
from ..checkpoint import (
    arrays_in,
    contacts_in,
    faults_reported,
    fill_arrays,
    reported,
    restore_contacts,
    row_of,
    taken,
    taken_clock,
)
from ..curve_ends import on_curves
from ..singular.dynamic_singularities import PassedDynamicSingularities, is_singular
from ..singular.mobility import Mobility
from ..singular.overconstrained_loops import choose_far_apart, gap_note, independence
from .breakpoints import breakpoints, jumps_of_accelerations, warn_of_fine_tables
from .elements_at_start import notes_of_pressed_elements, refuse_coinciding_ends
from .failures import force_failure, note_undetermined_rows, repetition, rows_with_forces, step_failure
from .first_position import assemble
from .start import order_of_elimination, start_speeds
from .state import ConstrainedState
from .system import PositionGaps, blank_report, starts_sparse

if TYPE_CHECKING:
    from ...model.joint_elements import JointDriver
    from ..linearisation.terms import Terms


CALL_EVALUATIONS = 4000  # of the equations, handed to the kernel at a time: an interrupt waits for them
FEW_EVALUATIONS = 1  # the same where the choice of equations has to be looked at
WORN_CHOICE = 0.7  # least singular value of the equations chosen, of that when they were
LARGEST_BLOCK = 256  # rows


class ConstrainedMotion(ConstrainedState):
    """One run over the times of `grid`."""

    singularities: PassedDynamicSingularities  # see `rows`

    @abstractmethod
    def block(self, report: Report) -> Any:
        """The rows of a report in the terms of the model."""

    def rows(self) -> Iterator[Any]:
        """Yield the report rows in blocks.

        Raises ModelError when the drivers contradict the joints, AnalysisError when the mechanism
        cannot be assembled, reaches a singular position or has a motion without inertia; all rows
        before have been yielded.
        """
        behind = float(self.clock["stop"][0]) if self.resumed else -np.inf
        if not self.resumed:
            self.row, self.singularities = 0, PassedDynamicSingularities(self)
            self.start()
        self.resumed = False
        times = np.array([self.grid.time(k) for k in range(self.grid.rows)])
        end = times[-1]
        signals, start = self.elements.signals, self.grid.start
        stops = [*breakpoints(self, end), *([end] if is_sampled(signals, end - start) else [])]
        jumps = jumps_of_accelerations(self) if self.integrator.keeps_accelerations else frozenset()
        # A step that keeps accelerations ends just before they jump, and the next begins with those behind.
        landings = [np.nextafter(stop, -np.inf) if stop in jumps else stop for stop in stops]
        # Rows at samples are those after them.
        ends = [t - SAME_SAMPLE * abs(t) if is_sampled(signals, t - start) else t for t in landings]
        parts = np.split(np.arange(times.size), np.searchsorted(times, ends, "right"))
        for k, (stop, rows) in enumerate(zip([*landings, end], parts, strict=True)):
            if stop < behind:
                continue
            self.clock["stop"] = stop
            for report in self._reports(times[rows[rows >= self.row]]):
                self.singularities.look(report.times, report.states)
                note_undetermined_rows(self, report)
                self.row += report.times.size
                yield from on_curves(self.elements, [self.block(report)])
            # To the very breakpoint, where there need not be a row.
            for _ in self._reports(np.array([stop] if k < len(landings) else [])):
                pass
            if np.nextafter(stop, np.inf) in jumps:
                self._begin_anew(np.nextafter(stop, np.inf))
            if k < len(landings) and self._sample():
                self._begin_anew(stop)
        self.warnings += self.integrator.warnings(self.clock[0])

    @property
    def checkpoint(self) -> dict[str, np.ndarray]:
        """Return where to go on behind the rows that have been yielded: all that the integration keeps, and
        its work.
        """
        return {
            "row": np.array(self.row),
            "warnings": reported(self.warnings),
            "undetermined": np.array(self.undetermined),
            **arrays_in(integration=self.integration, work=self.work),
            **self.singularities.checkpoint,
            **contacts_in(self.arrays.contacts),
        }

    def restore(self, checkpoint: Mapping[str, np.ndarray]) -> None:
        """Go on behind the rows that were yielded up to a checkpoint.

        The start is made anew: it decides which equations repeat others.
        """
        self.start()
        self.row, self.resumed, self.singularities = (
            row_of(checkpoint),
            True,
            PassedDynamicSingularities(self),
        )
        self.warnings[:] = faults_reported(checkpoint)
        self.undetermined = taken(checkpoint, "undetermined", (None,)).tolist()
        size, equations = self.integration.z.size, len(self.arrays.equations)
        taken_clock(checkpoint, "integration/clock", self.clock, size, equations)
        fill_arrays(checkpoint, integration=self.integration, work=self.work)
        self.singularities.restore(checkpoint)
        restore_contacts(checkpoint, self.arrays.contacts)

    def _reports(self, times: np.ndarray) -> Iterator[Report]:
        """Reports of as many rows as a call fills, up to all `times`; raises AnalysisError."""
        while times.size:
            report = blank_report(self.arrays, times[:LARGEST_BLOCK], self.works)
            answer = self._call(codes.INTEGRATION, report)
            filled = int(self.clock["row"][0])
            if self.dependent > DEPENDENT and answer in (codes.ROWS_FULL, codes.PAUSED):
                self._choose_equations()
            times = times[filled:]
            known = rows_with_forces(report.responses[:filled])
            if known:
                yield report._replace(**_first(report, known))
            if known < filled:
                raise force_failure(self, report.responses[known], float(report.times[known]))
            if answer == codes.STEP_SHORT:
                self._excuse_short_steps()
            elif answer not in (codes.ROWS_FULL, codes.PAUSED):
                raise step_failure(self, answer)

    def _choose_equations(self) -> None:
        """Choose other independent equations of loops that close only nearly, before those at hand depend.

        The kernels do not: what one choice leaves of the gap is a step aside for another.
        """
        system, work, z = self.system, self.work, self.integration.z
        n, t = self._first.size, float(self.clock["t"][0])
        q, u = z[:n], z[n : n + self.arrays.speeds]
        evaluate_jacobian(system, work, q)
        if independence(work) > WORN_CHOICE * self._independence:
            return
        choose_far_apart(work, int(work.rank[0]))
        self._independence, work.quality[0] = independence(work), 0.0
        project_position(system, work, q, t, self.integration.angles[EXPECTED])
        project_speeds(system, work, q, u, t)
        self._begin()

    def _excuse_short_steps(self) -> None:
        """Go on where steps are short for a load or a spring; raises AnalysisError at a singular position."""
        if is_singular(self, self.integration.z[: self._first.size], self._first):
            raise step_failure(self, codes.STEP_VANISHED)
        self.clock["short_step_allowed"] = 1

    def _begin_anew(self, t: float) -> None:
        """Go on at t, s, behind a jump of the accelerations, with those behind it; raises AnalysisError."""
        keeps, memory = self.integrator.type.radius is not None, getattr(self.integration, "memory", None)
        span = memory["span"].copy() if memory is not None and keeps else 0.0
        self.clock["t"], self.clock["stop"] = t, self.grid.time(self.grid.rows - 1)
        self.clock["step"] = self.integrator.length
        self._begin()
        if memory is not None and keeps:
            memory["span"] = span

    def _sample(self) -> bool:
        """Take the samples of signals that are due at the state; return whether there are any."""
        signals, t, z = self.system.signals, float(self.clock["t"][0]), self.integration.z
        if not set_due(signals, self.elements.signals, self.grid.start, t):
            return False
        n = self.arrays.coordinate_scale.size
        end = n + self.arrays.speeds
        self.work.angles[:] = self.integration.angles[NEW]
        signals.states[:] = z[end : end + signals.states.size]
        accelerations(self.system, self.work, z[:n], z[n:end], t, np.zeros(self.arrays.speeds))
        z[end : end + signals.states.size] = signals.states
        signals.records["due"] = 0
        return True

    def _begin(self) -> None:
        """Choose the first step from where the integration stands; raises AnalysisError."""
        answer = self._call(codes.BEGIN, blank_report(self.arrays, np.zeros(0), self.works))
        if answer != codes.READY:
            raise step_failure(self, answer)

    def start(self) -> Mobility:
        """Assemble positions and speeds at the first time and choose the first step.

        Returns what the equations leave free, and which of them repeat others; raises as `rows`.
        """
        mobility = self.start_position()
        if self.starts_sparse:
            self.work.quality[0] = factorise_order(self.work)
        if self.dependent > DEPENDENT:
            self._independence, self.work.quality[0] = independence(self.work), 0.0
        self.clock["t"] = self.grid.start
        self.clock["stop"] = self.grid.time(self.grid.rows - 1)
        self._sample()
        self._begin()
        self.warnings += notes_of_pressed_elements(self.elements, self.arrays.loads, self.work.responses)
        return mobility

    def start_position(self) -> Mobility:
        """Assemble positions and speeds at the first time; returns and raises as `start`."""
        grid, integration = self.grid, self.integration
        # What continues another motion needs no position near that of the deck.
        q = np.zeros(self.arrays.coordinate_scale.size) if self.continues else self.assembled(grid.start)
        if self.rest is not None:
            q = self.rest[: q.size].copy()
        integration.angles[NEW] = integration.angles[OLD] = integration.angles[EXPECTED] = self.screw_angles(
            q
        )
        self.work.angles[:] = integration.angles[NEW]
        mobility = self.mobility = order_of_elimination(self, q, grid.start)
        integration.z[: q.size] = self._first = q
        # Rates that contradict others are refused here: what is left does repeat others.
        end = q.size + self.arrays.speeds
        integration.z[q.size : end] = (
            start_speeds(self, q, grid.start) if self.rest is None else self.rest[q.size :]
        )
        first = initial_states(self.elements.signals)
        end += len(self.arrays.signals.states) - first.size
        integration.z[end : end + first.size] = first
        refuse_coinciding_ends(self.system, self.work, chain(self.springs, self.elements.forces), grid.start)
        if mobility.redundant:
            self.warnings.append(repetition(mobility, self.usual_repetitions(q), *self.usual_words))
        warn_of_fine_tables(self)
        return mobility

    def first_position(
        self, t: float, tolerance: float, start: np.ndarray, *, estimates: bool = False
    ) -> tuple[PositionGaps, np.ndarray]:
        """Return the equations and coordinates (n + b,) near `start` that meet them; raises AnalysisError.

        `tolerance`: scaled gap at which overconstrained loops count as closed; `estimates`: the deck's
        positions are such.
        """
        gaps = self.gaps
        gaps.sparse = starts_sparse(self.arrays)
        q, loose = assemble(gaps, t, tolerance, start, estimates=estimates)
        if loose:
            self.dependent, self.clock["repeated"] = loose.dependent, TO_GAP * max(tolerance, loose.size)
            self.loop_note = gap_note(gaps, loose, tolerance)
            self.warnings.append(self.loop_note)
        return gaps, q

    @property
    def _evaluations(self) -> int:
        return FEW_EVALUATIONS if self.dependent > DEPENDENT else CALL_EVALUATIONS

    def _call(self, task: int, report: Report) -> int:
        def integrate(part: Report, evaluations: int) -> int:
            call = self.integrator.integrate_rows
            return int(call(task, self.system, self.work, self.integration, part, evaluations))

        if self.step_sequence is None or task == codes.BEGIN:
            return integrate(report, self._evaluations)
        once = self._evaluations == FEW_EVALUATIONS
        return self.step_sequence.fill(integrate, self.clock, report, once)

    def screw_angles(self, q: np.ndarray) -> np.ndarray:
        """Angles that count turns at q, those nearest to the deck's."""
        angles = self.first_angles.copy()
        fill_angles(self.system, self.work, q, self.first_angles, angles)
        return angles


def _first(report: Report, filled: int) -> dict[str, np.ndarray]:
    return {name: array[:filled] for name, array in report._asdict().items()}


class LinearisableMotion(ConstrainedMotion):
    """A motion with what lines START and its linearisation need besides."""

    @abstractmethod
    def driven_arrays(self, drivers: "tuple[JointDriver, ...]") -> SystemArrays:
        """Return the arrays with further drivers of joint coordinates, whose equations are the last."""

    def led(self, q: np.ndarray, t: float, tolerance: float) -> np.ndarray:
        """Return coordinates (n + b,) with the joint coordinates of lines START; raises AnalysisError."""
        if not self.elements.first_values:
            return q
        from .start_values import led_to_values

        q, self.first_angles = led_to_values(self, self.driven_arrays, q, t, tolerance)
        return q

    @property
    @abstractmethod
    def terms(self) -> "Terms":
        """Names of loads, drivers, joints and points."""

    @abstractmethod
    def driven_system(self, k: int, additions: list[float], t: float) -> System:
        """Return the system with additions to the value, rate and second rate of driver k at t."""
