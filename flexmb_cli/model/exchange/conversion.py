"""Conversion of a dialect's model into a rigid model: the parts that all dialects share."""

from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import Any

import numpy as np

from ...errors import Fault, Place
from ...quick_dataclass import replace
from ..joints import ANGLE
from ..vectors import rotation_matrix
from .rigid_model import Refusals, RigidBody, RigidModel
from .shapes import RigidShape
from .start import Pair, Start, angle_between, stroke_between

Pose = tuple[np.ndarray, np.ndarray]  # origin (3,), m, and rotation matrix (3, 3), body to global axes
# (message, place, name) of an item that is not converted: the dialect's fault
Refused = Callable[[str, Place | None, str], Fault]


class Conversion(ABC):
    """Collects the parts of a rigid model, at the `start` of a model, and the items it cannot carry over.

    `now`: poses of the bodies at the start.
    """

    def __init__(self, start: Start, refused: Refused):
        self.start, self.refusals, self._refused = start, Refusals(), refused
        self.now: list[Pose] = [(r, rotation_matrix(p)) for r, p in zip(start.r, start.p, strict=True)]

    @abstractmethod
    def model(self) -> RigidModel:
        """Return the rigid model, but for the shapes of its bodies."""

    def converted(self, shapes: Callable[[], tuple[RigidShape, ...]]) -> RigidModel:
        """Return the model with `shapes`; raises ModelError with all that is not converted."""
        found = replace(self.model(), shapes=shapes())
        self.refusals.raise_faults(self._refused)
        return found

    def rigid_body(self, k: int, name: str, masses: tuple[float, Any, Any], place: Place | None) -> RigidBody:
        """Return body k at the start; `masses`: mass, its centre (3,), moments (3, 3) about it, body axes."""
        start, (mass, centre, moments) = self.start, masses
        motion = start.r[k], start.p[k], start.v[k], start.omega[k]
        return RigidBody(name, *motion, mass, centre, moments, place)


def about_centre(mass: float, centre: np.ndarray, inertia: Any) -> np.ndarray:
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
