"""The matrices of implicit steps against differences of the forces, and numpy's linear algebra."""

from dataclasses import replace

import numpy as np
import pytest

from flexmb_cli.kernels.constrained.accelerations import (
    choose_order,
    evaluate_jacobian,
    factorise_constraints,
)
from flexmb_cli.kernels.constrained.body_vectors import geometry_of
from flexmb_cli.kernels.constrained.constraint_primitives import primitive_value
from flexmb_cli.kernels.constrained.forces import add_stiff
from flexmb_cli.kernels.constrained.mass_matrix import kinetic_energy, mass_matrices
from flexmb_cli.kernels.constrained.system import SOLVED
from flexmb_cli.kernels.integrators import generalised_alpha, radau5
from flexmb_cli.kernels.integrators.generalised_alpha_step import _set_matrix
from flexmb_cli.kernels.integrators.radau5_step import prepare, renew_matrices
from flexmb_cli.kernels.linalg.cholesky import cholesky_solve
from flexmb_cli.kernels.linalg.profile_ldl import solve_symmetric
from flexmb_cli.model.joints import ANGLE, STROKE
from flexmb_cli.model.laws import At, Line, spring
from flexmb_cli.solvers.constrained.system import dense_jacobian
from tests.dialects.vsdf.mechanisms import analysis_of, joint, moved, node, random_state, sample
from tests.kernels.constrained.test_constraint_primitives import FIRST, H, forces_at

STEP = 0.02  # s
# Eigenvalues of the inverse of Radau's weights: Hairer and Wanner II, section IV.8.
REAL, COMPLEX = 3.6378342527444957, 2.6810828736277521 + 3.0504301992474105j


@pytest.fixture(scope="module")
def stiff(tmp_path_factory):
    """A mechanism at rest with springs that pull nowhere, and its M, D, K (n, n) from energies and forces."""
    mechanism = sample(tmp_path_factory.mktemp("trusses"))
    bodies = mechanism.bodies
    joints = joint(bodies, "cylindrical", 0, 2), joint(bodies, "translational", 1, 2, "joint 2")
    springs = (
        spring("spring 1", Line(0, 2, node(bodies, 0, 13), node(bodies, 2, 17)), 30.0, 0.4, 4.0),
        spring("spring 2", Line(1, -1, node(bodies, 1, 12), node(bodies, -1, 14)), 20.0, 0.4, 3.0),
        spring("s", At(0, ANGLE), 20.0, 0.3, 2.0),
        spring("t", At(1, STROKE), 25.0, 0.1, 1.0),
    )
    parts = {"joints": joints, "springs": springs, "gravity": (0.0, 0.0, 0.0)}
    analysis = analysis_of(replace(mechanism, **parts))
    q, _ = random_state(analysis)
    relax(analysis, q)
    return analysis, q, mass_of(analysis, q), *slopes_of(analysis, q)


REST = 1  # number of a spring


def relax(analysis, q):
    """Give every spring its length at q: the change of a force's direction then does not count."""
    system, work = analysis.system, analysis.work
    work.angles[:] = analysis.screw_angles(q)
    evaluate_jacobian(system, work, q)
    for load in system.loads:
        if load["in_line"]:
            load["c"][REST] = np.linalg.norm(work.relative_vectors[0, load["primitive"], 0])
        else:
            turn = system.primitives[load["primitive"]]["turn"]
            expected = work.angles[turn] if turn >= 0 else 0.0
            load["c"][REST] = primitive_value(geometry_of(system, work), load["primitive"], expected)


def mass_of(analysis, q):
    """M (n, n), u · M u being twice the kinetic energy."""
    n = analysis.arrays.speeds
    evaluate_jacobian(analysis.system, analysis.work, q)
    mass_matrices(analysis.system, analysis.work, q)
    energy = lambda u: kinetic_energy(analysis.system, analysis.work, u)  # noqa: E731
    E = np.eye(n)
    single = np.array([energy(e) for e in E])
    return np.array([[energy(a + b) for b in E] for a in E]) - single[:, None] - single


def slopes_of(analysis, q):
    """D and K (n, n): minus the derivatives of the forces by speeds and by positions, at rest."""
    n, arrays = analysis.arrays.speeds, analysis.arrays
    rest, E = np.zeros(n), np.eye(n)
    # Velocity forces are even in the speeds, those of dampers odd.
    D = [-(forces_at(analysis, q, e) - forces_at(analysis, q, -e)) / 2 for e in E]
    K = [
        -sum(w * forces_at(analysis, moved(arrays, q, e, k * H), rest) for k, w in FIRST.items()) / H
        for e in E
    ]
    return np.array(D).T, np.array(K).T


def test_stiff_products_are_slopes_of_the_forces(stiff):
    analysis, q, _, D, K = stiff
    forces_at(analysis, q, np.zeros(len(K)))
    x = np.random.default_rng(2).normal(size=len(K))
    for by_position, by_speed in ((1.0, 0.0), (0.0, 1.0), (0.3, 0.7)):
        y = np.ones(len(K))
        add_stiff(analysis.system, analysis.work, by_position, by_speed, x, y)
        np.testing.assert_allclose(y - 1.0, by_position * K @ x + by_speed * D @ x, atol=1e-6)


def free_motions(analysis, q):
    """Z (n, f): what the constraints leave free, in speeds."""
    system, work = analysis.system, analysis.work
    evaluate_jacobian(system, work, q)
    choose_order(work, len(work.jacobian))
    assert factorise_constraints(system, work, q) == SOLVED
    mass_matrices(system, work, q)
    free = work.motions.shape[0] - work.rank[0]
    assert free > 3
    np.testing.assert_allclose(dense_jacobian(work) @ work.motions[:, :free], 0.0, atol=1e-10)
    return work.motions[:, :free] * system.speed_scale[:, None]


def test_the_matrix_of_generalised_alpha_is_that_of_the_free_motions(stiff):
    analysis, q, M, D, K = stiff
    Z = free_motions(analysis, q)
    integration = generalised_alpha.new_integration(analysis.work, len(analysis.work.angles))
    assert _set_matrix(analysis.system, analysis.work, integration, 0.3, 0.7) == SOLVED
    b = np.arange(1.0, Z.shape[1] + 1)
    x = b.copy()
    cholesky_solve(integration.newton.reduced, len(b), x)
    np.testing.assert_allclose(Z.T @ (M + 0.3 * K + 0.7 * D) @ Z @ x, b, rtol=1e-6)


def test_the_matrices_of_radaus_method_are_those_of_the_eigenvalues_of_its_weights(stiff):
    analysis, q, M, D, K = stiff
    Z = free_motions(analysis, q)
    integration = radau5.new_integration(analysis.work, len(analysis.work.angles))
    renew_matrices(analysis.system, analysis.work, integration.matrices)
    assert prepare(integration, Z.shape[1], STEP)
    b = np.arange(1.0, Z.shape[1] + 1)
    x, y = b.copy(), b.astype(complex)
    cholesky_solve(integration.newton.reduced, len(b), x)
    solve_symmetric(integration.complex, len(b), y)
    matrix = lambda h: Z.T @ (M + h * D + h**2 * K) @ Z  # noqa: E731
    np.testing.assert_allclose(matrix(STEP / REAL) @ x, b, rtol=1e-6)
    # Which of the two conjugates is taken is a matter of choice.
    h = STEP / COMPLEX
    gaps = [np.abs(matrix(step) @ y - b).max() for step in (h, h.conjugate())]
    assert min(gaps) < 1e-6 * np.abs(b).max()
