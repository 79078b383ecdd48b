"""Drivers, springs, stops, bushings, couplings and friction at joints, and composite joints.

A joint coordinate is the angle of body J against body I about the joint's axis, rad, or the stroke of P_j
along it, m; both are 0 at the deck's estimates.  Hinges of a tree have the coordinates "rotation 1" to
"translation 3" of the tree instead.  Joints and drivers are numbered from 0 here.  Body -1 is the ground,
whose axes are global.
"""

import math
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any

from ..errors import Place
from .joints import ANGLE, BY_NAME, JOINT_TYPES, NODE_JOINT_TYPES
from .laws import JointLaw
from .mechanism import Vector
from .time_functions import MotionFunction

if TYPE_CHECKING:
    from collections.abc import Iterator

    from .fe_model import End
    from .flexible_mechanism import FlexibleMechanism, NodePoint
    from .loads import DynamicModel

USUAL_EXPONENT = 10  # of two, of the largest factor of a coupling that is left as it is
LENGTH, TURN = "m", "rad"
OF_BUSHING = (
    ("x", LENGTH),
    ("y", LENGTH),
    ("z", LENGTH),
    ("about x", TURN),
    ("about y", TURN),
    ("about z", TURN),
)
# The coordinates that the joints of each type have.
COORDINATES_OF = {kind.name: kind.coordinates for kind in (*JOINT_TYPES, *NODE_JOINT_TYPES)}


def is_angle(coordinate: str) -> bool:
    """Return whether a coordinate of a joint or hinge is an angle rather than a length."""
    return coordinate == ANGLE or coordinate.startswith("rotation")


@dataclass(frozen=True)
class JointDriver:
    """A joint coordinate that follows a function."""

    name: str
    joint: int
    coordinate: str
    function: MotionFunction
    place: Place | None = None


@dataclass(frozen=True)
class JointMotor:
    """A force or torque of a function of time in a joint coordinate, N or N m, opposite on body i."""

    name: str
    joint: int
    coordinate: str
    function: MotionFunction
    place: Place | None = None


@dataclass(frozen=True)
class DrivenItem:
    """The driver, or the simplified constraint in direction 1 to 3, number `item`, which follows a
    function.
    """

    name: str
    item: int
    function: MotionFunction
    place: Place | None = None


@dataclass(frozen=True)
class JointSpring:
    """Spring and damper in a joint coordinate x with the rate v, N or N m, for s = x - rest:

    -(preload + stiffness s + curve(s) + damping v + damper(v)).
    """

    name: str
    joint: int
    coordinate: str
    stiffness: float = 0.0
    rest: float = 0.0
    damping: float = 0.0
    preload: float = 0.0
    curve: MotionFunction | None = None
    damper: MotionFunction | None = None
    place: Place | None = None


@dataclass(frozen=True)
class LineSpring:
    """The same in the distance of two points, of rigid bodies in body axes, or at nodes.

    With `slack` it acts only while it is longer than `rest`.
    A slack element (a cable) pulls with stiffness s (1 + damping v), never less than 0.
    """

    name: str
    i: int
    j: int
    P_i: "Vector | NodePoint | End"
    P_j: "Vector | NodePoint | End"
    stiffness: float = 0.0
    rest: float = 0.0
    damping: float = 0.0
    preload: float = 0.0
    curve: MotionFunction | None = None
    damper: MotionFunction | None = None
    slack: bool = False
    place: Place | None = None


@dataclass(frozen=True)
class Bushing:
    """Springs and dampers between frames at P_i and P_j that coincide in attitude at the estimates.

    Displacements of P_j and turns of its frame are measured in the axes of body i; a turn about x is the
    angle from y of i to y of j in the plane y z, and so on in cyclic order.  Along and about x, y, z:
    N/m (3), N m/rad (3); N s/m (3), N m s/rad (3).
    """

    name: str
    i: int
    j: int
    P_i: "Vector | NodePoint | End"
    P_j: "Vector | NodePoint | End"
    stiffness: tuple[float, float, float, float, float, float]
    damping: tuple[float, float, float, float, float, float]
    place: Place | None = None


@dataclass(frozen=True)
class Coupling:
    """Σ factor · joint coordinate = 0 for `terms` (joint, coordinate, factor): gears, racks, belts."""

    name: str
    terms: tuple[tuple[int, str, float], ...]
    place: Place | None = None

    @property
    def scale(self) -> float:
        """Power of two that its equation is divided by, 1 of usual factors: a rank is found beside others."""
        exponent = math.frexp(max(abs(factor) for _, _, factor in self.terms))[1]
        return 1.0 if abs(exponent) <= USUAL_EXPONENT else math.ldexp(1.0, exponent)


@dataclass(frozen=True)
class JointFriction:
    """Dry friction in a joint, from the part N of its reaction force across its axis plus `preload`, N.

    At the sliding speed v (radius times rate of the angle, rate of the stroke, or the root of the sum of
    their squares) the force μ N opposes sliding, μ = (dynamic + (static - dynamic) exp(-(v/stribeck)²))
    tanh(v/creep).  In a screw the force on the flanks of its square thread adds to N.
    """

    name: str
    joint: int
    dynamic: float
    static: float
    stribeck: float
    creep: float
    radius: float = 0.0
    preload: float = 0.0
    place: Place | None = None


@dataclass(frozen=True)
class CompositeJoint:
    """A joint with a massless link: "revolute-cylindrical", "revolute-spherical" or "spherical-spherical".

    `s_i`: axis of the revolute at P_i; `s_j`: axis of the cylindrical at P_j; `size`: length of the link, m.
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
class JointRate:
    """Rate of a joint coordinate at the start, rad/s or m/s."""

    name: str
    joint: int
    coordinate: str
    rate: float
    place: Place | None = None


@dataclass(frozen=True)
class JointElements:
    """All elements at joints in the order of the deck; `reported`: whether results have joint coordinates."""

    drivers: tuple[JointDriver, ...] = ()
    motors: tuple[JointMotor, ...] = ()
    driven: tuple[DrivenItem, ...] = ()
    supports: tuple[DrivenItem, ...] = ()
    springs: tuple[JointSpring, ...] = ()
    lines: tuple[LineSpring, ...] = ()
    laws: tuple[JointLaw, ...] = ()
    bushings: tuple[Bushing, ...] = ()
    couplings: tuple[Coupling, ...] = ()
    frictions: tuple[JointFriction, ...] = ()
    composites: tuple[CompositeJoint, ...] = ()
    rates: tuple[JointRate, ...] = ()
    reported: bool = False

    def __bool__(self) -> bool:
        return any(getattr(self, field.name) for field in fields(self))

    def groups(self) -> list[tuple[Any, ...]]:
        """Return the tuples of all types."""
        found = (getattr(self, field.name) for field in fields(self))
        return [group for group in found if isinstance(group, tuple)]

    @property
    def constrain(self) -> bool:
        """Return whether some of them are equations."""
        return any((self.drivers, self.driven, self.supports, self.couplings, self.composites))


def element_names(model: "DynamicModel | FlexibleMechanism") -> list[tuple[str, str]]:
    """Name of every spring and element and unit of its coordinate, "m" or "rad"."""
    found = [(item.name, LENGTH) for item in model.springs]
    # Asking for the class would import flexible bodies in runs that have none.
    joints = getattr(model, "joints", ())
    for item in getattr(model, "joint_springs", ()):
        found.append((item.name, _unit(BY_NAME[joints[item.joint].kind].sprung)))
    return found + list(names_of(model.elements))


def names_of(elements: JointElements) -> "Iterator[tuple[str, str]]":
    """Name of every element and unit of its coordinate."""
    yield from ((spring.name, _unit(spring.coordinate)) for spring in elements.springs)
    yield from ((line.name, LENGTH) for line in elements.lines)
    yield from ((item.name, _unit(item.coordinate)) for item in elements.laws)
    yield from ((f"{item.name} {part}", unit) for item in elements.bushings for part, unit in OF_BUSHING)
    yield from ((friction.name, LENGTH) for friction in elements.frictions)
    yield from ((motor.name, _unit(motor.coordinate)) for motor in elements.motors)


def _unit(coordinate: str) -> str:
    return TURN if is_angle(coordinate) else LENGTH
