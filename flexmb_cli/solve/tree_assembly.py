"""Closing the loops of a tree at the start, and saying which one cannot be closed."""

import numpy as np

from ..errors import AnalysisError, Fault, ModelError
from ..kernels.tree_projection import assemble
from ..model.tree import ROTATION, Tree

CLOSED = 1e-10  # m


def assemble_tree(tree: Tree, system, state: np.ndarray) -> None:
    """Bring `state` onto the closures of the tree.

    The first rotation and the elastic coordinates are kept; when the loops cannot be closed so, only
    the prescribed coordinates are.  Raises ModelError for closures in a one-way model, AnalysisError
    when a gap remains.
    """
    if not tree.closures:
        return
    if tree.one_way:
        raise ModelError([_one_way_fault(tree)])
    arrays, work, coordinates = system
    for kept in (_kept(tree, arrays), arrays.given):
        trial = state.copy()
        gap = assemble(arrays, work, coordinates, tree.time.start, trial, kept)
        if gap <= CLOSED:
            state[:] = trial
            return
    raise _assembly_failure(tree, arrays.closures)


def _kept(tree, arrays):
    kept = arrays.given | arrays.elastic
    first = next((m for m, c in enumerate(tree.coordinates) if c.motion == ROTATION), None)
    if first is not None:
        kept[first] = True
    return kept


def _one_way_fault(tree):
    closure = tree.closures[0]
    message = (
        "closed loops need the coupled equations: closure forces act on rigid and elastic motion "
        "alike; drop the one-way assumption (UNCO)"
    )
    return Fault("error", message, closure.place, closure.name)


def closure_of_row(tree: Tree, row: int):
    """The closure to which a row of the closure equations belongs."""
    return [closure for closure in tree.closures for _ in closure.directions][row]


def _assembly_failure(tree, rows):
    worst = int(np.nanargmax(np.abs(rows["gap"]))) if np.any(np.isfinite(rows["gap"])) else 0
    closure, gap = closure_of_row(tree, worst), float(abs(rows["gap"][worst]))
    t = tree.time.start
    message = (
        f"at t = {t:.6g} s the loop cannot be closed: the two points stay {gap:.3g} m apart along "
        f"axis {rows['axis'][worst] + 1}; check lengths, the two points and the initial coordinates"
    )
    return AnalysisError(Fault("error", message, closure.place, closure.name), t, {"gap": gap})
