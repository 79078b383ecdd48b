"""Inverse dynamics: reactions and driver efforts of the motion that the drivers prescribe."""

from collections.abc import Iterator, Mapping
from dataclasses import fields, replace
from itertools import chain

import numpy as np

from ...errors import AnalysisError, Fault
from ...kernels.constrained.accelerations import choose_order, evaluate_jacobian
from ...kernels.constrained.report import Report, observe_rows
from ...model.arrays.dynamic import dynamic_arrays
from ...model.loads import DynamicModel
from ..checkpoint import arrays_in, fill_arrays
from ..constrained.elements_at_start import refuse_coinciding_ends
from ..constrained.rows import DynamicRows, body_axes, dynamic_rows
from ..constrained.system import blank_report, constrained_system, new_work
from .analysis import KinematicAnalysis
from .position import KinematicSettings
from .rows import Rows


class InverseDynamics:
    """One run over the report times of a driven mechanism; its motion is that of the kinematic analysis."""

    def __init__(self, model: DynamicModel, settings: KinematicSettings | None = None):
        self.model = model
        self.mechanism = model.mechanism
        self.motion = KinematicAnalysis(model.mechanism, settings)
        self.arrays = dynamic_arrays(model)
        self.system = constrained_system(self.arrays)
        self.work = new_work(self.arrays)
        self._ordered = False

    @property
    def warnings(self) -> list[Fault]:
        """Warnings found so far."""
        return self.motion.warnings

    def rows(self) -> Iterator[DynamicRows]:
        """Yield the report rows in blocks; raises as `KinematicAnalysis.rows` does.

        `applied_work` is nan: between the rows the efforts are not known.
        """
        for rows in self.motion.rows():
            yield self.with_forces(rows)

    @property
    def one_block(self) -> bool:
        """Return whether a block holds all rows after the first."""
        return self.motion.one_block

    @property
    def checkpoint(self) -> dict[str, np.ndarray]:
        """Return where to go on after the rows that have been yielded."""
        return self.motion.checkpoint | arrays_in(work=self.work)

    def restore(self, checkpoint: Mapping[str, np.ndarray]) -> None:
        """Go on after the rows that were yielded up to a checkpoint."""
        self.with_forces(self.motion.restore(checkpoint))
        fill_arrays(checkpoint, work=self.work)

    def with_forces(self, rows: Rows) -> DynamicRows:
        """Return rows of the motion with the forces that belong to them; raises AnalysisError."""
        report = blank_report(self.arrays, rows.time)
        _fill_states(report, rows)
        if not self._ordered:
            self._choose_order(report)
        expected = np.zeros((rows.time.size, self.arrays.angles.size))
        filled = observe_rows(self.system, self.work, expected, report)
        if filled < rows.time.size:
            raise undetermined(rows.time[filled])
        fields_of_rows = {field.name: getattr(rows, field.name) for field in fields(Rows)}
        return replace(dynamic_rows(self.model, report, self.arrays.place_of_work), **fields_of_rows)

    def _choose_order(self, report: Report) -> None:
        bodies = len(self.mechanism.bodies)
        evaluate_jacobian(self.system, self.work, report.states[0, : 7 * bodies])
        if choose_order(self.work, self.arrays.speeds) < self.arrays.speeds:
            raise undetermined(report.times[0])
        model, start = self.model, float(report.times[0])
        refuse_coinciding_ends(self.system, self.work, chain(model.springs, model.elements.forces), start)
        self._ordered = True


def _fill_states(report: Report, rows: Rows) -> None:
    p = rows.euler_parameters
    q = np.concatenate([rows.position, p], axis=2)
    u = np.concatenate([rows.velocity, body_axes(p, rows.angular_velocity)], axis=2)
    times = rows.time.size
    report.states[:] = np.column_stack([q.reshape(times, -1), u.reshape(times, -1), np.full(times, np.nan)])


def undetermined(t: float) -> AnalysisError:
    """The drivers and joints leave the speeds open at a position."""
    message = (
        f"at t = {t:.6g} s the position is singular: joints and drivers do not determine all velocities, "
        "so no unique forces belong to the motion"
    )
    return AnalysisError(Fault("error", message, id="SOLVE-013"), t)
