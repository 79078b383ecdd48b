"""Files of finite-element programs that cannot be used, and what is said of them: exact messages."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from flexmb_cli.errors import ModelError, Place
from flexmb_cli.fe.flexible_bodies import flexible_body
from flexmb_cli.fe.formats.formats import read_matrix
from flexmb_cli.fe.formats.matrix_file import FEFileFault
from flexmb_cli.fe.formats.node_table import read_node_table
from flexmb_cli.model.flexible_body import FEFile
from tests.fe.trusses import files_input, truss

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
        "x, line 1: %%MatrixMarket matrix coordinate|array real general|symmetric wanted",
    ),
    ("MM", MM + "% no size\n", "x ends before the line of its size"),
    ("MM", MM + "3 4 1\n1 1 1.0\n", "x, line 2: the matrix must be square; it has 3 rows, 4 columns"),
    (
        "MM",
        MM + "3 3 2\n1 1 1.0\n",
        "x announces 2 entries and holds 1; was it cut off, or edited?",
    ),
    ("MM", MM + "3 3 1\n1 4 1.0\n", "x, line 3: entry (1, 4) lies outside the matrix of 3 rows"),
    (
        "MM",
        MM + "3 3 1\n1 2 1.0\n",
        "x, line 3: an entry above the diagonal, while the file declares a lower triangle",
    ),
    ("MM", MM + "3 3 1\n1 1 1.O\n", "x, line 3: row, column and value wanted; '1.O' is no finite number"),
    ("MM", MM + "3 3 1\n1 1 nan\n", "x, line 3: row, column and value wanted; 'nan' is no finite number"),
    ("MM", MM + "3 3 1\n1 1\n", "x, line 3: row, column and value wanted, 3 numbers; read '1 1'"),
    ("MM", MM + "3 3 1\n1.5 1 2.0\n", "x, line 3: row and column must be whole numbers"),
    ("HB", "too short\n", "x ends before the fourth line of a Harwell-Boeing heading"),
    (
        "HB",
        HB.replace("RSA", "CSA"),
        "x, line 3: the matrix is of type CSA; RSA (symmetric) or RUA, assembled and real, wanted",
    ),
    (
        "HB",
        HB.replace(
            "RSA                        2             2", "RSA                        3             3"
        ),
        "x has 3 rows and its mapping file 2 equations; they are of different models",
    ),
    ("HB", HB[:-26], "x ends at line 10, 1 lines too early"),
    (
        "HB",
        HB.replace("1.000000000000000D+00", "1.000000000000000X+00"),
        "x, line 10: '1.000000000000000X+00' is no number; fields are 25 columns wide by the format of line "
        "4: are they wider or narrower here?",
    ),
    ("HB", HB.replace("(1I14)", "(none)", 1), "x, line 4: no FORTRAN format in '(none)'"),
    (
        "HB",
        HB.replace("\n             3\n", "\n             9\n"),
        "x: the column pointers do not add up to 2 entries",
    ),
    ("CCX", "", "x is empty"),
    ("CCX", "1 1 2.0\n1 3 2.0\n", "x, line 2: entry (1, 3) lies outside the matrix of 2 rows"),
    (
        "CCX",
        "1 1 2.0\n",
        "x has 1 rows and its .dof file 2 equations; they are of different models",
    ),
    ("ABQ", "** only a comment\n", "x holds no entries"),
    ("ABQ", MM, "x, line 1: this is a Matrix Market file: the format is MM"),
    (
        "ABQ",
        "1,1, 1,1, 1e36\n",
        "x: 1e+36 at node 1, direction 1, is a boundary condition; generate the matrices without *BOUNDARY",
    ),
    (
        "ABQ",
        "1,4, 1,4, 2.0\n",
        "x: node 1 has rotations (direction 4 to 6); mesh with solid elements",
    ),
    (
        "ABQ",
        "1,1, 1,1\n",
        "x, line 1: row node, row direction, column node, column direction, value wanted, or row, column, "
        "value, by commas or blanks",
    ),
    (
        "ABQ",
        "** comment\n1,1, 1,1, 2.0\n** comment\n1,1, x,1, 2.0\n",
        "x, line 4: row node, direction, column node, direction, value wanted; 'x' is no finite number",
    ),
    ("DMIG", "GRID, 1,, 0., 0., 0.\n", "x holds no DMIG card"),
    ("DMIG", DMIG_COLUMN, "x, line 1: DMIG KAAX begins without its header card"),
    (
        "DMIG",
        DMIG_HEAD.replace("6", "9"),
        "x, line 1: DMIG KAAX has form 9; 6 (symmetric) or 1 (square) wanted",
    ),
    (
        "DMIG",
        DMIG_HEAD.replace("       2       0", "       4       0"),
        "x, line 1: DMIG KAAX is complex; real wanted",
    ),
    (
        "DMIG",
        DMIG_HEAD + DMIG_COLUMN + "*                      1               4 1.0\n",
        "x, line 2: grid point 1 has rotations (component 4); mesh with solid elements",
    ),
    (
        "DMIG",
        DMIG_HEAD
        + DMIG_COLUMN.replace("1               1", "1               0")
        + "*                      1               1 1.0\n",
        "x, line 2: scalar point 1 is a coordinate of a condensed model; full matrices are wanted",
    ),
    (
        "DMIG",
        DMIG_HEAD.replace("KAAX", "AAAX") + DMIG_HEAD.replace("KAAX", "BAAX"),
        "x holds the matrices AAAX, BAAX; exactly one must begin with K",
    ),
    ("OP4", "", "x is empty"),
    (
        "OP4",
        "not a heading\n",
        "x, line 1: columns, rows, form, type, name and format of an OP4 text matrix wanted",
    ),
    (
        "OP4",
        OP4.replace("       1       1", "       1       2"),
        "x, line 1: the matrix must be square; it has 2 rows, 1 columns",
    ),
    ("OP4", OP4.replace("       2KAA", "       4KAA"), "x, line 1: the matrix is complex; real wanted"),
    (
        "OP4",
        OP4 + "       1       1       1\n 1.0\n",
        "x, line 4: column, first row and words wanted; was the file cut off?",
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
    ("HB", "ANS", "nothing here\n", "map holds no line 'equation node UX|UY|UZ'; is it the mapping file?"),
    (
        "HB",
        "ANS",
        "1 1 UX\n2 1 ROTX\n",
        "map, line 2: freedom ROTX of node 1: only UX, UY, UZ can be used; mesh with solid elements",
    ),
    ("HB", "ANS", "1 1 UX\n3 1 UY\n", "map maps 2 equations, but not equation 2"),
    ("HB", "CCX", "1.1\n", "format HB needs the equation mapping: add a card FEMP of format ANS"),
    (
        "CCX",
        "CCX",
        "1.1\n1.4\n",
        "map, line 2: direction 4 of node 1: only 1, 2, 3 can be used, no rotations",
    ),
    ("CCX", "CCX", "1.1\n12\n", "map, line 2: node.direction wanted, such as 12.3; read '12'"),
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
    ("TXT", "1 0 zero 0\n", "x, line 1: id x y z wanted; read '1 0 zero 0'"),
    (
        "TXT",
        "NODE X Y Z THXY THYZ THZX\n1 0 0 0 0 0 0\n2 1 0 0 90 0 0\n",
        "x, line 3: the axes of node 2 are rotated; matrices in rotated nodal axes cannot be used",
    ),
    ("TXT", "1 0 inf 0\n", "x, line 1: the position of node 1 is not finite"),
    ("INP", "*NODE PRINT\n1, 0, 0, 0\n", "x holds no nodes in format INP"),
    ("INP", "*NODE\n1, a, 0, 0\n", "x, line 2: id x y z wanted; read '1 a 0 0'"),
    ("CDB", "NBLOCK,6,SOLID\nno format\n", "x, line 2: a format such as (3i9,6e20.13) must follow NBLOCK"),
    (
        "CDB",
        "NBLOCK,6,SOLID\n(3i9,6e20.13)\n        1        0        0 0.0000X\n",
        "x, line 3: a line of NBLOCK wanted; read '1        0        0 0.0000X'",
    ),
    ("BDF", "GRID, 1, 5, 0., 0., 0.\n", "x, line 1: GRID 1: the position must be in basic coordinates"),
    ("BDF", "GRID,,, 0., 0., 0.\n", "x, line 1: GRID: the number of the point wanted; read ''"),
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


def messages(given):
    """Severity and sentence of all faults of a body's files."""
    try:
        faults = flexible_body(given, cached=False)[1]
    except ModelError as stopped:
        faults = stopped.faults
    return [f"{fault.severity}: {fault.message}" for fault in faults]


def spoilt(folder, change, symmetric=True, **choices):
    """Messages for the truss after `change(r, M, K)` edited its arrays."""
    r, _, M, K = truss(1)
    change(r, M, K)
    return messages(files_input(folder, r, M, K, symmetric, **choices))


def test_matrices_of_another_mesh(tmp_path):
    r, _, M, K = truss(1)
    assert messages(files_input(tmp_path, r[:5], M, K)) == [
        "error: M.mtx has 21 rows; the 5 nodes of the table need 15, three each",
        "error: K.mtx has 21 rows; the 5 nodes of the table need 15, three each",
    ]


def test_an_unsymmetric_matrix(tmp_path):
    def change(_r, _M, K):
        K[0, 4] = 7.0
        K[4, 0] = 9.0

    assert spoilt(tmp_path, change, symmetric=False) == [
        "error: K.mtx is not symmetric: entries (1, 5) and (5, 1) are 7 and 9"
    ]


def test_a_node_without_mass(tmp_path):
    def change(_r, M, _K):
        M[3:6] = M[:, 3:6] = 0.0

    assert spoilt(tmp_path, change) == [
        "error: the mass of node 12 along x is 0; is the node in no element? "
        "(3 of 21 such degrees of freedom)"
    ]


def test_a_node_that_no_element_has(tmp_path):
    def change(_r, _M, K):
        K[18:] = K[:, 18:] = 0.0

    found = spoilt(tmp_path, change)
    assert found[0] == (
        "error: the stiffness of node 17 along x is 0; is the node in no element? "
        "(3 of 21 such degrees of freedom)"
    )


def test_a_condensed_mass_matrix_couples_directions(tmp_path):
    def change(_r, M, _K):
        M[0, 1] = M[1, 0] = 0.5 * np.abs(M).max()

    assert spoilt(tmp_path, change) == [
        "error: the mass of directions x, y, z differs by 5.0e-01 of the largest entry, most at node 11: the "
        "equations need equal masses in all directions and none between them; a condensed mass matrix, or "
        "internal degrees of freedom in it? export the matrix of solid elements"
    ]


def test_a_mass_matrix_of_few_digits(tmp_path):
    def change(_r, M, _K):
        M[0, 0] += 1e-5 * np.abs(M).max()

    assert spoilt(tmp_path, change, modes=2) == [
        "warning: the mass of directions x, y, z differs by 6.7e-06 of the largest entry, most at node 11: "
        "the equations need equal masses in all directions and none between them; their mean is taken"
    ]


def test_a_supported_body(tmp_path):
    def change(_r, _M, K):
        K[:3, :3] += np.diag([5.0, 5.0, 5.0]) * np.abs(K).max()

    K = truss(1)[3]
    share = 5.0 * np.abs(K).max() / (5.0 * np.abs(K).max() + np.diag(K)[:3].max())
    assert spoilt(tmp_path, change) == [
        f"error: the stiffness resists a translation by {share:.1e} of the largest entry, most at node 11; "
        "is the body supported, or joined to another? export it free"
    ]


def test_nodes_in_another_order_or_unit(tmp_path):
    def change(r, _M, _K):
        r[[0, 1]] = r[[1, 0]]

    (message,) = spoilt(tmp_path, change)
    assert message.startswith("error: the stiffness resists a rotation by ")
    assert message.endswith(
        ", but no translation: the node table does not belong to the matrix (order of the nodes, unit of "
        "length, rotated nodal axes)"
    )


def test_a_stiffness_of_few_digits(tmp_path):
    def change(_r, _M, K):
        K[0, 0] *= 1 + 1e-6

    K = truss(1)[3]
    share = 1e-6 * K[0, 0] / np.abs(K).max()
    assert spoilt(tmp_path, change, modes=2) == [
        f"warning: the stiffness resists rigid motion by {share:.1e} of the largest entry, most at node 11; "
        "export it with more digits"
    ]


def test_reference_nodes_on_one_line(tmp_path):
    def change(r, _M, _K):
        r[2] = 2 * r[1] - r[0]

    assert spoilt(tmp_path, change, reference=(11, 12, 13))[0] == (
        "error: the reference nodes 11, 12, 13 lie on one line; three that span a plane are needed"
    )


def test_clamped_nodes_on_one_line_leave_a_rotation(tmp_path):
    (message,) = spoilt(tmp_path, lambda r, M, K: None, clamped=(11, 12))
    assert message.startswith(
        "error: the clamped nodes do not hold the body in its frame: three that are not on one line are "
        "needed "
    )


@pytest.mark.parametrize("name, what", [("M.mtx", "mass"), ("K.mtx", "stiffness")])
@pytest.mark.filterwarnings("error")
def test_a_matrix_of_zeros_is_told_of_its_freedoms(tmp_path, name, what):
    """The largest entry, 0, was divided by; found by fuzzing."""
    r, _, M, K = truss(1)
    given = files_input(tmp_path, r, M, K)
    head, size, *lines = (tmp_path / name).read_text().splitlines()
    zeros = [f"{line.rpartition(' ')[0]} 0.0" for line in lines]
    (tmp_path / name).write_text("\n".join([head, size, *zeros]) + "\n")
    assert any(f"error: the {what} of node" in message for message in messages(given))


def test_mass_and_stiffness_exchanged_are_called_so(tmp_path):
    def change(_r, M, K):
        M[:], K[:] = K.copy(), M.copy()

    assert (
        "error: this mass matrix looks like a stiffness; it gives no force in a translation, and the "
        "stiffness does: are the files exchanged?"
    ) in spoilt(tmp_path, change)


def test_a_mesh_in_two_pieces(tmp_path):
    def change(_r, M, K):
        r, _, piece_M, piece_K = truss(2, 4)
        for whole, piece in ((M, piece_M), (K, piece_K)):
            whole[:] = 0.0
            whole[:12, :12] = piece
            whole[12:, 12:] = piece[:9, :9]
        _r[:4] = r
        _r[4:] = r[:3] + 5.0
        K[12:, 12:] = 0.0
        for i, j in ((4, 5), (5, 6), (4, 6)):
            along = (_r[i] - _r[j]) / np.linalg.norm(_r[i] - _r[j])
            bar = np.zeros(21)
            bar[3 * i : 3 * i + 3], bar[3 * j : 3 * j + 3] = along, -along
            K += 100 * np.outer(bar, bar)

    for choices in ({"reference": (11, 12, 13)}, {}):
        (message,) = spoilt(tmp_path, change, modes=2, **choices)
        assert message.startswith("error: held in its frame the body still moves without strain")


def test_two_interface_nodes_do_not_hold_a_body(tmp_path):
    (message,) = spoilt(tmp_path, lambda r, M, K: None, interface=(11, 12), modes=2)
    assert message.startswith(
        "error: the interface nodes do not hold the body: three that are not on one line are needed"
    )


def test_more_modes_than_the_body_has(tmp_path):
    assert spoilt(tmp_path, lambda r, M, K: None, modes=16) == [
        "error: 16 modes are asked for, and the body has 15; 0 takes all"
    ]


def test_an_indefinite_mass_matrix(tmp_path):
    def change(_r, M, _K):
        m = np.eye(7) + 0.0
        m[0, 1] = m[1, 0] = 2.0
        M[:] = np.kron(m, np.eye(3))

    assert spoilt(tmp_path, change) == [
        "error: the mass matrix is not positive definite; is it complete, or of another model?"
    ]


def test_a_held_node_is_missing_from_the_equations(tmp_path):
    r, _, M, K = truss(1, 4)
    given = files_input(tmp_path, r, M, K)
    lines = []
    for letter, matrix in (("M", M), ("K", K)):
        entries = [
            f"{i // 3 + 11},{i % 3 + 1},{j // 3 + 11},{j % 3 + 1},{matrix[i, j]:.17g}"
            for i in range(11)
            for j in range(i + 1)
        ]
        (tmp_path / f"{letter}.abq").write_text("\n".join(entries) + "\n")
        lines.append(FEFile(tmp_path / f"{letter}.abq", "ABQ", Place(len(lines) + 1, 1)))
    given = replace(given, mass=lines[0], stiffness=lines[1])
    assert messages(given)[1] == (
        "error: K.abq has no row for direction 3 of node 14, and lacks 1 in all: is the node held by a "
        "boundary condition, or in no element? export the body unsupported, with the nodes of its elements "
        "only"
    )


def test_a_fault_stands_at_the_card_of_its_file(tmp_path):
    given = files_input(tmp_path, *(truss(1)[i] for i in (0, 2, 3)))
    given = replace(
        given,
        mass=FEFile(Path("none"), "MM", Place(5, 12)),
        stiffness=FEFile(Path("also none"), "MM", Place(7, 12)),
    )
    with pytest.raises(ModelError) as stopped:
        flexible_body(given, cached=False)
    assert [(fault.place, fault.sentence) for fault in stopped.value.faults] == [
        (Place(5, 12), "body 1: none: no such file in ."),
        (Place(7, 12), "body 1: also none: no such file in ."),
    ]
