"""Masses that some shapes lack: reduced integration gives mass matrices that are only semidefinite."""

import math
from dataclasses import replace

import h5py
import numpy as np
import pytest
from click.testing import CliRunner
from scipy.linalg import eigh
from scipy.spatial.distance import pdist

from flexmb_cli.cli.run import run
from flexmb_cli.errors import ModelError
from flexmb_cli.fe.flexible_bodies import flexible_body
from flexmb_cli.fe.invariants import EPSILON
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


YOUNG, POISSON, TENSION, SIZE = 2.0e11, 0.3, 6.0e7, np.array([0.3, 0.2, 0.1])


def stretched_block():
    """Nodes, K and S of a block of six tetrahedra, and forces at its nodes: a tension on two faces.

    One point each leaves the masses (8, 8) of the rank 5.  Also the numbers of the nodes at the origin,
    along x and along y.
    """
    placed, elements = Beam(tuple(SIZE), (1, 1, 1), "C3D4").mesh()
    positions = np.array(list(placed.values()))
    K, S = tetrahedra(positions, elements, YOUNG, POISSON, 7800.0)
    force = np.zeros(positions.shape)
    for face, sign in ((0.3, 1.0), (0.0, -1.0)):
        for nodes in elements:
            on_face = [node - 1 for node in nodes if positions[node - 1, 0] == face]
            if len(on_face) == 3:
                force[on_face, 0] += sign * TENSION * SIZE[1] * SIZE[2] / 2 / 3
    corners = tuple(
        int(np.flatnonzero((positions == SIZE * place).all(axis=1))[0]) + 11
        for place in ([0, 0, 0], [1, 0, 0], [0, 1, 0])
    )
    return positions, K, S, force, corners


@pytest.mark.parametrize("choices", [{}, {"attachment": range(11, 19)}], ids=["all modes", "and ATTM"])
def test_a_patch_of_tetrahedra_stretches_uniformly(tmp_path, choices):
    """A block under a tension sigma on two faces: u = sigma/E (x, -nu y, -nu z), exact in linear elements."""
    positions, K, S, force, corners = stretched_block()
    given = files_input(tmp_path, positions, S, K, reference=corners, modes=0)
    found = body(replace(given, attachment=tuple(choices.get("attachment", ()))))
    bent = found.Phi @ np.linalg.solve(found.Kr, found.Phi.T @ force.ravel())
    expected = TENSION / YOUNG * positions * [1.0, -POISSON, -POISSON]
    assert found.massless
    assert bent.reshape(-1, 3) == pytest.approx(expected, abs=1e-10 * np.abs(expected).max())


@pytest.mark.parametrize("interface", [(), range(11, 19)], ids=["all modes", "CRBN at all nodes"])
def test_let_go_a_body_framed_by_nodes_has_the_frequencies_of_the_condensed_stiffness(tmp_path, interface):
    """Three directions of three shapes without mass: most move the frame's nodes, and have mass in the frame.

    The rigid motion is free, so that modes keep the Schur complement of Mff.
    """
    positions, K, S, _, corners = stretched_block()
    given = files_input(tmp_path, positions, S, K, reference=corners, modes=0)
    found = body(replace(given, interface=tuple(interface)))
    s, E = EPSILON @ found.s0, np.eye(3)
    Mrr = np.block([[found.m * E, s], [s.T, found.J0]])
    Mrf = np.vstack([found.S1, -found.C0])
    free = eigh(found.Kr, found.Mff - Mrf.T @ np.linalg.solve(Mrr, Mrf), eigvals_only=True)
    expected = frequencies_without_massless(K, S)[6:]
    assert found.massless + found.massless_in_motion == 9 == K.shape[0] - 6 - len(expected)
    assert np.sqrt(free[: len(expected)]) / math.tau == pytest.approx(expected, rel=1e-8)
    assert np.sqrt(free[len(expected) :]) / math.tau == pytest.approx(found.frequencies[-1], rel=1e-8)


PATCH = """\
VSDF A BLOCK OF TETRAHEDRA ON A BALL JOINT
BODY
    1 FLEX    0{0:5d}{1:5d}{2:5d}
FEMN
    1 TXT  nodes.txt
FEMM
    1 MM   M.mtx
FEMK
    1 MM   K.mtx
DAMP
    1       0.0       0.0       1.0
JOIN
    1 SPHE    0    0    0    1{0:5d}
FORC
{forces}
TIME
     0.005     0.005
INTG
 RAD5    1.0E-8
OUTN
    1   11   12   13   14   15   16   17   18
END
STAR
STOP
"""


@pytest.mark.long_motion
def test_a_patch_on_a_ball_joint_comes_to_rest_uniformly_stretched(tmp_path):
    """The tension is balanced: the joint bears nothing, and the block stretches as in the test above.

    The distances of its nodes are compared, as the joint leaves it free to turn.
    """
    positions, K, S, force, corners = stretched_block()
    files_input(tmp_path, positions, S, K)
    rows = [f"{11 + k} {x!r} {y!r} {z!r}" for k, (x, y, z) in enumerate(positions.tolist())]
    (tmp_path / "nodes.txt").write_text("\n".join(rows) + "\n")
    loads = [f"    1{11 + k:5d}{pull:10.1f}       0.0       0.0    1" for k, (pull, _, _) in enumerate(force)]
    (tmp_path / "patch.vsdf").write_text(PATCH.format(*corners, forces="\n".join(loads)))
    done = CliRunner().invoke(run, [str(tmp_path / "patch.vsdf"), "-q", "-o", str(tmp_path)])
    assert done.exit_code == 0, done.output
    with h5py.File(tmp_path / "patch.h5") as result:
        found = result["point/position"][-1]
    stretched = positions * (1.0 + TENSION / YOUNG * np.array([1.0, -POISSON, -POISSON]))
    assert pdist(found) == pytest.approx(pdist(stretched), abs=1e-6 * TENSION / YOUNG * SIZE[0])


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


def test_the_mass_matrix_of_a_body_is_parted_once(tmp_path, monkeypatch):
    """Modes and the limit of the effective masses ask for the same eigenvectors."""
    parted, own = [], np.linalg.eigh
    monkeypatch.setattr(np.linalg, "eigh", lambda matrix: parted.append(matrix.tobytes()) or own(matrix))
    body(half_massless(tmp_path, clamped=(11, 12, 13), modes=4)[0])
    assert parted and len(parted) == len(set(parted))
