"""The words of the block ELEMENTS: what their lines say, the keys, units and defaults.

Lines of force laws follow from their records in `model.laws`.  Reader, writer, echo, reference page and the
grammar of editors follow from this table.
"""

from collections.abc import Iterator
from typing import Any, NamedTuple

from ...deck.expansion.expressions import FORMULA
from ...deck.units import UNITS as SYSTEMS
from ...model.joints import CONSTANT_ANGLE, DIRECTIONS
from ...model.laws import FUNCTIONS, LAWS, PAIRS, REQUIRED, VECTOR, At, Joint, Law, Parameter, Push, Touch
from .line import MASS, OUTPUT, UNITS

# What the text after `key=` is; numbers and vectors as in `model.laws`.
NUMBER, WHOLE, FUNCTION, COORDINATE, END, FILE = (
    "number",
    "whole number",
    "function",
    "coordinate",
    "end",
    "file",
)
FUNCTION_KINDS = ("table", "spline", "periodic", "polynomial", "sine", "ramp", "step", "sum", "product")
SIGNALS, NUMBERS, AXIS, NAMED = "signals", "numbers", "axis", "name"
_SAMPLED = ("period", "delay")
# Keys of the types of signals: those that must be given, those that may.  Terms have none.
SIGNAL_KEYS: dict[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "measure": ((), ("at", "from", "to", "along")),
    "sum": ((), ()),
    "product": ((), ()),
    "table": (("of", "function"), ()),
    "limit": (("of",), ("lower", "upper")),
    "deadzone": (("of", "lower", "upper"), ()),
    "switch": (("of", "level", "below", "above"), ("width",)),
    "integral": (("of",), ("lower", "upper", "start")),
    "pid": (("of",), ("kp", "ki", "kd", "filter", "lower", "upper", "start", *_SAMPLED)),
    "transfer": (("of", "numerator", "denominator"), ("lower", "upper", *_SAMPLED)),
    "state": (("of", "a", "b", "c"), ("d", "lower", "upper", "start", *_SAMPLED)),
    "sample": (("of", "period"), ("delay", "start")),
}
# Keys of the numbers after the name of a function that may stand by their places, too.
POSITIONS = {"sine": ("mean", "amplitude", "omega", "phase")}
POSITIONS |= dict.fromkeys(("ramp", "step"), ("start", "from", "end", "to"))
# Keys of a contact's shapes: those of the first body, those of the second.
OF_FIRST: dict[str, tuple[str, ...]] = {
    "plane": ("normal",),
    "sphere": ("radius_from",),
    "box": ("size_from",),
    "mesh": ("file_from", "unit_from"),
}
OF_FIRST |= dict.fromkeys(("capsule", "cylinder"), ("axis_from", "radius_from"))
OF_SECOND: dict[str, tuple[str, ...]] = {"point": (), "sphere": ("radius_to",), "box": ("size_to",)}
OF_SECOND["mesh"] = ("file_to", "unit_to")
OF_SECOND |= dict.fromkeys(("capsule", "cylinder"), ("axis_to", "radius_to"))
# Keys of what rolls on what: of the plane or wheel, and of the sphere, disc or wheel.
ROLL_KEYS: dict[str, tuple[str, ...]] = {
    "plane-sphere": ("normal", "radius_to"),
    "plane-disc": ("normal", "axis_to", "radius_to"),
    "wheel-wheel": ("axis_from", "radius_from", "radius_to"),
}
# Quantities of lines OUTPUT: meaning, unit, whether they are vectors, keys that they need.
_POINTS = ("from", "to")
OUTPUTS: dict[str, tuple[str, str, bool, tuple[str, ...]]] = {
    FORMULA: ("formula of quantities", "1", False, ()),
    "distance": ("distance of two points", "m", False, _POINTS),
    "distance_rate": ("rate of the distance of two points", "m/s", False, _POINTS),
    "position": ("vector from one point to another, axes of a body", "m", True, _POINTS),
    "velocity": ("its derivative in the axes of the body", "m/s", True, _POINTS),
    "cardan": ("angles about x, the new y and the new z, without jumps", "rad", True, ("body",)),
    "roll_pitch_yaw": ("angles about the fixed x, y and z, without jumps", "rad", True, ("body",)),
    "rotation_vector": ("axis times angle of the rotation, without jumps", "rad", True, ("body",)),
    "angular_velocity": ("angular velocity, axes of the other body", "rad/s", True, ("body",)),
}
# Of lines MASS, besides the primitives of cards GEOM.
POINT, STL = "point", "stl"
# Keys of general joints: those that must be given, those that may.
GENERAL_KEYS: dict[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "general": ((), ("free", "axis_from", "across")),
    "weld": ((), ()),
    **dict.fromkeys(("inline", "inplane", "parallel"), (("axis_from",), ())),
    CONSTANT_ANGLE: (("axis_from", "axis_to"), ()),
}
LINKS = {"revcyl": ("axis_from", "axis_to"), "revsph": ("axis_from", "length"), "sphsph": ("length",)}


class Key(NamedTuple):
    """A key of a line; without a default, the record of a line that leaves it out does not have it."""

    name: str  # before the sign =
    meaning: str  # for pages and messages
    kind: str = NUMBER  # of its value
    default: Any = None  # of its value
    units: tuple[str, str] = ("", "")  # along a stroke or a line, and about an axis
    needed: bool = False  # on every line of its word


class BlockWord(NamedTuple):
    """A word that begins lines."""

    word: str  # in capitals
    meaning: str  # for pages
    keys: tuple[Key, ...]  # that its lines may have
    choices: tuple[tuple[tuple[str, ...], ...], ...] = ()  # of each, one group of keys must be given
    kinds: tuple[str, ...] = ()  # words of which one follows the name
    unnamed: bool = False  # whether it may go without a name
    law: Law | None = None  # of force elements

    def key(self, name: str) -> Key | None:
        """Return a key by its name."""
        return next((key for key in self.keys if key.name == name), None)


AT = Key(
    "at",
    "coordinate: joint.angle or joint.stroke, of universal joints joint.angle1 and joint.angle2, of trees "
    "hinge.r1 to hinge.t3",
    COORDINATE,
)
FROM = Key("from", "first end: body(x,y,z) or body:node, body 0 being the ground", END)
TO = Key("to", "second end: body(x,y,z) or body:node", END)
JOINT = Key("joint", "number of the joint or hinge", WHOLE, needed=True)
_ENDS = (FROM._replace(needed=True), TO._replace(needed=True))
_DIRECTION = (
    Key("direction", "direction of a positive effort", VECTOR, needed=True),
    Key("axes", "number of the body in whose axes the direction is, that of `to`; 0: ground", WHOLE, 0),
)
# The primitives of `model.shapes`, which takes numpy.
SOLIDS = ("box", "cylinder", "tube", "cone", "sphere")
_OF_MANY = "; 2-9(x,y,z) or 2-9:node are shapes of bodies 2 to 9, 2:1-5 of nodes 1 to 5"
_SETS = tuple(key._replace(meaning=key.meaning + _OF_MANY) for key in _ENDS)
_SHAPES = (
    Key("normal", "outward normal of the plane through `from`, axes of its body", VECTOR),
    Key("file_from", "STL file of the mesh at `from`, in the axes of its body; its triangles touch", FILE),
    Key("unit_from", "metres in a unit of the file", units=("m", "m")),
    Key("file_to", "STL file of the mesh at `to`, in the axes of its body; its convex hull touches", FILE),
    Key("unit_to", "metres in a unit of the file", units=("m", "m")),
    *(
        Key(f"{what}_{end}", meaning.format(end), kind, units=("m", "m"))
        for end in ("from", "to")
        for what, meaning, kind in (
            ("radius", "radius of the shape at `{}`", NUMBER),
            ("axis", "from `{}` to the other end of its capsule or cylinder, axes of its body", VECTOR),
            ("size", "edges of the box about `{}`, along the axes of its body", VECTOR),
        )
    ),
)
_NAMES = {"function": "effort"}  # of parameters whose keys are called otherwise


def key_of(parameter: Parameter) -> str:
    """Return the key of a parameter of a force law."""
    return _NAMES.get(parameter.name, parameter.name)


def _of_law(law: Law) -> BlockWord:
    """Return the word of a force law: what it measures, and its parameters."""
    if Touch in law.measures:
        return BlockWord(law.word, law.meaning, (*_SETS, *_SHAPES, *_parameters(law)), kinds=PAIRS, law=law)
    if Push in law.measures:
        to = TO._replace(meaning="point or node on which it acts", needed=True)
        return BlockWord(law.word, law.meaning, (to, *_DIRECTION, *_parameters(law)), law=law)
    at, line, joint = At in law.measures, set(law.measures) - {At, Joint}, Joint in law.measures
    measures = (JOINT,) if joint else (AT, FROM, TO) if at and line else (AT,) if at else (FROM, TO)
    both = at and bool(line)
    keys = [key._replace(needed=not both) for key in measures]
    choices = ((("at",), ("from", "to")),) if both else ()
    return BlockWord(
        law.word, law.meaning or f"force law {law.word}", (*keys, *_parameters(law)), choices, law=law
    )


def _parameters(law: Law) -> Iterator[Key]:
    words = {"coordinate": "coordinate", "effort": "effort"}
    for p in law.parameters:
        needed = p.default is REQUIRED
        kind = FUNCTION if p.kind in FUNCTIONS else p.kind
        units = ("", "") if kind == FUNCTION else (_unit(p, False), _unit(p, At in law.measures))
        default = None if needed else p.default
        yield Key(key_of(p), p.meaning.format_map(words), kind, default, units, needed)


def _unit(parameter: Parameter, turning: bool) -> str:
    unit = parameter.unit(turning)
    return "" if unit == "1" else unit


WORDS = (
    BlockWord(
        "FUNCTION",
        "function of time, of a stretch or of a rate",
        (
            Key("file", "text file of its numbers", FILE),
            Key("number", "number under which cards name it", WHOLE),
            Key("points", "number of the table of cards TABL that it goes through", WHOLE),
        ),
        kinds=FUNCTION_KINDS,
    ),
    BlockWord(
        "DRIVE",
        "coordinate, or driver of the deck, that follows a function",
        (
            AT,
            Key("driver", "number of the driver of the deck", WHOLE),
            Key("value", "function that the coordinate follows", FUNCTION),
            Key("rate", "function that its rate follows", FUNCTION),
        ),
        ((("at",), ("driver",)), (("value",), ("rate",))),
    ),
    BlockWord(
        "SUPPORT",
        "held point that moves by functions",
        (
            Key("simplified", "number of the simplified constraint of the deck", WHOLE),
            Key("value", "function that its coordinate follows", FUNCTION),
            Key("pin", "number of the pin of the deck", WHOLE),
            *(Key(axis, f"function added to {axis}", FUNCTION) for axis in "xyz"),
        ),
        ((("simplified", "value"), ("pin",)),),
    ),
    BlockWord(
        "SIGNAL",
        "value that is measured, follows from other signals, or is that of a controller",
        (
            Key("of", "signal, or (signal,signal), that it follows from", SIGNALS),
            *(key._replace(needed=False) for key in (AT, *_ENDS)),
            Key("along", "axis of the first end's body along which it is measured", AXIS),
            Key("function", "function of the signal", FUNCTION),
            Key("lower", "least value"),
            Key("upper", "largest value"),
            Key("level", "value of the signal at which it switches"),
            Key("width", "of the signal, over which it goes from one to the other"),
            Key("below", "signal that it is below that value", SIGNALS),
            Key("above", "signal that it is above that value", SIGNALS),
            Key("kp", "gain of the signal"),
            Key("ki", "gain of its integral, 1/s"),
            Key("kd", "gain of its rate, s"),
            Key("filter", "time constant of the rate, s"),
            *(Key(name, f"coefficients of the {name}, that of the highest power of s, or z, first", NUMBERS)
              for name in ("numerator", "denominator")),
            *(Key(name, f"matrix {name.upper()}, row by row", NUMBERS) for name in "abcd"),
            Key("start", "values of its states at the start, or before the first sample", NUMBERS),
            Key("period", "time from sample to sample, s; without it it is continuous"),
            Key("delay", "time from a sample to the value that follows from it, s"),
            Key("number", "number under which cards name it", WHOLE),
        ),
        kinds=tuple(SIGNAL_KEYS),
    ),
    *map(_of_law, LAWS),
    BlockWord(
        "COUPLING",
        "sum of factors times coordinates, which keeps its first value; or a cam, to = function(from), "
        "one-sided with `stiffness`",
        (
            AT._replace(name="from", meaning="coordinate of the cam"),
            AT._replace(name="to", meaning="coordinate of the follower"),
            Key("function", "function of the cam's coordinate that the follower's equals", FUNCTION),
            Key("stiffness", "of a follower that lifts off: effort per depth", units=("N/m", "N m/rad")),
            Key("damping", "share of the effort that a rate of 1 adds", units=("s/m", "s/rad")),
            Key("lower", "least to - function(from); 0 if neither limit is given", units=("m", "rad")),
            Key("upper", "largest to - function(from)", units=("m", "rad")),
        ),
    ),
    BlockWord(
        "CURVE",
        "point `to` on a curve fixed to the body of `from`, from that point on: a slot, a rail; closed "
        "if it continues after `end` as it began",
        (
            *_ENDS,
            *(Key(axis, f"function of the parameter: {axis} of the curve", FUNCTION) for axis in "xyz"),
            Key("file", "text file of points x y z, which a spline goes through", FILE),
            Key("begin", "parameter at which the curve begins"),
            Key("end", "parameter at which it ends"),
        ),
    ),
    BlockWord(
        "ROLL",
        "disc, sphere or wheel about `to` that rolls without slip on the plane through `from`, or on the "
        "wheel about it; axles of two wheels are parallel",
        (
            *_ENDS,
            Key("normal", "outward normal of the plane, axes of its body", VECTOR),
            Key("axis_from", "axle of the wheel about `from`, axes of its body", VECTOR),
            Key("axis_to", "axle of the disc, axes of its body", VECTOR),
            Key("radius_from", "radius of the wheel about `from`; negative: a ring, in which the other rolls",
                units=("m", "m")),
            Key("radius_to", "radius of the disc, sphere or wheel about `to`", units=("m", "m")),
        ),
        kinds=tuple(ROLL_KEYS),
    ),
    BlockWord(
        "JOINT",
        "joint with a massless link, or one that holds some of six directions",
        (
            *_ENDS,
            Key("axis_from", "axis in the first body: of the revolute joint, or z of the directions", VECTOR,
                units=("m", "m")),
            Key("axis_to", "axis in the second body, of the cylindrical joint or at a constant angle", VECTOR,
                units=("m", "m")),
            Key("length", "length of the link", units=("m", "m")),
            Key("free", f"directions of a general joint that are free: {', '.join(DIRECTIONS)}", SIGNALS),
            Key("across", "x of the directions, axes of the first body", VECTOR, units=("m", "m")),
        ),
        kinds=(*LINKS, *GENERAL_KEYS),
    ),
    *(
        BlockWord(
            word,
            f"joint of a line JOINT, or driver of a line DRIVE, that {does} at a time, or when a quantity "
            "reaches a value",
            (
                Key("of", "name of the joint or driver", NAMED, needed=True),
                Key("time", "time at which that happens, s"),
                Key("when", "quantity of the results, or output, at whose value it happens", NAMED),
                Key("above", "value that the quantity reaches from below, in its SI unit"),
                Key("below", "value that it reaches from above"),
            ),
            ((("time",), ("when",)),),
        )
        for word, does in (("CATCH", "begins to hold"), ("RELEASE", "lets go"))
    ),
    BlockWord(
        MASS,
        "mass that is added to a rigid body: a point, a solid, or what a closed STL surface encloses",
        (
            Key("body", "number of the body", WHOLE, needed=True),
            Key("mass", "its mass", units=("kg", "kg")),
            Key("density", "its density, of a solid", units=("kg/m^3", "kg/m^3")),
            Key("size", "sizes a, b, c as of a card GEOM, or 0", VECTOR, units=("m", "m")),
            Key("file", "STL file", FILE),
            Key("unit", "metres in a unit of the file, 0.001: mm", default=1.0, units=("m", "m")),
            Key("centre", "its middle or a file's origin, axes of the body", VECTOR, (0.0,) * 3, ("m", "m")),
            Key("angles", "turn about the fixed axes x, y, z", VECTOR, (0.0,) * 3, ("rad", "rad")),
        ),
        ((("mass",), ("density",)),),
        kinds=(POINT, *SOLIDS, STL),
    ),
    BlockWord(
        OUTPUT,
        "quantity that results have besides: `OUTPUT name = formula`, or a relative motion",
        (
            FROM,
            TO,
            Key("body", "number of the body that turns", WHOLE),
            Key("axes", "number of the body whose axes are used, which see the motion; 0: ground", WHOLE, 0),
        ),
        kinds=tuple(kind for kind in OUTPUTS if kind != FORMULA),
    ),
    BlockWord(
        UNITS,
        f"consistent system of all numbers of the deck, {', '.join(SYSTEMS)}: labels of results have it",
        (),
    ),
    BlockWord(
        "START",
        "coordinate at the start, its rate, or both; `START equilibrium`: the motion begins at rest in the "
        "equilibrium under its loads",
        (
            AT._replace(needed=True),
            Key("value", "coordinate at the start", units=("m", "rad")),
            Key("rate", "its rate at the start", units=("m/s", "rad/s")),
        ),
        unnamed=True,
    ),
)  # fmt: skip
BY_WORD = {word.word: word for word in WORDS}


def usage(word: BlockWord) -> str:
    """Return how a line of a word is written."""
    if word.word == OUTPUT:
        keys = "from=1(x,y,z) to=2(x,y,z) | body=2"
        return f"OUTPUT name = formula, or OUTPUT name {'|'.join(word.kinds)} ({keys}) [axes=…]"
    if word.word == "COUPLING":
        return "COUPLING name 2.angle=factor 3.stroke=factor …, or from=1.angle to=2.stroke function=name"
    if word.word == "START":
        return "START at=2.angle value=… rate=…, or START equilibrium"
    if word.word == UNITS:
        return f"UNITS {'|'.join(SYSTEMS)}"
    parts = [word.word, "name" if not word.unnamed else "", "|".join(word.kinds)]
    if word.word == "SIGNAL":
        return "SIGNAL name sum 0.8 -1*2.angle, or SIGNAL name pid of=error kp=3 ki=10, and so on"
    shape = {COORDINATE: "2.angle", END: "1(x,y,z)", VECTOR: "(x,y,z)", FUNCTION: "function"}
    texts = {key.name: f"{key.name}={shape.get(key.kind, '…')}" for key in word.keys}
    ways = [" | ".join(" ".join(texts[k] for k in group) for group in groups) for groups in word.choices]
    parts += [f"({way})" for way in ways]
    chosen = {name for groups in word.choices for group in groups for name in group}
    for key in word.keys:
        if key.name not in chosen:
            parts.append(texts[key.name] if key.needed else f"[{texts[key.name]}]")
    return " ".join(part for part in parts if part)
