"""Dynamics of a mechanism with masses and loads: forward, or inverse where drivers move it."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any

from ...errors import Fault, ModelError
from ...model.integrators import word_of
from ...model.loads import DynamicModel
from ...model.unit_checks import unit_warnings
from ...results.hdf5.dynamic import dynamic_layout, dynamic_values
from ...solvers.compilation import announce_compiling
from ..energy_drift import ConstrainedDrift, StepCount
from ..error_estimate import finer_motion, nothing_to_refine
from ..outcome import Run, RunOptions
from ..python_options import set_tolerances
from . import Solution
from .at_rest import begin_at_rest, refuse_rest

if TYPE_CHECKING:
    from ...solvers.constrained.young_dynamics import ForwardDynamics
    from ...solvers.kinematics.inverse_dynamics import InverseDynamics


TOO_COARSE = (
    "too coarse a tolerance (card TOLERANCE), or steps of GALF that are too long or damp too much (a "
    "spectral radius below 1)"
)


def solution(model: DynamicModel, run: Run) -> Solution:
    """Return the dynamics of `model`, ready to be solved."""
    if run.options.as_printed:
        reported = "the program of 1996 has no dynamics: leave out --as-printed, or the cards after DYNAMICS"
        raise ModelError([Fault("error", reported, id="RUN-031")])
    model = _as_asked(model, run.options)
    if model.analysis != "forward":
        refuse_rest(run, model.elements)
    stepped = model.analysis == "forward" or bool(model.elements)
    analysis: Any = (_stepped if stepped else _inverse)(model, run)
    # Results of a prescribed motion hold no energies.
    drift = ConstrainedDrift(TOO_COARSE) if model.analysis == "forward" else None
    count = StepCount(analysis.clock if stepped else None, drift)
    layout, values = _contents(model)
    return Solution(
        analysis,
        model.mechanism.time.rows,
        layout,
        values,
        count,
        partial(unit_warnings, model, run.outcome.system),
        analysis.warnings,
        partial(finer_motion, partial(_stepped, model), values) if stepped else nothing_to_refine,
        dict(run.options.integration if stepped else run.options.solver),
        stepped or not analysis.one_block,
    )


def _as_asked(model: DynamicModel, options: RunOptions) -> DynamicModel:
    """The model with the method and tolerance of the options; a prescribed motion depends on neither."""
    if model.analysis != "forward":
        return model
    given, integrator = options.integration, model.integrator
    if "rtol" in given:
        integrator = replace(integrator, tolerance=given["rtol"])
    if "method" in given:
        integrator = replace(integrator, method=word_of(given["method"]))
    return replace(model, integrator=integrator)


def _contents(model: DynamicModel) -> tuple[Callable[..., Any], Callable[..., Any]]:
    """Functions of the layout of the HDF5 file and of its values from report rows."""
    if not model.elements:
        return partial(dynamic_layout, model), partial(dynamic_values, model)
    from ...results.hdf5.dynamic import element_layout, values_with_elements

    return partial(element_layout, model), partial(values_with_elements, model)


def _stepped(model: DynamicModel, run: Run) -> "ForwardDynamics":
    """The analysis that takes time steps: forward, or prescribed by drivers beside elements at joints."""
    from ...solvers.constrained.young_dynamics import DrivenDynamics, ForwardDynamics

    forward = model.analysis == "forward"
    analysis = (ForwardDynamics if forward else DrivenDynamics)(model)
    if forward:
        set_tolerances(analysis, run.options, run.outcome)
        mechanism = model.mechanism
        begin_at_rest(
            analysis,
            partial(ForwardDynamics, model),
            run,
            6 * len(mechanism.bodies),
            mechanism.time,
            model.elements,
        )
    announce_compiling(run.listener, analysis.integrator.entry)
    return analysis


def _inverse(model: DynamicModel, run: Run) -> "InverseDynamics":
    from ...solvers.kinematics.inverse_dynamics import InverseDynamics
    from ...solvers.kinematics.position import KinematicSettings

    announce_compiling(run.listener, "constrained.report.observe_rows")
    return InverseDynamics(model, KinematicSettings(**run.options.solver))
