"""Bringing the coordinates and speeds of a tree onto its closures.

A correction is the motion that forces in the closures would give the tree, b^-1 Jᵀ times what closes
the gaps: the least one in the metric of the mass matrix, which leaves alone whatever the loops do
not involve.  `stiff_projection` makes the same corrections in the metric of the matrix of an implicit step.
"""

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from .._jit import allocating, kernel
from .kinematics import attitude_rates, place_frames
from .loop_closures import add_row_forces, evaluate_rows, solve_rows
from .motion import normalise_attitudes, parts
from .unit_forces import clear_unit_forces, respond, respond_nodes

if TYPE_CHECKING:
    from ...model.arrays.tree import TreeArrays


CLOSED_LOOP_GAP = 1e-13  # m and m/s: as good as closed
MOST_CORRECTIONS = 5
LONGEST_CORRECTION = 0.5  # correction of one coordinate, rad or m


@kernel
def largest_gap(closures: np.ndarray) -> float:
    """Largest |gap|, m."""
    largest = 0.0
    for i in range(closures.shape[0]):
        largest = max(largest, abs(closures[i]["gap"]))
    return largest


@kernel
def largest_rate(closures: np.ndarray) -> float:
    """Largest |rate| of a gap, m/s."""
    largest = 0.0
    for i in range(closures.shape[0]):
        largest = max(largest, abs(closures[i]["rate"]))
    return largest


class Metric(NamedTuple):
    """Metric in which corrections are the least: kernels of (tree, work, coordinates, ..., *arrays)."""

    begin: Callable[..., Any]  # (..., *arrays): what corrections need, where the frames are placed
    respond: Callable[..., Any]  # (..., z, *arrays): responses of all coordinates to the rows' changes
    rate_corrections: int  # corrections of the speeds


def projection(metric: Metric) -> Callable[..., Any]:
    """Return the kernel that closes gaps and rates of a state z (n,) by the least corrections in a metric."""
    begin, respond, rate_corrections = metric

    @kernel
    def project(
        tree: "TreeArrays", work: np.ndarray, coordinates: np.ndarray, z: np.ndarray, *arrays: Any
    ) -> None:
        evaluate_gaps(tree, work, coordinates, z)
        begin(tree, work, coordinates, *arrays)
        for _ in range(MOST_CORRECTIONS):
            if largest_gap(tree.closures) <= CLOSED_LOOP_GAP:
                break
            for i in range(tree.closures.shape[0]):
                tree.closures[i]["force"] = -tree.closures[i]["gap"]
            respond(tree, work, coordinates, z, *arrays)
            move_coordinates(tree, coordinates, z)
            evaluate_gaps(tree, work, coordinates, z)
        for _ in range(rate_corrections):
            for i in range(tree.closures.shape[0]):
                tree.closures[i]["force"] = -tree.closures[i]["rate"]
            respond(tree, work, coordinates, z, *arrays)
            change_speeds(tree, coordinates, z)
            evaluate_gaps(tree, work, coordinates, z)

    return project


@kernel
def evaluate_gaps(tree: "TreeArrays", work: np.ndarray, coordinates: np.ndarray, z: np.ndarray) -> None:
    """Place the frames and measure the closures at the state z."""
    y, q, attitudes = parts(tree, z)
    place_frames(tree, work, coordinates, q, y, attitudes)
    evaluate_rows(tree, work, q, y)


@kernel
def respond_to_rows(tree: "TreeArrays", work: np.ndarray, coordinates: np.ndarray, z: np.ndarray) -> None:
    """Responses of all coordinates to forces that take away what the rows hold as forces."""
    _y, q, _attitudes = parts(tree, z)
    solve_rows(tree.closures, tree.closure_matrix)
    clear_unit_forces(work, coordinates)
    add_row_forces(tree, work, coordinates)
    respond(tree, work, coordinates)
    respond_nodes(tree, work, coordinates, q)


@kernel
def move_coordinates(tree: "TreeArrays", coordinates: np.ndarray, z: np.ndarray) -> None:
    """Move the coordinates by their responses, none further than LONGEST_CORRECTION."""
    _y, q, attitudes = parts(tree, z)
    _move_parts(tree, coordinates, q, attitudes)
    normalise_attitudes(tree, z)


@allocating
def _move_parts(tree: "TreeArrays", coordinates: np.ndarray, q: np.ndarray, attitudes: np.ndarray):
    largest = 0.0
    for m in range(coordinates.shape[0]):
        largest = max(largest, abs(coordinates[m]["response"]))
    share = min(1.0, LONGEST_CORRECTION / largest) if largest > 0.0 else 1.0
    move = np.zeros(q.shape[0])
    for m in range(q.shape[0]):
        move[m] = share * coordinates[m]["response"]
        q[m] += move[m]
    turn = np.zeros(attitudes.shape)
    for k in range(1, tree.frames.shape[0]):
        if tree.frames[k]["ball"] >= 0:
            attitude_rates(tree.frames[k], move, attitudes, turn)
    for ball in range(attitudes.shape[0]):
        for i in range(4):
            attitudes[ball, i] += turn[ball, i]


@kernel
def change_speeds(tree: "TreeArrays", coordinates: np.ndarray, z: np.ndarray) -> None:
    """Change the speeds by their responses."""
    y, _q, _attitudes = parts(tree, z)
    for m in range(y.shape[0]):
        y[m] += coordinates[m]["response"]


@kernel
def _nothing(tree: "TreeArrays", work: np.ndarray, coordinates: np.ndarray) -> None:
    """Responses to forces go by what the last solution of the equations has left."""


# Near the state for which the equations have just been solved.
project = projection(Metric(_nothing, respond_to_rows, 1))
