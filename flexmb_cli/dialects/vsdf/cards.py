"""The cards of a VSDF deck: one table of words, columns and meanings.

Vlasenko and Kasper (2008) typed their models into Maple; this deck is flexmb's own.  The
whole format is described for users in decks/vsdf/FORMAT.md.
"""

from typing import Any

from ...solvers.constrained.integrators import METHODS
from . import DIALECT
from .card import Card, Column
from .card import vector_columns as _vector
from .card import whole_column as _whole
from .elements.cards import ELEMENT_CARDS

END, STAR, STOP = "END", "STAR", "STOP"
FINAL = (END, STAR, STOP)


def _word(key: str, meaning: str, words: tuple[str, ...], default: None = None) -> Any:
    return Column(key, meaning, letter="A", skip=1, words=words, default=default)


_BODY = _whole("body", "number of the body", None)
_NODE = _whole("node", "node or node set", None)


def _file(word: str, section: str, what: str, forms: tuple[str, ...]) -> Any:
    columns = (
        _BODY,
        _word("form", "format of the file", forms),
        Column("file", f"file of the {what}", letter="T", skip=1, default=None),
    )
    return Card(word, section, f"{what} of body {{}}", "body", columns)


def _node_list(word: str, section: str, what: str) -> Card:
    return Card(word, section, f"{what} {{}}", "list", (_BODY,), _NODE)


NODE_FORMS = ("TXT", "CDB", "INP", "BDF")
MATRIX_FORMS = ("MM", "HB", "CCX", "ABQ", "DMIG", "OP4")
MAPPING_FORMS = ("ANS", "CCX")
JOINTS = tuple(DIALECT.joints)
MOTIONS = ("TRAX", "TRAY", "TRAZ", "ROTX", "ROTY", "ROTZ", "ANGL", "STRK")
STRESS_PLACES = ("NODE", "ELEM", "MAX")
SHAPES = ("BOX", "CYLI", "TUBE", "CONE", "SPHE")

_SHAPED = _whole("body", "rigid body, 0: ground", None)
# Offset and angles of a shape.
_PLACED = (
    *_vector("offset", "middle of the shape, body axes", "m"),
    Column("alpha", "turned about x, then", "rad", default=0.0),
    Column("beta", "about y, then", "rad", default=0.0),
    Column("gamma", "about z, axes of the body", "rad", default=0.0),
)

CARDS = (
    Card(
        "BODY",
        "body",
        "body {}",
        "own",
        (
            _whole("number", "number of the body", None),
            _word("kind", "FLEX or RIGD", ("FLEX", "RIGD")),
            _whole("modes", "number of modes, 0: all"),
            *(_whole(f"n{i}", f"reference node {i}") for i in (1, 2, 3)),
        ),
    ),
    _file("FEMN", "node_table", "node table", NODE_FORMS),
    _file("FEMM", "mass_matrix", "mass matrix", MATRIX_FORMS),
    _file("FEMK", "stiffness_matrix", "stiffness matrix", MATRIX_FORMS),
    _file("FEMP", "mapping", "equation mapping", MAPPING_FORMS),
    Card(
        "RIGI",
        "rigid",
        "mass of body {}",
        "body",
        (_BODY, Column("mass", "mass", "kg", default=None), *_vector("c", "centre of mass, body axes", "m")),
        second=tuple(
            Column(f"J{ij}", f"inertia about the centre of mass, {ij}", "kg m^2", default=0.0)
            for ij in ("xx", "yy", "zz", "xy", "yz", "zx")
        ),
    ),
    Card(
        "NODE",
        "node",
        "node {}",
        "list",
        (
            _whole("body", "rigid body, 0: ground"),
            _whole("node", "number of the node", None),
            *_vector("r", "position, axes of the rigid body, of the ground global", "m"),
        ),
    ),
    Card(
        "NSET",
        "node_set",
        "node set {}",
        "list",
        (_BODY, _whole("set", "number of the set", None)),
        _whole("node", "node of the set", None),
    ),
    _node_list("CLMP", "clamped", "clamped nodes"),
    _node_list("ATTM", "attachment", "attachment nodes"),
    _node_list("CRBN", "interface", "interface nodes"),
    Card(
        "DAMP",
        "damping",
        "damping of body {}",
        "body",
        (
            _BODY,
            Column("alpha", "mass-proportional damping", "1/s", default=0.0),
            Column("beta", "stiffness-proportional damping", "s", default=0.0),
            Column("ratio", "damping ratio of every mode", default=0.0),
        ),
    ),
    Card(
        "POSI",
        "position",
        "position of body {}",
        "body",
        (_BODY, *_vector("r", "origin of the node table or rigid body, global", "m")),
    ),
    Card(
        "EULP",
        "attitude",
        "attitude of body {}",
        "body",
        (
            _BODY,
            *(
                Column(
                    f"e{k}", f"Euler parameter e{k} of the axes of the node table or rigid body", default=0.0
                )
                for k in range(4)
            ),
        ),
    ),
    Card(
        "VELO",
        "velocity",
        "velocity of body {}",
        "body",
        (
            _BODY,
            *_vector("v", "velocity of the body frame's origin (FLEX: n1), global axes", "m/s"),
            *_vector("w", "angular velocity, axes of the body frame (FLEX: e1 from n1 to n2)", "rad/s"),
        ),
    ),
    Card(
        "PINN",
        "pin",
        "pin {}",
        "list",
        (
            _BODY,
            _NODE,
            _whole("mask", "global directions held, such as 111 or 101", None),
            *_vector("p", "point held to, global; empty: where the node is", "m"),
        ),
    ),
    Card(
        "JOIN",
        "joint",
        "joint {}",
        "own",
        (
            _whole("number", "number of the joint", None),
            _word("kind", "kind of the joint", JOINTS),
            _whole("a", "body a, 0: ground"),
            _whole("a1", "joint point on a"),
            _whole("a2", "node on the axis on a"),
            _whole("b", "body b, 0: ground"),
            _whole("b1", "joint point on b"),
            _whole("b2", "node on the axis on b"),
            _whole("a3", "node across the axis on a"),
            _whole("b3", "node across the axis on b"),
            Column("size", "pitch or distance; empty: as at t = 0", "m/rad or m", default=0.0),
        ),
    ),
    Card(
        "MOTN",
        "motion",
        "motion {}",
        "own",
        (
            _whole("number", "number of the motion", None),
            _word("kind", "what is prescribed", MOTIONS),
            _whole("object", "body (TRAX to ROTZ) or joint (ANGL, STRK)", None),
            _whole("law", "1 polynomial, 2 spin-up, 3 sine, 4 table, 5 function, 6 rate by function", None),
            *(Column(f"c{k}", f"constant {k} of the law", "SI", default=0.0) for k in range(4)),
        ),
    ),
    Card(
        "TABL",
        "table",
        "point {} of the tables",
        "list",
        (
            _whole("table", "number of the table", None),
            Column("t", "time", "s", default=None),
            Column("f", "value", "SI", default=None),
        ),
    ),
    Card(
        "FORC",
        "force",
        "force {}",
        "list",
        (
            _BODY,
            _NODE,
            *_vector("F", "force", "N"),
            _whole("follows", "1: in axes of the body frame (FLEX: e1 from n1 to n2), else global"),
            _whole("table", "table or function of its factor, 0: constant"),
        ),
    ),
    Card(
        "TORQ",
        "torque",
        "torque {}",
        "list",
        (
            _BODY,
            *_vector("M", "torque", "N m"),
            _whole("follows", "1: in body axes, else global"),
            _whole("table", "table or function of its factor, 0: constant"),
        ),
    ),
    Card(
        "SPRI",
        "spring",
        "spring {}",
        "own",
        (
            _whole("number", "number of the spring", None),
            _whole("a", "body a, 0: ground"),
            _whole("na", "node on a", None),
            _whole("b", "body b, 0: ground"),
            _whole("nb", "node on b", None),
            Column("k", "stiffness", "N/m", default=0.0),
            Column("c", "damping", "N s/m", default=0.0),
            Column("length", "length at rest; empty: as at t = 0", "m", default=0.0),
        ),
    ),
    Card(
        "JSPR",
        "joint_spring",
        "joint spring {}",
        "list",
        (
            _whole("joint", "number of the joint", None),
            Column("k", "stiffness", "N m/rad or N/m", default=0.0),
            Column("c", "damping", "N m s/rad or N s/m", default=0.0),
            Column("q0", "angle or stroke at rest, from t = 0", "rad or m", default=0.0),
        ),
    ),
    Card("GRAV", "gravity", "GRAV", "single", _vector("g", "gravity, global axes", "m/s^2")),
    Card(
        "GEOS",
        "stiffening",
        "stiffening of body {}",
        "body",
        (
            _BODY,
            _whole("on", "1: centrifugal stiffening"),
            Column("E", "Young's modulus of the elements; empty: by MATL or FEMG", "Pa", default=0.0),
            Column("nu", "Poisson's ratio of the elements", default=0.0),
        ),
    ),
    Card(
        "FEMG",
        "unit_load",
        "geometric stiffness {}",
        "list",
        (
            _BODY,
            _whole("load", "unit load, 4 to 12: xx xy xz yx ... zz", None),
            _word("form", "format of the file", MATRIX_FORMS),
            Column("file", "file of the geometric stiffness", letter="T", skip=1, default=None),
        ),
    ),
    Card(
        "TIME",
        "time",
        "TIME",
        "single",
        (
            Column("end", "last time", "s", default=None),
            Column("output", "time between rows", "s", default=None),
            Column("step", "step of integration, 0: chosen by tolerance", "s", default=0.0),
        ),
    ),
    Card(
        "INTG",
        "integrator",
        "INTG",
        "single",
        (
            _word(
                "method",
                ", ".join(f"{word} {method.meaning}" for word, method in METHODS.items()),
                tuple(METHODS),
            ),
            Column("rho", "spectral radius at infinity, or tolerance", default=0.0),
            Column("stabilise", "constraint stabilisation", "1/s", default=0.0),
        ),
    ),
    Card("OUTN", "output", "output nodes {}", "list", (_BODY,), _NODE),
    Card(
        "MATL",
        "material",
        "material of body {}",
        "body",
        (
            _BODY,
            Column("E", "Young's modulus of the elements", "Pa", default=None),
            Column("nu", "Poisson's ratio of the elements", default=0.0),
            Column("rho", "density, to test the mass by; empty: no test", "kg/m^3", default=0.0),
        ),
    ),
    Card(
        "OUTS",
        "stress_output",
        "stress output {}",
        "list",
        (_BODY, _word("what", "where stresses are reported", STRESS_PLACES)),
        _whole("number", "node, node set or element; none: all"),
    ),
    Card(
        "PLAC",
        "placement",
        "placement {}",
        "list",
        (
            _BODY,
            _NODE,
            *_vector("p", "point that it lies at (first), towards (second), beside (third), global", "m"),
        ),
    ),
    Card(
        "GEOM",
        "shape",
        "shape {}",
        "list",
        (
            _SHAPED,
            _word("shape", "shape for pictures", SHAPES),
            Column("a", "length along x; of all but a box the radius", "m", default=0.0),
            Column("b", "length along y; of all but a box the length along z", "m", default=0.0),
            Column("c", "length along z; inner radius of a tube, upper one of a cone", "m", default=0.0),
            *_PLACED,
        ),
    ),
    Card(
        "GSTL",
        "shape_file",
        "shape file {}",
        "list",
        (_SHAPED, Column("unit", "metres in a unit of the file; empty: 1", "m", default=1.0), *_PLACED),
        second=(Column("file", "STL file", letter="T", skip=1, default=None),),
    ),
    *ELEMENT_CARDS,
)

BY_WORD = {card.word: card for card in CARDS}
KNOWN_WORDS = (*BY_WORD, *FINAL)
# Words that data cards begin with.
DATA_WORDS = tuple(word for card in CARDS if card.columns[0].letter == "A" for word in card.columns[0].words)
