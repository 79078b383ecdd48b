"""Integrators of scipy for trees: Radau IIA(5) for stiff elastic modes, and LSODA.

Radau (Hairer and Wanner, Solving Ordinary Differential Equations II, section IV.8) damps vibrations
that its steps do not resolve and is then many times faster than an explicit method; LSODA (Petzold,
1983) switches between the families of DGEAR, which the thesis used: Adams and backward differences.
Loops are closed at the report times and breakpoints, not at every step.
"""

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from ...errors import AnalysisError, Fault
from ...kernels.integrators import clock as codes
from ...kernels.integrators import sdirk4
from ...kernels.tree.report import Report
from .breakpoints import why_no_step
from .rows import TreeRows

if TYPE_CHECKING:
    from .steps import TreeSteps

INCREMENT = 1.5e-8  # of a coordinate or speed, or of 1 SI unit: the root of the round-off
WATCHED, HOPELESS = 1000, 1e6  # steps; how many times as many may be left to the end of the interval
UNCOUNTED = 1e6  # tolerance of the applied work, whose error must not choose the steps, J


def library_rows(analysis: "TreeSteps", stop: float) -> Iterator[TreeRows]:
    """Report rows of a TreeSteps up to the breakpoint `stop`, whose functions are set."""
    from scipy.integrate import LSODA, Radau

    settings, clock = analysis.tree.integration, analysis.clock[0]
    atol = np.full(analysis.state.size, settings.atol)
    atol[clock["counted"] :] = UNCOUNTED
    # scipy refuses anything finer and would print a warning.
    rtol = max(settings.rtol, 100 * np.finfo(float).eps)
    if analysis.due_times(clock["t"]):
        yield analysis.observe(lambda t: analysis.state.copy(), analysis.due_times(clock["t"]))
    arguments: dict[str, Any] = {"rtol": rtol, "atol": atol}

    def slope(t: float, z: np.ndarray) -> Any:
        return _slope(analysis, t, z)

    if settings.method == "radau":
        arguments["jac"] = jacobian_of(slope)
    solver = {"radau": Radau, "lsoda": LSODA}[settings.method](
        slope, float(clock["t"]), analysis.state.copy(), stop, **arguments
    )
    steps, mark = 0, solver.t
    while solver.status == "running":
        try:
            solver.step()
        except ValueError:  # slopes that are no numbers in Radau's matrix
            solver.status = "failed"
        steps += 1
        if steps % WATCHED == 0:
            # scipy continues with steps of any shortness where nothing can be resolved.
            if stop - solver.t > HOPELESS * (solver.t - mark):
                raise _step_failure(analysis, solver.t)
            mark = solver.t
        if solver.status == "failed":
            clock["t"], analysis.state[:] = solver.t, solver.y
            raise analysis.force_failure() or _step_failure(analysis, solver.t)
        times = analysis.due_times(solver.t)
        if times:
            yield analysis.observe(solver.dense_output(), times)
    clock["t"], analysis.state[:] = stop, solver.y


def jacobian_of(slope: Callable[[float, np.ndarray], np.ndarray]) -> Callable[[float, np.ndarray], Any]:
    """Return the function (t, z) of the Jacobian (n, n) of `slope`(t, z), by forward differences.

    Radau's own differences become larger from call to call for coordinates that act on nothing, such as the
    place of a free body, until they overflow.
    """

    def jacobian(t: float, z: np.ndarray) -> Any:
        increments = (z + INCREMENT * np.maximum(1.0, np.abs(z))) - z
        columns = [slope(t, z + row) for row in np.diag(increments)]
        return ((np.array(columns) - slope(t, z)) / increments[:, None]).T

    return jacobian


def _slope(analysis: "TreeSteps", t: float, z: np.ndarray) -> Any:
    analysis.clock["t"], analysis.state[:] = t, z
    if analysis.evaluate() == codes.NO_INERTIA:
        raise analysis.failure()
    slope = analysis.integration.slopes[0].copy()
    # LSODA steps on where there is no slope.
    if analysis.tree.integration.method == "lsoda" and not np.isfinite(slope).all():
        raise analysis.force_failure() or _step_failure(analysis, t)
    return slope


def _step_failure(analysis: "TreeSteps", t: float) -> AnalysisError:
    method, reason = analysis.tree.integration.method, why_no_step(analysis.tree, t)
    message = f"at t = {t:.6g} s {method} finds no step that meets the tolerance; {reason}"
    return AnalysisError(Fault("error", message, id="SOLVE-030"), float(t))


IMPLICIT_CALL_WORK = 1_000_000  # places of the matrix; an interrupt waits for about a second of them


def implicit_rows(analysis: "TreeSteps") -> Iterator[TreeRows]:
    """Report rows of a TreeSteps up to the next breakpoint, whose functions are set.

    Raises AnalysisError as the other methods.
    """
    clock, n = analysis.clock[0], len(analysis.coordinates)
    arrays = analysis.arrays
    rows = len(arrays.answers) + 3 * len(arrays.contacts.touches)
    integration = sdirk4.implicit_work(analysis.clock, analysis.state, n, arrays.closures, rows)
    integration.before[:] = analysis.integration.slopes[0]
    budget = 1 + IMPLICIT_CALL_WORK // (1 + n * n)

    def integrate_rows(report: Report, budget: int) -> Any:
        return sdirk4.integrate_rows(
            analysis.arrays, analysis.work, analysis.coordinates, integration, report, budget
        )

    start = clock["step_start"].copy(), clock["step_tried"].copy()
    for block in analysis.rows_of_steps(integrate_rows, budget):
        # A stopped run continues from the last breakpoint: the matrix has no other memory.
        last = clock["step_start"].copy(), clock["step_tried"].copy()
        clock["step_start"], clock["step_tried"] = start
        yield block
        clock["step_start"], clock["step_tried"] = last
