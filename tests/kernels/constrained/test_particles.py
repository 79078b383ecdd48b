"""Inertia, weight and energies of rigid bodies against those of the particles that they are made of."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from flexmb_cli.kernels.constrained.accelerations import evaluate_jacobian
from flexmb_cli.kernels.constrained.mass_matrix import (
    inertia_and_elastic_forces,
    kinetic_energy,
    mass_matrices,
    mass_times,
    weight_energy,
)
from flexmb_cli.model.flexible_mechanism import FlexibleMechanism, FloatingBody
from tests.dialects.vsdf.mechanisms import DEFAULT, GRID, analysis_of, random_state, unit

GRAVITY = np.array([0.4, -9.0, 2.0])


class Particles:
    """Two bodies of five particles each, whose origins are not their mass centres, in any motion."""

    def __init__(self, seed):
        random = np.random.default_rng(seed)
        self.masses, self.places = random.uniform(0.5, 2.0, (2, 5)), random.uniform(-0.5, 0.5, (2, 5, 3))
        bodies = []
        for m, r in zip(self.masses, self.places, strict=True):
            J = sum(mass * (x @ x * np.eye(3) - np.outer(x, x)) for mass, x in zip(m, r, strict=True))
            pose = random.uniform(-1, 1, 3), unit(random.uniform(-1, 1, 4)), np.zeros(3), np.zeros(3)
            bodies.append(FloatingBody(f"body {len(bodies) + 1}", *pose, m.sum(), m @ r, J))
        self.analysis = analysis_of(FlexibleMechanism(tuple(bodies), GRID, DEFAULT, tuple(GRAVITY)))
        self.q, self.u = random_state(self.analysis, seed)
        self.ud = random.uniform(-1, 1, 12)
        evaluate_jacobian(self.analysis.system, self.analysis.work, self.q)
        mass_matrices(self.analysis.system, self.analysis.work, self.q)

    def motion(self):
        """Mass, arm (global), axes, position, velocity and acceleration of every particle, with its body."""
        for k in range(2):
            A = Rotation.from_quat(self.q[7 * k + 3 : 7 * k + 7][[1, 2, 3, 0]]).as_matrix()
            v, w, vd, wd = (x[6 * k + i : 6 * k + i + 3] for x in (self.u, self.ud) for i in (0, 3))
            for m, r in zip(self.masses[k], self.places[k], strict=True):
                velocity = v + A @ np.cross(w, r)
                acceleration = vd + A @ (np.cross(wd, r) + np.cross(w, np.cross(w, r)))
                yield k, m, r, A, self.q[7 * k : 7 * k + 3] + A @ r, velocity, acceleration


@pytest.fixture(params=range(3))
def particles(request):
    return Particles(request.param)


def test_inertia_and_weight_are_those_of_the_particles(particles):
    """D'Alembert: M u' - f is the sum of m (a - g) and of their moments about the origin, body axes."""
    system, work = particles.analysis.system, particles.analysis.work
    product, forces, expected = np.zeros(12), np.zeros(12), np.zeros(12)
    mass_times(system, work, particles.ud, product)
    assert inertia_and_elastic_forces(system, work, particles.q, particles.u, forces) == 0.0
    for k, m, r, A, _, _, acceleration in particles.motion():
        force = m * (acceleration - GRAVITY)
        expected[6 * k : 6 * k + 3] += force
        expected[6 * k + 3 : 6 * k + 6] += np.cross(r, A.T @ force)
    np.testing.assert_allclose(product - forces, expected, rtol=1e-11)


def test_energies_are_those_of_the_particles(particles):
    system, work = particles.analysis.system, particles.analysis.work
    kinetic = sum(0.5 * m * v @ v for _, m, _, _, _, v, _ in particles.motion())
    weight = sum(-m * GRAVITY @ x for _, m, _, _, x, _, _ in particles.motion())
    assert kinetic_energy(system, work, particles.u) == pytest.approx(kinetic, rel=1e-12)
    assert weight_energy(system, work, particles.q) == pytest.approx(weight, rel=1e-12)
