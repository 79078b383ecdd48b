"""Nodes coupled rigidly or in the mean, as Nastran, CalculiX and Abaqus write them.

Expected: the nodes of the cards, by MSC Nastran's and Abaqus' manuals.
"""

import pytest

from flexmb_cli.fe.formats.couplings import read_coupling
from flexmb_cli.fe.formats.matrix_file import FEFileFault

RBE2 = "RBE2           7     900  123456       1       2       3       4       5\n               6  1.2E-5\n"
RBE3 = "RBE3,8,,901,123456,1.0,123,1,2\n,3,2.5,123,4,ALPHA,1.E-5\n"
NSET = "*NODE, NSET=END\n1, 0, 0, 0\n2, 1, 0, 0\n*NSET, NSET=ODD, GENERATE\n1, 5, 2\n"
RIGID = NSET + "*RIGID BODY, NSET=odd, REF NODE=900, ROT NODE=902\n"
KINEMATIC = NSET + "*KINEMATIC COUPLING, REF NODE=900\nODD, 1, 3\n8, 1, 3\n"
MEAN = NSET + "*ELEMENT, TYPE=DCOUP3D, ELSET=E1\n77, 901\n*DISTRIBUTING COUPLING, ELSET=E1\nODD, 2.\n8\n"
READ = {
    "RBE2": ("BDF", RBE2, 900, True, (1, 2, 3, 4, 5, 6), (1.0,) * 6, True),
    "two RBE2": ("BDF", RBE2 + "RBE2,9,900,123456,8\n", 900, True, (1, 2, 3, 4, 5, 6, 8), (1.0,) * 7, True),
    "RBE2 without rotations": ("BDF", "RBE2,9,900,123,8\n", 900, True, (8,), (1.0,), False),
    "RBE3": ("BDF", RBE2 + RBE3, 901, False, (1, 2, 3, 4), (1.0, 1.0, 1.0, 2.5), False),
    "*RIGID BODY": ("INP", RIGID, 900, True, (1, 3, 5), (1.0,) * 3, True),
    "PIN NSET": ("INP", RIGID.replace("NSET=odd", "PIN NSET=END"), 900, True, (1, 2), (1.0,) * 2, False),
    "*KINEMATIC COUPLING": ("INP", KINEMATIC, 900, True, (1, 3, 5, 8), (1.0,) * 4, False),
    "*DISTRIBUTING COUPLING": ("INP", MEAN, 901, False, (1, 3, 5, 8), (2.0, 2.0, 2.0, 1.0), False),
}  # fmt: skip


@pytest.mark.parametrize("case", READ)
def test_couplings_are_read(tmp_path, case):
    form, text, node, rigid, members, weights, turns = READ[case]
    (tmp_path / "x").write_text(text)
    coupling = read_coupling(tmp_path / "x", form, node, rigid)
    assert (coupling.members, coupling.weights, coupling.turns) == (members, weights, turns)


REFUSED = {
    "another node": ("BDF", RBE2, 5, True, "couples no nodes to node 5"),
    "a mean asked for as rigid": ("BDF", RBE3, 901, True, "couples no nodes to node 901"),
    "a table of text": ("TXT", "1 0 0 0\n", 900, True, "files of format TXT have no couplings"),
    "components that leave one out": ("BDF", "RBE2,9,900,12,8\n", 900, True, "components 12: expected 123456 or 123"),  # noqa: E501
    "dependent points": ("BDF", RBE3.replace("ALPHA", "UM"), 901, False, "UM are not read"),
    "with and without rotations": ("BDF", RBE2 + "RBE2,9,900,123,8\n", 900, True, "rotations and without"),
    "elements": ("INP", RIGID.replace("NSET=odd", "ELSET=E"), 900, True, "option ELSET of .RIGID BODY"),
    "no set": ("INP", RIGID.replace("NSET=odd, ", ""), 900, True, "expected one set of nodes"),
    "a surface": ("INP", "*COUPLING, REF NODE=900, SURFACE=S\n*KINEMATIC\n", 900, True, "surfaces of"),
    "one direction": ("INP", KINEMATIC.replace("8, 1, 3", "8, 1"), 900, True, "directions 1 to 6, or 1 to 3"),
    "an unknown set": ("INP", KINEMATIC.replace("ODD, 1", "EVEN, 1"), 900, True, "no node set EVEN"),
}  # fmt: skip


@pytest.mark.parametrize("case", REFUSED)
def test_couplings_that_cannot_be_used_are_refused(tmp_path, case):
    form, text, node, rigid, words = REFUSED[case]
    (tmp_path / "x").write_text(text)
    with pytest.raises(FEFileFault, match=words):
        read_coupling(tmp_path / "x", form, node, rigid)
