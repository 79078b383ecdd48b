"""The cards of FMBD.DAT: one table of words, FORMATs and lists, historic and extended.

Source of the historic cards: DAFMS thesis (Zhao, 1992), appendix C, subroutines QCONTR, DFIN, TSYSIN.
The extension cards are unknown to the 1992 program, which skips them one line at a time; no data
record of theirs can begin with a card's word, because all begin with a number.

`A` numbers the degrees of freedom of a hinge: 1-3 rotation about, 4-6 translation along axis 1-3 of P_k.
The whole format is described for users in decks/dafms/FORMAT.md.
"""

from dataclasses import dataclass
from functools import cache

from ...deck.fortran_records import Item


@dataclass(frozen=True)
class Card:
    """A card: its word (four columns), the section of its records, FORMAT and list of one record.

    `layout` is how many records follow: "bodies" N, each headed by the body's number; "list" one
    list over all bodies; "coordinates", "state" a list over the coordinates; "single" one record;
    "switch" none; "entries" a count, then so many entries.  Of those the first `head` items
    stand in `format`, the others in `tail`; without a head all do, and `tail` is that of a list.
    """

    word: str
    section: str
    layout: str
    format: str = ""
    items: tuple[Item, ...] = ()
    tail: str = ""
    head: int = 0


def _card(head: str, *items: Item, tail: str = "", first: int = 0) -> Card:
    """Return a card; `head`: its word in four columns, section, layout, and the FORMAT if it has one."""
    section, layout, *form = head[4:].split()
    return Card(head[:4], section, layout, "".join(form), items, tail, first)


MACROS = ("DFMB", "STAR", "STOP")
END, PRINT_ON, PRINT_OFF = "END ", "PRIN", "NOPR"
SWITCHES = (END, PRINT_ON, PRINT_OFF)


def _axes(
    letter: str, meaning: str, unit: str = "", axes: tuple[int, int, int] = (1, 2, 3)
) -> tuple[Item, ...]:
    return tuple(Item(f"{letter}{axis}", f"{meaning}, axis {axis}", unit) for axis in axes)


def _euler(meaning: str) -> tuple[Item, ...]:
    return tuple(Item(f"e{i}", f"Euler parameter e{i} of {meaning}") for i in (1, 2, 3, 4))


_CLOSURE = (
    Item("KA", "first body of the closure"),
    Item("NA", "its node, 0: the vector a"),
    Item("KB", "second body of the closure, 0: inertial frame"),
    Item("NB", "its node, 0: the vector b"),
    *_axes("C", "1: closed in this direction"),
    *_axes("a", "point of the first body", "m"),
    *_axes("b", "point of the second body", "m"),
)

_SHAPE = (
    Item("K", "rigid body that the shape is of, 0: inertial frame"),
    Item("IS", "shape: 1 box, 2 cylinder, 3 tube, 4 cone, 5 sphere"),
    Item("SA", "length along axis 1; of all but a box the radius", "m"),
    Item("SB", "length along axis 2; of all but a box the length along axis 3", "m"),
    Item("SC", "length along axis 3; inner radius of a tube, upper one of a cone", "m"),
    *_axes("SO", "middle of the shape from O_k", "m"),
    *_axes("SW", "angle by which it is turned, in turn", "rad"),
)

HINGE_ITEMS = (
    Item("K", "body whose hinge is meant"),
    Item("A", "freedom of the hinge: 1-3 rotation, 4-6 translation"),
)

HISTORIC = (
    _card("CONN parent list 10I5", Item("L", "number of the body's parent, 0: inertial frame")),
    _card("MASS mass bodies I5,F10.5", Item("BM", "mass of the body", "kg")),
    _card("INER inertia bodies I5,3F10.5", *_axes("BII", "moment of inertia about O_k", "kg m^2")),
    _card("XI   offset bodies I5,3F10.5", *_axes("XI", "P_k to O_k, echoed only", "m")),
    _card("Q(k) hinge_point bodies I5,3F10.5", *_axes("PH", "hinge point in the parent", "m")),
    _card("NOFP hinge_node bodies I5,I5", Item("NP", "node of the parent at the hinge")),
    _card("EULT attitude bodies I5,4F10.5", *_euler("O_k against P_k")),
    _card("EULL hinge_attitude bodies I5,4F10.5", *_euler("P_k in the parent")),
    _card("X(L) first_coordinate coordinates 5F10.5"),
    _card("Y(L) state state 5F10.5"),
    _card("FORC force bodies I5,3F10.5", *_axes("HF", "force at O_k, inertial", "N")),
    _card("TOQU torque bodies I5,3F10.5", *_axes("HM", "external torque, inertial", "N m")),
    _card("RC(K mass_centre bodies I5,3F10.5", *_axes("RC", "O_k to mass centre", "m")),
    _card(
        "DESN pulse bodies 2I5,4F10.5",
        Item("IDS", "law of the designed torque: 0 none, 1 pulse"),
        Item("F1", "height of the pulse", "N m"),
        Item("TIME", "length of the pulse", "s"),
    ),
)

EXTENSIONS = (
    _card("GRAV gravity single I5,3F10.5", Item("KG", "not used"), *_axes("g", "gravity, inertial", "m/s^2")),
    _card("UNCO one_way switch"),
    _card("LOOP closure entries 7I5", *_CLOSURE, tail="6F10.5", first=7),
    _card(
        "PROD product bodies I5,3F10.5",
        *(Item(f"BII{ij}", f"element {ij} of the inertia matrix about O_k", "kg m^2") for ij in (12, 13, 23)),
    ),
    _card(
        "SPRI spring entries 2I5,2F10.5",
        *HINGE_ITEMS,
        Item("KS", "stiffness", "N m/rad or N/m"),
        Item("Q0", "coordinate at rest", "rad or m"),
    ),
    _card(
        "DAMP damper entries 2I5,F10.5", *HINGE_ITEMS, Item("CS", "damping constant", "N m s/rad or N s/m")
    ),
    _card(
        "MOTR motor entries 2I5,F10.5",
        *HINGE_ITEMS,
        Item("TAU", "torque or force, opposite on the parent", "N m or N"),
    ),
    _card(
        "PRES prescribed entries 2I5,3F10.5",
        *HINGE_ITEMS,
        Item("C", "coordinate at t = 0", "rad or m"),
        Item("B", "speed at t = 0", "rad/s or m/s"),
        Item("A2", "acceleration", "rad/s^2 or m/s^2"),
    ),
    _card(
        "TABL torque_table entries 3I5",
        Item("K", "body"),
        Item("A", "inertial axis of the torque"),
        Item("NP", "number of points of the table"),
        tail="2F10.5",
    ),
    _card(
        "TABM motor_table entries 3I5",
        *HINGE_ITEMS,
        Item("NP", "number of points of the table"),
        tail="2F10.5",
    ),
    _card(
        "ELDA elastic_damping bodies I5,2F10.5",
        Item("ALPHA", "mass-proportional", "1/s"),
        Item("BETA", "stiffness-proportional", "s"),
    ),
    _card(
        "NROT nodal_rotation entries 2I5", Item("K", "flexible body"), Item("I", "its node"), tail="6E13.5"
    ),
    _card(
        "GSTF stiffening bodies I5,I5,F10.5",
        Item("IGS", "geometric stiffening: 0 none, 1 on"),
        Item("RA", "clamped end of the beam, from O_k", "m"),
    ),
    _card(
        "TOLR tolerance single 2E13.5",
        Item("RTOL", "relative tolerance of a step"),
        Item("ATOL", "absolute tolerance of a step"),
    ),
    _card(
        "METH method single I5",
        Item("METH", "integrator: 1 explicit, 2 implicit, 3 DGEAR's family, 4 implicit and compiled"),
    ),
    _card("GEOM shape entries 2I5,3F10.5", *_SHAPE, tail="6F10.5", first=5),
)

CARDS = {card.word: card for card in (*HISTORIC, *EXTENSIONS)}
KNOWN_WORDS = (*MACROS, *SWITCHES, *CARDS)


@cache
def resembling(word: str) -> str | None:
    """The known card that `word` was probably meant to be: other case, one letter off, two swapped."""
    for known in KNOWN_WORDS:
        if word.casefold() == known.casefold() or sorted(word) == sorted(known):
            return known
    close = [known for known in KNOWN_WORDS if sum(a != b for a, b in zip(word, known, strict=True)) == 1]
    return close[0] if close else None
