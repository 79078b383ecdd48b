"""Cards of functions of time and of elements at joints and between nodes of a VSDF deck."""

from typing import Any

from ....model.laws import COORDINATE_LAWS, Law
from ..card import Card, Column, vector_columns, whole_column

FUNCTION_KINDS = {
    "TABL": "table",
    "SPLI": "spline",
    "POLY": "polynomial",
    "SINE": "sine",
    "RAMP": "ramp",
    "STEP": "step",
    "SUM": "sum",
    "PROD": "product",
}
OF_TABLES = ("TABL", "SPLI")

_JOINT = whole_column("joint", "number of the joint", None)
_FUNCTION = whole_column("function", "function of time that it follows", None)
_COORDINATE = whole_column("coordinate", "1: its angle, 2: its stroke", None)
_ENDS = (
    whole_column("a", "body a, 0: ground"),
    whole_column("na", "node on a", None),
    whole_column("b", "body b, 0: ground"),
    whole_column("nb", "node on b", None),
)


def _real(key: str, meaning: str, unit: str = "", default: float | None = 0.0) -> Column:
    return Column(key, meaning, unit, default=default)


def _characteristics(force: Any, stretch: Any) -> tuple[Any, Any]:
    return (
        whole_column("curve", f"function of {stretch} that adds to the {force}, 0: none"),
        whole_column("damper", f"function of the rate that adds to the {force}, 0: none"),
    )


def _spring(word: str, section: str, coordinate: str, force: str, unit: str) -> Card:
    columns = (
        _JOINT,
        _real("stiffness", f"{force} per {coordinate}", f"{force}/{unit}"),
        _real("rest", f"{coordinate} without {force}", unit),
        _real("damping", f"{force} per rate", f"{force} s/{unit}"),
        _real("preload", f"{force} at rest, against a positive {coordinate}", force),
        *_characteristics(force, f"{coordinate} - rest"),
    )
    return Card(word, section, f"{section} {{}}", "list", columns)


def _law(law: Law, letter: str) -> Card:
    words = (
        {"coordinate": "angle", "effort": "N m"} if letter == "T" else {"coordinate": "stroke", "effort": "N"}
    )
    columns = (
        _real(p.name, p.meaning.format_map(words), p.unit(letter == "T"), p.default) for p in law.parameters
    )
    section = f"{letter}{law.word}".lower()
    return Card(section.upper()[:4], section, f"{section} {{}}", "list", (_JOINT, *columns))


ELEMENT_CARDS = (
    Card(
        "FUNC",
        "function",
        "function {}",
        "list",
        (
            whole_column("number", "number of the function, none of a table's", None),
            Column("kind", "what it is", letter="A", skip=1, words=tuple(FUNCTION_KINDS), default=None),
        ),
        _real("c", "number that defines it", "SI", None),
    ),
    Card(
        "SUPP",
        "support",
        "support {}",
        "list",
        (
            whole_column("pin", "number of the pin, counted through the deck", None),
            *(
                whole_column(f"function.{axis}", f"function of time added to {axis}, 0: none")
                for axis in "xyz"
            ),
        ),
    ),
    Card("TMOT", "tmotor", "tmotor {}", "list", (_JOINT, _FUNCTION)),
    Card("AMOT", "amotor", "amotor {}", "list", (_JOINT, _FUNCTION)),
    _spring("TSPR", "tspring", "angle", "N m", "rad"),
    _spring("ASPR", "aspring", "stroke", "N", "m"),
    *(_law(law, letter) for law in COORDINATE_LAWS for letter in "TA"),
    Card(
        "LSPR",
        "lspring",
        "lspring {}",
        "list",
        (
            *_ENDS,
            _real("stiffness", "stiffness", "N/m"),
            _real("rest", "length without force", "m"),
            _real("damping", "force per rate of length", "N s/m"),
            _real("preload", "pull at the length rest", "N"),
            *_characteristics("pull", "length - rest"),
        ),
    ),
    Card(
        "CABL",
        "cable",
        "cable {}",
        "list",
        (
            *_ENDS,
            _real("stiffness", "pull per stretch", "N/m", None),
            _real("rest", "length up to which it is slack", "m"),
            _real("damping", "share of the pull that a rate of 1 m/s adds", "s/m"),
        ),
    ),
    Card(
        "BUSH",
        "bushing",
        "bushing {}",
        "list",
        (
            *_ENDS,
            *vector_columns("k", "stiffness, axes of body a", "N/m"),
            *vector_columns("kr", "stiffness against turns, axes of body a", "N m/rad"),
            *vector_columns("c", "damping, axes of body a", "N s/m"),
            *vector_columns("cr", "damping of turns, axes of body a", "N m s/rad"),
        ),
    ),
    Card(
        "COUP",
        "coupling_term",
        "term {} of the couplings",
        "list",
        (
            whole_column("coupling", "number of the coupling", None),
            _JOINT,
            _COORDINATE,
            _real("factor", "factor of this coordinate in the sum that stays 0", "", None),
        ),
    ),
    Card(
        "FRIC",
        "friction",
        "friction {}",
        "list",
        (
            _JOINT,
            _real("dynamic", "coefficient of sliding friction", "", None),
            _real("static", "coefficient of static friction", "", None),
            _real("stribeck", "speed in which one fades into the other", "m/s", None),
            _real("creep", "speed in which friction rises from 0", "m/s", None),
            _real("radius", "radius of the bearing", "m"),
            _real("preload", "force between the parts besides the reaction", "N"),
        ),
    ),
    Card(
        "RATE",
        "rate",
        "rate {}",
        "list",
        (_JOINT, _COORDINATE, _real("rate", "rate at the start", "rad/s or m/s", None)),
    ),
    Card(
        "OUTJ",
        "joint_output",
        "joint output {}",
        "list",
        (whole_column("on", "1: results hold joint coordinates and what springs do", None),),
    ),
)
