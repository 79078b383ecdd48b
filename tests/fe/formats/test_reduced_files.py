"""Reduced matrices with rotations and modal coordinates in the layouts of Nastran, Abaqus and ANSYS.

Expected: matrices with all digits, and mass, centre, inertia and frequencies of another program that reduced
them (reduced/README.md); layouts of MSC Nastran's and Abaqus' manuals.
"""

import json
from pathlib import Path

import numpy as np
import pytest
import scipy

from flexmb_cli.fe.formats.formats import read_matrix
from flexmb_cli.fe.formats.matrix_file import FEFileFault
from flexmb_cli.fe.formats.nastran import row_order
from flexmb_cli.fe.formats.node_table import read_node_table

FOLDER = Path(__file__).parent / "reduced"
FACTS = json.loads((FOLDER / "facts.json").read_text())
# Name of the model: node table, then stiffness and mass with their mapping, and digits after the point.
LAYOUTS = {
    "DMIG, Guyan": ("beam_g", "BDF beam_g.pch", "DMIG beam_g.pch", "DMIG beam_g.pch", "", 9),
    "DMIG, modes": ("beam_cb", "BDF beam_cb.pch", "DMIG beam_cb.pch", "DMIG beam_cb.pch", "", 9),
    "DMIG, frame": ("frame_cb", "BDF frame_cb.pch", "DMIG frame_cb.pch", "DMIG frame_cb.pch", "", 9),
    "DMIG, three rows": ("beam_n6", "BDF beam_n6.pch", "DMIG beam_n6.pch", "DMIG beam_n6.pch", "", 9),
    "OP4": (
        *("beam_cb", "BDF beam_cb_op4.pch", "OP4 beam_cb.op4", "OP4 beam_cb.op4"),
        *("BDF beam_cb_op4.pch", 15),
    ),
    "Abaqus": ("beam_g", "INP beam_nodes.inp", "ABQ beam_g_STIF1.mtx", "ABQ beam_g_MASS1.mtx", "", 15),
    "substructure": ("beam_g", "TXT beam_nodes.txt", "ABQ beam_g_sub.mtx", "ABQ beam_g_sub.mtx", "", 13),
    "CalculiX": ("beam_g", "TXT beam_nodes.txt", "ABQ beam_g_ccx.mtx", "ABQ beam_g_MASS1.mtx", "", 13),
    "ANSYS": (
        *("beam_g", "TXT beam_nodes.txt", "HB beam_g_K.hb", "HB beam_g_M.hb", "ANS beam_g.mapping", 12),
    ),
}


def dense(path, form, letter, mapping, table):
    """The matrix (size, size), rows of the nodes in basic axes in the table's order, then modal ones."""
    by, file = mapping.split() if mapping else ("", "")
    matrix = read_matrix(path, form, letter, FOLDER / file if file else None, by)
    full = np.zeros((matrix.size, matrix.size))
    np.add.at(full, (matrix.rows, matrix.columns), matrix.values)
    if matrix.one_triangle:
        full += np.tril(full, -1).T + np.triu(full, 1).T
    place = {number: i for i, number in enumerate(table.numbers.tolist())}
    keys = [(place.get(node, len(place)), node, component) for node, component in matrix.equations.tolist()]
    order = sorted(range(matrix.size), key=keys.__getitem__)
    turn = np.eye(matrix.size)
    rows = [keys[i] for i in order]
    for i, row in enumerate(rows):
        for j, column in enumerate(rows):
            same = row[1] == column[1] and 0 not in (row[2], column[2]) and (row[2] > 3) == (column[2] > 3)
            if table.axes is not None and same:
                turn[i, j] = table.axes[row[0]][(row[2] - 1) % 3, (column[2] - 1) % 3]
    return turn @ full[np.ix_(order, order)] @ turn.T, [row[1:] for row in rows]


def model(case):
    name, nodes, stiffness, mass, mapping, digits = LAYOUTS[case]
    form, file = nodes.split()
    table = read_node_table(FOLDER / file, form)
    K, rows = dense(FOLDER / stiffness.split()[1], stiffness.split()[0], "K", mapping, table)
    M, _ = dense(FOLDER / mass.split()[1], mass.split()[0], "M", mapping, table)
    return name, table, rows, K, M, 0.6 * 10.0**-digits


@pytest.mark.parametrize("case", [case for case in LAYOUTS if LAYOUTS[case][0] != "beam_n6"])
def test_every_layout_has_the_same_numbers(case):
    """Turned axes sum up the rounding of a few digits; the OP4 has zeros for 1e-14 between two modes."""
    name, table, _, K, M, rounding = model(case)
    exact = np.load(FOLDER / f"{name}.npz")
    np.testing.assert_allclose(table.positions, exact["X"], rtol=0, atol=1e-14)
    for found, expected in ((K, exact["K"]), (M, exact["M"])):
        np.testing.assert_allclose(
            found, expected, rtol=4 * rounding, atol=max(4 * rounding, 2e-14) * np.ptp(expected)
        )


@pytest.mark.parametrize("case", LAYOUTS)
def test_mass_and_frequencies_are_those_of_the_program_that_made_the_file(case):
    """Rigid motions R: K R = 0, R' M R has mass, centre and inertia; the free body has the frequencies."""
    name, table, rows, K, M, rounding = model(case)
    facts, place = FACTS[name], dict(zip(table.numbers.tolist(), table.positions, strict=True))
    R = np.zeros((len(rows), 6))
    for i, (node, component) in enumerate(rows):
        if component in (1, 2, 3):
            R[i, component - 1] = 1.0
            R[i, 3:] = np.cross(np.eye(3), place[node])[:, component - 1]
        elif component:
            R[i, component - 1] = 1.0
    assert np.abs(K @ R).max() <= 40 * rounding * np.abs(K).max()
    rigid = R.T @ M @ R
    mass, centre = rigid[0, 0], np.array([rigid[1, 5], rigid[2, 3], rigid[0, 4]]) / rigid[0, 0]
    inertia = rigid[3:, 3:] - mass * (centre @ centre * np.eye(3) - np.outer(centre, centre))
    assert mass == pytest.approx(facts["mass"], rel=40 * rounding + 1e-12)
    np.testing.assert_allclose(centre, facts["centre"], rtol=0, atol=40 * rounding + 1e-12)
    np.testing.assert_allclose(inertia, facts["inertia_about_centre"], rtol=0, atol=40 * rounding + 1e-12)
    # Rounding leaves some stiffness in rigid motions, relative to the largest entry.
    frequencies = np.sqrt(scipy.linalg.eigh(K, M, eigvals_only=True)[6:14]) / (2 * np.pi)
    assert frequencies == pytest.approx(facts["free_Hz"], rel=1e-5 if rounding > 1e-10 else 1e-8)


def test_the_superelement_names_rows_of_points_and_modal_coordinates():
    order = row_order(FOLDER / "beam_cb_op4.pch").tolist()
    assert order[:6] == [[101, component] for component in range(1, 7)]
    assert order[18:] == [[9001, 0], [9002, 0], [9003, 0], [9004, 0]]


def test_numbers_that_fill_their_columns_are_parted(tmp_path):
    """A genuine file of MSC Nastran has `20111101       0` followed by `20111102` without a blank."""
    (tmp_path / "x").write_text("EXTRN   20111101       020111102     135\n             475       2\n")
    expected = [[20111101, 0], [20111102, 1], [20111102, 3], [20111102, 5], [475, 2]]
    assert row_order(tmp_path / "x").tolist() == expected


@pytest.mark.parametrize("component", ["0", "1"])
def test_a_scalar_point_has_component_0_or_1(tmp_path, component):
    """MSC Quick Reference Guide, DMIG: GJ a scalar point, CJ 0 or blank; SPOINT n THRU m."""
    text = "DMIG,K,0,6,2,0\nDMIG,K,7,1,,7,1,3.0\n"
    text += f"DMIG,K,9002,{component},,9002,{component},5.0\nSPOINT,9001,THRU,9003\n"
    (tmp_path / "x").write_text(text)
    assert read_matrix(tmp_path / "x", "DMIG", "K").equations.tolist() == [[7, 1], [9002, 0]]


def test_displacement_axes_of_a_cylinder_are_radial_at_the_point(tmp_path):
    """CORD2C, CORD2S: at 90 degrees e_r is the y axis and e_theta of the cylinder -x."""
    text = "CORD2C,5,,0.,0.,0.,0.,0.,1.\n,1.,0.,0.\nCORD2S,6,,0.,0.,0.,0.,0.,1.\n,1.,0.,0.\n"
    text += "GRID,1,,0.,2.,1.,5\nGRID,2,,0.,1.,1.,6\nGRID,3,,1.,1.,1.\n"
    (tmp_path / "x").write_text(text)
    axes = read_node_table(tmp_path / "x", "BDF").axes
    half = np.sqrt(0.5)
    np.testing.assert_allclose(axes[0].T, [[0, 1, 0], [-1, 0, 0], [0, 0, 1]], rtol=0, atol=1e-15)
    np.testing.assert_allclose(axes[1].T, [[0, half, half], [0, half, -half], [-1, 0, 0]], rtol=0, atol=1e-15)
    np.testing.assert_array_equal(axes[2], np.eye(3))


def test_rotations_of_solid_elements_are_left_out(tmp_path):
    """Rows of zeros, which superelements of solids have, are no coordinates."""
    (tmp_path / "x").write_text("1,1, 1,1, 2.0\n1,4, 1,4, 0.0\n1,1, 1,4, 0.0\n")
    assert read_matrix(tmp_path / "x", "ABQ", "K").equations.tolist() == [[1, 1]]


SUBSTRUCTURE = (FOLDER / "beam_g_sub.mtx").read_text()
CALCULIX = (FOLDER / "beam_g_ccx.mtx").read_text()
REFUSED = {
    "a mass of CalculiX": ("ABQ", "M", CALCULIX, "holds a stiffness only"),
    "a triangle with modes": (
        "ABQ", "K", SUBSTRUCTURE.replace("1, 2, 3, 4, 5, 6\n", "1, 2, 3\n"), "retained modes is not",
    ),
    "an acoustic direction": (
        "ABQ", "K", SUBSTRUCTURE.replace("1, 2, 3, 4, 5, 6\n", "1, 2, 3, 8\n"), "directions 1 to 6",
    ),
    "a line without directions": (
        "ABQ", "K", SUBSTRUCTURE.replace("4, 5, 6\n", "4, 5, 6\n3,\n"), "directions 1 to 6",
    ),
    "a row twice": ("ABQ", "K", CALCULIX.replace("101,       102", "101,       101"), "stands 2"),
    "a temperature": ("ABQ", "K", "1,1, 1,1, 2.0\n1,11, 1,11, 2.0\n", "direction 11 of node 1"),
    "component 7": ("DMIG", "K", "DMIG,K,0,6,2,0\nDMIG,K,1,1,,1,7,3.0\n", "component 7 of point 1"),
}  # fmt: skip


@pytest.mark.parametrize("case", REFUSED)
def test_what_cannot_be_read_is_refused_with_its_reason(tmp_path, case):
    form, letter, text, words = REFUSED[case]
    (tmp_path / "x").write_text(text)
    with pytest.raises(FEFileFault, match=words):
        read_matrix(tmp_path / "x", form, letter)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("GRID,1\n", "holds no card EXTRN"),
        ("EXTRN,1,127\n", "expected components such as 123456, or 0; read '127'"),
        ("EXTRN,1,123,1,3\n", "node 1, direction 3 stands 2 times"),
    ],
)
def test_an_order_of_rows_that_cannot_be_used_is_refused(tmp_path, text, words):
    (tmp_path / "x").write_text(text)
    with pytest.raises(FEFileFault, match=words):
        row_order(tmp_path / "x")
