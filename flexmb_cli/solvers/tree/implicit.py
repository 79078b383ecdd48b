"""Report rows of a tree by the compiled implicit integrator, for stiff elastic modes."""

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from ...kernels.integrators import sdirk4
from ...kernels.tree.report import Report
from ...model.arrays.tree_elements import BETWEEN
from .rows import TreeRows

if TYPE_CHECKING:
    from .analysis import TreeAnalysis


IMPLICIT_CALL_WORK = 1_000_000  # places of the matrix; an interrupt waits for about a second of them


def implicit_rows(analysis: "TreeAnalysis") -> Iterator[TreeRows]:
    """Report rows of a TreeAnalysis up to the next breakpoint, whose functions are set.

    Raises AnalysisError as the other methods.
    """
    clock, n = analysis.clock[0], len(analysis.coordinates)
    arrays = analysis.arrays
    contacts = int(np.count_nonzero(arrays.elements["measure"] == BETWEEN))
    integration = sdirk4.implicit_work(
        analysis.clock, analysis.state, n, arrays.closures, len(arrays.answers) + 2 * contacts
    )
    integration.before[:] = analysis.integration.slopes[0]
    budget = 1 + IMPLICIT_CALL_WORK // (1 + n * n)

    def integrate_rows(report: Report) -> Any:
        return sdirk4.integrate_rows(
            analysis.arrays, analysis.work, analysis.coordinates, integration, report, budget
        )

    start = clock["step_start"].copy(), clock["step_tried"].copy()
    for block in analysis.rows_of_steps(integrate_rows):
        # A stopped run continues from the last breakpoint: the matrix has no other memory.
        last = clock["step_start"].copy(), clock["step_tried"].copy()
        clock["step_start"], clock["step_tried"] = start
        yield block
        clock["step_start"], clock["step_tried"] = last
