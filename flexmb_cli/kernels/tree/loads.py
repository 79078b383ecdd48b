"""Forces of elastic bodies along the coordinates, torques on bodies, prescribed motion.

DAFMS thesis (1992), generalised active forces, eqs. (3.8)-(3.13).
Geometric stiffening acts on the elastic coordinates only; its reaction on the body is of second
order in the displacements and left out, as is axial prestress by the acceleration of the body's origin.

`tree` is a `model.arrays.tree.TreeArrays`.
"""

from typing import TYPE_CHECKING

import numpy as np

from .._jit import part
from ..constrained.time_functions import function_values
from ..linalg.number_rows import product
from ..linalg.vec3 import dot, outward, triple

if TYPE_CHECKING:
    from ...model.arrays.tree import TreeArrays


@part
def coordinate_efforts(
    tree: "TreeArrays", work: np.ndarray, q: np.ndarray, y: np.ndarray, coordinates: np.ndarray
) -> None:
    """Set the effort of elastic bodies along each coordinate, frames being placed: -K u - D u'."""
    for m in range(coordinates.shape[0]):
        coordinates[m]["effort"] = 0.0
    for b in range(tree.elastic_bodies.shape[0]):
        body = tree.elastic_bodies[b]
        _subtract_product(1.0, tree.stiffness, body["stiffness"], body, tree.reach, q, coordinates)
        if body["damping"] >= 0:
            _subtract_product(1.0, tree.damping, body["damping"], body, tree.reach, y, coordinates)
        if body["stiffening"] >= 0:
            turning, weight = axial_prestress(tree, work, body)
            start = body["stiffening"]
            _subtract_product(turning, tree.stiffening, start, body, tree.reach, q, coordinates)
            _subtract_product(
                weight, tree.stiffening, start + body["count"] ** 2, body, tree.reach, q, coordinates
            )


@part
def axial_prestress(tree: "TreeArrays", work: np.ndarray, body: np.void) -> tuple[float, float]:
    """Return what prestresses a beam: square of the angular velocity across it, and gravity along it."""
    s = work[body["frame"]]
    along, w = outward(s["axes"], triple(body["beam"], 0)), triple(s["angular"], 0)
    return dot(w, w) - dot(w, along) ** 2, dot(triple(tree.gravity, 0), along)


@part
def _subtract_product(
    factor: float,
    matrices: np.ndarray,
    start: int,
    body: np.void,
    reach: np.ndarray,
    x: np.ndarray,
    coordinates: np.ndarray,
) -> None:
    """effort -= factor A x over one body's coordinates, A beginning at `start`."""
    for i in range(body["count"]):
        product = elastic_row_times(matrices, start, body, reach, i, x)
        coordinates[body["first"] + i]["effort"] -= factor * product


@part
def elastic_row_times(
    matrices: np.ndarray, start: int, body: np.void, reach: np.ndarray, i: int, x: np.ndarray
) -> float:
    """Row i of one body's matrix, which begins at `start`, times the body's part of x (NS,)."""
    first = body["first"]
    begin, end = reach[first + i, 0], reach[first + i, 1]
    row = start + i * body["count"]
    return product(matrices[row + begin : row + end], x[first + begin : first + end])


@part
def set_prescribed(
    tree: "TreeArrays", t: float, q: np.ndarray, y: np.ndarray, coordinates: np.ndarray
) -> None:
    """Put the prescribed coordinates C + B t + A t²/2, with their functions, and their rates in place."""
    for i in range(tree.prescribed.shape[0]):
        p = tree.prescribed[i]
        m = p["coordinate"]
        q[m] = p["C"] + t * (p["B"] + 0.5 * p["A"] * t)
        y[m] = p["B"] + p["A"] * t
        coordinates[m]["rate"] = p["A"]
        if p["function"] >= 0:
            value, rate, second = function_values(tree.curves, tree.knots, p["function"], min(t, p["until"]))
            q[m] += value
            y[m] += rate
            coordinates[m]["rate"] += second


@part
def add_body_torques(tree: "TreeArrays", t: float, work: np.ndarray) -> None:
    """Take the torque functions on bodies off p_n of their frames."""
    for i in range(tree.torques.shape[0]):
        torque = tree.torques[i]
        value = function_values(tree.curves, tree.knots, torque["function"], min(t, torque["until"]))[0]
        torque["value"] = torque["constant"] + value
        work[torque["frame"]]["bias"][torque["axis"]] -= torque["value"]
