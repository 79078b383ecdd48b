"""Report rows of a mechanism of rigid and flexible bodies."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...kernels.constrained.report import Report
from ...model.arrays.node_joints import reaction_point
from ...model.arrays.system import SystemArrays
from ...model.flexible_mechanism import FlexibleMechanism, NodePoint, PointJoint
from ...model.vectors import cross_rows, global_axes
from .rows import coordinate_accelerations, coordinate_rates
from .turned_arms import arm_motion, node_spin


@dataclass(frozen=True)
class FlexibleRows:
    """A block of T rows; SI units, global axes.

    Reactions act on body b of each joint at its first point there, those of pins on the body at its node.
    Without errors total = kinetic + potential + strain - applied_work stays constant.
    """

    time: np.ndarray  # (T,)
    position: np.ndarray  # (T, b, 3) origins of the body frames
    euler_parameters: np.ndarray  # (T, b, 4)
    velocity: np.ndarray  # (T, b, 3)
    euler_parameter_rates: np.ndarray  # (T, b, 4)
    acceleration: np.ndarray  # (T, b, 3)
    euler_parameter_accelerations: np.ndarray  # (T, b, 4)
    angular_velocity: np.ndarray  # (T, b, 3)
    angular_acceleration: np.ndarray  # (T, b, 3)
    amplitude: tuple[np.ndarray, ...]  # (T, N) of every flexible body
    amplitude_rate: tuple[np.ndarray, ...]  # (T, N) of every flexible body
    point_position: np.ndarray  # (T, outputs, 3)
    point_velocity: np.ndarray  # (T, outputs, 3)
    point_acceleration: np.ndarray  # (T, outputs, 3)
    node_rotation: np.ndarray  # (T, outputs that turn, 3) rotation vectors against the body, its axes, rad
    node_angular_velocity: np.ndarray  # (T, outputs that turn, 3) rad/s
    joint_coordinate: np.ndarray  # (T, joint coordinates) rad or m, 0 at the estimates of the deck
    joint_rate: np.ndarray  # (T, joint coordinates) its rate
    reaction_force: np.ndarray  # (T, joints, 3)
    reaction_torque: np.ndarray  # (T, joints, 3)
    holding_force: np.ndarray  # (T, pins, 3)
    driver_effort: np.ndarray  # (T, motions) force or torque along the prescribed coordinate
    kinetic: np.ndarray  # (T,) J
    potential: np.ndarray  # (T,) of gravity and springs
    strain: np.ndarray  # (T,)
    applied_work: np.ndarray  # (T,) of motions, forces, damping and stiffening since the start
    applied_power: np.ndarray  # (T,) its rate, W
    constraint_residual: np.ndarray  # (T,) largest scaled gap
    velocity_residual: np.ndarray  # (T,) and its rate

    @property
    def total(self) -> np.ndarray:
        """Energy that nothing changes but errors (T,), J."""
        return self.kinetic + self.potential + self.strain - self.applied_work


@dataclass(frozen=True)
class BodyMotion:
    """States of a report by bodies: q, u and rates of u; modal coordinates and their two derivatives."""

    q: np.ndarray  # (T, b, 7)
    u: np.ndarray  # (T, b, 6)
    ud: np.ndarray  # (T, b, 6)
    modal: tuple[np.ndarray, np.ndarray, np.ndarray]  # (T, E) each
    first: np.ndarray  # (b + 1,)

    def of(self, point: NodePoint) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Arm of a point with its first two derivatives relative to the body (T, 3), body axes."""
        part = slice(self.first[point.body], self.first[point.body] + point.shape.shape[1])
        s, sd, sdd = (eta[:, part] @ point.shape.T for eta in self.modal)
        if point.is_arm and point.turn is not None:
            turns = (eta[:, part] @ point.turn.T for eta in self.modal)
            moved, speed, more = arm_motion(point.arm, *turns)
            s, sd, sdd = s + moved, sd + speed, sdd + more
        return point.r0 + s, sd, sdd

    def point(self, point: NodePoint) -> Any:
        """Position, velocity and acceleration (T, 3) of a point, global axes."""
        if point.body < 0:
            rest = np.zeros((len(self.q), 3))
            return rest + point.r0, rest, rest
        q, u, ud = self.q[:, point.body], self.u[:, point.body], self.ud[:, point.body]
        s, sd, sdd = self.of(point)
        p, w = q[:, 3:], u[:, 3:]
        turned = cross_rows(w, s)
        rest = cross_rows(w, turned + 2.0 * sd) + cross_rows(ud[:, 3:], s) + sdd
        return (
            q[:, :3] + global_axes(p, s),
            u[:, :3] + global_axes(p, turned + sd),
            ud[:, :3] + global_axes(p, rest),
        )

    def turning(self, point: NodePoint) -> tuple[np.ndarray, np.ndarray]:
        """Rotation vector of a node against its body, body axes; angular velocity, global axes; (T, 3)."""
        assert point.turn is not None, f"{point.name} has no rotations"
        part = slice(self.first[point.body], self.first[point.body] + point.turn.shape[1])
        theta, rate = (eta[:, part] @ point.turn.T for eta in self.modal[:2])
        w = self.u[:, point.body, 3:] + node_spin(theta, rate)
        return theta, global_axes(self.q[:, point.body, 3:], w)


def flexible_rows(mechanism: FlexibleMechanism, arrays: SystemArrays, report: Report) -> FlexibleRows:
    """The rows of a report in the terms of the model."""
    motion = body_motion((body.modes for body in mechanism.bodies), arrays, report)
    q, u, ud = motion.q, motion.u, motion.ud
    rates, seconds = coordinate_rates(q, u), coordinate_accelerations(q, u, ud)
    points = [motion.point(point) for point in mechanism.outputs]
    points = [_stacked([point[k] for point in points], len(q)) for k in range(3)]
    turns = [motion.turning(point) for point in mechanism.turning_outputs]
    return FlexibleRows(
        time=report.times,
        position=q[..., :3],
        euler_parameters=q[..., 3:],
        velocity=u[..., :3],
        euler_parameter_rates=rates[..., 3:],
        acceleration=ud[..., :3],
        euler_parameter_accelerations=seconds[..., 3:],
        angular_velocity=global_axes(q[..., 3:], u[..., 3:]),
        angular_acceleration=global_axes(q[..., 3:], ud[..., 3:]),
        amplitude=_by_body(mechanism, motion, motion.modal[0]),
        amplitude_rate=_by_body(mechanism, motion, motion.modal[1]),
        point_position=points[0],
        point_velocity=points[1],
        point_acceleration=points[2],
        node_rotation=_stacked([theta for theta, _ in turns], len(q)),
        node_angular_velocity=_stacked([w for _, w in turns], len(q)),
        joint_coordinate=report.joints[..., 0] + 0.0,  # without negative zeros
        joint_rate=report.joints[..., 1] + 0.0,
        **_forces(mechanism, arrays, motion, report),
        kinetic=report.audit[:, 0].copy(),
        potential=report.audit[:, 1].copy(),
        strain=report.audit[:, 2].copy(),
        applied_work=report.states[:, arrays.place_of_work].copy(),
        applied_power=report.powers.copy(),
        constraint_residual=report.audit[:, 3].copy(),
        velocity_residual=report.audit[:, 4].copy(),
    )


def body_motion(modes: Iterable[int], arrays: SystemArrays, report: Report) -> BodyMotion:
    """The states of a report by bodies, which have so many `modes` each."""
    b, n, times = arrays.bodies, arrays.speeds, len(report.times)
    states, end = report.states, n + arrays.bodies
    modal = states[:, 7 * b : end], states[:, end + 6 * b : end + n], report.rates[:, 6 * b :]
    return BodyMotion(
        states[:, : 7 * b].reshape(times, b, 7),
        states[:, end : end + 6 * b].reshape(times, b, 6),
        report.rates[:, : 6 * b].reshape(times, b, 6),
        modal,
        np.cumsum([0, *modes]),
    )


def _stacked(items: list[np.ndarray], times: int) -> Any:
    return np.stack(items, axis=1) if items else np.zeros((times, 0, 3))


def _by_body(mechanism: FlexibleMechanism, motion: BodyMotion, modal: np.ndarray) -> tuple[np.ndarray, ...]:
    """Modal coordinates, or their rates, of every flexible body."""
    return tuple(
        modal[:, motion.first[k] : motion.first[k + 1]].copy()
        for k, body in enumerate(mechanism.bodies)
        if body.modes
    )


def _forces(
    mechanism: FlexibleMechanism, arrays: SystemArrays, motion: BodyMotion, report: Report
) -> dict[str, np.ndarray]:
    """Reactions of joints, forces of pins, efforts of motions."""
    joints, pins = len(mechanism.joints), len(mechanism.pins)
    reactions = [_reaction(motion, mechanism.joints[k], report.wrenches[:, k]) for k in range(joints)]
    motions = joints + pins + len(mechanism.motions)
    first_rows = arrays.groups["first_row"][joints + pins : motions]
    return {
        "reaction_force": _stacked([force for force, _ in reactions], len(motion.q)),
        "reaction_torque": _stacked([torque for _, torque in reactions], len(motion.q)),
        "holding_force": report.wrenches[:, joints : joints + pins, 1, :3].copy(),
        "driver_effort": report.multipliers[:, first_rows].copy(),
    }


def _reaction(motion: BodyMotion, joint: PointJoint, wrenches: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Force and torque (T, 3) on body b at its first point: what its body bears, or the other's opposite."""
    point = reaction_point(joint)
    side, sign, body = (1, 1.0, point.body) if point.body >= 0 else (0, -1.0, joint.a[0].body)
    q, wrench = motion.q[:, body], sign * wrenches[:, side]
    force = wrench[:, :3].copy()
    arm = motion.point(point)[0] - q[:, :3]
    return force, global_axes(q[:, 3:], wrench[:, 3:]) - cross_rows(arm, force)
