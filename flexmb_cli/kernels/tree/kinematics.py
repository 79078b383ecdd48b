"""Outward pass of a tree: attitudes, positions, velocities and acceleration remainders.

DAFMS thesis (1992), sections 2.2-2.3: S_k = S_j TD_k TR_k (2.10), positions (2.32) and (2.33), angular
velocities (2.27) and (2.28), velocity (2.34), acceleration (2.41).  What the thesis leaves out is added: the
axis of a second rotation turns with the first, and the carried point moves with 2 w x u'.

`frame` is a record of `model.arrays.tree_frames.FRAME`; `s`, `parent` and `work` are records of FRAME_WORK,
`coordinates` of COORDINATE_WORK.
"""

import math
from typing import TYPE_CHECKING

import numpy as np

from .._jit import part
from ..linalg.vec3 import centripetal, column, cross, dot, outward, plus, scaled, store, triple

if TYPE_CHECKING:
    from ...model.arrays.tree import TreeArrays


@part
def place_frames(
    tree: "TreeArrays",
    work: np.ndarray,
    coordinates: np.ndarray,
    q: np.ndarray,
    y: np.ndarray,
    attitudes: np.ndarray,
) -> None:
    """Fill the kinematic part of `work` from coordinates, speeds and Euler parameters (balls, 4)."""
    for k in range(1, tree.frames.shape[0]):
        frame = tree.frames[k]
        parent = work[frame["parent"]]
        if frame["node_frame"] >= 0:
            _place_node_frame(
                frame,
                tree.node_frames.records[frame["node_frame"]],
                tree.node_frames.slopes,
                parent,
                work[k],
                q,
                y,
            )
            continue
        _set_hinge_axes(frame, parent, work[k])
        _turn_frame(frame, parent, work[k], coordinates, q, y, attitudes)
        _move_frame(frame, parent, work[k], coordinates, q, y)


@part
def _place_node_frame(
    frame: np.void,
    node_frame: np.void,
    slopes: np.ndarray,
    parent: np.void,
    s: np.void,
    q: np.ndarray,
    y: np.ndarray,
) -> None:
    """A node frame moves with its node and is turned by three successive rotations C w."""
    _copy_axes(parent["axes"], s["axes"])
    w = triple(parent["angular"], 0)
    rest = (0.0, 0.0, 0.0)
    for i in range(3):
        axis = column(s["axes"], i)
        store(axis, s["hinge_axes"], 3 * i)
        start = node_frame["slope"] + i * node_frame["count"]
        angle, rate = _slope(node_frame, slopes, start, q), _slope(node_frame, slopes, start, y)
        spin = scaled(rate, axis)
        rest = plus(rest, cross(w, spin))
        w = plus(w, spin)
        _turn_about(s["axes"], i, angle)
    store(w, s["angular"], 0)
    store(rest, s["remainder"], 0)
    place = plus(triple(frame["point"], 0), _along_axes(node_frame["node"], q))
    slide = outward(parent["axes"], _along_axes(node_frame["node"], y))
    _set_motion(parent, s, outward(parent["axes"], place), slide)


@part
def _slope(node_frame: np.void, slopes: np.ndarray, start: int, values: np.ndarray) -> float:
    """One row of C times the elastic coordinates or their speeds."""
    total = 0.0
    for m in range(node_frame["count"]):
        total += slopes[start + m] * values[node_frame["first"] + m]
    return total


@part
def _copy_axes(a: np.ndarray, b: np.ndarray) -> None:
    for i in range(9):
        b[i] = a[i]


@part
def _set_product(A: np.ndarray, B: np.ndarray | tuple[float, ...], out: np.ndarray) -> None:
    """out = A B for axes in rows of nine."""
    for row in range(0, 9, 3):
        a0, a1, a2 = A[row], A[row + 1], A[row + 2]
        for col in range(3):
            out[row + col] = a0 * B[col] + a1 * B[3 + col] + a2 * B[6 + col]


@part
def _set_hinge_axes(frame: np.void, parent: np.void, s: np.void) -> None:
    """S_j TD_k: the axes of P_k, from which those of O_k start."""
    if frame["framed"] != 0:
        _set_product(parent["axes"], frame["frame"], s["hinge_axes"])
    else:
        _copy_axes(parent["axes"], s["hinge_axes"])
    _copy_axes(s["hinge_axes"], s["axes"])


@part
def _turn_frame(
    frame: np.void,
    parent: np.void,
    s: np.void,
    coordinates: np.ndarray,
    q: np.ndarray,
    y: np.ndarray,
    attitudes: np.ndarray,
) -> None:
    """Set S_k, w_k, the axes of the rotations and the angular remainder of hinge k."""
    w = triple(parent["angular"], 0)
    rest = (0.0, 0.0, 0.0)
    first = frame["first_rotation"]
    if frame["ball"] >= 0:
        w, rest = _turn_ball(s, coordinates, first, y, w)
        _set_attitude(s, attitudes, frame["ball"])
    elif frame["turned"] != 0:
        _set_product(s["hinge_axes"], frame["attitude"], s["axes"])
    else:
        for i in range(frame["rotations"]):
            axis = frame["rotation_axes"][i]
            direction = column(s["axes"], axis)
            store(direction, coordinates[first + i]["direction"], 0)
            spin = scaled(y[first + i], direction)
            # w holds the rotations before this one: they turn this one's axis.
            rest = plus(rest, cross(w, spin))
            w = plus(w, spin)
            _turn_about(s["axes"], axis, q[first + i])
    store(w, s["angular"], 0)
    store(rest, s["remainder"], 0)


@part
def _turn_about(A: np.ndarray, axis: int, angle: float) -> None:
    """Turn axes A about one of themselves."""
    c, s = math.cos(angle), math.sin(angle)
    a = axis + 1 if axis < 2 else 0
    b = axis - 1 if axis > 0 else 2
    for row in range(0, 9, 3):
        x, z = A[row + a], A[row + b]
        A[row + a] = c * x + s * z
        A[row + b] = c * z - s * x


@part
def _turn_ball(
    s: np.void, coordinates: np.ndarray, first: int, y: np.ndarray, w: tuple[float, float, float]
) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
    """Three rotations: the speeds are the relative angular velocity in P_k axes."""
    for i in range(3):
        store(column(s["hinge_axes"], i), coordinates[first + i]["direction"], 0)
    spin = outward(s["hinge_axes"], triple(y, first))
    return plus(w, spin), cross(w, spin)


@part
def _set_attitude(s: np.void, attitudes: np.ndarray, ball: int) -> None:
    """S_k = P_k axes times the rotation of Euler parameters, which are taken as if of length one."""
    e0, e1, e2, e3 = attitudes[ball, 0], attitudes[ball, 1], attitudes[ball, 2], attitudes[ball, 3]
    f = 2.0 / (e0 * e0 + e1 * e1 + e2 * e2 + e3 * e3)
    turn = (
        1.0 - f * (e2 * e2 + e3 * e3),
        f * (e1 * e2 - e0 * e3),
        f * (e1 * e3 + e0 * e2),
        f * (e1 * e2 + e0 * e3),
        1.0 - f * (e1 * e1 + e3 * e3),
        f * (e2 * e3 - e0 * e1),
        f * (e1 * e3 - e0 * e2),
        f * (e2 * e3 + e0 * e1),
        1.0 - f * (e1 * e1 + e2 * e2),
    )
    _set_product(s["hinge_axes"], turn, s["axes"])


@part
def _move_frame(
    frame: np.void, parent: np.void, s: np.void, coordinates: np.ndarray, q: np.ndarray, y: np.ndarray
) -> None:
    """Set rho_k, p_k, v_k and the linear remainder."""
    offset = outward(parent["axes"], triple(frame["point"], 0))
    slide = (0.0, 0.0, 0.0)
    for i in range(frame["translations"]):
        m = frame["first_translation"] + i
        direction = column(s["hinge_axes"], frame["translation_axes"][i])
        store(direction, coordinates[m]["direction"], 0)
        offset = plus(offset, scaled(q[m], direction))
        slide = plus(slide, scaled(y[m], direction))
    _set_motion(parent, s, offset, slide)


@part
def _set_motion(
    parent: np.void, s: np.void, offset: tuple[float, float, float], slide: tuple[float, float, float]
) -> None:
    """Motion of an origin at `offset` from the parent's, which moves against the parent with `slide`."""
    w = triple(parent["angular"], 0)
    store(offset, s["offset"], 0)
    store(plus(triple(parent["position"], 0), offset), s["position"], 0)
    store(plus(triple(parent["velocity"], 0), plus(cross(w, offset), slide)), s["velocity"], 0)
    store(plus(centripetal(w, offset), scaled(2.0, cross(w, slide))), s["remainder"], 3)


@part
def node_place(nodal_mass: np.void, q: np.ndarray) -> tuple[float, float, float]:
    """Return r = x + u of a nodal mass in the axes of its body, m."""
    return plus(triple(nodal_mass["position"], 0), node_vector(nodal_mass, q))


@part
def node_vector(nodal_mass: np.void, values: np.ndarray) -> tuple[float, float, float]:
    """Return values (NS,) at a nodal mass's coordinates along axes 1, 2, 3; 0 where it is held."""
    return _along_axes(nodal_mass["coordinate"], values)


@part
def _along_axes(c: np.ndarray, values: np.ndarray) -> tuple[float, float, float]:
    return (
        values[c[0]] if c[0] >= 0 else 0.0,
        values[c[1]] if c[1] >= 0 else 0.0,
        values[c[2]] if c[2] >= 0 else 0.0,
    )


@part
def attitude_rates(frame: np.void, y: np.ndarray, attitudes: np.ndarray, rates: np.ndarray) -> None:
    """Fill rates[ball] with e0' = -e.s/2, e' = (e0 s - e x s)/2, s the speeds in P_k axes."""
    ball = frame["ball"]
    s = triple(y, frame["first_rotation"])
    e0 = attitudes[ball, 0]
    e = triple(attitudes[ball], 1)
    rates[ball, 0] = -0.5 * dot(e, s)
    store(scaled(0.5, plus(scaled(e0, s), cross(s, e))), rates[ball], 1)
