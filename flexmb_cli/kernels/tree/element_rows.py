"""Slopes of elements for implicit methods: what coordinates feel of a unit effort, -dF/dx and -dF/dv."""

from typing import TYPE_CHECKING

import numpy as np

from .._jit import allocating, kernel
from ..constrained.dry_friction import fill_feedback
from ..laws import DAMPING, RADIUS, STIFFNESS
from ..linalg.vec3 import cross, inward, minus, plus, scaled, triple
from .composite_mass import add_generalised_forces
from .elements import ABOUT, BETWEEN, IN_COORDINATE, answer_elements
from .friction import answer_frictions
from .motion import parts

if TYPE_CHECKING:
    from ...model.arrays.tree import TreeArrays


@kernel
def set_element_rows(
    tree: "TreeArrays",
    work: np.ndarray,
    coordinates: np.ndarray,
    z: np.ndarray,
    rows: np.ndarray,
    slopes: np.ndarray,
) -> None:
    """Fill rows (E + m + 3 T, NS) and slopes (E + m + 3 T, 2) for frames placed at the state z.

    Behind elements and frictions stand three rows of each pair that may touch: normal, along and across its
    sliding; the row of a contact itself is 0.

    The slopes of friction have the feedback of its own normal force, as it was found last.
    """
    y, q, _attitudes = parts(tree, z)
    # No slope depends on a function of time.
    answer_elements(tree, work, 0.0, q, y, coordinates)
    answer_frictions(tree, y)
    rows.fill(0.0)
    slopes.fill(0.0)
    for e in range(tree.answers.shape[0]):
        k = e - tree.elements.shape[0]
        if k < 0 and tree.elements[e]["measure"] == BETWEEN:
            continue
        slopes[e, 0], slopes[e, 1] = max(tree.answers[e, STIFFNESS], 0.0), max(tree.answers[e, DAMPING], 0.0)
        if k >= 0:
            _set_friction_row(tree.frictions[k], y, rows[e])
            slopes[e, 0], slopes[e, 1] = slopes[e, 0] * tree.normals[k], slopes[e, 1] * tree.normals[k]
        elif tree.elements[e]["measure"] == IN_COORDINATE:
            rows[e, tree.elements[e]["coordinate"]] = 1.0
            if tree.elements[e]["curve"] >= 0:
                rows[e, tree.elements[e]["cam"]] -= tree.elements[e]["slope"]
        else:
            _set_row(tree, work, coordinates, tree.elements[e], rows[e])
    for k in range(tree.contacts.sets.shape[0]):
        s = tree.contacts.sets[k]
        for n in range(s["first"], s["first"] + s["count"]):
            if tree.contacts.touches[n]["effort"] != 0.0:
                _set_touch(tree, work, coordinates, n, tree.answers.shape[0] + 3 * n, rows, slopes)
    for m in range(rows.shape[1]):
        if tree.given[m]:
            for e in range(rows.shape[0]):
                rows[e, m] = 0.0
    if tree.normals.shape[0] > 0:
        _take_feedback(tree, slopes)


@allocating
def _take_feedback(tree: "TreeArrays", slopes: np.ndarray) -> None:
    """Multiply the slopes of friction by the feedback of its own normal force."""
    feedback = np.ones(tree.normals.shape[0])
    fill_feedback(tree.joint_forces, tree.normals, feedback)
    for k in range(feedback.shape[0]):
        for order in range(2):
            slopes[tree.elements.shape[0] + k, order] *= feedback[k]


@kernel
def _set_touch(
    tree: "TreeArrays",
    work: np.ndarray,
    coordinates: np.ndarray,
    k: int,
    first: int,
    rows: np.ndarray,
    slopes: np.ndarray,
) -> None:
    """Fill the three rows of pair k, of unit forces at its place of contact."""
    touch, ends = tree.contacts.touches[k], tree.contacts.ends
    normal, along = triple(touch["normal"], 0), triple(touch["along"], 0)
    slopes[first, 0], slopes[first, 1] = touch["stiffness"], touch["damping"]
    slopes[first + 1, 0], slopes[first + 2, 0] = touch["hold"], touch["hold"]
    slopes[first + 1, 1], slopes[first + 2, 1] = touch["slope_along"], touch["slope_across"]
    for n in range(3):
        force = normal if n == 0 else along if n == 1 else cross(normal, along)
        j, i = ends[touch["end_j"]], ends[touch["end_i"]]
        _add_end(tree, work, coordinates, j, triple(touch["arm_j"], 0), force, rows[first + n])
        _add_end(tree, work, coordinates, i, triple(touch["arm_i"], 0), scaled(-1.0, force), rows[first + n])


@kernel
def _add_end(
    tree: "TreeArrays",
    work: np.ndarray,
    coordinates: np.ndarray,
    end: np.void,
    arm: tuple[float, float, float],
    force: tuple[float, float, float],
    row: np.ndarray,
) -> None:
    """Add what coordinates feel of a force at the arm from an end."""
    s = work[end["frame"]]
    n = cross(plus(minus(triple(end["position"], 0), triple(s["position"], 0)), arm), force)
    add_generalised_forces(tree, work, coordinates, end["frame"], n, force, row)
    along = inward(s["axes"], force)
    for axis in range(3):
        if end["node"][axis] >= 0:
            row[end["node"][axis]] += along[axis]


@kernel
def _set_friction_row(f: np.void, y: np.ndarray, row: np.ndarray) -> None:
    turning = y[f["turning"]] * f["c"][RADIUS] if f["turning"] >= 0 else 0.0
    sliding = y[f["sliding"]] if f["sliding"] >= 0 else 0.0
    v = (turning * turning + sliding * sliding) ** 0.5
    both = f["turning"] >= 0 and f["sliding"] >= 0 and v > 0.0
    if f["turning"] >= 0:
        row[f["turning"]] = f["c"][RADIUS] * (turning / v if both else 1.0)
    if f["sliding"] >= 0:
        row[f["sliding"]] = sliding / v if both else 1.0


@kernel
def _set_row(
    tree: "TreeArrays", work: np.ndarray, coordinates: np.ndarray, element: np.void, row: np.ndarray
) -> None:
    force, torque = triple(element["force"], 0), triple(element["torque"], 0)
    for k, node, sign in (
        (element["frame_j"], element["node_j"], 1.0),
        (element["frame_i"], element["node_i"], -1.0),
    ):
        s = work[k]
        n = plus(torque, cross(minus(triple(element["place"], 0), triple(s["position"], 0)), force))
        add_generalised_forces(tree, work, coordinates, k, scaled(sign, n), scaled(sign, force), row)
        if element["measure"] != ABOUT:
            along = inward(s["axes"], force)
            for axis in range(3):
                if node[axis] >= 0:
                    row[node[axis]] += sign * along[axis]
