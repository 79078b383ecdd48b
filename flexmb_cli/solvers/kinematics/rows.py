"""Report rows: what an analysis of a mechanism delivers, block by block, to the writers."""

import numpy as np

from ...quick_dataclass import dataclass, fields


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
    constraint_residual: np.ndarray  # (T,) largest |Phi|
    velocity_residual: np.ndarray  # (T,) largest |dPhi/dt|
    newton_iterations: np.ndarray  # (T,) int64


def first_rows(rows: Rows, count: int) -> Rows:
    """The first `count` of the rows."""
    return Rows(**{field.name: getattr(rows, field.name)[:count] for field in fields(Rows)})


def joined_rows(first: Rows | None, others: Rows) -> Rows:
    """Rows and those behind them as one block."""
    if first is None:
        return others
    names = [field.name for field in fields(Rows)]
    return Rows(**{name: np.concatenate([getattr(first, name), getattr(others, name)]) for name in names})


def twice_g(p: np.ndarray, rate: np.ndarray) -> np.ndarray:
    """2 G(p) rate (…, 3): angular velocity of ṗ (3.35), angular acceleration of p̈ (3.37), global axes."""
    e0, e1, e2, e3 = np.moveaxis(p, -1, 0)
    r0, r1, r2, r3 = np.moveaxis(rate, -1, 0)
    return 2.0 * np.stack(
        [
            e0 * r1 - e1 * r0 + e2 * r3 - e3 * r2,
            e0 * r2 - e2 * r0 + e3 * r1 - e1 * r3,
            e0 * r3 - e3 * r0 + e1 * r2 - e2 * r1,
        ],
        axis=-1,
    )
