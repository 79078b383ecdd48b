"""A tree of rigid and flexible bodies in relative coordinates (DAFMS thesis, 1992, chapter 2).

Body k hangs by hinge k on a lower numbered body or on the inertial frame.  P_k is the hinge's point
of the parent, O_k the origin of body k; a rotation turns O_k against P_k about an axis of the P_k
frame, a translation moves O_k away from P_k along one.  Nodes of a flexible body are displaced
against the O_k frame, which stays tangent to the body at its root.

Bodies and nodes are numbered from 0 here (parent -1: inertial frame) and from 1 in decks and names;
axes are 1, 2, 3 everywhere.  SI units; attitudes are Euler parameters (e0, e1, e2, e3), scalar first.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import Place
from .general_joints import GeneralJoint
from .joint_elements import Curve, JointElements, Roll
from .mechanism import TimeGrid, Vector
from .time_functions import MotionFunction

if TYPE_CHECKING:  # few decks have any
    from .shapes import Shape

INERTIAL = -1
ASSEMBLED_GAP = 1e-10  # m: loops of an assembled tree are closed as well as that

Attitude = tuple[float, float, float, float]
UNTURNED: Attitude = (1.0, 0.0, 0.0, 0.0)

ROTATION, TRANSLATION, ELASTIC = "rotation", "translation", "elastic"


@dataclass(frozen=True, eq=False)
class Elasticity:
    """Elastic properties of a body: NP lumped nodes with the same free axes, NM = NP · len(axes).

    `positions` (NP, 3): undeformed, from O_k in O_k axes, m; `masses` (NP,): kg, positive; `axes`:
    directions of the nodal displacements, ascending; `stiffness`, `damping` (NM, NM): clamped at
    O_k, node by node; `forces` (NP, 3): constant, inertial axes, N.  `stiffened_from`: geometric
    stiffening of a straight beam, clamped so far from O_k (m); None: none.
    """

    positions: np.ndarray
    masses: np.ndarray
    axes: tuple[int, ...]
    stiffness: np.ndarray
    forces: np.ndarray
    damping: np.ndarray | None = None
    stiffened_from: float | None = None

    @property
    def coordinates(self) -> int:
        """Number of elastic coordinates NM."""
        return len(self.masses) * len(self.axes)

    @property
    def lowest(self) -> float:
        """Lowest circular frequency of the body clamped at O_k, rad/s, without its other masses."""
        factors = np.repeat(self.masses, len(self.axes)) ** -0.5
        values = np.linalg.eigvalsh(factors[:, None] * self.stiffness * factors)
        return float(np.sqrt(max(values[0], 0.0)))


@dataclass(frozen=True, eq=False)
class Body:
    """One body.  `mass` is the whole mass; what a flexible body's nodes leave of it sits at O_k.

    `inertia` (3, 3): about O_k in O_k axes, kg m², of the whole undeformed body, nodes included;
    `centre`: O_k to mass centre (rigid bodies only); `force` at O_k and `torque` on the body are
    external, constant, inertial axes.
    """

    name: str
    mass: float
    inertia: np.ndarray
    centre: Vector = (0.0, 0.0, 0.0)
    elastic: Elasticity | None = None
    force: Vector = (0.0, 0.0, 0.0)
    torque: Vector = (0.0, 0.0, 0.0)
    place: Place | None = None


@dataclass(frozen=True, eq=False)
class Hinge:
    """Hinge of one body: its `parent`, the `point` P_k (undeformed, parent's axes) and what is free.

    `node`: node of a flexible parent at P_k, whose displacement P_k follows (None: P_k is fixed in
    the parent).  `frame` (EULL): attitude of the P_k axes in the parent.  `rotations`,
    `translations`: free axes, ascending.  One rotation is an angle, two are successive rotations;
    three have Euler parameters, the relative angular velocity in P_k axes as speeds, and its time
    integrals as coordinates.  `attitude` (EULT): of O_k against P_k, fixed when no rotation is free,
    initial when all three are; without meaning for one and two.  `elastic_rotation` (3, NM of the
    parent): rotation of the P_k frame, parent's axes, as a linear function of the parent's elastic
    coordinates (taken as three successive rotations); None: it keeps the parent's attitude.
    """

    parent: int
    point: Vector = (0.0, 0.0, 0.0)
    node: int | None = None
    frame: Attitude = UNTURNED
    attitude: Attitude = UNTURNED
    rotations: tuple[int, ...] = ()
    translations: tuple[int, ...] = ()
    elastic_rotation: np.ndarray | None = None
    place: Place | None = None


@dataclass(frozen=True)
class BodyTorque:
    """External torque on a body about an inertial axis (DESN, tabulated torque), N m."""

    body: int
    axis: int
    function: MotionFunction
    place: Place | None = None


@dataclass(frozen=True)
class Prescribed:
    """A hinge coordinate driven as C + B t + A t²/2 (not one of three free rotations)."""

    body: int
    motion: str
    axis: int
    C: float
    B: float
    A: float
    place: Place | None = None


@dataclass(frozen=True)
class Closure:
    """A cut joint: a point of body `a` keeps to a point of body `b` in `directions` (axes 1, 2, 3).

    The directions are axes of body b, inertial ones for b = -1.  A point is `a_node` of a flexible
    body or, when that is None, `a_point` in the body's axes.  On a `curve` of body b from point b on, the
    directions 1 and 2 are its normals.  Those of a `general` joint are its rows; `turned` (3, 3)
    takes vectors from the axes of body b to those of body a at the start.  Of a `roll`: its equations.
    """

    name: str
    a: int
    b: int
    directions: tuple[int, ...]
    a_node: int | None = None
    b_node: int | None = None
    a_point: Vector = (0.0, 0.0, 0.0)
    b_point: Vector = (0.0, 0.0, 0.0)
    place: Place | None = None
    curve: Curve | None = None
    general: GeneralJoint | None = None
    turned: Any = None
    roll: Roll | None = None


@dataclass(frozen=True)
class Coordinate:
    """Generalized coordinate: `motion` of `body` about or along `axis`, of `node` if elastic."""

    body: int
    motion: str
    axis: int
    node: int | None = None
    name: str = ""


def default_tolerances(method: str) -> tuple[float, float]:
    """Relative and absolute tolerance of a step.

    Of DOP853 such that the printed digits are right also of elastic coordinates, which are 1e-5 m.
    """
    return (1e-12, 1e-14) if method == "dop853" else (1e-9, 1e-9)


@dataclass(frozen=True)
class Integration:
    """Settings of the integration: one of TREE_METHODS, relative and absolute tolerance of a step.

    dop853 is explicit and compiled; sdirk4 is implicit and compiled, for stiff elastic modes; radau is
    implicit too, and slower; lsoda is of the family the thesis used (DGEAR).
    """

    method: str = "dop853"
    rtol: float = default_tolerances("dop853")[0]
    atol: float = default_tolerances("dop853")[1]


@dataclass(frozen=True, eq=False)
class Tree:
    """Everything a dynamic analysis of a tree needs; hinges[k] carries bodies[k].

    `q`, `y` (NS,): initial coordinates and speeds in the order of `coordinates`.  `one_way`: the
    elastic motion does not act on the rigid motion (thesis 4.3).
    """

    bodies: tuple[Body, ...]
    hinges: tuple[Hinge, ...]
    q: np.ndarray
    y: np.ndarray
    time: TimeGrid
    gravity: Vector = (0.0, 9.8, 0.0)
    torques: tuple[BodyTorque, ...] = ()
    prescribed: tuple[Prescribed, ...] = ()
    started: tuple[int, ...] = ()  # coordinates that loops are closed with as they are
    closures: tuple[Closure, ...] = ()
    one_way: bool = False
    integration: Integration = field(default_factory=Integration)
    elements: JointElements = field(default_factory=JointElements)
    shapes: tuple["Shape", ...] = ()
    loop_tolerance: float = 0.0  # scaled gap at which overconstrained loops count as closed

    @cached_property
    def coordinates(self) -> tuple[Coordinate, ...]:
        """The NS generalized coordinates in the order of eq. (2.22): rotations, translations, elastic."""
        return generalized_coordinates(self.bodies, self.hinges)


def generalized_coordinates(bodies: Sequence[Any], hinges: Sequence[Any]) -> tuple[Coordinate, ...]:
    """Return the coordinates of eq. (2.22), as many as (2.4): rotations, translations, elastic ones."""
    named = list(zip(range(len(bodies)), bodies, hinges, strict=True))
    rigid = [
        Coordinate(k, motion, axis, name=f"{body.name} {motion} {axis}")
        for motion, axes in ((ROTATION, "rotations"), (TRANSLATION, "translations"))
        for k, body, hinge in named
        for axis in getattr(hinge, axes)
    ]
    elastic = [
        Coordinate(k, ELASTIC, axis, node, f"{body.name} node {node + 1} axis {axis}")
        for k, body, _ in named
        if body.elastic is not None
        for node in range(len(body.elastic.masses))
        for axis in body.elastic.axes
    ]
    return tuple(rigid + elastic)
