"""Masses that some shapes lack: reduced integration gives mass matrices that are only semidefinite."""

import math

import numpy as np
import pytest
from scipy.linalg import eigh

from flexmb_cli.errors import ModelError
from flexmb_cli.fe.flexible_bodies import flexible_body
from tests.fe.supplied import body
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


def test_all_modes_are_those_that_have_mass(tmp_path):
    assert body(half_massless(tmp_path, modes=0)[0]).modes == 9


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
