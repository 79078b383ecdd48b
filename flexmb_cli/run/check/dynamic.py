"""Diagnose a dynamic model: assembly, rank, repeated equations and what is free to move.

Where drivers move it (inverse dynamics), it is diagnosed as in kinematics.
"""

from ...model.loads import DynamicModel
from ...model.unit_checks import unit_doubts
from ..context import Run
from .check import CheckReport
from .parts import before_and_after, gaps_of, parts_of


def check(report: CheckReport, model: DynamicModel, run: Run, jacobian: str | None) -> None:
    """Fill the `CheckReport`; raises FlexmbError for what cannot be run."""
    run.warn(unit_doubts(model))
    if model.analysis == "forward":
        _check_forward(report, model, run)
        return
    from . import kinematic

    kinematic.check(report, model.mechanism, run, jacobian)


def _check_forward(report, model, run):
    from ...solvers import compilation

    compilation.interpret()
    from ...solvers.constrained.young_dynamics import ForwardDynamics

    analysis = ForwardDynamics(model)
    arrays, speeds = analysis.arrays.kinematic, analysis.arrays.speeds
    before = gaps_of(analysis, arrays, arrays.q)
    try:
        found = analysis.start()
    finally:
        report.outcome.faults += analysis.warnings
    report.counts = parts_of(model.mechanism) | {
        "equations": len(arrays.equations),
        "coordinates": speeds,
        "degrees_of_freedom": int(speeds - found.rank) + len(model.mechanism.drivers),
    }
    report.time = model.mechanism.time.start
    report.gaps = before_and_after(before, gaps_of(analysis, arrays, analysis.march.z[: arrays.q.size]))
    report.rank, report.smallest = int(found.rank), float(found.smallest)
    report.redundant = [[equation.name for equation in group] for group in found.redundant]
    report.free = [list(names) for names in found.free]
    run.warn(())
