"""Kane's equations of a tree, b y' = F - f*, solved recursively at a cost linear in bodies and nodes.

DAFMS thesis (1992), chapter 3, with the terms its listing leaves out.  The matrix b is never formed:
eliminating the coordinates from the tips to the root is the factorization of b in the order of the
tree (Featherstone's articulated bodies).  A coordinate is either free, and its acceleration follows,
or locked: its acceleration is given, and the effort that enforces it follows.  All locked is
inverse dynamics.  The one-way motion of thesis 4.3 is two solutions: the rigid coordinates with the
elastic ones locked at rest, then the elastic ones with the rigid ones locked.
"""

from typing import TYPE_CHECKING

from .._jit import part
from ..linalg.vec3 import (
    accumulate,
    column,
    cross,
    dot,
    inward,
    plus,
    scaled,
    store,
    symmetric,
    symmetric_times,
    triple,
)
from .inertia import own_inertia
from .kinematics import node_place, place_frames
from .loads import add_body_torques, coordinate_efforts
from .loop_closures import add_closure_forces, clear_loop_forces, find_loop_forces
from .node_frames import absorb_node_frames, release_node_frames
from .work import H_, J_, M_

if TYPE_CHECKING:
    import numpy as np

    from ...model.arrays.tree import TreeArrays


SOLVED = -1

# A pivot below this part of the body's own inertia is round-off: nothing moves with the coordinate.
SMALLEST_HINGE_INERTIA = 1e-13


@part
def accelerations(
    tree: "TreeArrays",
    work: "np.ndarray",
    coordinates: "np.ndarray",
    t: float,
    q: "np.ndarray",
    y: "np.ndarray",
    attitudes: "np.ndarray",
) -> int:
    """Set coordinates["rate"], the y' of the state; returns SOLVED or the coordinate without inertia.

    q, y (NS,), attitudes (balls, 4).  The rate of a "held" coordinate is input.
    """
    clear_loop_forces(tree.closures)
    # One call of the solution only: a second would be compiled a second time.
    for turn in range(2):
        if not _prepare_turn(tree, work, coordinates, turn):
            break
        # Each time: accelerations of locked coordinates have joined the remainders of the hinges.
        place_frames(tree, work, coordinates, q, y, attitudes)
        if turn == 0:
            coordinate_efforts(tree, work, t, q, y, coordinates)
        fault = solve_tree(tree, work, coordinates, t, q, y)
        if fault != SOLVED:
            return fault
    return SOLVED


@part
def _prepare_turn(tree: "TreeArrays", work: "np.ndarray", coordinates: "np.ndarray", turn: int) -> bool:
    """Lock and load the tree for the first or second solution; False when no second one is needed."""
    if turn == 1 and not tree.one_way:
        if tree.closures.shape[0] > 0:
            find_loop_forces(tree, work, coordinates)
        return tree.closures.shape[0] > 0
    for m in range(coordinates.shape[0]):
        c = coordinates[m]
        c["locked"] = c["held"]
        if tree.one_way:
            c["locked"] = (c["held"] != 0 or tree.elastic[m]) if turn == 0 else not tree.elastic[m]
            if turn == 0 and tree.elastic[m]:
                c["rate"] = 0.0
    return True


@part
def solve_tree(
    tree: "TreeArrays",
    work: "np.ndarray",
    coordinates: "np.ndarray",
    t: float,
    q: "np.ndarray",
    y: "np.ndarray",
) -> int:
    """Rates of the free coordinates, and in "drive" the efforts that hold the locked ones to theirs.

    Expects frames just placed and the efforts along the coordinates; returns as `accelerations`.
    """
    frames = tree.frames
    for k in range(1, frames.shape[0]):
        own_inertia(frames[k], work[k], tree.nodal_masses, tree.gravity, coordinates, q, y)
    add_body_torques(tree, t, work)
    add_closure_forces(tree.closures, work)
    for k in range(frames.shape[0] - 1, 0, -1):
        if frames[k]["flexible_parent"] >= 0:
            absorb_node_frames(
                tree, tree.node_frames.bodies[frames[k]["flexible_parent"]], work, coordinates, q
            )
        fault = _eliminate_hinge(frames[k], work[k], coordinates, tree.inertia_scale)
        if fault != SOLVED:
            return fault
        if frames[k]["parent"] > 0 and frames[k]["node_frame"] < 0:
            _hand_over(work[k], work[frames[k]["parent"]])
    for k in range(1, frames.shape[0]):
        if frames[k]["node_frame"] >= 0:
            continue
        _accelerate_frame(frames[k], work[frames[k]["parent"]], work[k], coordinates)
        if frames[k]["flexible_parent"] >= 0:
            release_node_frames(
                tree, tree.node_frames.bodies[frames[k]["flexible_parent"]], work, coordinates
            )
        if frames[k]["nodal_masses"] > 0:
            _accelerate_nodes(frames[k], work[k], tree.nodal_masses, q, coordinates)
    return SOLVED


@part
def _eliminate_hinge(frame: "np.void", s: "np.void", coordinates: "np.ndarray", scale: "np.ndarray") -> int:
    """Free the inertia of a frame from its hinge coordinates, one by one."""
    for i in range(frame["rotations"]):
        m = frame["first_rotation"] + i
        _couple_rotation(s["inertia"], coordinates[m])
        if not _eliminate(s, coordinates[m], 0, scale[m]):
            return m
    for i in range(frame["translations"]):
        m = frame["first_translation"] + i
        _couple_translation(s["inertia"], coordinates[m])
        if not _eliminate(s, coordinates[m], 3, scale[m]):
            return m
    return SOLVED


@part
def _couple_rotation(I: "np.ndarray", c: "np.void") -> None:
    axis = triple(c["direction"], 0)
    store(symmetric_times(symmetric(I, J_), axis), c["coupling"], 0)
    store(_transposed_H(I, axis), c["coupling"], 3)


@part
def _couple_translation(I: "np.ndarray", c: "np.void") -> None:
    axis = triple(c["direction"], 0)
    store(_times_H(I, axis), c["coupling"], 0)
    store(symmetric_times(symmetric(I, M_), axis), c["coupling"], 3)


@part
def _times_H(I: "np.ndarray", v: tuple[float, float, float]) -> tuple[float, float, float]:
    return (dot(triple(I, H_), v), dot(triple(I, H_ + 3), v), dot(triple(I, H_ + 6), v))


@part
def _transposed_H(I: "np.ndarray", v: tuple[float, float, float]) -> tuple[float, float, float]:
    return (dot(column(I, H_), v), dot(column(I, H_ + 1), v), dot(column(I, H_ + 2), v))


@part
def _eliminate(s: "np.void", c: "np.void", part: int, scale: float) -> bool:
    """Take a coordinate out of inertia and bias; False when it has no positive inertia.

    `part` is 0 for a rotation, 3 for a translation.  A locked coordinate stays in the inertia, and
    its acceleration joins the hinge's remainder.
    """
    axis = triple(c["direction"], 0)
    bias = s["bias"]
    c["drive"] = c["effort"] - dot(axis, triple(bias, part))
    if c["locked"] != 0:
        accumulate(scaled(c["rate"], axis), s["remainder"], part)
        return True
    n, f = triple(c["coupling"], 0), triple(c["coupling"], 3)
    pivot = dot(axis, triple(c["coupling"], part))
    if not pivot > SMALLEST_HINGE_INERTIA * scale:
        return False
    c["pivot"] = pivot
    _subtract_outer(s["inertia"], n, f, 1.0 / pivot)
    gain = c["drive"] / pivot
    accumulate(scaled(gain, n), bias, 0)
    accumulate(scaled(gain, f), bias, 3)
    return True


@part
def _subtract_outer(
    I: "np.ndarray", n: tuple[float, float, float], f: tuple[float, float, float], c: float
) -> None:
    """I -= c U Uᵀ with U = (n, f)."""
    a = scaled(-c, n)
    b = scaled(-c, f)
    accumulate((a[0] * n[0], a[0] * n[1], a[0] * n[2]), I, J_)
    accumulate((a[1] * n[1], a[1] * n[2], a[2] * n[2]), I, J_ + 3)
    accumulate(scaled(a[0], f), I, H_)
    accumulate(scaled(a[1], f), I, H_ + 3)
    accumulate(scaled(a[2], f), I, H_ + 6)
    accumulate((b[0] * f[0], b[0] * f[1], b[0] * f[2]), I, M_)
    accumulate((b[1] * f[1], b[1] * f[2], b[2] * f[2]), I, M_ + 3)


@part
def _hand_over(s: "np.void", parent: "np.void") -> None:
    """Add what is left of a frame to its parent, seen from the parent's origin."""
    I = s["inertia"]
    r = triple(s["offset"], 0)
    al, a = triple(s["remainder"], 0), triple(s["remainder"], 3)
    n = plus(symmetric_times(symmetric(I, J_), al), _times_H(I, a))
    f = plus(_transposed_H(I, al), symmetric_times(symmetric(I, M_), a))
    f = plus(f, triple(s["bias"], 3))
    accumulate(plus(n, plus(triple(s["bias"], 0), cross(r, f))), parent["bias"], 0)
    accumulate(f, parent["bias"], 3)
    _add_shifted(I, r, parent["inertia"])


@part
def _add_shifted(I: "np.ndarray", r: tuple[float, float, float], out: "np.ndarray") -> None:
    """Add to `out` the inertia I seen from a point that lies -r away: with R = [r x],

    M' = M, H' = H + R M, J' = J + R H'ᵀ + H Rᵀ.
    """
    m0, m1, m2 = symmetric(I, M_)
    h0, h1, h2 = triple(I, H_), triple(I, H_ + 3), triple(I, H_ + 6)
    # Columns of R M are r x (columns of M), and M is symmetric.
    c0, c1, c2 = cross(r, m0), cross(r, m1), cross(r, m2)
    s0 = plus(h0, (c0[0], c1[0], c2[0]))
    s1 = plus(h1, (c0[1], c1[1], c2[1]))
    s2 = plus(h2, (c0[2], c1[2], c2[2]))
    # Columns of R H'ᵀ are r x (rows of H'), rows of H Rᵀ are r x (rows of H).
    d0, d1, d2 = cross(r, s0), cross(r, s1), cross(r, s2)
    e0, e1, e2 = cross(r, h0), cross(r, h1), cross(r, h2)
    for i in range(6):
        out[J_ + i] += I[J_ + i]
        out[M_ + i] += I[M_ + i]
    accumulate((d0[0] + e0[0], d1[0] + e0[1], d2[0] + e0[2]), out, J_)
    accumulate((d1[1] + e1[1], d2[1] + e1[2], d2[2] + e2[2]), out, J_ + 3)
    accumulate(s0, out, H_)
    accumulate(s1, out, H_ + 3)
    accumulate(s2, out, H_ + 6)


@part
def _accelerate_frame(frame: "np.void", parent: "np.void", s: "np.void", coordinates: "np.ndarray") -> None:
    """Accelerations of the hinge coordinates and of the origin, from those of the parent."""
    turn = triple(parent["acceleration"], 0)
    al = plus(triple(s["remainder"], 0), turn)
    a = plus(triple(parent["acceleration"], 3), cross(turn, triple(s["offset"], 0)))
    a = plus(a, triple(s["remainder"], 3))
    # The coordinate eliminated last is solved first.
    for i in range(frame["translations"] - 1, -1, -1):
        c = coordinates[frame["first_translation"] + i]
        a = plus(a, scaled(_solve_coordinate(c, al, a), triple(c["direction"], 0)))
    for i in range(frame["rotations"] - 1, -1, -1):
        c = coordinates[frame["first_rotation"] + i]
        al = plus(al, scaled(_solve_coordinate(c, al, a), triple(c["direction"], 0)))
    store(al, s["acceleration"], 0)
    store(a, s["acceleration"], 3)


@part
def _solve_coordinate(c: "np.void", al: tuple[float, float, float], a: tuple[float, float, float]) -> float:
    """Return what a coordinate adds to the acceleration along its axis; the effort when it is locked."""
    carried = dot(triple(c["coupling"], 0), al) + dot(triple(c["coupling"], 3), a)
    if c["locked"] != 0:
        c["drive"] = carried - c["drive"]
        return 0.0
    c["rate"] = (c["drive"] - carried) / c["pivot"]
    return c["rate"]


@part
def _accelerate_nodes(
    frame: "np.void", s: "np.void", nodal_masses: "np.ndarray", q: "np.ndarray", coordinates: "np.ndarray"
) -> None:
    """Accelerations of the nodal masses of a flexible body against it."""
    al = inward(s["axes"], triple(s["acceleration"], 0))
    a = inward(s["axes"], triple(s["acceleration"], 3))
    for i in range(frame["first_nodal_mass"], frame["first_nodal_mass"] + frame["nodal_masses"]):
        nodal_mass = nodal_masses[i]
        carried = plus(a, cross(al, node_place(nodal_mass, q)))
        for axis in range(3):
            m = nodal_mass["coordinate"][axis]
            if m >= 0:
                _accelerate_node(coordinates[m], nodal_mass["mass"], carried[axis])


@part
def _accelerate_node(c: "np.void", mass: float, carried: float) -> None:
    if c["locked"] != 0:
        c["drive"] = mass * carried - c["drive"]
    else:
        c["rate"] = c["drive"] / mass - carried
