"""Decks of flexible bodies that describe no model, and what is said of them."""

import pytest

from tests.dialects.vsdf.vsdf_decks import reported, supplied

FLEXIBLE_MODELS = [
    (
        "no node table",
        supplied("pendulum", ("pendulum_nodes.txt", "pendulum_knots.txt")),
        lambda deck: [f"5:12: error: body 1: pendulum_knots.txt: no such file in {deck}"],
    ),
    (
        "no mass matrix",
        supplied("pendulum", ("FEMM\n    1 MM   fe/pendulum_M.mtx\n", "")),
        lambda deck: ["3:5: error: body 1: a FLEX body needs a card FEMM"],
    ),
    (
        "reference node",
        supplied("pendulum", ("    1   13    9", "    1   99    9")),
        lambda deck: ["3:24: error: body 1: reference node n2 is 99, which body 1 does not have"],
    ),
    (
        "a reference node missing",
        supplied("pendulum", ("    1   13    9", "    1   13    0")),
        lambda deck: ["3:30: error: body 1: reference node n3 is missing; give three, or none for mean axes"],
    ),
    (
        "reference nodes alike",
        supplied("pendulum", ("    1   13    9", "    1   13   13")),
        lambda deck: ["3:20: error: body 1: the three reference nodes must differ"],
    ),
    (
        "negative modes",
        supplied("pendulum", ("FLEX    9", "FLEX   -9")),
        lambda deck: ["3:14: error: body 1: a number of modes is 0 or more; read -9"],
    ),
    (
        "clamped node",
        supplied("pendulum", ("JOIN\n", "CLMP\n    1    1   77\nJOIN\n")),
        lambda deck: ["11:14: error: clamped nodes 1: body 1 has no node 77"],
    ),
    (
        "a set with the number of a node",
        supplied("pendulum", ("JOIN\n", "NSET\n    1   54    1    2\nJOIN\n")),
        lambda deck: ["11:9: error: node set 1: 54 is a node of body 1; a set needs a number of its own"],
    ),
    (
        "negative damping",
        supplied("pendulum", ("JOIN\n", "DAMP\n    1      -0.1\nJOIN\n")),
        lambda deck: ["11:12: error: damping of body 1: alpha = -0.1: negative damping feeds energy in"],
    ),
    (
        "stiffening without matrices",
        supplied("pendulum", ("JOIN\n", "GEOS\n    1    1\nJOIN\n")),
        lambda deck: [
            "11:10: error: stiffening of body 1: centrifugal stiffening needs geometric stiffness matrices, "
            "cards FEMG, or E and nu of the elements in the node table's file, on GEOS or on MATL"
        ],
    ),
    (
        "unit load",
        supplied("spinup", ("    1    8 MM", "    1   13 MM")),
        lambda deck: [
            "17:9: error: geometric stiffness 2: unit load 13: only 4 to 12 (xx xy xz yx yy yz zx zy "
            "zz) are used"
        ],
    ),
    (
        "stiffening not switched on",
        supplied("spinup", ("GEOS\n    1    1\n", "")),
        lambda deck: [
            "14:17: warning: body 1: FEMG is not used: GEOS does not switch stiffening on for body 1"
        ],
    ),
    (
        "torque on a flexible body",
        supplied("pendulum", ("JOIN\n", "TORQ\n    1       1.0\nJOIN\n")),
        lambda deck: [
            "11:5: error: torque 1: body 1 is FLEX: name a node with rotations, or give a pair of forces"
        ],
    ),
    (
        "mass of a flexible body",
        supplied("pendulum", ("JOIN\n", "RIGI\n    1       1.0\n 1.0,1.0,1.0\nJOIN\n")),
        lambda deck: ["11:5: error: mass of body 1: RIGI is for RIGD bodies; body 1 is FLEX"],
    ),
    (
        "output node",
        supplied("pendulum", ("    1   51\n", "    1   51   99\n")),
        lambda deck: ["19:14: error: output nodes 1: body 1 has no node 99"],
    ),
]


@pytest.mark.parametrize(
    "text, wanted", [case[1:] for case in FLEXIBLE_MODELS], ids=[case[0] for case in FLEXIBLE_MODELS]
)
def test_decks_of_flexible_bodies_that_describe_no_model(text, wanted):
    from tests.dialects.vsdf.vsdf_decks import DECKS

    assert reported(text) == wanted(DECKS / "fe")
