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
    from ...solvers.constrained.driven_dynamics import DrivenDynamics
    from ...solvers.constrained.young_dynamics import ForwardDynamics

    analysis = DrivenDynamics(model) if model.analysis == "inverse" else ForwardDynamics(model)
    arrays, speeds = analysis.arrays.kinematic, analysis.arrays.speeds
    before = gaps_of(_Gaps(analysis), analysis.arrays, arrays.q, analysis.arrays.turns)
    try:
        found = analysis.start()
    finally:
        report.outcome.faults += analysis.warnings
    drivers = len(model.mechanism.drivers) + len(model.elements.drivers)
    report.counts = parts_of(model.mechanism) | {
        "equations": len(analysis.arrays.equations),
        "coordinates": speeds,
        "degrees_of_freedom": int(speeds - found.rank) + drivers,
    }
    report.time = model.mechanism.time.start
    q = analysis.march.z[: arrays.q.size]
    report.gaps = before_and_after(
        before, gaps_of(_Gaps(analysis), analysis.arrays, q, analysis.arrays.turns)
    )
    report.rank, report.smallest = int(found.rank), float(found.smallest)
    report.redundant = [[equation.name for equation in group] for group in found.redundant]
    report.free = [list(names) for names in found.free]
    refuse_warnings(report.outcome, options)


class _Gaps:
    """An analysis as `gaps_of` looks at it: the gaps of all its equations."""

    def __init__(self, analysis):
        from ...solvers.constrained.flexible_start import PositionGaps

        self.mechanism = analysis.mechanism
        self.evaluator = PositionGaps(analysis.arrays, analysis.system, analysis.work)
