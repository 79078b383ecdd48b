"""Positions of the bodies of a tree at an instant, and the forces that elements put on them."""

import numpy as np

from ...model.flexible_mechanism import NodePoint
from ...model.tree import ELASTIC, INERTIAL, Tree
from ...model.vectors import cross


class PlacedBodies:
    """Poses and velocities of all bodies, by the records of their frames, and forces collected on them.

    q, y (NS,): coordinates and speeds.  `force`, `torque` (N, 3): at the origins, inertial axes; `effort`
    (NS,): generalised forces.
    """

    def __init__(self, tree: Tree, frames: np.ndarray, q: np.ndarray, y: np.ndarray):
        self.tree, self.q, self.y = tree, q, y
        self.axes = frames["axes"].reshape(-1, 3, 3)
        self.origin, self.velocity, self.angular = frames["position"], frames["velocity"], frames["angular"]
        self.force, self.torque = np.zeros(self.origin.shape), np.zeros(self.origin.shape)
        self.effort = np.zeros(q.size)

    def elastic(self, body: int) -> np.ndarray:
        """Numbers (NM,) of the elastic coordinates of a body."""
        found = [m for m, c in enumerate(self.tree.coordinates) if c.motion == ELASTIC and c.body == body]
        return np.array(found, int)

    def axes_of(self, body: int) -> np.ndarray:
        """Axes (3, 3) of a body in its columns."""
        return np.eye(3) if body == INERTIAL else self.axes[body]

    def angular_of(self, body: int) -> np.ndarray:
        """Angular velocity (3,) of a body."""
        return np.zeros(3) if body == INERTIAL else self.angular[body]

    def point(self, end: NodePoint) -> tuple[np.ndarray, np.ndarray]:
        """Position and velocity (3,) of a point."""
        if end.body == INERTIAL:
            return end.r0, np.zeros(3)
        own, A = self.elastic(end.body), self.axes[end.body]
        reach = A @ (end.r0 + end.shape @ self.q[own])
        velocity = self.velocity[end.body] + cross(self.angular[end.body], reach)
        return self.origin[end.body] + reach, velocity + A @ (end.shape @ self.y[own])

    def push(self, end: NodePoint, force: np.ndarray) -> None:
        """Add a force (3,) at a point: on its body, and along the elastic coordinates that move it there."""
        if end.body == INERTIAL:
            return
        self.force[end.body] += force
        self.torque[end.body] += cross(self.point(end)[0] - self.origin[end.body], force)
        self.effort[self.elastic(end.body)] += end.shape.T @ (self.axes[end.body].T @ force)

    def twist(self, i: int, j: int, torque: np.ndarray) -> None:
        """Add a torque (3,) on body j and its opposite on body i."""
        for body, sign in ((i, -1.0), (j, 1.0)):
            if body != INERTIAL:
                self.torque[body] += sign * torque
