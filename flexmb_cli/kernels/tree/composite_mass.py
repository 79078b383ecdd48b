"""The matrix b of a tree, and what a force on a frame does along every coordinate.

Composite rigid bodies (Featherstone, Rigid Body Dynamics Algorithms, 2008, section 6.2): with all
coordinates locked, each frame shows the inertia of everything beyond it; a unit acceleration along a
coordinate needs one wrench there, which acts along every coordinate on the way to the root.  The cost
is that of the entries which are not zero.
"""

from typing import TYPE_CHECKING

import numpy as np

from .._jit import kernel, part
from ..linalg.vec3 import column, cross, dot, outward, plus, scaled, triple
from .kane import solve_tree
from .kinematics import node_place, place_frames
from .motion import parts

if TYPE_CHECKING:
    from ...model.arrays.node_frames import NodeFrames
    from ...model.arrays.tree import TreeArrays


@kernel
def set_mass(
    tree: "TreeArrays", work: np.ndarray, coordinates: np.ndarray, z: np.ndarray, mass: np.ndarray
) -> None:
    """Fill the upper triangle of mass (NS, NS) with b at the state z.

    Prescribed coordinates get rows and columns of the unit matrix.
    """
    y, q, attitudes = parts(tree, z)
    for m in range(coordinates.shape[0]):
        coordinates[m]["effort"], coordinates[m]["rate"], coordinates[m]["locked"] = 0.0, 0.0, 1
    place_frames(tree, work, coordinates, q, y, attitudes)
    solve_tree(tree, work, coordinates, 0.0, q, y)
    mass.fill(0.0)
    for k in range(1, tree.frames.shape[0]):
        frame = tree.frames[k]
        if frame["node_frame"] >= 0:
            continue
        _set_hinge_rows(tree, work, coordinates, k, mass)
        for i in range(frame["first_nodal_mass"], frame["first_nodal_mass"] + frame["nodal_masses"]):
            _set_node_rows(tree, work, coordinates, k, tree.nodal_masses[i], q, mass)
        if frame["flexible_parent"] >= 0:
            _add_node_frame_rows(
                tree, work, coordinates, tree.node_frames.bodies[frame["flexible_parent"]], mass
            )
    _complete(tree, mass)


@part
def _set_hinge_rows(
    tree: "TreeArrays", work: np.ndarray, coordinates: np.ndarray, k: int, mass: np.ndarray
) -> None:
    """Rows of the hinge coordinates of frame k, from the couplings that the solution left."""
    frame = tree.frames[k]
    for i in range(frame["rotations"] + frame["translations"]):
        m = frame["first_rotation"] + i
        if i >= frame["rotations"]:
            m = frame["first_translation"] + i - frame["rotations"]
        coupling = coordinates[m]["coupling"]
        add_generalised_forces(tree, work, coordinates, k, triple(coupling, 0), triple(coupling, 3), mass[m])


@part
def _set_node_rows(
    tree: "TreeArrays",
    work: np.ndarray,
    coordinates: np.ndarray,
    k: int,
    nodal_mass: np.void,
    q: np.ndarray,
    mass: np.ndarray,
) -> None:
    place = outward(work[k]["axes"], node_place(nodal_mass, q))
    for axis in range(3):
        m = nodal_mass["coordinate"][axis]
        if m >= 0:
            f = scaled(nodal_mass["mass"], column(work[k]["axes"], axis))
            mass[m, m] = nodal_mass["mass"]
            add_generalised_forces(tree, work, coordinates, k, cross(place, f), f, mass[m])


@part
def _add_node_frame_rows(
    tree: "TreeArrays", work: np.ndarray, coordinates: np.ndarray, body: np.void, mass: np.ndarray
) -> None:
    """Return what the node frames of a body carry resists its elastic coordinates."""
    node_frames, first = tree.node_frames, body["first"]
    for r in range(body["first_node_frame"], body["first_node_frame"] + body["node_frames"]):
        k = node_frames.records[r]["frame"]
        for m in range(body["count"]):
            n, f = _node_frame_rows(node_frames, r, m, 0), _node_frame_rows(node_frames, r, m, 3)
            add_generalised_forces(tree, work, coordinates, k, n, f, mass[first + m])


@kernel
def _node_frame_rows(node_frames: "NodeFrames", r: int, m: int, part: int) -> tuple[float, float, float]:
    """Three rows of (inertia of what hangs on node frame r) times (its motion by coordinate m)."""
    return (
        _node_frame_row(node_frames, 6 * r, 6 * r + part, m),
        _node_frame_row(node_frames, 6 * r, 6 * r + part + 1, m),
        _node_frame_row(node_frames, 6 * r, 6 * r + part + 2, m),
    )


@kernel
def _node_frame_row(node_frames: "NodeFrames", start: int, row: int, m: int) -> float:
    total = 0.0
    for i in range(6):
        total += node_frames.own[row, i] * node_frames.motion[start + i, m]
    return total


@kernel
def add_generalised_forces(
    tree: "TreeArrays",
    work: np.ndarray,
    coordinates: np.ndarray,
    k: int,
    n: tuple[float, float, float],
    f: tuple[float, float, float],
    forces: np.ndarray,
) -> None:
    """Add to forces (NS,) what all coordinates feel of the moment n and force f at the origin of frame k."""
    while k > 0:
        frame, s = tree.frames[k], work[k]
        if frame["node_frame"] >= 0:
            _add_generalised_forces_by_nodes(tree.node_frames, frame["node_frame"], n, f, forces)
        for i in range(frame["rotations"]):
            m = frame["first_rotation"] + i
            forces[m] += dot(triple(coordinates[m]["direction"], 0), n)
        for i in range(frame["translations"]):
            m = frame["first_translation"] + i
            forces[m] += dot(triple(coordinates[m]["direction"], 0), f)
        n = plus(n, cross(triple(s["offset"], 0), f))
        k = frame["parent"]


@part
def _add_generalised_forces_by_nodes(
    node_frames: "NodeFrames",
    r: int,
    n: tuple[float, float, float],
    f: tuple[float, float, float],
    forces: np.ndarray,
) -> None:
    """The elastic coordinates of its body move a node frame by D."""
    D, first = node_frames.motion, node_frames.records[r]["first"]
    for m in range(node_frames.records[r]["count"]):
        for i in range(3):
            forces[first + m] += D[6 * r + i, m] * n[i] + D[6 * r + 3 + i, m] * f[i]


@part
def _complete(tree: "TreeArrays", mass: np.ndarray) -> None:
    """Bring entries below the diagonal above it; a coordinate further out may have the smaller number."""
    n = mass.shape[0]
    for i in range(n):
        for j in range(i):
            if mass[i, j] != 0.0:
                mass[j, i] = mass[i, j]
    for i in range(n):
        if tree.given[i]:
            mass[:i, i] = 0.0
            mass[i, i:] = 0.0
            mass[i, i] = 1.0
