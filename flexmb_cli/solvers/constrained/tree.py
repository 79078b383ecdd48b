"""A tree moved as a constrained mechanism: every body has coordinates of its own, hinges are equations.

The other formulation of the same model: floating frames with nodal displacements as modal coordinates,
Euler parameters and Lagrange multipliers.  Nothing of the recursion along the tree is used.

Hinge coordinates are found from the motion of the bodies.  Integrals of the relative angular velocity, the
coordinates of three free rotations, are no functions of the position: they are nan.  Angles are those
that the steps of the integration have counted.
"""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from ...fe.lumped_body import floating_body, massless_body
from ...kernels.constrained.report import Report
from ...kernels.tree.motion import parts
from ...model.arrays.constraint_table import PrimitiveTable
from ...model.arrays.element_table import ElementTable, JointCoordinateName, report_coordinates
from ...model.arrays.flexible import flexible_arrays, length_scale
from ...model.arrays.system import SystemArrays
from ...model.flexible_mechanism import FlexibleMechanism, NodePoint
from ...model.integrators import IMPLICIT_TREE_METHODS, Integrator
from ...model.joint_elements import JointElements
from ...model.tree import ELASTIC, ROTATION, Hinge, Tree
from ...model.tree_as_mechanism.frames import Base, Frames, hinge_frames, refuse_foreign
from ...model.tree_as_mechanism.hinges import (
    HingeJoints,
    add_closures,
    add_hinges,
    add_prescribed,
    tree_loads,
)
from ...model.tree_as_mechanism.poses import elastic_start, first_poses, repeated_in_planar_tree
from ...model.vectors import global_axes
from ..checkpoint import taken
from ..projection import RESIDUAL_MET, largest
from ..tree.analysis import TreeAnalysis, hold_functions
from ..tree.assembly import assemble_tree
from ..tree.points import rotation_matrices
from ..tree.rows import TreeRows, rows_of_tree, unturned
from .analysis import ConstrainedMotion
from .flexible_rows import BodyMotion, body_motion
from .tree_element_rows import with_elements


class AbsoluteTree(ConstrainedMotion):
    """One run of a tree over its report times in absolute coordinates; the rows are those of a tree.

    Raises ModelError for what is not carried over, AnalysisError for loops that do not close.
    """

    omega_in_body_axes = True
    usual_words = "planar tree", "one a loop"

    def __init__(self, tree: Tree):
        refuse_foreign(tree)
        self.frames = hinge_frames(tree)
        self.tree = tree = closed_tree(tree)
        poses = first_poses(tree, self.frames)
        bodies = [floating_body(tree, k, poses[k]) for k in range(len(tree.bodies))]
        bodies += [
            massless_body(node_frame, pose)
            for node_frame, pose in zip(self.frames.node_frames, poses[len(bodies) :], strict=True)
        ]
        self._bodies = tuple(bodies)
        arrays = absolute_arrays(tree, self.frames, self._bodies)
        stiff = tree.elements and tree.integration.method in IMPLICIT_TREE_METHODS
        integrator = Integrator("RAD5" if stiff else "RK45", tolerance=tree.integration.rtol)
        super().__init__(arrays, tree.time, integrator, tree.elements)
        self.clock["atol"] = tree.integration.atol
        self._speeds = np.concatenate([np.concatenate([body.velocity, body.omega]) for body in bodies])
        self._elastic = [elastic_start(tree, k) for k in range(len(tree.bodies))]
        self._attitude = unturned(len(tree.bodies))

    @property
    def checkpoint(self) -> dict[str, np.ndarray]:
        """Return where to go on, with attitudes of the last row, which the next ones continue."""
        return {**super().checkpoint, "attitude": self._attitude}

    def restore(self, checkpoint: Mapping[str, np.ndarray]) -> None:
        """Go on behind the rows that were yielded up to a checkpoint."""
        super().restore(checkpoint)
        self._attitude = taken(checkpoint, "attitude", self._attitude.shape)

    def assembled(self, t: float) -> np.ndarray:
        """Coordinates at the start: those of the tree, which meet the equations of its hinges.

        Loops that close only nearly are closed by all bodies, as the tolerance allows.
        """
        rigid = 7 * self.arrays.bodies
        q = np.concatenate([self.arrays.q[:rigid], *(eta for eta, _ in self._elastic)])
        if largest(self.gaps.residual(q, t, self.arrays.angles)) <= RESIDUAL_MET:
            return q
        return self.first_position(t, self.tree.loop_tolerance, q)[1]

    def given_speeds(self, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """All speeds are given, by the tree's."""
        speeds = np.concatenate([self._speeds, *(rate for _, rate in self._elastic)])
        return np.ones(speeds.size, bool), speeds

    def usual_repetitions(self, q: np.ndarray) -> int | None:
        """Closed directions across the plane of a planar tree; None of any other."""
        return repeated_in_planar_tree(self.tree)

    def block(self, report: Report) -> TreeRows:
        """The rows of a report in the terms of the tree."""
        rows = rows_of_bodies(self.tree, self.frames, self.arrays, report, self._attitude)
        self._attitude = rows.euler_parameters[-1].copy()
        if not self.tree.elements:
            return rows
        return with_elements(self.tree, self.arrays, rows, report)


def closed_tree(tree: Tree) -> Tree:
    """The tree with initial coordinates and speeds that its closures allow, as Kane's equations find them.

    Gaps of loops that nearly close are left.  Joints that are caught later close nothing here.
    """
    lasting = tuple(c for c in tree.closures if not (c.general and c.general.turned is not None))
    if not lasting:
        return tree
    drivers = JointElements(drivers=tree.elements.drivers)
    analysis = TreeAnalysis(replace(tree, elements=drivers, closures=lasting))
    hold_functions(analysis.arrays, tree.time.end)
    assemble_tree(analysis)
    y, q, attitudes = (part.copy() for part in parts(analysis.arrays, analysis.state))
    turned = iter(attitudes.tolist())
    hinges = [replace(h, attitude=tuple(next(turned))) if len(h.rotations) == 3 else h for h in tree.hinges]
    return replace(tree, q=q, y=y, hinges=tuple(hinges))


def turning_coordinates(tree: Tree) -> list[JointCoordinateName]:
    """Return the rotations that are angles, whose turns the steps of the integration count."""
    return [
        JointCoordinateName(c.body, f"{c.motion} {c.axis}")
        for c in tree.coordinates
        if c.motion == ROTATION and len(tree.hinges[c.body].rotations) < 3
    ]


def absolute_arrays(tree: Tree, frames: Frames, bodies: tuple[Any, ...]) -> SystemArrays:
    """The equations of a tree between bodies with coordinates of their own."""
    free = FlexibleMechanism(bodies, tree.time, Integrator(), tree.gravity)
    table = PrimitiveTable(bodies, length_scale(free))
    add_hinges(table, tree, frames)
    add_prescribed(table, tree, frames)
    elements = ElementTable(table, HingeJoints(table, tree, frames), tree.elements)
    report_coordinates(HingeJoints(table.reported(), tree, frames), turning_coordinates(tree))
    elements.add_sums_and_cams()
    elements.add_drivers(tree.time.start)
    add_closures(table, tree)
    others = list(tree_loads(table, tree))
    loads, signals = elements.loads(others), elements.signal_arrays(len(others))
    return replace(flexible_arrays(free), loads=loads, **signals, **table.arrays())


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
    tree: Tree, frames: Frames, arrays: SystemArrays, report: Report, last: np.ndarray
) -> TreeRows:
    """Return the rows of a report in the terms of the tree; `last` as in `rows_of_tree`."""
    modes = [body.elastic.coordinates if body.elastic else 0 for body in tree.bodies]
    motion = body_motion([*modes, *(0 for _ in frames.node_frames)], arrays, report)
    q, y, y_rate = _coordinates(tree, frames, motion, report.joints[:, :, 0])
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
        applied_work=report.states[:, arrays.place_of_work].copy(),
        audit=report.audit,
        reactions=np.zeros((len(report.times), 0, 6)),
    )


def _closure_forces(tree: Tree, arrays: SystemArrays, report: Report) -> Any:
    """Force on body a of each closure (T, C, 3): the second body of its group."""
    first = len(arrays.groups) - len(tree.closures)
    return report.wrenches[:, first:, 1, :3].copy()


def _coordinates(tree: Tree, frames: Frames, motion: BodyMotion, angles: np.ndarray) -> Any:
    """Coordinates, speeds and their rates (T, NS); angles (T, n) of hinges with one or two rotations."""
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


def _rotation(hinge: Hinge, axis: int, base: Moving, body: Moving, counted: Iterator[np.ndarray]) -> Any:
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
