"""Friction in the hinges of a tree: its normal forces follow from the forces in hinges, which it changes.

A unit normal force changes the forces in hinges by the response to its efforts, and to the forces that this
response causes in loops and couplings.
"""

from typing import TYPE_CHECKING

import numpy as np

from .._jit import kernel, part
from ..constrained.dry_friction import PRELOAD, fill_normal_forces
from ..laws import DAMPING, EFFORT, NORMAL, NORMAL_PRELOAD, POWER, RADIUS, STIFFNESS, answer_unit_friction
from ..linalg.vec3 import dot, minus, scaled, triple
from .hinge_forces import hinge_wrench
from .loop_closures import add_row_forces, find_loop_responses
from .unit_forces import clear_unit_forces, respond

if TYPE_CHECKING:
    from ...model.arrays.tree import TreeArrays


@part
def answer_frictions(tree: "TreeArrays", y: np.ndarray) -> None:
    """Fill the efforts of all frictions by the normal force 1 N."""
    for k in range(tree.frictions.shape[0]):
        f, answer = tree.frictions[k], tree.answers[tree.elements.shape[0] + k]
        turns, slides = f["turning"] >= 0, f["sliding"] >= 0
        turning = y[f["turning"]] * f["c"][RADIUS] if turns else 0.0
        sliding = y[f["sliding"]] if slides else 0.0
        about, along = answer_unit_friction(f, tree.signals, turning, sliding, turns and slides, answer)
        f["turning_effort"], f["sliding_effort"] = about * f["c"][RADIUS], along


@kernel
def find_normal_forces(tree: "TreeArrays", work: np.ndarray, coordinates: np.ndarray) -> None:
    """Find the normal forces, the forces of rows without friction known; add what friction causes in rows."""
    _set_forces(tree, work, coordinates)
    for p in range(tree.frictions.shape[0]):
        _set_response(tree, work, coordinates, p)
    fill_normal_forces(tree.joint_forces, tree.normals)
    for k in range(tree.frictions.shape[0]):
        answer, N = tree.answers[tree.elements.shape[0] + k], tree.normals[k]
        answer[NORMAL] = N
        for column in (EFFORT, POWER, STIFFNESS, DAMPING):
            answer[column] *= N
    for i in range(tree.closures.shape[0]):
        force = tree.row_forces[0, i]
        for p in range(tree.frictions.shape[0]):
            force += tree.normals[p] * tree.row_forces[1 + p, i]
        tree.closures[i]["force"] = force


@kernel
def _set_forces(tree: "TreeArrays", work: np.ndarray, coordinates: np.ndarray) -> None:
    """Fill the joint forces without friction: of the solution with open loops, and by the forces of rows."""
    tree.joint_forces.fill(0.0)
    for k in range(tree.frictions.shape[0]):
        tree.joint_forces[0, k, PRELOAD] = tree.frictions[k]["c"][NORMAL_PRELOAD]
    _add_forces(tree, work, coordinates, 0, False)
    if tree.closures.shape[0] > 0:
        _keep_row_forces(tree, 0)
        clear_unit_forces(work, coordinates)
        add_row_forces(tree, work, coordinates)
        respond(tree, work, coordinates)
        _add_forces(tree, work, coordinates, 0, True)


@kernel
def _set_response(tree: "TreeArrays", work: np.ndarray, coordinates: np.ndarray, p: int) -> None:
    """Fill the joint forces by the unit normal force of friction p, and those of rows."""
    clear_unit_forces(work, coordinates)
    _set_unit_efforts(tree, coordinates, p)
    respond(tree, work, coordinates)
    if tree.closures.shape[0] > 0:
        find_loop_responses(tree, work, coordinates)
        _keep_row_forces(tree, 1 + p)
        clear_unit_forces(work, coordinates)
        _set_unit_efforts(tree, coordinates, p)
        add_row_forces(tree, work, coordinates)
        respond(tree, work, coordinates)
    _add_forces(tree, work, coordinates, 1 + p, True)


@kernel
def _keep_row_forces(tree: "TreeArrays", place: int) -> None:
    for i in range(tree.closures.shape[0]):
        tree.row_forces[place, i] = tree.closures[i]["force"]


@kernel
def _set_unit_efforts(tree: "TreeArrays", coordinates: np.ndarray, p: int) -> None:
    f = tree.frictions[p]
    if f["turning"] >= 0:
        coordinates[f["turning"]]["unit_effort"] = f["turning_effort"]
    if f["sliding"] >= 0:
        coordinates[f["sliding"]]["unit_effort"] = f["sliding_effort"]


@kernel
def _add_forces(
    tree: "TreeArrays", work: np.ndarray, coordinates: np.ndarray, row: int, response: bool
) -> None:
    """Add to a row of the joint forces those across the axes of the hinges, of the solution or a response."""
    for k in range(tree.frictions.shape[0]):
        f = tree.frictions[k]
        s, parent = work[f["frame"]], work[tree.frames[f["frame"]]["parent"]]
        if response:
            _n, force = hinge_wrench(parent["response"], 0.0, s["unit_force"], s)
        else:
            _n, force = hinge_wrench(parent["acceleration"], 1.0, s["bias"], s)
        axis = triple(coordinates[f["turning"] if f["turning"] >= 0 else f["sliding"]]["direction"], 0)
        force = minus(force, scaled(dot(force, axis), axis))
        for i in range(3):
            tree.joint_forces[row, k, i] += force[i]


@part
def add_friction_efforts(tree: "TreeArrays", coordinates: np.ndarray) -> None:
    """Add the efforts of friction under the normal forces found."""
    for p in range(tree.frictions.shape[0]):
        f = tree.frictions[p]
        if f["turning"] >= 0:
            coordinates[f["turning"]]["effort"] += tree.normals[p] * f["turning_effort"]
        if f["sliding"] >= 0:
            coordinates[f["sliding"]]["effort"] += tree.normals[p] * f["sliding_effort"]
