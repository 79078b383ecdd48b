"""Matrices as programs export them: in the solver's order, with blank lines, as substructures, with ties.

Expected: frequencies of scipy.linalg.eigh of the numbers in tests/fe/formats/bar, and the manuals' layouts.
"""

import re

import numpy as np
import pytest

from tests.fe.formats.bar_files import (
    FOLDER,
    FREQUENCIES,
    MASS,
    NODES,
    K,
    M,
    abaqus_nodes,
    abaqus_rows,
    bar_of,
    dmig,
    harwell_boeing,
    market,
    op4_binary,
    op4_text,
    refused,
)

ORDER = np.random.default_rng(7).permutation(16)
ROWS = (3 * ORDER[:, None] + np.arange(3)).ravel()
K_SOLVER, M_SOLVER = K[np.ix_(ROWS, ROWS)], M[np.ix_(ROWS, ROWS)]
VECTOR = "%%MatrixMarket matrix array {} general\n% entry k: node of rows 3k-2 to 3k\n{}\n"
WHOLE = VECTOR.format("integer", "\n".join(["16 1", *(str(node + 1) for node in ORDER)]))
REAL = VECTOR.format("real", "\n".join(["16 1", *(f"{node + 1:.6E}" for node in ORDER)]))
LABELS = "".join(
    f"{3 * k + d + 1} {node + 1} U{'XYZ'[d]}\n" for k, node in enumerate(ORDER) for d in range(3)
)
LINES = [f"{node + 1}.{d}" for node in range(16) for d in (1, 2, 3)]


@pytest.mark.parametrize("mapping", [WHOLE, REAL, LABELS], ids=["whole", "real", "labels"])
def test_rows_in_the_solvers_order_are_mapped(tmp_path, mapping):
    """APDL Math exports such a vector of node numbers; HBMAT's mapping says the same of every equation."""
    for form, write in (
        ("MM", market),
        ("OP4", lambda A: op4_text("A", A)),
        ("ABQ", abaqus_rows),
        ("HB", harwell_boeing),
    ):
        mass, found = bar_of(tmp_path, (form, write(M_SOLVER)), (form, write(K_SOLVER)), ("ANS", mapping))
        assert (mass, *found) == pytest.approx((MASS, *FREQUENCIES), rel=1e-7)


def test_a_mapping_of_one_matrix_stands_beside_labels_of_the_other(tmp_path):
    found = bar_of(tmp_path, ("ABQ", abaqus_nodes(M)), ("MM", market(K_SOLVER)), ("ANS", WHOLE))
    assert (found[0], *found[1]) == pytest.approx((MASS, *FREQUENCIES), rel=1e-7)


@pytest.mark.parametrize(
    ("mapping", "words"),
    [
        (WHOLE.replace("\n16 1", "\n16 2"), "of one column, not 2"),
        (WHOLE.replace("\n16 1", "\n17 1"), "announces 17 entries and holds 16"),
        (VECTOR.format("integer", "2 1\n3\n3"), "node 3, direction 1 stands 2 times"),
        (VECTOR.format("real", "2 1\n3.5\n3"), "nodes must be whole numbers"),
        (
            VECTOR.format("integer", "2 1\n5\n3"),
            "has 48 rows and the mapping FEMP 6; has it other nodes, or rotations",
        ),
        (
            VECTOR.format("integer", "8 1\n" + "\n".join("12345678")),
            "has it other nodes, or rotations of beams and shells?",
        ),
        (LABELS.replace(" 3 UX", " 4 UX"), "node 4, direction 1 stands 2 times"),
    ],
)
def test_a_mapping_that_does_not_fit_is_refused(tmp_path, mapping, words):
    assert words in refused(tmp_path, ("MM", market(M)), ("MM", market(K)), ("ANS", mapping))


def test_blank_lines_are_passed_over(tmp_path):
    """NIST allows them anywhere after the first line of a Matrix Market file, and scipy.io reads them."""
    mapping = "".join(f"{k + 1} {k // 3 + 1} U{'XYZ'[k % 3]}\n\n" for k in range(48))
    for form, mass, stiffness, given in (
        ("MM", market(M, ["", "  "]), market(K, [""]), None),
        ("MM", market(M, [""], "array"), market(K, ["", ""], "array"), None),
        ("HB", harwell_boeing(M, True), harwell_boeing(K, True), ("ANS", mapping)),
        (
            "OP4",
            op4_text("MAA", M, blank=True),
            "\n" + op4_text("PA", K[:, :2], blank=True) + op4_text("KAA", K, blank=True),
            None,
        ),
        ("CCX", *(f"\n{ccx(A)}".replace("\n2 ", "\n\n2 ", 1) for A in (M, K)), ("CCX", "\n\n".join(LINES))),
    ):
        found = bar_of(tmp_path, (form, mass), (form, stiffness), given)
        assert (found[0], *found[1]) == pytest.approx((MASS, *FREQUENCIES), rel=1e-7)


def ccx(matrix):
    """Matrix storage of CalculiX."""
    return "".join(f"{i + 1} {j + 1} {value:.17e}\n" for (i, j), value in np.ndenumerate(matrix) if i <= j)


def test_a_cut_off_line_is_still_missed_among_blank_ones(tmp_path):
    text = market(K, [""])
    assert "announces 2304 entries and holds 2303" in refused(
        tmp_path, ("MM", market(M)), ("MM", text[: text.rindex("48 48")])
    )


@pytest.mark.parametrize("width", [16, 8])
def test_both_triangles_of_form_6_are_refused(tmp_path, width):
    """MSC Quick Reference Guide, DMIG: an entry of a symmetric matrix is given once."""
    both = [("DMIG", dmig(name, A, width=width, both=True)) for name, A in (("MAAX", M), ("KAAX", K))]
    said = refused(tmp_path, *both)
    assert "DMIG KAAX is of form 6 and has both triangles, such as the entry of 1, 2 with 1, 1" in said


def test_a_square_dmig_may_have_both_triangles(tmp_path):
    files = [("DMIG", dmig(name, A, form=1)) for name, A in (("MAAX", M), ("KAAX", K))]
    assert bar_of(tmp_path, *files)[1] == pytest.approx(FREQUENCIES, rel=2e-7)


def test_too_few_digits_are_called_so_in_every_format(tmp_path):
    """Four to five digits leave 1e-4 of the largest entry, which is no support."""
    for mass, stiffness, words in (
        (("DMIG", dmig("MAAX", M)), ("DMIG", dmig("KAAX", K, width=8)), "with 5 of them it resists"),
        (("MM", market(M)), ("MM", market(K, form=".3e")), "with 4 of them it resists"),
        (("OP4", op4_binary(("M", M))), ("ABQ", abaqus_rows(K, ".3e")), "with 4 of them it resists"),
    ):
        said = refused(tmp_path, mass, stiffness)
        assert "the digits of the stiffness are too few: " + words in said
        assert "supported" not in said
        assert ("DMIG*" in said) == (stiffness[0] == "DMIG")


def test_a_support_is_still_called_so_with_few_digits(tmp_path):
    held = K.copy()
    held[0, 0] *= 1.5
    said = refused(tmp_path, ("DMIG", dmig("MAAX", M)), ("DMIG", dmig("KAAX", held, width=8)))
    assert "is the body supported" in said


def test_six_rows_a_node_are_rotations(tmp_path):
    """Rows of solid elements taken for those of half as many nodes resist the rigid motions of these."""
    nodes = "".join(f"{i} {0.1 * i} 0 0\n" for i in range(8))
    for form, write in (("MM", market), ("OP4", lambda A: op4_text("A", A)), ("ABQ", abaqus_rows)):
        said = refused(tmp_path, (form, write(M)), (form, write(K)), nodes=nodes)
        assert "the stiffness resists rigid motion by" in said


USER = (FOLDER / "user.mtx").read_text()
CORNERS = "".join(NODES.splitlines(keepends=True)[i] for i in (0, 1, 2, 3, 12, 13, 14, 15))


def test_a_substructure_of_abaqus_is_read(tmp_path):
    """*SUBSTRUCTURE MATRIX OUTPUT: the stiffness is that of own Guyan condensation, the mass lumped."""
    keep = [3 * i + d for i in (0, 1, 2, 3, 12, 13, 14, 15) for d in range(3)]
    drop = [i for i in range(48) if i not in keep]
    condensed = K[np.ix_(keep, keep)] - K[np.ix_(keep, drop)] @ np.linalg.solve(
        K[np.ix_(drop, drop)], K[np.ix_(drop, keep)]
    )
    lumped = np.kron(np.diag([1.0, 2, 1, 1, 2, 1, 1, 1]), np.eye(3))
    # Nodes in another order than the table's: those of the element count.
    table = "".join(reversed(CORNERS.splitlines(keepends=True)))
    found = bar_of(tmp_path, ("DMIG", _dmig_of_corners(lumped)), ("ABQ", USER), nodes=table)
    wanted = bar_of(tmp_path, ("MM", market(lumped)), ("MM", market(condensed)), nodes=CORNERS)
    from scipy.linalg import eigh

    values = np.sqrt(eigh(condensed, lumped, eigvals_only=True)[6:9]) / (2 * np.pi)
    assert (found[0], *found[1]) == pytest.approx((10.0, *values), rel=1e-6)
    assert wanted[1] == pytest.approx(values, rel=1e-6)


def test_a_condensed_mass_is_taken_as_it_is(tmp_path):
    """The mass of the substructure couples directions; frequencies are those of scipy's free-free pencil."""
    found = bar_of(tmp_path, ("ABQ", USER), ("ABQ", USER), nodes=CORNERS)
    matrices = [_triangle(text) for text in re.split(r"\*MATRIX,TYPE=\w+\n", USER)[1:]]
    from scipy.linalg import eigh

    values = np.sqrt(eigh(*matrices, eigvals_only=True)[6:9]) / (2 * np.pi)
    assert found[1] == pytest.approx(values, rel=1e-9)


def _triangle(text):
    """The symmetric matrix whose lower triangle a text holds row by row."""
    values = np.array([float(word) for word in re.split(r"[,\s]+", text.strip()) if word])
    size = int(np.sqrt(2 * len(values)))
    matrix = np.zeros((size, size))
    matrix[np.tril_indices(size)] = values
    return matrix + np.tril(matrix, -1).T


def _dmig_of_corners(matrix):
    full = np.zeros((48, 48))
    keep = [3 * i + d for i in (0, 1, 2, 3, 12, 13, 14, 15) for d in range(3)]
    full[np.ix_(keep, keep)] = matrix
    blank = [i for i in range(48) if i not in keep]
    lines = dmig("MAAX", full).splitlines(keepends=True)
    empty = {f"{i // 3 + 1:16d}{i % 3 + 1:16d}" for i in blank}
    return "".join(line for line in lines if not (line.startswith("DMIG*") and line[24:56] in empty))


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("1, 2, 3\n", "1, 2, 3, 4, 5, 6\n", "the 48 directions of *USER ELEMENT make"),
        ("1, 2, 3\n", "1, 2, 3\n 5, 1, 2\n", "the 20 directions of *USER ELEMENT"),
        ("NODES=       8", "NODES=       9", "has 9 nodes, and its comment 'ELEMENT NODES' names 8"),
        (
            "**1, 2, 3, 4, 13, 14, 15, 16",
            "**1, 2, 3, 4, 13, 14, 15, 15",
            "node 15, direction 1 stands 2 times",
        ),
        ("9.7255855369618e+08\n8", "8", "make a matrix of 300 values; this one has 299"),
        ("8.0890908962948e+07, ", "8.0890908962948f+07, ", "line 9: expected values separated by commas"),
        ("*MATRIX,TYPE=MASS", "*MATRIX,TYPE=MASS,SCALE FACTOR=2", "SCALE FACTOR is not read"),
        ("*MATRIX,TYPE=MASS", "*DAMPING", "*DAMPING is not read"),
        ("LINEAR", "FILE=9", "FILE is not read; export"),
    ],
)
def test_a_substructure_that_cannot_be_used_is_refused(tmp_path, old, new, words):
    text = USER.replace(old, new, 1)
    said = refused(tmp_path, ("ABQ", text), ("ABQ", text), nodes=CORNERS)
    assert words in said


def test_rows_that_a_rigid_body_takes_are_named_so(tmp_path):
    """CalculiX leaves the dependent nodes of *RIGID BODY, *EQUATION and *MPC out of the .dof file."""
    rows = "\n".join(LINES[:36] + [f"{node}.{d}" for node in (91, 92) for d in (1, 2, 3)])
    size = np.arange(42)
    files = [("CCX", ccx(A[np.ix_(size, size)])) for A in (M, K)]
    nodes = NODES + "91 0.9 0.06 0.04\n92 0.9 0.06 0.04\n"
    said = refused(tmp_path, *files, ("CCX", rows), nodes=nodes)
    assert "no row for direction 1 of node 13" in said
    assert "tied to others (*RIGID BODY, *EQUATION, *MPC" in said


def test_repeated_labels_are_those_of_expanded_shells(tmp_path):
    repeated = "\n".join(line for line in LINES[:24] for _ in range(2))
    said = refused(tmp_path, ("CCX", ccx(M)), ("CCX", ccx(K)), ("CCX", repeated))
    assert "repeats 24 of 48 labels: node 1, direction 1 stands 2 times, as of shells and beams" in said
