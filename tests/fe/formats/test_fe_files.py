"""Readers of finite-element files on the spellings that programs use."""

from pathlib import Path

import numpy as np
import pytest
from scipy.io import hb_write, mmread
from scipy.sparse import csc_matrix

from flexmb_cli.fe.formats.formats import read_matrix
from flexmb_cli.fe.formats.matrix_file import FEFileFault

FILES = Path(__file__).parents[3] / "decks" / "vsdf" / "fe"


def full(file, size=None):
    """The matrix in the order of its rows, or of nodes 1, 2, ... when rows are labelled."""
    matrix = np.zeros((file.size, file.size))
    np.add.at(matrix, (file.rows, file.columns), file.values)
    if file.one_triangle:
        matrix = matrix + matrix.T - np.diag(np.diag(matrix))
    if file.equations is None:
        return matrix
    order = np.lexsort((file.equations[:, 1], file.equations[:, 0]))[:size]
    return matrix[np.ix_(order, order)]


def read(folder, text, form, letter="K", mapping=None, kind=""):
    (folder / "x").write_text(text)
    if mapping is not None:
        (folder / "map").write_text(mapping)
    return full(read_matrix(folder / "x", form, letter, folder / "map", kind))


SUPPLIED = [
    ("HB", "pendulum_{}.hb", "pendulum.mapping", "ANS", 1e-15),
    ("ABQ", "pendulum_{}1.mtx", None, "", 1e-15),
    ("OP4", "pendulum_MK.op4", None, "", 0.0),
    ("DMIG", "pendulum_{}.pch", None, "", 5e-10),
]


@pytest.mark.parametrize("form, name, mapping, kind, digits", SUPPLIED, ids=[row[0] for row in SUPPLIED])
@pytest.mark.parametrize("letter", ["M", "K"])
def test_every_format_holds_the_matrix_that_scipy_reads_from_matrix_market(
    form, name, mapping, kind, digits, letter
):
    wanted = mmread(FILES / f"pendulum_{letter}.mtx").toarray()
    stem = {"M": "MASS", "K": "STIF"}[letter] if form == "ABQ" else letter
    found = full(read_matrix(FILES / name.format(stem), form, letter, mapping and FILES / mapping, kind))
    np.testing.assert_allclose(found, wanted, rtol=0, atol=max(digits, 1e-15) * np.abs(wanted).max())


def test_calculix_has_the_nodal_mass_of_the_other_formats_and_more_rows():
    """Version 2.20: 162 equations of nodes, 144 of the bricks' incompatible modes."""
    found = read_matrix(FILES / "calculix/pendulum.mas", "CCX", "M", FILES / "calculix/pendulum.dof", "CCX")
    assert found.size == 306
    wanted = mmread(FILES / "pendulum_M.mtx").toarray()
    np.testing.assert_allclose(full(found, 162), wanted, rtol=0, atol=3e-15)


def test_matrix_market_agrees_with_scipy_in_every_layout(tmp_path):
    texts = [
        "%%MatrixMarket matrix coordinate real general\n% note\n\n2 2 3\n1 1 4\n2 1 1.5D+00\n1 2 1.5\n",
        "%%MatrixMarket matrix coordinate integer symmetric\n2 2 2\n1 1 4\n2 1 3\n",
        "%%MatrixMarket matrix array real general\n2 2\n4\n1.5\n1.25\n2\n",
        "%%MatrixMarket matrix array real symmetric\n3 3\n1\n2\n3\n4\n5\n6\n\n",
    ]
    for text in texts:
        (tmp_path / "scipy").write_text(text.replace("D", "E").replace("\n\n2", "\n2"))
        wanted = mmread(tmp_path / "scipy")
        np.testing.assert_array_equal(
            read(tmp_path, text, "MM"), np.asarray(getattr(wanted, "toarray", lambda w=wanted: w)())
        )


def harwell_boeing(kind, pointers, rows, values, columns=1, size=2, value_format="(2D12.4)"):
    """A file of one number a line for integers, two touching values a line."""
    lines = ["title".ljust(72) + "KEY"]
    value_lines = [
        "".join(f"{value:12.4E}" for value in values[i : i + 2]).replace("E", "D")
        for i in range(0, len(values), 2)
    ]
    counts = len(pointers), len(rows), len(value_lines)
    lines.append(f"{sum(counts):14d}" + "".join(f"{count:14d}" for count in counts) + f"{0:14d}")
    lines.append(f"{kind}           {size:14d}{size:14d}{len(values):14d}{0:14d}")
    lines.append(f"{'(1I14)':16}{'(1I14)':16}{value_format:20}")
    lines += [f"{number:14d}" for number in (*pointers, *rows)] + value_lines
    return "\n".join(lines) + "\n"


MAPPING = "heading\n 1 1 UX\n 2 1 UY\n"


def test_touching_values_are_cut_by_the_width_of_their_format(tmp_path):
    text = harwell_boeing("RSA", (1, 3, 4), (1, 2, 2), (4.0, -1.5, -2.0))
    assert "D+00 -1.5000" in text
    text = text.replace("  4.0000D+00 -1.5000D+00", "  4.0000D+00-12.500D+000")
    found = read(tmp_path, text, "HB", mapping=MAPPING, kind="ANS")
    assert found.tolist() == [[4.0, -12.5], [-12.5, -2.0]]


def test_a_matrix_from_scipys_writer_is_read_though_its_fields_are_narrower_than_told(tmp_path):
    """scipy.io.hb_write announces 3E25.16 and writes 24 columns a value: signs end up in the field before."""
    values = np.array([[2 / 3, -1e5 / 7, 0.0], [-1e5 / 7, 3e-7, -11 / 9], [0.0, -11 / 9, 1 / 3]])
    hb_write(str(tmp_path / "x"), csc_matrix(values))
    widths = {len(line) for line in (tmp_path / "x").read_text().splitlines()[6:]}
    assert "E25.16" in (tmp_path / "x").read_text() and widths == {24, 72}
    mapping = " 1 1 UX\n 2 1 UY\n 3 1 UZ\n"
    text = (tmp_path / "x").read_text()
    assert read(tmp_path, text, "HB", mapping=mapping, kind="ANS").tolist() == values.tolist()


def test_touching_fields_of_another_width_than_told_are_named(tmp_path):
    text = harwell_boeing("RSA", (1, 3, 4), (1, 2, 2), (4.0, -1.5, -2.0))
    text = text.replace("  4.0000D+00 -1.5000D+00", "  4.00000D+00-1.50000D+00")
    with pytest.raises(FEFileFault, match="by the format of line 4: are they wider or narrower here"):
        read(tmp_path, text, "HB", mapping=MAPPING, kind="ANS")


def test_rua_is_full_and_not_mirrored(tmp_path):
    text = harwell_boeing("RUA", (1, 3, 5), (1, 2, 1, 2), (4.0, 1.0, 1.0, 5.0))
    assert read(tmp_path, text, "HB", mapping=MAPPING, kind="ANS").tolist() == [[4.0, 1.0], [1.0, 5.0]]


def test_full_columns_declared_symmetric_with_wrong_pointers_are_not_mirrored(tmp_path):
    """ANSYS before release 11 wrote RSA, all n² entries, and pointers with stride n + 1."""
    text = harwell_boeing("RSA", (1, 4, 7), (1, 2, 1, 2), (4.0, 1.0, 1.0, 5.0))
    assert read(tmp_path, text, "HB", mapping=MAPPING, kind="ANS").tolist() == [[4.0, 1.0], [1.0, 5.0]]


def test_the_mapping_orders_the_rows(tmp_path):
    text = harwell_boeing("RSA", (1, 2, 3), (1, 2), (4.0, 5.0))
    mapping = "Matrix Eqn  Node  DOF\n 2 7 UX\n 1 7 uz\n"
    assert read(tmp_path, text, "HB", mapping=mapping, kind="ANS").tolist() == [[5.0, 0.0], [0.0, 4.0]]


def test_calculix_directions_are_text_and_no_decimal_fractions(tmp_path):
    """12.1 is node 12, direction 1; 1.2 must not become node 12."""
    text = "1 1 1.0\n1 2 0.0\n2 2 2.0\n3 3 3.0\n"
    (tmp_path / "x").write_text(text)
    (tmp_path / "map").write_text("12.1\n1.2\n1.1\n")
    found = read_matrix(tmp_path / "x", "CCX", "K", tmp_path / "map", "CCX")
    assert found.equations.tolist() == [[12, 1], [1, 2], [1, 1]]
    assert len(found.values) == 3


def test_abaqus_square_and_triangle_give_the_same_matrix(tmp_path):
    triangle = "** comment\n*MATRIX\n1,1, 1,1, 4.0\n2,3, 1,1, -1.0\n2,3, 2,3, 5.0D0\n"
    square = triangle + "1,1, 2,3, -1.0\n"
    assert read(tmp_path, triangle, "ABQ").tolist() == [[4.0, -1.0], [-1.0, 5.0]]
    assert read(tmp_path, square, "ABQ").tolist() == [[4.0, -1.0], [-1.0, 5.0]]


def test_abaqus_rows_without_nodes_follow_the_node_table(tmp_path):
    (tmp_path / "x").write_text("1,1,4.0\n2,1,1.0\n2,2,5.0\n")
    found = read_matrix(tmp_path / "x", "ABQ", "K")
    assert found.equations is None
    assert full(found).tolist() == [[4.0, 1.0], [1.0, 5.0]]


def test_abaqus_coordinates_are_parted_by_blanks(tmp_path):
    """*MATRIX OUTPUT, FORMAT=COORDINATE: row, column, value."""
    (tmp_path / "x").write_text("         1         1   4.0000000000000D+00\n 2 1 1.0E+00\n\n 2 2   5.0\n")
    assert full(read_matrix(tmp_path / "x", "ABQ", "K")).tolist() == [[4.0, 1.0], [1.0, 5.0]]


DMIG = {
    "large fields": (
        "DMIG    KAAX           0       6       2       0\n"
        "DMIG*   KAAX                           1               1\n"
        "*                      1               1 4.0D+00\n"
        "*                      1               2-1.5\n"
        "DMIG*   KAAX                           1               2\n"
        "*                      1               2 5.0+0\n"
    ),
    "small fields": (
        "DMIG    KAAX    0       6       2       0\n"
        "DMIG    KAAX    1       1               1       1       4.0\n"
        "        1       2       -1.5\n"
        "DMIG    KAAX    1       2               1       2       5.0\n"
    ),
    "free fields": (
        "$ comment\nDMIG,KAAX,0,6,2,0\nDMIG,KAAX,1,1,,1,1,4.0\n+,1,2,-1.5\nDMIG,KAAX,1,2,,1,2,5.0 $ tail\n"
    ),
    "square": ("DMIG,KAAX,0,1,2,0\nDMIG,KAAX,1,1,,1,1,4.0\n,1,2,-1.5\nDMIG,KAAX,1,2,,1,1,-1.5\n,1,2,5.0\n"),
    "among others": (
        "DMIG,MAAX,0,6,2,0\nDMIG,MAAX,1,1,,1,1,9.0\n"
        "DMIG,KAAX,0,6,2,0\nDMIG,KAAX,1,1,,1,1,4.0\n,1,2,-1.5\nDMIG,KAAX,1,2,,1,2,5.0\n"
    ),
    "rotations without stiffness": (
        "DMIG,KAAX,0,6,2,0\n"
        "DMIG,KAAX,1,1,,1,1,4.0\n"
        ",1,2,-1.5\n"
        "DMIG,KAAX,1,2,,1,2,5.0\n"
        "DMIG,KAAX,1,4,,1,4,0.0\n"
    ),
}


@pytest.mark.parametrize("text", DMIG.values(), ids=DMIG)
def test_dmig_in_all_its_spellings(tmp_path, text):
    assert read(tmp_path, text, "DMIG").tolist() == [[4.0, -1.5], [-1.5, 5.0]]


def op4(rows, body):
    return f"       2{rows:8d}       6       2KAA     1P,3E23.16\n{body}       3       1       1\n 1.0\n"


VALUES = " 4.0000000000000000E+00-1.5000000000000000E+00\n"
OP4 = {
    "dense": op4(
        2,
        f"       1       1       2\n{VALUES}       2       1       2\n"
        "-1.5000000000000000E+00 5.0000000000000000E+00\n",
    ),
    "strings": op4(
        2,
        f"       1       0       5\n {65536 * 5 + 1}\n{VALUES}"
        f"       2       0       6\n"
        f" {65536 * 3 + 1}\n"
        f"-1.5000000000000000E+00\n"
        f" {65536 * 3 + 2}\n"
        f" 5.0000000000000000E+00\n",
    ),
    "bigmat": op4(
        -2,
        f"       1       0       6\n       5       1\n{VALUES}"
        "       2       0       6\n       5       1\n-1.5000000000000000E+00 5.0000000000000000E+00\n",
    ),
}


@pytest.mark.parametrize("text", OP4.values(), ids=OP4)
def test_op4_text_in_all_its_layouts(tmp_path, text):
    assert read(tmp_path, text, "OP4").tolist() == [[4.0, -1.5], [-1.5, 5.0]]
