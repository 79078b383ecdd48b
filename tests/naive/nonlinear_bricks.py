"""Bricks in large motion: total Lagrangian, St. Venant-Kirchhoff, incompatible modes.

Every brick of the mesh is the same box.  With the nodes' displacements u_a and three incompatible modes
M_k = 1 - xi_k^2 of amplitude a_k (Wilson, Taylor; all nine are internal to the brick),

    F = 1 + sum u_a x grad N_a + sum a_k x grad M_k,    E = (F'F - 1) / 2,    S = lambda tr(E) 1 + 2 mu E,

nodal forces are the integrals of F S grad N_a over 2 x 2 x 2 points, and a_k is where those of F S grad M_k
vanish.  There is no frame, no mode and no joint: held nodes are left out, the others move in global axes by
M u'' = f(u).  The steps are Verlet's, explicit and symplectic.  numba only makes the loops fast.
"""

import itertools

import numpy as np
from numba import njit
from scipy.linalg import cho_factor, cho_solve

CORNERS = np.array(
    [[-1, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, -1], [-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]]
)
POINTS = np.array(list(itertools.product((-1, 1), repeat=3))) / np.sqrt(3)


def shapes(xi):
    """N (8,) at a point of the unit cube (3,)."""
    return np.prod(1 + CORNERS * xi, axis=1) / 8


def slopes(xi):
    """Gradients of the eight N and the three M along xi (11, 3)."""
    one = 1 + CORNERS * xi
    N = [CORNERS[:, k] * one[:, k - 2] * one[:, k - 1] / 8 for k in range(3)]
    return np.concatenate([np.array(N).T, np.diag(-2 * xi)])


class Bricks:
    """A mesh of equal boxes along the axes: nodes (n, 3) in m, elements (e, 8) from 0, Pa, kg/m^3."""

    def __init__(self, nodes, elements, young, poisson, density):
        self.nodes, self.elements = nodes, elements
        edges = np.ptp(nodes[elements], axis=1)
        np.testing.assert_allclose(edges, np.tile(edges[0], (len(elements), 1)), rtol=1e-12)
        self.volume = np.prod(edges[0]) / 8
        self.G = np.array([slopes(xi) * 2 / edges[0] for xi in POINTS])
        self.lame = young * poisson / ((1 + poisson) * (1 - 2 * poisson)), young / (2 * (1 + poisson))
        self.m = self._masses(density)
        self.soft = self._softness()

    def _masses(self, density):
        """Consistent masses (n, n), the same for each direction."""
        N = np.array([shapes(xi) for xi in POINTS])
        m = np.zeros((len(self.nodes),) * 2)
        for nodes in self.elements:
            m[np.ix_(nodes, nodes)] += density * self.volume * N.T @ N
        return m

    def _softness(self):
        """Inverse of the stiffness of the incompatible modes of an undeformed brick (9, 9)."""
        lam, mu = self.lame
        g = self.G[:, 8:]
        K = lam * np.einsum("pki,plj->kilj", g, g) + mu * np.einsum("pkj,pli->kilj", g, g)
        K += mu * np.einsum("pkm,plm,ij->kilj", g, g, np.eye(3))
        return np.linalg.inv(self.volume * K.reshape(9, 9))

    def forces(self, u, a):
        """Elastic forces on the nodes (n, 3) and the energy; a (e, 3, 3), a guess, becomes the amplitudes."""
        f = np.zeros_like(u)
        return f, elastic(self.elements, self.G, self.volume, *self.lame, self.soft, u, a, f)

    def stiffness(self):
        """Of the undeformed mesh (3 n, 3 n), by central differences of 1e-8 m."""
        columns = []
        for unit in np.eye(self.nodes.size).reshape(-1, *self.nodes.shape) * 1e-8:
            f = [self.forces(side * unit, np.zeros((len(self.elements), 3, 3)))[0] for side in (-1, 1)]
            columns.append((f[0] - f[1]).ravel() / 2e-8)
        return np.array(columns).T


@njit
def brick(G, volume, lam, mu, u, r):
    """r (11, 3): integrals of F S grad; u (11, 3): nodes, then incompatible modes.  The energy."""
    H, E, P = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3))
    r[:] = 0.0
    energy = 0.0
    for p in range(8):
        for i in range(3):
            for j in range(3):
                H[i, j] = 0.0
                for a in range(11):
                    H[i, j] += u[a, i] * G[p, a, j]
        for i in range(3):
            for j in range(3):
                # F'F - 1 written out, or strains of small displacements would drown in round-off.
                E[i, j] = (H[i, j] + H[j, i] + H[0, i] * H[0, j] + H[1, i] * H[1, j] + H[2, i] * H[2, j]) / 2
        trace = E[0, 0] + E[1, 1] + E[2, 2]
        energy += volume * lam * trace * trace / 2
        for i in range(3):
            for j in range(3):
                energy += volume * mu * E[i, j] * E[i, j]
                P[i, j] = 2 * mu * E[i, j] + lam * trace * H[i, j]
                for k in range(3):
                    P[i, j] += 2 * mu * H[i, k] * E[k, j]
            P[i, i] += lam * trace
        for a in range(11):
            for i in range(3):
                for j in range(3):
                    r[a, i] += volume * P[i, j] * G[p, a, j]
    return energy


@njit
def correct(soft, F, u, r):
    """A Newton step of the incompatible modes with the stiffness of the undeformed brick turned by F."""
    turned = np.zeros(9)
    for k in range(3):
        for i in range(3):
            for j in range(3):
                turned[3 * k + j] += r[8 + k, i] * F[i, j]
    for k in range(3):
        for j in range(3):
            change = 0.0
            for q in range(9):
                change += soft[3 * k + j, q] * turned[q]
            for i in range(3):
                u[8 + k, i] -= F[i, j] * change


@njit
def largest(values):
    """Of the magnitudes of an array (n, 3)."""
    top = 0.0
    for row in values:
        for value in row:
            top = max(top, abs(value))
    return top


@njit
def elastic(elements, G, volume, lam, mu, soft, nodal, amplitudes, forces):
    """Add the nodal forces; amplitudes becomes those without force.  The energy."""
    u, r, F = np.empty((11, 3)), np.empty((11, 3)), np.empty((3, 3))
    roundoff = 1e-15 * volume * lam * np.abs(G).max()
    energy = 0.0
    for e in range(len(elements)):
        F[:] = 0.0
        for i in range(3):
            F[i, i] = 1.0
        for a in range(8):
            for i in range(3):
                u[a, i] = nodal[elements[e, a], i]
                for j in range(3):
                    for p in range(8):
                        F[i, j] += u[a, i] * G[p, a, j] / 8
        u[8:] = amplitudes[e]
        for _ in range(50):
            stored = brick(G, volume, lam, mu, u, r)
            if largest(r[8:]) <= max(1e-7 * largest(r[:8]), roundoff):
                break
            correct(soft, F, u, r)
        else:
            raise ArithmeticError("incompatible modes of a brick not found")
        energy += stored
        amplitudes[e] = u[8:]
        for a in range(8):
            for i in range(3):
                forces[elements[e, a], i] -= r[a, i]
    return energy


def swing(bricks, held, gravity, step, times):
    """Released at rest: displacements and velocities (t, n, 3), energies (t,); times are whole steps."""
    free = np.setdiff1d(np.arange(len(bricks.nodes)), held)
    factor = cho_factor(bricks.m[np.ix_(free, free)])
    weight = bricks.m.sum(axis=1)[:, None] * gravity
    u, v = np.zeros((2, *bricks.nodes.shape))
    a = np.zeros((len(bricks.elements), 3, 3))
    rows, counts = [], np.rint(np.asarray(times) / step).astype(int)
    np.testing.assert_allclose(counts * step, times, rtol=1e-12)

    def accelerate():
        f, energy = bricks.forces(u, a)
        return cho_solve(factor, (f + weight)[free], check_finite=False), energy

    push, energy = accelerate()
    for count in range(counts[-1] + 1):
        if count in counts:
            total = energy + np.sum(v * (bricks.m @ v)) / 2 - np.sum(weight * u)
            rows.append((u.copy(), v.copy(), total))
        v[free] += step / 2 * push
        u[free] += step * v[free]
        push, energy = accelerate()
        v[free] += step / 2 * push
    return tuple(np.array(column) for column in zip(*rows, strict=True))
