"""Cards of what holds bodies together and moves them: pins, joints, motions, tables, loads, springs."""

from ....model.time_functions import JOINT_STROKE, JOINT_TURN, ROTATIONS, TRANSLATIONS
from .. import DIALECT
from ..card import BODY, NODE, Column, card, vector_columns, whole_column, word_column

JOINTS = tuple(DIALECT.joints)
MOTIONS = (*TRANSLATIONS, *ROTATIONS, JOINT_TURN, JOINT_STROKE)
_FACTOR = Column("table", "table or function of its factor, 0: constant", letter="I", names=True)

JOINT_AND_LOAD_CARDS = (
    card(
        "PINN pin list",
        "pin {}",
        BODY,
        NODE,
        whole_column("mask", "global directions held, such as 111 or 101", None),
        *vector_columns("p", "point held to, global; empty: where the node is", "m"),
    ),
    card(
        "JOIN joint own",
        "joint {}",
        whole_column("number", "number of the joint", None),
        word_column("kind", "kind of the joint", JOINTS),
        whole_column("a", "body a, 0: ground"),
        whole_column("a1", "joint point on a"),
        whole_column("a2", "node on the axis on a"),
        whole_column("b", "body b, 0: ground"),
        whole_column("b1", "joint point on b"),
        whole_column("b2", "node on the axis on b"),
        whole_column("a3", "node across the axis on a"),
        whole_column("b3", "node across the axis on b"),
        Column("size", "pitch or distance; empty: as at t = 0", "m/rad or m", default=0.0),
    ),
    card(
        "MOTN motion own",
        "motion {}",
        whole_column("number", "number of the motion", None),
        word_column("kind", "what is prescribed", MOTIONS),
        whole_column("object", "body (TRAX to ROTZ) or joint (ANGL, STRK)", None),
        whole_column("law", "1 polynomial, 2 spin-up, 3 sine, 4 table, 5 function, 6 rate by function", None),
        *(Column(f"c{k}", f"constant {k} of the law", "SI", default=0.0, names=k == 0) for k in range(4)),
    ),
    card(
        "TABL table list",
        "point {} of the tables",
        whole_column("table", "number of the table", None),
        Column("t", "time", "s", default=None),
        Column("f", "value", "SI", default=None),
    ),
    card(
        "FORC force list",
        "force {}",
        BODY,
        NODE,
        *vector_columns("F", "force", "N"),
        whole_column("follows", "1: in axes of the body frame (FLEX: e1 from n1 to n2), else global"),
        _FACTOR,
    ),
    card(
        "TORQ torque list",
        "torque {}",
        BODY,
        *vector_columns("M", "torque", "N m"),
        whole_column("follows", "1: in body axes, else global"),
        _FACTOR,
        whole_column("node", "FLEX: node with rotations on which it acts"),
    ),
    card(
        "SPRI spring own",
        "spring {}",
        whole_column("number", "number of the spring", None),
        whole_column("a", "body a, 0: ground"),
        whole_column("na", "node on a", None),
        whole_column("b", "body b, 0: ground"),
        whole_column("nb", "node on b", None),
        Column("k", "stiffness", "N/m", default=0.0),
        Column("c", "damping", "N s/m", default=0.0),
        Column("length", "length at rest; empty: as at t = 0", "m", default=0.0),
    ),
    card(
        "JSPR joint_spring list",
        "joint spring {}",
        whole_column("joint", "number of the joint", None),
        Column("k", "stiffness", "N m/rad or N/m", default=0.0),
        Column("c", "damping", "N m s/rad or N s/m", default=0.0),
        Column("q0", "angle or stroke at rest, from t = 0", "rad or m", default=0.0),
    ),
    card("GRAV gravity single", "GRAV", *vector_columns("g", "gravity, global axes", "m/s^2")),
)
