"""Drivers, force elements and couplings at joints, and composite joints.

A joint coordinate is the angle of body J against body I about the joint's axis, rad, or the stroke of P_j
along it, m; both are 0 at the deck's estimates.  Hinges of a tree have the coordinates "rotation 1" to
"translation 3" of the tree instead.  Joints and drivers are numbered from 0 here.  Body -1 is the ground,
whose axes are global.
"""

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, fields
from typing import Any

from ..errors import Place
from .joints import JOINT_TYPES, NODE_JOINT_TYPES
from .laws import Element, Law, is_angle
from .mechanism import Vector
from .time_functions import MotionFunction

USUAL_EXPONENT = 10  # of two, of the largest factor of a coupling that is left as it is
# The coordinates that the joints of each type have.
COORDINATES_OF = {kind.name: kind.coordinates for kind in (*JOINT_TYPES, *NODE_JOINT_TYPES)}


@dataclass(frozen=True)
class JointDriver:
    """A joint coordinate that follows a function."""

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
class Coupling:
    """Σ factor · joint coordinate = 0 for `terms` (joint, coordinate, factor): gears, racks, belts.

    With a `function` f, of a cam: first coordinate = f(last coordinate) for two terms.
    """

    name: str
    terms: tuple[tuple[int, str, float], ...]
    place: Place | None = None
    function: MotionFunction | None = None

    @property
    def of_angles(self) -> bool:
        """Return whether it is an equation of angles, whose effort at a factor of 1 is in N m."""
        return all(is_angle(name) for _, name, _ in self.terms[: 1 if self.function else None])

    @property
    def scale(self) -> float:
        """Power of two that its equation is divided by, 1 of usual factors: a rank is found beside others."""
        exponent = math.frexp(max(abs(factor) for _, _, factor in self.terms))[1]
        return 1.0 if abs(exponent) <= USUAL_EXPONENT else math.ldexp(1.0, exponent)


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
class JointStart:
    """A joint coordinate at the start, rad or m, and its rate, rad/s or m/s; None where it is not given."""

    name: str
    joint: int
    coordinate: str
    value: float | None = None
    rate: float | None = None
    place: Place | None = None


@dataclass(frozen=True)
class JointElements:
    """All elements in the order of the deck."""

    drivers: tuple[JointDriver, ...] = ()
    driven: tuple[DrivenItem, ...] = ()
    supports: tuple[DrivenItem, ...] = ()
    forces: tuple[Element, ...] = ()  # motors after all others
    couplings: tuple[Coupling, ...] = ()
    composites: tuple[CompositeJoint, ...] = ()
    starts: tuple[JointStart, ...] = ()

    def __bool__(self) -> bool:
        return any(getattr(self, field.name) for field in fields(self))

    def of(self, *laws: Law) -> tuple[Element, ...]:
        """Return the force elements of some laws."""
        return tuple(item for item in self.forces if item.law in laws)

    @property
    def first_values(self) -> dict[tuple[int, str], float]:
        """Return the values at the start that are given, by joint and coordinate."""
        return {(item.joint, item.coordinate): item.value for item in self.starts if item.value is not None}

    def groups(self) -> list[tuple[Any, ...]]:
        """Return the tuples of all types."""
        return [getattr(self, field.name) for field in fields(self)]


def names_of(elements: JointElements, springs: Iterable[Element] = ()) -> Iterator[tuple[str, str]]:
    """Yield the name of each part of every spring and element, and the unit of its coordinate, m or rad."""
    for item in (*springs, *elements.forces):
        yield from item.parts
