"""The free-flying rod and the pendulum moved by the kernels of one body and scipy's integrator.

The tables are those of this project's reference computation, generalised-alpha with 5e-5 s: converged
to 2e-6 m for the free rod, to 4e-7 m and 5e-4 m/s for the pendulum.
"""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from flexmb_cli.fe.build_mechanism import flexible_mechanism
from flexmb_cli.kernels.constrained.floating_frame import (
    add_elastic_forces,
    add_gravity,
    first_moment,
    mass_matrix,
    moving_inertia,
    velocity_forces,
)
from tests.dialects.vsdf.vsdf_decks import build, supplied

FREE_ROD = {
    0.1: (0.113486, 0.013563, -0.052720),
    0.2: (0.108654, 0.015886, -0.079189),
    0.3: (0.111211, 0.010482, -0.075067),
    0.4: (0.141734, 0.000744, -0.055497),
    0.5: (0.203101, -0.007349, -0.045248),
}
PENDULUM = {
    0.05: (-0.01773, -0.6870),
    0.1: (-0.06558, -1.0621),
    0.2: (-0.06680, 1.2063),
    0.3: (0.02671, 0.2874),
    0.4: (-0.01628, -1.1268),
    0.5: (-0.09822, 0.3916),
}


def tilde(v):
    return np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])


class Moving:
    """One flexible body with held point rows: state (x0, p, eta, v, w, etad)."""

    def __init__(self, text):
        self.mechanism, _ = flexible_mechanism(build(text), cached=False)
        self.body = self.mechanism.bodies[0]
        self.found, self.N = self.body.flexible, self.body.modes
        self.gravity = np.array(self.mechanism.gravity)
        self.held = []
        for joint in self.mechanism.joints:
            # A revolute joint with the ground along y: the first node rests, the second stays on y.
            self.held += [(joint.b[0], (0, 1, 2)), (joint.b[1], (0, 2))]

    def start(self):
        b, zero = self.body, np.zeros(self.N)
        return np.concatenate([b.r, b.p, zero, b.velocity, b.omega, zero])

    def parts(self, y):
        N = self.N
        return y[:3], y[3:7], y[7 : 7 + N], y[7 + N : 10 + N], y[10 + N : 13 + N], y[13 + N :]

    def rotation(self, p):
        return (2 * p[0] ** 2 - 1) * np.eye(3) + 2 * (np.outer(p[1:], p[1:]) + p[0] * tilde(p[1:]))

    def equations(self, y):
        """M and all forces."""
        f, N = self.found, self.N
        _, p, eta, _, w, etad = self.parts(y)
        A = self.rotation(p / np.linalg.norm(p))
        s, S_tt, S_tf, T = np.empty(3), np.empty((3, 3)), np.empty((3, N)), np.empty((N, 3, 3))
        M, force = np.empty((6 + N, 6 + N)), np.empty(6 + N)
        first_moment(eta, f.s0, f.S1, s)
        moving_inertia(eta, f.J0, f.J1, f.J2, f.C0, f.C1, T, S_tt, S_tf)
        mass_matrix(A, f.m, s, f.S1, S_tt, S_tf, f.Mff, M)
        velocity_forces(A, w, etad, s, f.S1, S_tt, S_tf, f.J1, T, f.C1, force)
        add_gravity(A, f.m, s, f.S1, self.gravity, force)
        add_elastic_forces(w, eta, etad, f.Kr, f.Dr, f.KG, force)
        return A, s, M, force

    def node(self, point, y):
        """Position, velocity, Jacobian and the acceleration without that of the coordinates."""
        x0, p, eta, v, w, etad = self.parts(y)
        A = self.rotation(p / np.linalg.norm(p))
        r, rd = point.r0 + point.shape @ eta, point.shape @ etad
        J = np.hstack([np.eye(3), -A @ tilde(r), A @ point.shape])
        rest = A @ (np.cross(w, np.cross(w, r)) + 2 * np.cross(w, rd))
        return x0 + A @ r, v + A @ (np.cross(w, r) + rd), J, rest

    def rate(self, _t, y):
        _, p, _, v, w, etad = self.parts(y)
        _, _, M, force = self.equations(y)
        nodes = [(self.node(point, y), rows) for point, rows in self.held]
        G = np.vstack([node[2][list(rows)] for node, rows in nodes] or [np.zeros((0, 6 + self.N))])
        c = np.concatenate([-node[3][list(rows)] for node, rows in nodes] or [np.zeros(0)])
        k = len(c)
        whole = np.block([[M, G.T], [G, np.zeros((k, k))]])
        acceleration = np.linalg.solve(whole, np.concatenate([force, c]))[: 6 + self.N]
        e0, e = p[0], p[1:]
        pd = 0.5 * np.concatenate([[-e @ w], e0 * w + np.cross(e, w)])
        return np.concatenate([v, pd, etad, acceleration])

    def move(self, times, rtol=1e-8):
        moved = solve_ivp(
            self.rate, (0.0, max(times)), self.start(), "DOP853", sorted(times), rtol=rtol, atol=1e-10
        )
        assert moved.success
        return dict(zip(sorted(times), moved.y.T, strict=True))

    def conserved(self, y):
        """Momentum, angular momentum about the origin, energy without gravity."""
        x0, _, eta, v, w, etad = self.parts(y)
        A, _, M, _ = self.equations(y)
        u = np.concatenate([v, w, etad])
        momentum = M @ u
        H = np.cross(x0, momentum[:3]) + A @ momentum[3:6]
        return momentum[:3], H, 0.5 * u @ momentum + 0.5 * eta @ self.found.Kr @ eta


@pytest.fixture(scope="module")
def free_rod():
    moving = Moving(supplied("freeflying"))
    return moving, moving.move(FREE_ROD)


@pytest.mark.long_motion
def test_the_free_rod_flies_as_listed(free_rod):
    moving, states = free_rod
    tip = next(point for point in moving.mechanism.outputs if point.name.endswith(" 51"))
    for time, wanted in FREE_ROD.items():
        np.testing.assert_allclose(moving.node(tip, states[time])[0], wanted, rtol=0, atol=3e-6)


@pytest.mark.long_motion
def test_the_free_rod_keeps_momentum_angular_momentum_and_energy(free_rod):
    """P, H about the origin of space, and energy of the start; the integrator's tolerance is 1e-8."""
    moving, states = free_rod
    for state in states.values():
        P, H, energy = moving.conserved(state)
        np.testing.assert_allclose(P, [0.091, -0.00195, -0.0507], rtol=0, atol=1e-9)
        np.testing.assert_allclose(H, [-2.3183e-4, 4.98983e-3, -1.1483e-4], rtol=0, atol=6e-9)
        assert energy == pytest.approx(2.840608e-2, abs=1e-8)


@pytest.mark.long_motion
def test_the_pendulum_swings_as_listed():
    """Nine modes, five equations of the revolute joint, node 51, from rest."""
    moving = Moving(supplied("pendulum"))
    states = moving.move(PENDULUM)
    (tip,) = moving.mechanism.outputs
    for time, (z, vz) in PENDULUM.items():
        position, velocity, *_ = moving.node(tip, states[time])
        assert position[2] == pytest.approx(z, abs=1e-5)
        assert velocity[2] == pytest.approx(vz, abs=1e-3)
