"""Loads on node frames, and their exchange with all elastic coordinates of the body.

With X = (al, a) of the body, w its elastic accelerations, F the forces on what hangs on the node frames:
nodal masses give w = w_0 - L X - m^-1 Dᵀ F, node frames move with A = T X + D w + r and need F = I A + b.
Elimination of w and A leaves F = (1 + I W)^-1 (I (E X + s) + b) with W = D m^-1 Dᵀ, E = T - D L,
s = D w_0 + r, and the body feels Eᵀ F: six rows a node frame, at a cost linear in the body's nodes.  The
names of the arrays are those of `model.arrays.node_frames.NodeFrames`.
"""

from typing import TYPE_CHECKING

import numpy as np

from .._jit import part
from .node_frame_law import set_force_law, set_transmission, start_node_frame, sum_nodes
from .work import H_, J_, M_

if TYPE_CHECKING:
    from ...model.arrays.node_frames import NodeFrames
    from ...model.arrays.tree import TreeArrays


@part
def absorb_node_frames(
    tree: "TreeArrays", body: np.void, work: np.ndarray, coordinates: np.ndarray, q: np.ndarray
) -> None:
    """Add to inertia and bias of a flexible parent what its node frames carry, their subtrees being
    complete.
    """
    node_frames = tree.node_frames
    rows, n = 6 * body["first_node_frame"], 6 * body["node_frames"]
    s = work[body["frame"]]
    for r in range(body["first_node_frame"], body["first_node_frame"] + body["node_frames"]):
        start_node_frame(node_frames, r, rows, n, work[node_frames.records[r]["frame"]], s)
    sum_nodes(tree, body, s, rows, n, coordinates, q)
    set_transmission(node_frames, rows, n)
    set_force_law(node_frames, body, rows, n, work)
    _add_carried(node_frames, rows, n, s)


@part
def _add_carried(node_frames: "NodeFrames", rows: int, n: int, s: np.void) -> None:
    """Inertia += Eᵀ gain, bias += Eᵀ held."""
    E, gain = node_frames.carry, node_frames.gain
    for row in range(rows, rows + n):
        place = 0
        for i in range(3):
            for j in range(i, 3):
                s["inertia"][J_ + place] += E[row, i] * gain[row, j]
                s["inertia"][M_ + place] += E[row, 3 + i] * gain[row, 3 + j]
                place += 1
            for j in range(3):
                s["inertia"][H_ + 3 * i + j] += E[row, i] * gain[row, 3 + j]
    _add_held(node_frames, rows, n, s["bias"])


@part
def _add_held(node_frames: "NodeFrames", rows: int, n: int, bias: np.ndarray) -> None:
    for row in range(rows, rows + n):
        for i in range(6):
            bias[i] += node_frames.carry[row, i] * node_frames.held[row]


@part
def release_node_frames(tree: "TreeArrays", body: np.void, work: np.ndarray, coordinates: np.ndarray) -> None:
    """Accelerate the node frames, and take off the drive of the nodes what they pass on, X being known."""
    node_frames = tree.node_frames
    rows, n = 6 * body["first_node_frame"], 6 * body["node_frames"]
    _set_forces(node_frames, rows, n, work[body["frame"]]["acceleration"])
    for m in range(body["count"]):
        coordinates[body["first"] + m]["drive"] -= _generalised_force(node_frames, rows, n, m)
    for r in range(body["first_node_frame"], body["first_node_frame"] + body["node_frames"]):
        out = work[node_frames.records[r]["frame"]]["acceleration"]
        _move_node_frame(node_frames, r, rows, n, work[body["frame"]]["acceleration"], out)
        for i in range(6):
            out[i] += node_frames.given[6 * r + i]


@part
def _set_forces(node_frames: "NodeFrames", rows: int, n: int, X: np.ndarray) -> None:
    for row in range(rows, rows + n):
        force = node_frames.held[row]
        for i in range(6):
            force += node_frames.gain[row, i] * X[i]
        node_frames.force[row] = force


@part
def _generalised_force(node_frames: "NodeFrames", rows: int, n: int, m: int) -> float:
    """(Dᵀ F) of one elastic coordinate."""
    total = 0.0
    for row in range(rows, rows + n):
        total += node_frames.motion[row, m] * node_frames.force[row]
    return total


@part
def _move_node_frame(
    node_frames: "NodeFrames", r: int, rows: int, n: int, X: np.ndarray, out: np.ndarray
) -> None:
    """out = E X - W F."""
    for row in range(6 * r, 6 * r + 6):
        total = 0.0
        for i in range(6):
            total += node_frames.carry[row, i] * X[i]
        for j in range(n):
            total -= node_frames.compliance[row, j] * node_frames.force[rows + j]
        out[row - 6 * r] = total


@part
def absorb_unit_forces(tree: "TreeArrays", body: np.void, work: np.ndarray) -> None:
    """Add to the unit forces of a flexible parent what its node frames pass on of theirs."""
    node_frames = tree.node_frames
    rows, n = 6 * body["first_node_frame"], 6 * body["node_frames"]
    for i in range(rows, rows + n):
        held = 0.0
        for j in range(n):
            unit_force = work[node_frames.records[body["first_node_frame"] + j // 6]["frame"]]["unit_force"][
                j % 6
            ]
            held += node_frames.transmission[i, j] * unit_force
        node_frames.held[i] = held
    _add_held(node_frames, rows, n, work[body["frame"]]["unit_force"])


@part
def follow_node_frames(tree: "TreeArrays", body: np.void, work: np.ndarray) -> None:
    """Set the responses of the node frames, that of the body being known."""
    node_frames = tree.node_frames
    rows, n = 6 * body["first_node_frame"], 6 * body["node_frames"]
    X = work[body["frame"]]["response"]
    _set_forces(node_frames, rows, n, X)
    for r in range(body["first_node_frame"], body["first_node_frame"] + body["node_frames"]):
        _move_node_frame(node_frames, r, rows, n, X, work[node_frames.records[r]["frame"]]["response"])


@part
def node_frame_share(tree: "TreeArrays", frame: np.void, m: int) -> float:
    """Return the effort of elastic coordinate m that goes to the carried bodies of a frame's body, if any."""
    if frame["flexible_parent"] < 0:
        return 0.0
    body = tree.node_frames.bodies[frame["flexible_parent"]]
    return _generalised_force(
        tree.node_frames, 6 * body["first_node_frame"], 6 * body["node_frames"], m - body["first"]
    )
