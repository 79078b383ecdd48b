"""Kane's equations of a tree, b y' = F - f*, solved recursively at a cost linear in bodies and nodes.

DAFMS thesis (1992), chapter 3, eqs. (3.7) and (3.16), with the terms its listing leaves out.  Partial
velocities, (2.35)-(2.38), are not stored: the recursion carries vectors from frame to frame.  The matrix b
is never formed: eliminating the coordinates from the tips to the root is the factorization of b in the order
of the tree (Featherstone's articulated bodies).  A coordinate is either free, and its acceleration follows,
or locked: its acceleration is given, and the effort that enforces it follows.  All locked is inverse
dynamics.  Forces of loops, couplings and friction follow from a solution without them, and take a second.
The one-way motion of thesis 4.3 solves for the rigid coordinates with the elastic ones locked at rest, then
for the elastic ones with the rigid ones locked.
"""

from typing import TYPE_CHECKING

import numpy as np

from .._jit import part
from ..linalg.vec3 import accumulate, cross, dot, inward, plus, scaled, store, triple
from .articulated_inertia import add_to_parent, couple_rotation, couple_translation, subtract_outer
from .elements import add_element_wrenches, answer_elements
from .friction import add_friction_efforts, answer_frictions, find_normal_forces
from .hinge_forces import set_reactions
from .inertia import own_inertia
from .kinematics import node_place, place_frames
from .loads import add_body_torques, coordinate_efforts
from .loop_closures import add_closure_forces, add_coupling_efforts, clear_loop_forces, find_loop_forces
from .node_frames import absorb_node_frames, release_node_frames

if TYPE_CHECKING:
    from ...model.arrays.tree import TreeArrays


SOLVED = -1
OPEN, CLOSED, ELASTIC = (
    0,
    1,
    2,
)  # solutions: without forces of loops and friction, with them, of one-way motion

# A pivot below this part of the body's own inertia is round-off: nothing moves with the coordinate.
SMALLEST_HINGE_INERTIA = 1e-13


@part
def accelerations(
    tree: "TreeArrays",
    work: np.ndarray,
    coordinates: np.ndarray,
    t: float,
    q: np.ndarray,
    y: np.ndarray,
    attitudes: np.ndarray,
) -> int:
    """Set coordinates["rate"], the y' of the state; returns SOLVED or the coordinate without inertia.

    q, y (NS,), attitudes (balls, 4).  The rate of a "held" coordinate is input.
    """
    clear_loop_forces(tree.closures)
    # One call of the solution only: another would be compiled another time.
    for solution in (OPEN, CLOSED, ELASTIC):
        if not _prepare_solution(tree, work, coordinates, solution):
            continue
        # Each time: accelerations of locked coordinates have joined the remainders of the hinges.
        place_frames(tree, work, coordinates, q, y, attitudes)
        if solution == OPEN:
            coordinate_efforts(tree, work, q, y, coordinates)
            answer_elements(tree, work, t, q, y, coordinates)
            answer_frictions(tree, y)
        fault = solve_tree(tree, work, coordinates, t, q, y)
        if fault != SOLVED:
            return fault
    return SOLVED


@part
def _prepare_solution(tree: "TreeArrays", work: np.ndarray, coordinates: np.ndarray, solution: int) -> bool:
    """Lock and load the tree for a solution; False when it is not needed."""
    if solution == CLOSED:
        return _find_internal_forces(tree, work, coordinates)
    if solution == ELASTIC:
        if not tree.one_way:
            return False
        set_reactions(tree, work)
    for m in range(coordinates.shape[0]):
        c = coordinates[m]
        c["locked"] = c["held"]
        if tree.one_way:
            c["locked"] = (c["held"] != 0 or tree.elastic[m]) if solution == OPEN else not tree.elastic[m]
            if solution == OPEN and tree.elastic[m]:
                c["rate"] = 0.0
    return True


@part
def _find_internal_forces(tree: "TreeArrays", work: np.ndarray, coordinates: np.ndarray) -> bool:
    """Find the forces of loops, couplings and friction; return whether there are any."""
    rows, frictions = tree.closures.shape[0], tree.frictions.shape[0]
    if rows > 0:
        find_loop_forces(tree, work, coordinates)
    if frictions > 0:
        find_normal_forces(tree, work, coordinates)
        add_friction_efforts(tree, coordinates)
    if rows > 0:
        add_coupling_efforts(tree, coordinates)
    return rows + frictions > 0


@part
def solve_tree(
    tree: "TreeArrays", work: np.ndarray, coordinates: np.ndarray, t: float, q: np.ndarray, y: np.ndarray
) -> int:
    """Rates of the free coordinates, and in "drive" the efforts that hold the locked ones to theirs.

    Expects frames just placed and the efforts along the coordinates; returns as `accelerations`.
    """
    frames = tree.frames
    for k in range(1, frames.shape[0]):
        own_inertia(frames[k], work[k], tree.nodal_masses, tree.gravity, coordinates, q, y)
    add_body_torques(tree, t, work)
    add_closure_forces(tree, work, q, y)
    add_element_wrenches(tree, work)
    for k in range(frames.shape[0] - 1, 0, -1):
        if frames[k]["flexible_parent"] >= 0:
            absorb_node_frames(
                tree, tree.node_frames.bodies[frames[k]["flexible_parent"]], work, coordinates, q
            )
        fault = _eliminate_hinge(frames[k], work[k], coordinates, tree.inertia_scale)
        if fault != SOLVED:
            return fault
        if frames[k]["parent"] > 0 and frames[k]["node_frame"] < 0:
            add_to_parent(work[k], work[frames[k]["parent"]])
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
def _eliminate_hinge(frame: np.void, s: np.void, coordinates: np.ndarray, scale: np.ndarray) -> int:
    """Free the inertia of a frame from its hinge coordinates, one by one."""
    for i in range(frame["rotations"]):
        m = frame["first_rotation"] + i
        couple_rotation(s["inertia"], coordinates[m])
        if not _eliminate(s, coordinates[m], 0, scale[m]):
            return m
    for i in range(frame["translations"]):
        m = frame["first_translation"] + i
        couple_translation(s["inertia"], coordinates[m])
        if not _eliminate(s, coordinates[m], 3, scale[m]):
            return m
    return SOLVED


@part
def _eliminate(s: np.void, c: np.void, part: int, scale: float) -> bool:
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
    subtract_outer(s["inertia"], n, f, 1.0 / pivot)
    gain = c["drive"] / pivot
    accumulate(scaled(gain, n), bias, 0)
    accumulate(scaled(gain, f), bias, 3)
    return True


@part
def _accelerate_frame(frame: np.void, parent: np.void, s: np.void, coordinates: np.ndarray) -> None:
    """Accelerations of the hinge coordinates and of the origin, from those of the parent."""
    alpha_parent = triple(parent["acceleration"], 0)
    al = plus(triple(s["remainder"], 0), alpha_parent)
    a = plus(triple(parent["acceleration"], 3), cross(alpha_parent, triple(s["offset"], 0)))
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
def _solve_coordinate(c: np.void, al: tuple[float, float, float], a: tuple[float, float, float]) -> float:
    """Return what a coordinate adds to the acceleration along its axis; the effort when it is locked."""
    carried = dot(triple(c["coupling"], 0), al) + dot(triple(c["coupling"], 3), a)
    if c["locked"] != 0:
        c["drive"] = carried - c["drive"]
        return 0.0
    c["rate"] = (c["drive"] - carried) / c["pivot"]
    return c["rate"]


@part
def _accelerate_nodes(
    frame: np.void, s: np.void, nodal_masses: np.ndarray, q: np.ndarray, coordinates: np.ndarray
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
def _accelerate_node(c: np.void, mass: float, carried: float) -> None:
    if c["locked"] != 0:
        c["drive"] = mass * carried - c["drive"]
    else:
        c["rate"] = c["drive"] / mass - carried
