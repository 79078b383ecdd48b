"""Bases of a body: frame conditions, static answers, effective masses, large and dense paths alike."""

import numpy as np
import pytest
from scipy.io import mmread
from scipy.linalg import eigh

from flexmb_cli.fe import linear_algebra, modes
from flexmb_cli.fe.input_checks import rigid_motions
from flexmb_cli.fe.massless_shapes import FreeMotion
from flexmb_cli.fe.reference_frame import reference_frame, static_shapes, unit_forces
from tests.fe.supplied import CHORD, FILES, NEAR_JOINT, body, pendulum
from tests.fe.trusses import truss, truss_input

ROOT = (1, 2, 3, 4, 5, 6)


def matrices():
    return tuple(mmread(FILES / f"pendulum_{letter}.mtx").toarray() for letter in "MK")


def rows(*numbers):
    return np.array([3 * (number - 1) + i for number in numbers for i in range(3)])


@pytest.mark.parametrize("reference", [NEAR_JOINT, CHORD], ids=["near the joint", "chord"])
def test_shapes_fulfil_the_conditions_of_three_nodes(reference):
    """(103): node 1 rests, node 2 moves along e1 only, node 3 in the plane of e1 and e2."""
    found = body(pendulum(reference=reference, modes=5))
    n1, n2, n3 = (found.shape(node) for node in reference)
    held = np.concatenate([n1, n2[1:], n3[2:]])
    assert np.abs(held).max() == 0.0
    assert np.abs(found.Phi).max() > 1.0


def test_shapes_of_a_clamped_set_rest_there():
    found = body(pendulum(clamped=ROOT, modes=5))
    assert all(not found.shape(node).any() for node in ROOT)


def test_shapes_in_mean_axes_move_neither_the_centre_of_mass_nor_the_mean_rotation():
    found = body(pendulum(mean=True, modes=9))
    assert np.abs(found.S1).max() < 1e-12
    assert np.abs(found.C0).max() < 1e-12
    assert np.abs(found.s0).max() < 1e-15
    assert found.origin == pytest.approx([0.05, 0.005, 0.0075])


def test_body_axes_follow_the_reference_nodes():
    """(100)-(102): e1 from node 1 to node 2, node 3 in the half plane of e2; here both ways round."""
    found = body(pendulum(reference=(49, 1, 50), modes=1))
    assert found.origin == pytest.approx([0.1, 0.0, 0.0])
    np.testing.assert_allclose(found.axes.T, [[-1, 0, 0], [0, 0, 1], [0, 1, 0]], atol=1e-12)
    assert found.position(1) == pytest.approx([0.1, 0.0, 0.0])


def test_a_turned_frame_changes_neither_frequencies_nor_inertia():
    """The same nodes fix the frame whatever the directions of the node table's axes."""
    given = pendulum(reference=NEAR_JOINT, modes=9)
    plain = body(given)
    reflected = body(pendulum(reference=(13, 1, 9), modes=9))
    turned = plain.axes.T @ reflected.axes
    about = plain.J0 - plain.m * (
        plain.centre @ plain.centre * np.eye(3) - np.outer(plain.centre, plain.centre)
    )
    other = reflected.J0 - reflected.m * (
        reflected.centre @ reflected.centre * np.eye(3) - np.outer(reflected.centre, reflected.centre)
    )
    assert turned.T @ about @ turned == pytest.approx(other, abs=1e-12)


def test_inertia_of_the_undeformed_rod_is_that_of_the_box():
    """m (b² + h²)/12 + m of Steiner; bricks of consistent mass have exactly that of the continuous box."""
    found = body(pendulum(modes=1))
    m, (l, b, h) = 0.26, (0.1, 0.01, 0.015)
    assert np.diag(found.J0) == pytest.approx(
        [m * (b * b + h * h) / 3, m * (l * l + h * h) / 3, m * (l * l + b * b) / 3]
    )
    assert found.centre == pytest.approx([l / 2, b / 2, h / 2])


@pytest.mark.parametrize(
    "choice",
    [{"reference": NEAR_JOINT}, {"clamped": ROOT}, {"reference": (12, 40, 53)}],
    ids=["three nodes", "clamped", "askew"],
)
def test_effective_masses_of_all_modes_sum_to_the_limit(choice):
    """All modes carry R' S R less what only the held freedoms carry, which the Schur complement gives."""
    found = body(pendulum(modes=0, **choice))
    assert found.effective_mass.sum(axis=0) == pytest.approx(found.effective_limit, rel=1e-9)


def test_the_limit_of_effective_mass_is_mass_and_inertia_less_those_of_the_held_rows():
    M, _ = matrices()
    held = rows(*ROOT)
    free = np.setdiff1d(np.arange(len(M)), held)
    schur = M[np.ix_(held, held)] - M[np.ix_(held, free)] @ np.linalg.solve(
        M[np.ix_(free, free)], M[np.ix_(free, held)]
    )
    along_x = (held % 3 == 0).astype(float)
    found = body(pendulum(clamped=ROOT, modes=3))
    assert found.effective_limit[0] == pytest.approx(0.26 - along_x @ schur @ along_x)


def test_attachment_modes_make_static_deflections_exact():
    """A force at an attachment node bends the clamped rod as the whole stiffness matrix says."""
    _, K = matrices()
    free = np.setdiff1d(np.arange(len(K)), rows(*ROOT))
    force = np.zeros(len(K))
    force[rows(51)] = [0.1, -0.2, 0.3]
    wanted = np.zeros(len(K))
    wanted[free] = np.linalg.solve(K[np.ix_(free, free)], force[free])
    found = body(pendulum(clamped=ROOT, attachment=(51,), modes=2))
    bent = found.Phi @ np.linalg.solve(found.Kr, found.Phi.T @ force)
    assert bent == pytest.approx(wanted, abs=1e-9 * np.abs(wanted).max())
    without = body(pendulum(clamped=ROOT, modes=2))
    poor = without.Phi @ np.linalg.solve(without.Kr, without.Phi.T @ force)
    assert np.abs(poor - wanted).max() > 1e-3 * np.abs(wanted).max()


def test_attachment_modes_of_a_free_body_make_balanced_deflections_exact():
    """Two opposite pulls in mean axes: the nodes part as those of any statically held rod do."""
    _, K = matrices()
    free = np.setdiff1d(np.arange(len(K)), [0, 1, 2, 3 * 12 + 1, 3 * 12 + 2, 3 * 8 + 2])
    force = np.zeros(len(K))
    force[3 * 50], force[3 * 2] = 1.0, -1.0
    held = np.zeros(len(K))
    held[free] = np.linalg.solve(K[np.ix_(free, free)], force[free])
    found = body(pendulum(mean=True, attachment=(3, 51), modes=2))
    bent = found.Phi @ np.linalg.solve(found.Kr, found.Phi.T @ force)
    assert force @ bent == pytest.approx(force @ held, rel=1e-9)


@pytest.mark.parametrize(
    "choice", [{"reference": NEAR_JOINT}, {"mean": True}], ids=["three nodes", "mean axes"]
)
def test_a_craig_bampton_basis_deforms_statically_as_the_whole_body(choice):
    """Balanced forces at the interface do the work 1/2 F' K^-1 F, whatever the frame."""
    _, K = matrices()
    free = np.setdiff1d(np.arange(len(K)), [0, 1, 2, 3 * 12 + 1, 3 * 12 + 2, 3 * 8 + 2])
    force = np.zeros(len(K))
    force[3 * 48], force[3 * 0] = 1.0, -1.0  # nodes 49 and 1 lie on one line along x
    held = np.zeros(len(K))
    held[free] = np.linalg.solve(K[np.ix_(free, free)], force[free])
    found = body(pendulum(interface=(1, 5, 49), modes=2, **choice))
    assert found.modes == 3 * 3 + 2 - 6
    assert found.dropped.dependent == 6
    bent = found.Phi @ np.linalg.solve(found.Kr, found.Phi.T @ force)
    assert force @ bent == pytest.approx(force @ held, rel=1e-9)


def test_rigid_motion_with_the_round_off_of_another_processor_has_no_forces():
    """By another LAPACK (that of scipy 1.13) shapes of interface nodes in one plane were off by 1.4e-14.

    A basis with the round-off of their forces began at 12.8 Hz instead of 26.4.
    """
    _, K = matrices()
    motion = rigid_motions(pendulum().positions)
    noise = 1.0 + 3e-14 * np.random.default_rng(1).uniform(-1.0, 1.0, motion.shape)
    assert not modes._without_round_off(K, motion * noise).any()


def test_the_modes_of_a_clamped_craig_bampton_basis_come_from_above():
    """Rayleigh-Ritz: frequencies of a basis are not below the body's; fixed-interface modes lower them."""
    exact = body(pendulum(clamped=ROOT, modes=4)).frequencies
    few = body(pendulum(clamped=ROOT, interface=(49, 51, 53), modes=0)).frequencies[:4]
    more = body(pendulum(clamped=ROOT, interface=(49, 51, 53), modes=8)).frequencies[:4]
    assert (few >= more - 1e-9).all()
    assert (more >= exact - 1e-9).all()
    assert more[:2] == pytest.approx(exact[:2], rel=1e-3)


def test_sparse_and_dense_solvers_give_the_same_modes(monkeypatch):
    for choice in ({"reference": NEAR_JOINT}, {"mean": True}, {"clamped": ROOT}):
        dense = body(pendulum(modes=6, **choice))
        monkeypatch.setattr(linear_algebra, "DENSE", 0)
        found = body(pendulum(modes=6, **choice))
        monkeypatch.undo()
        assert found.frequencies == pytest.approx(dense.frequencies, rel=1e-9)
        assert found.Phi == pytest.approx(dense.Phi, abs=1e-6 * np.abs(dense.Phi).max())


def test_random_bodies_have_the_eigenvalues_of_plain_matrices(tmp_path):
    r, _, M, K = truss(5)
    free = np.setdiff1d(np.arange(21), rows(1, 4, 6))
    wanted = np.sqrt(eigh(K[np.ix_(free, free)], M[np.ix_(free, free)], eigvals_only=True)) / (2 * np.pi)
    found = body(truss_input(tmp_path, 5, clamped=(11, 14, 16)))
    assert found.frequencies == pytest.approx(wanted, rel=1e-9)
    assert found.r0 == pytest.approx(r)


def test_damping_is_that_of_rayleigh_and_of_every_mode():
    found = body(pendulum(modes=3, damping=(0.4, 1e-3, 0.02)))
    omega = 2 * np.pi * found.frequencies
    wanted = 0.4 + 1e-3 * omega**2 + 2 * 0.02 * omega
    assert found.Dr == pytest.approx(np.diag(wanted), abs=1e-9)


def test_the_largest_component_of_every_mode_is_positive():
    found = body(pendulum(modes=9)).Phi
    assert (found.max(axis=0) >= -found.min(axis=0) * (1 - 1e-6)).all()


@pytest.mark.parametrize("basis", ["mean axes", "attachment", "interface"])
def test_a_freedom_without_stiffness_is_a_free_motion_on_every_processor(tmp_path, basis):
    """Elimination meets a pivot of exactly 0: the third direction of the sixth node is tied to nothing."""
    r, m, M, K = truss(1)
    K[17] = K[:, 17] = 0.0
    mean = reference_frame(truss_input(tmp_path, 1), m.sum(axis=0) @ r / m.sum())
    held = reference_frame(truss_input(tmp_path, 1, reference=(11, 12, 13)), np.zeros(3))
    bases = {
        "mean axes": lambda: modes.eigenmodes(K, M, mean, 2),
        "attachment": lambda: static_shapes(K, M, held, unit_forces(21, rows(4))),
        "interface": lambda: modes.craig_bampton(K, M, held, rows(1, 2, 3), 1),
    }
    with pytest.raises(FreeMotion) as stopped:
        bases[basis]()
    assert np.argmax(np.abs(stopped.value.shape)) == 17
