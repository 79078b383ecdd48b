"""Relative motion of points and bodies from rows of bodies: distances, velocities, angles without jumps.

Matrices (rows, 3, 3) turn components in body axes into global ones.  Cardan angles are those about x, the new
y and the new z, R = Rx Ry Rz; roll, pitch and yaw those of R = Rz Ry Rx (Wittenburg, Dynamics of Multibody
Systems, 2008, section 2.1).
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from ..hdf5.layout import Values

TURN = 2.0 * np.pi  # rad
AXIS_LOST = 1e-6  # rad: below it the axis of a rotation is that of the row before


class Motion(NamedTuple):
    """The motion of a body or of a point fixed in it, global axes."""

    position: np.ndarray  # (rows, 3), m
    velocity: np.ndarray  # (rows, 3), m/s
    axes: np.ndarray  # of the body, components in them to global ones (rows, 3, 3), pure numbers
    angular_velocity: np.ndarray  # of the body (rows, 3), rad/s


def motion_of(values: Values, body: int, point: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> Motion:
    """Return the motion of a point of a body, counted from 1; body 0 is the ground.

    `point`: body axes, m.
    """
    rows = len(values["time"])
    if body == 0:
        zero = np.zeros((rows, 3))
        return Motion(zero + point, zero, np.broadcast_to(np.eye(3), (rows, 3, 3)), zero)
    at = (slice(None), body - 1)
    axes, omega = _matrices(values["body/euler_parameters"][at]), values["body/angular_velocity"][at]
    arm = axes @ np.asarray(point)
    return Motion(
        values["body/position"][at] + arm, values["body/velocity"][at] + np.cross(omega, arm), axes, omega
    )


def _matrices(parameters: np.ndarray) -> np.ndarray:
    """Return the matrices (rows, 3, 3) of Euler parameters (rows, 4)."""
    e0, e1, e2, e3 = parameters.T
    return np.moveaxis(
        np.array(
            [
                [e0**2 + e1**2 - e2**2 - e3**2, 2 * (e1 * e2 - e0 * e3), 2 * (e1 * e3 + e0 * e2)],
                [2 * (e1 * e2 + e0 * e3), e0**2 - e1**2 + e2**2 - e3**2, 2 * (e2 * e3 - e0 * e1)],
                [2 * (e1 * e3 - e0 * e2), 2 * (e2 * e3 + e0 * e1), e0**2 - e1**2 - e2**2 + e3**2],
            ]
        ),
        -1,
        0,
    )


def _seen(axes: np.ndarray, vectors: np.ndarray) -> np.ndarray:
    """Return global vectors (rows, 3) by their components in other axes."""
    return np.einsum("nji,nj->ni", axes, vectors)


def position(first: Motion, second: Motion, frame: Motion) -> np.ndarray:
    """Return the vector from the first to the second point, axes of a frame (rows, 3), m."""
    return _seen(frame.axes, second.position - first.position)


def velocity(first: Motion, second: Motion, frame: Motion) -> np.ndarray:
    """Return the derivative of `position` in the axes of the frame (rows, 3), m/s."""
    apart = second.position - first.position
    carried = np.cross(frame.angular_velocity, apart)
    return _seen(frame.axes, second.velocity - first.velocity - carried)


def distance(first: Motion, second: Motion, frame: Motion) -> np.ndarray:
    """Return the distance of two points (rows,), m."""
    return np.linalg.norm(second.position - first.position, axis=1)


def distance_rate(first: Motion, second: Motion, frame: Motion) -> np.ndarray:
    """Return the rate of their distance (rows,), m/s; 0 where they coincide."""
    apart, length = second.position - first.position, distance(first, second, frame)
    along = np.einsum("ni,ni->n", apart, second.velocity - first.velocity)
    return np.divide(along, length, out=np.zeros_like(length), where=length > 0)


def angular_velocity(body: Motion, frame: Motion) -> np.ndarray:
    """Return the angular velocity of a body relative to a frame, axes of the frame (rows, 3), rad/s."""
    return _seen(frame.axes, body.angular_velocity - frame.angular_velocity)


def cardan(turned: np.ndarray, omega: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return angles and rates (rows, 3) of R = Rx Ry Rz, of matrices and angular velocities in the frame."""
    x = np.arctan2(-turned[:, 1, 2], turned[:, 2, 2])
    y = np.arctan2(turned[:, 0, 2], np.hypot(turned[:, 0, 0], turned[:, 0, 1]))
    z = np.arctan2(-turned[:, 0, 1], turned[:, 0, 0])
    across = -np.sin(x) * omega[:, 1] + np.cos(x) * omega[:, 2]
    with np.errstate(all="ignore"):
        rates = (
            omega[:, 0] - np.tan(y) * across,
            np.cos(x) * omega[:, 1] + np.sin(x) * omega[:, 2],
            across / np.cos(y),
        )
    return np.column_stack([x, y, z]), np.column_stack(rates)


def roll_pitch_yaw(turned: np.ndarray, omega: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return angles and rates (rows, 3) of R = Rz Ry Rx: roll about x, pitch about y, yaw about z."""
    x = np.arctan2(turned[:, 2, 1], turned[:, 2, 2])
    y = np.arctan2(-turned[:, 2, 0], np.hypot(turned[:, 0, 0], turned[:, 1, 0]))
    z = np.arctan2(turned[:, 1, 0], turned[:, 0, 0])
    along = np.cos(z) * omega[:, 0] + np.sin(z) * omega[:, 1]
    with np.errstate(all="ignore"):
        about_y = -np.sin(z) * omega[:, 0] + np.cos(z) * omega[:, 1]
        rates = np.column_stack([along / np.cos(y), about_y, omega[:, 2] + np.tan(y) * along])
    return np.column_stack([x, y, z]), rates


def rotation_vector(turned: np.ndarray) -> np.ndarray:
    """Return the rotation vectors (rows, 3) of matrices, no longer than pi, by Euler parameters."""
    trace = np.trace(turned, axis1=1, axis2=2)
    # The largest of the four parameters first: no small number is divided by (Shepperd, 1978).
    squares = np.column_stack([trace, *(turned[:, k, k] for k in range(3))])
    squares = 1.0 + np.column_stack([squares[:, 0], *(2 * squares[:, k] - trace for k in (1, 2, 3))])
    sums = turned + np.swapaxes(turned, 1, 2)
    skew = np.column_stack([turned[:, i, j] - turned[:, j, i] for i, j in ((2, 1), (0, 2), (1, 0))])
    quaternions = np.empty((len(turned), 4))
    for n, row in enumerate(squares):
        k = int(np.argmax(row))
        others = skew[n] if k == 0 else np.insert(np.delete(sums[n, k - 1], k - 1), 0, skew[n, k - 1])
        quaternions[n] = np.insert(others / (2 * np.sqrt(row[k])), k, 0.5 * np.sqrt(row[k]))
    quaternions *= np.where(quaternions[:, :1] < 0, -1.0, 1.0)
    sine = np.linalg.norm(quaternions[:, 1:], axis=1)
    angle = 2 * np.arctan2(sine, quaternions[:, 0])
    factor = np.divide(angle, sine, out=np.full_like(sine, 2.0), where=sine > 0)
    return factor[:, None] * quaternions[:, 1:]


@dataclass
class Continued:
    """A quantity whose rows continue those before without jumps: the last row, its rate and time."""

    value: np.ndarray | None = None
    rate: np.ndarray | None = None
    time: float = 0.0

    def of(
        self,
        times: np.ndarray,
        vectors: np.ndarray,
        rates: np.ndarray,
        nearest: Callable[[np.ndarray, np.ndarray], np.ndarray],
    ) -> np.ndarray:
        """Return rows (rows, 3), each the one of its like that is `nearest` to what the rates lead to."""
        rows: list[Any] = []
        for time, value, rate in zip(times.tolist(), vectors, rates, strict=True):
            if self.value is not None and self.rate is not None:
                step = 0.5 * (time - self.time) * (self.rate + rate)
                value = nearest(value, self.value + np.where(np.isfinite(step), step, 0.0))
            self.value, self.rate, self.time = value, rate, time
            rows.append(value)
        return np.array(rows).reshape(-1, 3)


def nearest_angles(angles: np.ndarray, expected: np.ndarray) -> np.ndarray:
    """Return angles with whole turns added, near to expected ones."""
    return angles + TURN * np.round((expected - angles) / TURN)


def nearest_rotation(vector: np.ndarray, expected: np.ndarray) -> np.ndarray:
    """Return the rotation vector of the same rotation that is near to an expected one."""
    angle, length = float(np.linalg.norm(vector)), float(np.linalg.norm(expected))
    if angle < AXIS_LOST:
        axis = expected / length if length > 0 else np.zeros(3)
        return vector + TURN * round(length / TURN) * axis
    axis = vector / angle
    return (angle + TURN * round((float(axis @ expected) - angle) / TURN)) * axis
