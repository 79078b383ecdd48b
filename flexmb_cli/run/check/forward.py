"""Diagnose a deck of forward dynamics: assembly, rank, repeated equations and what is free to move."""

from ...dialects.young.build_dynamics import build_young_dynamics
from ...model.unit_checks import unit_doubts
from ..outcome import RunOptions, refuse_warnings
from .parts import before_and_after, gaps_of, parts_of


def check_forward(report, options: RunOptions) -> None:
    """Fill the `CheckReport`; raises FlexmbError for what cannot be run."""
    model, warnings = build_young_dynamics(report.deck)
    report.outcome.faults += [*warnings, *unit_doubts(model)]
    refuse_warnings(report.outcome, options)
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
    refuse_warnings(report.outcome, options)
