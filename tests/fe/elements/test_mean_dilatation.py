"""C3D8 of Abaqus: mean-dilatation bricks against bricks of loops, patch tests, and a cantilever's stress.

The bar of 0.9 x 0.12 x 0.08 m is the one of a public report; its stress of 448743 Pa and its frequencies
follow from own bricks whose stiffness agrees with Abaqus' own to 7e-15.
"""

import itertools

import numpy as np
import pytest
from click.testing import CliRunner
from scipy.linalg import eigh

from flexmb_cli.cli.check import check
from flexmb_cli.cli.run import run
from flexmb_cli.cli.table import table
from flexmb_cli.dialects.vsdf.build import build_vsdf
from flexmb_cli.errors import ModelError
from flexmb_cli.fe.elements.element_stiffness import BodyElements, assembled, element_stiffness
from flexmb_cli.fe.elements.solid_elements import FORMULATIONS, elasticity, solid_elements
from flexmb_cli.fe.elements.stress_shapes import nodal_stresses
from flexmb_cli.fe.flexible_bodies import flexible_body
from tests.dialects.vsdf.vsdf_decks import read
from tests.fe.elements.test_stresses import Skewed
from tests.fe.trusses import write_matrix
from tests.naive.mean_dilatation_brick import matrices

MATERIAL = 7e10, 0.33, 2700.0
BAR = np.array(list(itertools.product(np.linspace(0, 0.9, 7), (0, 0.12), (0, 0.08))))
BRICKS = [[4 * i + k for k in (0, 4, 6, 2, 1, 5, 7, 3)] for i in range(6)]
MEAN = next(one for one in FORMULATIONS[8] if one.name == "mean dilatation")
STRAIN = np.array([[1e-3, 4e-4, -3e-4], [4e-4, -2e-3, 7e-4], [-3e-4, 7e-4, 5e-4]])


def write_bar(folder, K=None, kind="C3D8"):
    """The bar's mesh, and its matrices where `K` is given."""
    lines = ["*NODE", *(f"{n}, {x:.17g}, {y:.17g}, {z:.17g}" for n, (x, y, z) in enumerate(BAR, start=1))]
    lines.append(f"*ELEMENT, TYPE={kind}")
    lines += [", ".join(map(str, [m, *(k + 1 for k in nodes)])) for m, nodes in enumerate(BRICKS, start=1)]
    (folder / "bar.inp").write_text("\n".join(lines) + "\n")
    if K is not None:
        write_matrix(folder / "K.mtx", K)
        write_matrix(folder / "M.mtx", matrices(BAR, BRICKS, MATERIAL, averaged=True)[0])
    return folder


def deck(files, cards="", modes=0):
    return (
        f"VSDF BAR\nBODY\n1,FLEX,{modes}\nFEMN\n    1 INP  bar.inp\n{files}{cards}"
        "TIME\n0.05,0.025\nEND\nSTAR\nSTOP\n"
    )


WITH_FILES = "FEMM\n    1 MM   M.mtx\nFEMK\n    1 MM   K.mtx\nMATL\n1,7E10,0.33\n"
OF_ELEMENTS = "MATL\n1,7E10,0.33,2700\n"
CANTILEVER = (
    "CLMP\n1,1,2,3,4\nMOTN\n"
    + "".join(
        f"{k},{word},1,1\n" for k, word in enumerate(("TRAX", "TRAY", "TRAZ", "ROTX", "ROTY", "ROTZ"), 1)
    )
    + "FORC\n"
    + "".join(f"1,{node},0,0,125.0\n" for node in (25, 26, 27, 28))
    + "DAMP\n1,0,0,0.9\nINTG\n RAD5,1E-8\nOUTS\n1,NODE\n1,MAX\n"
)


def body_of(folder, text):
    """The flexible body of a deck in `folder`, and what is said of it."""
    (given,) = build_vsdf(read(text), folder)[0].bodies
    return flexible_body(given.flexible, cached=False)


def refusal(folder, text):
    with pytest.raises(ModelError) as stopped:
        body_of(folder, text)
    return "\n".join(fault.message for fault in stopped.value.faults)


def skewed():
    placed, elements = Skewed((0.3, 0.2, 0.2), (2, 2, 2), "C3D8").mesh()
    return np.array(list(placed.values())), np.array(elements) - 1


def test_the_stiffness_of_a_skewed_block_is_that_of_bricks_by_loops():
    positions, rows = skewed()
    made = solid_elements(positions, rows, MEAN)
    found = assembled(element_stiffness(made, elasticity(*MATERIAL[:2]))[0], rows, len(positions), 3)
    wanted = matrices(positions, rows, MATERIAL, averaged=True)[1]
    assert abs(found - wanted).max() < 1e-14 * abs(wanted).max()


def test_a_skewed_block_under_uniform_strain_has_its_stress_and_no_force_inside():
    positions, rows = skewed()
    made, D = solid_elements(positions, rows, MEAN), elasticity(*MATERIAL[:2])
    stiffness, internal = element_stiffness(made, D)
    moved = (positions @ STRAIN).reshape(-1, 1)
    forces = (assembled(stiffness, rows, len(positions), 3) @ moved).reshape(-1, 3)
    (inner,) = np.flatnonzero(np.bincount(rows.ravel()) == 8)
    assert abs(forces[inner]).max() < 1e-12 * abs(forces).max()
    shears = 2 * STRAIN[[0, 1, 2], [1, 2, 0]]
    stress = D @ np.concatenate([np.diag(STRAIN), shears])
    found = nodal_stresses(BodyElements(made, D, internal, 0.0), moved)[..., 0]
    np.testing.assert_allclose(found, np.tile(stress, (len(found), 1)), rtol=1e-11)


def test_the_stress_of_a_cantilever_of_abaqus_bricks_is_found(tmp_path):
    """At rest under its forces; the centres of its bricks have none, and -3e-7 Pa was reported."""
    write_bar(tmp_path, matrices(BAR, BRICKS, MATERIAL, averaged=True)[1])
    body, said = body_of(tmp_path, deck(WITH_FILES, "CLMP\n1,1,2,3,4\n"))
    eta = 125.0 * sum(body.shape(node)[2] for node in (25, 26, 27, 28)) / np.diag(body.Kr)
    assert body.stress.nodal[12, 0] @ eta == pytest.approx(448743, rel=1e-5)
    assert not said


@pytest.mark.long_motion
def test_a_damped_run_ends_at_that_stress(tmp_path):
    write_bar(tmp_path, matrices(BAR, BRICKS, MATERIAL, averaged=True)[1])
    (tmp_path / "bar.vsdf").write_text(deck(WITH_FILES, CANTILEVER))
    done = CliRunner().invoke(run, [str(tmp_path / "bar.vsdf"), "-o", str(tmp_path), "--strict"])
    assert done.exit_code == 0, done.output
    shown = CliRunner().invoke(table, [str(tmp_path / "bar.h5"), "stress.1.node13.xx", "-q"])
    assert float(shown.stdout.splitlines()[-1].split(",")[1]) == pytest.approx(448743, rel=1e-5)


@pytest.mark.parametrize("types, hertz", [
    ("ABQ", (693.0435, 760.5572, 1621.3220)), ("CCX", (828.6488, 993.8358, 1622.2758)),
])  # fmt: skip
def test_the_deck_says_whose_types_its_elements_have(types, hertz, tmp_path):
    text = deck(OF_ELEMENTS, f"ELMT\n1,{types}\n", modes=3)
    body, said = body_of(write_bar(tmp_path), text)
    assert body.frequencies == pytest.approx(hertz, rel=1e-7)
    assert body.m == pytest.approx(23.328, rel=1e-12)
    assert not said


def test_a_lumped_mass_is_that_of_bricks_by_loops(tmp_path):
    body, _ = body_of(write_bar(tmp_path), deck(OF_ELEMENTS, "ELMT\n1,ABQ,LUMP\n", modes=10))
    M, K = matrices(BAR, BRICKS, MATERIAL, averaged=True, lumped=True)
    omega = np.sqrt(eigh(K, M, eigvals_only=True)[6:16])
    assert body.frequencies == pytest.approx(omega / (2 * np.pi), rel=1e-9)
    assert body.stress.assembled == "C3D8 of Abaqus, lumped mass"


def test_a_deck_that_does_not_say_so_is_told_which_types_are_taken(tmp_path):
    path = write_bar(tmp_path) / "bar.vsdf"
    path.write_text(deck(OF_ELEMENTS, modes=3))
    done = CliRunner().invoke(check, [str(path)])
    assert "C3D8 is taken as in CalculiX, fully integrated; Abaqus averages" in done.stderr
    assert "6 elements, full integration; M and K made of C3D8 of CalculiX, consistent mass" in done.stdout


@pytest.mark.parametrize("cards, kind, wanted", [
    ("ELMT\n1,ABQ\n", "C3D8I", "type C3D8I of Abaqus; known are C3D4, C3D8, C3D10, C3D20, C3D20R"),
    ("ELMT\n1,ABQ\n", "C3D8R", "C3D8R needs forces against hourglasses, which no file contains; use C3D8"),
])  # fmt: skip
def test_types_whose_formulation_nobody_has_published_are_refused(cards, kind, wanted, tmp_path):
    assert wanted in refusal(write_bar(tmp_path, kind=kind), deck(OF_ELEMENTS, cards))


def test_masses_of_second_order_are_not_lumped(tmp_path):
    beam = Skewed((0.3, 0.2, 0.1), (2, 1, 1), "C3D20")
    (tmp_path / "bar.inp").write_text(beam.input())
    assert "mass of elements of 20 nodes is not lumped" in refusal(
        tmp_path, deck(OF_ELEMENTS, "ELMT\n1,,LUMP\n")
    )


HALF = [matrices(BAR, BRICKS, MATERIAL, averaged=averaged)[1] for averaged in (True, False)]


def test_stresses_of_no_known_formulation_are_refused_unless_asked_for(tmp_path):
    """Half of each of two stiffnesses is that of neither, and answers uniform strains as both do."""
    write_bar(tmp_path, sum(HALF) / 2)
    said = refusal(tmp_path, deck(WITH_FILES))
    assert "is that of no known formulation of its elements" in said
    assert "write REDU on a card ELMT" in said
    body, warned = body_of(tmp_path, deck(WITH_FILES, "ELMT\n1,,,REDU\n"))
    assert body.stress.formulation == "reduced integration"
    assert "stresses are taken at the points of reduced integration" in warned[0].message


def test_c3d8r_has_the_stress_of_its_centre_whatever_holds_its_hourglasses(tmp_path):
    write_bar(tmp_path, sum(HALF) / 2, kind="C3D8R")
    body, warned = body_of(tmp_path, deck(WITH_FILES))
    assert body.stress.formulation == "reduced integration"
    assert "those of a brick's centre miss its bending" in warned[0].message


@pytest.mark.parametrize("files, cards, wanted", [
    (WITH_FILES, "ELMT\n1,,CONS\n", "the mass of body 1 is that of FEMM; leave the field empty"),
    (WITH_FILES.partition("MATL")[0], "ELMT\n1,ABQ\n", "body 1 needs a card MATL"),
])  # fmt: skip
def test_words_about_elements_without_effect_are_refused(files, cards, wanted, tmp_path):
    write_bar(tmp_path, HALF[0])
    assert wanted in refusal(tmp_path, deck(files, cards))
