"""Nodes of Abaqus input files that are generated, included, in local systems or moved: those of the bar.

Meaning of the cards: Abaqus Keywords Reference Guide; masses and frequencies: bars.py.
"""

import math
import time

import numpy as np
import pytest

from flexmb_cli.fe.flexible_bodies import key_of
from flexmb_cli.fe.formats.connectivity import read_elements
from flexmb_cli.fe.formats.matrix_file import FEFileFault
from flexmb_cli.fe.formats.node_table import read_node_table
from flexmb_cli.model.flexible_body import FEFile, FlexibleInput
from tests.fe.formats.bars import (
    FULLY_INTEGRATED,
    MASS,
    OF_MATRICES,
    POINTS,
    by_elements,
    by_matrices,
    inp_elements,
    inp_nodes,
    refusal,
)

ENDS = "*NODE\n" + inp_nodes(1, 4) + inp_nodes(13, 16)
NGEN = "*NGEN\n1,13,4\n2,14,4\n3,15,4\n4,16,4\n"


def in_system(shape, values):
    return f"*Node, nset=all, System={shape}\n" + "".join(
        f"{n}, {', '.join(map(repr, map(float, row)))}\n" for n, row in enumerate(values, 1)
    )


def cylindrical(point):
    x, y, z = point
    return math.hypot(x, y), math.degrees(math.atan2(y, x)), z


def spherical(point):
    """R, theta about z, phi above the plane of x and y, as in *NMAP, TYPE=SPHERICAL."""
    x, y, z = point
    return (
        np.linalg.norm(point),
        math.degrees(math.atan2(y, x)),
        math.degrees(math.atan2(z, math.hypot(x, y))),
    )


SAME = {
    "the lines between": ENDS + NGEN,
    "lines with the last step left out": "*NODE\n" + inp_nodes(1, 1) + inp_nodes(16, 16) + "*NODE\n"
    + inp_nodes(2, 15) + "*NSET, NSET=A, GENERATE\n1,16,1\n",
    "lines backwards": ENDS + "*NGEN, NSET=middle\n13,1,-4\n14,2,-4\n15,3,-4\n16,4,-4\n",
    "sets of nodes, filled": "*NODE, NSET=A\n" + inp_nodes(1, 4) + "*NODE, NSET=b\n" + inp_nodes(13, 16)
    + "*NFILL\na, B, 3, 4\n",
    "sets by *NSET": ENDS + "*NSET, NSET=A, GENERATE\n1,4,1\n*nset, nset=B\n16,15,\n14,13\n*NFILL\nA,B,3,4\n",
    "sides generated, then filled": ENDS + "*NGEN\n1,13,4\n2,14,4\n*NSET, NSET=A\n1,2,3,4\n*NSET, NSET=B\n"
    "13,14,15,16\n*NFILL\nA,B,3,4\n",
    "a cylindrical system": in_system("C", map(cylindrical, POINTS)),
    "a spherical system": in_system("s", map(spherical, POINTS)),
    "a system moved": "*SYSTEM\n1., 2., 3.\n*NODE\n"
    + inp_nodes(points=[(x - 1, y - 2, z - 3) for x, y, z in POINTS]),
    "a system turned, its z axis kept": "*SYSTEM\n0,0,0, 0,5,0\n*NODE\n"
    + inp_nodes(points=[(y, -x, z) for x, y, z in POINTS]),
    "a system of three points": "*SYSTEM\n0,0,0, 0,0,2\n0,-1,3\n*NODE\n"
    + inp_nodes(points=[(z, -y, x) for x, y, z in POINTS]),
    "a cylinder about a moved axis": "*SYSTEM\n0.5,0,0\n"
    + in_system("C", [cylindrical((x - 0.5, y, z)) for x, y, z in POINTS]),
    "the global system again": "*SYSTEM\n1,1,1\n*SYSTEM\n*NODE\n" + inp_nodes(),
    "an instance moved": "*PART, NAME=p\n*NODE\n"
    + inp_nodes(points=[(x - 2, y, z + 1) for x, y, z in POINTS])
    + "*END PART\n*ASSEMBLY, NAME=A\n*INSTANCE, NAME=p-1, PART=P\n2,0,-1\n*END INSTANCE\n*END ASSEMBLY\n",
    "an instance turned by -90 degrees about x": "*PART, NAME=p\n*NODE\n"
    + inp_nodes(points=[(x, -z, y) for x, y, z in POINTS])
    + "*END PART\n*INSTANCE, NAME=p-1, PART=p\n0,0,0\n0,0,0, 1,0,0, -90\n*END INSTANCE\n",
    "generated nodes of an instance": "*PART, NAME=p\n*NODE\n"
    + inp_nodes(1, 4, [(x - 2, y, z) for x, y, z in POINTS])
    + inp_nodes(13, 16, [(x - 2, y, z) for x, y, z in POINTS])
    + NGEN + "*INSTANCE, NAME=p-1, PART=p\n2.\n*END INSTANCE\n",
    "keywords continued around a comment": "*NODE,\n** text\nNSET=ALL\n" + inp_nodes(),
    "the mark of UTF-8": "\ufeff*NODE\n" + inp_nodes(),
    "keywords continued and indented": "  *Node ,\n  nset = ALL,\n System = R\n" + inp_nodes(),
}  # fmt: skip


@pytest.mark.parametrize("case", SAME)
def test_the_bar_by_other_cards(tmp_path, case):
    (tmp_path / "x").write_text(SAME[case], encoding="utf-8")
    found = read_node_table(tmp_path / "x", "INP")
    order = np.argsort(found.numbers)
    assert found.numbers[order].tolist() == list(range(1, 17))
    np.testing.assert_allclose(found.positions[order], POINTS, rtol=0, atol=1e-14)
    body = by_matrices(tmp_path, "INP", SAME[case])
    assert body.m == pytest.approx(MASS, rel=1e-6)
    assert body.frequencies == pytest.approx(OF_MATRICES, rel=1e-6)


def test_an_arc_in_cylindrical_coordinates(tmp_path):
    """27.1999 kg; 1161.6491, 1307.1814, 1591.6444 Hz: own bricks, `scipy.linalg.eigh`."""
    nodes = [(r, 10 + 24 * i, z) for i in range(4) for r in (0.8, 0.92) for z in (0.0, 0.08)]
    text = in_system("C", nodes) + "*ELEMENT, TYPE=C3D8\n1,1,3,7,5,2,4,8,6\n2,5,7,11,9,6,8,12,10\n"
    body, _ = by_elements(tmp_path, "INP", text + "3,9,11,15,13,10,12,16,14\n")
    assert body.m == pytest.approx(27.1999, abs=5e-5)
    assert body.frequencies == pytest.approx([1161.6491, 1307.1814, 1591.6444], rel=1e-7)


def test_an_instance_moved_and_turned_about_a_line_off_the_origin(tmp_path):
    """By 2 m along x, then by 180 degrees about x = 2, z = 0: x -> 4 - (x + 2), z -> -z."""
    text = (
        "*Part, name=bar\n*NODE\n" + inp_nodes() + "*End Part\n*Instance, name=bar-1, part=bar\n 2., 0., 0.\n"
    )
    (tmp_path / "x").write_text(text + " 2., 0., 0., 2., 1., 0., 180.\n*End Instance\n")
    found = read_node_table(tmp_path / "x", "INP").positions
    np.testing.assert_allclose(found, [(2 - x, y, -z) for x, y, z in POINTS], atol=1e-15)


def included(folder, how):
    """The bar with nodes and elements in other files, below `parts`."""
    (folder / "parts").mkdir()
    (folder / "parts" / "nodes.inp").write_text(inp_nodes() if "INPUT of" in how else "*NODE\n" + inp_nodes())
    (folder / "parts" / "mesh.inp").write_text("*INCLUDE, INPUT=nodes.inp\n" + inp_elements())
    (folder / "elements.inp").write_text(inp_elements().partition("\n")[2])
    return {
        "nested": "*Heading\n** text\n*Include, Input=parts/mesh.inp\n",
        "quoted and continued": '*INCLUDE,\n input = "parts\\nodes.inp"\n' + inp_elements(),
        "INPUT of *NODE and *ELEMENT": "*NODE, INPUT=parts/nodes.inp, NSET=N\n"
        "*ELEMENT, TYPE=C3D8, ELSET=E, INPUT=elements.inp\n",
    }[how]


@pytest.mark.parametrize("how", ["nested", "quoted and continued", "INPUT of *NODE and *ELEMENT"])
def test_files_that_are_included_belong_to_the_mesh(tmp_path, how):
    body, warnings = by_elements(tmp_path, "INP", included(tmp_path, how))
    assert not warnings and body.m == pytest.approx(MASS, rel=1e-6)
    assert body.frequencies == pytest.approx(FULLY_INTEGRATED, rel=1e-6)


def test_a_change_of_an_included_file_is_another_body(tmp_path):
    (tmp_path / "x").write_text(included(tmp_path, "nested"))
    given = FlexibleInput(
        "b", FEFile(tmp_path / "x", "INP"), FEFile(tmp_path / "x", "INP"), np.arange(1), np.zeros((1, 3))
    )
    first = key_of(given)
    (tmp_path / "parts" / "mesh.inp").write_text("*INCLUDE, INPUT=nodes.inp\n" + inp_elements("C3D8I"))
    assert key_of(given) != first


BAR_1 = "*PART, NAME=p\n*NODE\n1,0,0,0\n*END PART\n"
REFUSED = {
    "copies": (ENDS + "*NCOPY, CHANGE NUMBER=4, OLD SET=A, SHIFT\n", "line 10: *NCOPY: it makes, moves"),
    "a map": (ENDS + "*NMAP, NSET=A, TYPE=RECTANGULAR\n", "*NMAP: it makes, moves or hides nodes"),
    "a file that a comma does not part": ("*INCLUDE INPUT=a\n", "line 1: *INCLUDE INPUT=A: it makes, moves"),
    "a revolved sector": (
        ENDS + "*SYMMETRIC MODEL GENERATION, REVOLVE\n", "line 10: *SYMMETRIC MODEL GENERATION: it makes",
    ),
    "nodes moved to a surface": (ENDS + "*ADJUST, NODE SET=A, SURFACE=B\n", "line 10: *ADJUST: it makes"),
    "turned axes": (ENDS + "*TRANSFORM, NSET=A\n1,1,0,0,1,0\n", "*TRANSFORM: matrices in turned nodal axes"),
    "a parabola": (ENDS + "*NGEN, LINE=P\n1,13,4,5\n", "line 10: the option LINE of *NGEN is not read"),
    "uneven lengths": (ENDS + "*NFILL, BIAS=0.5\nA,B,3,4\n", "the option BIAS of *NFILL is not read"),
    "an unknown option": ("*NODE, SYSTM=C\n1,0,0,0\n", "line 1: the option SYSTM of *NODE is not read"),
    "an unknown system": ("*NODE, SYSTEM=Q\n1,0,0,0\n", "SYSTEM=Q is unknown; expected R, C or S"),
    "an import": ("*INSTANCE, LIBRARY=old, NAME=p\n*END INSTANCE\n", "the option LIBRARY of *INSTANCE"),
    "an encrypted file": ("*INCLUDE, INPUT=a, PASSWORD=b\n", "line 1: *INCLUDE: it makes, moves"),
    "a file without a name": ("*INCLUDE\n", "line 1: *INCLUDE: it makes"),
    "two instances": (
        BAR_1 + 2 * "*INSTANCE, NAME=a, PART=p\n*END INSTANCE\n", "part P is not defined before, or has two",
    ),
    "a part without instance": (
        BAR_1 + BAR_1.replace("=p", "=q") + "*INSTANCE, NAME=a, PART=p\n", "part Q has no instance",
    ),
    "nodes of a moved instance": (
        BAR_1 + "*INSTANCE, NAME=a, PART=p\n1,0,0\n*NODE\n2,0,0,0\n", "line 7: nodes in a moved instance",
    ),
    "a rotation without an axis": (BAR_1 + "*INSTANCE, NAME=a, PART=p\n1\n1,1,1,1,1,1,5\n", "points of an"),
    "three points on a line": ("*SYSTEM\n0,0,0,1,1,1\n2,2,2\n*NODE\n1,0,0,0\n", "lie on one line"),
    "decimal commas": ("*NODE\n2, 0,5, 0,0, 0,0\n", "line 2: expected three coordinates with decimal points"),
    "a step of 0": (ENDS + "*NGEN\n1,13,0\n", "an increment of 0 does not lead from 1 to 13"),
    "a step the wrong way": (ENDS + "*NGEN\n1,13,-4\n", "an increment of -4 does not lead from 1 to 13"),
    "a step that misses": (ENDS + "*NGEN\n1,13,5\n", "an increment of 5 does not lead from 1 to 13"),
    "no numbers": (ENDS + "*NGEN\nA,B\n", "line 11: expected whole numbers; read 'A B'"),
    "an unknown end": (ENDS + "*NGEN\n1,99,1\n", "*NGEN: node 99 is not defined before"),
    "a billion nodes": ("*NODE\n1,0,0,0\n999999999,1,0,0\n*NGEN\n1,999999999\n", "more than 1000000 nodes"),
    "a billion in sets": (
        "*NSET, NSET=A, GENERATE\n1,999999999999\n*NFILL\nA,A,1,1\n", "more than 1000000 nodes are generated",
    ),
    "a billion intervals": (
        "*NODE, NSET=A\n1,0,0,0\n*NODE, NSET=B\n2,1,0,0\n*NFILL\nA,B,999999999,1\n", "more than 1000000",
    ),
    "sets of other lengths": (
        "*NODE, NSET=A\n1,0,0,0\n2,1,0,0\n*NODE, NSET=B\n3,1,1,0\n*NFILL\nA,B,2,1\n", "two sets of as many",
    ),
    "an unsorted set": (ENDS + "*NSET, NSET=A, UNSORTED\n1,2\n*NFILL\nA,A,2,1\n", "the option UNSORTED of"),
    "no set": (ENDS + "*NFILL\nA\n", "two sets of as many nodes, a number of intervals"),
    "another place of a node": (
        ENDS + "*NODE\n5,0,0,0\n" + NGEN, "node 5 stands on lines 11 and 13",
    ),
    "a file that is not there": ("*INCLUDE, INPUT=no.inp\n", "the file included here: no.inp: no such"),
    "an empty name": ("*INCLUDE, INPUT=\n", "x, line 1: the file included here: "),
    "a name that is none": ("*INCLUDE, INPUT=a\0b\n", "x"),
    "itself": ("*INCLUDE, INPUT=x\n", "x, line 1: x includes itself"),
    "a device": ("*INCLUDE, INPUT=/dev/zero\n", "zero is not a regular file"),
}  # fmt: skip


@pytest.mark.parametrize("case", REFUSED)
def test_what_is_not_read_is_refused_by_its_name(tmp_path, case):
    text, message = REFUSED[case]
    (tmp_path / "x").write_text(text)
    start = time.process_time()
    with pytest.raises(FEFileFault, match="x") as refused:
        read_node_table(tmp_path / "x", "INP")
    assert message in str(refused.value)
    assert time.process_time() - start < 2.0


def test_a_circle_of_files_is_refused(tmp_path):
    for name, other in ("xy", "yz", "zx"):
        (tmp_path / name).write_text(f"*INCLUDE, INPUT={other}\n")
    with pytest.raises(FEFileFault, match="z, line 1: x includes itself, at once or by other files"):
        read_node_table(tmp_path / "x", "INP")


def test_files_that_include_the_next_twice_do_not_grow_without_bound(tmp_path):
    for i in range(40):
        (tmp_path / f"x{i}").write_text(f"*INCLUDE, INPUT=x{i + 1}\n" * 5)
    with pytest.raises(FEFileFault, match="inclusions go beyond 10 files deep, 1000 files or 2 GB"):
        read_node_table(tmp_path / "x0", "INP")


FLAT = "*ELEMENT, type=T3D2, ELSET=Line1\n101, 1, 5\n*ELEMENT, type=CPS4, ELSET=Surface1\n102, 1, 2, 4, 3\n"


@pytest.mark.parametrize("more, named", [
    (FLAT, "(1 CPS4, 1 T3D2)"),
    ("*ELEMENT, TYPE=S3\n101,1,2,3\n102,2,3,4\n", "(2 S3)"),
    ("*ELEMENT, TYPE=S8R\n101,1,2,3,\n4,5,6,7,8\n", "(1 S8R)"),
    ("*ELEMENT, TYPE=M3D3\n7,1,2,3\n", "(1 M3D3)"),
])  # fmt: skip
def test_lines_and_surfaces_beside_solid_elements_are_left_out_with_a_warning(tmp_path, more, named):
    """As Gmsh writes them; frequencies of the bricks alone, bars.py."""
    body, warnings = by_elements(tmp_path, "INP", "*NODE\n" + inp_nodes() + inp_elements() + more)
    assert body.frequencies == pytest.approx(FULLY_INTEGRATED, rel=1e-6)
    assert warnings == [
        f"mesh holds other elements, too {named}; they have no part in the body, neither mass nor stiffness"
    ]


def test_surfaces_with_a_section_are_shells_and_refused(tmp_path):
    text = "*NODE\n" + inp_nodes() + inp_elements() + FLAT + "*SHELL SECTION, ELSET=surface1\n0.01\n"
    assert "line 24: elements of a section; only tetrahedra" in refusal(by_elements, tmp_path, "INP", text)[0]


HIDDEN = {
    "*ELGEN": (
        "*ELEMENT, TYPE=C3D8\n1,1,2,3,4,5,6,7,8\n*ELGEN\n1,3,4,1\n",
        "*ELGEN is not read; let a preprocessor write",
    ),
    "OFFSET": ("*ELEMENT, TYPE=C3D8, OFFSET=5\n", "the option OFFSET of *ELEMENT is not read"),
    "numbering": (
        "*ELEMENT, TYPE=C3D8, SOLID ELEMENT NUMBERING=FIDAP\n",
        "the option SOLID ELEMENT NUMBERING",
    ),
    "a mass": ("*ELEMENT, TYPE=MASS\n1,1\n", "stresses are computed for tetrahedra"),
}


@pytest.mark.parametrize("case", HIDDEN)
def test_elements_that_are_made_otherwise_are_refused(tmp_path, case):
    (tmp_path / "x").write_text(HIDDEN[case][0])
    with pytest.raises(FEFileFault) as refused:
        read_elements(tmp_path / "x", "INP")
    assert HIDDEN[case][1] in str(refused.value)
