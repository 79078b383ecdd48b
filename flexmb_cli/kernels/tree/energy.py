"""Energy of a tree, and the power of everything that is not gravity, elasticity or a spring."""

from typing import TYPE_CHECKING

import numpy as np

from .._jit import kernel
from ..linalg.vec3 import cross, dot, inward, outward, plus, scaled, symmetric, symmetric_times, triple
from .elements import element_energy
from .kinematics import node_place, node_vector
from .loads import axial_prestress, elastic_row_times

if TYPE_CHECKING:
    from ...model.arrays.tree import TreeArrays


@kernel
def energies(
    tree: "TreeArrays", work: np.ndarray, q: np.ndarray, y: np.ndarray
) -> tuple[float, float, float]:
    """Kinetic, potential (gravity and springs) and strain energy, J, of placed frames."""
    g = triple(tree.gravity, 0)
    kinetic = potential = 0.0
    for k in range(1, tree.frames.shape[0]):
        frame, s = tree.frames[k], work[k]
        kinetic += _frame_kinetic(frame, s)
        height = plus(scaled(frame["mass"], triple(s["position"], 0)), _moment(frame, s))
        potential -= dot(g, height)
        for i in range(frame["first_nodal_mass"], frame["first_nodal_mass"] + frame["nodal_masses"]):
            place, velocity = node_state(tree.nodal_masses[i], s, q, y)
            kinetic += 0.5 * tree.nodal_masses[i]["mass"] * dot(velocity, velocity)
            potential -= tree.nodal_masses[i]["mass"] * dot(g, place)
    return kinetic, potential + element_energy(tree), _strain(tree, q)


@kernel
def _moment(frame: np.void, s: np.void) -> tuple[float, float, float]:
    return outward(s["axes"], triple(frame["moment"], 0))


@kernel
def _frame_kinetic(frame: np.void, s: np.void) -> float:
    v, w = triple(s["velocity"], 0), triple(s["angular"], 0)
    spin = inward(s["axes"], w)
    turning = dot(spin, symmetric_times(symmetric(frame["inertia"], 0), spin))
    return 0.5 * frame["mass"] * dot(v, v) + dot(v, cross(w, _moment(frame, s))) + 0.5 * turning


@kernel
def node_state(
    nodal_mass: np.void, s: np.void, q: np.ndarray, y: np.ndarray
) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
    """Position and velocity of a nodal mass of the body with frame record s, inertial axes."""
    r = outward(s["axes"], node_place(nodal_mass, q))
    du = outward(s["axes"], node_vector(nodal_mass, y))
    velocity = plus(triple(s["velocity"], 0), plus(cross(triple(s["angular"], 0), r), du))
    return plus(triple(s["position"], 0), r), velocity


@kernel
def _strain(tree: "TreeArrays", q: np.ndarray) -> float:
    """u . K u / 2 over all bodies."""
    total = 0.0
    for b in range(tree.elastic_bodies.shape[0]):
        body = tree.elastic_bodies[b]
        total += _bilinear(tree, tree.stiffness, body["stiffness"], body, q, q)
    return 0.5 * total


@kernel
def _bilinear(
    tree: "TreeArrays", matrices: np.ndarray, start: int, body: np.void, x: np.ndarray, z: np.ndarray
) -> float:
    """x . A z over one body's coordinates, A beginning at `start`."""
    total = 0.0
    for i in range(body["count"]):
        total += x[body["first"] + i] * elastic_row_times(matrices, start, body, tree.reach, i, z)
    return total


@kernel
def applied_power(
    tree: "TreeArrays", work: np.ndarray, coordinates: np.ndarray, q: np.ndarray, y: np.ndarray
) -> float:
    """Power of external forces and torques, damping, stiffening and prescribed motion, W.

    Torques are those evaluated last.
    """
    power = 0.0
    for k in range(1, tree.frames.shape[0]):
        frame, s = tree.frames[k], work[k]
        power += dot(triple(frame["force"], 0), triple(s["velocity"], 0))
        power += dot(triple(frame["torque"], 0), triple(s["angular"], 0))
        for i in range(frame["first_nodal_mass"], frame["first_nodal_mass"] + frame["nodal_masses"]):
            force = triple(tree.nodal_masses[i]["force"], 0)
            if dot(force, force) > 0.0:
                _place, velocity = node_state(tree.nodal_masses[i], s, q, y)
                power += dot(force, velocity)
    for i in range(tree.torques.shape[0]):
        torque = tree.torques[i]
        power += torque["value"] * work[torque["frame"]]["angular"][torque["axis"]]
    for m in range(coordinates.shape[0]):
        if tree.given[m]:
            power += coordinates[m]["drive"] * y[m]
    return power + _stiffening_power(tree, work, q, y) - _dissipated(tree, y)


@kernel
def _dissipated(tree: "TreeArrays", y: np.ndarray) -> float:
    """Power that the damping of elastic bodies takes."""
    total = 0.0
    for b in range(tree.elastic_bodies.shape[0]):
        body = tree.elastic_bodies[b]
        if body["damping"] >= 0:
            total += _bilinear(tree, tree.damping, body["damping"], body, y, y)
    return total


@kernel
def _stiffening_power(tree: "TreeArrays", work: np.ndarray, q: np.ndarray, y: np.ndarray) -> float:
    """Power of geometric stiffening, which counts as a load: nothing answers it on the rigid motion."""
    total = 0.0
    for b in range(tree.elastic_bodies.shape[0]):
        body = tree.elastic_bodies[b]
        start = body["stiffening"]
        if start >= 0:
            turning, weight = axial_prestress(tree, work, body)
            total -= turning * _bilinear(tree, tree.stiffening, start, body, y, q)
            total -= weight * _bilinear(tree, tree.stiffening, start + body["count"] ** 2, body, y, q)
    return total
