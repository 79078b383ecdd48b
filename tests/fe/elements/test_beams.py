"""Beams of bulk data files as bodies: stiffness, consistent mass, sections, and what is refused.

Expected: the matrices of another program for the same beam (tests/fe/formats/reduced), which it reduced from
a finer mesh; natural frequencies of Euler and Bernoulli's beam (Blevins, Formulas for Natural Frequency and
Mode Shape (1979), table 8-1); equal sections by other cards.
"""

from pathlib import Path

import numpy as np
import pytest
import scipy

from flexmb_cli.fe.elements.structures import matrix_of_structures, structure_matrix
from flexmb_cli.fe.formats.matrix_file import FEFileFault
from flexmb_cli.fe.formats.node_table import read_node_table
from flexmb_cli.fe.formats.structure_elements import has_structures, read_structures
from flexmb_cli.interface import solve
from flexmb_cli.model.flexible_body import ElementMaterial, FEFile
from tests.fe.row_bodies.row_decks import DECKS, motion

EXACT = Path(__file__).parents[1] / "formats" / "reduced" / "beam_g.npz"
WIDTH, HEIGHT = 0.01, 0.02
AREA, I1, I2 = WIDTH * HEIGHT, HEIGHT * WIDTH**3 / 12, WIDTH * HEIGHT**3 / 12
TORSION = HEIGHT * WIDTH**3 * (1 / 3 - 0.21 * WIDTH / HEIGHT * (1 - WIDTH**4 / HEIGHT**4 / 12))
ALUMINIUM = (7e10, 0.33, 2700.0)
SHEAR = repr(5 / 6)
PBAR = f"PBAR,1,1,{AREA!r},{I1!r},{I2!r},{TORSION!r},,\n,,,,,,,,\n,{SHEAR},{SHEAR}\n"
GRIDS = "GRID,101,,0.,0.,0.\nGRID,102,,.5,0.,0.\nGRID,103,,1.,0.,0.\n"
BARS = "CBAR,1,1,101,102,0.,1.,0.\nCBAR,2,1,102,103,0.,1.,0.\n"
MATERIAL = "MAT1,1,7.+10,,.33,2700.\n"


def matrices(folder, text, elastic=ALUMINIUM, form="BDF"):
    """K and M (6 n, 6 n) of the beams of a file."""
    (folder / "x").write_text(text)
    nodes = read_node_table(folder / "x", form)
    table = read_structures(folder / "x", form, nodes, elastic)
    for letter in "KM":
        file = structure_matrix(table, nodes, elastic, letter)
        full = np.zeros((file.size, file.size))
        np.add.at(full, (file.rows, file.columns), file.values)
        yield full


def relative(found, expected):
    """Largest difference relative to the diagonal entries of row and column."""
    scale = np.sqrt(np.diag(expected))
    return np.abs((found - expected) / np.outer(scale, scale)).max()


def test_the_matrices_are_those_of_a_finer_mesh_reduced_to_the_same_nodes(tmp_path):
    """Guyan's reduction of exact beams gives exact beams, in mass, too; round-off of the program: 1e-13."""
    exact = np.load(EXACT)
    for found, letter in zip(matrices(tmp_path, GRIDS + MATERIAL + BARS + PBAR), "KM", strict=True):
        assert relative(found, exact[letter]) < 1e-12


@pytest.mark.parametrize(
    "cards",
    [
        GRIDS + "GRID,7,,0.,3.,0.\n" + PBAR + BARS.replace("0.,1.,0.", "7"),
        GRIDS + BARS.replace("CBAR", "CBEAM") + f"PBEAM,1,1,{AREA!r},{I1!r},{I2!r},,{TORSION!r}\n"
        + f",,,,,,,,\n,,,,,,,,\n,{SHEAR},{SHEAR}\n",
        "CORD2R,5,,0.,0.,0.,1.,0.,0.\n,0.,0.,1.\n" + GRIDS.replace("0.,0.\n", "0.,0.,5\n") + PBAR
        + BARS.replace("0.,1.,0.", "0.,-1.,0."),
    ],
    ids=["a point", "CBEAM", "displacement axes of the end"],
)  # fmt: skip
def test_the_same_section_by_other_cards(tmp_path, cards):
    """Axes of system 5: x along the global z, y along -y, z along x; G0 gives no rows of its own."""
    exact = np.load(EXACT)
    for found, letter in zip(matrices(tmp_path, cards), "KM", strict=True):
        assert relative(found, exact[letter]) < 1e-12


def test_a_turned_beam_has_turned_matrices(tmp_path):
    """The rotation takes x to (2, 1, 2)/3, y to (-2, 2, 1)/3."""
    turn = np.array([[2, -2, -1], [1, 2, -2], [2, 1, 2]]) / 3
    places = [turn @ (x, 0, 0) for x in (0.0, 0.5, 1.0)]
    grids = "".join(f"GRID,{101 + i},,{','.join(map(repr, map(float, p)))}\n" for i, p in enumerate(places))
    bars = BARS.replace("0.,1.,0.", "-2.,2.,1.")
    whole, exact = np.kron(np.eye(6), turn), np.load(EXACT)
    for found, letter in zip(matrices(tmp_path, grids + bars + PBAR), "KM", strict=True):
        assert relative(whole.T @ found @ whole, exact[letter]) < 1e-12


def test_frequencies_of_a_free_slender_beam_are_those_of_euler_and_bernoulli(tmp_path):
    """Twelve beams without shear; rotary inertia lowers the first by (kL)² I/(A L²)/2 parts, 1e-6 here.

    λ = 4.73004074, 7.85320462, 10.9956078; consistent cubics err by (λ/n)⁴/720 (Hughes (1987), 7.3.2).
    """
    n, side = 12, 1e-3
    grids = "".join(f"GRID,{1 + i},,{i / n!r},0.,0.\n" for i in range(n + 1))
    bars = "".join(f"CBAR,{i},1,{i},{i + 1},0.,1.,0.\n" for i in range(1, n + 1))
    area, inertia = side**2, side**4 / 12
    text = f"{grids}{bars}PBAR,1,1,{area!r},{inertia!r},{inertia!r},{inertia!r}\n"
    K, M = matrices(tmp_path, text, (2.1e11, 0.3, 7800.0))
    bending = [6 * i + c for i in range(n + 1) for c in (1, 5)]
    values = scipy.linalg.eigh(K[np.ix_(bending, bending)], M[np.ix_(bending, bending)], eigvals_only=True)
    expected = np.array([4.73004074, 7.85320462, 10.9956078]) ** 2 * np.sqrt(2.1e11 * inertia / 7800 / area)
    error = (np.array([4.73, 7.85, 11.0]) / n) ** 4 / 720 + 1e-5
    assert (np.abs(np.sqrt(values[2:5]) / expected - 1) < error).all()


def test_mass_and_inertia_of_a_beam_with_mass_that_is_no_material(tmp_path):
    """A rigid body: m = (ρ A + μ) L, about the end m L²/3 and ρ I L, along the beam ρ (I1 + I2) L."""
    _, M = matrices(tmp_path, GRIDS + BARS + PBAR.replace(f"{TORSION!r},,", f"{TORSION!r},.46,"))
    R = np.zeros((18, 6))
    for i, x in enumerate((0.0, 0.5, 1.0)):
        R[6 * i : 6 * i + 6] = np.eye(6)
        R[6 * i + 1, 5], R[6 * i + 2, 4] = x, -x
    rigid = R.T @ M @ R
    assert np.diag(rigid)[:4] == pytest.approx([1.0, 1.0, 1.0, 2700 * (I1 + I2)], rel=1e-12)
    assert np.diag(rigid)[4:] == pytest.approx([1 / 3 + 2700 * I2, 1 / 3 + 2700 * I1], rel=1e-12)


REFUSED = {
    "another material": (MATERIAL.replace("7.", "6.") + BARS + PBAR, "E is 6.+10, and 7e.10 on MATL"),
    "pins": (BARS.replace("0.,1.,0.\nCBAR,2", "0.,1.,0.,,\n,,5\nCBAR,2") + PBAR, "pins and offsets"),
    "no property": (BARS, "there is no PBAR 1"),
    "a product of inertia": (
        BARS + f"PBEAM,2,1,1.,1.,1.,.5,1.\n{PBAR}", "I12 zero: turn the axes to the principal",
    ),
    "stations": (BARS + f"PBEAM,2,1,1.,1.,1.,,1.,,,\n,,,,,,,,\n,YES,1.,2.,2.\n{PBAR}", "give one section"),
    "a vector along the beam": (BARS.replace("0.,1.,0.", "1.,0.,0.") + PBAR, "lies along the beam"),
    "a missing point": (BARS.replace("103", "104") + PBAR, "there is no GRID 104"),
    "a number twice": (BARS.replace("CBAR,2", "CBAR,1") + PBAR, "two beams of one number"),
}  # fmt: skip


@pytest.mark.parametrize("case", REFUSED)
def test_beams_that_cannot_be_used_are_refused(tmp_path, case):
    text, words = REFUSED[case]
    with pytest.raises(FEFileFault, match=words):
        list(matrices(tmp_path, GRIDS + text))


def test_a_lumped_mass_is_refused(tmp_path):
    (tmp_path / "x").write_text(GRIDS + BARS + PBAR)
    material = ElementMaterial(FEFile(tmp_path / "x", "BDF"), 7e10, 0.33, None, 2700.0, lumped=True)
    with pytest.raises(FEFileFault, match="the mass of beams and shells is consistent"):
        matrix_of_structures(material, "M")


def test_a_file_with_solid_elements_is_no_file_of_beams(tmp_path):
    (tmp_path / "x").write_text(GRIDS + BARS + PBAR)
    assert has_structures(tmp_path / "x", "BDF")
    (tmp_path / "x").write_text(GRIDS + BARS + PBAR + "CHEXA,1,1,1,2,3,4,5,6\n,7,8\n")
    assert not has_structures(tmp_path / "x", "BDF")


@pytest.mark.long_motion
def test_a_beam_of_elements_on_a_crank_moves_like_a_geometrically_exact_beam():
    """beam_elements.vsdf: the problem of tests/fe/row_bodies, whose beam is exact to 2e-5 m."""
    result = solve(DECKS / "beam_elements.vsdf")
    times, places, _ = motion("beam_pendulum_truth")
    tip = np.column_stack([result[f"point.1.{x}"] for x in "xyz"])
    assert times == pytest.approx(result["time"], abs=1e-12)
    assert np.linalg.norm(tip - places, axis=1).max() < 3e-4
