"""Conversion of a dialect's model into a rigid model: the parts that all dialects share."""

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from ...errors import Place
from ..joint_elements import Bushing
from ..joints import ANGLE
from ..mechanism import GROUND, Vector
from ..vectors import rotation_matrix
from .rigid_model import Refusals, RigidBody, RigidModel, vector
from .shapes import RigidShape
from .start import Pair, Start, angle_between, stroke_between

Pose = tuple[np.ndarray, np.ndarray]  # origin (3,), m, and rotation matrix (3, 3), body to global axes
End = tuple[int, Vector]  # body of the new model, and a point on it
SAME_ATTITUDE = 1e-9  # rad


class Conversion(ABC):
    """Collects the parts of a rigid model, at the `start` of a model, and the items it cannot carry over.

    `now`: poses of the bodies at the start.
    """

    def __init__(self, start: Start):
        self.start, self.refusals = start, Refusals()
        self.now: list[Pose] = [(r, rotation_matrix(p)) for r, p in zip(start.r, start.p, strict=True)]

    @abstractmethod
    def model(self) -> RigidModel:
        """Return the rigid model, but for the shapes of its bodies."""

    def converted(self, shapes: Callable[[], tuple[RigidShape, ...]]) -> RigidModel:
        """Return the model with `shapes`; raises ModelError with all that is not converted."""
        found = replace(self.model(), shapes=shapes())
        self.refusals.raise_faults()
        return found

    def bushing(self, item: Bushing, ends: tuple[End, End], first: list[Pose]) -> Bushing | None:
        """Return a bushing between `ends` (new body, point), or None where other dialects have none like it.

        `first`: poses in which its frames coincide in attitude, which in the new deck do so at the start.
        """
        (i, P_i), (j, P_j) = ends
        turned = _turn_since(first, self.now, item.i, item.j)
        if any((*item.stiffness[3:], *item.damping[3:])) and turned > SAME_ATTITUDE:
            message = f"the bodies of the bushing have turned by {turned:.3g} rad from where it has no torque"
            self.refusals.add(
                item, f"{message} at the start; other dialects begin without torque", id="MODEL-018"
            )
            return None
        if i == GROUND != item.i and not np.allclose(self.now[item.i][1], np.eye(3), atol=SAME_ATTITUDE):
            self.refusals.add(
                item,
                "the axes of a bushing are those of body I, which is grounded and turned",
                id="MODEL-019",
            )
            return None
        return replace(item, i=i, j=j, P_i=P_i, P_j=P_j)

    def rigid_body(self, k: int, name: str, masses: tuple[float, Any, Any], place: Place | None) -> RigidBody:
        """Return body k at the start; `masses`: mass, its centre (3,), moments (3, 3) about it, body axes."""
        start, (mass, centre, moments) = self.start, masses
        motion = start.r[k], start.p[k], start.v[k], start.omega[k]
        return RigidBody(name, *motion, mass, centre, moments, place)


def place_of(point: Any) -> Vector:
    """Return a node's place, or a point of a rigid body, in the axes of its body."""
    return vector(getattr(point, "r0", point))


def _turn_since(first: list[Pose], now: list[Pose], i: int, j: int) -> float:
    """Angle by which body j has turned against body i between two sets of poses; -1: the ground."""
    still = np.eye(3)
    relative = [
        (poses[i][1] if i != GROUND else still).T @ (poses[j][1] if j != GROUND else still)
        for poses in (first, now)
    ]
    return float(np.linalg.norm(relative[0] - relative[1]) / 2.0**0.5)


def about_centre(mass: float, centre: np.ndarray, inertia: np.ndarray) -> np.ndarray:
    """Return moments of inertia (3, 3) about the mass centre (3,), of those about the origin (Steiner)."""
    c = centre
    found: np.ndarray = np.asarray(inertia, float) - mass * (c @ c * np.eye(3) - np.outer(c, c))
    return found


def coordinate_since(
    coordinate: str, axis: tuple[Any, Any, Any], bodies: tuple[int, int], poses: tuple[list[Pose], list[Pose]]
) -> float:
    """Return an angle or a stroke of a joint since the first of two sets of poses.

    `axis`: s_i, P_i and P_j in the axes of their bodies; `bodies`: the numbers i and j.
    """
    i, j = bodies
    first, now = (Pair(*set_of[i], *set_of[j]) for set_of in poses)
    if coordinate == ANGLE:
        return angle_between(axis[0], first, now)
    return stroke_between(*axis, first, now)
