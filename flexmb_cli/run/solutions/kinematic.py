"""Kinematics of a mechanism that its drivers move."""

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from ...model.mechanism import Mechanism
from ...results.hdf5.kinematic import kinematic_layout, kinematic_values
from ...solvers.compilation import announce_compiling
from ...solvers.kinematics.analysis import KinematicAnalysis
from ...solvers.kinematics.position import KinematicSettings
from ..error_estimate import nothing_to_refine
from ..outcome import Run
from . import NoCount, Solution
from .at_rest import refuse_rest

if TYPE_CHECKING:
    import numpy as np

    from ...solvers.kinematics.variants import Variants


def solution(mechanism: Mechanism, run: Run) -> Solution:
    """Return the kinematics of `mechanism`, ready to be solved."""
    if run.options.as_printed:
        return _as_printed(mechanism, run)
    refuse_rest(run, None)
    announce_compiling(run.listener, "kinematics.continuation.follow")
    analysis = KinematicAnalysis(mechanism, KinematicSettings(**run.options.solver))
    whole = _solution(mechanism, analysis, run, not analysis.one_block)
    return replace(whole, variants=lambda: _variants(analysis))


def _variants(analysis: KinematicAnalysis) -> "Variants":
    from ...solvers.kinematics.variants import Variants

    return Variants(analysis)


def _solution(mechanism: Mechanism, analysis: Any, run: Run, resumable: bool) -> Solution:
    return Solution(
        analysis,
        mechanism.time.rows,
        lambda: kinematic_layout(mechanism),
        kinematic_values,
        NewtonCount(),
        warnings=analysis.warnings,
        finer=nothing_to_refine,
        identity=dict(run.options.solver),
        resumable=resumable,
    )


def _as_printed(mechanism: Mechanism, run: Run) -> Solution:
    """The numbers of the program of 1996, errors included; each row takes moments."""
    from ...solvers.as_printed.program import AsPrinted

    run.outcome.as_printed = True
    return _solution(mechanism, AsPrinted(mechanism, run.options.solver), run, False)


class NewtonCount(NoCount):
    """Iterations and residuals so far."""

    def __init__(self) -> None:
        self.iterations = self.most = 0
        self.residual = 0.0

    def add(self, values: Mapping[str, "np.ndarray"]) -> None:
        """Count a block of values."""
        iterations = values["audit/newton_iterations"]
        self.iterations += int(iterations.sum())
        self.most = max(self.most, int(iterations.max()))
        self.residual = max(self.residual, float(values["audit/constraint_residual"].max()))

    def __str__(self) -> str:
        return (
            f"Newton iterations {self.iterations}, at most {self.most} in a row; "
            f"largest residual {self.residual:.1e}"
        )
