"""Friction in the hinges of a tree: forces in hinges by the recursion, and the normal forces they give.

What hangs on hinge k needs from it n = J al + H a + p_n, f = Hᵀ al + M a + p_f, with its articulated inertia
after the elimination of the hinge and the acceleration (al, a) before that of the hinge.  A unit normal force
changes these forces by its efforts' response alone.
"""

from typing import TYPE_CHECKING

from .._jit import kernel, part
from ..constrained.dry_friction import PRELOAD, fill_normal_forces
from ..laws import DAMPING, EFFORT, NORMAL, POWER, answer_unit_friction
from ..linalg.vec3 import cross, dot, minus, plus, scaled, symmetric, symmetric_times, triple
from .articulated_inertia import _times_H, _transposed_H
from .unit_forces import clear_unit_forces, respond
from .work import J_, M_

if TYPE_CHECKING:
    import numpy as np

    from ...model.arrays.tree import TreeArrays


@part
def answer_frictions(tree: "TreeArrays", y: "np.ndarray") -> None:
    """Fill the efforts of all frictions by the normal force 1 N."""
    for k in range(tree.frictions.shape[0]):
        f, answer = tree.frictions[k], tree.answers[tree.elements.shape[0] + k]
        turns, slides = f["turning"] >= 0, f["sliding"] >= 0
        turning = y[f["turning"]] * f["radius"] if turns else 0.0
        sliding = y[f["sliding"]] if slides else 0.0
        share = answer_unit_friction(f, turning, sliding, turns and slides, answer)
        f["turning_effort"], f["sliding_effort"] = -share * turning * f["radius"], -share * sliding


@part
def hinge_wrench(
    motion: "np.ndarray", remainder: "np.ndarray", share: float, bias: "np.ndarray", s: "np.void"
) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
    """Moment about its origin and force on a frame by its hinge, the parent moving with (al, a)."""
    al = plus(triple(motion, 0), scaled(share, triple(remainder, 0)))
    a = plus(triple(motion, 3), cross(triple(motion, 0), triple(s["offset"], 0)))
    a = plus(a, scaled(share, triple(remainder, 3)))
    I = s["inertia"]
    n = plus(symmetric_times(symmetric(I, J_), al), _times_H(I, a))
    f = plus(_transposed_H(I, al), symmetric_times(symmetric(I, M_), a))
    return plus(n, triple(bias, 0)), plus(f, triple(bias, 3))


@kernel
def set_reactions(tree: "TreeArrays", work: "np.ndarray", reactions: "np.ndarray") -> None:
    """Fill reactions (F, 6): moment about its origin and force of its hinge on every frame, inertial axes."""
    for k in range(1, tree.frames.shape[0]):
        s, parent = work[k], work[tree.frames[k]["parent"]]
        n, f = hinge_wrench(parent["acceleration"], s["remainder"], 1.0, s["bias"], s)
        for i in range(3):
            reactions[k, i], reactions[k, 3 + i] = n[i], f[i]


@part
def _fill_forces(tree: "TreeArrays", work: "np.ndarray", coordinates: "np.ndarray", share: float, row: int) -> None:
    """Fill a row of the joint forces: those across the axes of the hinges."""
    for k in range(tree.frictions.shape[0]):
        f = tree.frictions[k]
        s, parent = work[f["frame"]], work[tree.frames[f["frame"]]["parent"]]
        if row == 0:
            _n, force = hinge_wrench(parent["acceleration"], s["remainder"], 1.0, s["bias"], s)
        else:
            _n, force = hinge_wrench(parent["response"], s["remainder"], 0.0, s["unit_force"], s)
        axis = triple(coordinates[f["turning"] if f["turning"] >= 0 else f["sliding"]]["direction"], 0)
        force = minus(force, scaled(dot(force, axis), axis))
        for i in range(3):
            tree.joint_forces[row, k, i] = force[i]


@part
def find_normal_forces(tree: "TreeArrays", work: "np.ndarray", coordinates: "np.ndarray") -> None:
    """Find the normal forces, the tree having been solved without friction."""
    _fill_forces(tree, work, coordinates, 1.0, 0)
    for k in range(tree.frictions.shape[0]):
        tree.joint_forces[0, k, PRELOAD] = tree.frictions[k]["preload"]
    for p in range(tree.frictions.shape[0]):
        clear_unit_forces(work)
        _set_unit_efforts(tree, coordinates, p, 1.0)
        respond(tree, work, coordinates)
        _fill_forces(tree, work, coordinates, 0.0, 1 + p)
        _set_unit_efforts(tree, coordinates, p, 0.0)
    fill_normal_forces(tree.joint_forces, tree.normals)
    for k in range(tree.frictions.shape[0]):
        answer, N = tree.answers[tree.elements.shape[0] + k], tree.normals[k]
        answer[NORMAL] = N
        for column in (EFFORT, POWER, DAMPING):
            answer[column] *= N


@part
def _set_unit_efforts(tree: "TreeArrays", coordinates: "np.ndarray", p: int, size: float) -> None:
    f = tree.frictions[p]
    if f["turning"] >= 0:
        coordinates[f["turning"]]["unit_effort"] = size * f["turning_effort"]
    if f["sliding"] >= 0:
        coordinates[f["sliding"]]["unit_effort"] = size * f["sliding_effort"]


@part
def add_friction_efforts(tree: "TreeArrays", coordinates: "np.ndarray") -> None:
    """Add the efforts of friction under the normal forces found."""
    for p in range(tree.frictions.shape[0]):
        f = tree.frictions[p]
        if f["turning"] >= 0:
            coordinates[f["turning"]]["effort"] += tree.normals[p] * f["turning_effort"]
        if f["sliding"] >= 0:
            coordinates[f["sliding"]]["effort"] += tree.normals[p] * f["sliding_effort"]
