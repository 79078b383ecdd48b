"""Diagnose a dynamic model: assembly, rank, repeated equations and what is free to move.

Where drivers move it (inverse dynamics), it is diagnosed as in kinematics.
"""

from typing import TYPE_CHECKING

from ...model.loads import DynamicModel
from ...model.unit_checks import unit_warnings
from ..context import Run
from .check import CheckReport
from .parts import (
    before_and_after,
    gaps_of,
    is_small,
    is_too_large,
    note_moves,
    note_slips,
    parts_of,
    refuse_jacobian,
    start_of,
)

if TYPE_CHECKING:
    from ...solvers.constrained.young_dynamics import ForwardDynamics


def check(report: CheckReport, model: DynamicModel, run: Run, jacobian: str | None) -> None:
    """Fill the `CheckReport`; raises FlexmbError for what cannot be run."""
    run.warn(unit_warnings(model))
    if model.analysis == "forward" or model.elements:
        refuse_jacobian(
            jacobian, "it is printed of kinematics and inverse dynamics without elements at joints"
        )
        from ...solvers.compilation import interpreting

        if is_too_large(report, parts_of(model.mechanism), 7 * len(model.mechanism.bodies)):
            return
        loads = model.forces, model.torques, model.springs, *model.elements.groups()
        with interpreting(is_small(6 * len(model.mechanism.bodies), *loads)):
            _check_forward(report, model, run)
        return
    from . import kinematic

    kinematic.check(report, model.mechanism, run, jacobian)


def _check_forward(report: CheckReport, model: DynamicModel, run: Run) -> None:
    from ...solvers.constrained.young_dynamics import DrivenDynamics, ForwardDynamics

    analysis = DrivenDynamics(model) if model.analysis == "inverse" else ForwardDynamics(model)
    arrays, speeds = analysis.arrays.kinematic, analysis.arrays.speeds
    gaps = _Gaps(analysis)
    before = gaps_of(gaps, analysis.arrays, arrays.q, analysis.arrays.angles)
    try:
        found = start_of(analysis, report)
    finally:
        report.outcome.faults += analysis.warnings
    drivers = len(model.mechanism.drivers) + len(model.elements.drivers)
    report.counts = parts_of(model.mechanism) | {
        "equations": len(analysis.arrays.equations),
        "coordinates": speeds,
        "degrees_of_freedom": int(speeds - found.rank) + drivers,
    }
    report.time = model.mechanism.time.start
    q = analysis.integration.z[: arrays.q.size]
    report.gaps = before_and_after(before, gaps_of(gaps, analysis.arrays, q, analysis.arrays.angles))
    note_slips(report, gaps.evaluator, arrays.q, report.time, analysis.arrays.angles)
    note_moves(report, analysis.arrays, arrays.q, q)
    report.rank, report.smallest = int(found.rank), float(found.smallest)
    report.redundant = [[equation.name for equation in group] for group in found.redundant]
    report.free = [list(names) for names in found.free]
    run.warn(())


class _Gaps:
    """An analysis as `gaps_of` looks at it: the gaps of all its equations."""

    def __init__(self, analysis: "ForwardDynamics"):
        self.mechanism = analysis.mechanism
        self.evaluator = analysis.gaps
