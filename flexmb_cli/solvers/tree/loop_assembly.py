"""Initial coordinates and speeds of a tree brought onto its closures, by its poses alone.

As decks mean it, the first rotation and the elastic coordinates stay; when the loops do not close so, only
what is prescribed does.  A gap and its rate are (p_a - p_b) · d and d · (v_a - v_b - w_b × (p_a - p_b)), d a
closed direction of body b; the rates at single unit speeds are the columns of the Jacobian.
"""

from dataclasses import replace
from typing import Any

import numpy as np

from ...errors import Fault
from ...model.equations import DEPENDENT
from ...model.joint_elements import Coupling
from ...model.tree import ASSEMBLED_GAP, ELASTIC, INERTIAL, ROTATION, TRANSLATION, Closure, Tree
from ...model.tree_as_mechanism.frames import Frames, shape_of
from ...model.tree_as_mechanism.poses import STILL, Pose, elastic_start, first_poses, repeated_in_planar_tree
from ...model.vectors import cross
from ..assembly import DAMPINGS, OTHER_STARTS
from ..levenberg_marquardt import least_squares

MOST_STEPS = 40
MOST_LEFT = 0.9  # of a gap by a step behind a search: more is left where a loop does not close
LONGEST_MOVE = 0.5  # step of a coordinate, rad or m
TREE_ASIDE = 0.5  # of the size, and rad: the largest distance of other starts


def loop_size(tree: Tree) -> float:
    """Return the largest coordinate of the points that the closures join, m."""
    return max(abs(x) for c in tree.closures for x in (*c.a_point, *c.b_point)) or 1.0


def nearest_closed(tree: Tree, frames: Frames, free: np.ndarray) -> tuple[Tree, np.ndarray]:
    """Return the tree closed nearest to its coordinates by changes of the `free` ones, and its gaps, m.

    By damped least squares from the coordinates and from others near them; the one with the least gaps where
    none closes.
    """
    slopes = abs(_jacobian(tree, frames))
    slides = np.array([c.motion == TRANSLATION for c in tree.coordinates])
    size = float(slopes[:, ~slides].max(initial=0.0)) or 1.0
    units = np.where(slides, size, 1.0) * free
    random = np.random.default_rng(1992)
    turned = units * np.array([c.motion != ELASTIC for c in tree.coordinates])
    asides = [
        _moved(tree, random.uniform(-TREE_ASIDE, TREE_ASIDE, units.size) * turned)
        for _ in range(OTHER_STARTS)
    ]
    starts = [(tree, damping) for damping in DAMPINGS] + [(aside, DAMPINGS[0]) for aside in asides]
    found = [
        _closed(_searched(start, frames, units, size, d), frames, free, MOST_LEFT) for start, d in starts
    ]
    closed = [one for one in found if _is_closed(one[1])]
    if not closed:
        return min(found, key=lambda one: float(np.max(np.abs(one[1]))))
    poses = first_poses(tree, frames)
    return min(closed, key=lambda one: _distance(poses, first_poses(one[0], frames), size))


def _is_closed(gaps: np.ndarray) -> bool:
    return bool(np.max(np.abs(gaps)) <= ASSEMBLED_GAP)


def _distance(before: list[Pose], after: list[Pose], size: float) -> float:
    """Return the sum of translations, in the size, and of rotation angles, rad, of all bodies."""
    total = 0.0
    for a, b in zip(before, after, strict=True):
        cosine = 0.5 * (np.sum(a.A * b.A) - 1.0)
        total += float(np.linalg.norm(b.r - a.r)) / size + float(np.arccos(np.clip(cosine, -1.0, 1.0)))
    return total


def _searched(tree: Tree, frames: Frames, units: np.ndarray, size: float, damping: float) -> Tree:
    """Return the tree with the least gaps that a search finds by changes of coordinates in `units` (NS,)."""

    def at(x: np.ndarray) -> Any:
        attitudes = x[len(units) :].reshape(-1, 4)
        hinges = [replace(h, attitude=tuple(p)) for h, p in zip(tree.hinges, attitudes, strict=True)]
        return replace(tree, q=x[: len(units)], hinges=tuple(hinges))

    def packed(tree: Tree) -> np.ndarray:
        return np.concatenate([tree.q, *(hinge.attitude for hinge in tree.hinges)])

    found = least_squares(
        lambda x: _gaps_and_rates(at(x), frames)[0] / size,
        lambda x: _jacobian(at(x), frames) * units / size,
        packed(tree),
        lambda x, step: packed(_moved(at(x), units * step)),
        damping,
    )[0]
    made: Tree = at(found)
    return made


def _closed(tree: Tree, frames: Frames, free: np.ndarray, most_left: float = np.inf) -> tuple[Any, Any]:
    """Newton's steps with the free coordinates as long as they help; the tree and its gaps.

    `most_left`: part of the gaps that a step may leave.
    """
    gaps, _ = _gaps_and_rates(tree, frames)
    for _ in range(MOST_STEPS):
        step = np.zeros(len(free))
        step[free] = np.linalg.lstsq(_jacobian(tree, frames)[:, free], -gaps, rcond=DEPENDENT)[0]
        step *= min(1.0, LONGEST_MOVE / max(np.max(np.abs(step)), 1e-300))
        trial = _moved(tree, step)
        left, _ = _gaps_and_rates(trial, frames)
        before, after = (float(np.max(np.abs(x))) for x in (gaps, left))
        if (before <= ASSEMBLED_GAP and after >= 0.5 * before) or after > most_left * before:
            break
        tree, gaps = trial, left
    return tree, gaps


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
    return (float(c * e0 - s @ e), *(c * e + e0 * s + cross(s, e)))


def _gaps_and_rates(tree: Tree, frames: Frames) -> tuple[Any, Any]:
    """Gaps of the closed directions, m, and their rates, m/s."""
    poses, gaps, rates = first_poses(tree, frames), [], []
    for closure in tree.closures:
        a = _point(tree, poses, closure.a, closure.a_point, closure.a_node)
        b = _point(tree, poses, closure.b, closure.b_point, closure.b_node)
        gap = a.r - b.r
        rate = a.v - b.v - cross(b.w, gap)
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
    return Pose(on.r + r, on.A, on.v + cross(on.w, r) + on.A @ slide, on.w)


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
    found = [row for row, again in zip(closed_rows(tree), repeated, strict=True) if again]
    shown = ", ".join(name for name, _ in found[:SHOWN]) + (" and others" if count > SHOWN else "")
    coupled = bool(tree.elements.couplings)
    message = (
        f"{count} of {repeated.size} closed directions{' and couplings' * coupled} "
        f"repeat{'s' * (count == 1)} others: {shown}; the motion is unique, forces along them are taken as "
        f"0; leave {'them' if coupled else 'their flags'} out"
    )
    return Fault("warning", message, found[0][1].place, found[0][1].name, id="SOLVE-036")
