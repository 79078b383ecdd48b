"""Diagnose a mechanism that its drivers move: assembly, rank, redundant and free coordinates, the Jacobian.

Small mechanisms are assembled by the same kernels left uncompiled, so that `check` answers at once.
"""

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from ...errors import Fault, ModelError
from ...model.mechanism import Mechanism, TimeGrid
from ..outcome import Run
from .check import (
    FARTHEST_STEPS,
    CheckReport,
    LabelledJacobian,
    gaps_of,
    is_too_large,
    note_moves,
    note_slips,
    parts_of,
    record_assembly,
    record_mobility,
)

if TYPE_CHECKING:
    from ...solvers.kinematics.analysis import KinematicAnalysis


MOST_EQUATIONS_INTERPRETED = 150  # equations
FAR_STEPS = 100  # report steps to the time of a Jacobian
RANK_LIMIT = 10_000  # equations, whose rank takes seconds


def check(report: CheckReport, mechanism: Mechanism, run: Run, jacobian: str | None) -> None:
    """Fill the `CheckReport`; raises FlexmbError for what cannot be run."""
    _diagnose(report, mechanism, jacobian)
    run.warn(())


def _diagnose(report: CheckReport, mechanism: Mechanism, jacobian: str | None) -> None:
    from ...solvers.compilation import interpreting

    equations = 7 * len(mechanism.bodies)
    if is_too_large(report, parts_of(mechanism), equations):
        return
    with interpreting(equations <= MOST_EQUATIONS_INTERPRETED and not _is_far(mechanism.time, jacobian)):
        _assemble(report, mechanism, jacobian, equations)


def _assemble(report: CheckReport, mechanism: Mechanism, jacobian: str | None, equations: int) -> None:
    from ...solvers.kinematics.analysis import KinematicAnalysis
    from ...solvers.kinematics.assembly import mobility
    from ...solvers.kinematics.position import KinematicSettings

    # Points take no part in what is looked at, and there may be a million of them.
    analysis = KinematicAnalysis(replace(mechanism, points=()), KinematicSettings(most_ranked=RANK_LIMIT))
    report.counts = _counts(mechanism, analysis)
    arrays, report.time = analysis.arrays, mechanism.time.start
    start = arrays.q, report.time, arrays.screw_angles
    before = gaps_of(analysis.evaluator, arrays, *start)
    if jacobian == "estimate":
        report.jacobian = _labelled(analysis, arrays.q, None)
    try:
        next(analysis.rows())
    finally:
        report.outcome.faults += analysis.warnings
    record_assembly(report, before, gaps_of(analysis.evaluator, arrays, analysis.state[0], *start[1:]))
    note_slips(report, analysis.evaluator, *start)
    note_moves(report, arrays, arrays.q, analysis.state[0])
    if equations <= RANK_LIMIT:
        record_mobility(
            report, mobility(analysis.evaluator, analysis.state[0], report.time, analysis.motion[:, 0])
        )
    if jacobian not in (None, "estimate"):
        report.jacobian = _jacobian_at(mechanism, float(jacobian))


def _is_far(grid: TimeGrid, jacobian: str | None) -> bool:
    """Return whether the Jacobian is requested so late that computing up to there needs compiled kernels."""
    return jacobian not in (None, "estimate") and float(jacobian) - grid.start > FAR_STEPS * grid.step


def _counts(mechanism: Mechanism, analysis: "KinematicAnalysis") -> dict[str, dict[str, int] | int]:
    equations, coordinates = len(analysis.arrays.equations), analysis.arrays.q.size
    return parts_of(mechanism) | {
        "equations": equations,
        "coordinates": coordinates,
        "degrees_of_freedom": coordinates - equations + len(mechanism.drivers),
    }


def _jacobian_at(mechanism: Mechanism, time: float) -> LabelledJacobian:
    """Φ_q at any time from the start on; the mechanism is moved there first."""
    from ...solvers.kinematics.analysis import KinematicAnalysis

    start = mechanism.time.start
    if not time >= start:
        message = f"--jacobian {time:g}: the motion begins at t = {start:g} s"
        raise ModelError([Fault("error", message, id="RUN-003")])
    if time - start > FARTHEST_STEPS * mechanism.time.step:
        message = (
            f"--jacobian {time:g}: later than {FARTHEST_STEPS} of the deck's steps; ask for an earlier time"
        )
        raise ModelError([Fault("error", message, id="RUN-004")])
    grid = replace(mechanism.time, end=time, step=max(time - start, 1.0))
    analysis = KinematicAnalysis(replace(mechanism, time=grid))
    for _ in analysis.rows():
        pass
    return _labelled(analysis, analysis.state[0], time)


def _labelled(analysis: "KinematicAnalysis", q: np.ndarray, time: float | None) -> LabelledJacobian:
    evaluator, arrays = analysis.evaluator, analysis.arrays
    evaluator.residual(q, analysis.mechanism.time.start, arrays.screw_angles)
    matrix = evaluator.jacobian(q) * arrays.row_scale[:, None] / arrays.column_scale
    factors = np.array([equation.factor for equation in arrays.equations])
    names = tuple(equation.name for equation in arrays.equations)
    return LabelledJacobian(time, names, arrays.body_names, matrix * factors[:, None])
