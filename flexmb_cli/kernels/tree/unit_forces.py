"""Response of a tree to forces on frames and efforts along hinge coordinates alone: b^-1 Jᵀ, without loads.

Uses the inertias, couplings and pivots that the last solution of the tree left behind, so that a
force costs a fraction of a solution.
"""

from typing import TYPE_CHECKING

import numpy as np

from .._jit import part
from ..linalg.vec3 import accumulate, cross, dot, inward, minus, plus, scaled, store, triple
from .kinematics import node_place
from .node_frames import absorb_unit_forces, follow_node_frames, node_frame_share

if TYPE_CHECKING:
    from ...model.arrays.tree import TreeArrays


@part
def clear_unit_forces(work: np.ndarray, coordinates: np.ndarray) -> None:
    """Set the unit forces on all frames, and the unit efforts along all coordinates, to zero."""
    for m in range(coordinates.shape[0]):
        coordinates[m]["unit_effort"] = 0.0
    for k in range(work.shape[0]):
        for i in range(6):
            work[k]["unit_force"][i] = 0.0


@part
def unit_force(s: np.void, place: tuple[float, float, float], force: tuple[float, float, float]) -> None:
    """Add a force at a place, both in inertial axes, to the unit forces of a frame."""
    arm = minus(place, triple(s["position"], 0))
    accumulate(scaled(-1.0, cross(arm, force)), s["unit_force"], 0)
    accumulate(scaled(-1.0, force), s["unit_force"], 3)


@part
def respond(tree: "TreeArrays", work: np.ndarray, coordinates: np.ndarray) -> None:
    """Set the responses of frames and hinge coordinates to the unit forces; locked coordinates do not
    move.
    """
    frames = tree.frames
    for k in range(frames.shape[0] - 1, 0, -1):
        if frames[k]["node_frame"] >= 0:
            continue
        if frames[k]["flexible_parent"] >= 0:
            absorb_unit_forces(tree, tree.node_frames.bodies[frames[k]["flexible_parent"]], work)
        _take_up(frames[k], work[k], coordinates)
        _pass_on(work[k], work[frames[k]["parent"]])
    for k in range(1, frames.shape[0]):
        if frames[k]["node_frame"] >= 0:
            continue
        _follow(frames[k], work[frames[k]["parent"]], work[k], coordinates)
        if frames[k]["flexible_parent"] >= 0:
            follow_node_frames(tree, tree.node_frames.bodies[frames[k]["flexible_parent"]], work)


@part
def _take_up(frame: np.void, s: np.void, coordinates: np.ndarray) -> None:
    for i in range(frame["rotations"]):
        _yield_to(s["unit_force"], coordinates[frame["first_rotation"] + i], 0)
    for i in range(frame["translations"]):
        _yield_to(s["unit_force"], coordinates[frame["first_translation"] + i], 3)


@part
def _yield_to(forces: np.ndarray, c: np.void, part: int) -> None:
    """Take out of the unit forces what a free coordinate does not transmit."""
    if c["locked"] != 0:
        return
    c["response"] = c["unit_effort"] - dot(triple(c["direction"], 0), triple(forces, part))
    gain = c["response"] / c["pivot"]
    for i in range(6):
        forces[i] += gain * c["coupling"][i]


@part
def _pass_on(s: np.void, parent: np.void) -> None:
    n, f = triple(s["unit_force"], 0), triple(s["unit_force"], 3)
    accumulate(plus(n, cross(triple(s["offset"], 0), f)), parent["unit_force"], 0)
    accumulate(f, parent["unit_force"], 3)


@part
def _follow(frame: np.void, parent: np.void, s: np.void, coordinates: np.ndarray) -> None:
    """Response of a frame and its hinge coordinates from that of the parent."""
    al = triple(parent["response"], 0)
    a = plus(triple(parent["response"], 3), cross(al, triple(s["offset"], 0)))
    for i in range(frame["translations"] - 1, -1, -1):
        c = coordinates[frame["first_translation"] + i]
        a = plus(a, scaled(_own_response(c, al, a), triple(c["direction"], 0)))
    for i in range(frame["rotations"] - 1, -1, -1):
        c = coordinates[frame["first_rotation"] + i]
        al = plus(al, scaled(_own_response(c, al, a), triple(c["direction"], 0)))
    store(al, s["response"], 0)
    store(a, s["response"], 3)


@part
def _own_response(c: np.void, al: tuple[float, float, float], a: tuple[float, float, float]) -> float:
    if c["locked"] != 0:
        c["response"] = 0.0
    else:
        carried = dot(triple(c["coupling"], 0), al) + dot(triple(c["coupling"], 3), a)
        c["response"] = (c["response"] - carried) / c["pivot"]
    return c["response"]


@part
def respond_nodes(tree: "TreeArrays", work: np.ndarray, coordinates: np.ndarray, q: np.ndarray) -> None:
    """Set the responses of the nodal masses' coordinates, those of the frames being known."""
    for k in range(1, tree.frames.shape[0]):
        frame, s = tree.frames[k], work[k]
        al, a = inward(s["axes"], triple(s["response"], 0)), inward(s["axes"], triple(s["response"], 3))
        for i in range(frame["first_nodal_mass"], frame["first_nodal_mass"] + frame["nodal_masses"]):
            nodal_mass = tree.nodal_masses[i]
            carried = plus(a, cross(al, node_place(nodal_mass, q)))
            for axis in range(3):
                m = nodal_mass["coordinate"][axis]
                if m >= 0:
                    passed_on = node_frame_share(tree, frame, m) / nodal_mass["mass"]
                    free = coordinates[m]["locked"] == 0
                    coordinates[m]["response"] = -carried[axis] - passed_on if free else 0.0
