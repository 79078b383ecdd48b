"""Equations of single coordinates: simplified, distance and ground constraints, drivers, normalisation.

Liang Yong (1996), sections 4.2.7 and 4.2.8 and Appendix A, unit YOUNG_4.  No error of these shows in a
listing.  The function of a driver is taken as C + B t + A t²/2, where the scan of the source reads A t/2.
"""

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ...model.attitudes import held_coordinate
from ...model.mechanism import Mechanism

if TYPE_CHECKING:
    from ...model.mechanism import Distance


@dataclass(frozen=True)
class Single:
    """One equation: coefficients by coordinate (7 body + k), residual, right-hand sides."""

    coefficients: dict[int, float]
    residual: float
    nu: float = 0.0
    gamma: float = 0.0


def held(mechanism: Mechanism, q: np.ndarray) -> list[Single]:
    """Simplified and distance constraints, then grounded bodies; q (bodies, 7)."""
    found = [_value(q, item.body, item.direction, item.value) for item in mechanism.simplified]
    found += [_difference(q, item) for item in mechanism.distances]
    for ground in mechanism.grounds:
        found += [_value(q, ground.body, k, value) for k, value in enumerate(ground.values, start=1)]
    return found


def _value(q: np.ndarray, body: int, direction: int, value: float) -> "Single":
    coordinate, target = held_coordinate(direction, value)
    return Single({7 * body + coordinate: 1.0}, q[body, coordinate] - target)


def _difference(q: np.ndarray, item: "Distance") -> "Single":
    coordinate = item.direction - 1 if item.direction <= 3 else item.direction
    gap = q[item.i, coordinate] - q[item.j, coordinate] - item.value
    return Single({7 * item.i + coordinate: 1.0, 7 * item.j + coordinate: -1.0}, gap)


def driven(mechanism: Mechanism, q: np.ndarray, qd: np.ndarray, t: float) -> list[Single]:
    """One equation of a translation, two of a rotation, (4.59) to (4.64); q, qd (bodies, 7)."""
    found = []
    for driver in mechanism.drivers:
        function = driver.C + (driver.B + 0.5 * driver.A * t) * t
        rate, second = driver.B + driver.A * t, driver.A
        first, k = 7 * driver.body, driver.direction
        if k <= 3:
            found.append(Single({first + k - 1: 1.0}, q[driver.body, k - 1] - function, rate, second))
            continue
        e0, ek = q[driver.body, 3], q[driver.body, k]
        e0d, ekd = qd[driver.body, 3], qd[driver.body, k]
        turning = 0.5 * (rate * e0d + second * e0), -0.5 * (rate * ekd + second * ek)
        found.append(Single({first + k: 1.0}, ek - math.sin(0.5 * function), 0.5 * rate * e0, turning[0]))
        found.append(Single({first + 3: 1.0}, e0 - math.cos(0.5 * function), -0.5 * rate * ek, turning[1]))
    return found


def normalised(bodies: list[int], q: np.ndarray, qd: np.ndarray) -> list[Single]:
    """|p|² = 1 of the `bodies`, numbers from 0; q, qd (bodies, 7)."""
    found = []
    for body in bodies:
        p, pd = q[body, 3:], qd[body, 3:]
        coefficients = {7 * body + 3 + k: 2.0 * p[k] for k in range(4)}
        sizes = (float(v[0] * v[0] + v[1] * v[1] + v[2] * v[2] + v[3] * v[3]) for v in (p, pd))
        size, rate = sizes
        found.append(Single(coefficients, size - 1.0, 0.0, -2.0 * rate))
    return found
