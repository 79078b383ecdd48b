"""Report rows: what an analysis of a mechanism delivers, block by block, to the writers."""

from dataclasses import dataclass

import numpy as np


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
