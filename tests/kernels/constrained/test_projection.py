"""Positions and speeds brought onto the constraints: by M the shortest way, and by any other matrix.

A bar on a spherical joint at the origin, its centre at A s: J = [1, -A s~] on v and ω (body axes), and the
least correction in the metric of M is M⁻¹ Jᵀ (J M⁻¹ Jᵀ)⁻¹ ν, by hand.
"""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from flexmb_cli.kernels.constrained.accelerations import factorise_at
from flexmb_cli.kernels.constrained.projection import (
    CLOSED_GAP,
    close_gaps,
    close_rates,
    evaluate_residual,
    project_speeds,
    rate_gap,
)
from flexmb_cli.model.loads import DynamicModel, MassProperties
from flexmb_cli.model.mechanism import Joint, Mechanism
from flexmb_cli.solvers.constrained.young_dynamics import ForwardDynamics
from tests.solvers.constrained.dynamic_runs import AT_REST, GROUND, body
from tests.solvers.constrained.test_start import TIME

MASS, INERTIA, ARM = 2.0, (0.3, 0.5, 0.7), np.array([0.1, -0.2, 0.6])
SPEEDS = np.array([0.4, -1.0, 0.3, 0.8, -0.5, 1.1])


@pytest.fixture
def bar():
    """An analysis whose first position is closed, with factors there."""
    joint = Joint("spherical", "spherical 1", 0, 1, (0.0, 0.0, 0.0), tuple(-ARM))
    mass = MassProperties("mass 1", 1, MASS, inertia=(*INERTIA, 0.0, 0.0, 0.0))
    mechanism = Mechanism((GROUND, body(2, tuple(ARM))), TIME, (joint,), grounds=(AT_REST,))
    analysis = ForwardDynamics(DynamicModel(mechanism, "forward", (mass,)))
    analysis.start()
    return analysis


def own_speeds(x):
    return x[6:12]


def test_speeds_are_changed_by_the_impulse_of_the_joint(bar):
    q, u = bar.integration.z[:14].copy(), np.concatenate([np.zeros(6), SPEEDS])
    project_speeds(bar.system, bar.work, q, u, 0.0)
    A = Rotation.from_quat(q[10:14][[1, 2, 3, 0]]).as_matrix()
    cross = np.array([[0, -ARM[2], ARM[1]], [ARM[2], 0, -ARM[0]], [-ARM[1], ARM[0], 0]])
    J = np.hstack([np.eye(3), A @ cross])  # of the point at -ARM: v - ω × ARM
    yielding = np.diag(1.0 / np.array([MASS] * 3 + [*INERTIA])) @ J.T
    expected = SPEEDS - yielding @ np.linalg.solve(J @ yielding, J @ SPEEDS)
    assert own_speeds(u) == pytest.approx(expected, abs=1e-13)


def test_by_another_matrix_the_bar_comes_onto_its_joint_elsewhere(bar):
    """Ten times the inertia of the free motions: as if all that is free were stiff."""
    found = []
    for factor in (1.0, 10.0):
        q, u = bar.integration.z[:14].copy(), np.concatenate([np.zeros(6), SPEEDS])
        q[7:10] += 0.02, -0.01, 0.03
        factorise_at(bar.system, bar.work, q)
        metric = bar.work._replace(reduced=bar.work.reduced * factor**0.5)
        close_gaps(bar.system, bar.work, metric, q, 0.0, np.zeros(0))
        assert evaluate_residual(bar.system, bar.work, q, 0.0, np.zeros(0)) <= CLOSED_GAP
        factorise_at(bar.system, bar.work, q)
        close_rates(bar.system, bar.work, metric, u, 0.0)
        assert rate_gap(bar.system, bar.work, u, 0.0) < 1e-14
        found.append(np.concatenate([q, u]))
    assert np.abs(found[0] - found[1]).max() > 1e-3
