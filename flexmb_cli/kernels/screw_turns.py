"""Angles of screw joints during a march: they count whole turns, which a position alone does not show."""

from ._jit import kernel
from .constrained_system import A
from .constraints import SCREW
from .joints import screw
from .rotation import rotate, rotation_matrices

# Rows of the angles kept (3, screws), rad: at the end of the last step, at its start, and those expected.
NEW, OLD, NEAR = 0, 1, 2


@kernel
def _turn_rate(system, work, c, u):
    """Rate of a screw's angle: the relative turning along its axis, rad/s."""
    i, j = 6 * c["body_i"] + 3, 6 * c["body_j"] + 3
    axis = rotate(work.rotations[A], c["body_i"], c["s_i"])
    w_i = rotate(work.rotations[A], c["body_i"], (u[i], u[i + 1], u[i + 2]))
    w_j = rotate(work.rotations[A], c["body_j"], (u[j], u[j + 1], u[j + 2]))
    return axis[0] * (w_j[0] - w_i[0]) + axis[1] * (w_j[1] - w_i[1]) + axis[2] * (w_j[2] - w_i[2])


@kernel
def expect_turns(system, work, march, h):
    """Angles of the screws at the end of a step, by the mean of their rates: they settle whole turns."""
    bodies = march.z.shape[0] // 13
    for s in range(march.turns.shape[1]):
        march.turns[NEAR, s] = march.turns[NEW, s]
    for end in range(2 if march.turns.shape[1] else 0):
        z = march.z if end == 0 else march.trial
        rotation_matrices(z[: 7 * bodies], work.rotations[A])
        for k in range(system.constraints.shape[0]):
            c = system.constraints[k]
            if c["kind"] == SCREW:
                rate = _turn_rate(system, work, c, z[7 * bodies : 13 * bodies])
                march.turns[NEAR, c["screw"]] += 0.5 * h * rate


@kernel
def note_turns(system, work, march):
    """Angles of the screws at the end of a step, where A belongs to it."""
    for k in range(system.constraints.shape[0]):
        c = system.constraints[k]
        if c["kind"] == SCREW:
            s = c["screw"]
            march.turns[OLD, s] = march.turns[NEW, s]
            march.turns[NEW, s] = screw.angle(c, work.rotations[A], march.turns[NEAR, s])


@kernel
def screw_angles(system, work, q, near):
    """Angles (screws,) of the screws at q, those nearest to `near`, rad."""
    angles = near.copy()
    rotation_matrices(q, work.rotations[A])
    for k in range(system.constraints.shape[0]):
        c = system.constraints[k]
        if c["kind"] == SCREW:
            angles[c["screw"]] = screw.angle(c, work.rotations[A], near[c["screw"]])
    return angles
