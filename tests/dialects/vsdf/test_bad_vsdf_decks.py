"""VSDF decks that cannot be read, or describe no model, and what is said of them."""

import pytest

from tests.dialects.vsdf.vsdf_decks import RIGID, changed, reported, supplied

READING = [
    (
        "first word",
        changed(("VSDF TWO", "VSDD TWO")),
        ["1:1: error: the first card must begin with VSDF; read 'VSDD'"],
    ),
    (
        "unknown card",
        changed(("JOIN\n", "JION\n")),
        ["22:1: error: there is no card 'JION'; is 'JOIN' meant?"],
    ),
    (
        "letter O",
        changed(("       2.0       0.5", "       2.O       0.5")),
        ["6:13: error: RIGI: mass in columns 6-15 must be a number; read '2.O': letter O instead of zero?"],
    ),
    (
        "two numbers in a field",
        changed(("       2.0       0.5", "     2.0 0.5        ")),
        [
            "6:11: error: RIGI: mass in columns 6-15 must be a number; read '2.0 0': two numbers in "
            "one field? "
            "fields are cut by column, or by commas"
        ],
    ),
    (
        "no mass",
        changed(("    1       2.0       0.5\n", "    1\n")),
        ["6:6: error: RIGI: mass in columns 6-15 must be a number; the field is empty"],
    ),
    (
        "decimal body number",
        changed(("    2       1.0      0.25", "  2.5       1.0      0.25")),
        ["8:3: error: RIGI: body in columns 1-5 must be an integer; read '2.5'"],
    ),
    (
        "unknown joint",
        changed(("    1 REVO", "    1 HING")),
        [
            "23:7: error: JOIN: kind in columns 7-10 must be one of SPHE, UNIV, REVO, CYLI, TRAN, "
            "SCRW, FIXD, "
            "RSPH, DIST; read 'HING'"
        ],
    ),
    (
        "number behind the fields",
        changed(("       1.0      0.01\n", "       1.0      0.01       0.0       5.0\n")),
        ["28:38: error: TIME: '5.0' stands behind the last field and is not read"],
    ),
    (
        "second card missing",
        changed(("      0.05       0.1       0.1\nPOSI", "POSI")),
        ["8:26: error: RIGI: its second card, with Jxx ... Jzx, is missing"],
    ),
    (
        "twice",
        changed(("NODE\n", "    2       3.0\nNODE\n")),
        ["12:5: error: position of body 2: it is given on line 11 already"],
    ),
    (
        "numbers out of order",
        changed(("    2 RIGD", "    3 RIGD")),
        ["4:5: error: body 3: it is number 2 of its kind; records are numbered 1, 2, ... in their order"],
    ),
    (
        "no END",
        changed(("END\nSTAR\nSTOP\n", "")),
        ["30:11: error: unexpected end of the deck, expected the card END"],
    ),
    (
        "behind END",
        changed(("STAR\n", "STAR\nGRAV\n")),
        ["33:1: error: card 'GRAV' stands behind END, where nothing is read"],
    ),
    (
        "BODY not first",
        "VSDF\nTIME\n 1.0,0.1\nBODY\n    1 RIGD\nEND\nSTAR\n",
        ["2:1: error: card 'TIME' stands before BODY, which must come first"],
    ),
    (
        "data before a card",
        "VSDF\n    1\nBODY\n    1 RIGD\nEND\nSTAR\n",
        ["2:1: error: a data card stands before any keyword"],
    ),
    (
        "a list without entries",
        changed(("    2    3\n", "    2\n")),
        ["30:6: error: OUTN: the card names no node or node set"],
    ),
    (
        "tab",
        changed(("    1       2.0       0.5\n", "    1\t2.0\t0.5\n")),
        [
            "6:7: error: RIGI: mass in columns 6-15: a tab counts as one column; use blanks or commas",
        ],
    ),
    (
        "free field",
        changed(("       1.0      0.01\n", "1.0, 0.01x\n")),
        ["28:6: error: TIME: output in field 2 must be a number; read '0.01x'"],
    ),
    (
        "all at once",
        changed(("    1 REVO", "    1 HING"), ("       1.0      0.01\n", "       1.0      O.01\n")),
        [
            "23:7: error: JOIN: kind in columns 7-10 must be one of SPHE, UNIV, REVO, CYLI, TRAN, "
            "SCRW, FIXD, "
            "RSPH, DIST; read 'HING'",
            "28:17: error: TIME: output in columns 11-20 must be a number; read 'O.01': letter O "
            "instead of zero?",
        ],
    ),
]

RIGID_MODELS = [
    (
        "body number",
        changed(("    2       1.0      0.25", "    3       1.0      0.25")),
        [
            "4:5: error: body 2: a RIGD body needs a card RIGI with its mass and inertia",
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
        "a moment missing",
        changed(("       0.1       0.2       0.2", "                 0.2       0.2")),
        [
            "7:1: error: mass of body 1: the principal moments of inertia must be above zero; the "
            "least is 0 kg m^2"
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
        [
            "18:10: error: node 6: body 1 already has a node 3",
            "24:25: error: joint 2: body 1 has no node 4",
        ],
    ),
    (
        "no such node",
        changed(("    2 REVO    1    3    4", "    2 REVO    1    3    9")),
        ["24:25: error: joint 2: body 1 has no node 9"],
    ),
    (
        "no such body",
        changed(("    2 REVO    1", "    2 REVO    7")),
        [
            "24:15: error: joint 2: body number 7 is outside 0..2",
        ],
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
        ["26:13: error: pin 1: mask 121 wanted as three digits 0 or 1 for x y z, such as 111 or 101"],
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
        "card of the other kind",
        changed(("GRAV\n", "DAMP\n    1       0.1\nGRAV\n")),
        ["26:5: error: damping of body 1: DAMP is for FLEX bodies; body 1 is RIGD"],
    ),
]

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
            "11:5: error: torque 1: body 1 is FLEX, its nodes do not turn; give a pair of forces instead"
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


@pytest.mark.parametrize("text, wanted", [case[1:] for case in READING], ids=[case[0] for case in READING])
def test_decks_that_cannot_be_read(text, wanted):
    assert reported(text) == wanted


@pytest.mark.parametrize(
    "text, wanted", [case[1:] for case in RIGID_MODELS], ids=[case[0] for case in RIGID_MODELS]
)
def test_decks_of_rigid_bodies_that_describe_no_model(text, wanted):
    assert reported(text) == wanted


@pytest.mark.parametrize(
    "text, wanted", [case[1:] for case in FLEXIBLE_MODELS], ids=[case[0] for case in FLEXIBLE_MODELS]
)
def test_decks_of_flexible_bodies_that_describe_no_model(text, wanted):
    from tests.dialects.vsdf.vsdf_decks import DECKS

    assert reported(text) == wanted(DECKS / "fe")


def test_a_sound_deck_leaves_nothing_to_say():
    assert reported(RIGID) == []


def test_the_columns_of_a_card_are_drawn_above_it():
    from flexmb_cli.errors import DeckError, compiler_style
    from tests.dialects.vsdf.vsdf_decks import read

    text = changed(("       2.0       0.5", "       2.O       0.5"))
    with pytest.raises(DeckError) as stopped:
        read(text)
    shown = compiler_style("x.vsdf", stopped.value.faults, text.splitlines())
    assert shown.splitlines()[1:] == [
        "    [I5-][F10-----][F10-----][F10-----][F10-----]",
        "    ----+----1----+----2----+----3----+----4----+",
        "        1       2.O       0.5",
        "                ^^^",
    ]


def test_a_step_that_rk45_does_not_use_is_told():
    text = changed(("       1.0      0.01\n", "       1.0      0.01      0.02\nINTG\n RK45    1.0E-9\n"))
    assert reported(text) == [
        "28:27: warning: TIME: RK45 chooses its steps by the tolerance; the step of 0.02 s is not used"
    ]


def test_a_megabyte_of_faults_is_left_after_a_thousand():
    """Each unknown word is looked for among the known ones, and each fault is kept."""
    faults = reported("VSDF T\nBODY\n    1 RIGD\n" + "QQQQ\n" * 200_000)
    assert 1000 < len(faults) < 1010
    assert "not read from here on" in faults[-1]


def test_more_springs_than_memory_allows_are_refused(monkeypatch):
    """One takes 2.6 kB, a hundred times its card: 10 MB of them took 1.6 GB."""
    monkeypatch.setattr("flexmb_cli.dialects.vsdf.loads.MOST_ELEMENTS", 1)
    springs = "JSPR\n    1      10.0\n    1      10.0\nEND"
    (message,) = reported(changed(("END", springs)))
    assert message.endswith("joint spring 2: the deck has 2 springs of this card; at most 1 are taken")


def test_the_fields_of_a_card_with_a_list_are_bounded(monkeypatch):
    """Each takes some hundred bytes while its card is read."""
    text = changed(("OUTN\n    2    3\n", f"OUTN\n    2{5 * '    3'}\n"))
    monkeypatch.setattr("flexmb_cli.dialects.vsdf.data_cards.one_card._MOST_FIELDS", 6)
    assert not any("has at most" in message for message in reported(text))
    monkeypatch.setattr("flexmb_cli.dialects.vsdf.data_cards.one_card._MOST_FIELDS", 5)
    (message,) = reported(text)
    assert message.endswith("a card has at most 5 fields; go on on a further one")
