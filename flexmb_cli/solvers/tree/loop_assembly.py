"""States of a tree near which its loops close, found by gaps and their rates alone.

A gap and its rate are (p_a - p_b) · d and d · (v_a - v_b - w_b × (p_a - p_b)), d a closed direction of body
b; the rates at single unit speeds are the columns of the Jacobian.
"""

from typing import Any

import numpy as np

from ...errors import Fault
from ...kernels.tree.loads import set_prescribed
from ...kernels.tree.motion import normalise_attitudes, parts, turn_attitudes
from ...kernels.tree.projection import evaluate_gaps
from ...model.arrays.tree import TreeArrays, body_frames
from ...model.joint_elements import Coupling
from ...model.joints import DEPENDENT
from ...model.tree import ASSEMBLED_GAP, ELASTIC, TRANSLATION, Closure, Tree
from ...model.tree_as_mechanism.poses import repeated_in_planar_tree
from ..assembly import DAMPINGS, OTHER_STARTS, least_squares
from .state import TreeState

MOST_STEPS = 40
MOST_LEFT = 0.9  # of a gap by a step after a search: more is left where a loop does not close
LONGEST_MOVE = 0.5  # step of a coordinate, rad or m
TREE_ASIDE = 0.5  # of the size, and rad: the largest distance of other starts


def loop_size(tree: Tree) -> float:
    """Return the largest coordinate of the points that the closures join, m."""
    return max(abs(x) for c in tree.closures for x in (*c.a_point, *c.b_point)) or 1.0


def displaced(arrays: TreeArrays, z: np.ndarray, d: np.ndarray) -> np.ndarray:
    """Return the state z (n,) with its coordinates displaced by d (NS,); three rotations turn the hinge."""
    z = z.copy()
    _, q, attitudes = parts(arrays, z)
    q += d
    rates = np.zeros_like(attitudes)
    turn_attitudes(arrays, d, attitudes, rates)
    attitudes += rates
    normalise_attitudes(arrays, z)
    return z


def prescribe(analysis: TreeState, z: np.ndarray, t: float) -> None:
    """Put the prescribed coordinates of z and their speeds to where they are at t."""
    speeds, q, _ = parts(analysis.arrays, z)
    set_prescribed(analysis.arrays, t, q, speeds, analysis.coordinates)


def measured(analysis: TreeState, z: np.ndarray) -> np.ndarray:
    """Return the CLOSURE_ROW records of a TreeState with the gaps of the state z, and their rates."""
    if analysis.arrays.closures.size:
        evaluate_gaps(analysis.arrays, analysis.work, analysis.coordinates, z)
    return analysis.arrays.closures


def gap_rates(analysis: TreeState, z: np.ndarray, speeds: np.ndarray) -> np.ndarray:
    """Return the rates (R,) of the gaps at the position of z with other speeds."""
    z = z.copy()
    z[: speeds.size] = speeds
    return measured(analysis, z)["rate"].copy()


def jacobian_of_gaps(analysis: TreeState, z: np.ndarray) -> np.ndarray:
    """Return J (R, NS) of the gaps by the coordinates that are not prescribed, 0 by the others."""
    arrays = analysis.arrays
    speeds = np.where(arrays.given, 0.0, 1.0)
    columns = [gap_rates(analysis, z, unit) for unit in np.diag(speeds)] if arrays.closures.size else []
    return np.array(columns).reshape(speeds.size, -1).T


def nearest_closed(analysis: TreeState, free: np.ndarray, start: np.ndarray) -> np.ndarray:
    """Return the state closed nearest to `start` by changes of the `free` coordinates (NS,).

    By damped least squares from it and from others near it; the one with the least gaps where none closes.
    """
    prescribe(analysis, start, analysis.tree.time.start)
    slides, elastic = (
        np.array([c.motion == motion for c in analysis.tree.coordinates]) for motion in (TRANSLATION, ELASTIC)
    )
    size = float(abs(jacobian_of_gaps(analysis, start))[:, ~slides].max(initial=0.0)) or 1.0
    units = np.where(slides, size, 1.0) * free
    random = np.random.default_rng(1992)
    asides = [
        displaced(
            analysis.arrays, start, random.uniform(-TREE_ASIDE, TREE_ASIDE, units.size) * units * ~elastic
        )
        for _ in range(OTHER_STARTS)
    ]
    starts = [(start, damping) for damping in DAMPINGS] + [(aside, DAMPINGS[0]) for aside in asides]
    positions = [_closed(analysis, _searched(analysis, z, units, size, d), free) for z, d in starts]
    closed = [z for z, gap in positions if gap <= ASSEMBLED_GAP]
    if not closed:
        return min(positions, key=lambda one: one[1])[0]
    places = _places(analysis, start)
    return min(closed, key=lambda z: _distance(places, _places(analysis, z), size))


def _places(analysis: TreeState, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Places (N, 3) and axes (N, 9) of all bodies."""
    measured(analysis, z)
    own = body_frames(analysis.arrays)
    return analysis.work["position"][own], analysis.work["axes"][own]


def _distance(before: Any, after: Any, size: float) -> float:
    """Return the sum of translations, in the size, and of rotation angles, rad, of all bodies."""
    cosines = 0.5 * (np.sum(before[1] * after[1], axis=1) - 1.0)
    moves = np.linalg.norm(after[0] - before[0], axis=1) / size
    return float(np.sum(moves) + np.sum(np.arccos(np.clip(cosines, -1.0, 1.0))))


def _searched(
    analysis: TreeState, z: np.ndarray, units: np.ndarray, size: float, damping: float
) -> np.ndarray:
    """Return the state with the least gaps that a search finds by changes of coordinates in `units` (NS,)."""
    return least_squares(
        lambda x: measured(analysis, x)["gap"] / size,
        lambda x: jacobian_of_gaps(analysis, x) * units / size,
        z,
        lambda x, step: displaced(analysis.arrays, x, units * step),
        damping,
    )[0]


def _closed(analysis: TreeState, z: np.ndarray, free: np.ndarray) -> tuple[np.ndarray, float]:
    """Newton's steps with the free coordinates as long as they help; the state and its largest gap."""
    gaps = measured(analysis, z)["gap"].copy()
    for _ in range(MOST_STEPS):
        step, J = np.zeros(len(free)), jacobian_of_gaps(analysis, z)
        step[free] = np.linalg.lstsq(J[:, free], -gaps, rcond=DEPENDENT)[0]
        step *= min(1.0, LONGEST_MOVE / max(np.max(np.abs(step)), 1e-300))
        trial = displaced(analysis.arrays, z, step)
        left = measured(analysis, trial)["gap"].copy()
        before, after = (float(np.max(np.abs(x))) for x in (gaps, left))
        if (before <= ASSEMBLED_GAP and after >= 0.5 * before) or after > MOST_LEFT * before:
            break
        z, gaps = trial, left
    return z, float(np.max(np.abs(gaps)))


SHOWN = 6


def closed_rows(tree: Tree) -> list[tuple[str, Closure | Coupling]]:
    """Return names and owners of the closed directions and couplings, in the order of their rows."""
    directions = [(closure, axis) for closure in tree.closures for axis in closure.directions]
    rows: list[tuple[str, Closure | Coupling]] = [
        (f"{closure.name} direction {axis}", closure) for closure, axis in directions
    ]
    return rows + [(item.name, item) for item in tree.elements.couplings]


def repetition(tree: Tree, repeated: np.ndarray) -> Fault | None:
    """A note where a planar tree repeats what it must, else a warning; None where nothing is repeated.

    `repeated` (R,): which of the closed directions and couplings, in their order, depend on others.
    """
    count = int(np.sum(repeated))
    if not count:
        return None
    if count == repeated_in_planar_tree(tree):
        message = (
            f"planar tree: {count} of {repeated.size} closed directions repeat{'s' * (count == 1)} others, "
            "the one across the plane of each loop; the motion is unique, forces along it are taken as 0"
        )
        return Fault("note", message, id="SOLVE-035")
    repeated_rows = [row for row, again in zip(closed_rows(tree), repeated, strict=True) if again]
    shown = ", ".join(name for name, _ in repeated_rows[:SHOWN]) + (" and others" if count > SHOWN else "")
    coupled = bool(tree.elements.couplings)
    message = (
        f"{count} of {repeated.size} closed directions{' and couplings' * coupled} "
        f"repeat{'s' * (count == 1)} others: {shown}; the motion is unique, forces along them are taken as "
        f"0; leave {'them' if coupled else 'their flags'} out"
    )
    return Fault("warning", message, repeated_rows[0][1].place, repeated_rows[0][1].name, id="SOLVE-036")
