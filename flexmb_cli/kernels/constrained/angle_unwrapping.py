"""Angles of screws, drivers and joint springs during a march: they count whole turns, which a position
alone does not show."""

from .._jit import kernel
from ..kinematics.constraints import SCREW
from ..kinematics.joints import screw
from ..linalg.rotation import rotate, rotation_matrices
from .body_vectors import geometry_of, move_arms, place_arms
from .constraint_primitives import angle_rates, measure_angle
from .report import coordinates_and_speeds
from .system import A

# Rows of the angles kept (3, angles), rad: at the end of the last step, at its start, and those expected.
NEW, OLD, NEAR = 0, 1, 2
MOST_TURNED = 2.5  # rad in a step, less than half a turn: the stages of a step then find their angles


@kernel
def _turn_rate(work, c, u):
    """Rate of a screw's angle: the relative turning along its axis, rad/s."""
    i, j = 6 * c["body_i"] + 3, 6 * c["body_j"] + 3
    axis = rotate(work.rotations[A], c["body_i"], c["s_i"])
    w_i = rotate(work.rotations[A], c["body_i"], (u[i], u[i + 1], u[i + 2]))
    w_j = rotate(work.rotations[A], c["body_j"], (u[j], u[j + 1], u[j + 2]))
    return axis[0] * (w_j[0] - w_i[0]) + axis[1] * (w_j[1] - w_i[1]) + axis[2] * (w_j[2] - w_i[2])


@kernel
def expect_turns(system, work, march, h):
    """Angles at the end of a step, by the mean of their rates: they settle whole turns.

    Returns the largest turn between bodies of a flexible mechanism in the step, rad.
    """
    for s in range(march.turns.shape[1]):
        march.turns[NEAR, s] = march.turns[NEW, s]
    for end in range(2 if march.turns.shape[1] else 0):
        q, u = coordinates_and_speeds(system, march.z if end == 0 else march.trial)
        rotation_matrices(q, work.rotations[A])
        geometry = geometry_of(system, work)
        place_arms(geometry, q)
        move_arms(geometry, u)
        _add_turns(system, work, u, 0.5 * h, march.turns[NEAR])
    largest = 0.0
    for k in range(system.measures.shape[0]):
        s = system.measures[k]["turn"]
        if s >= 0:
            largest = max(largest, abs(march.turns[NEAR, s] - march.turns[NEW, s]))
    return largest


@kernel
def _add_turns(system, work, u, h, turns):
    """Add h times the rates of all angles."""
    for k in range(system.constraints.shape[0]):
        c = system.constraints[k]
        if c["kind"] == SCREW:
            turns[c["screw"]] += h * _turn_rate(work, c, u)
    for k in range(system.measures.shape[0]):
        if system.measures[k]["turn"] >= 0:
            turns[system.measures[k]["turn"]] += h * angle_rates(work.arms, system.measures[k])[0]


@kernel
def find_turns(system, work, near, turns):
    """Fill turns (angles,) with those nearest to `near`, where A and the arms belong to the position."""
    for k in range(system.constraints.shape[0]):
        c = system.constraints[k]
        if c["kind"] == SCREW:
            turns[c["screw"]] = screw.angle(c, work.rotations[A], near[c["screw"]])
    for k in range(system.measures.shape[0]):
        s = system.measures[k]["turn"]
        if s >= 0:
            turns[s] = measure_angle(work.arms, system.measures[k], near[s])


@kernel
def note_turns(system, work, march):
    """Angles at the end of a step, where A and the arms belong to it."""
    for s in range(march.turns.shape[1]):
        march.turns[OLD, s] = march.turns[NEW, s]
    find_turns(system, work, march.turns[NEAR], march.turns[NEW])


@kernel
def fill_angles(system, work, q, near, angles):
    """Fill angles (angles,) with those at q that are nearest to `near`, rad."""
    rotation_matrices(q, work.rotations[A])
    place_arms(geometry_of(system, work), q)
    find_turns(system, work, near, angles)
