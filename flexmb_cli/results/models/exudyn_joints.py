"""Joints of a mechanism for Exudyn, without the equations that repeat others.

Exudyn's generic joint prevents chosen motions in a frame that is fixed to both bodies: displacements along
the axes of body I's frame, rotations about those of body J's.  All equations must be independent: the setting
that ignores a singular Jacobian solves some closed loops only.
"""

from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from ...model.mechanism import GROUND, Joint, Mechanism
from ...model.vectors import rotation_matrix

if TYPE_CHECKING:
    from ...model.joint_elements import CompositeJoint

Position = dict[str, np.ndarray]  # "r" (bodies, 3) in m, Euler parameters "p" (bodies, 4)
# The displacements and rotations that a joint along the third axis of its frame prevents.
HELD = {
    "spherical": (1, 1, 1, 0, 0, 0),
    "revolute": (1, 1, 1, 1, 1, 0),
    "cylindrical": (1, 1, 0, 1, 1, 0),
    "translational": (1, 1, 0, 1, 1, 1),
}
# Share of an equation, of unit length, that those before it do not contain: with less it repeats them.
INDEPENDENT = 1e-7


def joint_frames(mechanism: Mechanism, start: Position) -> list[np.ndarray]:
    """Return for every joint its frame at the start (3, 3), whose third column is the joint's axis."""
    turned = [rotation_matrix(p) for p in start["p"]]
    return [
        np.eye(3) if joint.kind == "spherical" else frame_along(turned[joint.i] @ np.array(joint.s_i))
        for joint in mechanism.joints
    ]


def frame_along(axis: np.ndarray) -> np.ndarray:
    """Return a rotation matrix whose third column is the direction of `axis`."""
    axis = axis / np.linalg.norm(axis)
    across = np.eye(3)[int(np.argmin(np.abs(axis)))]
    x = np.cross(across, axis)
    x = x / np.linalg.norm(x)
    return np.column_stack([x, np.cross(axis, x), axis])


def independent_equations(
    mechanism: Mechanism, links: "Sequence[CompositeJoint]", positions: list[Position]
) -> tuple[list[tuple[int, ...]], list[bool]]:
    """Return for every joint which of six motions it prevents, 1 or 0, and for every link whether it is kept.

    `positions`: at the start and at later times.  At a singular position more equations depend on each other
    than elsewhere: the position with the greatest rank decides.  The last joint of a loop loses the repeated
    equations.  In a plane loop these are its three equations out of the plane, at every position.  Links hold
    the distance of two points and come after all joints.
    """
    chosen = [_independent_rows(_rows(mechanism, links, positions[0], later)) for later in positions]
    independent = iter(max(chosen, key=sum))
    axes = [tuple(int(held and next(independent)) for held in HELD[joint.kind]) for joint in mechanism.joints]
    return axes, list(independent)


def _independent_rows(rows: np.ndarray) -> list[bool]:
    """Return of every row whether it is independent of those before it that are kept."""
    basis = np.zeros((0, rows.shape[1]))
    independent = []
    for row in rows:
        size = np.linalg.norm(row)
        left = row / size if size > 0 else row
        for _ in range(2):  # once leaves round-off of the size of what was taken away
            left = left - basis.T @ (basis @ left)
        independent.append(bool(np.linalg.norm(left) > INDEPENDENT))
        if independent[-1]:
            basis = np.vstack([basis, left / np.linalg.norm(left)])
    return independent


def _rows(
    mechanism: Mechanism, links: "Sequence[CompositeJoint]", start: Position, now: Position
) -> np.ndarray:
    """Return the equations of joints and links in velocities and angular velocities of the moving bodies."""
    still = {GROUND, *(item.body for item in mechanism.grounds)}
    first, turned = ([*map(rotation_matrix, at["p"]), np.eye(3)] for at in (start, now))
    origins, places = ([*at["r"], np.zeros(3)] for at in (start, now))
    columns = {body: 6 * k for k, body in enumerate(k for k in range(len(now["r"])) if k not in still)}
    length = float(np.ptp(now["r"], axis=0).max()) or 1.0
    row = partial(_row, origins=places, columns=columns, length=length)
    rows: list[np.ndarray] = []
    for joint, frame in zip(mechanism.joints, joint_frames(mechanism, start), strict=True):
        frame_of_i, frame_of_j = (turned[body] @ first[body].T @ frame for body in (joint.i, joint.j))
        # The script gives body J the point that lies at P_i at the start, wherever P_j is.
        from_j = origins[joint.i] + first[joint.i] @ np.array(joint.P_i) - origins[joint.j]
        place = places[joint.j] + turned[joint.j] @ first[joint.j].T @ from_j
        for axis, held in enumerate(HELD[joint.kind]):
            if held:
                direction = frame_of_i[:, axis] if axis < 3 else frame_of_j[:, axis - 3]
                rows.append(row(joint, direction, place if axis < 3 else None))
    for link in links:
        P_i, P_j = (
            places[body] + turned[body] @ np.array(P) for body, P in ((link.i, link.P_i), (link.j, link.P_j))
        )
        rows.append(row(link, P_j - P_i, P_j))
    return np.array(rows).reshape(len(rows), 6 * len(columns))


def _row(
    pair: "Joint | CompositeJoint",
    direction: np.ndarray,
    place: np.ndarray | None,
    origins: list[np.ndarray],
    columns: dict[int, int],
    length: float,
) -> np.ndarray:
    """Return the equation of no relative velocity along `direction`, or without a place of none about it.

    The direction d turns with body I.  So the velocities of both bodies are those at `place`, where the
    point of body J is: d · (P_j - P_i) changes by d · (v_j - v_i), both at P_j.
    """
    row = np.zeros(6 * len(columns))
    for body, sign in ((pair.i, 1.0), (pair.j, -1.0)):
        if body not in columns:
            continue
        at = columns[body]
        if place is None:
            row[at + 3 : at + 6] = sign * direction
        else:
            row[at : at + 3] = sign * direction
            row[at + 3 : at + 6] = sign * np.cross(place - origins[body], direction) / length
    return row
