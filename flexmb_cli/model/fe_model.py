"""Model of a VSDF deck before its matrices are reduced: bodies, and what acts at their nodes.

Bodies are numbered from 0, the ground is -1.  A node is named by its number in the body's node table, or
by that of a node set.  Positions of nodes are in the axes of their node table, those of the ground global.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import Place
from .flexible_body import FlexibleInput
from .integrators import Integrator
from .joint_elements import JointElements
from .laws import Element
from .mechanism import GROUND, TimeGrid, Vector
from .time_functions import Motion, MotionFunction

if TYPE_CHECKING:  # few decks have any
    from .shapes import Shape


@dataclass(frozen=True)
class RigidMass:
    """Mass, kg; centre of mass (3,), m; inertia (3, 3) about it, kg m²; body axes."""

    mass: float
    centre: Vector
    inertia: np.ndarray


@dataclass(frozen=True)
class Arm:
    """A point at `offset` (3,), axes of the node table, from the node that carries it and turns it."""

    node: int
    offset: np.ndarray
    place: Place | None = None


@dataclass(frozen=True)
class VsdfBody:
    """A body: pose of its node table's axes at t = 0, velocity of its origin, angular velocity (body axes).

    `nodes`: positions by number; `sets`: members of the node sets by number; `arms`: points off nodes with
    rotations.  Either `rigid` or
    `flexible` is given; `stiffened` asks for centrifugal stiffening.  `place` and `velocity_place`: of the
    cards BODY and VELO.
    """

    name: str
    r: Vector
    p: tuple[float, float, float, float]
    velocity: Vector = (0.0, 0.0, 0.0)
    omega: Vector = (0.0, 0.0, 0.0)
    rigid: RigidMass | None = None
    flexible: FlexibleInput | None = None
    nodes: Mapping[int, np.ndarray] = field(default_factory=dict)
    sets: dict[int, tuple[int, ...]] = field(default_factory=dict)
    arms: dict[int, Arm] = field(default_factory=dict)
    stiffened: bool = False
    place: Place | None = None
    velocity_place: Place | None = None

    def members(self, node: int) -> tuple[int, ...]:
        """The nodes that a node's, arm's or set's number stands for; () when there is none."""
        if node in self.arms:
            return (self.arms[node].node,)
        return self.sets.get(node, (node,) if node in self.nodes else ())

    def position(self, node: int) -> np.ndarray:
        """Position (3,) of a node, or the mean of a set's, in the axes of the node table."""
        places = [self.nodes[member] for member in self.members(node)]
        centre: np.ndarray = places[0].copy() if len(places) == 1 else np.mean(places, axis=0)
        return centre + self.arms[node].offset if node in self.arms else centre

    @property
    def A(self) -> np.ndarray:
        """Rotation matrix of the node table's axes at t = 0."""
        e0, e1, e2, e3 = self.p
        e = np.array([e1, e2, e3])
        tilde = np.array([[0, -e3, e2], [e3, 0, -e1], [-e2, e1, 0]])
        return (2 * e0 * e0 - 1) * np.eye(3) + 2 * (np.outer(e, e) + e0 * tilde)

    def global_position(self, node: int) -> np.ndarray:
        """Return where a node is at t = 0, undeformed, global axes (3,)."""
        return np.array(self.r) + self.A @ self.position(node)


@dataclass(frozen=True)
class End:
    """A place on a body: a node (or set), or for the ground the global `point` (3,)."""

    body: int
    node: int
    point: Vector | None = None


@dataclass(frozen=True)
class NodeJoint:
    """A joint of `kind` between ends P (points), Q (on the axes or arms), H (across the axes), as it needs.

    `size`: pitch, m/rad, or distance, m; nan: as at t = 0.
    """

    name: str
    kind: str
    a: tuple[End, ...]
    b: tuple[End, ...]
    size: float
    place: Place | None = None


@dataclass(frozen=True)
class Pin:
    """Global directions of a node held at `point`; None: where the node is at t = 0.

    `functions` of time add displacements to it along x, y, z, m.
    """

    name: str
    end: End
    directions: tuple[bool, bool, bool]
    point: Vector | None
    place: Place | None = None
    functions: tuple[MotionFunction | None, MotionFunction | None, MotionFunction | None] = (None, None, None)


@dataclass(frozen=True)
class NodeForce:
    """A force at a node, N, in global axes, or in body axes when it follows; times `factor` of time."""

    name: str
    end: End
    force: Vector
    follows: bool
    factor: MotionFunction | None = None
    place: Place | None = None


@dataclass(frozen=True)
class BodyTorque:
    """A torque on a rigid body, N m, in global axes, or in body axes when it follows.

    `at`: the end of a flexible body on whose rotation it acts, in a mechanism its point; None: a rigid body.
    """

    name: str
    body: int
    torque: Vector
    follows: bool
    factor: MotionFunction | None = None
    place: Place | None = None
    at: Any = None


@dataclass(frozen=True)
class StressSelection:
    """Selection of a body's stresses to report: its nodes and elements by number, and its largest one.

    `places`: where the deck names each of the elements.
    """

    body: int
    nodes: tuple[int, ...] = ()
    elements: tuple[int, ...] = ()
    every_element: bool = False
    largest: bool = False
    places: tuple[Place | None, ...] = ()


@dataclass(frozen=True)
class VsdfModel:
    """Everything the deck says, in its order."""

    bodies: Sequence[VsdfBody]
    time: TimeGrid
    integrator: Integrator
    ground: VsdfBody
    joints: Sequence[NodeJoint] = ()
    pins: tuple[Pin, ...] = ()
    motions: tuple[Motion, ...] = ()
    forces: tuple[NodeForce, ...] = ()
    torques: tuple[BodyTorque, ...] = ()
    springs: tuple[Element, ...] = ()  # in line, whose rest nan is the length at t = 0, then in joints
    gravity: Vector = (0.0, 0.0, 0.0)
    outputs: tuple[End, ...] = ()
    stresses: tuple[StressSelection, ...] = ()
    shapes: tuple["Shape", ...] = ()
    elements: JointElements = field(default_factory=JointElements)

    def global_position(self, end: End) -> np.ndarray:
        """Return where an end is at t = 0 (3,)."""
        if end.point is not None:
            return np.array(end.point)
        body = self.ground if end.body == GROUND else self.bodies[end.body]
        return body.global_position(end.node)
