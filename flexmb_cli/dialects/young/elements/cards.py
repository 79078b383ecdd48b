"""Cards of time functions, joint drivers, joint elements, composite joints and initial joint rates."""

from ....model.laws import COORDINATE_LAWS, Law
from ..card import Card, vector, whole
from ..sections import Column

_NUMBER = whole("number", "number of the function")
_FUNCTION = whole("function", "number of the function that it follows")
_JOINT = whole("joint", "number of the joint, counted through the deck")
_BY_RATE = whole("rate", "0: the function is the coordinate, 1: its rate")
_POINTS = (Column("t", "time of a point", "s"), Column("v", "value there"))
_COEFFICIENTS = (Column("c", "coefficient of the next power of time"),)
_PARTS = (whole("f", "number of a function above"),)

FUNCTION_CARDS = (
    Card("TABLE", "table", (_NUMBER,), repeated=_POINTS, least=2),
    Card("SPLINE", "spline", (_NUMBER,), repeated=_POINTS, least=2),
    Card("POLYNOMIAL", "polynomial", (_NUMBER,), repeated=_COEFFICIENTS, least=1),
    Card(
        "SINE",
        "sine",
        (
            _NUMBER,
            Column("mean", "mean value"),
            Column("amplitude", "amplitude"),
            Column("omega", "angular frequency", "rad/s"),
            Column("phase", "phase at t = 0", "rad"),
        ),
        optional=1,
    ),
    *(
        Card(
            keyword,
            keyword.lower(),
            (
                _NUMBER,
                Column("start", "time up to which the first value holds", "s"),
                Column("from", "first value"),
                Column("end", "time from which the last value holds", "s"),
                Column("to", "last value"),
            ),
        )
        for keyword in ("RAMP", "STEP")
    ),
    Card("SUM", "sum", (_NUMBER,), repeated=_PARTS, least=1),
    Card("PRODUCT", "product", (_NUMBER,), repeated=_PARTS, least=1),
)  # fmt: skip

_ENDS = (
    whole("I", "number of body I, 0: the ground"),
    whole("J", "number of body J, 0: the ground"),
    *vector("P_i", "the end on body I, body axes", "m"),
    *vector("P_j", "the end on body J, body axes", "m"),
)
_LINK = Column("length", "length of the link", "m")


def _spring(keyword: str, section: str, coordinate: str, force: str, unit: str) -> Card:
    columns = (
        _JOINT,
        Column("stiffness", f"{force} per {coordinate}", f"{force}/{unit}"),
        Column("rest", f"{coordinate} without {force}", unit),
        Column("damping", f"{force} per rate", f"{force} s/{unit}"),
        Column("preload", f"{force} at rest, against a positive {coordinate}", force),
        whole("curve", f"number of a function of {coordinate} - rest that adds to the {force}, 0: none"),
        whole("damper", f"number of a function of the rate that adds to the {force}, 0: none"),
    )
    return Card(keyword, section, columns, optional=5)


def _law(law: Law, letter: str) -> Card:
    words = (
        {"coordinate": "angle", "effort": "N m"} if letter == "T" else {"coordinate": "stroke", "effort": "N"}
    )
    columns = (Column(p.name, p.meaning.format_map(words), p.unit(letter == "T")) for p in law.parameters)
    keyword = f"{letter}{law.word}"
    return Card(keyword, keyword.lower(), (_JOINT, *columns), optional=law.optional)


JOINT_CARDS = (
    Card("DRIVE", "drive", (whole("driver", "number of the driver"), _FUNCTION, _BY_RATE), optional=1),
    Card("SUPPORT", "support", (whole("simplified", "number of the simplified constraint"), _FUNCTION)),
    Card("ANGLE", "angle", (_JOINT, _FUNCTION, _BY_RATE), optional=1),
    Card("STROKE", "stroke", (_JOINT, _FUNCTION, _BY_RATE), optional=1),
    Card("TMOTOR", "tmotor", (_JOINT, _FUNCTION)),
    Card("AMOTOR", "amotor", (_JOINT, _FUNCTION)),
    _spring("TSPRING", "tspring", "angle", "N m", "rad"),
    _spring("ASPRING", "aspring", "stroke", "N", "m"),
    *(_law(law, letter) for law in COORDINATE_LAWS for letter in "TA"),
    Card(
        "LSPRING",
        "lspring",
        (
            *_ENDS,
            Column("stiffness", "stiffness", "N/m"),
            Column("rest", "length without force", "m"),
            Column("damping", "force per rate of length", "N s/m"),
            Column("preload", "pull at the length rest", "N"),
            whole("curve", "number of a function of length - rest that adds to the pull, 0: none"),
            whole("damper", "number of a function of the rate that adds to the pull, 0: none"),
        ),
        optional=4,
    ),
    Card(
        "CABLE",
        "cable",
        (
            *_ENDS,
            Column("stiffness", "pull per stretch", "N/m"),
            Column("rest", "length up to which it is slack", "m"),
            Column("damping", "share of the pull that a rate of 1 m/s adds", "s/m"),
        ),
        optional=1,
    ),
    Card(
        "BUSHING",
        "bushing",
        (
            *_ENDS,
            *vector("k", "the stiffness, axes of body I", "N/m"),
            *vector("kr", "the stiffness against turns, axes of body I", "N m/rad"),
            *vector("c", "the damping, axes of body I", "N s/m"),
            *vector("cr", "the damping of turns, axes of body I", "N m s/rad"),
        ),
        optional=6,
    ),
    Card(
        "COUPLING",
        "coupling",
        (),
        repeated=(
            whole("joint", "number of a joint, counted through the deck"),
            whole("coordinate", "1: its angle, 2: its stroke"),
            Column("factor", "factor of this coordinate in the sum that stays 0"),
        ),
        least=2,
    ),
    Card(
        "FRICTION",
        "friction",
        (
            _JOINT,
            Column("dynamic", "coefficient of sliding friction"),
            Column("static", "coefficient of static friction"),
            Column("stribeck", "speed in which one fades into the other", "m/s"),
            Column("creep", "speed in which friction rises from 0", "m/s"),
            Column("radius", "radius of the bearing", "m"),
            Column("preload", "force between the parts besides the reaction", "N"),
        ),
        optional=2,
    ),
    Card(
        "REVCYL",
        "revcyl",
        (*_ENDS, *vector("s_i", "the axis of the revolute, body axes", "m"),
         *vector("s_j", "the axis of the cylindrical, body axes", "m")),
    ),
    Card(
        "REVSPH",
        "revsph",
        (*_ENDS, *vector("s_i", "the axis of the revolute, body axes", "m"), _LINK),
    ),
    Card("SPHSPH", "sphsph", (*_ENDS, _LINK)),
    Card(
        "RATE",
        "rate",
        (
            _JOINT,
            whole("coordinate", "1: its angle, 2: its stroke"),
            Column("rate", "rate at the start", "rad/s or m/s"),
        ),
    ),
    Card("JOINTS", "joints", ()),
)  # fmt: skip
# Those that bring in equations, or take those of the deck away.
CONSTRAINING = ("drive", "support", "angle", "stroke", "coupling", "revcyl", "revsph", "sphsph")
