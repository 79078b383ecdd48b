"""What hangs on node frames, and its exchange with all elastic coordinates of their body.

With X = (al, a) of the body, w its elastic accelerations, F the forces on what hangs on the node frames:
nodal masses give w = w_0 - L X - m^-1 Dᵀ F, node frames move with A = T X + D w + r and need F = I A + b.
Elimination of w and A leaves F = (1 + I W)^-1 (I (E X + s) + b) with W = D m^-1 Dᵀ, E = T - D L,
s = D w_0 + r, and the body feels Eᵀ F: six rows a node frame, at a cost linear in the body's nodes.  The
names of the arrays are those of `model.arrays.node_frames.NodeFrames`.
"""

from typing import TYPE_CHECKING

from .._jit import part
from ..linalg.vec3 import column, cross, outward, triple
from .kinematics import node_place
from .work import H_, J_, M_

if TYPE_CHECKING:
    import numpy as np

    from ...model.arrays.node_frames import NodeFrames
    from ...model.arrays.tree import TreeArrays


@part
def absorb_node_frames(
    tree: "TreeArrays", body: "np.void", work: "np.ndarray", coordinates: "np.ndarray", q: "np.ndarray"
) -> None:
    """Add to inertia and bias of a flexible parent what its node frames carry, their subtrees being
    complete.
    """
    node_frames = tree.node_frames
    rows, n = 6 * body["first_node_frame"], 6 * body["node_frames"]
    s = work[body["frame"]]
    for r in range(body["first_node_frame"], body["first_node_frame"] + body["node_frames"]):
        _start_node_frame(node_frames, r, rows, n, work[node_frames.records[r]["frame"]], s)
    _sum_nodes(tree, body, s, rows, n, coordinates, q)
    _set_transmission(node_frames, rows, n)
    _set_force_law(node_frames, body, rows, n, work)
    _add_carried(node_frames, rows, n, s)


@part
def _start_node_frame(
    node_frames: "NodeFrames", r: int, rows: int, n: int, node_frame: "np.void", s: "np.void"
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
    matrix: "np.ndarray", row: int, a: tuple[float, float, float], b: tuple[float, float, float]
) -> None:
    for i in range(3):
        matrix[row, i], matrix[row, 3 + i] = a[i], b[i]


@part
def _set_inertia(out: "np.ndarray", row: int, I: "np.ndarray") -> None:
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
def _sum_nodes(
    tree: "TreeArrays",
    body: "np.void",
    s: "np.void",
    rows: int,
    n: int,
    coordinates: "np.ndarray",
    q: "np.ndarray",
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
    c: "np.void",
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
def _set_transmission(node_frames: "NodeFrames", rows: int, n: int) -> None:
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
def _invert(A: "np.ndarray", rows: int, n: int) -> None:
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
def _set_force_law(node_frames: "NodeFrames", body: "np.void", rows: int, n: int, work: "np.ndarray") -> None:
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


@part
def _add_carried(node_frames: "NodeFrames", rows: int, n: int, s: "np.void") -> None:
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
def _add_held(node_frames: "NodeFrames", rows: int, n: int, bias: "np.ndarray") -> None:
    for row in range(rows, rows + n):
        for i in range(6):
            bias[i] += node_frames.carry[row, i] * node_frames.held[row]


@part
def release_node_frames(
    tree: "TreeArrays", body: "np.void", work: "np.ndarray", coordinates: "np.ndarray"
) -> None:
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
def _set_forces(node_frames: "NodeFrames", rows: int, n: int, X: "np.ndarray") -> None:
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
    node_frames: "NodeFrames", r: int, rows: int, n: int, X: "np.ndarray", out: "np.ndarray"
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
def absorb_unit_forces(tree: "TreeArrays", body: "np.void", work: "np.ndarray") -> None:
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
def follow_node_frames(tree: "TreeArrays", body: "np.void", work: "np.ndarray") -> None:
    """Set the responses of the node frames, that of the body being known."""
    node_frames = tree.node_frames
    rows, n = 6 * body["first_node_frame"], 6 * body["node_frames"]
    X = work[body["frame"]]["response"]
    _set_forces(node_frames, rows, n, X)
    for r in range(body["first_node_frame"], body["first_node_frame"] + body["node_frames"]):
        _move_node_frame(node_frames, r, rows, n, X, work[node_frames.records[r]["frame"]]["response"])


@part
def node_frame_share(tree: "TreeArrays", frame: "np.void", m: int) -> float:
    """Return the effort of elastic coordinate m that goes to the carried bodies of a frame's body, if any."""
    if frame["flexible_parent"] < 0:
        return 0.0
    body = tree.node_frames.bodies[frame["flexible_parent"]]
    return _generalised_force(
        tree.node_frames, 6 * body["first_node_frame"], 6 * body["node_frames"], m - body["first"]
    )
