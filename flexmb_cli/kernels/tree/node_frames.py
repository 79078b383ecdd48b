"""What hangs on riders, and its exchange with all elastic coordinates of their body.

With X = (al, a) of the body, w its elastic accelerations, F the forces on what hangs on the riders:
lumps give w = w_0 - L X - m^-1 Dᵀ F, riders move with A = T X + D w + r and need F = I A + b.
Elimination of w and A leaves F = (1 + I W)^-1 (I (E X + s) + b) with W = D m^-1 Dᵀ, E = T - D L,
s = D w_0 + r, and the body feels Eᵀ F: six rows a rider, at a cost linear in the body's nodes.  The
names of the arrays are those of `model.arrays.node_frames.Riders`.
"""

from .._jit import part
from ..linalg.vec3 import column, cross, outward, triple
from .kinematics import lump_place
from .work import H_, J_, M_


@part
def absorb_riders(tree, body, work, coordinates, q):
    """Add to inertia and bias of a ridden body what its riders carry, their subtrees being complete."""
    riders = tree.riders
    rows, n = 6 * body["first_rider"], 6 * body["riders"]
    s = work[body["frame"]]
    for r in range(body["first_rider"], body["first_rider"] + body["riders"]):
        _start_rider(riders, r, rows, n, work[riders.records[r]["frame"]], s)
    _sum_nodes(tree, body, s, rows, n, coordinates, q)
    _set_grip(riders, rows, n)
    _set_force_law(riders, body, rows, n, work)
    _add_carried(riders, rows, n, s)


@part
def _start_rider(riders, r, rows, n, rider, s):
    """Columns of D; E = T, s = r, W = 0; the inertia of what hangs there as a full matrix."""
    record = riders.records[r]
    row = 6 * r
    for m in range(record["count"]):
        for i in range(3):
            along = 0.0
            for axis in range(3):
                slope = riders.slopes[record["slope"] + axis * record["count"] + m]
                along += rider["hinge_axes"][3 * axis + i] * slope
            riders.motion[row + i, m] = along
            riders.motion[row + 3 + i, m] = 0.0
    for axis in range(3):
        if record["node"][axis] >= 0:
            for i in range(3):
                riders.motion[row + 3 + i, record["node"][axis] - record["first"]] = s["axes"][3 * i + axis]
    x, y, z = triple(rider["offset"], 0)
    _set_row(riders.carry, row, (1.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    _set_row(riders.carry, row + 1, (0.0, 1.0, 0.0), (0.0, 0.0, 0.0))
    _set_row(riders.carry, row + 2, (0.0, 0.0, 1.0), (0.0, 0.0, 0.0))
    _set_row(riders.carry, row + 3, (0.0, z, -y), (1.0, 0.0, 0.0))
    _set_row(riders.carry, row + 4, (-z, 0.0, x), (0.0, 1.0, 0.0))
    _set_row(riders.carry, row + 5, (y, -x, 0.0), (0.0, 0.0, 1.0))
    for i in range(6):
        riders.given[row + i] = rider["remainder"][i]
        for j in range(n):
            riders.compliance[row + i, j] = 0.0
    _set_inertia(riders.own, row, rider["inertia"])


@part
def _set_row(matrix, row, a, b):
    for i in range(3):
        matrix[row, i], matrix[row, 3 + i] = a[i], b[i]


@part
def _set_inertia(out, row, I):
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
def _sum_nodes(tree, body, s, rows, n, coordinates, q):
    """Let the nodes' coordinates into W, E and s."""
    frame = tree.frames[body["frame"]]
    for i in range(frame["first_lump"], frame["first_lump"] + frame["lumps"]):
        lump = tree.lumps[i]
        place = outward(s["axes"], lump_place(lump, q))
        for axis in range(3):
            m = lump["coordinate"][axis]
            if m >= 0:
                e = column(s["axes"], axis)
                _sum_node(
                    tree.riders, rows, n, m - body["first"], coordinates[m], lump["mass"], cross(place, e), e
                )


@part
def _sum_node(riders, rows, n, m, c, mass, turn, shift):
    """One coordinate: w is its rate when locked, else drive / mass - turn . al - shift . a - Dᵀ F / mass."""
    D = riders.motion
    free = 0.0 if c["locked"] != 0 else 1.0
    own = c["rate"] if c["locked"] != 0 else c["drive"] / mass
    for i in range(rows, rows + n):
        d = D[i, m]
        riders.given[i] += d * own
        for k in range(3):
            riders.carry[i, k] -= free * d * turn[k]
            riders.carry[i, 3 + k] -= free * d * shift[k]
        for j in range(n):
            riders.compliance[i, j] += free * d * D[rows + j, m] / mass


@part
def _set_grip(riders, rows, n):
    """(1 + I W)^-1, and what it makes of I."""
    grip, own = riders.grip, riders.own
    for i in range(n):
        block = i - i % 6
        for j in range(n):
            total = 1.0 if i == j else 0.0
            for k in range(6):
                total += own[rows + i, k] * riders.compliance[rows + block + k, j]
            grip[rows + i, j] = total
    _invert(grip, rows, n)
    for i in range(rows, rows + n):
        for j in range(n):
            block = j - j % 6
            total = 0.0
            for k in range(6):
                total += grip[i, block + k] * own[rows + block + k, j % 6]
            riders.stiff[i, j] = total


@part
def _invert(A, rows, n):
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
def _set_force_law(riders, body, rows, n, work):
    """F = gain X + held."""
    for i in range(rows, rows + n):
        for k in range(6):
            total = 0.0
            for j in range(n):
                total += riders.stiff[i, j] * riders.carry[rows + j, k]
            riders.gain[i, k] = total
        held = 0.0
        for j in range(n):
            bias = work[riders.records[body["first_rider"] + j // 6]["frame"]]["bias"][j % 6]
            held += riders.stiff[i, j] * riders.given[rows + j] + riders.grip[i, j] * bias
        riders.held[i] = held


@part
def _add_carried(riders, rows, n, s):
    """Inertia += Eᵀ gain, bias += Eᵀ held."""
    E, gain = riders.carry, riders.gain
    for row in range(rows, rows + n):
        place = 0
        for i in range(3):
            for j in range(i, 3):
                s["inertia"][J_ + place] += E[row, i] * gain[row, j]
                s["inertia"][M_ + place] += E[row, 3 + i] * gain[row, 3 + j]
                place += 1
            for j in range(3):
                s["inertia"][H_ + 3 * i + j] += E[row, i] * gain[row, 3 + j]
    _add_held(riders, rows, n, s["bias"])


@part
def _add_held(riders, rows, n, bias):
    for row in range(rows, rows + n):
        for i in range(6):
            bias[i] += riders.carry[row, i] * riders.held[row]


@part
def release_riders(tree, body, work, coordinates):
    """Accelerate the riders, and take off the drive of the nodes what they pass on, X being known."""
    riders = tree.riders
    rows, n = 6 * body["first_rider"], 6 * body["riders"]
    _set_forces(riders, rows, n, work[body["frame"]]["acceleration"])
    for m in range(body["count"]):
        coordinates[body["first"] + m]["drive"] -= _felt(riders, rows, n, m)
    for r in range(body["first_rider"], body["first_rider"] + body["riders"]):
        out = work[riders.records[r]["frame"]]["acceleration"]
        _move_rider(riders, r, rows, n, work[body["frame"]]["acceleration"], out)
        for i in range(6):
            out[i] += riders.given[6 * r + i]


@part
def _set_forces(riders, rows, n, X):
    for row in range(rows, rows + n):
        force = riders.held[row]
        for i in range(6):
            force += riders.gain[row, i] * X[i]
        riders.force[row] = force


@part
def _felt(riders, rows, n, m):
    """(Dᵀ F) of one elastic coordinate."""
    total = 0.0
    for row in range(rows, rows + n):
        total += riders.motion[row, m] * riders.force[row]
    return total


@part
def _move_rider(riders, r, rows, n, X, out):
    """out = E X - W F."""
    for row in range(6 * r, 6 * r + 6):
        total = 0.0
        for i in range(6):
            total += riders.carry[row, i] * X[i]
        for j in range(n):
            total -= riders.compliance[row, j] * riders.force[rows + j]
        out[row - 6 * r] = total


@part
def absorb_pushes(tree, body, work):
    """Add to the pushes of a ridden body what its riders pass on of theirs."""
    riders = tree.riders
    rows, n = 6 * body["first_rider"], 6 * body["riders"]
    for i in range(rows, rows + n):
        held = 0.0
        for j in range(n):
            push = work[riders.records[body["first_rider"] + j // 6]["frame"]]["push"][j % 6]
            held += riders.grip[i, j] * push
        riders.held[i] = held
    _add_held(riders, rows, n, work[body["frame"]]["push"])


@part
def follow_riders(tree, body, work):
    """Set the responses of the riders, that of the body being known."""
    riders = tree.riders
    rows, n = 6 * body["first_rider"], 6 * body["riders"]
    X = work[body["frame"]]["response"]
    _set_forces(riders, rows, n, X)
    for r in range(body["first_rider"], body["first_rider"] + body["riders"]):
        _move_rider(riders, r, rows, n, X, work[riders.records[r]["frame"]]["response"])


@part
def rider_share(tree, frame, m):
    """Return the effort of elastic coordinate m that goes to the carried bodies of a frame's body, if any."""
    if frame["ridden"] < 0:
        return 0.0
    body = tree.riders.bodies[frame["ridden"]]
    return _felt(tree.riders, 6 * body["first_rider"], 6 * body["riders"], m - body["first"])
