"""Input of the kernels of a kinematic analysis, and the quantities derived from its coordinates."""

from typing import Any

import numpy as np

from ...kernels.kinematics.newton import COLUMN, RANK, System
from ...model.arrays.kinematic import KinematicArrays
from ...model.joints import DRIVER, SIMPLIFIED
from ...model.mechanism import Mechanism
from .rows import Rows, twice_g
from .settings import KinematicSettings


def kinematic_system(arrays: KinematicArrays, settings: KinematicSettings) -> System:
    """The kernels' view of a mechanism.

    Bodies at rest come first among the columns, and held or driven coordinates first among the
    rows: elimination then finds them as pivots and leaves zeros behind.
    """
    constraints = arrays.constraints
    simple = np.isin(constraints["kind"], (SIMPLIFIED.code, DRIVER.code))
    of_row = np.searchsorted(constraints["first_row"], np.arange(len(arrays.equations)), side="right") - 1
    order = np.argsort(~simple[of_row], kind="stable")
    held = np.bincount(constraints["body_i"][simple], minlength=len(arrays.body_names))
    column = np.empty(arrays.q.size, dtype=np.int64)
    for position, body in enumerate(np.argsort(-held, kind="stable")):
        column[7 * body : 7 * body + 7] = np.arange(7 * position, 7 * position + 7)
    # Fewer equations than coordinates can be evaluated, though not solved: the table is padded.
    places, units = np.zeros((arrays.q.size, 4), dtype=np.int64), np.ones((2, arrays.q.size))
    places[: len(order), :2], places[: len(order), 2], places[:, COLUMN] = arrays.bodies_of, order, column
    units[0, : len(order)], units[1] = 1.0 / arrays.row_scale, arrays.column_scale
    return System(
        constraints,
        places,
        units,
        np.array([settings.tolerance, settings.smallest_pivot, settings.most_iterations, arrays.q.size]),
    )


def with_dependent_columns(system: System, dependent: Any) -> System:
    """The system for a position at which the coordinates `dependent` follow from the others.

    They are eliminated last, and their corrections and rates are 0.
    """
    places = system.places.copy()
    order = np.argsort(
        places[:, COLUMN] + system.places.shape[0] * np.isin(np.arange(len(places)), dependent)
    )
    places[order, COLUMN] = np.arange(len(places))
    limits = system.limits.copy()
    limits[RANK] -= len(dependent)
    return system._replace(places=places, limits=limits)


def rows_of(mechanism: Mechanism, times: np.ndarray, states: np.ndarray, audit: np.ndarray) -> Rows:
    """Report rows from states (T, 3, 7 n): positions, velocities and accelerations of all coordinates."""
    q, qd, qdd = (states[:, k].reshape(len(times), -1, 7) for k in range(3))
    p, pd, pdd = q[:, :, 3:], qd[:, :, 3:], qdd[:, :, 3:]
    points = point_motion(mechanism, q, qd, qdd)
    return Rows(
        time=np.asarray(times),
        position=q[:, :, :3],
        euler_parameters=p,
        velocity=qd[:, :, :3],
        euler_parameter_rates=pd,
        acceleration=qdd[:, :, :3],
        euler_parameter_accelerations=pdd,
        angular_velocity=twice_g(p, pd),
        angular_acceleration=twice_g(p, pdd),
        point_position=points[0],
        point_velocity=points[1],
        point_acceleration=points[2],
        constraint_residual=audit[:, 0].copy(),
        velocity_residual=audit[:, 1].copy(),
        newton_iterations=audit[:, 2].astype(np.int64),
    )


def point_motion(mechanism: Mechanism, q: np.ndarray, qd: np.ndarray, qdd: np.ndarray) -> Any:
    """Position, velocity, acceleration (T, points, 3) of the points of interest, global axes."""
    body = np.array([point.body for point in mechanism.points], dtype=np.int64)
    s = np.array([point.s for point in mechanism.points], dtype=float).reshape(-1, 3)
    q, qd, qdd = q[:, body], qd[:, body], qdd[:, body]
    p, pd, pdd = q[..., 3:], qd[..., 3:], qdd[..., 3:]
    # A s = b(p, p) is quadratic in p, so its derivatives are 2 b(p, ṗ) and 2 b(ṗ, ṗ) + 2 b(p, p̈).
    return (
        q[..., :3] + rotated(p, p, s),
        qd[..., :3] + 2.0 * rotated(p, pd, s),
        qdd[..., :3] + 2.0 * (rotated(pd, pd, s) + rotated(p, pdd, s)),
    )


def rotated(p: np.ndarray, r: np.ndarray, s: np.ndarray) -> np.ndarray:
    """G(p) L(r)ᵀ s (3.26), symmetrical in p and r: A s for p = r, half of dA/dt s for r = ṗ."""
    p0, p1, p2, p3 = np.moveaxis(p, -1, 0)
    r0, r1, r2, r3 = np.moveaxis(r, -1, 0)
    x, y, z = s.T
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
