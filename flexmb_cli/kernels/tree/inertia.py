"""Inertia and bias force of a frame, the nodal masses of a flexible body eliminated on the spot.

DAFMS thesis (1992), sections 3.2-3.3, eqs. (3.14) and (3.15), in recursive form: instead of the matrix b and
the columns f* and F, each frame collects the inertia and force its subtree shows at its origin while the
coordinates of that subtree stay free.  A nodal mass that is free along axis d shows no inertia along d,
only the elastic force; along the other axes it is carried with the body.
"""

import numpy as np

from .._jit import part
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
    symmetric,
    symmetric_times,
    triple,
)
from .kinematics import node_place, node_vector
from .work import H_, J_, M_


@part
def own_inertia(
    frame: np.void,
    s: np.void,
    nodal_masses: np.ndarray,
    gravity: np.ndarray,
    coordinates: np.ndarray,
    q: np.ndarray,
    y: np.ndarray,
) -> None:
    """Start inertia and bias of a frame with its own mass, loads and nodal masses."""
    if frame["nodal_masses"] == 0:
        _rigid_inertia(frame, s)
    else:
        _sum_nodal_masses(frame, s, nodal_masses, gravity, coordinates, q, y)
        _turn_sums(s)
    _add_rigid_bias(frame, s, gravity)


@part
def _rigid_inertia(frame: np.void, s: np.void) -> None:
    """J = S J S', H = [s x], M = m U; no bias yet."""
    out = s["inertia"]
    first, second = _rotated(s["axes"], symmetric(frame["inertia"], 0))
    store(first, out, J_)
    store(second, out, J_ + 3)
    x, y, z = outward(s["axes"], triple(frame["moment"], 0))
    m = frame["mass"]
    store((0.0, -z, y), out, H_)
    store((z, 0.0, -x), out, H_ + 3)
    store((-y, x, 0.0), out, H_ + 6)
    store((m, 0.0, 0.0), out, M_)
    store((m, 0.0, m), out, M_ + 3)
    for i in range(6):
        s["bias"][i] = 0.0


@part
def _rotated(
    A: np.ndarray,
    J: tuple[tuple[float, float, float], tuple[float, float, float], tuple[float, float, float]],
) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
    """The six numbers of S J S', in two triples, for the rows of a symmetric J."""
    a, b, c = triple(A, 0), triple(A, 3), triple(A, 6)
    x, y, z = symmetric_times(J, a), symmetric_times(J, b), symmetric_times(J, c)
    return (dot(a, x), dot(b, x), dot(c, x)), (dot(b, y), dot(c, y), dot(c, z))


@part
def _add_rigid_bias(frame: np.void, s: np.void, gravity: np.ndarray) -> None:
    """p_n = w x J w - s x g - M_k, p_f = w x (w x s) - m g - F_k of the frame without nodal masses."""
    w = triple(s["angular"], 0)
    g = triple(gravity, 0)
    moment = outward(s["axes"], triple(frame["moment"], 0))
    spin = symmetric_times(symmetric(frame["inertia"], 0), inward(s["axes"], w))
    n = minus(cross(w, outward(s["axes"], spin)), cross(moment, g))
    f = minus(centripetal(w, moment), scaled(frame["mass"], g))
    accumulate(minus(n, triple(frame["torque"], 0)), s["bias"], 0)
    accumulate(minus(f, triple(frame["force"], 0)), s["bias"], 3)


@part
def _sum_nodal_masses(
    frame: np.void,
    s: np.void,
    nodal_masses: np.ndarray,
    gravity: np.ndarray,
    coordinates: np.ndarray,
    q: np.ndarray,
    y: np.ndarray,
) -> None:
    """Sum the nodal masses in the body's axes."""
    w = inward(s["axes"], triple(s["angular"], 0))
    g = inward(s["axes"], triple(gravity, 0))
    _start_sums(frame, s)
    for i in range(frame["first_nodal_mass"], frame["first_nodal_mass"] + frame["nodal_masses"]):
        nodal_mass = nodal_masses[i]
        r = node_place(nodal_mass, q)
        c = plus(centripetal(w, r), scaled(2.0, cross(w, node_vector(nodal_mass, y))))
        load = plus(scaled(nodal_mass["mass"], g), inward(s["axes"], triple(nodal_mass["force"], 0)))
        _sum_nodal_mass(nodal_mass, r, c, load, s["inertia"], s["bias"], coordinates)


@part
def _start_sums(frame: np.void, s: np.void) -> None:
    """J and M of the frame without nodal masses, in its own axes; a flexible body has no first moment."""
    out = s["inertia"]
    for i in range(6):
        s["bias"][i] = 0.0
        out[J_ + i] = frame["inertia"][i]
    for i in range(H_, 21):
        out[i] = 0.0
    out[M_] = frame["mass"]
    out[M_ + 3] = frame["mass"]
    out[M_ + 5] = frame["mass"]


@part
def _sum_nodal_mass(
    nodal_mass: np.void,
    r: tuple[float, float, float],
    c: tuple[float, float, float],
    load: tuple[float, float, float],
    inertia: np.ndarray,
    bias: np.ndarray,
    coordinates: np.ndarray,
) -> None:
    """Add a nodal mass at r with acceleration remainder c under an external load."""
    m = nodal_mass["coordinate"]
    mass = nodal_mass["mass"]
    b0, f0 = _carried(mass, c[0], load[0], m[0], coordinates)
    b1, f1 = _carried(mass, c[1], load[1], m[1], coordinates)
    b2, f2 = _carried(mass, c[2], load[2], m[2], coordinates)
    force = (f0, f1, f2)
    accumulate(cross(r, force), bias, 0)
    accumulate(force, bias, 3)
    _add_carried(inertia, r, b0, b1, b2)


@part
def _carried(mass: float, c: float, load: float, m: int, coordinates: np.ndarray) -> tuple[float, float]:
    """Mass that the body carries along one axis, and the force it has to pass on to the nodal mass."""
    if m < 0:
        return mass, mass * c - load
    coordinate = coordinates[m]
    if coordinate["locked"] != 0:
        force = mass * (c + coordinate["rate"]) - load
        coordinate["drive"] = coordinate["effort"] - force
        return mass, force
    coordinate["drive"] = coordinate["effort"] + load - mass * c
    return 0.0, coordinate["effort"]


@part
def _add_carried(out: np.ndarray, r: tuple[float, float, float], b0: float, b1: float, b2: float) -> None:
    """J += [r x] B [r x]ᵀ, H += [r x] B, M += B with B = diag(b0, b1, b2)."""
    x, y, z = r
    out[J_] += z * z * b1 + y * y * b2
    out[J_ + 1] -= x * y * b2
    out[J_ + 2] -= x * z * b1
    out[J_ + 3] += z * z * b0 + x * x * b2
    out[J_ + 4] -= y * z * b0
    out[J_ + 5] += y * y * b0 + x * x * b1
    accumulate((0.0, -z * b1, y * b2), out, H_)
    accumulate((z * b0, 0.0, -x * b2), out, H_ + 3)
    accumulate((-y * b0, x * b1, 0.0), out, H_ + 6)
    out[M_] += b0
    out[M_ + 3] += b1
    out[M_ + 5] += b2


@part
def _turn_sums(s: np.void) -> None:
    """Turn the sums over nodal masses from the body's axes to inertial ones."""
    out, A = s["inertia"], s["axes"]
    for block in range(J_, M_ + 1, M_ - J_):
        first, second = _rotated(A, symmetric(out, block))
        store(first, out, block)
        store(second, out, block + 3)
    # S H S': columns first, then rows.
    a, b, c = outward(A, column(out, H_)), outward(A, column(out, H_ + 1)), outward(A, column(out, H_ + 2))
    for i in range(3):
        store(outward(A, (a[i], b[i], c[i])), out, H_ + 3 * i)
    store(outward(A, triple(s["bias"], 0)), s["bias"], 0)
    store(outward(A, triple(s["bias"], 3)), s["bias"], 3)
