"""Elastic forces, damping and centrifugal stiffening of a flexible body, written with matrices."""

import numpy as np
import pytest

from flexmb_cli.kernels.constrained.floating_frame import add_elastic_forces


@pytest.mark.parametrize("stiffened", [False, True])
def test_elastic_forces_are_those_of_their_matrices(stiffened):
    """-(K η + D η̇ + sum_ij (w~ w~)_ij KG_ij η), w~ x = w × x; the power is that of all but K.  D need not be
    symmetric."""
    random, N = np.random.default_rng(3), 4
    w, eta, etad = random.normal(size=3), random.normal(size=N), random.normal(size=N)
    K, D = random.normal(size=(2, N, N))
    KG = random.normal(size=(3, 3, N, N)) if stiffened else np.zeros((0, 0, N, N))
    tilde = np.cross(w, np.eye(3)).T
    assert tilde @ eta[:3] == pytest.approx(np.cross(w, eta[:3]))
    lost = D @ etad
    if stiffened:
        lost += np.einsum("ij,ijkl,l", tilde @ tilde, KG, eta)
    f = np.ones(6 + N)
    power = add_elastic_forces(w, eta, etad, K, D, KG, f)
    np.testing.assert_allclose(f, np.append(np.ones(6), 1.0 - K @ eta - lost), rtol=1e-12)
    assert power == pytest.approx(-lost @ etad, rel=1e-12)
