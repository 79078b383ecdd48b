"""Stresses of elements: patch tests, CalculiX's own figures, and element energies."""

import re
from dataclasses import dataclass

import numpy as np
import pytest

from flexmb_cli.fe.elements.element_stiffness import BodyElements, element_stiffness, stresses
from flexmb_cli.fe.elements.solid_elements import (
    CUBE,
    FORMULATIONS,
    elasticity,
    integration_points,
    solid_elements,
)
from flexmb_cli.fe.elements.stress_shapes import extrapolation, nodal_stresses
from flexmb_cli.fe.elements.tetrahedra import NODES
from flexmb_cli.results.hdf5.stress import principal_stresses, von_mises
from scripts.brick_beam import Beam, run_calculix
from tests.fe.calculix import needs_ccx

# Element of CalculiX: its formulation here.
FORMS = {
    "C3D4": "one point",
    "C3D10": "four points",
    "C3D8": "full integration",
    "C3D8I": "incompatible modes of CalculiX",
    "C3D20": "full integration",
    "C3D20R": "reduced integration",
}
YOUNG, POISSON = 2.1e11, 0.3


@dataclass(frozen=True)
class Skewed(Beam):
    """A block whose corners are moved by a tenth of a cell or so; middles of edges stay on straight edges."""

    def mesh(self):
        placed, elements = super().mesh()
        nodes = np.array(list(placed.values()))
        size = np.array(self.size)
        # A smooth map of the block, the same for corners and middles, that bends no edge.
        moved = (
            nodes
            + 0.15 * np.outer(nodes[:, 1], [1.0, 0.0, 0.0])
            + 0.1 * np.outer(nodes[:, 2], [1.0, 1.0, 0.0])
        )
        corners = {node for element in elements for node in element[: 8 if len(element) in (8, 20) else 4]}
        chance = np.random.default_rng(4)
        for node in sorted(corners):
            moved[node - 1] += chance.uniform(-0.06, 0.06, 3) * size / self.cells
        for element in elements:
            for (a, b), middle in zip(_edges(len(element)), _middles(element), strict=False):
                moved[middle - 1] = (moved[element[a] - 1] + moved[element[b] - 1]) / 2
        # CalculiX reads twenty columns of a number.
        return {n: tuple(map(float, place)) for n, place in enumerate(np.round(moved, 9), start=1)}, elements


def _edges(count):
    if count == 10:
        return [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)]
    return [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)]


def _middles(element):
    return element[4:] if len(element) == 10 else element[8:]


def block(element):
    return Skewed((0.3, 0.2, 0.2), (2, 2, 2), element, YOUNG, POISSON)


def elements_of(beam) -> tuple[np.ndarray, BodyElements]:
    """Positions of the nodes, and the elements in the formulation that CalculiX uses."""
    placed, elements = beam.mesh()
    positions, rows = np.array(list(placed.values())), np.array(elements) - 1
    name = FORMS[beam.element]
    formulation = next(one for one in FORMULATIONS[rows.shape[1]] if one.name == name)
    made = solid_elements(positions, rows, formulation)
    D = elasticity(beam.young, beam.poisson)
    return positions, BodyElements(made, D, element_stiffness(made, D)[1], 0.0)


STRAIN = np.array([[1.0e-3, 4.0e-4, -3.0e-4], [4.0e-4, -2.0e-3, 7.0e-4], [-3.0e-4, 7.0e-4, 5.0e-4]])


def hookes_stress():
    """The stress xx yy zz xy yz zx of STRAIN, Pa."""
    shear = YOUNG / (2 * (1 + POISSON))
    lame = YOUNG * POISSON / ((1 + POISSON) * (1 - 2 * POISSON))
    sigma = 2 * shear * STRAIN + lame * np.trace(STRAIN) * np.eye(3)
    return sigma[[0, 1, 2, 0, 1, 2], [0, 1, 2, 1, 2, 0]]


@pytest.mark.parametrize("element", [name for name in FORMS if name != "C3D8I"])
def test_a_skewed_patch_under_uniform_strain_has_hookes_stress_at_every_node(element):
    """sigma = 2 G eps + lambda tr(eps) E (Irons' patch test); skewed C3D8I of CalculiX do not pass it."""
    positions, made = elements_of(block(element))
    expected = hookes_stress()
    found = nodal_stresses(made, (positions @ STRAIN).reshape(-1, 1))[..., 0]
    np.testing.assert_allclose(
        found, np.tile(expected, (len(positions), 1)), atol=1e-9 * np.abs(expected).max()
    )


def test_a_skewed_patch_of_published_incompatible_modes_passes_too():
    """With the factor det J0 / det J (Taylor, Beresford and Wilson 1976, eq. 16), all six components."""
    positions, _ = elements_of(block("C3D8"))
    rows = np.array(block("C3D8").mesh()[1]) - 1
    made = solid_elements(positions, rows, FORMULATIONS[8][0])
    D = elasticity(YOUNG, POISSON)
    found = BodyElements(made, D, element_stiffness(made, D)[1], 0.0)
    stress = nodal_stresses(found, (positions @ STRAIN).reshape(-1, 1))[..., 0]
    expected = hookes_stress()
    np.testing.assert_allclose(
        stress, np.tile(expected, (len(positions), 1)), atol=1e-9 * np.abs(expected).max()
    )


def displaced(beam, moved):
    """CalculiX input of the beam with the displacements `moved` (n, 3) of all nodes, stresses printed."""
    held = [
        f"{node}, {direction}, {direction}, {value!r}"
        for node, row in enumerate(moved.tolist(), start=1)
        for direction, value in enumerate(row, start=1)
    ]
    printed = ["*EL PRINT, ELSET=EALL", "S, COORD, ELSE", "*NODE FILE", "U", "*EL FILE", "S"]
    step = ["*STATIC", "*BOUNDARY", *held, *printed]
    return beam.input().replace("*FREQUENCY, SOLVER=MATRIXSTORAGE\n1", "\n".join(step))


def printed_tables(path):
    """The tables of a .dat file: rows of numbers by the first word of their heading."""
    tables, rows = {}, None
    for line in path.read_text().splitlines():
        heading = re.match(r"\s*(stresses|global coordinates|internal energy)", line)
        if heading:
            rows = tables.setdefault(heading[1].split()[0], [])
        elif rows is not None and line.strip():
            rows.append([float(word) for word in line.split()])
    return {name: np.array(rows) for name, rows in tables.items()}


def nodal_file(path):
    """Stresses (n, 6) xx yy zz xy yz zx of the nodes in a .frd file, six digits."""
    lines = path.read_text().splitlines()
    start = next(i for i, line in enumerate(lines) if line.startswith(" -4  STRESS"))
    rows = []
    for line in lines[start + 7 :]:
        if not line.startswith(" -1"):
            break
        rows.append([float(line[13 + 12 * k : 25 + 12 * k]) for k in range(6)])
    return np.array(rows)


@needs_ccx
@pytest.mark.processes
@pytest.mark.parametrize("element", FORMS)
def test_stresses_are_calculix_own_for_the_same_displacements(tmp_path, element):
    """Random displacements of a skewed block; CalculiX prints seven digits, in its .frd file six.

    Components to 1e-6 of the largest, energies of the elements to their digits.  Its coefficients from
    points to nodes have four digits (2.549, -0.683); from 27 points it makes no least-squares fit.
    """
    beam = block(element)
    positions, made = elements_of(beam)
    moved = np.round(np.random.default_rng(7).uniform(-1e-5, 1e-5, positions.shape), 12)
    (tmp_path / "b.inp").write_text(displaced(beam, moved))
    run_calculix(tmp_path, "b")
    tables = printed_tables(tmp_path / "b.dat")
    count = len(made.elements.rows)
    found = stresses(made, moved.reshape(-1, 1), slice(0, count))[..., 0]
    theirs = tables["stresses"][:, 2:].reshape(count, -1, 6)[..., [0, 1, 2, 3, 5, 4]]
    order = _same_points(made, positions, tables["global"][:, 2:].reshape(count, -1, 3))
    ours = np.take_along_axis(found, order[..., None], axis=1)
    assert np.abs(ours - theirs).max() < 1e-6 * np.abs(theirs).max()
    energy = np.einsum("mga,ab,mgb,mg->m", found, np.linalg.inv(made.D), found, made.elements.volumes) / 2
    assert energy == pytest.approx(tables["internal"][:, 1], rel=2e-6)
    nodal = nodal_stresses(made, moved.reshape(-1, 1))[..., 0]
    if element != "C3D20":
        assert np.abs(nodal - nodal_file(tmp_path / "b.frd")).max() < 5e-5 * np.abs(nodal).max()


def _same_points(made, positions, theirs):
    """For every point of CalculiX the nearest of ours (m, g): places that agree to its digits."""
    count = made.elements.nodes
    points, _ = integration_points(count, made.elements.formulation)
    corners = 4 if count in (4, 10) else 8
    # Edges are straight: the corners' map is the element's.
    place = positions[made.elements.rows[:, :corners]]
    if corners == 4:
        weights = np.column_stack([1 - points.sum(axis=1), points])
    else:
        signs = np.array([(-1, -1, -1), (1, -1, -1), (1, 1, -1), (-1, 1, -1),
                          (-1, -1, 1), (1, -1, 1), (1, 1, 1), (-1, 1, 1)])  # fmt: skip
        weights = np.prod(1 + points[:, None] * signs, axis=-1) / 8
    ours = np.einsum("gk,mki->mgi", weights, place)
    gaps = np.linalg.norm(theirs[:, :, None] - ours[:, None], axis=-1)
    assert gaps.min(axis=-1).max() < 1e-6
    return gaps.argmin(axis=-1)


@pytest.mark.parametrize("nodes, formulation", [
    (count, one) for count, found in FORMULATIONS.items() for one in found if one.points > 1
])  # fmt: skip
def test_values_that_are_linear_in_an_element_are_exact_at_its_nodes(nodes, formulation):
    points, _ = integration_points(nodes, formulation)
    places = NODES[:nodes] if nodes in (4, 10) else CUBE[:nodes]
    slope = np.array([2.0, -3.0, 5.0])
    np.testing.assert_allclose(
        extrapolation(nodes, formulation) @ (1 + points @ slope), 1 + places @ slope, atol=1e-12
    )


def test_the_volume_and_the_first_moment_of_a_tetrahedron_come_from_its_points():
    """Exactly: 1/6 and 1/24; with four points also the second moment, 1/60."""
    for count in (1, 4):
        points, weights = integration_points(
            10 if count == 4 else 4, FORMULATIONS[10 if count == 4 else 4][0]
        )
        assert weights.sum() == pytest.approx(1 / 6)
        assert weights @ points == pytest.approx([1 / 24] * 3)
        if count == 4:
            assert weights @ points**2 == pytest.approx([1 / 60] * 3)


def test_von_mises_and_principal_stresses_of_known_states():
    """Pull p: p; pure shear t: sqrt(3) t with principal stresses t, 0, -t; pressure: 0."""
    states = np.array([[5.0, 0, 0, 0, 0, 0], [0, 0, 0, 2.0, 0, 0], [-3.0, -3.0, -3.0, 0, 0, 0]])
    assert von_mises(states) == pytest.approx([5.0, 2 * np.sqrt(3), 0.0])
    expected = np.array([[5.0, 0, 0], [2.0, 0, -2.0], [-3.0, -3.0, -3.0]])
    np.testing.assert_allclose(principal_stresses(states), expected, atol=1e-15)
