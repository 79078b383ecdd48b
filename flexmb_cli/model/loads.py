"""Loads of a mechanism besides its drivers: masses, forces, torques, springs, gravity, first velocities.

SI units.  Bodies are numbered from 0, as in `mechanism`; points and vectors are in the axes of their
body unless the text says global.  Every item keeps its readable name and its place in the deck.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Literal

from ..errors import Place
from .integrators import Integrator
from .joint_elements import JointElements
from .laws import Element
from .mechanism import Mechanism, Vector
from .time_functions import MotionFunction

NOWHERE: Vector = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class MassProperties:
    """Mass (kg), centre of mass (m, body axes) and inertia about it (kg m², body axes) of a body.

    `inertia`: the elements xx, yy, zz, xy, yz, zx of the tensor; xy is -∫ x y dm.
    """

    name: str
    body: int
    mass: float
    centre: Vector = NOWHERE
    inertia: tuple[float, float, float, float, float, float] = (0.0,) * 6
    place: Place | None = None


@dataclass(frozen=True)
class AppliedForce:
    """A force (N), times a `factor`, on a `point` of a body, in global axes or, `following`, its own."""

    name: str
    body: int
    force: Vector
    point: Vector = NOWHERE
    following: bool = False
    factor: MotionFunction | None = None
    place: Place | None = None


@dataclass(frozen=True)
class AppliedTorque:
    """A torque (N m), times a `factor`, on a body, in global axes or, `following`, in the body's."""

    name: str
    body: int
    torque: Vector
    following: bool = False
    factor: MotionFunction | None = None
    place: Place | None = None


@dataclass(frozen=True)
class InitialVelocity:
    """Velocity (m/s) of a body's origin and angular velocity (rad/s) at the start, global axes."""

    name: str
    body: int
    velocity: Vector
    angular: Vector
    place: Place | None = None


@dataclass(frozen=True)
class DynamicModel:
    """A mechanism with masses and loads.

    `analysis`: "inverse" finds the reactions and efforts of the motion that the drivers prescribe,
    "forward" the motion under the loads.  Bodies without `masses` are massless.
    """

    mechanism: Mechanism
    analysis: Literal["inverse", "forward"] = "forward"
    masses: Sequence[MassProperties] = ()
    forces: Sequence[AppliedForce] = ()
    torques: Sequence[AppliedTorque] = ()
    springs: Sequence[Element] = ()  # in line
    gravity: Vector = NOWHERE
    velocities: Sequence[InitialVelocity] = ()
    integrator: Integrator = field(default_factory=Integrator)
    elements: JointElements = field(default_factory=JointElements)

    @property
    def without_masses(self) -> bool:
        """Return whether masses are left out on purpose: a given motion, of which joint angles are wanted."""
        return self.analysis == "inverse" and not self.masses and not any(self.gravity)


def holders(mechanism: Mechanism) -> list[tuple[str, int]]:
    """Names and bodies of the holding forces; a distance constraint holds two bodies."""
    pairs = [(item.name, item.body) for item in mechanism.simplified]
    for item in mechanism.distances:
        pairs += [(f"{item.name}, body I", item.i), (f"{item.name}, body J", item.j)]
    return pairs + [(item.name, item.body) for item in mechanism.grounds]
