"""The one table of the dynamic cards of a YOUNG deck: keywords, sections and columns."""

from dataclasses import dataclass
from functools import cached_property

from .sections import Column


@dataclass(frozen=True)
class Card:
    """A card: its keyword, the section its records form, and its columns.

    The last `optional` columns may be left out and are then 0.
    """

    keyword: str
    section: str
    columns: tuple[Column, ...]
    optional: int = 0

    @cached_property
    def positions(self) -> dict[str, int]:
        """Where among the columns each key stands."""
        return {column.key: k for k, column in enumerate(self.columns)}


def _whole(key, meaning):
    return Column(key, meaning, is_integer=True)


def _vector(key, meaning, unit):
    return tuple(Column(f"{key}.{axis}", f"{axis} of {meaning}", unit) for axis in "xyz")


_BODY = _whole("body", "number of the body")
_FOLLOWING = _whole("following", "0: global axes, 1: the axes of the body, turning with it")

CARDS = (
    Card(
        "MASS",
        "mass",
        (
            _BODY,
            Column("m", "mass", "kg"),
            *_vector("centre", "the centre of mass, body axes", "m"),
            *(
                Column(
                    f"I{a}",
                    f"element {a} of the inertia tensor about the centre of mass, body axes",
                    "kg m^2",
                )
                for a in ("xx", "yy", "zz", "xy", "yz", "zx")
            ),
        ),
        optional=3,
    ),
    Card(
        "FORCE",
        "force",
        (
            _BODY,
            *_vector("P", "the point of action, body axes", "m"),
            *_vector("F", "the force", "N"),
            _FOLLOWING,
        ),
        optional=1,
    ),
    Card("TORQUE", "torque", (_BODY, *_vector("T", "the torque", "N m"), _FOLLOWING), optional=1),
    Card(
        "SPRING",
        "spring",
        (
            _whole("I", "number of body I"),
            _whole("J", "number of body J"),
            *_vector("P_i", "the end on body I, body axes", "m"),
            *_vector("P_j", "the end on body J, body axes", "m"),
            Column("stiffness", "stiffness", "N/m"),
            Column("free_length", "length without force", "m"),
            Column("damping", "force of the damper in line per rate of length", "N s/m"),
        ),
        optional=1,
    ),
    Card(
        "DAMPER",
        "damper",
        (
            _whole("I", "number of body I"),
            _whole("J", "number of body J"),
            *_vector("P_i", "the end on body I, body axes", "m"),
            *_vector("P_j", "the end on body J, body axes", "m"),
            Column("damping", "force per rate of length", "N s/m"),
        ),
    ),
    Card("GRAVITY", "gravity", _vector("g", "the acceleration of gravity, global axes", "m/s^2")),
    Card(
        "VELOCITY",
        "velocity",
        (
            _BODY,
            *_vector("v", "the velocity of the body's origin at the start, global axes", "m/s"),
            *_vector("w", "the angular velocity at the start, global axes", "rad/s"),
        ),
        optional=3,
    ),
    Card("TOLERANCE", "tolerance", (Column("relative", "error tolerance of the integration"),)),
    Card(
        "GALF",
        "generalised-alpha",
        (
            Column("step", "length of the steps of the generalised-alpha method, 0: by the tolerance", "s"),
            Column("radius", "spectral radius at infinity, 1: no numerical damping, 0: the most"),
        ),
    ),
    Card(
        "RAD5",
        "radau",
        (Column("tolerance", "error tolerance of Radau's method of order 5, 0: that of TOLERANCE"),),
        optional=1,
    ),
)
BY_KEYWORD = {card.keyword: card for card in CARDS}
