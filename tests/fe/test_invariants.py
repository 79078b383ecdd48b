"""Invariants against sums over the nodes, and the equations made of them against the kinetic energy.

Vlasenko and Kasper (2008), (53): f_v = -Mdot pdot + (d/dp (pdot' M pdot / 2))'.  The reference knows
nothing of invariants: it differentiates q = x0 + A(theta) r(eta) of every node.
"""

import numpy as np
import pytest

from flexmb_cli.kernels.constrained.floating_frame import (
    add_elastic_forces,
    add_gravity,
    first_moment,
    mass_matrix,
    moving_inertia,
    velocity_forces,
)
from tests.fe.supplied import body
from tests.fe.trusses import truss, truss_input

SEEDS = range(4)
FRAMES = ({"reference": (12, 15, 17)}, {"clamped": (11, 14, 16)}, {})


def tilde(v):
    return np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])


def stacked(r):
    return np.vstack([tilde(v) for v in r])


def rotation(p):
    e0, e = p[0], p[1:]
    return (e0 * e0 - e @ e) * np.eye(3) + 2 * np.outer(e, e) + 2 * e0 * tilde(e)


def rate_matrix(p):
    """L with omega (body axes) = 2 L pdot."""
    e0, e1, e2, e3 = p
    return np.array([[-e1, e0, e3, -e2], [-e2, -e3, e0, e1], [-e3, e2, -e1, e0]])


class Sample:
    """A truss as a flexible body at a random state."""

    def __init__(self, folder, seed, frame):
        self.body = body(truss_input(folder, seed, modes=6, **frame))
        _, self.m, _, _ = truss(seed)
        random = np.random.default_rng(100 + seed)
        N = self.body.modes
        self.eta, self.etad = random.uniform(-0.3, 0.3, N), random.uniform(-1, 1, N)
        self.w, self.v = random.uniform(-2, 2, 3), random.uniform(-1, 1, 3)
        p = random.uniform(-1, 1, 4)
        self.p = p / np.linalg.norm(p)
        self.A = rotation(self.p)
        self.r = self.body.r0 + (self.body.Phi @ self.eta).reshape(-1, 3)
        self.rd = (self.body.Phi @ self.etad).reshape(-1, 3)

    @property
    def S(self):
        """The mass matrix in body axes."""
        return np.kron(self.m, np.eye(3))

    def moving(self):
        b, N = self.body, self.body.modes
        s, T, S_tt, S_tf = np.empty(3), np.empty((N, 3, 3)), np.empty((3, 3)), np.empty((3, N))
        first_moment(self.eta, b.s0, b.S1, s)
        moving_inertia(self.eta, b.J0, b.J1, b.J2, b.C0, b.C1, T, S_tt, S_tf)
        return s, T, S_tt, S_tf

    def equations(self):
        """M and f_v of the kernels."""
        b, N = self.body, self.body.modes
        s, T, S_tt, S_tf = self.moving()
        M, f = np.empty((6 + N, 6 + N)), np.empty(6 + N)
        mass_matrix(self.A, b.m, s, b.S1, S_tt, S_tf, b.Mff, M)
        velocity_forces(self.A, self.w, self.etad, s, b.S1, S_tt, S_tf, b.J1, T, b.C1, f)
        return M, f

    def node_jacobian(self, x):
        """dq/dp (3 n, 7 + N) at x = (x0, theta, eta), by complex steps, which leave no difference error."""
        columns = []
        for k in range(len(x)):
            z = x.astype(complex)
            z[k] += 1e-40j
            r = self.body.r0 + (self.body.Phi @ z[7:]).reshape(-1, 3)
            columns.append((z[:3] + r @ _complex_rotation(z[3:7]).T).imag.ravel() / 1e-40)
        return np.array(columns).T

    def energy_forces(self):
        """M and f_v by (53), in (x0, theta, eta) and then in (v, w, etad)."""
        x = np.concatenate([np.zeros(3), self.p, self.eta])
        xd = np.concatenate([self.v, 0.5 * rate_matrix(self.p).T @ self.w, self.etad])

        def M(at):
            J = self.node_jacobian(at)
            return J.T @ self.S @ J

        h = 1e-5
        rates = np.array([(M(x + h * e) - M(x - h * e)) / (2 * h) for e in np.eye(len(x))])
        Mdot = np.einsum("k,kij->ij", xd, rates)
        f = -Mdot @ xd + 0.5 * np.einsum("kij,i,j->k", rates, xd, xd)
        turn = np.zeros((len(x), len(x) - 1))
        turn[:3, :3], turn[7:, 6:] = np.eye(3), np.eye(self.body.modes)
        turn[3:7, 3:6] = 0.5 * rate_matrix(self.p).T
        # Along true motions theta'' = L' alpha / 2 - (w.w / 4) theta.
        curved = np.concatenate([np.zeros(3), -0.25 * (self.w @ self.w) * self.p, np.zeros(self.body.modes)])
        return turn.T @ M(x) @ turn, turn.T @ (f - M(x) @ curved)


def _complex_rotation(p):
    e0, e = p[0], p[1:]
    skew = np.array([[0, -e[2], e[1]], [e[2], 0, -e[0]], [-e[1], e[0], 0]])
    return (e0 * e0 - np.sum(e * e)) * np.eye(3) + 2 * np.outer(e, e) + 2 * e0 * skew


@pytest.fixture(params=[(seed, i) for seed in SEEDS for i in range(len(FRAMES))], ids=str)
def sample(request, tmp_path):
    seed, frame = request.param
    return Sample(tmp_path, seed, FRAMES[frame])


def close(found, wanted, rtol=1e-12):
    np.testing.assert_allclose(found, wanted, rtol=0, atol=rtol * max(1.0, np.abs(wanted).max()))


def test_moments_of_inertia_are_the_sums_over_the_deformed_nodes(sample):
    s, T, S_tt, S_tf = sample.moving()
    Sd_tt = np.einsum("k,kab->ab", sample.etad, sample.body.J1 + T + T.transpose(0, 2, 1))
    rt, rdt = stacked(sample.r), stacked(sample.rd)
    close(s, sample.m.sum(axis=0) @ sample.r)
    close(S_tt, rt.T @ sample.S @ rt)
    close(Sd_tt, rt.T @ sample.S @ rdt + rdt.T @ sample.S @ rt)
    close(S_tf, rt.T @ sample.S @ sample.body.Phi)
    close(sample.body.m, sample.m.sum())


def test_the_mass_matrix_is_that_of_the_kinetic_energy(sample):
    close(sample.equations()[0], sample.energy_forces()[0])


def test_the_velocity_forces_are_those_of_the_kinetic_energy(sample):
    """Central differences of M with step 1e-5 are good to 1e-8 of the largest force."""
    close(sample.equations()[1], sample.energy_forces()[1], 1e-8)


def test_the_sign_printed_in_77_is_not_that_of_the_kinetic_energy(sample):
    """The paper's + S_tf q̇f, in place of the minus of (46) and (49), is off by more than any difference."""
    f = sample.equations()[1]
    S_tf = sample.moving()[3]
    printed = f[3:6] - 2 * np.cross(sample.w, S_tf @ sample.etad)
    wanted = sample.energy_forces()[1][3:6]
    assert np.abs(printed - wanted).max() > 1e-2 * np.abs(wanted).max()


def test_the_velocity_forces_are_those_of_the_nodes_accelerations(sample):
    """With a = w × (w × r) + 2 w × q̇f: f_vx = -A 1'S a, f_vw = r~'S a, f_vf = -Phi'S a."""
    w = sample.w
    a = (np.cross(w, np.cross(w, sample.r)) + 2 * np.cross(w, sample.rd)).ravel()
    force = sample.S @ a
    f = sample.equations()[1]
    close(f[:3], -sample.A @ force.reshape(-1, 3).sum(axis=0))
    close(f[3:6], stacked(sample.r).T @ force)
    close(f[6:], -sample.body.Phi.T @ force)


def test_gravity_is_the_mass_matrix_times_a_uniform_acceleration(sample):
    b, g = sample.body, np.array([0.3, -9.0, 2.0])
    M, f = sample.equations()[0], np.zeros(6 + sample.body.modes)
    s = sample.moving()[0]
    add_gravity(sample.A, b.m, s, b.S1, g, f)
    close(f, M[:, :3] @ g)


def test_elastic_forces_are_those_of_the_stiffness_at_the_nodes(sample):
    b = sample.body
    f = np.zeros(6 + b.modes)
    add_elastic_forces(sample.w, sample.eta, sample.etad, b.Kr, b.Dr, b.KG, f)
    close(f[6:], -b.Kr @ sample.eta)
    assert not f[:6].any()


def test_every_constant_basis_without_rigid_motion_has_unit_modal_masses(sample):
    close(sample.body.Mff, np.eye(sample.body.modes))
    assert sample.body.J2.transpose(1, 0, 3, 2) == pytest.approx(sample.body.J2)
    assert sample.body.C1.transpose(2, 1, 0) == pytest.approx(-sample.body.C1)
