"""Report rows of a tree by the compiled implicit integration, for stiff elastic modes."""

from collections.abc import Iterator

import numpy as np

from ...kernels.integrators import sdirk4
from .rows import TreeRows

CALL_WORK = 1_000_000  # places of the matrix; an interrupt waits for about a second of them


def implicit_rows(analysis, stop: float) -> Iterator[TreeRows]:
    """Report rows of a TreeAnalysis up to the breakpoint `stop`, whose functions are set.

    Raises AnalysisError as the other methods.
    """
    clock, z = analysis.clock[0], analysis.integration.z
    n = len(analysis.coordinates)
    work = sdirk4.implicit_work(z.size, n, analysis.arrays.closures)
    work.before[:] = analysis.integration.slopes[0]
    if analysis.due_times(clock["t"]):
        yield analysis.observe(lambda t: z.copy(), analysis.due_times(clock["t"]))
    budget = 1 + CALL_WORK // (1 + n * n)
    start, length = clock["step_start"].copy(), clock["step_length"].copy()
    while clock["t"] < stop:
        answer = sdirk4.integrate_implicitly(
            float(_next_time(analysis)),
            budget,
            analysis.arrays,
            analysis.work,
            analysis.coordinates,
            analysis.clock,
            z,
            work,
        )
        if answer in (sdirk4.VANISHED, sdirk4.FAULTED):
            raise analysis.failure()
        times = analysis.due_times(clock["t"])
        if times:
            block = analysis.observe(_interpolant(clock, z, work), times)
            # A stopped run goes on from the last breakpoint: the matrix has no other memory.
            last = clock["step_start"].copy(), clock["step_length"].copy()
            clock["step_start"], clock["step_length"] = start, length
            yield block
            clock["step_start"], clock["step_length"] = last


def _next_time(analysis):
    grid = analysis.tree.time
    return grid.time(analysis.row) if analysis.row < grid.rows else np.inf


def _interpolant(clock, z, work):
    start, h, end = float(clock["step_start"]), float(clock["step_length"]), z.copy()

    def state_at(t):
        out = np.empty(z.size)
        sdirk4.between((t - start) / h, h, end, work, out)
        return out

    return state_at
