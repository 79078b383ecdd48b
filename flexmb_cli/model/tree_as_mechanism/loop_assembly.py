"""Initial coordinates and speeds of a tree brought onto its closures, by its poses alone.

As decks mean it, the first rotation and the elastic coordinates stay; when the loops do not close so, only
what is prescribed does.  A gap and its rate are (p_a - p_b) · d and d · (v_a - v_b - w_b × (p_a - p_b)), d a
closed direction of body b; the rates at single unit speeds are the columns of the Jacobian.
"""

from typing import Any

import numpy as np

from ...errors import AnalysisError, Fault
from ...quick_dataclass import replace
from ..equations import DEPENDENT
from ..tree import ASSEMBLED_GAP, ELASTIC, INERTIAL, ROTATION, Tree
from .frames import Frames, shape_of
from .poses import STILL, Pose, elastic_start, first_poses

MOST_STEPS = 40
LONGEST_MOVE = 0.5  # step of a coordinate, rad or m


def closed_tree(tree: Tree, frames: Frames) -> Tree:
    """The tree with initial coordinates and speeds that its closures allow; raises AnalysisError."""
    if not tree.closures:
        return tree
    given = {(p.body, p.motion, p.axis) for p in tree.prescribed}
    driven = np.array([(c.body, c.motion, c.axis) in given for c in tree.coordinates])
    elastic = np.array([c.motion == ELASTIC for c in tree.coordinates])
    first = np.zeros(len(elastic), bool)
    first[[m for m, c in enumerate(tree.coordinates) if c.motion == ROTATION][:1]] = True
    for kept in (driven | elastic | first, driven):
        found, gaps = _closed(tree, frames, ~kept)
        if np.max(np.abs(gaps)) <= ASSEMBLED_GAP:
            made: Tree = _with_closed_speeds(found, frames, ~kept)
            return made
    raise _failure(tree, gaps)


def _closed(tree: Tree, frames: Frames, free: np.ndarray) -> tuple[Any, Any]:
    """Newton's steps with the free coordinates as long as they help; the tree and its gaps."""
    gaps, _ = _gaps_and_rates(tree, frames)
    for _ in range(MOST_STEPS):
        step = np.zeros(len(free))
        step[free] = np.linalg.lstsq(_jacobian(tree, frames)[:, free], -gaps, rcond=DEPENDENT)[0]
        step *= min(1.0, LONGEST_MOVE / max(np.max(np.abs(step)), 1e-300))
        trial = _moved(tree, step)
        left, _ = _gaps_and_rates(trial, frames)
        if np.max(np.abs(gaps)) <= ASSEMBLED_GAP and np.max(np.abs(left)) >= 0.5 * np.max(np.abs(gaps)):
            break
        tree, gaps = trial, left
    return tree, gaps


def _with_closed_speeds(tree: Tree, frames: Frames, free: np.ndarray) -> Any:
    _, rates = _gaps_and_rates(tree, frames)
    y = np.array(tree.y, float)
    y[free] += np.linalg.lstsq(_jacobian(tree, frames)[:, free], -rates, rcond=DEPENDENT)[0]
    return replace(tree, y=y)


def _jacobian(tree: Tree, frames: Frames) -> Any:
    """Rates of the gaps (rows, NS) per unit of each speed."""
    columns = [_gaps_and_rates(replace(tree, y=unit), frames)[1] for unit in np.eye(len(tree.q))]
    return np.array(columns).T


def _moved(tree: Tree, step: np.ndarray) -> Any:
    """The tree with its coordinates moved; hinges with three free rotations turn by small rotations."""
    hinges = list(tree.hinges)
    for k, hinge in enumerate(hinges):
        if len(hinge.rotations) == 3:
            own = [m for m, c in enumerate(tree.coordinates) if (c.body, c.motion) == (k, ROTATION)]
            hinges[k] = replace(hinge, attitude=_turned(hinge.attitude, step[own]))
    return replace(tree, q=np.asarray(tree.q, float) + step, hinges=tuple(hinges))


def _turned(attitude: Any, turn: np.ndarray) -> tuple[Any, ...]:
    """Euler parameters after a rotation vector (3,) in P_k axes."""
    angle = np.linalg.norm(turn)
    c, s = np.cos(angle / 2), 0.5 * np.sinc(angle / (2 * np.pi)) * np.asarray(turn)
    e0, e = attitude[0], np.array(attitude[1:])
    return (float(c * e0 - s @ e), *(c * e + e0 * s + np.cross(s, e)))


def _gaps_and_rates(tree: Tree, frames: Frames) -> tuple[Any, Any]:
    """Gaps of the closed directions, m, and their rates, m/s."""
    poses, gaps, rates = first_poses(tree, frames), [], []
    for closure in tree.closures:
        a = _point(tree, poses, closure.a, closure.a_point, closure.a_node)
        b = _point(tree, poses, closure.b, closure.b_point, closure.b_node)
        gap = a.r - b.r
        rate = a.v - b.v - np.cross(b.w, gap)
        directions = b.A[:, [axis - 1 for axis in closure.directions]]
        gaps.append(gap @ directions)
        rates.append(rate @ directions)
    return np.concatenate(gaps), np.concatenate(rates)


def _point(tree: Tree, poses: list[Pose], body: Any, place: Any, node: Any) -> Pose:
    """Motion of a point of a body, or of a node, with the axes of the body."""
    on, body_vector, slide = STILL if body == INERTIAL else poses[body], np.array(place, float), np.zeros(3)
    if node is not None and body != INERTIAL:
        elastic = tree.bodies[body].elastic
        eta, rate = elastic_start(tree, body)
        body_vector, slide = (
            elastic.positions[node] + shape_of(elastic, node) @ eta,
            shape_of(elastic, node) @ rate,
        )
    r = on.A @ body_vector
    return Pose(on.r + r, on.A, on.v + np.cross(on.w, r) + on.A @ slide, on.w)


def _failure(tree: Tree, gaps: np.ndarray) -> AnalysisError:
    worst = int(np.argmax(np.abs(gaps)))
    closure = [closure for closure in tree.closures for _ in closure.directions][worst]
    message = (
        f"the loops cannot be closed at the start: a gap of {gaps[worst]:.3g} m is left; bring Y(L) nearer "
        "to a closed position"
    )
    return AnalysisError(
        Fault("error", message, closure.place, closure.name, id="MODEL-009"), tree.time.start
    )
