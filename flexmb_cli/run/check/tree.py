"""Diagnose a tree without integrating it: counts, coordinates, inertia, closures and energies at the start.

Small trees are evaluated by the same kernels left uncompiled, so that `check` answers at once.
"""

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ...errors import AnalysisError
from ...model.arrays.tree import TreeArrays
from ...model.mechanism import TimeGrid
from ...model.tree import ELASTIC, Tree
from ...model.unit_checks import unit_warnings
from ...solvers.tree.loop_assembly import closed_rows
from ..outcome import Run
from .check import CheckReport, TreeFindings, refuse_jacobian

if TYPE_CHECKING:
    from ...solvers.tree.analysis import TreeAnalysis


MOST_COORDINATES_INTERPRETED = 400  # coordinates


def check(report: CheckReport, tree: Tree, run: Run, jacobian: str | None) -> None:
    """Fill the report.

    Raises FlexmbError: a loop that cannot be closed, a mass matrix that is not positive definite.
    """
    refuse_jacobian(jacobian, "a tree has relative coordinates and no constraint Jacobian")
    run.outcome.faults += unit_warnings(tree, run.outcome.system)
    report.counts = _counts(tree)
    elastic = [_spectrum(body) for body in tree.bodies if body.elastic is not None]
    report.tree = findings = TreeFindings(_start(tree, tree.q, tree.y), None, [], [], {}, elastic)
    from ...solvers.compilation import interpreting

    with interpreting(len(tree.coordinates) <= MOST_COORDINATES_INTERPRETED):
        _evaluate_start(report, findings, tree)


def _counts(tree: Tree) -> dict[str, int]:
    motions = [c.motion for c in tree.coordinates]
    return {
        "bodies": len(tree.bodies),
        "flexible": sum(body.elastic is not None for body in tree.bodies),
        "rotations": motions.count("rotation"),
        "translations": motions.count("translation"),
        "elastic": motions.count(ELASTIC),
        "coordinates": len(motions),
        "prescribed": len(tree.prescribed) + len(tree.elements.drivers),
        "closures": len(tree.closures),
        "closed_directions": sum(len(closure.directions) for closure in tree.closures),
        "report_times": tree.time.rows,
        "one_way": tree.one_way,
    }


def _evaluate_start(report: CheckReport, findings: TreeFindings, tree: Tree) -> None:
    from ...solvers.tree.analysis import TreeAnalysis
    from ...solvers.tree.steps import GO_ON

    start = tree.time.start
    analysis = TreeAnalysis(replace(tree, time=TimeGrid(start, start, tree.time.step)))
    analysis.call(GO_ON)
    given = _gaps(tree, analysis.arrays.closures)
    try:
        row = next(analysis.rows())
    except AnalysisError:
        findings.gaps = [(name, gap, gap) for name, gap in given]
        raise
    if tree.elements.couplings:
        report.outcome.faults += analysis.warnings
    assembled = _gaps(tree, analysis.arrays.closures)
    gaps = [(*before, after[1]) for before, after in zip(given, assembled, strict=True)]
    redundant = _redundant(tree, analysis.arrays)
    findings.coordinates = _start(tree, row.q[0], row.y[0])
    findings.lightest = _lightest(tree, analysis)
    findings.gaps, findings.redundant = gaps, redundant
    findings.energies = {name: float(getattr(row, name)[0]) for name in ("kinetic", "potential", "strain")}
    closed = analysis.arrays.closures.size - len(redundant)
    report.counts["degrees_of_freedom"] = len(tree.coordinates) - report.counts["prescribed"] - closed


def _start(tree: Tree, q: np.ndarray, y: np.ndarray) -> list[Any]:
    return [
        (c.name, "rad" if c.motion == "rotation" else "m", float(a), float(b))
        for c, a, b in zip(tree.coordinates, q, y, strict=True)
    ]


def _gaps(tree: Tree, rows: np.ndarray) -> list[tuple[str, float]]:
    """Largest gap of each closure, m."""
    gaps = iter(np.abs(rows["gap"]))
    return [(closure.name, float(max(next(gaps) for _ in closure.directions))) for closure in tree.closures]


def _redundant(tree: Tree, arrays: TreeArrays) -> list[str]:
    """Directions and couplings whose pivots the elimination found to be zero."""
    pivots = np.diag(arrays.closure_matrix)
    names = [name for name, _ in closed_rows(tree)]
    return [name for name, pivot in zip(names, pivots, strict=True) if pivot == 0.0]


def _lightest(tree: Tree, analysis: "TreeAnalysis") -> tuple[str, float] | None:
    """Coordinate with the least inertia left, all that hangs on it being free, as a share of its body's."""
    pivots = analysis.coordinates["pivot"]
    shares = np.where(pivots > 0, pivots / analysis.arrays.inertia_scale, np.inf)
    least = int(np.argmin(shares))
    return (tree.coordinates[least].name, float(shares[least])) if np.isfinite(shares[least]) else None


def _spectrum(body: Any) -> tuple[str, int, int, float, float]:
    """Frequencies of an elastic body with its root held: what the step length must follow."""
    elastic = body.elastic
    roots = np.sqrt(np.repeat(elastic.masses, len(elastic.axes)))
    values = np.linalg.eigvalsh(elastic.stiffness / np.outer(roots, roots))
    lowest, highest = (float(np.sqrt(abs(value))) / (2 * np.pi) for value in (values[0], values[-1]))
    return body.name, len(elastic.masses), elastic.coordinates, lowest, highest
