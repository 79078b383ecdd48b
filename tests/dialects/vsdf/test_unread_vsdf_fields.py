# ruff: noqa: E501
"""Fields and cards of VSDF decks that nothing reads are told: whoever wrote them meant something by it."""

import pytest

from tests.dialects.vsdf.vsdf_decks import RIGID, changed, reported, supplied

ELBOW = "    2 REVO    1    3    4    2    1    2\n"
EMPTY = "leave the field empty"

UNREAD = [
    (
        "modes and reference nodes of a rigid body",
        changed(("    1 RIGD\n", "    1 RIGD    5    1    2    3\n")),
        [
            f"3:15: error: body 1: modes is 5 and is not read: a RIGD body has no modes; {EMPTY}",
            *(
                f"3:{15 + 5 * k}: error: body 1: n{k} is {k} and is not read: a RIGD body has no reference "
                f"nodes, its axes are those of its RIGI and NODE cards; {EMPTY}"
                for k in (1, 2, 3)
            ),
        ],
    ),
    (
        "third nodes and size of a revolute joint",
        changed((ELBOW, "    2 REVO    1    3    4    2    1    2    1    3      0.25\n")),
        [
            f"24:45: error: joint 2: a3 is 1 and is not read: REVO has 2 nodes on a; {EMPTY}",
            f"24:50: error: joint 2: b3 is 3 and is not read: REVO has 2 nodes on b; {EMPTY}",
            f"24:57: error: joint 2: size is 0.25 and is not read: REVO has neither pitch nor distance; {EMPTY}",
        ],
    ),
    (
        "axes of a spherical joint",
        changed((ELBOW, ELBOW.replace("REVO", "SPHE"))),
        [
            f"24:25: error: joint 2: a2 is 4 and is not read: SPHE has 1 node on a; {EMPTY}",
            f"24:40: error: joint 2: b2 is 2 and is not read: SPHE has 1 node on b; {EMPTY}",
        ],
    ),
    (
        "constants after those of a spin-up",
        changed(("GRAV\n", "MOTN\n    1 ANGL    1    2       6.0       1.0       0.5\nGRAV\n")),
        [f"26:48: error: motion 1: c2 is 0.5 and is not read: law 2 reads c0 and c1; {EMPTY}"],
    ),
    (
        "constants after a table's number",
        changed(
            ("GRAV\n", "TABL\n 1,0.0,0.0\n 1,1.0,1.0\nMOTN\n    1 ANGL    1    4       1.0       0.5\nGRAV\n")
        ),
        [f"29:38: error: motion 1: c1 is 0.5 and is not read: law 4 reads the table's number c0; {EMPTY}"],
    ),
    (
        "a table that nothing names",
        changed(("GRAV\n", "TABL\n 3,0.0,0.0\n 3,1.0,1.0\nGRAV\n")),
        [
            "26:2: warning: table 3: nothing uses it; a motion of law 4 names a table in c0, a force or a torque "
            "in its last field, a line FUNCTION by points="
        ],
    ),
    (
        "a table that no field can name",
        changed(("GRAV\n", "TABL\n 0,0.0,0.0\n 0,1.0,1.0\nFORC\n    2    3       1.0\nGRAV\n")),
        ["26:2: error: table 0: tables are numbered from 1; read 0"],
    ),
    (
        "a length at rest without stiffness",
        changed(("GRAV\n", "SPRI\n    1    0    1    2    3                 2.0       0.3\nGRAV\n")),
        [
            "26:53: error: spring 1: length is 0.3 and is not read: a length at rest belongs to the stiffness k, "
            f"which is empty; {EMPTY}"
        ],
    ),
    (
        "a position at rest without stiffness",
        changed(("GRAV\n", "JSPR\n    1                 2.0       0.3\nGRAV\n")),
        [
            "26:33: error: joint spring 1: q0 is 0.3 and is not read: a position at rest belongs to the "
            f"stiffness k, which is empty; {EMPTY}"
        ],
    ),
    (
        "Poisson's ratio alone",
        changed(
            ("    1    1\nFEMG", "    1    1                 0.3\nFEMG"),
            text=supplied("spinup"),
        ),
        [
            "14:28: error: stiffening of body 1: nu is 0.3 and is not read: Poisson's ratio belongs to Young's "
            f"modulus E, which is empty; {EMPTY}"
        ],
    ),
    (
        "stiffening switched off",
        supplied("pendulum", ("JOIN\n", "GEOS\n    1    0     1.0E7      0.49\nJOIN\n")),
        ["11:16: warning: stiffening of body 1: E and nu are not used: stiffening is switched off, on is 0"],
    ),
    (
        "stiffening neither on nor off",
        changed(("    1    1\nFEMG", "    1    2\nFEMG"), text=supplied("spinup")),
        ["14:10: error: stiffening of body 1: on is 0 or 1; read 2"],
    ),
    (
        "geometric stiffness of a rigid body",
        changed(("GRAV\n", "FEMG\n    1    4 MM   k.mtx\nGRAV\n")),
        ["26:5: error: geometric stiffness 1: FEMG is for FLEX bodies; body 1 is RIGD"],
    ),
    (
        "a mapping beside formats that have none",
        supplied("pendulum_dmig", ("JOIN\n", "FEMP\n    1 ANS  fe/pendulum.mapping\nJOIN\n")),
        [
            "11:5: error: equation mapping of body 1: the mapping is not read: only matrices of formats MM, HB, "
            "CCX, ABQ, OP4 have one; remove the card"
        ],
    ),
    (
        "attachment modes beside interface modes",
        supplied("pendulum", ("JOIN\n", "CRBN\n    1    1    5    6\nATTM\n    1   51\nJOIN\n")),
        [
            "13:5: error: attachment nodes 1: ATTM is not read beside CRBN of body 1; name its nodes on CRBN, "
            "or remove CRBN"
        ],
    ),
    (
        "stabilisation",
        changed(("OUTN\n", "INTG\n GALF       0.9       5.0\nOUTN\n")),
        [
            "30:23: warning: INTG: constraint stabilisation is not used: every step is projected onto the "
            "constraints"
        ],
    ),
]  # fmt: skip

WITHOUT_EFFECT = [
    (
        "a spring within a rigid body",
        changed(("GRAV\n", "SPRI\n    1    1    3    1    1      10.0\nGRAV\n")),
        [
            "26:20: error: spring 1: both ends are on body 1, which is rigid, so their distance never changes"
        ],
    ),
    (
        "a spring within the ground",
        changed(("GRAV\n", "SPRI\n    1    0    1    0    2      10.0\nGRAV\n")),
        ["26:20: error: spring 1: both ends are on the ground, so their distance never changes"],
    ),
    (
        "a spring without numbers",
        changed(("GRAV\n", "SPRI\n    1    0    1    2    3\nGRAV\n")),
        ["26:26: error: spring 1: k, c are all empty, so the card does nothing"],
    ),
    (
        "a force on the ground",
        changed(("GRAV\n", "FORC\n    0    1       1.0\nGRAV\n")),
        ["26:5: error: force 1: a force on the ground moves nothing"],
    ),
    (
        "a force without numbers",
        changed(("GRAV\n", "FORC\n    2    3\nGRAV\n")),
        ["26:11: error: force 1: F.x, F.y, F.z are all empty, so the card does nothing"],
    ),
    (
        "a sine without frequency",
        changed(("GRAV\n", "MOTN\n    1 ANGL    1    3       0.0       1.0\nGRAV\n")),
        ["26:41: error: motion 1: the sine needs c2, rad/s; without it nothing moves"],
    ),
    (
        "a screw without pitch",
        changed((ELBOW, "    2 SCRW    1    3    4    2    1    2    1    3\n")),
        [
            "24:51: error: joint 2: SCRW needs its pitch in size, m/rad; write 0.0 for a screw without advance"
        ],
    ),
    (
        "a node twice in a set",
        changed(("OUTN\n    2    3\n", "NSET\n    1   90    1    3    1\nOUTN\n    2    3\n")),
        ["30:25: error: node set 1: node 1 is in the set already"],
    ),
    (
        "a set that no field can name",
        changed(("OUTN\n    2    3\n", "NSET\n    1    0    1    3\nOUTN\n    2    3\n")),
        ["30:10: error: node set 1: sets are numbered from 1; read 0"],
    ),
    (
        "rows farther apart than the run is long",
        changed(("       1.0      0.01\n", "       1.0       5.0\n")),
        ["28:18: warning: TIME: rows are 5 s apart and the run ends at 1 s: only that of t = 0 is written"],
    ),
    (
        "an end that is no row",
        changed(("       1.0      0.01\n", "       1.0       0.3\n")),
        ["28:8: note: TIME: no row stands at the end 1 s: the last within whole steps is at 0.9 s"],
    ),
]  # fmt: skip

BESIDE_FIELDS = [
    (
        "a keyword without data",
        changed(("GRAV\n       0.0     -9.81       0.0\n", "GRAV along y\n")),
        ["25:1: warning: GRAV: no data card follows the keyword, so it has no effect"],
    ),
    (
        "numbers with a unit after the keyword",
        changed(("GRAV\n", "GRAV 0.0,-9.81,0.0 m/s2\n")),
        [
            "25:6: error: GRAV: '0.0,-9.81,0.0 m/s2' stands after the keyword and is not read; data cards "
            "follow on lines of their own"
        ],
    ),
    (
        "a number and words after the last field",
        changed(("       1.0      0.01\n", "       1.0      0.01       0.0       5.0 s\n")),
        ["28:38: error: TIME: '5.0 s' stands after the last field and is not read"],
    ),
    (
        "a number that runs over the last field",
        changed(("     -9.81       0.0\n", "     -9.81  100000000.5 m/s2\n")),
        ["26:31: error: GRAV: '0.5 m/s2' stands after the last field and is not read"],
    ),
    (
        "an exponent that runs over the last field",
        changed(("     -9.81       0.0\n", "     -9.81 1.0000000E+1 m/s2\n")),
        [
            "26:31: error: GRAV: 'E+1 m/s2' touches the last field, which ends in column 30: a comment needs a "
            "blank before it, a longer number the form with commas"
        ],
    ),
    (
        "data after END",
        changed(("STAR\n", "       1.0      0.01\nSTAR\n")),
        ["32:1: error: a data card stands after END, where nothing is read"],
    ),
]  # fmt: skip
CASES = [*UNREAD, *WITHOUT_EFFECT, *BESIDE_FIELDS]


@pytest.mark.parametrize("text, wanted", [case[1:] for case in CASES], ids=[case[0] for case in CASES])
def test_what_nothing_reads_is_told(text, wanted):
    assert reported(text) == wanted


def test_a_written_zero_is_what_an_empty_field_means():
    text = changed(
        ("    1 RIGD\n", "    1 RIGD    0    0    0    0\n"),
        (ELBOW, "    2 REVO    1    3    4    2    1    2    0    0       0.0\n"),
    )
    assert reported(text) == []


def test_a_spring_within_a_flexible_body_is_a_spring():
    text = supplied("pendulum", ("GRAV\n", "SPRI\n    1    1    1    1   51      10.0\nGRAV\n"))
    assert reported(text) == []


def test_all_cards_of_the_sound_deck_are_read():
    assert reported(RIGID) == []
