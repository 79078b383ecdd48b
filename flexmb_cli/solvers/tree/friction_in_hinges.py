"""Friction in the hinges of a tree, from the force that all bodies beyond a hinge need by Newton's law."""

from typing import TYPE_CHECKING

import numpy as np

from ...model.joint_elements import JointFriction
from ...model.tree import INERTIAL, ROTATION, TRANSLATION, Tree
from .element_efforts import friction_per_speed

if TYPE_CHECKING:
    from .placed_bodies import PlacedBodies
    from .tree_with_elements import TreeWithElements


class FrictionInHinges:
    """The friction elements of a tree; `number`: of the hinge coordinates by body and name."""

    def __init__(self, tree: Tree, number: dict[tuple[int, str], int]):
        self.tree, self.items = tree, tree.elements.frictions
        self.number = number
        self.preloads = np.array([item.preload for item in self.items])

    def _speeds(self, item: JointFriction, y: np.ndarray) -> dict[int, tuple[float, float]]:
        """Arm, m or 1, and sliding speed of the coordinates of the hinge, by their numbers."""
        hinge, found = self.tree.hinges[item.joint], {}
        for motion, axes, arm in (
            (ROTATION, hinge.rotations, item.radius), (TRANSLATION, hinge.translations, 1.0),
        ):  # fmt: skip
            for axis in axes:
                m = self.number[item.joint, f"{motion} {axis}"]
                found[m] = arm, arm * float(y[m])
        return found

    def efforts(self, normal: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Generalised forces (NS,) of friction under the normal forces."""
        found = np.zeros(y.size)
        for item, N in zip(self.items, normal, strict=True):
            speeds = self._speeds(item, y)
            share = N * friction_per_speed(item, float(np.hypot(*_two(speeds))))
            for m, (arm, v) in speeds.items():
                found[m] -= share * v * arm
        return found

    def answers(self, normal: np.ndarray, y: np.ndarray) -> list[tuple[float, float]]:
        """Sliding speed and force of each; both signed where the hinge has one coordinate."""
        found = []
        for item, N in zip(self.items, normal, strict=True):
            one, other = _two(self._speeds(item, y))
            v = float(np.hypot(one, other))
            signed = v if one and other else one + other
            found.append((signed, -N * friction_per_speed(item, v) * signed))
        return found

    def forces_across(self, analysis: "TreeWithElements", placed: "PlacedBodies") -> np.ndarray:
        """Forces (frictions, 4) between the parts across the axes of the hinges; no hinge has a thread."""
        needed = _needed_forces(analysis, placed)
        found = []
        for item in self.items:
            force = sum(needed[k] for k in range(len(needed)) if self._is_beyond(k, item.joint))
            hinge = self.tree.hinges[item.joint]
            motion, axis = (
                (ROTATION, hinge.rotations[0]) if hinge.rotations else (TRANSLATION, hinge.translations[0])
            )
            along = analysis.coordinates["direction"][self.number[item.joint, f"{motion} {axis}"]]
            found.append([*(force - (force @ along) * along), 0.0])
        return np.array(found)

    def _is_beyond(self, body: int, hinge: int) -> bool:
        while body not in (INERTIAL, hinge):
            body = self.tree.hinges[body].parent
        return body == hinge


def _two(speeds: dict[int, tuple[float, float]]) -> tuple[float, float]:
    one, *other = [v for _, v in speeds.values()]
    return one, other[0] if other else 0.0


def _needed_forces(analysis: "TreeWithElements", placed: "PlacedBodies") -> np.ndarray:
    """Force (N, 3) that each body needs from its hinges: mass times acceleration less all other forces."""
    work, arrays = analysis.work[analysis.frames], analysis.arrays
    needed = np.array([_rate_of_momentum(analysis, placed, work, k) for k in range(len(work))])
    needed -= arrays.frames["force"][analysis.frames]
    for row in arrays.closures:
        for frame, sign in (("frame_a", 1.0), ("frame_b", -1.0)):
            if row[frame] > 0:
                needed[arrays.frames[row[frame]]["body"]] -= sign * row["force"] * row["direction"]
    return needed


def _rate_of_momentum(
    analysis: "TreeWithElements", placed: "PlacedBodies", work: np.ndarray, k: int
) -> np.ndarray:
    """Rate of the momentum of body k less its weight and the forces on its nodes."""
    body, g = analysis.model.bodies[k], np.array(analysis.model.gravity)
    A, w = placed.axes[k], placed.angular[k]
    al, a = work["acceleration"][k, :3], work["acceleration"][k, 3:]
    if body.elastic is None:
        r = A @ np.array(body.centre)
        found: np.ndarray = body.mass * (a + np.cross(al, r) + np.cross(w, np.cross(w, r)) - g)
        return found
    own = placed.elastic(k)
    u, v, rate = (np.zeros((len(body.elastic.masses), 3)) for _ in range(3))
    for x, values in ((u, placed.q), (v, placed.y), (rate, analysis.coordinates["rate"])):
        x[:, np.array(body.elastic.axes) - 1] = values[own].reshape(len(x), -1)
    total = (body.mass - body.elastic.masses.sum()) * (a - g)
    for m, place, moving, pushed in zip(
        body.elastic.masses, body.elastic.positions + u, v, rate, strict=True
    ):
        r, slide = A @ place, A @ moving
        turning = np.cross(al, r) + np.cross(w, np.cross(w, r) + 2.0 * slide)
        total = total + m * (a + turning + A @ pushed - g)
    force: np.ndarray = total - body.elastic.forces.sum(axis=0)
    return force
