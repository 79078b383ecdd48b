"""The one table of a YOUNG deck: its sections in reading order, and every number of them.

Liang Yong, YOUNG dissertation (1996), chapter 5 and the reading procedures of the listing.  Lengths
in m, angles in rad, times in s; points in the axes of their body.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

from ...deck import number
from ...model.joints import JOINT_TYPES, PITCH, JointType
from . import DIALECT

COUNT_OF = {name: count for count, name in DIALECT.joints.items()}
# Other dialects may have more.
YOUNG_JOINTS = tuple(kind for kind in JOINT_TYPES if kind.name in COUNT_OF)


@dataclass(frozen=True)
class Column:
    """One number of a record: what it is called, what it means, its unit.

    `turning_unit` and `turning_meaning` hold where the record's direction is 4 to 6.
    `is_text`: it is a word, such as the name of a file; `is_function`: it may be the name of one.
    """

    key: str
    meaning: str
    unit: str = ""
    is_integer: bool = False
    turning_unit: str = ""
    turning_meaning: str = ""
    is_text: bool = False
    is_function: bool = False

    def label(self, turning: bool) -> tuple[str, str]:
        """Meaning and unit, in a record whose direction is a rotation (`turning`) or not."""
        if turning and self.turning_meaning:
            return self.turning_meaning, self.turning_unit
        return self.meaning, self.unit


@dataclass(frozen=True)
class Section:
    """A section: its name in `--set`, the count that announces it, and its columns.

    `count` is "" for the sections that stand once in every deck.  `subject` names a record in messages.
    """

    name: str
    count: str
    subject: str
    columns: tuple[Column, ...]

    @cached_property
    def spellings(self) -> tuple[Callable[[str], tuple[float, str]], ...]:
        """Return what makes a number of the word in each column, see `number`."""
        return tuple(number.integer if column.is_integer else number.real for column in self.columns)

    @cached_property
    def positions(self) -> dict[str, int]:
        """Return where among the columns each key stands."""
        return {column.key: k for k, column in enumerate(self.columns)}

    @cached_property
    def direction(self) -> int | None:
        """Return where among the columns the direction stands, None when the records have none."""
        return self.positions.get("direction")


def _whole(key: str, meaning: str) -> Column:
    return Column(key, meaning, is_integer=True)


def _joint(kind: JointType) -> Section:
    columns = [_whole("I", "number of body I"), _whole("J", "number of body J")]
    for point in kind.points:
        body = point[-1].upper()
        columns += [
            Column(
                f"{point}.{axis}", f"{axis} of {point[0]} on body {body}, body axes{_ROLES[point[0]]}", "m"
            )
            for axis in "xyz"
        ]
    if kind.size == PITCH:
        columns.append(Column("pitch", "advance of the screw per radian", "m/rad"))
    return Section(kind.name, COUNT_OF[kind.name], f"{kind.name} joint", tuple(columns))


_ROLES = {
    "P": ": the joint point",
    "Q": ": s = Q - P points along the axis",
    "H": ": h = H - P points across the axis",
}


def drawing(section: Section) -> str:
    """Return the points P, Q and H of a joint in characters, "" for other records."""
    points = {column.key[0] for column in section.columns if column.key[1:3] == "_i"}
    if "P" not in points:
        return ""
    along = "an arm of its cross" if section.name == "universal" else "along the axis"
    across = ["            H", "            |   h = H - P, across the axis", "            |"]
    axis = f"    body ===P--------->Q   s = Q - P, {along}" if "Q" in points else "    body ===P=== body"
    ends = ", ".join(f"{point}_i" for point in sorted(points)), ", ".join(f"{p}_j" for p in sorted(points))
    where = f"    {ends[0]} in the axes of body I, {ends[1]} in those of body J"
    return "\n".join([*(across if "H" in points else []), axis, where])


_BODY = _whole("body", "number of the body")
_DIRECTION = _whole("direction", "1 2 3: along x y z; 4 5 6: about x y z")

COUNTS = Section(
    "counts",
    "",
    "counts",
    (
        _whole("NBODY", "number of bodies"),
        _whole("NDRIVE", "number of drivers"),
        _whole("NPOINT", "number of points of interest"),
        *(_whole(COUNT_OF[kind.name], f"number of {kind.name} joints") for kind in YOUNG_JOINTS),
        _whole("NSIMPL", "number of simplified constraints"),
        _whole("NSIMP2", "number of distance constraints"),
        _whole("NGROUN", "number of ground bodies"),
    ),
)

BODIES = Section(
    "body",
    "NBODY",
    "body",
    (
        *(Column(axis, f"estimate of {axis} of the body's origin at the start", "m") for axis in "xyz"),
        *(Column(f"e{k}", f"estimate of Euler parameter e{k} at the start") for k in range(4)),
    ),
)

DRIVERS = Section(
    "driver",
    "NDRIVE",
    "driver",
    (
        _BODY,
        _DIRECTION,
        Column("C", "coordinate at t = 0", "m", False, "rad", "angle at t = 0"),
        Column("B", "velocity at t = 0", "m/s", False, "rad/s", "angular velocity at t = 0"),
        Column("A", "acceleration", "m/s^2", False, "rad/s^2", "angular acceleration"),
    ),
)

POINTS = Section(
    "point",
    "NPOINT",
    "point of interest",
    (_BODY, *(Column(axis, f"{axis} of the point, body axes", "m") for axis in "xyz")),
)

SIMPLIFIED = Section(
    "simplified",
    "NSIMPL",
    "simplified constraint",
    (
        _BODY,
        _DIRECTION,
        Column("value", "value of the coordinate", "m", False, "rad", "angle v: e = sin(v/2)"),
    ),
)

DISTANCES = Section(
    "distance",
    "NSIMP2",
    "distance constraint",
    (
        _whole("I", "number of body I"),
        _whole("J", "number of body J"),
        _whole("direction", "1 2 3: x y z; 4 5 6: e1 e2 e3"),
        Column(
            "value", "coordinate of I less that of J", "m", False, "", "Euler parameter of I less that of J"
        ),
    ),
)

GROUNDS = Section(
    "ground",
    "NGROUN",
    "ground",
    (
        _BODY,
        *(Column(axis, f"{axis} of the body's origin", "m") for axis in "xyz"),
        Column("alpha", "angle about x: e1 = sin(alpha/2)", "rad"),
        Column("beta", "angle about y: e2 = sin(beta/2)", "rad"),
        Column("gamma", "angle about z: e3 = sin(gamma/2)", "rad"),
    ),
)

TIME = Section(
    "time",
    "",
    "time",
    (
        Column("start", "time of the first row, Ti", "s"),
        Column("end", "no row is later, Te", "s"),
        Column("step", "time between rows, dT", "s"),
    ),
)

YOUNG_SECTIONS = (
    COUNTS,
    BODIES,
    DRIVERS,
    POINTS,
    *map(_joint, YOUNG_JOINTS),
    SIMPLIFIED,
    DISTANCES,
    GROUNDS,
    TIME,
)
