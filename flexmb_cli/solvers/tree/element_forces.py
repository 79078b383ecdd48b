"""Forces of all elements of a tree on its bodies, but for friction and couplings, and what they answer."""

import math
from typing import TYPE_CHECKING

import numpy as np

from ...kernels.constrained.elements import NO_LENGTH
from ...model.flexible_mechanism import NodePoint
from ...model.joint_elements import Bushing, EndStop, JointMotor, JointSpring, LineSpring
from ...model.tree import Tree
from ...model.vectors import cross
from .element_efforts import Effort, cable_effort, linear_effort, spring_effort, stop_effort
from .placed_bodies import PlacedBodies

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

Answer = tuple[float, float, float, float, float]
# Columns of answers: coordinate and rate of an element, and the fields of its `Effort`.
COORDINATE, RATE, EFFORT, KEPT, ENERGY = range(5)
OF_BUSHING = 6  # coordinates: three displacements, three angles


class ElementForces:
    """The elements of a tree, whose attitudes at the start are `axes` (N, 3, 3)."""

    def __init__(self, tree: Tree, axes: np.ndarray):
        self.tree, self.elements = tree, tree.elements
        self.number = {(c.body, f"{c.motion} {c.axis}"): m for m, c in enumerate(tree.coordinates)}
        self._turned = [
            self._axes(axes, item.j).T @ self._axes(axes, item.i) for item in self.elements.bushings
        ]
        # Angles of the bushings found last: whole turns continue from them.
        self._angles = np.zeros((len(self.elements.bushings), 3))
        self.overturned: int | None = None  # number of a bushing whose angles jump

    @staticmethod
    def _axes(axes: np.ndarray, body: int) -> np.ndarray:
        return np.eye(3) if body < 0 else axes[body]

    def add_motors(self, placed: PlacedBodies, t: float) -> np.ndarray:
        """Add the efforts of motors at the time t; returns what each answers, (motors, 5)."""
        motors = self.elements.motors
        return filled(len(motors), (self._of_motor(placed, item, t) for item in motors))

    def _of_motor(self, placed: PlacedBodies, item: JointMotor, t: float) -> Answer:
        m, effort = self.number[item.joint, item.coordinate], item.function.at(t)[0]
        placed.effort[m] += effort
        return float(placed.q[m]), float(placed.y[m]), effort, 0.0, 0.0

    def add(self, placed: PlacedBodies) -> np.ndarray:
        """Add the forces of all others; returns what each element answers, (n, 5), in the order of results.

        Objects for the answers of 20,000 bushings would take 40 MB.
        """
        single = self.elements.springs, self.elements.lines, self.elements.stops
        count = sum(map(len, single)) + OF_BUSHING * len(self.elements.bushings)
        return filled(count, self._answers(placed))

    def _answers(self, placed: PlacedBodies) -> "Iterator[Answer]":
        yield from (self._in_joint(placed, item) for item in self.elements.springs)
        yield from (self._in_line(placed, item) for item in self.elements.lines)
        yield from (self._in_joint(placed, item) for item in self.elements.stops)
        self.overturned = None
        for k, item in enumerate(self.elements.bushings):
            if _is_overturned(placed, item, self._turned[k]):
                self.overturned = k
            yield from _along_axes(placed, item)
            yield from _about_axes(placed, item, self._turned[k], self._angles[k])

    def lengths(self, answers: np.ndarray) -> np.ndarray:
        """Return the lengths, m, of the lines among the answers of `add`."""
        first = len(self.elements.springs)
        found: np.ndarray = answers[first : first + len(self.elements.lines), COORDINATE]
        return found

    def _in_joint(self, placed: PlacedBodies, item: JointSpring | EndStop) -> Answer:
        m = self.number[item.joint, item.coordinate]
        x, v = float(placed.q[m]), float(placed.y[m])
        effort = stop_effort(item, x, v) if isinstance(item, EndStop) else spring_effort(item, x, v)
        placed.effort[m] += effort.effort
        return x, v, *effort

    def _in_line(self, placed: PlacedBodies, item: LineSpring) -> Answer:
        (r_i, v_i), (r_j, v_j) = (placed.point(_end(end)) for end in (item.P_i, item.P_j))
        x = float(np.linalg.norm(r_j - r_i))
        unit = (r_j - r_i) / max(x, NO_LENGTH)
        v = float(unit @ (v_j - v_i))
        effort = cable_effort(item, x, v) if item.slack else spring_effort(item, x, v)
        placed.push(_end(item.P_j), effort.effort * unit)
        placed.push(_end(item.P_i), -effort.effort * unit)
        return x, v, *effort


def filled(count: int, answers: "Iterable[Answer]") -> np.ndarray:
    """Return as many answers as rows (count, 5)."""
    found = np.empty((count, 2 + len(Effort._fields)))
    for row, answer in zip(found, answers, strict=True):
        row[:] = answer
    return found


def stored_energy(answers: np.ndarray) -> float:
    """Return what elements that answered so store, J, added in their order."""
    return float(sum(answers[:, ENERGY].tolist()))


def _end(end: object) -> NodePoint:
    """The end of an element of a tree, which is always a point of a body."""
    assert isinstance(end, NodePoint)
    return end


def _along_axes(placed: PlacedBodies, item: Bushing) -> "Iterator[Answer]":
    """Displacements of P_j along the axes of body i.

    A change of them turns with body i: by virtual work its torque is that of the opposite force at P_j.
    """
    (r_i, v_i), (r_j, v_j) = (placed.point(_end(end)) for end in (item.P_i, item.P_j))
    gap, rate = r_j - r_i, v_j - v_i - cross(placed.angular_of(item.i), r_j - r_i)
    for k, axis in enumerate(placed.axes_of(item.i).T):
        x, v = float(axis @ gap), float(axis @ rate)
        effort = linear_effort(item.stiffness[k], item.damping[k], x, v)
        force = effort.effort * axis
        placed.push(_end(item.P_j), force)
        placed.push(_end(item.P_i), -force)
        placed.twist(item.i, -1, cross(gap, force))
        yield x, v, *effort


def _is_overturned(placed: PlacedBodies, item: Bushing, turned: np.ndarray) -> bool:
    """Return whether an axis about which there is a torque has turned through a right angle."""
    cosines = np.sum(placed.axes_of(item.i) * (placed.axes_of(item.j) @ turned), axis=0)
    acts = np.array(item.stiffness[3:]) + np.array(item.damping[3:]) != 0.0
    return bool(np.any(acts & (cosines <= 0.0)))


def _about_axes(
    placed: PlacedBodies, item: Bushing, turned: np.ndarray, angles: np.ndarray
) -> "Iterator[Answer]":
    """Angles from axis y of i to axis y of j in the plane y z of i, and so on in cyclic order.

    Each is the one nearest to that of `angles` (3,), whose place it takes.
    """
    A = placed.axes_of(item.i)
    B = placed.axes_of(item.j) @ turned
    spin = placed.angular_of(item.j) - placed.angular_of(item.i)
    for k in range(3):
        f, g, h = A[:, (k + 1) % 3], A[:, (k + 2) % 3], B[:, (k + 1) % 3]
        c, s = float(f @ h), float(g @ h)
        slope = (c * cross(h, g) - s * cross(h, f)) / (c * c + s * s)
        x, v = angles[k] + math.remainder(math.atan2(s, c) - angles[k], math.tau), float(slope @ spin)
        angles[k] = x
        effort = linear_effort(item.stiffness[3 + k], item.damping[3 + k], x, v)
        placed.twist(item.i, item.j, effort.effort * slope)
        yield x, v, *effort
