"""A mechanism of rigid bodies at its start, in terms that every dialect can be read into and written from.

The model begins at t = 0 with the assembled positions and speeds, and all joint coordinates are 0 there.
Bodies are numbered from 0; -1 is the ground, whose axes are global.  SI units; local vectors are in the axes
of their body.
"""

import math
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from ...errors import Fault, ModelError, Place
from ..integrators import Integrator
from ..joint_elements import Coupling, JointDriver
from ..laws import Element
from ..loads import AppliedForce, AppliedTorque
from ..mechanism import GROUND, Point, TimeGrid, Vector
from ..shapes import ShapeCard, turning
from ..time_functions import MotionFunction
from ..vectors import rotation_matrix


@dataclass(frozen=True, eq=False)
class RigidBody:
    """A body: `r` and Euler parameters `p` of its axes, velocity of its origin, angular velocity, global.

    `centre`: mass centre, body axes; `inertia` (3, 3) about it, body axes.  `mass` 0: a massless body.
    """

    name: str
    r: np.ndarray
    p: np.ndarray
    velocity: np.ndarray
    omega: np.ndarray
    mass: float
    centre: np.ndarray
    inertia: np.ndarray
    place: Place | None = None

    @property
    def A(self) -> np.ndarray:
        """Rotation matrix (3, 3), body to global axes."""
        return rotation_matrix(self.p)

    @property
    def moments(self) -> tuple[float, ...]:
        """Moments of inertia xx, yy, zz, xy, yz, zx about the mass centre, kg m²."""
        J = self.inertia
        return J[0, 0], J[1, 1], J[2, 2], J[0, 1], J[1, 2], J[2, 0]


@dataclass(frozen=True)
class RigidJoint:
    """A joint of `kind` between bodies `i` and `j`, with points P and vectors s along the axes (or arms).

    The types are those of `joint_types`, and "fixed", "revolute-spherical" (its axis on body i) and
    "spherical-spherical".  `size`: pitch, m/rad, or length of the link, m.
    """

    name: str
    kind: str
    i: int
    j: int
    P_i: Vector
    P_j: Vector
    s_i: Vector = (0.0, 0.0, 0.0)
    s_j: Vector = (0.0, 0.0, 0.0)
    size: float = 0.0
    place: Place | None = None


@dataclass(frozen=True)
class BodyDriver:
    """A coordinate of a body that follows a function: directions 1-3 x y z, 4-6 turns about global x y z."""

    name: str
    body: int
    direction: int
    function: MotionFunction
    place: Place | None = None


@dataclass(frozen=True)
class RigidModel:
    """A rigid mechanism in the order of the deck.  `notes`: remarks for the reader of the new deck."""

    bodies: tuple[RigidBody, ...]
    time: TimeGrid
    gravity: Vector = (0.0, 0.0, 0.0)
    joints: tuple[RigidJoint, ...] = ()
    drivers: tuple[BodyDriver, ...] = ()
    joint_drivers: tuple[JointDriver, ...] = ()
    forces: tuple[AppliedForce, ...] = ()
    torques: tuple[AppliedTorque, ...] = ()
    points: tuple[Point, ...] = ()
    integrator: Integrator = field(default_factory=lambda: Integrator(tolerance=1e-12))
    notes: tuple[str, ...] = ()
    shapes: tuple[ShapeCard, ...] = ()
    elements: tuple[Element, ...] = ()  # bushings' frames coincide in attitude at the start
    couplings: tuple[Coupling, ...] = ()

    def axes(self, body: int) -> np.ndarray:
        """Rotation matrix (3, 3) of a body or of the ground."""
        return np.eye(3) if body == GROUND else self.bodies[body].A

    def position(self, body: int, point: Any) -> np.ndarray:
        """Global position (3,) at the start of a point of a body or of the ground."""
        point = np.asarray(point, float)
        return point if body == GROUND else self.bodies[body].r + self.bodies[body].A @ point

    def velocity(self, body: int, point: Any) -> np.ndarray:
        """Global velocity (3,) at the start of a point of a body or of the ground."""
        if body == GROUND:
            return np.zeros(3)
        own = self.bodies[body]
        return own.velocity + np.cross(own.omega, own.A @ np.asarray(point, float))

    def angular_velocity(self, body: int) -> np.ndarray:
        """Angular velocity (3,) at the start, global axes."""
        return np.zeros(3) if body == GROUND else self.bodies[body].omega

    def axis(self, joint: RigidJoint) -> np.ndarray:
        """Unit vector (3,) along the axis of a joint at the start, global axes."""
        s = self.axes(joint.i) @ np.array(joint.s_i)
        return s / np.linalg.norm(s)


def across(axis: np.ndarray) -> np.ndarray:
    """A unit vector (3,) at right angles to an axis."""
    g = np.cross(axis, np.eye(3)[int(np.argmin(np.abs(axis)))])
    return g / np.linalg.norm(g)


def vector(values: Any) -> Vector:
    """Three numbers as Python has them."""
    x, y, z = (float(value) for value in values)
    return x, y, z


class Refusals:
    """Items that a conversion cannot carry over, collected."""

    def __init__(self) -> None:
        self.items: list[Fault] = []

    def add(self, item: Any, message: str, *, id: str) -> None:
        """Refuse an item, which has a name and a place in its deck."""
        self.items.append(Fault("error", message, item.place, item.name, id=id))

    def raise_faults(self) -> None:
        """Raise ModelError if an item was refused."""
        if self.items:
            raise ModelError(self.items)


_FLAT = 1e-12  # cosine of the second angle below which the other two turn about one axis


def shifted(shape: ShapeCard, body: int, r: np.ndarray, A: np.ndarray) -> ShapeCard:
    """Return the shape on `body`, in whose axes the old frame lies at `r` (3,), turned by `A` (3, 3)."""
    x, y, z = map(float, np.asarray(r) + A @ np.array(shape.offset))
    turned = angles_of(A @ turning(shape.angles))
    return replace(shape, body=body, offset=(x, y, z), angles=turned)


def angles_of(R: np.ndarray) -> Vector:
    """Return the angles about the fixed axes x, y, z in turn of a rotation matrix (3, 3); rad."""
    cosine = math.hypot(R[0, 0], R[1, 0])
    beta = math.atan2(-R[2, 0], cosine)
    if cosine < _FLAT:
        return math.atan2(-R[1, 2], R[1, 1]) + 0.0, beta, 0.0
    return math.atan2(R[2, 1], R[2, 2]) + 0.0, beta + 0.0, math.atan2(R[1, 0], R[0, 0]) + 0.0


def notes_of(shapes: tuple[ShapeCard, ...]) -> tuple[str, ...]:
    """Return what a reader of a deck that names STL files should know."""
    return ("STL files keep their names: copy them beside this deck",) if any(s.file for s in shapes) else ()
