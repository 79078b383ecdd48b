"""Friction that changes its own normal force: what efforts gain by it."""

import numpy as np
import pytest

from flexmb_cli.kernels._jit import interpreting
from flexmb_cli.kernels.constrained.dry_friction import (
    COMPONENTS,
    PRELOAD,
    THREAD,
    fill_feedback,
    fill_normal_forces,
)


def normal_forces(forces):
    """The normal forces (m,) of joint forces (1 + m, m, 5)."""
    normals = np.zeros(forces.shape[1])
    with interpreting():
        fill_normal_forces(forces, normals)
    return normals


def test_feedback_is_what_a_preload_of_one_newton_adds_to_its_normal_force():
    """N = |F| + thread + preload: a preload changes N as an effort at the same N does, by (1 - J)⁻¹."""
    forces = np.random.default_rng(5).uniform(-0.25, 0.25, (4, 3, COMPONENTS))
    forces[0] *= 40.0
    forces[1:, :, PRELOAD], step = 0.0, 1e-5
    feedback = np.zeros(3)
    with interpreting():
        fill_feedback(forces, normal_forces(forces), feedback)
    found = []
    for k in range(3):
        above, below = forces.copy(), forces.copy()
        above[0, k, PRELOAD] += step
        below[0, k, PRELOAD] -= step
        found.append((normal_forces(above)[k] - normal_forces(below)[k]) / (2.0 * step))
    assert np.max(np.abs(feedback - 1.0)) > 0.1
    assert feedback == pytest.approx(found, rel=1e-7)


@pytest.mark.parametrize(("change", "wanted"), [(0.6, 2.5), (1.0, 1.0), (1.6, 0.0)])
def test_feedback_keeps_matrices_positive(change, wanted):
    """1/(1 - J) for J = 0.6; at J = 1 there is none to be told, above it would be negative."""
    forces = np.zeros((2, 1, COMPONENTS))
    forces[0, 0, THREAD], forces[1, 0, THREAD] = 3.0, change
    feedback = np.zeros(1)
    with interpreting():
        fill_feedback(forces, np.array([1.0]), feedback)
    assert feedback[0] == pytest.approx(wanted)
