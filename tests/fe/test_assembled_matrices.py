"""Matrices of a body from its elements: against CalculiX, and against what every mesh must have."""

import numpy as np
import pytest

from flexmb_cli.errors import ModelError
from flexmb_cli.fe.elements.assembled_matrices import element_matrix, shape_values
from flexmb_cli.fe.elements.body_elements import BodyTable
from flexmb_cli.fe.elements.solid_elements import CUBE
from flexmb_cli.fe.elements.stress_shapes import point_stresses
from flexmb_cli.fe.elements.tetrahedra import NODES
from flexmb_cli.fe.flexible_bodies import flexible_body
from flexmb_cli.fe.formats.formats import OF_ELEMENTS, read_matrix
from flexmb_cli.fe.formats.node_table import read_node_table
from flexmb_cli.fe.linear_algebra import summed
from flexmb_cli.fe.nodal_matrices import condensed, nodal_part
from flexmb_cli.model.flexible_body import ElementMaterial, FEFile, FlexibleInput
from flexmb_cli.model.flexible_mechanism import FloatingBody, StressOutput
from flexmb_cli.results.hdf5.stress import element_energies
from scripts.brick_beam import Beam, run_calculix
from tests.fe.calculix import needs_ccx
from tests.fe.elements.test_stresses import Skewed

DENSITY = 7850.0


def meshed(folder, beam, **choices) -> FlexibleInput:
    """The body of the beam's mesh, without any matrix."""
    path = folder / "b.inp"
    path.write_text(beam.input())
    table, elements = read_node_table(path, "INP"), FEFile(path, OF_ELEMENTS)
    material = ElementMaterial(FEFile(path, "INP"), beam.young, beam.poisson, None, beam.density)
    return FlexibleInput(
        "body 1", elements, elements, table.numbers, table.positions, material=material, **choices
    )


def matrices(given, beam):
    """M and K of the mesh."""
    rows = np.array(beam.mesh()[1]) - 1
    table = BodyTable(np.arange(1, len(rows) + 1), rows, beam.element)
    found = [element_matrix(given, table, letter) for letter in "MK"]
    return [np.asarray(summed(one.values, one.rows, one.columns, one.size)) for one in found]


@needs_ccx
@pytest.mark.processes
@pytest.mark.parametrize("element, mass", [
    ("C3D4", False), ("C3D10", False), ("C3D8", True), ("C3D20", True), ("C3D20R", False),
])  # fmt: skip
def test_matrices_of_a_skewed_block_are_those_that_calculix_writes(tmp_path, element, mass):
    """Masses only where CalculiX integrates them fully; elsewhere it takes the points of the stiffness."""
    beam = Skewed((0.2, 0.1, 0.1), (2, 1, 1), element)
    given = meshed(tmp_path, beam)
    run_calculix(tmp_path, "b")
    M, K = matrices(given, beam)
    for letter, suffix, found, arrange in (("M", "mas", M, nodal_part), ("K", "sti", K, condensed)):
        if letter == "K" or mass:
            file = read_matrix(tmp_path / f"b.{suffix}", "CCX", letter, tmp_path / "b.dof", "CCX")
            wanted = np.asarray(arrange("b", file, given.numbers).matrix)
            assert np.abs(found - wanted).max() < 1e-12 * np.abs(wanted).max()


@pytest.mark.parametrize("element", ["C3D4", "C3D10", "C3D8", "C3D20"])
def test_a_block_has_the_mass_and_the_inertia_of_a_box(element, tmp_path):
    """x' M x is the integral of rho x² over a box with a corner at the origin, rho V a²/3, and so on."""
    beam = Beam((0.3, 0.2, 0.1), (2, 1, 1), element)
    given = meshed(tmp_path, beam)
    M = matrices(given, beam)[0][::3, ::3]
    mass = DENSITY * 0.3 * 0.2 * 0.1
    assert M.sum() == pytest.approx(mass, rel=1e-12)
    second = given.positions.T @ M @ given.positions
    assert np.diag(second) == pytest.approx([mass * a**2 / 3 for a in beam.size], rel=1e-12)
    assert second[0, 1] == pytest.approx(mass * 0.3 * 0.2 / 4, rel=1e-12)


def test_products_of_quadratic_functions_in_a_tetrahedron_are_integrated_exactly(tmp_path):
    """M of a straight element of ten nodes: 6 m/420 at a corner, 32 m/420 at a middle (degree 4)."""
    (tmp_path / "b.inp").write_text(
        "*NODE\n" + "".join(f"{n},{x},{y},{z}\n" for n, (x, y, z) in enumerate(NODES, start=1))
        + "*ELEMENT, TYPE=C3D10\n1, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10\n"
    )  # fmt: skip
    file = FEFile(tmp_path / "b.inp", "INP")
    given = FlexibleInput(
        "b", file, file, np.arange(1, 11), NODES, material=ElementMaterial(file, 1.0, 0.0, None, 6.0)
    )
    found = element_matrix(given, BodyTable(np.array([1]), np.arange(10)[None], "C3D10"), "M")
    diagonal = np.diag(np.asarray(summed(found.values, found.rows, found.columns, found.size)))[::3]
    assert diagonal == pytest.approx([6 / 420] * 4 + [32 / 420] * 6, rel=1e-12)


@pytest.mark.parametrize("nodes", [4, 8, 10, 20])
def test_shape_functions_are_one_at_their_node_and_zero_at_the_others(nodes):
    places = NODES[:nodes] if nodes in (4, 10) else CUBE[:nodes]
    np.testing.assert_allclose(shape_values(places, nodes), np.eye(nodes), atol=1e-14)


@pytest.mark.parametrize("element", ["C3D4", "C3D10", "C3D8", "C3D8I", "C3D20", "C3D20R"])
def test_element_energies_are_half_eta_k_eta_to_ten_digits(tmp_path, element):
    beam = Skewed((0.3, 0.2, 0.2), (2, 2, 2), element)
    body = flexible_body(meshed(tmp_path, beam, modes=20), cached=False)[0]
    points, volumes = point_stresses(body, np.arange(len(body.stress.rows)))
    output = StressOutput(0, np.zeros(0), np.zeros((0, 6, 20)), body.stress.numbers, points, volumes)
    floating = FloatingBody("body 1", *np.zeros((4, 3)), body.m, body.s0, body.J0, body)
    eta = np.random.default_rng(2).normal(size=(5, 20))
    expected = np.einsum("tm,mn,tn->t", eta, body.Kr, eta) / 2
    np.testing.assert_allclose(element_energies(output, floating, eta).sum(axis=1), expected, rtol=1e-10)


def refused(folder, element, changed):
    """Return what is said of the block after `changed` has rewritten its file."""
    given = meshed(folder, Beam((0.3, 0.2, 0.1), (2, 1, 1), element))
    path = given.material.file.path
    path.write_text(changed(path.read_text()))
    with pytest.raises(ModelError) as fault:
        flexible_body(given, cached=False)
    return "\n".join(one.message for one in fault.value.faults)


@pytest.mark.parametrize("element, unknown", [
    ("C3D20", "C3D20RH"), ("C3D8", "C3D8H"), ("C3D10", "C3D10M"), ("C3D8", "C3D8RH"),
])  # fmt: skip
def test_elements_of_unknown_types_are_refused_by_their_name(tmp_path, element, unknown):
    said = refused(tmp_path, element, lambda text: text.replace(f"TYPE={element}", f"TYPE={unknown}"))
    assert f"elements of type {unknown}; known are C3D4, C3D8, C3D8I, C3D10, C3D20, C3D20R" in said


SECOND = "2, 5, 9, 11, 7, 6, 10, 12, 8\n"  # the second of two bricks


def test_an_element_given_twice_does_not_count_twice(tmp_path):
    """Its mass was added once more in silence."""
    said = refused(tmp_path, "C3D8", lambda text: text.replace(SECOND, SECOND + SECOND))
    assert said.count("b.inp: element 2 stands on lines 16 and 17") == 1


def test_elements_of_different_numbers_on_the_same_nodes_are_told(tmp_path):
    """The third turns the second by a quarter: its mass of 0.15 x 0.2 x 0.1 m came once more in silence."""
    given = meshed(tmp_path, Beam((0.3, 0.2, 0.1), (2, 1, 1), "C3D8", density=DENSITY))
    path = given.material.file.path
    path.write_text(path.read_text().replace(SECOND, SECOND + "3, 9, 11, 7, 5, 10, 12, 8, 6\n"))
    body, faults = flexible_body(given, cached=False)
    assert body.m == pytest.approx(1.5 * 0.3 * 0.2 * 0.1 * DENSITY, rel=1e-12)
    (said,) = [one for one in faults if "same nodes" in one.message]
    assert "b.inp: element 3 has the same nodes as element 2; each counts" in said.message
    assert said.severity == "warning"


def test_two_types_of_one_number_of_nodes_are_refused(tmp_path):
    """All elements were taken for those of the first type."""
    said = refused(tmp_path, "C3D8", lambda text: text.replace(SECOND, "*ELEMENT, TYPE=C3D8I\n" + SECOND))
    assert "b.inp mixes elements of types C3D8 and C3D8I; use one type" in said


def test_elements_that_need_hourglass_forces_are_refused(tmp_path):
    beam = Beam((0.3, 0.2, 0.1), (2, 1, 1), "C3D8")
    given = meshed(tmp_path, beam)
    path = given.material.file.path
    path.write_text(path.read_text().replace("C3D8", "C3D8R"))
    with pytest.raises(ModelError, match="C3D8R needs forces against hourglasses"):
        flexible_body(given, cached=False)
