"""Node tables of finite-element programs."""

import numpy as np
import pytest

from flexmb_cli.fe.formats.formats import read_matrix
from flexmb_cli.fe.formats.node_table import read_node_table
from tests.fe.formats.test_fe_files import FILES, full

NODE_TABLES = {
    "TXT": "# id x y z\n  7 1.5 0 -2.0\n\n3 0.0 2.5D-1 1 # tail\n",
    "TXT NLIST": (
        " LIST ALL SELECTED NODES.\n"
        "   NODE  X  Y  Z  THXY THYZ THZX\n"
        " 7 1.5 0. -2. 0. 0. 0.\n"
        "\n"
        " NODE X Y Z\n"
        " 3 0. .25 1.\n"
    ),
    "INP": (
        "*HEADING\n"
        " 1, 2, 3, 4\n"
        "*node, nset=ALL\n"
        " 7, 1.5, 0, -2.0,\n"
        "** comment\n"
        "3, 0, 0.25, 1.\n"
        "*ELEMENT\n"
        "1, 2, 3, 4\n"
    ),
    "CDB": (
        "NBLOCK,6,SOLID\n"
        "(3i9,6e20.13)\n"
        "        7        0        0 1.5000000000000E+00 0.0000000000000E+00-2.0000000000000E+00\n"
        "        3        0        0 0.0000000000000E+00 2.5000000000000E-01 1.0000000000000E+00\n"
        "N,R5.3,LOC,       -1,\n"
    ),
    "BDF": (
        "GRID    7               1.5     0.0     -2.0\n"
        "GRID*   3                               0.0             .25\n"
        "*       1.0\n"
    ),
    "BDF free": "GRID,7,,1.5,0.,-2.\ngrid,3,,0.,2.5-1,1.0\nENDDATA\n",
}


@pytest.mark.parametrize("kind", NODE_TABLES)
def test_node_tables_keep_numbers_positions_and_order(tmp_path, kind):
    (tmp_path / "x").write_text(NODE_TABLES[kind])
    found = read_node_table(tmp_path / "x", kind.split()[0])
    assert found.numbers.tolist() == [7, 3]
    assert found.positions.tolist() == [[1.5, 0.0, -2.0], [0.0, 0.25, 1.0]]


def test_trailing_zeros_of_an_archive_may_be_left_out(tmp_path):
    (tmp_path / "x").write_text(
        "NBLOCK,6,SOLID\n"
        "(3i9,6e20.13)\n"
        "        7        0        0\n"
        "        8        0        0 1.5000000000000E+00\n"
        "       -1\n"
    )
    found = read_node_table(tmp_path / "x", "CDB")
    assert found.positions.tolist() == [[0.0, 0.0, 0.0], [1.5, 0.0, 0.0]]


@pytest.mark.parametrize("name, form", [("pendulum.cdb", "CDB"), ("calculix/pendulum.inp", "INP")])
def test_the_supplied_node_tables_agree(name, form):
    wanted, found = read_node_table(FILES / "pendulum_nodes.txt", "TXT"), read_node_table(FILES / name, form)
    assert found.numbers.tolist() == wanted.numbers.tolist()
    np.testing.assert_allclose(found.positions, wanted.positions, atol=1e-15)


def test_windows_line_ends_are_read(tmp_path):
    (tmp_path / "x").write_bytes(b"%%MatrixMarket matrix coordinate real symmetric\r\n1 1 1\r\n1 1 2.5\r\n")
    assert full(read_matrix(tmp_path / "x", "MM", "K")).tolist() == [[2.5]]
