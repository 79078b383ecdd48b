"""Masses that some shapes lack: reduced integration gives mass matrices that are only semidefinite."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import eigh

from flexmb_cli.errors import ModelError
from flexmb_cli.fe.flexible_bodies import flexible_body
from scripts.brick_beam import Beam
from tests.fe.supplied import body
from tests.fe.tetrahedra import tetrahedra
from tests.fe.trusses import files_input, truss

NODES, LIGHT = 7, (5, 6)


def half_massless(folder, nodes=NODES, light=LIGHT, **choices):
    """A truss whose last two nodes have no share of the mass but one that cancels in pairs.

    S = T' diag(m, 0) T with every node's motion mixed into the others keeps all diagonals positive.
    """
    r, m, _, K = truss(3, nodes)
    heavy = np.delete(np.arange(nodes), light)
    mix = np.zeros((len(heavy), nodes))
    mix[:, heavy] = np.eye(len(heavy))
    mix[:, light] = 0.25
    scalar = mix.T @ m[np.ix_(heavy, heavy)] @ mix
    S = np.kron(scalar, np.eye(3))
    return files_input(folder, r, S, K, **choices), S, K


def frequencies_without_massless(K, S):
    """Those of the pencil with the shapes without mass condensed out of K, which is exact, Hz."""
    sizes, shapes = np.linalg.eigh(S)
    light, heavy = shapes[:, sizes < 1e-9], shapes[:, sizes >= 1e-9]
    inner = np.linalg.pinv(light.T @ K @ light)
    reduced = heavy.T @ K @ heavy - heavy.T @ K @ light @ inner @ light.T @ K @ heavy
    return np.sqrt(np.abs(eigh(reduced, heavy.T @ S @ heavy, eigvals_only=True))) / math.tau


@pytest.mark.parametrize("count", [4, 9])
def test_a_held_body_has_the_frequencies_of_the_stiffness_condensed_to_its_masses(tmp_path, count):
    given, S, K = half_massless(tmp_path, clamped=(11, 12, 13), modes=count)
    held = slice(9, None)
    expected = frequencies_without_massless(K[held, held], S[held, held])
    np.testing.assert_allclose(body(given).frequencies, expected[:count], rtol=1e-8)


@pytest.mark.parametrize("count", [3, 9])
def test_so_has_a_body_in_mean_axes(tmp_path, count):
    given, S, K = half_massless(tmp_path, modes=count)
    expected = frequencies_without_massless(K, S)[6 : 6 + count]
    np.testing.assert_allclose(body(given).frequencies, expected, rtol=1e-8)


@pytest.mark.parametrize(
    "choices, most", [({"clamped": (11, 12, 13)}, 9), ({}, 9)], ids=["clamped", "mean axes"]
)
def test_more_modes_than_shapes_with_mass_are_refused(tmp_path, choices, most):
    """Two nodes and what the light ones share, three freedoms each; free, five nodes less six motions."""
    with pytest.raises(ModelError) as refused:
        flexible_body(half_massless(tmp_path, modes=most + 1, **choices)[0], cached=False)
    assert f"only {most} shapes have mass" in str(refused.value)


def test_all_modes_are_those_that_have_mass_and_the_shapes_that_have_none(tmp_path):
    """Seven nodes less six rigid motions; two nodes without mass have three directions each."""
    found = body(half_massless(tmp_path, modes=0)[0])
    assert (found.modes, found.massless) == (15, 6)
    assert found.dropped.modes == 0
    assert found.Mff == pytest.approx(np.eye(15), abs=1e-9)


@pytest.mark.parametrize(
    "choices, held", [({"clamped": (11, 12, 13)}, 9), ({}, 0)], ids=["clamped", "mean axes"]
)
def test_all_modes_answer_forces_at_massless_nodes_as_the_stiffness_says(tmp_path, choices, held):
    """Balanced pulls at a node with and one without mass part them as the free block of K says."""
    given, _, K = half_massless(tmp_path, **choices)
    force = np.zeros(3 * NODES)
    gap = given.positions[6] - given.positions[3]
    force[9:12], force[18:21] = -gap, gap
    found = body(given)
    bent = found.Phi @ np.linalg.solve(found.Kr, found.Phi.T @ force)
    flexibility = np.linalg.pinv(K[held:, held:], rcond=1e-10)
    assert force @ bent == pytest.approx(force[held:] @ flexibility @ force[held:], rel=1e-9)


@pytest.mark.parametrize("choices", [{}, {"attachment": range(11, 19)}], ids=["all modes", "and ATTM"])
def test_a_patch_of_tetrahedra_stretches_uniformly(tmp_path, choices):
    """A block under a tension sigma on two faces: u = sigma/E (x, -nu y, -nu z), exact in linear elements.

    Six tetrahedra with one point each give no mass to two combinations of its eight nodes.
    """
    young, poisson, tension, size = 2.0e11, 0.3, 1.0e8, np.array([0.3, 0.2, 0.1])
    placed, elements = Beam(tuple(size), (1, 1, 1), "C3D4").mesh()
    positions = np.array(list(placed.values()))
    K, S = tetrahedra(positions, elements, young, poisson, 7800.0)
    force = np.zeros(positions.shape)
    for face, sign in ((0.3, 1.0), (0.0, -1.0)):
        for nodes in elements:
            on_face = [node - 1 for node in nodes if positions[node - 1, 0] == face]
            if len(on_face) == 3:
                force[on_face, 0] += sign * tension * size[1] * size[2] / 2 / 3
    corner, along, across = (
        int(np.flatnonzero((positions == size * place).all(axis=1))[0]) + 11
        for place in ([0, 0, 0], [1, 0, 0], [0, 1, 0])
    )
    given = files_input(tmp_path, positions, S, K, reference=(corner, along, across), modes=0)
    found = body(replace(given, attachment=tuple(choices.get("attachment", ()))))
    bent = found.Phi @ np.linalg.solve(found.Kr, found.Phi.T @ force.ravel())
    expected = tension / young * positions * [1.0, -poisson, -poisson]
    assert found.massless
    assert bent.reshape(-1, 3) == pytest.approx(expected, abs=1e-10 * np.abs(expected).max())


@pytest.mark.long_motion
def test_so_do_bodies_too_large_for_full_matrices(tmp_path):
    """930 freedoms; the limit of effective mass is that of the pseudo-inverse of the singular mass matrix."""
    nodes, held = 310, slice(9, None)
    given, S, _ = half_massless(tmp_path, nodes, (nodes - 2, nodes - 1), clamped=(11, 12, 13), modes=4)
    found = body(given)
    rigid = np.zeros((3 * nodes, 3))
    for axis in range(3):
        rigid[axis::3, axis] = 1.0
    carried = (S @ rigid)[held]
    limit = np.einsum("ij,ij->j", carried, np.linalg.pinv(S[held, held], rcond=1e-10) @ carried)
    assert found.effective_limit[:3] == pytest.approx(limit, rel=1e-9)
