"""Cards after DYNAMICS, and those of shapes after GEOMETRY: one table of keywords, columns and meanings."""

from dataclasses import dataclass

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

    def takes(self, count: int) -> bool:
        """Return whether a card may have so many numbers."""
        return -self.optional <= count - len(self.columns) <= 0

    @property
    def begins_with_text(self) -> bool:
        """Return whether a word follows its keyword."""
        return bool(self.columns) and self.columns[0].is_text

    @property
    def numbers(self) -> str:
        """Return how many numbers the card takes, and what they are called."""
        keys = " ".join(column.key for column in self.columns)
        most = len(self.columns)
        asked = f"{most}" if not self.optional else f"{most - self.optional} to {most}"
        return f"{asked} {'words' if self.begins_with_text else 'numbers'} ({keys})"


def card(head: str, *columns: Column, optional: int = 0) -> Card:
    """Return a card; `head`: its keyword and its section."""
    keyword, section = head.split()
    return Card(keyword, section, columns, optional)


def whole(key: str, meaning: str) -> Column:
    """A column of integers."""
    return Column(key, meaning, is_integer=True)


def vector(key: str, meaning: str, unit: str) -> tuple[Column, ...]:
    """The columns of three components."""
    return tuple(Column(f"{key}.{axis}", f"{axis} of {meaning}", unit) for axis in "xyz")


_BODY = whole("body", "number of the body")
_FOLLOWING = whole("following", "0: global axes, 1: the axes of the body, turning with it")
_FACTOR = Column(
    "factor", "name or number of the function that multiplies it, 0: none", is_integer=True, is_function=True
)
# What bodies look like in pictures.
_BODY_OR_GROUND = whole("body", "number of the body, 0: the ground")
_PLACED = (
    *vector("offset", "the middle of the shape, body axes", "m"),
    Column("alpha", "angle by which it is turned about x, then", "rad"),
    Column("beta", "about y, then", "rad"),
    Column("gamma", "about z, axes of the body", "rad"),
)
SHAPE_CARDS = (
    card(
        "GEOM shape",
        _BODY_OR_GROUND,
        whole("shape", "1 box, 2 cylinder, 3 tube, 4 cone, 5 sphere"),
        Column("a", "length along x; of all but a box the radius", "m"),
        Column("b", "length along y; of all but a box the length along z", "m"),
        Column("c", "length along z; inner radius of a tube, upper one of a cone", "m"),
        *_PLACED,
        optional=8,
    ),
    card(
        "STL shape_file",
        Column("file", "STL file", is_text=True),
        _BODY_OR_GROUND,
        Column("unit", "metres in a unit of the file", "m"),
        *_PLACED,
        optional=6,
    ),
)
CARDS = (
    card(
        "MASS mass",
        _BODY,
        Column("m", "mass", "kg"),
        *vector("centre", "the centre of mass, body axes", "m"),
        *(
            Column(
                f"I{a}", f"element {a} of the inertia tensor about the centre of mass, body axes", "kg m^2"
            )
            for a in ("xx", "yy", "zz", "xy", "yz", "zx")
        ),
        optional=3,
    ),
    card(
        "FORCE force",
        _BODY,
        *vector("P", "the point of action, body axes", "m"),
        *vector("F", "the force", "N"),
        _FOLLOWING,
        _FACTOR,
        optional=2,
    ),
    card("TORQUE torque", _BODY, *vector("T", "the torque", "N m"), _FOLLOWING, _FACTOR, optional=2),
    card(
        "SPRING spring",
        whole("I", "number of body I, 0: the ground"),
        whole("J", "number of body J, 0: the ground"),
        *vector("P_i", "the end on body I, body axes", "m"),
        *vector("P_j", "the end on body J, body axes", "m"),
        Column("stiffness", "stiffness", "N/m"),
        Column("free_length", "length without force", "m"),
        Column("damping", "force of the damper in line per rate of length", "N s/m"),
        optional=1,
    ),
    card(
        "DAMPER damper",
        whole("I", "number of body I, 0: the ground"),
        whole("J", "number of body J, 0: the ground"),
        *vector("P_i", "the end on body I, body axes", "m"),
        *vector("P_j", "the end on body J, body axes", "m"),
        Column("damping", "force per rate of length", "N s/m"),
    ),
    card("GRAVITY gravity", *vector("g", "the acceleration of gravity, global axes", "m/s^2")),
    card(
        "VELOCITY velocity",
        _BODY,
        *vector("v", "the velocity of the body's origin at the start, global axes", "m/s"),
        *vector("w", "the angular velocity at the start, global axes", "rad/s"),
        optional=3,
    ),
    card("TOLERANCE tolerance", Column("relative", "error tolerance of the integration")),
    card(
        "GALF generalised-alpha",
        Column("step", "length of the steps of the generalised-alpha method, 0: by the tolerance", "s"),
        Column("radius", "spectral radius at infinity, 1: no numerical damping, 0: the most"),
    ),
    card(
        "RAD5 radau",
        Column("tolerance", "error tolerance of Radau's method of order 5, 0: that of TOLERANCE"),
        optional=1,
    ),
    *SHAPE_CARDS,
)


BY_KEYWORD = {each.keyword: each for each in CARDS}
