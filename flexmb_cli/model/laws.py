"""Force laws and the elements that follow them: a record for each law, one class for all elements.

An `Element` is a measure with a law: x, the rate of x and an effort that drives x to larger values.

| measure | x |
|---|---|
| `At(joint, coordinate)` | a joint or hinge coordinate: angle, rad, or stroke, m |
| `Cam(joint, coordinate, cam_joint, cam_coordinate, function)` | a coordinate less a function of another |
| `Line(i, j, P_i, P_j)` | the distance of two points, m |
| `Frames(i, j, P_i, P_j)` | six: displacements of P_j and turns of its frame, in the axes of body i |
| `Joint(joint)` | none: friction of a joint |
| `Push(-1, j, P_i, P_j, direction, …)` | none: a direction at a point, in which a force or torque acts |
| `Touch(i, j, P_i, P_j, …)` | the gap of two shapes, negative where they overlap |

A `Law` has a word, the code of its branch in `kernels.laws`, `parameters`, and the types of `measures` that
it can have.  `Element.values` are those of its parameters in their order: a float, three floats of a VECTOR,
or a `MotionFunction` (None: none) of a parameter of type OF_TIME, OF_COORDINATE or OF_RATE; `element[name]`
is one of them.  `Parameter.unit`, `Element.since`, `Element.idle` and `Element.parts` say what units,
conversion, notes and names of results need.  Cards of all dialects and the arrays of both formulations follow
from these records: a new law is one record here and one branch of `kernels.laws`, of the same code.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, NamedTuple

from ..errors import Place
from .joints import ANGLE

if TYPE_CHECKING:
    from .time_functions import MotionFunction

REQUIRED: Any = ...  # default of a parameter that must be given
# Types of parameters.
NUMBER, VECTOR = "number", "vector"
OF_TIME, OF_COORDINATE, OF_RATE = "function of time", "function of the coordinate", "function of its rate"
FUNCTIONS = (OF_TIME, OF_COORDINATE, OF_RATE)
LENGTH, TURN = "m", "rad"
ZERO = (0.0, 0.0, 0.0)


class Parameter(NamedTuple):
    """A parameter of a law; its unit is effort^effort coordinate^length s^time."""

    name: str  # in decks and results
    meaning: str  # {coordinate} and {effort} stand for the words of a card
    effort: int = 0  # power of the unit of the effort
    length: int = 0  # power of the unit of the coordinate
    time: int = 0  # power of the second
    default: Any = REQUIRED  # in its unit
    signed: bool = False  # whether it may be negative
    counted: bool = False  # a value of the coordinate: it counts from another start after a conversion
    above: str | float | None = None  # a number, or the parameter, than which it must be larger
    kind: str = NUMBER  # NUMBER, VECTOR (x, y, z) or one of FUNCTIONS, whose values have the unit
    resists: bool = False  # a negative value, which a warning names, drives a motion on
    turning: bool | None = None  # whether the coordinate is an angle; None: as that of the element

    @property
    def is_coordinate(self) -> bool:
        """Return whether it is a value or a difference of the coordinate."""
        return self.kind == NUMBER and (self.effort, self.length, self.time) == (0, 1, 0)

    def unit(self, turning: bool) -> str:
        """Return the unit in an angle or a stroke, such as N m s2/rad2."""
        turning = turning if self.turning is None else self.turning
        powers = {
            "N m" if turning else "N": self.effort,
            "s": self.time,
            "rad" if turning else "m": self.length,
        }
        up, down = (
            [f"{unit}{abs(n) if abs(n) > 1 else ''}" for unit, n in powers.items() if sign * n > 0]
            for sign in (1, -1)
        )
        return " ".join(up or ["1"]) + ("/" + " ".join(down) if down else "")


class At(NamedTuple):
    """The coordinate of a joint, or of a hinge of a tree; joints are numbered from 0."""

    joint: int  # number, from 0; of a tree that of the body whose hinge it is
    coordinate: str  # "angle" or "stroke", or "rotation 1" to "translation 3" of a hinge


class Cam(NamedTuple):
    """The coordinate of a follower less a function of the coordinate of its cam."""

    joint: int  # of the follower, as of `At`
    coordinate: str  # of the follower
    cam_joint: int  # of the cam
    cam_coordinate: str  # of the cam
    function: "MotionFunction"  # of the cam's coordinate, m or rad


class Line(NamedTuple):
    """The distance of two points: in body axes or nodes; body -1 is the ground."""

    i: int  # first body, -1: ground
    j: int  # second body, -1: ground
    P_i: Any  # point of the first: (3,) body axes, m, or a node
    P_j: Any  # point of the second


class Along(NamedTuple):
    """The displacement of a point from another along an axis of body i; of sensors."""

    i: int  # first body, -1: ground
    j: int  # second body, -1: ground
    P_i: Any  # point of the first: (3,) body axes, m, or a node
    P_j: Any  # point of the second
    axis: int  # 0, 1, 2


class Frames(NamedTuple):
    """Frames at two points that coincide in attitude at the estimates of YOUNG, elsewhere at the start.

    A turn about x is the angle from y of i to y of j in the plane y z, and so on in cyclic order.
    """

    i: int  # first body, -1: ground
    j: int  # second body, -1: ground
    P_i: Any  # point of the first: (3,) body axes, m, or a node
    P_j: Any  # point of the second


class Push(NamedTuple):
    """A direction in which a force acts at a point of a body, or a torque on the body."""

    i: int  # -1: the ground, which no effort moves
    j: int  # the body
    P_i: Any  # point of the ground: of no meaning
    P_j: Any  # point of the body: (3,) body axes, m, or a node
    direction: Any = (0.0, 0.0, 0.0)  # (3,) unit vector, axes of the ground, or of the body if it follows
    follows: bool = False  # whether it turns with the body
    turning: bool = False  # whether a torque acts


class Joint(NamedTuple):
    """A joint whose parts slide on each other."""

    joint: int  # number, from 0


class Touch(NamedTuple):
    """Shapes of two bodies that may touch; body -1 is the ground.

    Axes are those of the bodies.  A capsule or cylinder goes from its point to the end of its axis, a box is
    about its point.
    """

    i: int  # first body, -1: ground
    j: int  # second body, -1: ground
    P_i: Any  # point of the first shape: (3,) body axes, m, or a node
    P_j: Any  # point of the second
    first: str  # shape of the first body, see PAIRS
    second: str  # shape of the second body
    axis_i: Any = (0.0, 0.0, 0.0)  # of a plane its unit normal, m
    axis_j: Any = (0.0, 0.0, 0.0)  # m
    radius_i: float = 0.0  # m
    radius_j: float = 0.0  # m
    size_i: Any = (0.0, 0.0, 0.0)  # edges of a box, m
    size_j: Any = (0.0, 0.0, 0.0)  # m
    more_i: tuple[tuple[int, Any], ...] = ()  # further bodies with the first shape, and points on them
    more_j: tuple[tuple[int, Any], ...] = ()  # the same of the second
    mutual: bool = False  # both are the same shapes, each of which may touch each
    corners: Any = ()  # (n, 3) of the convex hull of a mesh at the second point, axes of its body, m
    triangles: Any = ()  # (n, 9) corners of those of a mesh at the first point, axes of its body, m

    @property
    def parts(self) -> int:
        """Return how many points of the second shape may touch the first."""
        if self.second == "mesh":
            return len(self.corners)
        return PARTS_ON_PLANES.get(self.second, 1) if self.first == "plane" else 1

    @property
    def names(self) -> int:
        """Return how many names it has in results: one for each point that may touch, or one for all."""
        return 1 if self.more_i or self.more_j or self.second == "mesh" else self.parts

    @property
    def ends_i(self) -> tuple[tuple[int, Any], ...]:
        """Return all bodies with the first shape, and points on them."""
        return ((self.i, self.P_i), *self.more_i)

    @property
    def ends_j(self) -> tuple[tuple[int, Any], ...]:
        """Return all bodies with the second shape, and points on them."""
        return ((self.j, self.P_j), *self.more_j)

    @property
    def searched(self) -> bool:
        """Return whether pairs are searched: those of many shapes with many, none of them a plane."""
        return bool(self.more_i and self.more_j) and self.first != "plane"

    @property
    def sphere_i(self) -> tuple[Any, float]:
        """Return the middle of a sphere about the first shape, from its point, and its radius, m."""
        return _sphere(self.first, self.axis_i, self.radius_i, self.size_i)

    @property
    def sphere_j(self) -> tuple[Any, float]:
        """Return the middle of a sphere about the second shape, from its point, and its radius, m."""
        return _sphere(self.second, self.axis_j, self.radius_j, self.size_j)


def _sphere(shape: str, axis: Any, radius: float, size: Any) -> tuple[Any, float]:
    half = math.hypot(*axis) / 2.0
    around = math.hypot(half, radius) if shape == "cylinder" else half + radius
    return tuple(x / 2.0 for x in axis), around + math.hypot(*size) / 2.0


# Pairs of shapes that may touch, that of body i before that of body j.
PAIRS = (
    "plane-point",
    "plane-sphere",
    "plane-capsule",
    "plane-cylinder",
    "plane-box",
    "plane-mesh",
    "sphere-sphere",
    "capsule-sphere",
    "capsule-capsule",
    "cylinder-sphere",
    "box-sphere",
    "mesh-sphere",
)
PARTS_ON_PLANES = {"capsule": 2, "cylinder": 2, "box": 8}


def is_angle(coordinate: str) -> bool:
    """Return whether a coordinate of a joint or hinge is an angle rather than a length."""
    return coordinate.startswith((ANGLE, "rotation"))


class Law(NamedTuple):
    """A law by its word in decks, of at most six letters, and its code."""

    word: str  # that begins lines of the block ELEMENTS
    code: int  # that of its branch in `kernels.laws`
    parameters: tuple[Parameter, ...]  # in the order of the card
    measures: tuple[type, ...] = (At,)  # that it can have
    acting: tuple[str, ...] = ()  # parameters without which it does nothing, which is noted
    meaning: str = ""  # for pages

    @property
    def optional(self) -> int:
        """Return how many parameters at the end of a card have defaults."""
        given = [k for k, p in enumerate(self.parameters, 1) if p.default is REQUIRED]
        return len(self.parameters) - max(given, default=0)

    def values(self, **given: Any) -> tuple[Any, ...]:
        """Return the values of all parameters by name, defaults for those left out."""
        return tuple(given.get(p.name, p.default) for p in self.parameters)


# -(preload + stiffness s + curve(s) + damping v + damper(v)), s = x - rest.
SPRING = Law(
    "SPRING",
    1,
    (
        Parameter("stiffness", "{effort} per {coordinate}", 1, -1, 0, 0.0, signed=True, resists=True),
        Parameter("rest", "{coordinate} without {effort}", 0, 1, 0, 0.0, signed=True, counted=True),
        Parameter("damping", "{effort} per rate", 1, -1, 1, 0.0, signed=True, resists=True),
        Parameter("preload", "{effort} at rest, against a positive {coordinate}", 1, 0, 0, 0.0, signed=True),
        Parameter("curve", "function of {coordinate} - rest that adds to the {effort}", 1, default=None,
                  kind=OF_COORDINATE),
        Parameter("damper", "function of the rate that adds to the {effort}", 1, default=None, kind=OF_RATE),
    ),
    (At, Line),
    meaning="spring and damper in a coordinate, or between two points",
)  # fmt: skip
# A cable pulls while it is longer than `rest`: stiffness s (1 + damping v), never less than 0.
CABLE = Law(
    "CABLE",
    2,
    (
        Parameter("stiffness", "{effort} per stretch", 1, -1),
        Parameter("rest", "{coordinate} up to which it is slack", 0, 1),
        Parameter("damping", "share of the {effort} that a rate of 1 adds", 0, -1, 1, 0.0),
    ),
    (Line,),
    ("stiffness",),
    "cable between two points, which pulls while it is longer than `rest`",
)
# Hunt and Crossley's force at the depth s > 0 beyond a limit: stiffness s (1 + damping ds/dt), never below 0.
STOP = Law(
    "STOP",
    4,
    (
        Parameter("lower", "least {coordinate}", 0, 1, 0, 0.0, signed=True, counted=True),
        Parameter("upper", "largest {coordinate}", 0, 1, 0, 0.0, signed=True, counted=True, above="lower"),
        Parameter("stiffness", "{effort} per depth", 1, -1),
        Parameter("damping", "share of the force that a rate of 1 adds", 0, -1, 1, 0.0),
    ),
    (At,),
    ("stiffness",),
    "end stops of a coordinate, which push it back beyond `lower` and `upper`",
)
# Springs and dampers along and about the axes of body i: six linear springs.
BUSHING = Law(
    "BUSHING",
    SPRING.code,
    tuple(
        Parameter(name, f"{what}, axes of body i", 1, -1, time, ZERO, kind=VECTOR, turning=turning)
        for name, what, time, turning in (
            ("k", "stiffness", 0, False),
            ("kr", "stiffness against turns", 0, True),
            ("c", "damping", 1, False),
            ("cr", "damping of turns", 1, True),
        )
    ),
    (Frames,),
    ("k", "kr", "c", "cr"),
    "bushing: springs and dampers along and about the three axes of body i",
)
# An effort by a function of time, opposite on body i, besides a constant one.
MOTOR = Law(
    "MOTOR",
    3,
    (Parameter("function", "function of time that the {effort} follows", 1, kind=OF_TIME),),
    meaning="force or torque in a coordinate that follows a function of time",
)
# An effort by a function of time in a direction of the ground or of the body on which it acts.
FORCE, TORQUE = (
    Law(
        word,
        MOTOR.code,
        (Parameter("function", "function of time that the {effort} follows", 1, kind=OF_TIME),),
        (Push,),
        meaning=meaning,
    )
    for word, meaning in (
        ("FORCE", "force at a point or node of a body, which follows a function of time"),
        ("TORQUE", "torque on a body, which follows a function of time"),
    )
)
DRIVING = (MOTOR, FORCE, TORQUE)  # which follow functions of time
LEAST_SPEED = 1e-100  # m/s, of friction: squares of speeds over it are still doubles
# Of the friction of Canudas de Wit and others, see `kernels.bristles`.
BRISTLES = (
    Parameter("bristle", "stiffness of bristles, which make friction stick, per unit of the normal force", 0,
              -1, 0, 0.0),
    Parameter("bristle_damping", "damping of bristles per unit of the normal force", 0, -1, 1, 0.0),
)  # fmt: skip
# From the part N of the joint's reaction force across its axis plus `preload`: at the sliding speed v (radius
# times rate of the angle, rate of the stroke, or the root of the sum of their squares) the force mu N opposes
# sliding, mu = (dynamic + (static - dynamic) exp(-(v/stribeck)^2)) tanh(v/creep).  In a screw the force on
# the flanks of its square thread adds to N.
FRICTION = Law(
    "FRICTION",
    5,
    (
        Parameter("dynamic", "coefficient of sliding friction"),
        Parameter("static", "coefficient of static friction"),
        Parameter("stribeck", "speed in which one fades into the other", 0, 1, -1, above=LEAST_SPEED),
        Parameter("creep", "speed in which friction rises from 0, without bristles", 0, 1, -1, 1e-3,
                  above=LEAST_SPEED),
        Parameter("radius", "radius of the bearing", 0, 1, 0, 0.0),
        Parameter("preload", "force between the parts besides the reaction", 1, 0, 0, 0.0),
        *BRISTLES,
    ),
    (Joint,),
    ("dynamic", "static"),
    "dry friction in a joint, from its reaction force",
)  # fmt: skip
# Hunt and Crossley's force at the depth d of two shapes, and friction by it, as in FRICTION.
CONTACT = Law(
    "CONTACT",
    6,
    (
        Parameter("stiffness", "normal force per depth^exponent of each point, N/m^exponent", 1, -1),
        Parameter("exponent", "power of the depth", default=1.0, above=0.5),
        Parameter("damping", "share of the force that a rate of 1 adds", 0, -1, 1, 0.0),
        Parameter("friction", "coefficient of sliding friction", default=0.0),
        Parameter("static", "coefficient of static friction, if it is larger", default=0.0),
        Parameter("stribeck", "speed in which one fades into the other", 0, 1, -1, 1e-2, above=LEAST_SPEED),
        Parameter("creep", "speed in which friction rises from 0", 0, 1, -1, 1e-3, above=LEAST_SPEED),
        Parameter("rolling", "lever of the normal force that resists rolling", 0, 1, 0, 0.0),
        Parameter("torsion", "lever of the normal force that resists turning about the normal", 0, 1, 0, 0.0),
        *BRISTLES,
        Parameter("restitution", "ratio of speeds after and before a free collision at `speed`", default=1.0,
                  above=0.0),
        Parameter("speed", "speed of approach at which `restitution` holds", 0, 1, -1, 0.0),
    ),
    (Touch,),
    ("stiffness",),
    "contact of two shapes, with friction",
)  # fmt: skip
LAWS = (SPRING, CABLE, STOP, BUSHING, MOTOR, FRICTION, CONTACT, FORCE, TORQUE)
PARTS_OF_FRAMES = (
    ("x", LENGTH),
    ("y", LENGTH),
    ("z", LENGTH),
    ("about x", TURN),
    ("about y", TURN),
    ("about z", TURN),
)


@dataclass(frozen=True, slots=True)  # a deck may have thousands
class Element:
    """A force element: a law with the `values` of its parameters, and what it measures."""

    name: str
    law: Law
    measure: Any  # At, Cam, Line, Frames, Joint, Push or Touch
    values: tuple[Any, ...]
    place: Place | None = None

    def __getitem__(self, parameter: str) -> Any:
        """Return the value of a parameter."""
        for p, value in zip(self.law.parameters, self.values, strict=True):
            if p.name == parameter:
                return value
        raise KeyError(parameter)

    def with_values(self, **changed: Any) -> "Element":
        """Return the element with other values of some parameters."""
        return replace(self, values=self.changed(lambda p, value: changed.get(p.name, value)))

    @property
    def turning(self) -> bool:
        """Return whether its coordinate is an angle."""
        if isinstance(self.measure, Push):
            return self.measure.turning
        return isinstance(self.measure, At | Cam) and is_angle(self.measure.coordinate)

    @property
    def sticks(self) -> bool:
        """Return whether it has friction by bristles, which are states of the motion."""
        return BRISTLES[0] in self.law.parameters and self[BRISTLES[0].name] > 0.0

    @property
    def linear(self) -> bool:
        """Return whether it is a spring and damper without preload and functions."""
        return self.law is SPRING and not (self["preload"] or self["curve"] or self["damper"])

    @property
    def idle(self) -> bool:
        """Return whether it can never act; a spring without stiffness still shows its coordinate."""
        acting = [self[name] for name in self.law.acting]
        return bool(acting) and not any(any(x) if isinstance(x, tuple) else x for x in acting)

    @property
    def parts(self) -> list[tuple[str, str]]:
        """Return its names in results, and the unit of each coordinate, "m" or "rad"."""
        if isinstance(self.measure, Frames):
            return [(f"{self.name} {part}", unit) for part, unit in PARTS_OF_FRAMES]
        if isinstance(self.measure, Touch) and self.measure.names > 1:
            return [(f"{self.name} {k}", LENGTH) for k in range(1, self.measure.names + 1)]
        return [(self.name, TURN if self.turning else LENGTH)]

    def since(self, start: float) -> "Element":
        """Return the element where the coordinate counts from `start`."""
        return replace(self, values=self.changed(lambda p, value: value - start if p.counted else value))

    def numbers(self, number: Callable[[Any], int]) -> tuple[Any, ...]:
        """Return the values one after the other, functions by their `number`, 0 for none."""
        numbers: list[Any] = []
        for p, value in zip(self.law.parameters, self.values, strict=True):
            if p.kind in FUNCTIONS:
                numbers.append(number(value) if value else 0)
            else:
                numbers += value if p.kind == VECTOR else [value]
        return tuple(numbers)

    def changed(self, change: Callable[[Parameter, Any], Any]) -> tuple[Any, ...]:
        """Return what `change` makes of each parameter and its value."""
        return tuple(change(p, value) for p, value in zip(self.law.parameters, self.values, strict=True))


def spring(
    name: str,
    measure: At | Line,
    stiffness: float = 0.0,
    rest: float = 0.0,
    damping: float = 0.0,
    place: Place | None = None,
) -> Element:
    """Return a linear spring and damper."""
    values = SPRING.values(stiffness=stiffness, rest=rest, damping=damping)
    return Element(name, SPRING, measure, values, place)
