"""The RSSR against Prof. Coelho's table, and against the closed form of rssr.py.

Liang Yong, YOUNG dissertation (1996), Appendix C: position, velocity and acceleration of both rod
ends by an independent program, sixteen digits, twelve instants (23 February 1996).

That table does not keep its own rod length, which varies by 5e-8 m from row to row: it allows 2e-7
of B, 1e-6 of VB and 2e-6 of AB, relative to the largest length of each vector.  The crank end A is
free of it.  The closed form has no such limit.
"""

import csv

import numpy as np
import pytest

from tests.solvers.kinematics.rssr import Rssr, carried
from tests.solvers.kinematics.solved import PUBLISHED, mechanism_of, rows_of_deck

CRANK_RATE = 146.6000061035156  # rad/s, Appendix C
# Axes and rod ends of the table's constants at t = 0: the crank turns about y, the rocker about x.
COELHO = Rssr(
    O_in=np.array([0.0, -0.06566999852657318, 0.0]),
    u_in=np.array([0.0, 1.0, 0.0]),
    A=np.array([0.0, 0.0, 0.1000000014901161]),
    O_out=np.array([-0.04749999940395355, 0.4997699856758118, 0.0]),
    u_out=np.array([1.0, 0.0, 0.0]),
    B=np.array([0.0, 0.4812000095844269, 0.1000000014901161]),
)


@pytest.fixture(scope="module")
def rows():
    return rows_of_deck("IN-RSSR-COELHO")


@pytest.fixture(scope="module")
def table():
    with open(PUBLISHED / "coelho_rssr.csv") as file:
        lines = list(csv.DictReader(line for line in file if not line.startswith("#")))
    return {name: np.array([float(line[name]) for line in lines]) for name in lines[0]}


def end(rows, name):
    """A, VA, AA (point 1) or B, VB, AB (point 2), (T, 3)."""
    column = {"": rows.point_position, "V": rows.point_velocity, "A": rows.point_acceleration}
    return column[name[:-1]][:, 0 if name.endswith("A") else 1]


def relative(found, expected):
    """Largest distance of two series of vectors, as a part of the longest vector."""
    return np.max(np.linalg.norm(found - expected, axis=1)) / np.max(np.linalg.norm(expected, axis=1))


def test_the_instants_are_those_of_the_table(rows, table):
    assert np.max(np.abs(rows.time - table["time"])) <= 1e-16


@pytest.mark.parametrize(
    ("name", "allowed"), [("A", 1e-11), ("VA", 1e-11), ("AA", 1e-11), ("B", 2e-7), ("VB", 1e-6), ("AB", 2e-6)]
)
def test_rod_ends_are_those_of_the_table(rows, table, name, allowed):
    expected = np.column_stack([table[f"{name}{axis}"] for axis in "xyz"])
    assert relative(end(rows, name), expected) <= allowed


def test_rod_ends_are_those_of_the_closed_form(rows):
    """To 1e-11, a hundred thousand times closer than the program YOUNG (1e-4 to 1e-5, chapter 7)."""
    angle, rate, second = CRANK_RATE * rows.time, np.full(12, CRANK_RATE), np.zeros(12)
    A = carried(COELHO.O_in, COELHO.u_in, COELHO.A, angle, rate, second)
    B = carried(COELHO.O_out, COELHO.u_out, COELHO.B, *COELHO.rocker(angle, rate, second))
    for names, expected in ((("A", "VA", "AA"), A), (("B", "VB", "AB"), B)):
        for name, vectors in zip(names, expected, strict=True):
            assert relative(end(rows, name), vectors) <= 1e-11, name


def test_the_rod_keeps_its_length(rows):
    lengths = np.linalg.norm(rows.point_position[:, 0] - rows.point_position[:, 1], axis=1)
    assert np.max(np.abs(lengths - 0.4812000095844269)) <= 1e-15


def test_the_deck_has_the_constants_of_the_table():
    mechanism = mechanism_of("IN-RSSR-COELHO")
    assert mechanism.drivers[0].B == CRANK_RATE
    assert mechanism.bodies[1].r == tuple(COELHO.O_in)
    assert mechanism.bodies[3].r == tuple(COELHO.O_out)
