"""Force laws of elements in a joint coordinate, a record each.

Cards of all dialects, their units, names, checks and conversion, and the arrays of both formulations follow
from these records.  A new law is one record here and one branch of `kernels.laws`, of the same code.
"""

from dataclasses import dataclass
from typing import Any, NamedTuple

from ..errors import Place

# Codes of laws with fields of their own; those of LAWS follow.
SPRING, CABLE, MOTOR = 1, 2, 3


class Parameter(NamedTuple):
    """A number of a law; its unit is effort^effort coordinate^length s^time."""

    name: str  # in decks and results
    meaning: str  # {coordinate} and {effort} stand for the words of a card
    effort: int = 0  # power of the unit of the effort
    length: int = 0  # power of the unit of the coordinate
    time: int = 0  # power of the second
    default: float | None = None  # in its unit; None: it must be given
    signed: bool = False  # whether it may be negative
    counted: bool = False  # a value of the coordinate: it counts from another start after a conversion
    above: str = ""  # parameter than which it must be larger

    def unit(self, turning: bool) -> str:
        """Return the unit in an angle or a stroke, such as N m s2/rad2."""
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


class Law(NamedTuple):
    """A law by its word in decks, of at most six letters, and its code."""

    word: str  # behind the letter of the coordinate: TSTOP, ASTOP, HSTO
    code: int  # that of its branch in `kernels.laws`
    parameters: tuple[Parameter, ...]  # in the order of the card

    @property
    def optional(self) -> int:
        """Return how many parameters at the end of a card have defaults."""
        given = [k for k, p in enumerate(self.parameters, 1) if p.default is None]
        return len(self.parameters) - max(given, default=0)


# Hunt and Crossley's force at the depth s > 0 beyond a limit: stiffness s (1 + damping ds/dt), never below 0.
STOP = Law(
    "STOP",
    4,
    (
        Parameter("lower", "least {coordinate}", length=1, default=0.0, signed=True, counted=True),
        Parameter(
            "upper", "largest {coordinate}", length=1, default=0.0, signed=True, counted=True, above="lower"
        ),
        Parameter("stiffness", "{effort} per depth", effort=1, length=-1),
        Parameter("damping", "share of the force that a rate of 1 adds", length=-1, time=1, default=0.0),
    ),
)
LAWS = (STOP,)


@dataclass(frozen=True)
class JointLaw:
    """A law in a joint coordinate, with the `values` of its parameters."""

    name: str
    joint: int
    coordinate: str
    law: Law
    values: tuple[float, ...]
    place: Place | None = None

    def __getitem__(self, parameter: str) -> float:
        """Return the value of a parameter."""
        return self.values[[p.name for p in self.law.parameters].index(parameter)]

    def since(self, start: float) -> tuple[float, ...]:
        """Return the values where the coordinate counts from `start`."""
        return self._changed(lambda p, value: value - start if p.counted else value)

    def in_units(self, effort: float, length: float) -> tuple[float, ...]:
        """Return the values where the units of effort and coordinate are so many of the new ones."""
        return self._changed(lambda p, value: effort**p.effort * length**p.length * value)

    def _changed(self, change: Any) -> tuple[float, ...]:
        return tuple(change(p, value) for p, value in zip(self.law.parameters, self.values, strict=True))
