"""The force law F = gain X + held of what hangs on the node frames of a flexible body.

The equations and the names of the arrays are those of `node_frames`.
"""

from typing import TYPE_CHECKING

import numpy as np

from .._jit import part
from ..linalg.vec3 import column, cross, outward, triple
from .kinematics import node_place
from .work import H_, J_, M_

if TYPE_CHECKING:
    from ...model.arrays.node_frames import NodeFrames
    from ...model.arrays.tree import TreeArrays


@part
def start_node_frame(
    node_frames: "NodeFrames", r: int, rows: int, n: int, node_frame: np.void, s: np.void
) -> None:
    """Columns of D; E = T, s = r, W = 0; the inertia of what hangs there as a full matrix."""
    record = node_frames.records[r]
    row = 6 * r
    for m in range(record["count"]):
        for i in range(3):
            along = 0.0
            for axis in range(3):
                slope = node_frames.slopes[record["slope"] + axis * record["count"] + m]
                along += node_frame["hinge_axes"][3 * axis + i] * slope
            node_frames.motion[row + i, m] = along
            node_frames.motion[row + 3 + i, m] = 0.0
    for axis in range(3):
        if record["node"][axis] >= 0:
            for i in range(3):
                node_frames.motion[row + 3 + i, record["node"][axis] - record["first"]] = s["axes"][
                    3 * i + axis
                ]
    x, y, z = triple(node_frame["offset"], 0)
    _set_row(node_frames.carry, row, (1.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    _set_row(node_frames.carry, row + 1, (0.0, 1.0, 0.0), (0.0, 0.0, 0.0))
    _set_row(node_frames.carry, row + 2, (0.0, 0.0, 1.0), (0.0, 0.0, 0.0))
    _set_row(node_frames.carry, row + 3, (0.0, z, -y), (1.0, 0.0, 0.0))
    _set_row(node_frames.carry, row + 4, (-z, 0.0, x), (0.0, 1.0, 0.0))
    _set_row(node_frames.carry, row + 5, (y, -x, 0.0), (0.0, 0.0, 1.0))
    for i in range(6):
        node_frames.given[row + i] = node_frame["remainder"][i]
        for j in range(n):
            node_frames.compliance[row + i, j] = 0.0
    _set_inertia(node_frames.own, row, node_frame["inertia"])


@part
def _set_row(
    matrix: np.ndarray, row: int, a: tuple[float, float, float], b: tuple[float, float, float]
) -> None:
    for i in range(3):
        matrix[row, i], matrix[row, 3 + i] = a[i], b[i]


@part
def _set_inertia(out: np.ndarray, row: int, I: np.ndarray) -> None:
    """(6, 6) block [[J, H], [Hᵀ, M]] of 21 numbers."""
    place = 0
    for i in range(3):
        for j in range(i, 3):
            out[row + i, j] = out[row + j, i] = I[J_ + place]
            out[row + 3 + i, 3 + j] = out[row + 3 + j, 3 + i] = I[M_ + place]
            place += 1
        for j in range(3):
            out[row + i, 3 + j] = out[row + 3 + j, i] = I[H_ + 3 * i + j]


@part
def sum_nodes(
    tree: "TreeArrays", body: np.void, s: np.void, rows: int, n: int, coordinates: np.ndarray, q: np.ndarray
) -> None:
    """Let the nodes' coordinates into W, E and s."""
    frame = tree.frames[body["frame"]]
    for i in range(frame["first_nodal_mass"], frame["first_nodal_mass"] + frame["nodal_masses"]):
        nodal_mass = tree.nodal_masses[i]
        place = outward(s["axes"], node_place(nodal_mass, q))
        for axis in range(3):
            m = nodal_mass["coordinate"][axis]
            if m >= 0:
                e = column(s["axes"], axis)
                _sum_node(
                    tree.node_frames,
                    rows,
                    n,
                    m - body["first"],
                    coordinates[m],
                    nodal_mass["mass"],
                    cross(place, e),
                    e,
                )


@part
def _sum_node(
    node_frames: "NodeFrames",
    rows: int,
    n: int,
    m: int,
    c: np.void,
    mass: float,
    turn: tuple[float, float, float],
    shift: tuple[float, float, float],
) -> None:
    """One coordinate: w is its rate when locked, else drive / mass - turn . al - shift . a - Dᵀ F / mass."""
    D = node_frames.motion
    free = 0.0 if c["locked"] != 0 else 1.0
    own = c["rate"] if c["locked"] != 0 else c["drive"] / mass
    for i in range(rows, rows + n):
        d = D[i, m]
        node_frames.given[i] += d * own
        for k in range(3):
            node_frames.carry[i, k] -= free * d * turn[k]
            node_frames.carry[i, 3 + k] -= free * d * shift[k]
        for j in range(n):
            node_frames.compliance[i, j] += free * d * D[rows + j, m] / mass


@part
def set_transmission(node_frames: "NodeFrames", rows: int, n: int) -> None:
    """(1 + I W)^-1, and what it makes of I."""
    transmission, own = node_frames.transmission, node_frames.own
    for i in range(n):
        block = i - i % 6
        for j in range(n):
            total = 1.0 if i == j else 0.0
            for k in range(6):
                total += own[rows + i, k] * node_frames.compliance[rows + block + k, j]
            transmission[rows + i, j] = total
    _invert(transmission, rows, n)
    for i in range(rows, rows + n):
        for j in range(n):
            block = j - j % 6
            total = 0.0
            for k in range(6):
                total += transmission[i, block + k] * own[rows + block + k, j % 6]
            node_frames.stiff[i, j] = total


@part
def _invert(A: np.ndarray, rows: int, n: int) -> None:
    """Invert n rows of A from `rows` on in place, without exchanges.

    The eigenvalues of 1 + I W, both I and W positive semidefinite, are 1 and more.
    """
    for k in range(n):
        pivot = 1.0 / A[rows + k, k]
        A[rows + k, k] = 1.0
        for j in range(n):
            A[rows + k, j] *= pivot
        for i in range(n):
            factor = A[rows + i, k]
            if i != k and factor != 0.0:
                A[rows + i, k] = 0.0
                for j in range(n):
                    A[rows + i, j] -= factor * A[rows + k, j]


@part
def set_force_law(node_frames: "NodeFrames", body: np.void, rows: int, n: int, work: np.ndarray) -> None:
    """F = gain X + held."""
    for i in range(rows, rows + n):
        for k in range(6):
            total = 0.0
            for j in range(n):
                total += node_frames.stiff[i, j] * node_frames.carry[rows + j, k]
            node_frames.gain[i, k] = total
        held = 0.0
        for j in range(n):
            bias = work[node_frames.records[body["first_node_frame"] + j // 6]["frame"]]["bias"][j % 6]
            held += (
                node_frames.stiff[i, j] * node_frames.given[rows + j] + node_frames.transmission[i, j] * bias
            )
        node_frames.held[i] = held
