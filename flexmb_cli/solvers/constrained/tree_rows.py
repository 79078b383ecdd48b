"""The motion of a tree by that of its bodies in absolute coordinates; hinge coordinates are found from it.

Integrals of the relative angular velocity, the coordinates of three free rotations, are no functions of
the position: they are nan.  Angles are those that the steps of the integration have counted.
"""

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ...kernels.constrained.report import Report
from ...model.arrays.system import SystemArrays
from ...model.flexible_mechanism import NodePoint
from ...model.tree import ELASTIC, ROTATION, Tree
from ...model.tree_as_mechanism.frames import Base, Frames
from ..tree.points import rotation_matrices
from ..tree.rows import TreeRows, rows_of_tree
from .flexible_rows import BodyMotion, body_motion
from .rows import global_axes

if TYPE_CHECKING:
    from ...model.flexible_mechanism import NodePoint
from ...model.tree import Hinge


class Moving(NamedTuple):
    """A frame over T rows, global axes."""

    r: np.ndarray  # (T, 3) position of its origin, m
    v: np.ndarray  # (T, 3) velocity of its origin, m/s
    a: np.ndarray  # (T, 3) acceleration of its origin, m/s²
    axes: np.ndarray  # (T, 3, 3) its axes, a column each
    w: np.ndarray  # (T, 3) angular velocity, rad/s
    alpha: np.ndarray  # (T, 3) angular acceleration, rad/s²


def moving_body(motion: BodyMotion, body: int) -> Moving:
    """The frame of a body; that of the inertial one rests."""
    if body < 0:
        rest = np.zeros((len(motion.q), 3))
        return Moving(rest, rest, rest, np.broadcast_to(np.eye(3), (len(rest), 3, 3)), rest, rest)
    q, u, ud = motion.q[:, body], motion.u[:, body], motion.ud[:, body]
    p = q[:, 3:]
    w, alpha = global_axes(p, u[:, 3:]), global_axes(p, ud[:, 3:])
    return Moving(q[:, :3], u[:, :3], ud[:, :3], rotation_matrices(p), w, alpha)


def moving_base(motion: BodyMotion, base: Base) -> Moving:
    """The point and the axes that a hinge hangs on."""
    on = moving_body(motion, base.body)
    r, v, a = motion.point(NodePoint("", base.body, base.place, base.shape))
    return Moving(r, v, a, on.axes @ base.axes, on.w, on.alpha)


def rows_of_bodies(
    tree: Tree,
    frames: Frames,
    arrays: SystemArrays,
    report: Report,
    angles: np.ndarray,
    last: np.ndarray,
) -> TreeRows:
    """Return the rows of a report in the terms of the tree; `last` as in `rows_of_tree`.

    `angles` (T, n): those of hinges with one or two rotations, with their turns.
    """
    modes = [body.elastic.coordinates if body.elastic else 0 for body in tree.bodies]
    motion = body_motion([*modes, *(0 for _ in frames.node_frames)], arrays, report)
    q, y, y_rate = _coordinates(tree, frames, motion, angles)
    N = len(tree.bodies)
    bodies = [moving_body(motion, k) for k in range(N)]
    position, velocity, acceleration, axes, w, alpha = (
        np.stack(parts, axis=1) for parts in zip(*bodies, strict=True)
    )
    return rows_of_tree(
        tree,
        last,
        time=report.times,
        q=q,
        y=y,
        y_rate=y_rate,
        position=position,
        axes=axes,
        euler_parameters=motion.q[:, :N, 3:],
        velocity=velocity,
        acceleration=acceleration,
        angular_velocity=w,
        angular_acceleration=alpha,
        closure_force=_closure_forces(tree, arrays, report),
        applied_work=report.states[:, 2 * arrays.speeds + arrays.bodies].copy(),
        audit=report.audit,
        reactions=np.zeros((len(report.times), 0, 6)),
    )


def _closure_forces(tree: Tree, arrays: SystemArrays, report: Report) -> Any:
    """Force on body a of each closure (T, C, 3): the second body of its group."""
    first = len(arrays.groups) - len(tree.closures)
    return report.wrenches[:, first:, 1, :3].copy()


def _coordinates(tree: Tree, frames: Frames, motion: BodyMotion, angles: np.ndarray) -> Any:
    """Coordinates, speeds and their rates (T, NS)."""
    columns, elastic, counted = [], 0, iter(angles.T)
    for c in tree.coordinates:
        if c.motion == ELASTIC:
            columns.append(tuple(eta[:, elastic] for eta in motion.modal))
            elastic += 1
            continue
        base, body = moving_base(motion, frames.bases[c.body]), moving_body(motion, c.body)
        if c.motion == ROTATION:
            columns.append(_rotation(tree.hinges[c.body], c.axis - 1, base, body, counted))
        else:
            columns.append(_translation(c.axis - 1, base, body))
    return tuple(np.stack(parts, axis=1) for parts in zip(*columns, strict=True))


def _along(a: np.ndarray, b: np.ndarray) -> Any:
    return np.sum(a * b, axis=-1)


def _translation(axis: int, base: Moving, body: Moving) -> Any:
    """Gap along an axis of P_k, and its derivatives in the turning axes."""
    direction, w = base.axes[:, :, axis], base.w
    gap, rate, second = body.r - base.r, body.v - base.v, body.a - base.a
    slide = rate - np.cross(w, gap)
    turning = np.cross(base.alpha, gap) + 2.0 * np.cross(w, rate) - np.cross(w, np.cross(w, gap))
    return _along(gap, direction), _along(slide, direction), _along(second - turning, direction)


def _rotation(hinge: "Hinge", axis: int, base: Moving, body: Moving, counted: Iterator[np.ndarray]) -> Any:
    """Angle or nan, speed and its rate: the relative angular velocity along the axis it turns about."""
    spin, change = body.w - base.w, body.alpha - base.alpha
    second = len(hinge.rotations) == 2 and axis == hinge.rotations[1] - 1
    carrier = body if second else base
    direction = carrier.axes[:, :, axis]
    speed = _along(spin, direction)
    rate = _along(change, direction) + _along(spin, np.cross(carrier.w, direction))
    if len(hinge.rotations) == 3:
        return np.full(len(speed), np.nan), speed, rate
    return next(counted) + 0.0, speed, rate
