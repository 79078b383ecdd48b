"""A mechanism of rigid and flexible bodies in their own frames, as the equations of motion want it.

A rigid body is one without modal coordinates: m, s0 and J0 mean the same for both.  Bodies are numbered
from 0, the ground is -1.  SI units; `A` turns body axes into global ones.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from ..errors import Place
from .fe_model import BodyTorque
from .flexible_body import FlexibleBody
from .integrators import Integrator
from .joint_elements import JointElements
from .laws import Element
from .mechanism import TimeGrid, Vector
from .time_functions import Motion, MotionFunction

if TYPE_CHECKING:  # few decks have any
    from .shapes import Shape


@dataclass(frozen=True)
class FloatingBody:
    """A body: frame at t = 0 (`r` global, Euler parameters `p`), motion there, and inertia about its origin.

    `velocity` of the origin in global axes, `omega` in body axes; the modal coordinates and their rates
    start at zero.  `place` and `velocity_place`: of the cards BODY and VELO.
    """

    name: str
    r: np.ndarray  # (3,)
    p: np.ndarray  # (4,)
    velocity: np.ndarray  # (3,)
    omega: np.ndarray  # (3,)
    m: float
    s0: np.ndarray  # (3,) mass times centre of mass, kg m
    J0: np.ndarray  # (3, 3) about the origin, kg m²
    flexible: FlexibleBody | None = None
    stiffened: bool = False
    place: Place | None = None
    velocity_place: Place | None = None

    @property
    def modes(self) -> int:
        """N, the number of modal coordinates: 0 for a rigid body."""
        return self.flexible.modes if self.flexible else 0

    @property
    def reduced(self) -> FlexibleBody:
        """Nodes and modes of a flexible body."""
        assert self.flexible is not None, f"{self.name} is rigid"
        return self.flexible


@dataclass(frozen=True)
class NodePoint:
    """A point of a body at `r0 + shape @ eta`, body axes; on the ground (body -1) at r0, global axes.

    Of a node with rotations `turn` (3, N) is its rotation vector per modal coordinate, rad; the part `arm`
    of r0, from the node to the point, turns with it.
    """

    name: str
    body: int
    r0: np.ndarray  # (3,)
    shape: np.ndarray  # (3, N)
    turn: np.ndarray | None = None
    arm: np.ndarray = field(default_factory=lambda: np.zeros(3))  # (3,)

    @property
    def is_arm(self) -> bool:
        """Return whether the point is off the node whose rotations carry it."""
        return self.turn is not None and bool(self.arm.any())


@dataclass(frozen=True)
class PointJoint:
    """A joint of `kind` between points P, Q, H as `NodeJoint` has them; `size` nan: as at t = 0."""

    name: str
    kind: str
    a: tuple[NodePoint, ...]
    b: tuple[NodePoint, ...]
    size: float
    place: Place | None = None


@dataclass(frozen=True)
class PointPin:
    """Global `directions` of a point held at `target` (3,), to which `functions` add displacements."""

    name: str
    point: NodePoint
    directions: tuple[bool, bool, bool]
    target: np.ndarray
    place: Place | None = None
    functions: tuple[MotionFunction | None, MotionFunction | None, MotionFunction | None] = (None, None, None)


@dataclass(frozen=True)
class PointForce:
    """A force at a point, N: `force` in global axes, or in body axes when it follows, times `factor`."""

    name: str
    point: NodePoint
    force: Vector
    follows: bool
    factor: MotionFunction | None = None
    place: Place | None = None


@dataclass(frozen=True)
class StressOutput:
    """Stresses of body number `body` that are reported, Pa per unit of each mode, body axes.

    Components are xx yy zz xy yz zx; `largest`: whether the largest von Mises stress of all nodes is, too.
    """

    body: int
    nodes: np.ndarray  # (s,) numbers of nodes
    nodal: np.ndarray  # (s, 6, N)
    elements: np.ndarray  # (e,) numbers of elements
    points: np.ndarray  # (e, g, 6, N) at the points of integration
    volumes: np.ndarray  # (e, g) m³
    largest: bool = False


@dataclass(frozen=True)
class FlexibleMechanism:
    """Everything that dynamics needs of a VSDF deck."""

    bodies: Sequence[FloatingBody]
    time: TimeGrid
    integrator: Integrator
    gravity: Vector
    joints: Sequence[PointJoint] = ()
    pins: Sequence[PointPin] = ()
    motions: tuple[Motion, ...] = ()
    forces: Sequence[PointForce] = ()
    torques: tuple[BodyTorque, ...] = ()
    springs: Sequence[Element] = ()  # in line, then in joints
    outputs: Sequence[NodePoint] = ()
    stresses: tuple[StressOutput, ...] = ()
    shapes: tuple["Shape", ...] = ()
    elements: JointElements = field(default_factory=JointElements)
    loop_tolerance: float = 0.0  # scaled gap at which overconstrained loops count as closed

    @property
    def turning_outputs(self) -> list[NodePoint]:
        """Return the output nodes that have rotations, without arms on them."""
        return [point for point in self.outputs if point.turn is not None and not point.is_arm]
