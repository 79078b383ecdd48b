"""Drivers, force elements and couplings at joints, composite joints, points on curves, and rolling.

A joint coordinate is the angle of body J against body I about the joint's axis, rad, or the stroke of P_j
along it, m; both are 0 at the deck's estimates.  Hinges of a tree have the coordinates "rotation 1" to
"translation 3" of the tree instead.  Joints and drivers are numbered from 0 here.  Body -1 is the ground,
whose axes are global.
"""

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, fields
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from ..errors import Place
from .general_joints import GeneralJoint, Switch
from .joints import ANGLES_OF_CROSS, JOINT_TYPES, NODE_JOINT_TYPES
from .laws import FRICTION, MOTOR, At, Element, Law, is_angle
from .mechanism import Vector
from .signals import Signal
from .time_functions import MotionFunction, values_at

CURVE_SAMPLES = 400  # places of a curve at which it is looked at
ARC_PANELS = 256  # of its arc length, each integrated by Gauss's formula
# Places and weights of Gauss's formula of 8 points (Abramowitz and Stegun, table 25.4); numpy takes them from
# eigenvalues, whose last digits depend on the processor.
_PLACES = (0.9602898564975363, 0.7966664774136267, 0.5255324099163290, 0.1834346424956498)
_WEIGHTS = (0.1012285362903763, 0.2223810344533745, 0.3137066458778873, 0.3626837833783620)
ARC_FORMULA = (np.array([-x for x in _PLACES] + list(reversed(_PLACES))), np.array(_WEIGHTS + _WEIGHTS[::-1]))
ALIKE = 1e-9  # of a curve's size: places, and derivatives by its parameter's range, that count as equal
STANDSTILL = 1e-9  # of the largest rate: below it a curve stands still
LEAST_SINE = 1e-2  # sine of that between a curve and the vector across it
BEYOND_END = 1e-9  # of a curve's length: farther beyond an end, the point has left the curve
USUAL_EXPONENT = 10  # of two, of the largest factor of a coupling that is left as it is
# The coordinates that the joints of each type have.
_TYPES = (*JOINT_TYPES, *NODE_JOINT_TYPES)
COORDINATES_OF = {kind.name: kind.coordinates for kind in _TYPES}
OF_ELEMENTS = {kind.name: (*kind.coordinates, *kind.turns) for kind in _TYPES}  # in which elements act


class RollType(NamedTuple):
    """A pair of a shape that rolls and one that it rolls on."""

    code: int  # that of `kernels.rolling`
    directions: tuple[int, ...]  # numbers of its equations


ROLLS = {
    "plane-sphere": RollType(1, (1, 2, 3)),
    "plane-disc": RollType(1, (1, 2, 3)),
    "wheel-wheel": RollType(2, (1, 2)),
}


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
class Roll:
    """A disc, sphere or wheel of body j, about P_j, that rolls without slip on a plane or wheel of body i.

    Axes are those of the bodies, unit vectors.
    """

    name: str
    kind: str  # of ROLLS
    i: int
    j: int
    P_i: Any
    P_j: Any
    axis_i: Vector  # normal of the plane, or axle
    axis_j: Vector = (0.0, 0.0, 0.0)  # axle of a disc
    radius_j: float = 0.0  # m
    radius_i: float = 0.0  # m, of a wheel; negative: it is a ring, in which the other rolls
    place: Place | None = None

    @property
    def code(self) -> int:
        """Return the code of `kernels.rolling`."""
        return ROLLS[self.kind].code

    @property
    def directions(self) -> tuple[int, ...]:
        """Return the numbers of its equations, from 1: along the normal, and across it."""
        return ROLLS[self.kind].directions

    def lies_across(self, normal: np.ndarray) -> bool:
        """Return whether the plane that it rolls on is at right angles to that of a motion with `normal`."""
        return bool(abs(normal @ np.array(self.axis_i)) <= ALIKE)

    @property
    def across(self) -> Vector:
        """Return a unit vector at right angles to `axis_i`."""
        normal = np.array(self.axis_i)
        direction = np.cross(normal, np.eye(3)[np.argmin(np.abs(normal))])
        x, y, z = direction / np.linalg.norm(direction)
        return float(x), float(y), float(z)


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
class Curve:
    """A point P_j of body j on the curve P_i + (f(s), g(s), h(s)), fixed in the axes of body i.

    `begin`, `end`: range of the parameter s; a closed curve continues beyond them.  Ends: points, or nodes.
    """

    name: str
    i: int
    j: int
    P_i: Any
    P_j: Any
    functions: tuple[MotionFunction, MotionFunction, MotionFunction]
    begin: float
    end: float
    place: Place | None = None

    def at(self, s: np.ndarray) -> np.ndarray:
        """Points, and their first two derivatives by the parameter (3, n, 3), at parameters s (n,)."""
        return np.stack([values_at(function, s) for function in self.functions], axis=2)

    @cached_property
    def _samples(self) -> tuple[np.ndarray, np.ndarray]:
        s = np.linspace(self.begin, self.end, CURVE_SAMPLES + 1)
        return s, self.at(s)

    @cached_property
    def closed(self) -> bool:
        """Return whether it continues after its end as it began."""
        s, (first, *rates) = self._samples
        span = s[-1] - s[0]
        _, ahead = s, self.at(s[: CURVE_SAMPLES // 4] + span)
        sizes = [np.ptp(first), *(np.max(np.abs(rate)) for rate in rates)]
        own = (first, *rates)
        return all(
            np.max(np.abs(a - b[: len(a)])) <= ALIKE * max(size, sizes[0] / span**k)
            for k, (a, b, size) in enumerate(zip(ahead, own, sizes, strict=True))
        )

    @property
    def standstill(self) -> float | None:
        """Parameter at which the curve has no direction; None where it has one everywhere."""
        s, (_, rate, _) = self._samples
        speed = np.linalg.norm(rate, axis=1)
        slowest = int(np.argmin(speed))
        return None if speed[slowest] > STANDSTILL * np.max(speed) else float(s[slowest])

    @cached_property
    def across(self) -> np.ndarray | None:
        """Unit vector (3,) that the curve is nowhere parallel to, of a plane curve its normal."""
        _, (_, rate, _) = self._samples
        tangents = rate / np.linalg.norm(rate, axis=1)[:, None]
        axes = np.linalg.svd(tangents)[2]
        signs = np.array([(1, 1, 1), (1, 1, -1), (1, -1, 1), (-1, 1, 1)]) / math.sqrt(3.0)
        trials = np.concatenate([np.eye(3), axes[::-1], signs])
        angles = np.linalg.norm(np.cross(trials[:, None], tangents[None]), axis=2).min(axis=1)
        best = int(np.argmax(angles > angles.max() - LEAST_SINE))
        return trials[best] if angles[best] > LEAST_SINE else None

    def lies_across(self, normal: np.ndarray) -> bool:
        """Return whether a direction (3,), axes of its body, is at right angles to it everywhere."""
        rate = self._samples[1][1]
        return bool(np.max(np.abs(rate @ normal)) <= ALIKE * np.max(np.abs(rate)))

    def nearest(self, p: np.ndarray) -> float:
        """Parameter of the place nearest to a point (3,), from P_i, in the curve's axes, among samples."""
        s, (c, *_) = self._samples
        best = int(np.argmin(np.linalg.norm(c - p, axis=1)))
        return float(s[best])

    @cached_property
    def _table(self) -> np.ndarray:
        s = np.linspace(self.begin, self.end, ARC_PANELS + 1)
        return np.concatenate([[0.0], np.cumsum(self._integrals(s[:-1], s[1:]))])

    def _integrals(self, a: np.ndarray, b: np.ndarray) -> np.ndarray:
        """Lengths (n,) between parameters a and b (n,)."""
        x, w = ARC_FORMULA
        half = (b - a) / 2.0
        s = (a + b)[:, None] / 2.0 + half[:, None] * x
        speed = np.linalg.norm(self.at(s.ravel())[1], axis=1).reshape(s.shape)
        return half * (speed @ w)

    def lengths(self, s: np.ndarray) -> np.ndarray:
        """Arc lengths (n,), m, from the beginning to the parameters s (n,)."""
        span, whole = self.end - self.begin, np.zeros(s.shape)
        if self.closed:
            whole = np.floor((s - self.begin) / span)
        rest = s - whole * span
        width = span / ARC_PANELS
        panel = np.clip(np.floor((rest - self.begin) / width), 0, ARC_PANELS - 1).astype(int)
        return (
            whole * self._table[-1] + self._table[panel] + self._integrals(self.begin + panel * width, rest)
        )

    @property
    def length(self) -> float:
        """Arc length from beginning to end, m."""
        return float(self._table[-1])

    def first_outside(self, lengths: np.ndarray) -> int:
        """Place of the first arc length (n,) beyond an end of an open curve; n where there is none."""
        beyond = BEYOND_END * self.length
        outside = (lengths < -beyond) | (lengths > self.length + beyond)
        return int(np.argmax(outside)) if outside.any() and not self.closed else len(lengths)


def first_outside(curves: Sequence[Curve], lengths: np.ndarray) -> tuple[int, Curve | None]:
    """Return the first row of arc lengths (T, curves) that leaves a curve, and that curve; T and None."""
    ends = [(curve.first_outside(s), k) for k, (curve, s) in enumerate(zip(curves, lengths.T, strict=True))]
    row, k = min(ends, default=(len(lengths), -1))
    return row, None if row == len(lengths) else curves[k]


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
class StartAtRest:
    """The motion begins at rest in the equilibrium that the mechanism falls into under its loads."""

    name: str
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
    generals: tuple[GeneralJoint, ...] = ()
    switches: tuple[Switch, ...] = ()
    later: tuple[Any, ...] = ()  # joints and drivers that are off at the start
    starts: tuple[JointStart, ...] = ()
    rests: tuple[StartAtRest, ...] = ()
    curves: tuple[Curve, ...] = ()
    rolls: tuple[Roll, ...] = ()
    signals: tuple[Signal, ...] = ()

    def __bool__(self) -> bool:
        return any(getattr(self, field.name) for field in fields(self))

    def of(self, *laws: Law) -> tuple[Element, ...]:
        """Return the force elements of some laws."""
        return tuple(item for item in self.forces if item.law in laws)

    @property
    def first_values(self) -> dict[tuple[int, str], float]:
        """Return the values at the start that are given, by joint and coordinate."""
        return {(item.joint, item.coordinate): item.value for item in self.starts if item.value is not None}

    @property
    def on_crosses(self) -> list[Any]:
        """Return the elements in angles of universal joints."""
        moved: tuple[Any, ...] = (*self.drivers, *self.starts)
        named: list[tuple[Any, Iterable[str]]] = [(item, [item.coordinate]) for item in moved]
        named += [(item, [item.measure.coordinate]) for item in self.forces if isinstance(item.measure, At)]
        named += [(item, [name for _, name, _ in item.terms]) for item in self.couplings]
        return [item for item, names in named if set(names) & set(ANGLES_OF_CROSS)]

    @property
    def tracks(self) -> tuple[Roll | Curve, ...]:
        """Return what rolls and what runs on curves, in the order of their equations."""
        return (*self.rolls, *self.curves)

    def groups(self) -> list[tuple[Any, ...]]:
        """Return the tuples of all types."""
        return [getattr(self, field.name) for field in fields(self)]


def names_of(elements: JointElements, springs: Iterable[Element] = ()) -> Iterator[tuple[str, str]]:
    """Yield the name of each part of every spring and element, and the unit of its coordinate, m or rad."""
    for item in (*springs, *elements.forces):
        yield from item.parts


def motors_last(elements: Iterable[Element]) -> tuple[Element, ...]:
    """Return elements in their order, but motors after all others, as results have them."""
    return tuple(sorted(elements, key=lambda item: item.law is MOTOR))


def parts_by_name(elements: Iterable[Element]) -> list[str]:
    """Return the name of each part of elements in the order of arrays, without friction."""
    return [name for item in elements if item.law is not FRICTION for name, _ in item.parts]


def parts_in_arrays(elements: Iterable[Element]) -> list[tuple[Element, int]]:
    """Return the element of each part in results, and its place in arrays, which have friction last."""
    parts = [item for item in elements for _ in item.parts]
    in_arrays = sorted(range(len(parts)), key=lambda k: parts[k].law is FRICTION)
    place = {k: n for n, k in enumerate(in_arrays)}
    return [(item, place[k]) for k, item in enumerate(parts)]
