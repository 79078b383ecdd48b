"""Grid points of Nastran in coordinate systems, by GRDSET and INCLUDE; nodes of ANSYS by several blocks.

Cards: MSC Nastran Quick Reference Guide, ANSYS Command Reference; masses and frequencies: bars.py.
"""

import math

import numpy as np
import pytest

from flexmb_cli.fe.formats.connectivity import read_elements
from flexmb_cli.fe.formats.matrix_file import FEFileFault
from flexmb_cli.fe.formats.node_table import read_node_table
from tests.fe.formats.bars import (
    BRICKS,
    MASS,
    OF_MATRICES,
    POINTS,
    bdf_elements,
    bdf_nodes,
    by_elements,
    by_matrices,
    eblock,
    nblock,
)

# The z axis is the global x, the x axis the global y.
CORD2R = "CORD2R,3,,0.,0.,0.,1.,0.,0.\n,0.,1.,0.\n"
TURNED = [(y, z, x) for x, y, z in POINTS]
ROUND = [(math.hypot(x, y), math.degrees(math.atan2(y, x)), z) for x, y, z in POINTS]
SPHERE = [
    (math.hypot(x, y, z), math.degrees(math.atan2(math.hypot(x, y), z)), math.degrees(math.atan2(y, x)))
    for x, y, z in POINTS
]
# Of system 1 moved by (1, 2, 3): system 2 is defined in it.
CHAIN = "CORD2R,1,,1.,2.,3.,1.,2.,4.\n,2.,2.,3.\nCORD2R,2,1,0.,0.,1.,0.,0.,2.\n,1.,0.,1.\n"
SAME_GRIDS = {
    "GRDSET": CORD2R + "GRDSET,,3\n" + bdf_nodes(points=TURNED),
    "GRDSET after the points, in fixed fields": ""
    + bdf_nodes(points=TURNED) + CORD2R + "GRDSET                 3\n",
    "0 that GRDSET does not change": CORD2R + "GRDSET,,3\n" + bdf_nodes(system="0"),
    "CP": CORD2R + bdf_nodes(points=TURNED, system="3"),
    "a cylinder": "CORD2C,5,,0.,0.,0.,0.,0.,1.\n,1.,0.,0.\n" + bdf_nodes(points=ROUND, system="5"),
    "a sphere": "CORD2S,5,,0.,0.,0.,0.,0.,1.\n,1.,0.,0.\n" + bdf_nodes(points=SPHERE, system="5"),
    "a system in a system": CHAIN
    + bdf_nodes(points=[(x - 1, y - 2, z - 4) for x, y, z in POINTS], system="2"),
    "a system of points": "CORD1R,7,1,5,3\n" + bdf_nodes(1, 5)
    + bdf_nodes(6, 16, points=TURNED, system="7"),
    "two systems of points on a card": "CORD1R,8,1,2,5,7,1,5,3\n" + bdf_nodes(1, 5)
    + bdf_nodes(6, 16, points=TURNED, system="7"),
    "a cylinder of points": "CORD1C,7,1,2,5\n" + bdf_nodes(1, 5) + bdf_nodes(6, 16, points=ROUND, system="7"),
    "the mark of UTF-8": "\ufeff" + bdf_nodes(),
    "a system given twice alike": CORD2R + CORD2R + bdf_nodes(points=TURNED, system="3"),
    "axes of displacements that are moved, not turned": "CORD2R,4,,5.,0.,0.,5.,0.,1.\n,6.,0.,0.\n"
    "GRDSET,,,,,,4,456\n"
    + bdf_nodes(),
}  # fmt: skip


@pytest.mark.parametrize("case", SAME_GRIDS)
def test_the_bar_by_other_coordinates(tmp_path, case):
    (tmp_path / "x").write_text(SAME_GRIDS[case])
    found = read_node_table(tmp_path / "x", "BDF")
    np.testing.assert_allclose(found.positions, POINTS, rtol=0, atol=2e-15)
    body = by_matrices(tmp_path, "BDF", SAME_GRIDS[case])
    assert body.frequencies == pytest.approx(OF_MATRICES, rel=1e-6)


INCLUDED = {
    "quoted": "INCLUDE 'parts/grids.bdf'\n",
    "plain": "include parts\\grids.bdf $ comment\n",
    "over lines": "INCLUDE 'par\n  ts/\n  grids.bdf'\nPARAM,POST,-1\n",
    "by =": 'INCLUDE = "parts/grids.bdf"\n',
}


@pytest.mark.parametrize("how", INCLUDED)
def test_bulk_data_that_is_included_belongs_to_the_mesh(tmp_path, how):
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts" / "grids.bdf").write_text("INCLUDE 'elements.bdf'\n" + bdf_nodes())
    (tmp_path / "parts" / "elements.bdf").write_text(bdf_elements())
    body, warnings = by_elements(tmp_path, "BDF", "BEGIN BULK\n" + INCLUDED[how] + "ENDDATA\n")
    assert body.m == pytest.approx(MASS, rel=1e-6) and not warnings


GRID = "GRID,1,,0.,0.,0.\n"
REFUSED_GRIDS = {
    "an unknown system": ("GRID,1,9,0.,0.,0.\n", "GRID: coordinate system 9 is on no card CORD1R ... CORD2S"),
    "a support": ("GRID,1,,0.,0.,0.,,123456\n", "GRID: 1 is held by PS = 123456; export the body free"),
    "a support by GRDSET": ("GRDSET,,,,,,,3\n" + GRID, "1 is held by PS = 3"),
    "a superelement": ("GRID,1,,0.,0.,0.,,,2\n", "1 is of superelement 2"),
    "a circle of systems": (
        "CORD2R,1,2,0.,0.,0.,0.,0.,1.\n,1.,0.,0.\nCORD2R,2,1,0.,0.,0.,0.,0.,1.\n,1.,0.,0.\nGRID,1,1,0.,0.,0.\n",
        "coordinate system 1 depends on itself",
    ),
    "a system of its own points": ("CORD1R,1,1,2,3\nGRID,1,1,0.,0.,0.\n", "system 1 depends on itself"),
    "a thousand systems": (
        "".join(f"CORD2R,{i},{i + 1},0.,0.,0.,0.,0.,1.\n,1.,0.,0.\n" for i in range(1, 1000)) + "GRID,1,1\n",
        "or on more than 50 others",
    ),
    "points on a line": ("CORD2R,1,,0.,0.,0.,0.,0.,1.\n,0.,0.,2.\nGRID,1,1,0.,0.,0.\n", "lie on one line"),
    "a system of unknown points": ("CORD1R,1,7,8,9\nGRID,1,1,0.,0.,0.\n", "there is no GRID '7'"),
    "repeated cards": (GRID + "=,*1,=,*0.2,==\n=3\n", "line 2: cards repeated by = are not read"),
    "decimal commas": ("GRID           1             0,0     0,5     0,1\n", "fields out of their columns"),
    "a decimal comma in a continuation": (
        "GRID*                  1                             0.0             0.0\n*                  0,08\n",
        "decimals with commas",
    ),
    "decimal commas in a small continuation": (
        "CORD2R         3             0.0     0.0     0.0     1.0     0.0     0.0\n           0,0   1,0\n",
        "decimals with commas",
    ),
    "tabs": ("GRID\t1\t\t-1234.5678\t0.5\t0.\n", "out of their columns of 8 or 16, tabs, or decimals"),
    "tabs in a continuation": ("CORD2R,3,,0.,0.,0.,1.,0.,0.\n\t0.\t1.\t0.\n", "line 2: fields out of"),
    "two defaults": (CORD2R + "GRDSET,,3\nGRDSET,,0\n" + GRID, "line 4: GRDSET: it differs from the one on"),
    "two systems of a number": (
        CORD2R + CORD2R.replace("1.,0.\n", "2.,3.\n") + GRID, "CORD2R: it differs from the one on line 1",
    ),
    "fields by blanks": ("GRID 1 0 0.5 0. 0.\n", "fields out of their columns"),
    "itself": ("INCLUDE 'x'\n", "x, line 1: x includes itself"),
    "an open quote": ("INCLUDE 'x\n" + GRID, "line 1: the file included here"),
    "no file": ("INCLUDE\n", "line 1: the file included here"),
}  # fmt: skip


@pytest.mark.parametrize("case", REFUSED_GRIDS)
def test_fields_that_are_not_read_are_refused_by_their_names(tmp_path, case):
    text, message = REFUSED_GRIDS[case]
    (tmp_path / "x").write_text(text)
    with pytest.raises(FEFileFault) as refused:
        read_node_table(tmp_path / "x", "BDF")
    assert message in str(refused.value)


def test_nothing_behind_enddata_counts(tmp_path):
    (tmp_path / "x").write_text(bdf_nodes() + "ENDDATA\nGRID,99,,1.,1.,1.\n")
    assert read_node_table(tmp_path / "x", "BDF").numbers.tolist() == list(range(1, 17))


def test_surfaces_and_masses_beside_solid_elements_are_left_out_with_a_warning(tmp_path):
    text = bdf_nodes() + bdf_elements() + "CTRIA3,50,1,1,2,3\nCTRIA3,51,1,2,4,3\nCONM2,52,1,,5.\nCGAP,53\n"
    _, warnings = by_elements(tmp_path, "BDF", text)
    assert warnings[0].startswith("mesh holds other elements, too (1 CGAP, 1 CONM2, 2 CTRIA3)")


COMMANDS = "".join(f"N,{n},{x!r},{y!r},{z!r}\n" for n, (x, y, z) in enumerate(POINTS, 1))
SAME_ARCHIVES = {
    "two blocks": "/PREP7\n" + nblock(1, 8) + nblock(9, 16),
    "three blocks, the last ones ended by -1": nblock(1, 4)
    + (nblock(5, 10) + nblock(11, 16)).replace("N,R5.3,LOC,       -1,", "       -1"),
    "a block and commands": nblock(1, 8) + "".join(COMMANDS.splitlines(keepends=True)[8:]),
    "commands": "n,1,0,0,0 ! the first\n" + COMMANDS.partition("\n")[2].replace(",0,", ",,"),
    "commands of CDWRITE": "".join(
        f"N,R5.3,LOC,{n:8d},{x!r},{y!r},{z!r}\nN,R5.3,ANG,{n:8d},0,0,0\n"
        for n, (x, y, z) in enumerate(POINTS, 1)
    ) + "N,R5.3,LOC,       -1,\n",
    "blank lines in a block": nblock().replace("\n        5", "\n\n        5"),
    "a local system that is left again": "LOCAL,11,1,0,0,0\nCSYS,0\n" + nblock(),
    "a local system of CDWRITE": "LOCAL,R5.0,LOC, 11,0,0.1,0,0\n" + nblock(),
}  # fmt: skip


@pytest.mark.parametrize("case", SAME_ARCHIVES)
def test_the_bar_by_other_commands(tmp_path, case):
    body = by_matrices(tmp_path, "CDB", SAME_ARCHIVES[case])
    assert body.m == pytest.approx(MASS, rel=1e-6)
    assert body.frequencies == pytest.approx(OF_MATRICES, rel=1e-6)


REFUSED_ARCHIVES = {
    "generated nodes": ("N,1,0,0,0\nNGEN,5,1,1,,,0.1\n", "line 2: NGEN makes or changes nodes or elements"),
    "filled nodes": ("N,1,0,0,0\nfill,1,5\n", "line 2: FILL makes or changes nodes or elements"),
    "an input file": ("/INPUT,nodes,inp\n", "line 1: /INPUT makes or changes nodes or elements"),
    "turned nodes": ("N,1,0,0,0\nNROTAT,ALL\n", "NROTAT makes or changes nodes or elements"),
    "scaled nodes": (nblock() + "NSCALE,,ALL,,,1e-3,1e-3,1e-3\n", "NSCALE makes or changes nodes"),
    "turned axes": ("N,R5.3,LOC,1,0,0,0\nN,R5.3,ANG,1,90,0,0\n", "line 2: the axes of node 1 are rotated"),
    "turned axes of N": ("N,1,0,0,0,90\n", "the axes of node 1 are rotated"),
    "a cylindrical system": ("CSYS,1\nN,1,1,90,0\n", "nodes in the coordinates of CSYS,1; write the archive"),
    "a local system": ("LOCAL,11,1,0,0,0\n" + nblock(), "nodes in the coordinates of LOCAL,11"),
    "a node without number": ("N,,0,0,0\n", "line 1: expected id x y z"),
    "decimal commas": ("N,1,0,5,0,0,0,1\n", "the axes of node 1 are rotated"),
    "a block cut off": (nblock()[:800], "NBLOCK does not end with -1; is the file cut off?"),
    "a block without a format": ("NBLOCK,6,SOLID", "x, line 2: a format such as"),
}  # fmt: skip


@pytest.mark.parametrize("case", REFUSED_ARCHIVES)
def test_commands_that_are_not_read_are_refused_by_their_names(tmp_path, case):
    text, message = REFUSED_ARCHIVES[case]
    (tmp_path / "x").write_text(text)
    with pytest.raises(FEFileFault) as refused:
        read_node_table(tmp_path / "x", "CDB")
    assert message in str(refused.value)


NUMBERED = list(enumerate(BRICKS, 1))


def test_several_element_blocks_are_read(tmp_path):
    (tmp_path / "x").write_text(nblock() + eblock(NUMBERED[:1]) + eblock(NUMBERED[1:]))
    assert read_elements(tmp_path / "x", "CDB").nodes.tolist() == BRICKS


@pytest.mark.parametrize("more, named", [
    ("ET,2,154\n" + eblock([(9, [1, 2, 4, 3])], type=2), "1 surface elements"),
    ("et,2,SURF154\n" + eblock([(9, [1, 2, 4, 3])], type=2), "1 surface elements"),
    (eblock([(9, [1, 2, 4, 3])], key=""), "1 of EBLOCK without SOLID"),
])  # fmt: skip
def test_surface_elements_of_an_archive_are_left_out(tmp_path, more, named):
    (tmp_path / "x").write_text("ET,1,185\n" + more + nblock() + eblock(NUMBERED))
    found = read_elements(tmp_path / "x", "CDB")
    assert found.nodes.tolist() == BRICKS and found.left_out == named


@pytest.mark.parametrize("line", ["EN,5,1,2,3,4", "E,1,2,3,4,5,6,7,8", "EGEN,3,4,1", "/INPUT,x"])
def test_elements_by_other_commands_are_refused(tmp_path, line):
    (tmp_path / "x").write_text(nblock() + eblock(NUMBERED) + line + "\n")
    with pytest.raises(FEFileFault, match="makes or changes nodes or elements, and is not read"):
        read_elements(tmp_path / "x", "CDB")


TEXTS = {
    "a decimal comma": ("1 0 0 0\n2 0 0 0,08\n", "expected id x y z; read '2 0 0 0,08'; write decimals"),
    "a list in cylindrical coordinates": (
        " LIST ALL SELECTED NODES.   DSYS=      1\n 1 1. 90. 0.\n", "list the nodes after DSYS,0",
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", TEXTS)
def test_plain_tables_that_cannot_be_read(tmp_path, case):
    (tmp_path / "x").write_text(TEXTS[case][0])
    with pytest.raises(FEFileFault) as refused:
        read_node_table(tmp_path / "x", "TXT")
    assert TEXTS[case][1] in str(refused.value)


def test_no_node_is_lost_to_the_mark_of_utf8(tmp_path):
    """The first line of a file of Windows' editor was taken for a heading."""
    (tmp_path / "x").write_text("\ufeff1 1. 2. 3.\n2 0. 0. 0.\n", encoding="utf-8")
    assert read_node_table(tmp_path / "x", "TXT").numbers.tolist() == [1, 2]


def test_a_list_in_global_coordinates_is_read(tmp_path):
    (tmp_path / "x").write_text(" LIST ALL SELECTED NODES.   DSYS=      0\n 1 1. 90. 0.\n")
    assert read_node_table(tmp_path / "x", "TXT").positions.tolist() == [[1.0, 90.0, 0.0]]
