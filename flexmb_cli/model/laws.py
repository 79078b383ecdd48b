"""Laws of elements in a joint coordinate, a record each: cards, units, names and conversions follow from it.

A new law is one record here and one branch of `kernels.laws`, of the same code.
"""

from typing import NamedTuple

from ..errors import Place
from ..quick_dataclass import dataclass

OWN_SHAPES = 4  # codes 1 to 4 of `arrays.laws` have fields of their own
MOST_PARAMETERS = 4


class Parameter(NamedTuple):
    """A number of a law; its unit is effort^effort coordinate^length s^time."""

    name: str
    meaning: str
    effort: int = 0
    length: int = 0
    time: int = 0
    positive: bool = True  # whether it must not be negative
    counted: bool = False  # a value of the coordinate: it counts from another start after a conversion

    def unit(self, angle: bool) -> str:
        """The unit in an angle or a stroke, such as N m s2/rad2."""
        powers = {"N m" if angle else "N": self.effort, "s": self.time, "rad" if angle else "m": self.length}
        up, down = (
            [f"{unit}{abs(n) if abs(n) > 1 else ''}" for unit, n in powers.items() if sign * n > 0] for sign in (1, -1)
        )
        return " ".join(up or ["1"]) + ("/" + " ".join(down) if down else "")


class Law(NamedTuple):
    """A law by its word in decks (`DRAG`) and its code."""

    word: str
    code: int
    parameters: tuple[Parameter, ...]


LAWS = (
    Law(
        "CUBIC",
        6,
        (
            Parameter("stiffness", "effort per cube of the stretch", effort=1, length=-3),
            Parameter("rest", "coordinate at rest", length=1, positive=False, counted=True),
        ),
    ),
    Law("DRAG", 5, (Parameter("coefficient", "effort per square of the rate", effort=1, length=-2, time=2),)),
)


@dataclass(frozen=True)
class JointLaw:
    """A law in a joint coordinate, with the `values` of its parameters."""

    name: str
    joint: int
    coordinate: str
    law: Law
    values: tuple[float, ...]
    place: Place | None = None
