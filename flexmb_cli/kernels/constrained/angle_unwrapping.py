"""Angles of screws, drivers and joint springs during an integration: they count whole turns, which a position
alone does not show."""

from typing import TYPE_CHECKING

import numpy as np

from .._jit import kernel
from ..kinematics.constraints import SCREW
from ..kinematics.joints import screw
from ..linalg.rotation import A, rotate, rotation_matrices
from .body_vectors import geometry_of, geometry_of_joints, move_vectors, place_vectors
from .constraint_primitives import PARAMETER, angle_rates, primitive_angle, track_parameter, track_rates
from .report import coordinates_and_speeds
from .system import System, Work

if TYPE_CHECKING:
    from ..integrators.integrations import AlphaIntegration, Integration, RadauIntegration


# Rows of the angles kept (3, angles), rad: at the end of the last step, at its start, and those expected.
NEW, OLD, EXPECTED = 0, 1, 2
MOST_TURNED = 2.5  # rad in a step, less than half a turn: the stages of a step then find their angles


@kernel
def _turn_rate(work: Work, c: np.ndarray, u: np.ndarray):
    """Rate of a screw's angle: the relative turning along its axis, rad/s."""
    i, j = 6 * c["body_i"] + 3, 6 * c["body_j"] + 3
    axis = rotate(work.rotations[A], c["body_i"], c["s_i"])
    w_i = rotate(work.rotations[A], c["body_i"], (u[i], u[i + 1], u[i + 2]))
    w_j = rotate(work.rotations[A], c["body_j"], (u[j], u[j + 1], u[j + 2]))
    return axis[0] * (w_j[0] - w_i[0]) + axis[1] * (w_j[1] - w_i[1]) + axis[2] * (w_j[2] - w_i[2])


@kernel
def expect_angles(
    system: System, work: Work, integration: "Integration | AlphaIntegration | RadauIntegration", h: float
) -> float:
    """Angles at the end of a step, by the mean of their rates: they decide on whole turns.

    Returns the largest turn between bodies of a flexible mechanism in the step, rad.
    """
    for s in range(integration.angles.shape[1]):
        integration.angles[EXPECTED, s] = integration.angles[NEW, s]
    for end in range(2 if integration.angles.shape[1] else 0):
        q, u = coordinates_and_speeds(system, integration.z if end == 0 else integration.trial)
        rotation_matrices(q, work.rotations[A])
        if _counts_turns(system, integration.angles.shape[1]):
            geometry = geometry_of(system, work)
            place_vectors(geometry, q)
            move_vectors(geometry, u)
            _add_angles(system, work, u, 0.5 * h, integration.angles[EXPECTED])
        of_joints = geometry_of_joints(system, work)
        place_vectors(of_joints, q)
        move_vectors(of_joints, u)
        _add_rates(of_joints.primitives, of_joints.placed, 0.5 * h, integration.angles[EXPECTED])
    largest = 0.0
    for k in range(system.primitives.shape[0]):
        s = system.primitives[k]["turn"]
        if s >= 0 and system.primitives[k]["track"] < 0:
            largest = max(largest, abs(integration.angles[EXPECTED, s] - integration.angles[NEW, s]))
    return largest


@kernel
def _add_angles(system: System, work: Work, u: np.ndarray, h: float, angles: np.ndarray) -> None:
    """Add h times the rates of all angles."""
    for k in range(system.constraints.shape[0]):
        c = system.constraints[k]
        if c["kind"] == SCREW:
            angles[c["screw"]] += h * _turn_rate(work, c, u)
    _add_rates(system.primitives, work.body_vectors, h, angles)
    for k in range(system.primitives.shape[0]):
        m = system.primitives[k]
        if m["track"] == PARAMETER:
            angles[m["turn"]] += h * track_rates(system, work, k, angles)[0]


@kernel
def _add_rates(primitives: np.ndarray, placed: np.ndarray, h: float, angles: np.ndarray) -> None:
    """Add h times the rates of the angles of primitives; placed (3, body vectors, 3)."""
    for k in range(primitives.shape[0]):
        if primitives[k]["turn"] >= 0 and primitives[k]["track"] < 0:
            angles[primitives[k]["turn"]] += h * angle_rates(placed, primitives[k])[0]


@kernel
def _counts_turns(system: System, angles: int) -> bool:
    """Return whether any of so many angles is in an equation or in a load."""
    first = angles
    for k in range(system.joint_coordinates.shape[0]):
        if system.joint_coordinates[k]["turn"] >= 0:
            first = min(first, system.joint_coordinates[k]["turn"])
    return first > 0


@kernel
def nearest_angles(
    system: System, work: Work, q: np.ndarray, expected: np.ndarray, angles: np.ndarray
) -> None:
    """Fill angles (angles,) with those nearest to `expected`, where A and the body vectors belong to q."""
    for k in range(system.constraints.shape[0]):
        c = system.constraints[k]
        if c["kind"] == SCREW:
            angles[c["screw"]] = screw.angle(c, work.rotations[A], expected[c["screw"]])
    of_joints = geometry_of_joints(system, work)
    if angles.shape[0] > 0:
        place_vectors(of_joints, q)
    _fill_nearest(system.primitives, work.body_vectors, expected, angles)
    _fill_nearest(of_joints.primitives, of_joints.placed, expected, angles)
    for k in range(system.primitives.shape[0]):
        if system.primitives[k]["track"] == PARAMETER:
            angles[system.primitives[k]["turn"]] = track_parameter(system, work, k, expected)


@kernel
def _fill_nearest(
    primitives: np.ndarray, placed: np.ndarray, expected: np.ndarray, angles: np.ndarray
) -> None:
    """Fill the angles of primitives with those nearest to `expected`; placed (3, body vectors, 3)."""
    for k in range(primitives.shape[0]):
        s = primitives[k]["turn"]
        if s >= 0 and primitives[k]["track"] < 0:
            angles[s] = primitive_angle(placed, primitives[k], expected[s])


@kernel
def unwrap_angles(system: System, work: Work, integration: "Integration | RadauIntegration") -> None:
    """Angles at the end of a step, where A and the body vectors belong to it."""
    for s in range(integration.angles.shape[1]):
        integration.angles[OLD, s] = integration.angles[NEW, s]
    q = coordinates_and_speeds(system, integration.z)[0]
    nearest_angles(system, work, q, integration.angles[EXPECTED], integration.angles[NEW])


@kernel
def fill_angles(system: System, work: Work, q: np.ndarray, expected: np.ndarray, angles: np.ndarray) -> None:
    """Fill angles (angles,) with those at q that are nearest to `expected`, rad."""
    rotation_matrices(q, work.rotations[A])
    place_vectors(geometry_of(system, work), q)
    nearest_angles(system, work, q, expected, angles)
