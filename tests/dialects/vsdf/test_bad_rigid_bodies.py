"""Decks of rigid bodies that describe no model, and what is said of them."""

import pytest

from tests.dialects.vsdf.vsdf_decks import changed, reported

RIGID_MODELS = [
    (
        "body number",
        changed(("    2       1.0      0.25", "    3       1.0      0.25")),
        [
            "4:5: error: body 2: a RIGD body needs a card RIGI with its mass and inertia, "
            "or a line MASS of a block",
            "8:5: error: mass of body 3: body number 3 is outside 1..2",
        ],
    ),
    (
        "mass",
        changed(("       2.0       0.5", "      -2.0       0.5")),
        ["6:12: error: mass of body 1: the mass must be above zero; read -2.0"],
    ),
    (
        "triangle of the moments",
        changed(("       0.1       0.2       0.2", "       0.1       0.2       0.9")),
        [
            "7:8: error: mass of body 1: no body has the principal moments 0.1, 0.2, 0.9 kg m^2: the "
            "largest must "
            "not exceed the sum of the others (the moments are about the centre of mass)"
        ],
    ),
    (
        "a moment missing of a body that is no rod",
        changed(("       0.1       0.2       0.2", "                 0.2       0.3")),
        [
            "7:1: error: mass of body 1: no body has the principal moments 0, 0.2, 0.3 kg m^2: the largest "
            "must not exceed the sum of the others (the moments are about the centre of mass)"
        ],
    ),
    (
        "a negative moment",
        changed(("       0.1       0.2       0.2", "      -0.1       0.2       0.2")),
        [
            "7:7: error: mass of body 1: no principal moment of inertia may be negative; the "
            "least is -0.1 kg m^2"
        ],
    ),
    (
        "Euler parameters",
        changed(("NODE\n", "EULP\n    2\nNODE\n")),
        [
            "13:6: error: attitude of body 2: the Euler parameters are all zero; write 1 0 0 0 for a "
            "body that is "
            "not turned"
        ],
    ),
    (
        "length of the Euler parameters",
        changed(("NODE\n", "EULP\n    2       1.1\nNODE\n")),
        [
            "13:13: warning: attitude of body 2: the Euler parameters have length 1.1 and are scaled "
            "to length 1"
        ],
    ),
    (
        "node twice",
        changed(("    1    4       1.0", "    1    3       1.0")),
        ["18:10: error: node 6: body 1 already has a node 3", "24:25: error: joint 2: body 1 has no node 4"],
    ),
    (
        "no such node",
        changed(("    2 REVO    1    3    4", "    2 REVO    1    3    9")),
        ["24:25: error: joint 2: body 1 has no node 9"],
    ),
    (
        "no such body",
        changed(("    2 REVO    1", "    2 REVO    7")),
        ["24:15: error: joint 2: body number 7 is outside 0..2"],
    ),
    (
        "one body with itself",
        changed(("    2 REVO    1    3    4    2", "    2 REVO    1    3    4    1")),
        ["24:30: error: joint 2: a and b are both body 1; two bodies are needed"],
    ),
    (
        "node missing on the axis",
        changed(("    2 REVO    1    3    4", "    2 REVO    1    3    0")),
        ["24:25: error: joint 2: REVO needs 2 nodes on a; a2 is missing"],
    ),
    (
        "axis without length",
        changed(("    2 REVO    1    3    4", "    2 REVO    1    3    3")),
        [
            "24:25: error: joint 2: nodes a1 and a2 are the same point, so the axis between them has "
            "no direction"
        ],
    ),
    (
        "node on the axis",
        changed(
            (
                "    2 REVO    1    3    4    2    1    2\n",
                "    2 TRAN    1    3    4    2    1    2    4    3\n",
            )
        ),
        ["24:45: error: joint 2: node a3 lies on the axis through nodes a1 and a2; it must lie across it"],
    ),
    (
        "ground without nodes",
        changed(("    1 REVO    0    1    2    1    1    2", "    1 DIST    0    0    0    1    1")),
        ["23:20: error: joint 1: DIST needs nodes on the ground, cards NODE of body 0; a1 is missing"],
    ),
    (
        "no distance",
        changed(("    1 REVO    0    1    2    1    1    2", "    1 DIST    0    1    0    1    1")),
        ["23:51: error: joint 1: the distance must be above zero; for coinciding points take SPHE"],
    ),
    (
        "mask",
        changed(("GRAV\n", "PINN\n    2    3  121\nGRAV\n")),
        ["26:13: error: pin 1: mask 121 must be three digits 0 or 1 for x y z, such as 111 or 101"],
    ),
    (
        "law",
        changed(("GRAV\n", "MOTN\n    1 ANGL    1    7\nGRAV\n")),
        [
            "26:20: error: motion 1: law 7 is outside 1..6 (1 polynomial, 2 spin-up, 3 sine, 4 table, "
            "5 function, 6 rate by function)"
        ],
    ),
    (
        "no stroke",
        changed(("GRAV\n", "MOTN\n    1 STRK    1    1\nGRAV\n")),
        [
            "26:15: error: motion 1: joint 1 is revolute and has no stroke; translational, "
            "cylindrical, screw "
            "joints have one"
        ],
    ),
    (
        "no table",
        changed(("GRAV\n", "MOTN\n    1 ANGL    1    4       2.0\nGRAV\n")),
        ["26:28: error: motion 1: there is no table 2; cards TABL give some"],
    ),
    (
        "times of a table",
        changed(("GRAV\n", "TABL\n    1       0.0       1.0\n    1       0.0       2.0\nGRAV\n")),
        ["27:13: error: table 1: times must ascend; 0 s follows 0 s"],
    ),
    (
        "short table",
        changed(("GRAV\n", "TABL\n    1       0.0       1.0\nGRAV\n")),
        ["26:5: error: table 1: a table needs two points at least"],
    ),
    (
        "spin-up time",
        changed(("GRAV\n", "MOTN\n    1 ANGL    1    2       6.0\nGRAV\n")),
        ["26:31: error: motion 1: the spin-up time c1 must be above zero"],
    ),
    (
        "flag of a force",
        changed(("GRAV\n", "FORC\n    2    3       1.0       0.0       0.0    7\nGRAV\n")),
        ["26:45: error: force 1: the last flag is 0 (global axes) or 1 (body axes); read 7"],
    ),
    (
        "negative stiffness",
        changed(("GRAV\n", "SPRI\n    1    0    1    2    3     -10.0\nGRAV\n")),
        ["26:31: error: spring 1: k must not be negative; read -10.0"],
    ),
    (
        "spring between one node",
        changed(("GRAV\n", "SPRI\n    1    2    3    2    3      10.0\nGRAV\n")),
        ["26:25: error: spring 1: both ends are the same node"],
    ),
    (
        "spring of a joint that does not turn",
        changed(
            ("    1 REVO    0    1    2    1    1    2\n", "    1 SPHE    0    1         1    1\n"),
            ("GRAV\n", "JSPR\n    1       5.0\nGRAV\n"),
        ),
        ["26:5: error: joint spring 1: joint 1 is spherical and has neither angle nor stroke"],
    ),
    (
        "time",
        changed(("       1.0      0.01\n", "       1.0       0.0\n")),
        ["28:18: error: TIME: the time between rows must be above zero; read 0.0"],
    ),
    (
        "too many rows",
        changed(("       1.0      0.01\n", "       1.0      1E-9\n")),
        ["28:17: error: TIME: 1e+09 rows are more than 10000000; take a larger time between rows"],
    ),
    ("no time", changed(("TIME\n       1.0      0.01\n", "")), ["error: card 'TIME' is missing"]),
    (
        "spectral radius",
        changed(("OUTN\n", "INTG\n GALF       1.5\nOUTN\n")),
        ["30:13: error: INTG: the spectral radius lies between 0 and 1; read 1.5"],
    ),
    (
        "tolerance of a method with a radius",
        changed(("OUTN\n", "INTG\n GALF,0.9,,2\nOUTN\n")),
        ["30:12: error: INTG: the tolerance lies between 0 and 1; read 2"],
    ),
    (
        "tolerance twice",
        changed(("OUTN\n", "INTG\n RAD5,1e-8,,1e-6\nOUTN\n")),
        ["30:13: error: INTG: RAD5 has its tolerance in the second field; leave this one empty"],
    ),
    (
        "card of the other kind",
        changed(("GRAV\n", "DAMP\n    1       0.1\nGRAV\n")),
        ["26:5: error: damping of body 1: DAMP is for FLEX bodies; body 1 is RIGD"],
    ),
]


@pytest.mark.parametrize(
    "text, wanted", [case[1:] for case in RIGID_MODELS], ids=[case[0] for case in RIGID_MODELS]
)
def test_decks_of_rigid_bodies_that_describe_no_model(text, wanted):
    assert reported(text) == wanted


def test_a_deck_without_joints_has_no_number_to_offer():
    text = (
        "VSDF NO JOINTS\nBODY\n    1 RIGD\nRIGI\n1,2.0,0.1,0.2,0.0\n0.1,0.2,0.2\nMOTN\n 1,ANGL,1,1,0,1,0,0\n"
        "JSPR\n"
        " 1,1.0\n"
        "ELEMENTS\n"
        "  SPRING tspr-1 at=1.angle stiffness=5\n"
        "TIME\n"
        "       0.2      0.05\n"
        "END\n"
        "STAR\n"
        "STOP\n"
    )
    rest = "joint number 1 is not there: the deck has no joint; add one, or remove this card"
    places = "8:9: error: motion 1", "10:2: error: joint spring 1", "12:20: error: tspr-1"
    assert [line for line in reported(text) if ": error: " in line] == [f"{one}: {rest}" for one in places]
