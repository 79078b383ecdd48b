"""Dynamics of a mechanism with masses and loads: forward, or inverse where drivers move it."""

from functools import partial

from ...errors import Fault, ModelError
from ...model.loads import DynamicModel
from ...model.unit_checks import unit_doubts
from ...results.hdf5.dynamic import dynamic_layout, dynamic_values
from ...solvers.compilation import tell_of_compiling
from ..context import Run
from ..energy_drift import ConstrainedDrift
from ..error_estimate import finer_motion, nothing_to_refine
from ..solution import Solution
from ..step_count import StepCount

TOO_COARSE = (
    "too coarse a tolerance (card TOLERANCE), or steps of GALF that are too long or damp too much (a "
    "spectral radius below 1)"
)


def solution(model: DynamicModel, run: Run) -> Solution:
    """Return the dynamics of `model`, ready to be solved."""
    if run.options.as_printed:
        told = "the program of 1996 knows no dynamics: leave out --as-printed, or the cards behind DYNAMICS"
        raise ModelError([Fault("error", told, id="RUN-025")])
    forward = model.analysis == "forward"
    analysis = (_forward if forward else _inverse)(model, run)
    count = StepCount(analysis.clock, ConstrainedDrift(TOO_COARSE)) if forward else StepCount()
    values = partial(dynamic_values, model)
    return Solution(
        analysis,
        model.mechanism.time.rows,
        lambda: dynamic_layout(model),
        values,
        count,
        partial(unit_doubts, model),
        analysis.warnings,
        partial(finer_motion, partial(_forward, model), values) if forward else nothing_to_refine,
        {} if forward else dict(run.options.solver),
        forward or not analysis.one_block,
    )


def _forward(model, run):
    from ...solvers.constrained.young_dynamics import ForwardDynamics

    analysis = ForwardDynamics(model)
    tell_of_compiling(run.listener, analysis.stepper.entry)
    return analysis


def _inverse(model, run):
    from ...solvers.kinematics.inverse_dynamics import InverseDynamics
    from ...solvers.kinematics.settings import KinematicSettings

    tell_of_compiling(run.listener, "constrained.report.observe_rows")
    return InverseDynamics(model, KinematicSettings(**run.options.solver))
