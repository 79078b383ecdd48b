"""Diagnose a dynamic model: assembly, rank, repeated equations and what is free to move.

Where drivers move it (inverse dynamics), it is diagnosed as in kinematics.
"""

from ...model.loads import DynamicModel
from ...model.unit_checks import unit_warnings
from ..outcome import Run
from .check import (
    CheckReport,
    gaps_of,
    is_small,
    is_too_large,
    note_moves,
    note_slips,
    parts_of,
    record_assembly,
    record_mobility,
    refuse_jacobian,
    start_of,
)


def check(report: CheckReport, model: DynamicModel, run: Run, jacobian: str | None) -> None:
    """Fill the `CheckReport`; raises FlexmbError for what cannot be run."""
    run.warn(unit_warnings(model, run.outcome.system))
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
    arrays, speeds = analysis.arrays, analysis.arrays.speeds
    report.time, q = model.mechanism.time.start, arrays.kinematic.q
    before = gaps_of(analysis.gaps, arrays, q, report.time, arrays.angles)
    try:
        freedom = start_of(analysis, report)
    finally:
        report.outcome.faults += analysis.warnings
    drivers = len(model.mechanism.drivers) + len(model.elements.drivers)
    report.counts = parts_of(model.mechanism) | {
        "equations": len(arrays.equations),
        "coordinates": speeds,
        "degrees_of_freedom": int(speeds - freedom.rank) + drivers,
    }
    assembled = analysis.integration.z[: q.size]
    record_assembly(report, before, gaps_of(analysis.gaps, arrays, assembled, report.time, arrays.angles))
    note_slips(report, analysis.gaps, q, report.time, arrays.angles)
    note_moves(report, arrays, q, assembled)
    record_mobility(report, freedom)
    run.warn(())
