"""Dynamics of a tree: by Kane's equations, or in absolute coordinates."""

from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any

from ...errors import Fault
from ...model.integrators import IMPLICIT_TREE_METHODS
from ...model.tree import Tree
from ...model.unit_checks import unit_warnings
from ...results.hdf5.tree import tree_layout, tree_values
from ...solvers.compilation import announce_compiling
from ...solvers.tree.points import point_motion, point_names
from ..energy_drift import EnergyDrift, StepCount
from ..error_estimate import FINER, finer, why_no_estimate
from ..outcome import ABSOLUTE, Run
from ..stiffening_notes import SoftBody, SpinCount
from . import Solution
from .at_rest import begin_at_rest, refuse_rest

if TYPE_CHECKING:
    from collections.abc import Iterator

    import numpy as np

    from ...solvers.tree.analysis import TreeAnalysis
    from ...solvers.tree.rows import TreeRows

STIFFENING = "switch it on for a straight beam (block GSTF)"


def solution(tree: Tree, run: Run) -> Solution:
    """Return the motion of `tree` by the formulation of the options, ready to be solved."""
    absolute = run.options.formulation == ABSOLUTE
    # The choice of an integrator is one of Kane's equations.
    stepped = "dop853", *(IMPLICIT_TREE_METHODS if tree.elements else ())
    if absolute and tree.integration.method not in stepped:
        message = f"absolute coordinates are stepped by DOP853: {tree.integration.method} is not used"
        run.warn([Fault("warning", message, id="RUN-010")])
    analysis = (absolute_analysis if absolute else kane_analysis)(tree, run)
    given = tree.integration
    formulation = {"formulation": ABSOLUTE} if absolute else {}
    return Solution(
        analysis,
        tree.time.rows,
        lambda: tree_layout(tree, point_names(tree), reactions=not absolute),
        partial(values_of, tree),
        TreeCount(analysis.clock, tree, absolute),
        partial(unit_warnings, tree, run.outcome.system),
        analysis.warnings,
        finer=partial(_finer_blocks, tree),
        identity={"method": given.method, "rtol": given.rtol, "atol": given.atol, **formulation},
    )


def values_of(tree: Tree, rows: "TreeRows") -> Mapping[str, "np.ndarray"]:
    """Return report rows by the paths of their datasets."""
    return tree_values(tree, rows, point_motion(tree, rows))


def kane_analysis(tree: Tree, run: Run) -> "TreeAnalysis":
    """Return the analysis by Kane's equations."""
    from ...solvers.tree.analysis import TreeAnalysis

    announce_compiling(run.listener, "integrators.tree_dop853.integrate_rows")
    analysis = TreeAnalysis(tree)
    again, speeds = partial(TreeAnalysis, tree), len(tree.coordinates)
    begin_at_rest(analysis, again, run, speeds, tree.time, tree.elements)
    return analysis


def absolute_analysis(tree: Tree, run: Run) -> Any:
    """Return the analysis in absolute coordinates; raises ModelError for what is not carried over."""
    from ...solvers.constrained.tree import AbsoluteTree

    refuse_rest(run, tree.elements)
    announce_compiling(run.listener, "integrators.constrained_dop853.integrate_rows")
    return AbsoluteTree(tree)


def _finer_blocks(tree: Tree, run: Run) -> Any:
    """Blocks of values of a second run at a tighter tolerance."""
    given = tree.integration
    run.outcome.faults += why_no_estimate(given.rtol)
    # An absolute tolerance has no round-off to heed.
    second = replace(tree, integration=replace(given, rtol=finer(given.rtol), atol=FINER * given.atol))
    return (values_of(second, rows) for rows in kane_analysis(second, run).rows())


def _soft_bodies(tree: Tree) -> "Iterator[SoftBody]":
    for k, body in enumerate(tree.bodies):
        elastic = body.elastic
        if elastic is not None and elastic.stiffened_from is None and elastic.coordinates:
            yield SoftBody(k, body.name, elastic.lowest, body.place)


class TreeCount(StepCount):
    """Evaluations, and how far the energy drifts; that of a one-way tree is not constant."""

    def __init__(self, clock: "np.ndarray", tree: Tree, absolute: bool):
        spin = SpinCount(_soft_bodies(tree), STIFFENING)
        super().__init__(clock, None if tree.one_way else EnergyDrift(), spin)
        self.absolute = absolute

    def __str__(self) -> str:
        assert self.clock is not None, "a tree is integrated"
        clock, lead = self.clock[0], "absolute coordinates: " * self.absolute
        counts = f"{lead}{clock['evaluations']} evaluations, {clock['rejections']} rejected steps"
        return f"{counts}; {self.drift}" if self.drift else counts
