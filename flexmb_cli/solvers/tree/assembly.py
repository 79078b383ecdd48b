"""Closing the loops of a tree at the start, and saying which one cannot be closed."""

import numpy as np

from ...errors import AnalysisError, Fault, ModelError
from ...kernels.integrators import clock as codes
from ...kernels.integrators import tree_dop853
from ...kernels.tree.loop_closures import IMMOBILE
from ...model.arrays.tree import TreeArrays
from ...model.arrays.tree_elements import REPEATED
from ...model.tree import ASSEMBLED_GAP, ROTATION, Closure, Tree
from ..assembly import LOOSEST, NEAR, TO_GAP
from .loop_assembly import loop_size, measured, nearest_closed
from .state import TreeState

MOST_ITERATIONS = 40
LIMIT_PASSES = 2  # corrections of the limit of repeated equations by the gap that it leaves


def assemble_tree(analysis: TreeState) -> None:
    """Bring the state of a TreeState onto the closures of its tree, and attach its elements.

    The first rotation and the elastic coordinates are kept; when the loops cannot be closed so, only
    the prescribed coordinates are, and those of lines START.  Raises ModelError for closures in a one-way
    model, AnalysisError when a gap remains.
    """
    if analysis.tree.closures:
        arrays = analysis.arrays
        # Couplings keep what they begin with.
        rows = int(np.sum(arrays.closures["coupling"] < 0))
        analysis.arrays = arrays._replace(
            closures=arrays.closures[:rows], closure_matrix=np.zeros((rows, rows))
        )
        _find_parameters(analysis)
        _close_loops(analysis)
        analysis.arrays = arrays
    if analysis.tree.elements:
        from .attached_elements import attach_elements

        attach_elements(analysis)


def _find_parameters(analysis: TreeState) -> None:
    """Begin at the place of each curve that is nearest to its point at the start."""
    tree, frames = analysis.tree, analysis.work
    rows = measured(analysis, analysis.state)
    for row, closure in zip(rows, (c for c in tree.closures for _ in c.directions), strict=True):
        if closure.curve:
            b = frames[row["frame_b"]]
            apart = b["axes"].reshape(3, 3).T @ (row["place"] - b["position"])
            row["parameter"] = closure.curve.nearest(apart - row["point_b"])


def _close_loops(analysis: TreeState) -> None:
    tree, arrays = analysis.tree, analysis.arrays
    if tree.one_way:
        raise ModelError([_one_way_fault(tree)])
    start = analysis.state.copy()
    own = slice(len(tree.coordinates), 2 * len(tree.coordinates))
    for fixed in (_kept(tree, arrays), _given(tree, arrays)):
        analysis.state[:] = start
        gap = _close(analysis, fixed)
        if not gap <= ASSEMBLED_GAP or np.max(np.abs(analysis.state - start)[own]) > NEAR:
            gap = _close_nearest(analysis, fixed, start)
        if gap <= ASSEMBLED_GAP:
            return
    failure = _assembly_failure(tree, arrays.closures)
    analysis.state[:] = start
    analysis.loop_note = _close_nearly(analysis, failure)
    analysis.warnings.append(analysis.loop_note)


def _close_nearly(analysis: TreeState, failure: AnalysisError) -> Fault:
    """Close overconstrained loops as well as they can be; return the note on what is left.

    Raises `failure` where other loops stay open, AnalysisError where more is left than the tree allows.
    """
    tree, arrays, t = analysis.tree, analysis.arrays, analysis.tree.time.start
    rows = arrays.closures
    size = loop_size(tree)
    start, allowed = analysis.state.copy(), tree.loop_tolerance * size
    for tolerance in (tree.loop_tolerance, LOOSEST):
        for fixed in (_kept(tree, arrays), _given(tree, arrays)):
            analysis.state[:] = start
            gap = tolerance * size
            for _ in range(LIMIT_PASSES):
                # A wider limit than the gap needs would leave out equations that move bodies.
                rows["repeated"] = max(REPEATED, (TO_GAP * min(gap / size, tolerance)) ** 2)
                gap = _close(analysis, fixed)
            is_open = np.abs(rows["gap"]) > ASSEMBLED_GAP
            if gap > LOOSEST * size or pivot_shares(arrays)[is_open].any():
                continue
            closure = closure_of_row(tree, int(np.argmax(np.abs(rows["gap"]))))
            words = f"a loop is overconstrained and closes only to {gap:.1e} m"
            if gap <= allowed:
                message = f"{words}, within {allowed:.1e} m; equations that repeat others are left out"
                return Fault("note", message, closure.place, closure.name, id="SOLVE-082")
            message = (
                f"at t = {t:.6g} s the loop cannot be closed: {words}; the digits, or --loop-tolerance, "
                f"allow {allowed:.1e} m: change the two points, or allow more "
                f"(--loop-tolerance {2.0 * gap / size:.0e})"
            )
            fault = Fault("error", message, closure.place, closure.name, id="SOLVE-083")
            raise AnalysisError(fault, t, {"gap": gap})
    raise failure


def _close_nearest(analysis: TreeState, held: np.ndarray, start: np.ndarray) -> float:
    """Close the loops nearest to the state `start`, as `_close` does."""
    analysis.state[:] = nearest_closed(analysis, ~held, start.copy())
    return _close(analysis, held)


def _close(analysis: TreeState, held: np.ndarray) -> float:
    """Close the loops while the coordinates marked in `held` (NS,) stay; return the largest gap left, m."""
    analysis.coordinates["held"] = held
    gap = np.inf
    for _ in range(MOST_ITERATIONS):
        before = gap
        if analysis.call(tree_dop853.CLOSE) != codes.READY:
            break
        gap = analysis.clock["gap"][0]
        if gap <= ASSEMBLED_GAP and not gap < before / 2:
            break
    analysis.coordinates["held"] = analysis.arrays.given
    return float(gap)


def _given(tree: Tree, arrays: TreeArrays) -> np.ndarray:
    """Coordinates (NS,) that are prescribed, or given at the start by lines START."""
    given: np.ndarray = arrays.given.copy()
    given[list(tree.started)] = True
    return given


def _kept(tree: Tree, arrays: TreeArrays) -> np.ndarray:
    fixed = _given(tree, arrays) | arrays.elastic
    first = next((m for m, c in enumerate(tree.coordinates) if c.motion == ROTATION), None)
    if first is not None:
        fixed[first] = True
    return fixed


def _one_way_fault(tree: Tree) -> Fault:
    closure = tree.closures[0]
    message = (
        "closed loops need the coupled equations: if bodies of a loop deflect, their rigid motion depends "
        "on the elastic motion, which UNCO excludes; drop UNCO (or LOOP)"
    )
    return Fault("error", message, closure.place, closure.name, id="SOLVE-027")


def closure_of_row(tree: Tree, row: int) -> Closure:
    """The closure to which a row of the closure equations belongs."""
    return [closure for closure in tree.closures for _ in closure.directions][row]


def _assembly_failure(tree: Tree, rows: np.ndarray) -> AnalysisError:
    worst = int(np.nanargmax(np.abs(rows["gap"]))) if np.any(np.isfinite(rows["gap"])) else 0
    closure, gap = closure_of_row(tree, worst), float(abs(rows["gap"][worst]))
    t = tree.time.start
    message = (
        f"at t = {t:.6g} s the loop cannot be closed: the two points stay {gap:.3g} m apart along "
        f"axis {rows['axis'][worst] + 1}; check lengths, the two points and the initial coordinates"
    )
    return AnalysisError(
        Fault("error", message, closure.place, closure.name, id="SOLVE-028"), t, {"gap": gap}
    )


def pivot_shares(arrays: TreeArrays) -> np.ndarray:
    """Pivots of J b⁻¹ Jᵀ as shares of its largest diagonal element (R,); 0 where a row is left out."""
    largest = np.max(arrays.closures["own"], initial=0.0)
    pivots = np.diag(arrays.closure_matrix)
    return np.divide(pivots, largest, out=np.zeros(pivots.size), where=largest > 0.0)


def stray(tree: Tree, shares: np.ndarray, repeated: np.ndarray, t: float, worst: int) -> Fault:
    """Return the fault of steps from which the projection onto the loops departs, however short they are.

    `shares` (R,) are those of `pivot_shares`, `repeated` (R,) marks the rows that depend on others
    wherever the tree stands, `worst` is the place in the state of what moves most.
    """
    row, n = int(np.argmin(np.where(repeated, np.inf, shares))), len(tree.coordinates)
    closure, share = closure_of_row(tree, row), shares[row]
    condition = f"{1.0 / share:.0e}" if share > 0.0 else f"above {1.0 / IMMOBILE:.0e}"
    motion = f"; '{tree.coordinates[worst % n].name}' moves most" if worst < 2 * n else ""
    message = (
        f"at t = {t:.6g} s the loop comes to a singular position (condition {condition}): another motion "
        f"begins there, and closing the loop leads to it however short the step is{motion}; end the run "
        "before it, or change the lengths"
    )
    return Fault("error", message, closure.place, closure.name, id="SOLVE-029")
