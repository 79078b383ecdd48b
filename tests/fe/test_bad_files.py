"""Files of finite-element programs that cannot be used, and what is said of them: exact messages."""

import pytest

from flexmb_cli.fe.formats.formats import read_matrix
from flexmb_cli.fe.formats.matrix_file import FEFileFault
from flexmb_cli.fe.formats.node_table import read_node_table

MM = "%%MatrixMarket matrix coordinate real symmetric\n"
HB = (
    "title".ljust(72) + "STIFF\n"
    "             7             3             2             2             0\n"
    "RSA                        2             2             2             0\n"
    "(1I14)          (1I14)          (1D25.15)\n"
    "             1\n             2\n             3\n"
    "             1\n             2\n"
    "    1.000000000000000D+00\n    2.000000000000000D+00\n"
)
MAPPING = "  Matrix Eqn  Node  DOF\n  1  1  UX\n  2  1  UY\n"
DMIG_HEAD = "DMIG    KAAX           0       6       2       0\n"
DMIG_COLUMN = "DMIG*   KAAX                           1               1\n"
OP4 = "       1       1       6       2KAA     1P,3E23.16\n"

MATRICES = [
    ("MM", "", "x, line 1: a Matrix Market file begins with %%MatrixMarket; is the format another?"),
    (
        "MM",
        "1,1,1,1,2.0\n",
        "x, line 1: a Matrix Market file begins with %%MatrixMarket; is the format another?",
    ),
    (
        "MM",
        "%%MatrixMarket matrix coordinate complex symmetric\n",
        "x, line 1: the matrix must be real; this one is complex",
    ),
    (
        "MM",
        "%%MatrixMarket matrix coordinate real skew-symmetric\n",
        "x, line 1: the matrix must be symmetric or general; this one is skew-symmetric",
    ),
    (
        "MM",
        "%%MatrixMarket vector coordinate real general\n",
        "x, line 1: expected %%MatrixMarket matrix coordinate|array real general|symmetric",
    ),
    ("MM", MM + "% no size\n", "x ends before the line of its size"),
    ("MM", MM + "3 4 1\n1 1 1.0\n", "x, line 2: the matrix must be square; it has 3 rows, 4 columns"),
    ("MM", MM + "3 3 2\n1 1 1.0\n", "x announces 2 entries and holds 1; was it cut off, or edited?"),
    ("MM", MM + "3 3 1\n1 4 1.0\n", "x, line 3: entry (1, 4) lies outside the matrix of 3 rows"),
    (
        "MM",
        MM + "3 3 1\n1 2 1.0\n",
        "x, line 3: an entry above the diagonal, while the file declares a lower triangle",
    ),
    (
        "MM",
        MM + "3 3 1\n1 1 1.O\n",
        "x, line 3: expected row, column and value; '1.O' is not a finite number",
    ),
    (
        "MM",
        MM + "3 3 1\n1 1 nan\n",
        "x, line 3: expected row, column and value; 'nan' is not a finite number",
    ),
    ("MM", MM + "3 3 1\n1 1\n", "x, line 3: expected row, column and value, 3 numbers; read '1 1'"),
    ("MM", MM + "3 3 1\n1.5 1 2.0\n", "x, line 3: row and column must be whole numbers"),
    ("HB", "too short\n", "x ends before the fourth line of a Harwell-Boeing heading"),
    (
        "HB",
        HB.replace("RSA", "CSA"),
        "x, line 3: the matrix is of type CSA; expected RSA (symmetric) or RUA, assembled and real",
    ),
    (
        "HB",
        HB.replace(
            "RSA                        2             2", "RSA                        3             3"
        ),
        "x, lines 5-7: expected 4 numbers, read 3 in fields of 14 columns (line 4)",
    ),
    ("HB", HB[:-26], "x ends at line 10, 1 lines too early"),
    (
        "HB",
        HB.replace("1.000000000000000D+00", "1.000000000000000X+00"),
        "x, line 10: '1.000000000000000X+00' is not a number; fields are 25 columns wide by the format of "
        "line 4: are they wider or narrower here?",
    ),
    ("HB", HB.replace("(1I14)", "(none)", 1), "x, line 4: no FORTRAN format in '(none)'"),
    (
        "HB",
        HB.replace("\n             3\n", "\n             9\n"),
        "x: the column pointers do not add up to 2 entries",
    ),
    ("CCX", "", "x is empty"),
    ("CCX", "1 1 2.0\n1 0 2.0\n", "x, line 2: entry (1, 0) lies outside the matrix of 1 rows"),
    ("CCX", "1 1 2.0\n", "x has 1 rows and the mapping map 2"),
    ("ABQ", "** only a comment\n", "x holds no entries"),
    ("ABQ", MM, "x, line 1: this is a Matrix Market file: the format is MM"),
    (
        "ABQ",
        "1,1, 1,1, 1e36\n",
        "x: 1e+36 at node 1, direction 1, is a boundary condition; generate the matrices without *BOUNDARY",
    ),
    (
        "ABQ",
        "1,7, 1,1, 2.0\n",
        "x: direction 7 of node 1 is neither a translation nor a rotation (1 to 6): "
        "export a mechanical model",
    ),
    (
        "ABQ",
        "1,1, 1,1\n",
        "x, line 1: expected row node, row direction, column node, column direction, value, or row, column, "
        "value, by commas or blanks",
    ),
    (
        "ABQ",
        "** comment\n1,1, 1,1, 2.0\n** comment\n1,1, x,1, 2.0\n",
        "x, line 4: expected row node, direction, column node, direction, value; 'x' is not a finite number",
    ),
    ("DMIG", "GRID, 1,, 0., 0., 0.\n", "x holds no DMIG card"),
    ("DMIG", DMIG_COLUMN, "x, line 1: DMIG KAAX begins without its header card"),
    (
        "DMIG",
        DMIG_HEAD.replace("6", "9"),
        "x, line 1: DMIG KAAX has form 9; expected 6 (symmetric) or 1 (square)",
    ),
    (
        "DMIG",
        DMIG_HEAD.replace("       2       0", "       4       0"),
        "x, line 1: DMIG KAAX is complex; it must be real",
    ),
    (
        "DMIG",
        DMIG_HEAD + DMIG_COLUMN + "*                      1               7 1.0\n",
        "x, line 2: component 7 of point 1: expected 1 to 6, or 0 at a scalar point",
    ),
    (
        "DMIG",
        DMIG_HEAD.replace("KAAX", "AAAX") + DMIG_HEAD.replace("KAAX", "BAAX"),
        "x holds AAAX, BAAX: no K among them is meant; name a square real one on a card FEMX",
    ),
    ("OP4", "", "x is empty"),
    (
        "OP4",
        "not a heading\n",
        "x, line 1: expected columns, rows, form, type, name and format of an OP4 text matrix",
    ),
    (
        "OP4",
        OP4.replace("       1       1", "       1       2"),
        "x, line 1: the matrix must be square; it has 2 rows, 1 columns",
    ),
    ("OP4", OP4.replace("       2KAA", "       4KAA"), "x, line 1: the matrix is complex; it must be real"),
    (
        "OP4",
        OP4 + "       1       1       1\n 1.0\n",
        "x, line 4: expected column, first row and words; was the file cut off?",
    ),
]


@pytest.mark.parametrize("form, text, message", MATRICES)
def test_matrix_files_that_cannot_be_read(tmp_path, form, text, message):
    (tmp_path / "x").write_text(text)
    (tmp_path / "map").write_text(MAPPING if form == "HB" else "1.1\n1.2\n")
    kinds = {"HB": "ANS", "CCX": "CCX"}
    with pytest.raises(FEFileFault) as stopped:
        read_matrix(tmp_path / "x", form, "K", tmp_path / "map", kinds.get(form, ""))
    assert str(stopped.value) == message


MAPPINGS = [
    ("HB", "ANS", "nothing here\n", "map holds no line 'equation node UX|...|ROTZ'; is it the mapping file?"),
    (
        "HB",
        "ANS",
        "1 1 UX\n2 1 TEMP\n",
        "map, line 2: degree of freedom TEMP of node 1: only UX to ROTZ can be used. How mappings label "
        "modal coordinates of substructures is not published: "
        "condense without modes, or export the full model",
    ),
    ("HB", "ANS", "1 1 UX\n3 1 UY\n", "map maps 2 equations, but not equation 2"),
    ("HB", "CCX", "1.1\n", "format HB needs the equation mapping: add a card FEMP of format ANS"),
    (
        "CCX",
        "CCX",
        "1.1\n1.4\n",
        "map, line 2: direction 4 of node 1: only 1, 2, 3 can be used, no rotations",
    ),
    ("CCX", "CCX", "1.1\n12\n", "map, line 2: expected node.direction, such as 12.3; read '12'"),
    ("CCX", "CCX", "", "map is empty"),
]


@pytest.mark.parametrize("form, kind, text, message", MAPPINGS)
def test_mappings_that_cannot_be_used(tmp_path, form, kind, text, message):
    (tmp_path / "x").write_text("")
    (tmp_path / "map").write_text(text)
    with pytest.raises(FEFileFault) as stopped:
        read_matrix(tmp_path / "x", form, "K", tmp_path / "map", kind)
    assert str(stopped.value) == message


NODES = [
    ("TXT", "# nothing\n", "x holds no nodes in format TXT"),
    ("TXT", "1 0 0 0\n2 1 0 0\n1 0 0 1\n", "x: node 1 stands on lines 1 and 3"),
    ("TXT", "1 0 zero 0\n", "x, line 1: expected id x y z; read '1 0 zero 0'"),
    (
        "TXT",
        "NODE X Y Z THXY THYZ THZX\n1 0 0 0 0 0 0\n2 1 0 0 90 0 0\n",
        "x, line 3: the axes of node 2 are rotated; matrices in rotated nodal axes cannot be used",
    ),
    ("TXT", "1 0 inf 0\n", "x, line 1: the position of node 1 is not finite"),
    ("INP", "*NODE PRINT\n1, 0, 0, 0\n", "x holds no nodes in format INP"),
    ("INP", "*NODE\n1, a, 0, 0\n", "x, line 2: expected id x y z; read '1 a 0 0'"),
    ("CDB", "NBLOCK,6,SOLID\nno format\n", "x, line 2: a format such as (3i9,6e20.13) must follow NBLOCK"),
    (
        "CDB",
        "NBLOCK,6,SOLID\n(3i9,6e20.13)\n        1        0        0 0.0000X\n",
        "x, line 3: expected a line of NBLOCK; read '1        0        0 0.0000X'",
    ),
    (
        "BDF",
        "GRID, 1, 5, 0., 0., 0.\n",
        "x, line 1: GRID: coordinate system 5 is on no card CORD1R ... CORD2S; add it",
    ),
    ("BDF", "GRID,,, 0., 0., 0.\n", "x, line 1: GRID: expected the number of the point; read ''"),
]


@pytest.mark.parametrize("form, text, message", NODES)
def test_node_tables_that_cannot_be_used(tmp_path, form, text, message):
    (tmp_path / "x").write_text(text)
    with pytest.raises(FEFileFault) as stopped:
        read_node_table(tmp_path / "x", form)
    assert str(stopped.value) == message


def test_a_missing_file_is_named_with_its_folder(tmp_path):
    with pytest.raises(FEFileFault) as stopped:
        read_node_table(tmp_path / "none.txt", "TXT")
    assert str(stopped.value) == f"none.txt: no such file in {tmp_path}"


def test_a_binary_file_is_refused(tmp_path):
    (tmp_path / "job.full").write_bytes(b"\x00\x01\x02")
    with pytest.raises(FEFileFault) as stopped:
        read_matrix(tmp_path / "job.full", "MM", "K")
    assert str(stopped.value) == "job.full is a binary file; let the program write it as text"
