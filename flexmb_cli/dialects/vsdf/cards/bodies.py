"""Cards of bodies: their type, matrices, nodes, masses, and where they are and move at the start."""

from ....fe.formats.formats import MAPPING_FORMATS
from ....fe.formats.node_table import READERS
from ..card import (
    BODY,
    MATRIX_FORMS,
    Card,
    Column,
    card,
    file_card,
    node_list_card,
    vector_columns,
    whole_column,
    word_column,
)

NODE_FORMS = tuple(READERS)
MAPPING_FORMS = tuple(MAPPING_FORMATS)
# What a card FEMX names, and the section of the file that holds it.
MATRIX_SECTIONS = {"M": "mass_matrix", "K": "stiffness_matrix", "KG": "unit_load", "B": "damping_matrix"}


def _interface_card(word: str, section: str, subject: str, member: str) -> Card:
    """A card of a node that is coupled to others; 0 in their place: as in the file of FEMN."""
    node = whole_column("interface", "number of the node", None)
    more = whole_column("node", f"{member}, 0: as in the file", None)
    return card(f"{word} {section} list", subject, BODY, node, more=more, bodies="FLEX")


BODY_CARDS = (
    card(
        "BODY body own",
        "body {}",
        whole_column("number", "number of the body", None),
        word_column("kind", "FLEX or RIGD", ("FLEX", "RIGD")),
        whole_column("modes", "number of modes, 0: all"),
        *(whole_column(f"n{i}", f"reference node {i}") for i in (1, 2, 3)),
    ),
    file_card("FEMN", "node_table", "node table", NODE_FORMS),
    file_card("FEMM", "mass_matrix", "mass matrix", MATRIX_FORMS),
    file_card("FEMK", "stiffness_matrix", "stiffness matrix", MATRIX_FORMS),
    file_card("FEMD", "damping_matrix", "damping matrix", MATRIX_FORMS),
    card(
        "NODM nodal_mass list",
        "nodal mass {}",
        BODY,
        whole_column("node", "node of the table to whose mass it is added", None),
        Column("mass", "mass of a point", "kg", default=None),
        bodies="FLEX",
    ),
    card(
        "SCAL stiffness_factor body",
        "stiffness of body {}",
        BODY,
        Column("factor", "number by which the stiffness and Young's modulus are multiplied", default=None),
        bodies="FLEX",
    ),
    file_card("FEMP", "mapping", "equation mapping", MAPPING_FORMS),
    card(
        "FEMX matrix_name list",
        "matrix name {}",
        BODY,
        word_column("which", "M: of FEMM, K: of FEMK, KG: of FEMG, B: of FEMD", tuple(MATRIX_SECTIONS)),
        Column("name", "name of the matrix that is meant in its file", letter="T", skip=1, default=None),
        bodies="FLEX",
    ),
    card(
        "RIGI rigid body",
        "mass of body {}",
        BODY,
        Column("mass", "mass", "kg", default=None),
        *vector_columns("c", "centre of mass, body axes", "m"),
        second=tuple(
            Column(f"J{ij}", f"inertia about the centre of mass, {ij}", "kg m^2", default=0.0)
            for ij in ("xx", "yy", "zz", "xy", "yz", "zx")
        ),
        bodies="RIGD",
    ),
    card(
        "NODE node list",
        "node {}",
        whole_column("body", "rigid body, 0: ground"),
        whole_column("node", "number of the node", None),
        *vector_columns("r", "position, axes of the rigid body, of the ground global", "m"),
        bodies="RIGD",
    ),
    card(
        "NSET node_set list",
        "node set {}",
        BODY,
        whole_column("set", "number of the set", None),
        more=whole_column("node", "node of the set", None),
    ),
    card(
        "ARMN arm_node list",
        "arm {}",
        BODY,
        whole_column("node", "number of the node at the arm's end, of no other node", None),
        whole_column("on", "node with rotations that carries and turns it", None),
        *vector_columns("r", "place from the node that carries it, axes of the node table", "m"),
        bodies="FLEX",
    ),
    card(
        "DAMF damping_table list",
        "damping ratio {}",
        BODY,
        Column("f", "frequency; ratios between two are on a straight line, beyond them constant", "Hz"),
        Column("ratio", "damping ratio of modes of that frequency", default=None),
        bodies="FLEX",
    ),
    _interface_card("RBE2", "rigid_interface", "rigid interface node {}", "node carried"),
    _interface_card("RBE3", "mean_interface", "mean interface node {}", "node of the mean"),
    node_list_card("CLMP", "clamped", "clamped nodes"),
    node_list_card("ATTM", "attachment", "attachment nodes"),
    node_list_card("CRBN", "interface", "interface nodes"),
    card(
        "DAMP damping body",
        "damping of body {}",
        BODY,
        Column("alpha", "mass-proportional damping", "1/s", default=0.0),
        Column("beta", "stiffness-proportional damping", "s", default=0.0),
        Column("ratio", "damping ratio of every mode", default=0.0),
        bodies="FLEX",
    ),
    card(
        "POSI position body",
        "position of body {}",
        BODY,
        *vector_columns("r", "origin of the node table or rigid body, global", "m"),
    ),
    card(
        "EULP attitude body",
        "attitude of body {}",
        BODY,
        *(
            Column(f"e{k}", f"Euler parameter e{k} of the axes of the node table or rigid body", default=0.0)
            for k in range(4)
        ),
    ),
    card(
        "VELO velocity body",
        "velocity of body {}",
        BODY,
        *vector_columns("v", "velocity of the body frame's origin (FLEX: n1), global axes", "m/s"),
        *vector_columns("w", "angular velocity, axes of the body frame (FLEX: e1 from n1 to n2)", "rad/s"),
    ),
)
