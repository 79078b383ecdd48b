"""The OUT table against the listings of the YOUNG dissertation (Liang Yong, 1996), Appendix B."""

import csv
import io
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from flexmb_cli.dialects.young.listing import OutTable, echo_of_input, report_block
from flexmb_cli.results.hdf5.kinematic import kinematic_values

PUBLISHED = Path(__file__).parents[2] / "published" / "young"

BLOCK_OF_ONE_SECOND = """
-----
TIME= 1.000
-----
POSITION
BODY       X         Y         Z         e0        e1        e2        e3
  1     0.000     0.000     0.000     1.000     0.000     0.000     0.000
  2     0.500     0.000    -0.866     0.866     0.000     0.500     0.000


VELOCITY
BODY  dX     dY     dZ     de0    de1    de2    de3    w-x    w-y    w-z
  1  0.000  0.000  0.000  0.000  0.000  0.000  0.000   0.00   0.00  0.000
  2 -0.907  0.000 -0.524 -0.262  0.000  0.453  0.000   0.00   1.05  0.000

ACCELERATION
BODY  ddX    ddY    ddZ    dde0   dde1   dde2   dde3   dw-x   dw-y   dw-z
  1  0.000  0.000  0.000  0.000  0.000  0.000  0.000  0.000  0.000  0.000
  2 -0.548  0.000  0.949 -0.237  0.000 -0.137  0.000  0.000  0.000  0.000


POINTS OF INTEREST
No   X       Y       Z       dX      dY      dZ      ddX     ddY     ddZ
  1  1.0003  0.0000 -1.7319 -1.8133  0.0000 -1.0474 -1.0966  0.0000  1.8985

*****
"""

ECHO = """\
ENTER NUMBER OF
body : NBODY
driver: NDRIVE
points of interest: NPOINT
spherical joints: NSPHER
universal joints: NUNIVE
revolute joints: NREVOL
cylindrical joints: NCYLIN
translational joints: NTRANS
screw joints: NSCREW
simplified constraint: NSIMPL
distance constraint: NSIMP2
grounded body: NGROUN
  2  1  1  1  0  0  0  0  0  2  0  1
FOR BODY 1 ENTER INITIAL ESTIMATES OF X,Y,Z & E0 E1,E2,E3
  0.00  0.00  0.00  1.00  0.00  0.00  0.00
FOR BODY 2 ENTER INITIAL ESTIMATES OF X,Y,Z & E0 E1,E2,E3
  1.00  0.00  0.00  1.00  0.00  0.00  0.00
FOR DRIVER No 1
_ENTER BODY No_
  2
ENTER DRIVER CONSTRAINT
_NUMBER 1-6 FOR X,Y,Z,ALPHA,BETA,DELTA
  5
ENTER INITIAL POSITION, VELOCITY & ACCELERATION
    0.00    1.05    0.00
FOR POINT OF INTEREST No 1
_ENTER BODY No_
  2
ENTER RELATIVE COORDINATES OF THE POINT
  1.00  0.00  0.00
FOR SPHERICAL JOINT No 1
_ENTER BODY No I & J_
  1  2
ENTER LOCAL COORDINATES OF JOINT POINT
  0.00  0.00  0.00 -1.00  0.00  0.00
FOR SIMPLIFIED CONSTRAINTS No 1
_ENTER BODY No:_
  2
ENTER 1-6 FOR DIRECTION X,Y,Z,ALPH(axis is X),BETA(axis is Y),DELT(axis is Z)
  4
ENTER VALUES OF CONSTRAINT
  0.00
FOR SIMPLIFIED CONSTRAINTS No 2
_ENTER BODY No:_
  2
ENTER 1-6 FOR DIRECTION X,Y,Z,ALPH(axis is X),BETA(axis is Y),DELT(axis is Z)
  6
ENTER VALUES OF CONSTRAINT
  0.00
ENTER BODY No FOR No 1 GROUNDED BODY
1
ENTER BODY 1 COORDINATES
 1 1  0.00 1 2  0.00 1 3  0.00 1 4  0.00 1 5  0.00 1 6  0.00
-----*-----*-----
ENTER STARTING TIME: Ti; FINAL TIME: Te; AND dT
 0.00      6.00      1.00
""".replace("_", " ")  # blanks at the ends of lines show as underscores above

HEAD = """
-----------------------------
-- KINEMATIC ANALYSIS --
-----------------------------
"""


def written(deck, *blocks, layout="safe"):
    stream = io.StringIO()
    table = OutTable((stream,), deck, layout)
    table.begin()
    for block in blocks:
        table.rows(kinematic_values(block))
    return stream.getvalue()


def test_the_listing_of_2_1_1_at_one_second_is_reproduced_byte_for_byte(deck, rows):
    """OUT2-1-1, Appendix B; the values from the closed form of a unit radius turning at 1.047 rad/s."""
    assert written(deck, rows([1.0])) == ECHO + HEAD + BLOCK_OF_ONE_SECOND


@pytest.mark.parametrize("step", range(1, 6))
def test_every_readable_number_of_2_1_1_is_printed_where_the_listing_has_it(deck, rows, step):
    """OUT2-1-1; "repaired" lines are left out; signs of zero came from the program's round-off."""
    lines = written(deck, rows([float(step)])).split("TIME=")[1].splitlines()
    start = {"position": 4, "velocity": 10, "acceleration": 15, "point": 21}
    with open(PUBLISHED / "IN2-1-1.csv") as file:
        published = [
            row for row in csv.DictReader(file) if row["step"] == str(step) and row["ocr"] != "repaired"
        ]
    assert published
    for row in published:
        line = lines[start[row["section"]] + int(row["index"]) - 1]
        printed = [row[f"v{k}"] for k in range(1, 11) if row[f"v{k}"]]
        assert line.split()[1:] == [unsigned_zero(text) for text in printed]


def unsigned_zero(text):
    return text.lstrip("-") if float(text) == 0 else text


def test_rows_may_come_in_any_blocks(deck, rows):
    time = np.arange(7.0)
    assert written(deck, *[rows([t]) for t in time]) == written(deck, rows(time))


def test_without_points_their_table_is_absent(deck, rows, make):
    nothing = np.zeros((1, 0, 3))
    block = replace(rows([0.0]), point_position=nothing, point_velocity=nothing, point_acceleration=nothing)
    without = make.pack("IN.dat", [make.counts(NBODY=2), make.record("time", 0, start=0, end=0, step=1)])
    text = written(without, block)
    assert "POINTS" not in text
    assert text.endswith("  0.000  0.000\n\n*****\n")


def test_a_failure_ends_the_table(deck, rows):
    stream = io.StringIO()
    table = OutTable((stream,), deck)
    table.rows(kinematic_values(rows([0.0])))
    table.failed()
    assert stream.getvalue().endswith("*****\n\n\n-----CONVERGENCE FAILED-----\n")


def test_full_fields_touch_in_the_historic_layout_only(deck, rows):
    """OUT-RSSR, Appendix B, prints `-7.3304-1074.6427  0.0000-1861.1863`."""
    acceleration = np.array([[[-1074.6427, 0.0, -1861.1863]]])
    block = replace(rows([1.0]), point_acceleration=acceleration)
    assert " -1.0474-1074.6427  0.0000-1861.1863\n" in written(deck, block, layout="historic")
    assert " -1.0474 -1074.6427  0.0000 -1861.1863\n" in written(deck, block)


def test_zeros_keep_their_sign_in_the_historic_layout_only(deck, rows):
    block = replace(rows([1.0]), velocity=np.full((1, 2, 3), -1e-9))
    assert "  1 -0.000 -0.000 -0.000  0.000" in written(deck, block, layout="historic")
    assert "-0.000" not in written(deck, block)


def test_drivers_all_carry_the_number_of_drivers(make):
    """OUT1-3-3 and OUT1-3-4, Appendix B: a slip of the program that belongs to its layout."""
    drivers = [make.record("driver", k, body=1, direction=k, C=1, B=1, A=0) for k in (1, 2)]
    time = make.record("time", 0, start=0, end=3, step=1)
    deck = make.pack("IN1-3-3.dat", [make.counts(NBODY=1, NDRIVE=2), *drivers, time])
    echo = echo_of_input(deck)
    assert echo.count("FOR DRIVER No 2\n") == 2
    assert "FOR DRIVER No 1\n" not in echo


JOINT_ECHOES = {
    "universal": ("UNIVERSAL JOINT", "ENTER LOCAL COORDINATES OF POINTS", 12),
    "revolute": ("REVOLUTE JOINT", "ENTER LOCAL COORDINATES OF POINTS Pij,Qi,Qj", 12),
    "cylindrical": (
        "CYLINDRICAL JOINT",
        "ENTER LOCAL COORDINATES OF 4 POINTS: 2 ON AXIS, 2 ON EACH BODY",
        12,
    ),
    "translational": (
        "TRANSLATIONAL JOINTS",
        "ENTER LOCAL COORDINATES OF 6 POINTS, 3 ON EACH BODY,\n4 ON AXIS, 2 FOR PERPENDICULAR VECTORS:",
        18,
    ),
}


def deck_with(make, section, **values):
    time = make.record("time", 0, start=0, end=1, step=0.1)
    return make.pack("IN.dat", [make.counts(NBODY=2), make.record(section, 1, **values), time])


@pytest.mark.parametrize("section", JOINT_ECHOES)
def test_joints_are_echoed_with_their_points_on_one_line(make, section):
    name, title, numbers = JOINT_ECHOES[section]
    values = {f"v{k}": k + 0.25 for k in range(numbers)}
    printed = "".join(f"{k + 0.25:6.2f}" for k in range(numbers))
    echo = echo_of_input(deck_with(make, section, I=1, J=4, **values))
    assert f"FOR {name} No 1\n ENTER BODY No I & J \n  1  4\n{title}\n{printed}\n" in echo


def test_the_bodies_of_a_screw_joint_touch_as_in_the_listing(make):
    """OUT2-6-1, Appendix B."""
    values = {f"v{k}": 0.5 for k in range(19)}
    echo = echo_of_input(deck_with(make, "screw", I=1, J=2, **values))
    title = "ENTER LOCAL COORDINATES OF 6 POINTS,3 ON EACH BODY, 4 ON AXIS"
    assert f"FOR SCREW JOINT No 1\n ENTER BODY No I & J \n12\n{title}\n{19 * '  0.50'}\n" in echo


def test_touching_body_numbers_of_two_digits_are_parted_in_the_safe_layout(make):
    deck = deck_with(make, "screw", I=1, J=12, pitch=0.5)
    assert "\n1 12\n" in echo_of_input(deck)
    assert "\n112\n" in echo_of_input(deck, "historic")


def test_a_distance_is_echoed(make):
    echo = echo_of_input(deck_with(make, "distance", I=3, J=4, direction=1, value=0.25))
    assert (
        "FOR DISTANCE CONSTRAINTS No 1\n ENTER THE TWO BODY No: \n  3  4\n"
        "ENTER 1-6 FOR DIRECTION X,Y,Z,ALPH(axis is X),BETA(axis is Y),DELT(axis is Z)\n  1\n"
        "ENTER VALUES OF DISTANCE\n  0.25\n"
    ) in echo


def test_no_blank_ends_a_line_of_a_report_block():
    block = report_block(12, 3).lines(np.zeros(1 + 27 * 12 + 27))
    assert [line for line in block.splitlines() if line != line.rstrip()] == []
    assert " 12     0.000" in block
