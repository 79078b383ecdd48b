"""Report rows: what an analysis of a mechanism delivers, block by block, to the writers."""

from collections.abc import Callable
from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from ...model.mechanism import Mechanism


@dataclass(frozen=True)
class Rows:
    """A block of T consecutive report rows of a mechanism with n bodies and m points.

    Positions, velocities and accelerations in m, m/s, m/s², global axes; angular velocity and
    acceleration in rad/s, rad/s², global axes.  Arrays are float64 but for the iteration counts.
    """

    time: np.ndarray  # (T,)
    position: np.ndarray  # (T, n, 3)
    euler_parameters: np.ndarray  # (T, n, 4)
    velocity: np.ndarray  # (T, n, 3)
    euler_parameter_rates: np.ndarray  # (T, n, 4)
    acceleration: np.ndarray  # (T, n, 3)
    euler_parameter_accelerations: np.ndarray  # (T, n, 4)
    angular_velocity: np.ndarray  # (T, n, 3)
    angular_acceleration: np.ndarray  # (T, n, 3)
    point_position: np.ndarray  # (T, m, 3)
    point_velocity: np.ndarray  # (T, m, 3)
    point_acceleration: np.ndarray  # (T, m, 3)
    joint_coordinate: np.ndarray  # (T, joint coordinates) rad or m, 0 at the estimates of the deck
    joint_rate: np.ndarray  # (T, joint coordinates) its rate
    constraint_residual: np.ndarray  # (T,) largest |Phi|
    velocity_residual: np.ndarray  # (T,) largest |dPhi/dt|
    newton_iterations: np.ndarray  # (T,) int64


def rows_of(
    mechanism: Mechanism,
    times: np.ndarray,
    states: np.ndarray,
    audit: np.ndarray,
    joints: Callable[[Rows], tuple[np.ndarray, np.ndarray]],
    s: np.ndarray | None = None,
) -> Rows:
    """Report rows from states (T, 3, 7 n): positions, velocities and accelerations of all coordinates.

    joints: returns joint coordinates and their rates; s (T, points, 3): points of interest, body axes, m,
    where they are others in each row.
    """
    q, qd, qdd = (states[:, k].reshape(len(times), -1, 7) for k in range(3))
    if s is None:
        s = np.array([point.s for point in mechanism.points], dtype=float).reshape(-1, 3)
    bodies = np.array([point.body for point in mechanism.points], dtype=np.int64)
    return _RowsOfMotion(
        (bodies, s, q, qd, qdd),
        joints,
        time=np.asarray(times),
        position=q[:, :, :3],
        euler_parameters=q[:, :, 3:],
        velocity=qd[:, :, :3],
        euler_parameter_rates=qd[:, :, 3:],
        acceleration=qdd[:, :, :3],
        euler_parameter_accelerations=qdd[:, :, 3:],
        constraint_residual=audit[:, 0].copy(),
        velocity_residual=audit[:, 1].copy(),
        newton_iterations=audit[:, 2].astype(np.int64),
    )


_POINT_FIELDS = "point_position", "point_velocity", "point_acceleration"
_JOINT_FIELDS = "joint_coordinate", "joint_rate"
_RATES = {
    "angular_velocity": "euler_parameter_rates",
    "angular_acceleration": "euler_parameter_accelerations",
}


class _RowsOfMotion(Rows):
    """Rows that calculate motion other than that of origins when requested first: a sweep needs little."""

    def __init__(
        self,
        motion_of_points: tuple[np.ndarray, ...],
        joints: Callable[[Rows], tuple[np.ndarray, np.ndarray]],
        **fields: Any,
    ):
        self.__dict__.update(fields, _motion=motion_of_points, _joints=joints)

    def __getattr__(self, name: str) -> Any:
        if name in _RATES:
            self.__dict__[name] = twice_g(self.euler_parameters, getattr(self, _RATES[name]))
        elif name in _POINT_FIELDS:
            self.__dict__.update(zip(_POINT_FIELDS, point_motion(*self._motion), strict=True))
        elif name in _JOINT_FIELDS:
            self.__dict__.update(zip(_JOINT_FIELDS, self._joints(self), strict=True))
        else:
            raise AttributeError(name)
        return self.__dict__[name]


def first_rows(rows: Rows, count: int) -> Rows:
    """The first `count` of the rows."""
    if count == rows.time.size:
        return rows
    return Rows(**{field.name: getattr(rows, field.name)[:count] for field in fields(Rows)})


def joined_rows(first: Rows | None, others: Rows) -> Rows:
    """Rows and those after them as one block."""
    if first is None:
        return others
    names = [field.name for field in fields(Rows)]
    return Rows(**{name: np.concatenate([getattr(first, name), getattr(others, name)]) for name in names})


def twice_g(p: np.ndarray, rate: np.ndarray) -> np.ndarray:
    """2 G(p) rate (…, 3): angular velocity of ṗ (3.35), angular acceleration of p̈ (3.37), global axes."""
    e0, e1, e2, e3 = (p[..., k] for k in range(4))
    r0, r1, r2, r3 = (rate[..., k] for k in range(4))
    return 2.0 * np.stack(
        [
            e0 * r1 - e1 * r0 + e2 * r3 - e3 * r2,
            e0 * r2 - e2 * r0 + e3 * r1 - e1 * r3,
            e0 * r3 - e3 * r0 + e1 * r2 - e2 * r1,
        ],
        axis=-1,
    )


def point_motion(
    bodies: np.ndarray, s: np.ndarray, q: np.ndarray, qd: np.ndarray, qdd: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Position, velocity, acceleration (T, points, 3) of the points s of bodies (points,), global axes."""
    q, qd, qdd = q[:, bodies], qd[:, bodies], qdd[:, bodies]
    p, pd, pdd = q[..., 3:], qd[..., 3:], qdd[..., 3:]
    # A s = b(p, p) is quadratic in p, so its derivatives are 2 b(p, ṗ) and 2 b(ṗ, ṗ) + 2 b(p, p̈).
    return (
        q[..., :3] + rotated(p, p, s),
        qd[..., :3] + 2.0 * rotated(p, pd, s),
        qdd[..., :3] + 2.0 * (rotated(pd, pd, s) + rotated(p, pdd, s)),
    )


def rotated(p: np.ndarray, r: np.ndarray, s: np.ndarray) -> np.ndarray:
    """G(p) L(r)ᵀ s (…, 3) by (3.26), p and r (…, 4), s (…, 3) in body axes; symmetrical in p and r.

    A s for p = r, half of dA/dt s for r = ṗ.
    """
    p0, p1, p2, p3 = (p[..., k] for k in range(4))
    r0, r1, r2, r3 = (r[..., k] for k in range(4))
    x, y, z = (s[..., k] for k in range(3))
    rs, ps = r1 * x + r2 * y + r3 * z, p1 * x + p2 * y + p3 * z
    scalar = p0 * r0 - p1 * r1 - p2 * r2 - p3 * r3
    # p0 r × s + r0 p × s
    c1, c2, c3 = p0 * r1 + r0 * p1, p0 * r2 + r0 * p2, p0 * r3 + r0 * p3
    return np.stack(
        [
            scalar * x + rs * p1 + ps * r1 + c2 * z - c3 * y,
            scalar * y + rs * p2 + ps * r2 + c3 * x - c1 * z,
            scalar * z + rs * p3 + ps * r3 + c1 * y - c2 * x,
        ],
        axis=-1,
    )
