"""Report rows of a dynamic analysis: the motion, and the forces and energies that go with it."""

from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from ...kernels.constrained.report import Report
from ...model.loads import DynamicModel, holders
from ...model.mechanism import Mechanism
from ...model.vectors import cross_rows, global_axes
from ..kinematics.rows import Rows, rotated, rows_of

GROUND_ROWS = 6


@dataclass(frozen=True)
class DynamicRows(Rows):
    """Rows with forces in N, torques in N m and energies in J; vectors in global axes.

    Reactions act on body J of each joint at its point P_j.  Holding forces act on the bodies of
    simplified constraints, distance constraints and grounds at their origins, see `model.loads.holders`.
    Without errors total = kinetic + potential - applied_work stays constant.
    """

    reaction_force: np.ndarray  # (T, joints, 3)
    reaction_torque: np.ndarray  # (T, joints, 3)
    driver_effort: np.ndarray  # (T, drivers) force or torque along the driver's direction
    holding_force: np.ndarray  # (T, held, 3)
    holding_torque: np.ndarray  # (T, held, 3)
    kinetic: np.ndarray  # (T,)
    potential: np.ndarray  # (T,) of gravity and springs
    applied_work: np.ndarray  # (T,) of drivers and all other loads since the start
    applied_power: np.ndarray  # (T,) its rate, W

    @property
    def total(self) -> np.ndarray:
        """Energy that nothing changes but errors (T,), J."""
        return self.kinetic + self.potential - self.applied_work


def dynamic_rows(model: DynamicModel, report: Report, place_of_work: int) -> DynamicRows:
    """The rows of a report in the terms of the model; `place_of_work` of the loads in a state."""
    mechanism = model.mechanism
    bodies, times = len(mechanism.bodies), len(report.times)
    q = report.states[:, : 7 * bodies].reshape(times, bodies, 7)
    u = report.states[:, 7 * bodies : 13 * bodies].reshape(times, bodies, 6)
    ud = report.rates.reshape(times, bodies, 6)
    # Bodies at rest have accelerations in a row, too, of which round-off rules the equations.
    grounded = [ground.body for ground in mechanism.grounds]
    ud[:, grounded] = np.where(np.isnan(ud[:, grounded]), 0.0, ud[:, grounded])
    states = np.stack([q, coordinate_rates(q, u), coordinate_accelerations(q, u, ud)], axis=1)
    audit = np.column_stack([report.audit[:, 3], report.audit[:, 4], np.zeros(times)])
    joints = report.joints[..., 0] + 0.0, report.joints[..., 1] + 0.0  # without negative zeros
    motion = rows_of(mechanism, report.times, states.reshape(times, 3, -1), audit, lambda rows: joints)
    of_motion = {field.name: getattr(motion, field.name) for field in fields(Rows)}
    return DynamicRows(
        **of_motion,
        **_forces(mechanism, report.wrenches, q[..., 3:]),
        kinetic=report.audit[:, 0].copy(),
        potential=report.audit[:, 1].copy(),
        applied_work=report.states[:, place_of_work].copy(),
        applied_power=report.powers.copy(),
    )


def parameter_rates(p: np.ndarray, w: np.ndarray) -> np.ndarray:
    """½ Lᵀ w (…, 4) for Euler parameters p (…, 4) and w (…, 3) in body axes."""
    e0, e = p[..., :1], p[..., 1:]
    return 0.5 * np.concatenate([-np.sum(e * w, -1, keepdims=True), e0 * w + cross_rows(e, w)], axis=-1)


def coordinate_rates(q: np.ndarray, u: np.ndarray) -> np.ndarray:
    """Rates (…, 7) of the coordinates q (…, 7) of bodies with speeds u (…, 6)."""
    return np.concatenate([u[..., :3], parameter_rates(q[..., 3:], u[..., 3:])], axis=-1)


def coordinate_accelerations(q: np.ndarray, u: np.ndarray, ud: np.ndarray) -> np.ndarray:
    """Second derivatives (…, 7) of the coordinates, from speeds and their rates (…, 6)."""
    p, w = q[..., 3:], u[..., 3:]
    turning = 0.25 * np.sum(w * w, -1, keepdims=True) * p
    return np.concatenate([ud[..., :3], parameter_rates(p, ud[..., 3:]) - turning], axis=-1)


def body_axes(p: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Vectors v (…, 3), global axes, in the axes of bodies with Euler parameters p (…, 4)."""
    conjugate = p * np.array([1.0, -1.0, -1.0, -1.0])
    return global_axes(conjugate, v)


def _forces(mechanism: Mechanism, wrenches: np.ndarray, p: np.ndarray) -> dict[str, np.ndarray]:
    """Reactions, efforts and holding forces from the wrenches (T, constraints, 2, 6)."""
    joints, simplified = len(mechanism.joints), len(mechanism.simplified)
    held_pairs, drivers = len(mechanism.distances), len(mechanism.drivers)
    ends = np.cumsum([joints, simplified, held_pairs, drivers, GROUND_ROWS * len(mechanism.grounds)])
    of_joints, of_simplified, of_distances, of_drivers, of_grounds, others = np.split(wrenches, ends, axis=1)
    grounds = of_grounds.reshape(len(wrenches), -1, GROUND_ROWS, 2, 6).sum(axis=2)
    pairs = of_distances.reshape(len(wrenches), -1, 6)
    holding = np.concatenate([of_simplified[:, :, 0], pairs, grounds[:, :, 0]], axis=1)
    _add_fourth_parameters(mechanism, others[:, :, 0], holding)
    on = [body for _, body in holders(mechanism)]
    force, torque = _reactions(mechanism, of_joints[:, :, 1], p)
    return {
        "reaction_force": force,
        "reaction_torque": torque,
        "driver_effort": _efforts(mechanism, of_drivers[:, :, 0], p),
        "holding_force": holding[..., :3].copy(),
        "holding_torque": global_axes(p[:, on], holding[..., 3:]),
    }


def _add_fourth_parameters(mechanism: Any, others: np.ndarray, holding: np.ndarray) -> None:
    """A body whose e1, e2, e3 are held has an equation for e0; its force is its holder's.

    others (T, bodies so held, 6) in the order of the bodies.
    """
    place: dict[int, int] = {}
    angles: dict[int, int] = {}
    first_ground = len(mechanism.simplified) + 2 * len(mechanism.distances)
    for k, item in enumerate(mechanism.grounds):
        place.setdefault(item.body, first_ground + k)
    for k, item in enumerate(mechanism.simplified):
        if item.direction > 3:
            angles[item.body] = angles.get(item.body, 0) + 1
            if angles[item.body] == 3:
                place.setdefault(item.body, k)
    for k, body in enumerate(sorted(place)):
        holding[:, place[body]] += others[:, k]


def _reactions(mechanism: Mechanism, wrench: np.ndarray, p: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    on = [joint.j for joint in mechanism.joints]
    P = np.array([joint.P_j for joint in mechanism.joints], dtype=float).reshape(-1, 3)
    force = wrench[..., :3].copy()
    arm = rotated(p[:, on], p[:, on], P)
    return force, global_axes(p[:, on], wrench[..., 3:]) - cross_rows(arm, force)


def _efforts(mechanism: Mechanism, wrench: np.ndarray, p: np.ndarray) -> np.ndarray:
    on = [driver.body for driver in mechanism.drivers]
    force, torque = wrench[..., :3], global_axes(p[:, on], wrench[..., 3:])
    both = np.concatenate([force, torque], axis=-1)
    directions = np.array([driver.direction - 1 for driver in mechanism.drivers], dtype=np.int64)
    return np.take_along_axis(both, directions[None, :, None], axis=2)[..., 0]
