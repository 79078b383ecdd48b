"""A mechanism in absolute coordinates: bodies, joints, simplified constraints, drivers, points.

Bodies are numbered from 0 here and from 1 in decks and names.  Lengths in m, angles in rad, times
in s; local vectors are in the axes of their body.  Attitudes are Euler parameters (e0, e1, e2, e3).
Every item keeps its readable name and its place in the deck.
"""

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from ..errors import Place

if TYPE_CHECKING:  # few decks have any
    from .shapes import Shape

GROUND = -1  # number of the body that stays at rest, body 0 of the cards
SINE_OF_PARALLELS = 1e-9  # of the angle between directions that count as parallel

Vector = tuple[float, float, float]  # as in `vectors`, which takes numpy


@dataclass(frozen=True)
class Body:
    """A rigid body with its estimated position and (normalised) Euler parameters at the start."""

    name: str
    r: Vector
    p: tuple[float, float, float, float]
    place: Place | None = None

    @property
    def modes(self) -> int:
        """Number of modal coordinates: it does not deform."""
        return 0


@dataclass(frozen=True)
class Joint:
    """A joint of `kind` (a name of `joint_types.JOINT_TYPES`) between bodies `i` and `j`.

    `P_i`, `P_j`: joint points; `s_i`, `s_j`: vectors along the axis (or the cross's arms); `h_i`,
    `h_j`: vectors across the axis (translational, screw); `pitch`: advance per radian (screw), m.
    """

    kind: str
    name: str
    i: int
    j: int
    P_i: Vector
    P_j: Vector
    s_i: Vector = (0.0, 0.0, 0.0)
    s_j: Vector = (0.0, 0.0, 0.0)
    h_i: Vector = (0.0, 0.0, 0.0)
    h_j: Vector = (0.0, 0.0, 0.0)
    pitch: float = 0.0
    place: Place | None = None


@dataclass(frozen=True)
class Simplified:
    """A coordinate of one body held at a value; directions 1-3 x y z (m), 4-6 angles (rad)."""

    name: str
    body: int
    direction: int
    value: float
    place: Place | None = None


@dataclass(frozen=True)
class Distance:
    """A difference of coordinates, body `i` less body `j`; directions 4-6 compare e1, e2, e3."""

    name: str
    i: int
    j: int
    direction: int
    value: float
    place: Place | None = None


@dataclass(frozen=True)
class Driver:
    """A coordinate prescribed as C + B t + A t²/2; directions 4-6 turn the body about global x, y, z."""

    name: str
    body: int
    direction: int
    C: float
    B: float
    A: float
    place: Place | None = None


@dataclass(frozen=True)
class Ground:
    """A body at rest: its three coordinates (m) and three angles (rad)."""

    name: str
    body: int
    values: tuple[float, float, float, float, float, float]
    place: Place | None = None


@dataclass(frozen=True)
class Point:
    """A point of interest, fixed to a body at local coordinates `s`."""

    name: str
    body: int
    s: Vector
    place: Place | None = None


@dataclass(frozen=True)
class TimeGrid:
    """Report times start + k·step up to end."""

    start: float
    end: float
    step: float
    place: Place | None = None

    @property
    def rows(self) -> int:
        """Number of report times: none lies past `end` by more than round-off."""
        return int((self.end - self.start) / self.step + 1e-6) + 1

    @property
    def last(self) -> float:
        """The last report time."""
        return self.time(self.rows - 1)

    @property
    def left_out(self) -> str:
        """Return what to say where the end is no report time, "" where it is."""
        # The round-off that `rows` allows.
        if self.end - self.last <= 1e-6 * self.step:
            return ""
        last = f"the last within whole steps is at {self.last:.15g} s"
        return f"no row stands at the end {self.end:.15g} s: {last}"

    def time(self, k: int) -> float:
        """The k-th report time, computed from k and never by adding up."""
        return self.start + k * self.step


@dataclass(frozen=True)
class ListedTimes(TimeGrid):
    """Report times that are listed, in ascending order, from `start` to `end`."""

    times: tuple[float, ...] = ()

    @property
    def rows(self) -> int:
        """Number of report times."""
        return len(self.times)

    def time(self, k: int) -> float:
        """The k-th report time."""
        return self.times[k]


@dataclass(frozen=True)
class Mechanism:
    """Everything a kinematic analysis needs, in the deck's order."""

    bodies: tuple[Body, ...]
    time: TimeGrid
    joints: tuple[Joint, ...] = ()
    simplified: tuple[Simplified, ...] = ()
    distances: tuple[Distance, ...] = ()
    drivers: tuple[Driver, ...] = ()
    grounds: tuple[Ground, ...] = ()
    points: tuple[Point, ...] = field(default=())
    shapes: tuple["Shape", ...] = ()
    loop_tolerance: float = 0.0  # scaled gap at which overconstrained loops count as closed
