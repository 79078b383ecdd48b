"""Vectors that turn with a rotation vector, against scipy's rotations and their central differences."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from flexmb_cli.kernels.linalg.rotation_vectors import spin, spin_remainder, turned
from flexmb_cli.solvers.constrained.turned_arms import arm_motion

ARM = np.array([0.3, -0.7, 1.1])
SIZES = [0.0, 1e-9, 1e-4, 0.1, 1.0, 2.9, 3.5]


def path(size):
    """θ(t) = a + b t + c t², |a| = size: a, b, 2 c."""
    a = size * np.array([2.0, -3.0, 6.0]) / 7.0
    return a, np.array([0.4, 0.5, -0.3]), np.array([-0.2, 0.1, 0.6])


def end(size, t):
    a, b, c = path(size)
    return Rotation.from_rotvec(a + b * t + c * t * t / 2).apply(ARM)


@pytest.mark.parametrize("size", SIZES)
def test_an_arm_turns_and_moves_as_its_rotation(size):
    """Differences of fourth order, step 1e-3: errors about 1e-11 of first, 1e-9 of second derivatives."""
    theta, rate, second = path(size)
    assert turned(tuple(theta), tuple(ARM)) == pytest.approx(end(size, 0.0), abs=1e-14)
    h = 1e-3
    far, near, here, later, last = (end(size, k * h) for k in (-2, -1, 0, 1, 2))
    velocity = (far - 8 * near + 8 * later - last) / (12 * h)
    acceleration = (-far + 16 * near - 30 * here + 16 * later - last) / (12 * h * h)
    moved, v, a = (x[0] for x in arm_motion(ARM, *(x[None] for x in (theta, rate, second))))
    assert moved + ARM == pytest.approx(here, abs=1e-13)
    assert v == pytest.approx(velocity, abs=1e-10)
    assert a == pytest.approx(acceleration, abs=1e-8)
    w = np.array(spin(tuple(theta), tuple(rate), 1.0))
    alpha = np.array(spin(tuple(theta), tuple(second), 1.0)) + spin_remainder(tuple(theta), tuple(rate))
    assert np.cross(w, here) == pytest.approx(velocity, abs=1e-10)
    assert np.cross(w, np.cross(w, here)) + np.cross(alpha, here) == pytest.approx(acceleration, abs=1e-8)


@pytest.mark.parametrize("size", SIZES)
def test_a_torque_does_the_same_work_on_both(size):
    """The transpose: m · J v = Jᵀ m · v."""
    theta, v, m = path(size)
    assert m @ spin(tuple(theta), tuple(v), 1.0) == pytest.approx(
        v @ spin(tuple(theta), tuple(m), -1.0), rel=1e-13
    )
