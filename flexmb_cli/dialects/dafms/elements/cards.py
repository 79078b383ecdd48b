"""Cards of functions of time and of elements at hinges and between bodies of FMBD.DAT."""

from typing import Any

from ....deck.fortran_records import Item
from ....model.laws import COORDINATE_LAWS, Law
from ..card import Card

# By the code of the card FUNC.
FUNCTION_KINDS = {
    1: "table",
    2: "spline",
    3: "polynomial",
    4: "sine",
    5: "ramp",
    6: "step",
    7: "sum",
    8: "product",
}

HINGE_ITEMS = (
    Item("K", "body whose hinge is meant"),
    Item("A", "freedom of the hinge: 1-3 rotation, 4-6 translation"),
)
_ENDS = (
    Item("KA", "first body, 0: inertial frame"),
    Item("NA", "its node, 0: the vector a"),
    Item("KB", "second body, 0: inertial frame"),
    Item("NB", "its node, 0: the vector b"),
)
_POINTS = tuple(
    Item(f"{letter}{axis}", f"point of the {which} body, axis {axis}", "m")
    for letter, which in (("a", "first"), ("b", "second"))
    for axis in (1, 2, 3)
)
_CHARACTERISTICS = (
    Item("curve", "function of the stretch that adds to the force, 0: none"),
    Item("damper", "function of the rate that adds to the force, 0: none"),
)
_FORCE = "N m or N"


def _card(word: str, section: str, form: str, items: Any, tail: str = "", head: int = 0) -> Card:
    return Card(word, section, "entries", form, tuple(items), tail, head=head)


def _law(law: Law) -> Card:
    words = {"coordinate": "coordinate", "effort": "torque or force"}
    items = (
        Item(p.name, p.meaning.format_map(words), f"{p.unit(True)} or {p.unit(False)}")
        for p in law.parameters
    )
    form = f"2I5,{len(law.parameters)}F10.5"
    return _card(f"H{law.word}"[:4], f"hinge_{law.word.lower()}", form, (*HINGE_ITEMS, *items))


ELEMENT_CARDS = (
    _card(
        "FUNC",
        "function",
        "3I5",
        (
            Item("number", "number of the function"),
            Item("kind", "1 table 2 spline 3 polynomial 4 sine 5 ramp 6 step 7 sum 8 product"),
            Item("NP", "how many numbers define it"),
        ),
        "4E20.10",
    ),
    _card(
        "MOTF", "function_motor", "3I5", (*HINGE_ITEMS, Item("function", "function of its torque or force"))
    ),
    _card(
        "PREF",
        "function_drive",
        "4I5",
        (
            *HINGE_ITEMS,
            Item("function", "function that the coordinate follows"),
            Item("rate", "0: the function is the coordinate, 1: its rate"),
        ),
    ),
    _card(
        "HSPR",
        "hinge_spring",
        "2I5,4F10.5,2I5",
        (
            *HINGE_ITEMS,
            Item("stiffness", "stiffness", "N m/rad or N/m"),
            Item("rest", "coordinate at rest", "rad or m"),
            Item("damping", "torque or force per rate", "N m s/rad or N s/m"),
            Item("preload", "torque or force at rest, against a positive coordinate", _FORCE),
            *_CHARACTERISTICS,
        ),
    ),
    *map(_law, COORDINATE_LAWS),
    _card(
        "LSPR",
        "lspring",
        "6I5",
        (
            *_ENDS,
            *_CHARACTERISTICS,
            *_POINTS,
            Item("stiffness", "stiffness", "N/m"),
            Item("rest", "length without force", "m"),
            Item("damping", "force per rate of length", "N s/m"),
            Item("preload", "pull at the length rest", "N"),
        ),
        "6F10.5",
        head=6,
    ),
    _card(
        "CABL",
        "cable",
        "4I5",
        (
            *_ENDS,
            *_POINTS,
            Item("stiffness", "pull per stretch", "N/m"),
            Item("rest", "length up to which it is slack", "m"),
            Item("damping", "share of the pull that a rate of 1 m/s adds", "s/m"),
        ),
        "6F10.5",
        head=4,
    ),
    _card(
        "BUSH",
        "bushing",
        "4I5",
        (
            *_ENDS,
            *_POINTS,
            *(
                Item(f"{key}.{axis}", f"{what}, axis {axis} of the first body", unit)
                for key, what, unit in (
                    ("k", "stiffness", "N/m"),
                    ("kr", "stiffness against turns", "N m/rad"),
                    ("c", "damping", "N s/m"),
                    ("cr", "damping of turns", "N m s/rad"),
                )
                for axis in "xyz"
            ),
        ),
        "6F10.5",
        head=4,
    ),
    _card(
        "COUP",
        "coupling_term",
        "3I5,F10.5",
        (
            Item("coupling", "number of the coupling"),
            *HINGE_ITEMS,
            Item("factor", "factor of this coordinate in the sum that keeps its first value"),
        ),
    ),
    _card(
        "FRIC",
        "friction",
        "I5,6F10.5",
        (
            Item("K", "body whose hinge is meant"),
            Item("dynamic", "coefficient of sliding friction"),
            Item("static", "coefficient of static friction"),
            Item("stribeck", "speed in which one fades into the other", "m/s"),
            Item("creep", "speed in which friction rises from 0", "m/s"),
            Item("radius", "radius of the bearing", "m"),
            Item("preload", "force between the parts besides the reaction", "N"),
        ),
    ),
)
