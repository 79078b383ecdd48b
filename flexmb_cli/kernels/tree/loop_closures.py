"""Closed loops and couplings of a tree: gaps of their rows, rates, and the forces that keep them at zero.

A closure keeps p_a - p_b at zero along axes of body b.  Where point a may move along a free direction
of b, its velocity is compared with that of the point of body b just there.  A coupling keeps c . q at its
value; its force acts as the efforts c along the coordinates.  A point on a curve of body b has two rows,
along the curve's normals (`curves`).  A row that holds a turn keeps w . v, of a vector w of body a and v of
body b; its force acts as torques of ±(w x v).  Rolling has two or three rows, one with a gap (`rolling`).

DAFMS thesis (1992), section 3.4, reduces the equations to independent speeds, y = A y_i + B, which
makes the closure forces drop out since J A = 0 (3.17-3.25).  Here the same equations are solved for
the forces first: (J b^-1 Jᵀ) force = -(remainder of the closures' accelerations), with b^-1 Jᵀ from
the recursion.  The accelerations are those of the reduction; no choice of independent speeds is
needed that could turn singular on the way, and the forces come with it.  The matrix is eliminated
with diagonal pivots: rows that repeat others leave none and get no force.
"""

from typing import TYPE_CHECKING

import numpy as np

from .._jit import kernel
from ..constrained.time_functions import function_values
from ..curves import curve_values, nearest_parameter, normal, stretch
from ..linalg.number_rows import product
from ..linalg.vec3 import (
    accumulate,
    centripetal,
    column,
    cross,
    dot,
    inward,
    minus,
    outward,
    plus,
    scaled,
    store,
    triple,
)
from ..rolling import contact_advance, rolling_contact, rolling_direction
from .unit_forces import clear_unit_forces, respond, unit_force

if TYPE_CHECKING:
    from ...model.arrays.tree import TreeArrays


# Types of rows that close a direction.
AXIS_ROW, VECTOR_ROW, TURN_ROW = 0, 1, 2
# A response below this part of the largest one means that nothing moves in this direction.
IMMOBILE = 1e-12


@kernel
def clear_loop_forces(closures: np.ndarray) -> None:
    """Leave all loops open."""
    for i in range(closures.shape[0]):
        closures[i]["force"] = 0.0


@kernel
def evaluate_rows(tree: "TreeArrays", work: np.ndarray, q: np.ndarray, y: np.ndarray) -> None:
    """Set direction, place, gap and rate of every row for placed frames."""
    for i in range(tree.closures.shape[0]):
        row = tree.closures[i]
        if row["coupling"] >= 0:
            _evaluate_coupling(tree, row, q, y)
            continue
        a, b = work[row["frame_a"]], work[row["frame_b"]]
        if row["curve"] >= 0:
            _evaluate_track(tree, row, a, b)
            continue
        if row["type"] == TURN_ROW:
            _evaluate_turn(row, a, b)
            continue
        if row["roll"] > 0:
            _evaluate_rolling(row, a, b)
            continue
        direction = column(b["axes"], row["axis"])
        if row["type"] == VECTOR_ROW:
            direction = outward(b["axes"], triple(row["across"], 0))
        place = plus(triple(a["position"], 0), outward(a["axes"], triple(row["point_a"], 0)))
        other = plus(triple(b["position"], 0), outward(b["axes"], triple(row["point_b"], 0)))
        store(direction, row["direction"], 0)
        store(place, row["place"], 0)
        row["gap"] = dot(direction, minus(place, other))
        row["rate"] = dot(direction, _relative_velocity(a, b, place))


@kernel
def _evaluate_turn(row: np.void, a: np.void, b: np.void) -> None:
    """Set direction w x v, gap w . v - value and rate of a row that holds a turn."""
    w, v = outward(a["axes"], triple(row["point_a"], 0)), outward(b["axes"], triple(row["across"], 0))
    n = cross(w, v)
    store(n, row["direction"], 0)
    row["gap"] = dot(w, v) - row["value"]
    row["rate"] = dot(n, minus(triple(a["angular"], 0), triple(b["angular"], 0)))


@kernel
def _turn_acceleration(row: np.void, a: np.void, b: np.void) -> float:
    """Second derivative of w . v: (al_a - al_b) . n + (om_a - om_b) . n'."""
    w, v = outward(a["axes"], triple(row["point_a"], 0)), outward(b["axes"], triple(row["across"], 0))
    of_a, of_b = triple(a["angular"], 0), triple(b["angular"], 0)
    change = plus(cross(cross(of_a, w), v), cross(w, cross(of_b, v)))
    apart = minus(triple(a["acceleration"], 0), triple(b["acceleration"], 0))
    return dot(triple(row["direction"], 0), apart) + dot(change, minus(of_a, of_b))


@kernel
def _evaluate_coupling(tree: "TreeArrays", row: np.void, q: np.ndarray, y: np.ndarray) -> None:
    """Set gap and rate of a coupling; of a cam q_follower - f(q_cam) its factor -f', and what f'' adds."""
    factors, offset = tree.couplings[row["coupling"]], row["value"]
    row["bend"] = 0.0
    if row["curve"] >= 0:
        cam = row["cam"]
        value, slope, bend = function_values(tree.curves, tree.knots, row["curve"], q[cam])
        factors[cam] = -slope
        offset, row["bend"] = value - slope * q[cam], -bend * y[cam] * y[cam]
    row["gap"], row["rate"] = product(factors, q) - offset, product(factors, y)


@kernel
def _evaluate_track(tree: "TreeArrays", row: np.void, a: np.void, b: np.void) -> None:
    """Set what `evaluate_rows` does of a point on a curve, the curve's parameter and what c'' adds."""
    place = plus(triple(a["position"], 0), outward(a["axes"], triple(row["point_a"], 0)))
    p = minus(inward(b["axes"], minus(place, triple(b["position"], 0))), triple(row["point_b"], 0))
    s = nearest_parameter(tree.curves, tree.knots, row["curve"], p, row["parameter"])
    c, d, bend = curve_values(tree.curves, tree.knots, row["curve"], s)
    n = normal(d, triple(row["across"], 0), row["axis"])
    velocity = _relative_velocity(a, b, place)
    advance = dot(d, inward(b["axes"], velocity)) / stretch(d, bend, minus(p, c))
    row["parameter"], row["advance"] = s, advance
    store(outward(b["axes"], n), row["direction"], 0)
    store(place, row["place"], 0)
    row["gap"], row["rate"] = dot(n, minus(p, c)), dot(row["direction"], velocity)
    row["bend"] = -dot(n, bend) * advance * advance


@kernel
def _evaluate_rolling(row: np.void, a: np.void, b: np.void) -> None:
    """Set what `evaluate_rows` does of a rolling body, and what the way of the contact adds."""
    u, x = outward(b["axes"], triple(row["normal"], 0)), outward(a["axes"], triple(row["axle"], 0))
    centre = plus(triple(a["position"], 0), outward(a["axes"], triple(row["point_a"], 0)))
    origin = plus(triple(b["position"], 0), outward(b["axes"], triple(row["point_b"], 0)))
    kind, d, radius, other = row["roll"], minus(centre, origin), row["radius"][0], row["radius"][1]
    n, arm, gap = rolling_contact(kind, u, x, d, radius, other)
    place = plus(centre, arm)
    e = rolling_direction(kind, row["axis"], u, outward(b["axes"], triple(row["across"], 0)), n)
    w = minus(triple(a["angular"], 0), triple(b["angular"], 0))
    advance = contact_advance(kind, u, x, d, radius, other, w, _relative_velocity(a, b, centre))
    store(e, row["direction"], 0)
    store(place, row["place"], 0)
    row["gap"] = gap if row["axis"] == 0 else 0.0
    row["rate"] = dot(e, _relative_velocity(a, b, place))
    row["bend"] = dot(e, cross(w, advance))


@kernel
def _relative_velocity(
    a: np.void, b: np.void, place: tuple[float, float, float]
) -> tuple[float, float, float]:
    """Velocity of frame a at a place against that of frame b at the same place."""
    return minus(_velocity(a, place), _velocity(b, place))


@kernel
def _velocity(s: np.void, place: tuple[float, float, float]) -> tuple[float, float, float]:
    arm = minus(place, triple(s["position"], 0))
    return plus(triple(s["velocity"], 0), cross(triple(s["angular"], 0), arm))


@kernel
def _carried(s: np.void, motion: np.ndarray, place: tuple[float, float, float]) -> tuple[float, float, float]:
    """Linear part of `motion` (al, a) at a place of the frame."""
    arm = minus(place, triple(s["position"], 0))
    return plus(triple(motion, 3), cross(triple(motion, 0), arm))


@kernel
def _gap_acceleration(tree: "TreeArrays", work: np.ndarray, coordinates: np.ndarray, row: np.void) -> float:
    """Second derivative of the gap at the present accelerations."""
    if row["coupling"] >= 0:
        return _coupled(tree.couplings[row["coupling"]], coordinates["rate"]) + row["bend"]
    a, b, place = work[row["frame_a"]], work[row["frame_b"]], triple(row["place"], 0)
    if row["type"] == TURN_ROW:
        return _turn_acceleration(row, a, b)
    wa, wb = triple(a["angular"], 0), triple(b["angular"], 0)
    of_a = plus(
        _carried(a, a["acceleration"], place), centripetal(wa, minus(place, triple(a["position"], 0)))
    )
    of_b = plus(
        _carried(b, b["acceleration"], place), centripetal(wb, minus(place, triple(b["position"], 0)))
    )
    turning = scaled(2.0, cross(wb, _relative_velocity(a, b, place)))
    return dot(triple(row["direction"], 0), minus(minus(of_a, of_b), turning)) + row["bend"]


@kernel
def _gap_response(tree: "TreeArrays", work: np.ndarray, coordinates: np.ndarray, row: np.void) -> float:
    """Second derivative of the gap by the unit forces alone."""
    if row["coupling"] >= 0:
        return _coupled(tree.couplings[row["coupling"]], coordinates["response"])
    a, b, place = work[row["frame_a"]], work[row["frame_b"]], triple(row["place"], 0)
    if row["type"] == TURN_ROW:
        return dot(triple(row["direction"], 0), minus(triple(a["response"], 0), triple(b["response"], 0)))
    apart = minus(_carried(a, a["response"], place), _carried(b, b["response"], place))
    return dot(triple(row["direction"], 0), apart)


@kernel
def _coupled(factors: np.ndarray, values: np.ndarray) -> float:
    total = 0.0
    for m in range(factors.shape[0]):
        total += factors[m] * values[m]
    return total


@kernel
def add_closure_forces(tree: "TreeArrays", work: np.ndarray, q: np.ndarray, y: np.ndarray) -> None:
    """Subtract the constraint forces from the bias of the two frames of each closure."""
    if tree.closures.shape[0] == 0:
        return
    evaluate_rows(tree, work, q, y)
    for i in range(tree.closures.shape[0]):
        row = tree.closures[i]
        if row["coupling"] >= 0:
            continue
        force = scaled(row["force"], triple(row["direction"], 0))
        place = triple(row["place"], 0)
        if row["type"] == TURN_ROW:
            accumulate(scaled(-1.0, force), work[row["frame_a"]]["bias"], 0)
            if row["frame_b"] > 0:
                accumulate(force, work[row["frame_b"]]["bias"], 0)
            continue
        _load(work[row["frame_a"]], place, force)
        if row["frame_b"] > 0:
            _load(work[row["frame_b"]], place, scaled(-1.0, force))


@kernel
def _load(s: np.void, place: tuple[float, float, float], force: tuple[float, float, float]) -> None:
    arm = minus(place, triple(s["position"], 0))
    accumulate(scaled(-1.0, cross(arm, force)), s["bias"], 0)
    accumulate(scaled(-1.0, force), s["bias"], 3)


@kernel
def add_coupling_efforts(tree: "TreeArrays", coordinates: np.ndarray) -> None:
    """Add the efforts of couplings along the coordinates."""
    for i in range(tree.closures.shape[0]):
        row = tree.closures[i]
        if row["coupling"] >= 0:
            for m in range(coordinates.shape[0]):
                coordinates[m]["effort"] += row["force"] * tree.couplings[row["coupling"], m]


@kernel
def find_loop_forces(tree: "TreeArrays", work: np.ndarray, coordinates: np.ndarray) -> None:
    """Set the forces that take the gaps' accelerations away, from the solution with open loops."""
    closures = tree.closures
    _set_response_matrix(tree, work, coordinates)
    for i in range(closures.shape[0]):
        closures[i]["force"] = -_gap_acceleration(tree, work, coordinates, closures[i])
    solve_rows(closures, tree.closure_matrix)


@kernel
def find_loop_responses(tree: "TreeArrays", work: np.ndarray, coordinates: np.ndarray) -> None:
    """Set the forces that take the gaps' responses away, from those of the tree with open loops."""
    closures = tree.closures
    for i in range(closures.shape[0]):
        closures[i]["force"] = -_gap_response(tree, work, coordinates, closures[i])
    solve_rows(closures, tree.closure_matrix)


@kernel
def add_row_forces(tree: "TreeArrays", work: np.ndarray, coordinates: np.ndarray) -> None:
    """Add the forces of all rows to the unit forces."""
    for i in range(tree.closures.shape[0]):
        row = tree.closures[i]
        if row["coupling"] >= 0:
            for m in range(coordinates.shape[0]):
                coordinates[m]["unit_effort"] += row["force"] * tree.couplings[row["coupling"], m]
            continue
        force = scaled(row["force"], triple(row["direction"], 0))
        if row["type"] == TURN_ROW:
            accumulate(scaled(-1.0, force), work[row["frame_a"]]["unit_force"], 0)
            accumulate(force, work[row["frame_b"]]["unit_force"], 0)
            continue
        unit_force(work[row["frame_a"]], triple(row["place"], 0), force)
        unit_force(work[row["frame_b"]], triple(row["place"], 0), scaled(-1.0, force))


@kernel
def _set_response_matrix(tree: "TreeArrays", work: np.ndarray, coordinates: np.ndarray) -> None:
    """Fill and eliminate closure_matrix = J b^-1 Jᵀ for the last solution of the tree, without forces."""
    closures, matrix = tree.closures, tree.closure_matrix
    for j in range(closures.shape[0]):
        closures[j]["force"] = 1.0
        clear_unit_forces(work, coordinates)
        add_row_forces(tree, work, coordinates)
        closures[j]["force"] = 0.0
        respond(tree, work, coordinates)
        for i in range(closures.shape[0]):
            matrix[i, j] = _gap_response(tree, work, coordinates, closures[i])
    eliminate_rows(closures, matrix)


@kernel
def eliminate_rows(closures: np.ndarray, matrix: np.ndarray) -> None:
    """L D Lᵀ of a symmetric matrix with diagonal pivots; dependent rows get the pivot 0."""
    n = matrix.shape[0]
    largest = 0.0
    for i in range(n):
        closures[i]["own"] = matrix[i, i]
        closures[i]["order"] = i
        largest = max(largest, matrix[i, i])
    for k in range(n):
        _bring_best_pivot(closures, matrix, k)
        p = closures[k]["order"]
        if not matrix[p, p] > max(closures[p]["repeated"] * closures[p]["own"], IMMOBILE * largest):
            matrix[p, p] = 0.0
            continue
        for i in range(k + 1, n):
            r = closures[i]["order"]
            factor = matrix[r, p] / matrix[p, p]
            for j in range(k + 1, n):
                c = closures[j]["order"]
                matrix[r, c] -= factor * matrix[p, c]
            matrix[r, p] = factor


@kernel
def _bring_best_pivot(closures: np.ndarray, matrix: np.ndarray, k: int) -> None:
    """Exchange places in the order so that the row with the largest share of its own pivot is next."""
    best, share = k, -1.0
    for i in range(k, matrix.shape[0]):
        r = closures[i]["order"]
        left = matrix[r, r] / closures[r]["own"] if closures[r]["own"] > 0.0 else 0.0
        if left > share:
            best, share = i, left
    row = closures[best]["order"]
    closures[best]["order"] = closures[k]["order"]
    closures[k]["order"] = row


@kernel
def solve_rows(closures: np.ndarray, matrix: np.ndarray) -> None:
    """Replace the forces, which hold a right-hand side, by the solution; 0 for dependent rows."""
    n = matrix.shape[0]
    for k in range(n):
        p = closures[k]["order"]
        if matrix[p, p] == 0.0:
            continue
        for i in range(k + 1, n):
            r = closures[i]["order"]
            closures[r]["force"] -= matrix[r, p] * closures[p]["force"]
    for k in range(n - 1, -1, -1):
        p = closures[k]["order"]
        if matrix[p, p] == 0.0:
            closures[p]["force"] = 0.0
            continue
        closures[p]["force"] /= matrix[p, p]
        for i in range(k + 1, n):
            r = closures[i]["order"]
            closures[p]["force"] -= matrix[r, p] * closures[r]["force"]
