"""Attitudes of bodies that a deck itself gives, and the estimates that follow from them."""

import math
from collections.abc import Iterable
from typing import Any

import numpy as np

from .mechanism import Ground, Mechanism, Simplified
from .vectors import length, unit

SQUARE_ROUND_OFF = 1e-15


def held_coordinate(direction: int, value: float) -> tuple[int, float]:
    """Coordinate (0-6) and value that a simplified constraint of `direction` 1-6 holds."""
    return (direction - 1, value) if direction <= 3 else (direction, math.sin(0.5 * value))


class Attitudes:
    """Attitudes that the deck itself gives: estimates, held components, rotational drivers."""

    def __init__(self, mechanism: Mechanism):
        self.bodies = mechanism.bodies
        self.driven = {d.body for d in mechanism.drivers if d.direction > 3}
        self.held: Any = [{} for _ in mechanism.bodies]
        holders: list[Simplified | Ground] = [*mechanism.simplified, *mechanism.grounds]
        for item in holders:
            pairs: Iterable[tuple[int, float]] = (
                [(item.direction, item.value)]
                if isinstance(item, Simplified)
                else enumerate(item.values, start=1)
            )
            for direction, value in pairs:
                if direction > 3:
                    self.held[item.body][direction] = held_coordinate(direction, value)[1]

    def e0(self, body: int) -> float:
        """e0 of a body whose e1, e2, e3 are all held; its sign is the estimate's."""
        return math.copysign(math.sqrt(self._rest(body)), self.bodies[body].p[0])

    def _rest(self, body: int) -> float:
        """Return what the held components leave of |p|² = 1; its root would make much of round-off."""
        rest = 1.0 - sum(value * value for value in self.held[body].values())
        return rest if rest > SQUARE_ROUND_OFF else 0.0

    def estimates(self) -> np.ndarray:
        """Estimates q, with |p| = 1 and the held components of each attitude in their places.

        A held component of ±1 leaves no room for the others, and Newton would creep to their double
        root; so held components go in first, and the free ones share what is left of |p| = 1.
        """
        q = np.empty(7 * len(self.bodies))
        for body, item in enumerate(self.bodies):
            q[7 * body : 7 * body + 3] = item.r
            q[7 * body + 3 : 7 * body + 7] = self._attitude(body)
        return q

    def _attitude(self, body: int) -> np.ndarray:
        p = np.array(self.bodies[body].p)
        held = self.held[body]
        if not held or body in self.driven:
            return unit(p)
        for direction, value in held.items():
            p[direction - 3] = value
        free = [k for k in range(4) if k + 3 not in held]
        rest = self._rest(body)
        size = length(p[free])
        p[free] = p[free] * math.sqrt(rest) / size if size > 0.0 else 0.0
        if size == 0.0:
            p[0] = math.sqrt(rest)
        return p
