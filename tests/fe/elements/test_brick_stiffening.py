"""Geometric stiffness from bricks: against matrices supplied, Southwell's coefficient, and element theory."""

from dataclasses import dataclass, replace

import numpy as np
import pytest
from scipy import sparse
from scipy.integrate import trapezoid
from scipy.io import mmread
from scipy.spatial.transform import Rotation

from flexmb_cli.errors import ModelError
from flexmb_cli.fe.build_mechanism import flexible_mechanism
from flexmb_cli.fe.elements.assembled_matrices import formulation_of
from flexmb_cli.fe.elements.element_stiffness import (
    element_stiffness,
    initial_stress_matrix,
    matching_elements,
)
from flexmb_cli.fe.elements.solid_elements import CUBE, FORMULATIONS, elasticity, shape_slopes, solid_elements
from flexmb_cli.fe.flexible_bodies import flexible_body
from flexmb_cli.fe.formats.connectivity import read_elements
from flexmb_cli.fe.formats.formats import read_matrix
from flexmb_cli.fe.formats.node_table import read_node_table
from flexmb_cli.fe.nodal_matrices import condensed
from flexmb_cli.model.flexible_body import ElementMaterial, FEFile
from scripts.brick_beam import Beam, run_calculix
from tests.dialects.vsdf.vsdf_decks import build, reported, supplied
from tests.fe.calculix import needs_ccx
from tests.fe.supplied import FILES, body, nodes, pendulum, spin_up
from tests.fe.trusses import write_matrix

# 30 x 1 x 1 bricks with incompatible modes; four nodes a section, in the order (y, z).
SPIN_UP = np.array([[4 * i + a for a in (1, 5, 7, 3, 2, 6, 8, 4)] for i in range(30)])
YOUNG, POISSON = 7e10, 0.3


def spin_up_bricks(folder, young=YOUNG, poisson=POISSON, **choices):
    """The cantilever of the spin-up with its elements instead of the supplied matrices."""
    table = nodes("spinup_nodes.txt")
    rows = [f"{i}, " + ", ".join(map(str, brick)) for i, brick in enumerate(SPIN_UP, start=1)]
    places = [
        f"{n}, {x!r}, {y!r}, {z!r}"
        for n, (x, y, z) in zip(table.numbers, table.positions.tolist(), strict=True)
    ]
    path = folder / "spinup.inp"
    path.write_text("\n".join(["*NODE", *places, "*ELEMENT, TYPE=C3D8I", *rows]) + "\n")
    given = replace(spin_up(**choices), unit_loads=())
    return replace(given, stiffening=ElementMaterial(FEFile(path, "INP"), young, poisson))


def test_the_supplied_matrices_of_the_spin_up_are_found_to_their_digits(tmp_path):
    """spinup_KG_xx and _yy have twelve digits; yy is a thousandth of xx."""
    found, wanted = body(spin_up_bricks(tmp_path, modes=12)).KG, body(spin_up(modes=12)).KG
    for i in (0, 1):
        np.testing.assert_allclose(found[i, i], wanted[i, i], rtol=0, atol=1e-8 * np.abs(wanted[i, i]).max())


def test_the_formulation_is_told_from_the_stiffness_and_decides_on_the_stresses():
    """Bricks of full integration are stiffer by 7 % and would have another stress in every direction."""
    table, K = nodes("spinup_nodes.txt"), mmread(FILES / "spinup_K.mtx").tocsc()
    found = matching_elements(table.positions, SPIN_UP - 1, (YOUNG, POISSON), K)
    assert found.elements.formulation.name == "incompatible modes"
    assert found.deviation < 1e-10


def pendulum_bricks(**choices):
    """The rod of 8 x 2 x 1 bricks, its joint's face clamped; elements of the archive."""
    given = pendulum(clamped=(1, 2, 3, 4, 5, 6), modes=6, **choices)
    return replace(given, stiffening=ElementMaterial(FEFile(FILES / "pendulum.cdb", "CDB"), 1e7, 0.49))


def test_six_loads_make_the_stiffening_independent_of_the_axes(tmp_path):
    """A rod in axes turned about a line off all axes has the same K_G for the same spin."""
    turn = Rotation.from_rotvec([0.4, -0.7, 0.5]).as_matrix()
    straight, block = body(pendulum_bricks()), sparse.kron(sparse.identity(54), sparse.csc_matrix(turn))
    for letter in "MK":
        matrix = block @ mmread(FILES / f"pendulum_{letter}.mtx").tocsc() @ block.T
        write_matrix(tmp_path / f"{letter}.mtx", matrix.toarray())
    given = replace(
        pendulum_bricks(),
        mass=FEFile(tmp_path / "M.mtx", "MM"),
        stiffness=FEFile(tmp_path / "K.mtx", "MM"),
        positions=nodes().positions @ turn.T,
    )
    turned, spin = body(given), np.array([3.0, -5.0, 9.0])
    wanted = np.einsum("ij,ijkl->kl", _squared(spin), straight.KG)
    found = np.einsum("ij,ijkl->kl", _squared(turn @ spin), turned.KG)
    # Which sign a mode has depends on the axes.
    signs = np.sign(np.einsum("ik,ik->k", block @ straight.Phi, turned.Phi))
    np.testing.assert_allclose(found * np.outer(signs, signs), wanted, atol=1e-8 * np.abs(wanted).max())


def _squared(w):
    tilde = np.array([[0, -w[2], w[1]], [w[2], 0, -w[0]], [-w[1], w[0], 0]])
    return tilde @ tilde


def test_a_free_rod_in_mean_axes_is_stiffened_by_its_pull():
    """Pull of a uniform rod that turns about its middle, mu w² (L²/4 - x²)/2, on its first free-free mode.

    Per w² and unit modal mass: the integral of (L²/4 - x²)/2 f'² over that of f², beta L = 4.730041.
    """
    x = np.linspace(0.0, 1.0, 4001)
    b, s = 4.730041, 0.982502
    mode = np.cosh(b * x) + np.cos(b * x) - s * (np.sinh(b * x) + np.sin(b * x))
    slope = np.gradient(mode, x, edge_order=2)
    expected = trapezoid(x * (1 - x) / 2 * slope**2, x) / trapezoid(mode**2, x)
    given = replace(pendulum(modes=2, mean=True), stiffening=pendulum_bricks().stiffening)
    KG = body(given).KG
    found = np.diag(-(KG[0, 0] + KG[1, 1]))
    # A depth of a tenth to a seventh of the length bends by shear too.
    assert found == pytest.approx([expected] * 2, rel=0.08)


@pytest.mark.parametrize("change, message", [
    ({"young": 2 * YOUNG}, "check E and nu"),
    ({"poisson": 0.0}, "check E and nu"),
])  # fmt: skip
def test_a_material_that_does_not_make_the_stiffness_is_refused(tmp_path, change, message):
    with pytest.raises(ModelError) as refused:
        flexible_body(spin_up_bricks(tmp_path, modes=3, **change), cached=False)
    assert message in str(refused.value)


# A skewed brick of CalculiX 2.20, *ELEMENT, TYPE=C3D8I, E = 1 Pa, nu = 0.3: its corners, m, and the diagonal
# of its stiffness, N/m, of nodes 1 and 2, internal freedoms condensed.
SKEWED = np.array([
    [0.05, 0.16, 0.11], [0.9, -0.02, 0.0], [1.05, 1.2, -0.11], [-0.2, 1.13, 0.12],
    [-0.11, -0.08, 1.15], [1.02, 0.2, 1.12], [0.86, 1.05, 0.82], [-0.01, 0.92, 0.91],
])  # fmt: skip
OF_CALCULIX = [0.2715232648610497, 0.2762307224521956, 0.28562692319480637,
               0.1944996692327593, 0.229159894600302, 0.21098439973156444]  # fmt: skip


def test_a_skewed_brick_has_the_stiffness_that_calculix_prints():
    """Gradients of incompatible modes by the Jacobian at the centre, without the factor det J0 / det J."""
    deviations = {}
    for formulation in FORMULATIONS[8]:
        made = solid_elements(SKEWED, np.arange(8)[None], formulation)
        found = np.diag(element_stiffness(made, elasticity(1.0, 0.3))[0][0])[:6]
        deviations[formulation.name] = np.abs(found - OF_CALCULIX).max()
    assert deviations.pop("incompatible modes of CalculiX") < 1e-13
    assert min(deviations.values()) > 1e-4


@pytest.mark.parametrize("program", ["", "CCX"])
def test_a_c3d8i_is_made_as_calculix_makes_it_where_the_deck_names_no_other_program(program):
    """It was the brick of Taylor, Beresford and Wilson while the table of bodies called it CalculiX'."""
    made = solid_elements(SKEWED, np.arange(8)[None], formulation_of("C3D8I", 8, program))
    found = np.diag(element_stiffness(made, elasticity(1.0, 0.3))[0][0])[:6]
    np.testing.assert_allclose(found, OF_CALCULIX, rtol=0, atol=1e-13)


@dataclass(frozen=True)
class Skewed(Beam):
    """A beam with every node moved by a tenth of a cell or so."""

    def mesh(self):
        nodes, elements = super().mesh()
        moves = np.random.default_rng(4).uniform(-0.02, 0.02, (len(nodes), 3))
        # CalculiX reads twenty columns of a number.
        moved = np.round(np.array(list(nodes.values())) + moves, 6).tolist()
        return {node: tuple(place) for node, place in zip(nodes, moved, strict=True)}, elements


@needs_ccx
@pytest.mark.processes
def test_skewed_bricks_of_calculix_are_recognised(tmp_path):
    beam = Skewed((0.4, 0.1, 0.1), (4, 1, 1), "C3D8I")
    (tmp_path / "b.inp").write_text(beam.input())
    run_calculix(tmp_path, "b")
    given = calculix_body(tmp_path, beam, modes=2, clamped=(1, 2, 3, 4))
    assert body(given).KG.any()
    table, rows = read_node_table(tmp_path / "b.inp", "INP"), np.array(beam.mesh()[1]) - 1
    matrix = read_matrix(given.stiffness.path, "CCX", "K", given.mapping.path, "CCX")
    K = condensed("K", matrix, table.numbers).matrix
    found = matching_elements(table.positions, rows, (beam.young, beam.poisson), K)
    assert found.elements.formulation.name == "incompatible modes of CalculiX"
    assert found.deviation < 1e-12


def calculix_body(folder, beam, **choices):
    """The matrices b.mas and b.sti that CalculiX wrote for the beam, with its elements and material."""
    table = read_node_table(folder / "b.inp", "INP")
    return replace(
        spin_up(),
        mass=FEFile(folder / "b.mas", "CCX"),
        stiffness=FEFile(folder / "b.sti", "CCX"),
        mapping=FEFile(folder / "b.dof", "CCX"),
        numbers=table.numbers,
        positions=table.positions,
        unit_loads=(),
        stiffening=ElementMaterial(FEFile(folder / "b.inp", "INP"), beam.young, beam.poisson),
        **choices,
    )


@needs_ccx
@pytest.mark.parametrize(
    "element, cells",
    [("C3D20R", (12, 1, 2)), ("C3D20", (12, 1, 1)), ("C3D8I", (24, 1, 1)), ("C3D10", (16, 1, 1))],
)
@pytest.mark.processes
def test_a_beam_of_calculix_stiffens_as_southwell_says(tmp_path, element, cells):
    """Cantilever turning about its root: omega² grows by 1.193 w² out of plane, by 0.193 w² in plane.

    Southwell and Gough, A. R. C. R. & M. 766 (1921); the softening in plane is the body's J_ww, not K_G's.
    """
    beam = Beam((0.5, 0.01, 0.02), cells, element)
    (tmp_path / "b.inp").write_text(beam.input())
    run_calculix(tmp_path, "b")
    clamped = tuple(beam.section(0.0))
    given = calculix_body(tmp_path, beam, modes=2, clamped=clamped)
    given = replace(given, positions=given.positions - [0.0, 0.005, 0.01])
    KG = body(given).KG
    # The first mode bends along y, the second along z; spins about z and about y stiffen both.
    for i, j in ((0, 1), (0, 2)):
        stiffening = -(KG[i, i] + KG[j, j])
        assert np.diag(stiffening) == pytest.approx([1.193, 1.193], rel=0.01)


@pytest.mark.parametrize("count", [8, 20])
def test_shape_functions_interpolate_positions_exactly(count):
    """The sum of x_a dN_a/dxi is the unit matrix on the reference cube, that of dN_a/dxi zero."""
    points = np.random.default_rng(1).uniform(-1, 1, (20, 3))
    slopes = shape_slopes(points, count)
    np.testing.assert_allclose(
        np.einsum("gkj,ki->gij", slopes, CUBE[:count]), np.tile(np.eye(3), (20, 1, 1)), atol=1e-14
    )
    np.testing.assert_allclose(slopes.sum(axis=1), 0.0, atol=1e-14)


@pytest.mark.parametrize("count", [8, 20])
def test_a_bar_under_pull_has_the_string_stiffness_of_its_pull(count):
    """sigma = E strain in x alone, nu = 0: w' K_G w over the linear field w = x is sigma A L."""
    beam = Beam((2.0, 0.1, 0.1), (4, 1, 1), "C3D8I" if count == 8 else "C3D20", poisson=0.0)
    placed, elements = beam.mesh()
    positions = np.array(list(placed.values()))
    rows = np.array(elements) - 1
    for formulation in FORMULATIONS[count]:
        made = solid_elements(positions, rows, formulation)
        assert made.volumes.sum() == pytest.approx(0.02, rel=1e-13)
    found = matching_elements(positions, rows, (beam.young, 0.0), sparse.identity(3 * len(positions)).tocsc())
    stretched = np.zeros(positions.shape)
    stretched[:, 0] = 1e-3 * positions[:, 0]
    scalars = initial_stress_matrix(found, stretched.ravel())
    x = positions[:, 0]
    assert x @ (scalars @ x) == pytest.approx(1e-3 * beam.young * 0.01 * 2.0, rel=1e-12)


def test_hookes_law_in_pure_shear_and_under_pressure():
    D = elasticity(2.0e11, 0.25)
    assert D[3, 3] == pytest.approx(8.0e10)
    assert D[:3, :3].sum() / 9 == pytest.approx(2.0e11 / (3 * (1 - 0.5)))


def test_elements_come_in_the_same_order_from_every_format():
    archive = read_elements(FILES / "pendulum.cdb", "CDB")
    wanted = read_elements(FILES / "calculix/pendulum.inp", "INP")
    np.testing.assert_array_equal(archive.nodes, wanted.nodes)
    np.testing.assert_array_equal(archive.numbers, np.arange(1, 17))


def deck(*changes):
    """The pendulum on the archive's elements."""
    return supplied(
        "pendulum",
        ("TXT  fe/pendulum_nodes.txt", "CDB  fe/pendulum.cdb"),
        ("GRAV", "GEOS\n{}\nGRAV".format(*changes)),
    )


def test_a_deck_asks_for_it_by_the_material_on_geos():
    mechanism, warnings = flexible_mechanism(build(deck("    1    1     1.0E7      0.49")), cached=False)
    assert mechanism.bodies[0].stiffened
    assert mechanism.bodies[0].flexible.KG.shape == (3, 3, 9, 9)
    assert warnings == []


FAULTS = {
    "    1    1": "stiffening needs geometric stiffness matrices, cards FEMG, or E and nu of the elements",
    "    1    1    -1.0E7      0.49": "Young's modulus must be above zero; read -1.0E7",
    "    1    1     1.0E7      0.50": "Poisson's ratio lies between -1 and 0.5; read 0.50",
}


@pytest.mark.parametrize("card", FAULTS)
def test_a_material_that_cannot_be_is_refused_at_its_card(card):
    assert any(FAULTS[card] in fault for fault in reported(deck(card)))


def test_matrices_and_bricks_at_once_are_refused():
    text = supplied("spinup", ("GEOS\n    1    1\n", "GEOS\n    1    1     7.E10       0.3\n"))
    assert any("either from the matrices of FEMG or from elements" in fault for fault in reported(text))
