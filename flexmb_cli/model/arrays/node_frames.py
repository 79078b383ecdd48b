"""Node frames: frames at nodes of a flexible body whose hinges turn with the slope of the body.

The rotation of such a node is a linear function C w of all elastic coordinates of its body (DAFMS
thesis, 1992, eqs. 2.7 and 2.24: the nodal rotations that the condensation took out), so that what
hangs there acts on all of them.  A node frame has no mass and no coordinates of its own: its node stays a
nodal mass like the others.  A body that carries a turning hinge has node frames at all its carrying nodes.
"""

from typing import Any, NamedTuple

import numpy as np

NODE_FRAME = np.dtype(
    [
        ("frame", np.int64),  # number of its FRAME
        ("node", np.int64, 3),  # coordinate of its node's displacement along axis 1, 2, 3; -1 where held
        ("first", np.int64),  # first elastic coordinate of its body
        ("count", np.int64),  # NM of its body
        ("slope", np.int64),  # where its matrix C (3, NM) begins in `slopes`
    ]
)

FLEXIBLE_PARENT = np.dtype(
    [
        ("frame", np.int64),  # number of the body's FRAME
        ("first_node_frame", np.int64),  # number of its first NODE_FRAME, the others follow
        ("node_frames", np.int64),  # how many it has
        ("first", np.int64),  # first elastic coordinate
        ("count", np.int64),  # NM
    ]
)


class NodeFrames(NamedTuple):
    """R node frames in numbers, and their work space: six rows each, rotation first, inertial axes.

    Of a flexible parent with n node frames the first 6 n columns of (6 R, 6 R) arrays count, beginning at 0.
    """

    records: np.ndarray  # (R,) NODE_FRAME records
    bodies: np.ndarray  # FLEXIBLE_PARENT records
    slopes: np.ndarray  # all matrices C, flat
    motion: np.ndarray  # (6 R, NM) D: acceleration of the node frames by the elastic coordinates, 1/m and 1
    carry: np.ndarray  # (6 R, 6) E: and by the body, the nodes staying behind, m and 1
    given: np.ndarray  # (6 R,) s: and without either, rad/s², m/s²
    own: np.ndarray  # (6 R, 6) inertia of what hangs on each node frame, kg m², kg m, kg
    compliance: np.ndarray  # (6 R, 6 R) W: acceleration by forces on the node frames, one over units of `own`
    transmission: np.ndarray  # (6 R, 6 R) (1 + own W)^-1, 1, m and 1/m
    stiff: np.ndarray  # (6 R, 6 R) transmission own: inertia that acts on the parent, kg m², kg m, kg
    gain: np.ndarray  # (6 R, 6) stiff E, kg m², kg m, kg
    held: np.ndarray  # (6 R,) force on what hangs there while the body does not accelerate, N m, N
    force: np.ndarray  # (6 R,) force on what hangs there, N m, N


def empty_node_frames(node_frames: list[Any], bodies: list[Any], slopes: list[Any]) -> NodeFrames:
    """Node frames with blank work space; `node_frames` and `bodies` are rows of NODE_FRAME and
    FLEXIBLE_PARENT.
    """
    rows, widest = 6 * len(node_frames), max((6 * body[2] for body in bodies), default=0)
    longest = max((body[4] for body in bodies), default=0)
    return NodeFrames(
        np.array(node_frames, NODE_FRAME) if node_frames else np.zeros(0, NODE_FRAME),
        np.array(bodies, FLEXIBLE_PARENT) if bodies else np.zeros(0, FLEXIBLE_PARENT),
        np.concatenate([np.zeros(0), *(np.ravel(C) for C in slopes)]),
        np.zeros((rows, longest)),
        np.zeros((rows, 6)),
        np.zeros(rows),
        np.zeros((rows, 6)),
        np.zeros((rows, widest)),
        np.zeros((rows, widest)),
        np.zeros((rows, widest)),
        np.zeros((rows, 6)),
        np.zeros(rows),
        np.zeros(rows),
    )
