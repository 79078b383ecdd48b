"""Spatial trees in absolute coordinates: points and direction vectors, a constant mass matrix, multipliers.

A body is its origin p and the three columns d of its rotation matrix, 12 numbers; a node with three
freedoms is its place r.  The mass matrix of these is constant and there are no gyroscopic terms.  All
conditions (orthonormal d, hinges) and the elastic displacements d_a . (r - p) - x_a are quadratic in
the coordinates X, so that their derivatives are exact and short:

    M X'' = F - (dw/dX)' K w + (dPhi/dX)' lambda,    (dPhi/dX) X'' = -X' H X'.

Natural coordinates after de Jalon and Bayo; no angular velocities, no Euler parameters, no recursion.
"""

import numpy as np
from scipy.integrate import solve_ivp
from scipy.linalg import block_diag
from scipy.spatial.transform import Rotation

from flexmb_cli.model.tree import ELASTIC, INERTIAL, ROTATION

TRIPLE = np.eye(3)


def rotation(attitude):
    """Rotation matrix of Euler parameters, scalar first."""
    return Rotation.from_quat(np.roll(attitude, -1)).as_matrix()


class Quadratic:
    """Functions c + b X + X' H X / 2, one for each added row."""

    def __init__(self, size):
        self.size, self.rows = size, []

    def add(self, products=(), linear=(), constant=0.0):
        """One function: a sum of A.B over pairs of linear forms, of linear forms (size,), a constant."""
        H = sum((np.outer(a, b) + np.outer(b, a) for a, b in products), np.zeros((self.size,) * 2))
        self.rows.append((H, sum(linear, np.zeros(self.size)), constant))

    def close(self):
        """Turn the rows into arrays, when all are there."""
        self.H, self.b, self.c = (np.array(part) for part in zip(*self.rows, strict=True))

    def slope(self, X):
        """Jacobian (rows, size)."""
        return self.H @ X + self.b

    def value(self, X):
        """Values (rows,)."""
        return self.c + (self.b + self.H @ X / 2) @ X

    def bend(self, V):
        """Second derivatives along speeds V (rows,)."""
        return (self.H @ V) @ V


class SpatialTree:
    """The equations of one deck: balls and single rotations, nodes with three freedoms, gravity."""

    def __init__(self, tree):
        assert not (tree.elements or tree.prescribed or tree.torques or tree.closures)
        self.tree = tree
        self.nodes = [
            (k, i) for k, b in enumerate(tree.bodies) if b.elastic for i in range(len(b.elastic.masses))
        ]
        self.size = 12 * len(tree.bodies) + 3 * len(self.nodes)
        self.M, self.F = self._masses()
        self.conditions, self.strains = Quadratic(self.size), Quadratic(self.size)
        for k in range(len(tree.bodies)):
            self._keep_rigid(k)
            self._hang(k)
        for k, i in self.nodes:
            self._measure(k, i)
        self.conditions.close()
        if self.nodes:
            self.strains.close()
            self.K = block_diag(*(body.elastic.stiffness for body in tree.bodies if body.elastic))

    # Linear forms: component `axis` (0, 1, 2, inertial) of an origin, a direction vector or a node.

    def origin(self, k, axis):
        return self._unit(12 * k + axis)

    def direction(self, k, vector, axis):
        """Component of the vector (3,), given in the axes of body k."""
        return sum(vector[a] * self._unit(12 * k + 3 + 3 * a + axis) for a in range(3))

    def node(self, k, i, axis):
        return self._unit(self._node_place(k, i) + axis)

    def _node_place(self, k, i):
        return 12 * len(self.tree.bodies) + 3 * self.nodes.index((k, i))

    def _unit(self, place):
        return np.eye(self.size)[place]

    def _masses(self):
        """Constant mass matrix and forces: 2 T = sum of [m s'; s E] over (p, d1, d2, d3), and nodes."""
        M, F = np.zeros((self.size,) * 2), np.zeros(self.size)
        g = np.array(self.tree.gravity)
        for k, body in enumerate(self.tree.bodies):
            own = slice(12 * k, 12 * k + 12)
            J, mass, s = np.array(body.inertia), body.mass, body.mass * np.array(body.centre)
            if body.elastic is not None:
                mass, s = mass - body.elastic.masses.sum(), np.zeros(3)
                for m, x in zip(body.elastic.masses, body.elastic.positions, strict=True):
                    J = J - m * (x @ x * np.eye(3) - np.outer(x, x))
            E = np.trace(J) / 2 * np.eye(3) - J
            M[own, own] = np.kron(np.block([[np.array([[mass]]), s[None]], [s[:, None], E]]), TRIPLE)
            F[own] = np.kron([mass, *s], g)
            assert not (np.any(body.force) or np.any(body.torque))
        for k, i in self.nodes:
            elastic = self.tree.bodies[k].elastic
            assert elastic.axes == (1, 2, 3) and elastic.damping is None and elastic.stiffened_from is None
            here = slice(self._node_place(k, i), self._node_place(k, i) + 3)
            M[here, here] = elastic.masses[i] * TRIPLE
            F[here] = elastic.masses[i] * g + elastic.forces[i]
        return M, F

    def _scalar(self, a, b):
        """Pairs of forms for the scalar product of two vectors: (body, vector) each."""
        return [(self.direction(*a, axis), self.direction(*b, axis)) for axis in range(3)]

    def _keep_rigid(self, k):
        for a in range(3):
            for b in range(a, 3):
                self.conditions.add(self._scalar((k, TRIPLE[a]), (k, TRIPLE[b])), constant=-float(a == b))

    def _hang(self, k):
        """Origin on the hinge point and, with one rotation, its axis square to two vectors of the parent."""
        hinge = self.tree.hinges[k]
        assert not hinge.translations and hinge.elastic_rotation is None
        for axis in range(3):
            form, constant = self._hinge_point(hinge, axis)
            self.conditions.add(linear=[self.origin(k, axis), -form], constant=-constant)
        if len(hinge.rotations) == 3:
            assert hinge.parent == INERTIAL and np.allclose(rotation(hinge.frame), np.eye(3))
            return
        (turning,) = hinge.rotations
        frame = rotation(hinge.frame)
        for square in (frame[:, turning % 3], frame[:, (turning + 1) % 3]):
            self.conditions.add(self._scalar((hinge.parent, square), (k, TRIPLE[turning - 1])))

    def _hinge_point(self, hinge, axis):
        """Component of P_k as a linear form and a constant."""
        if hinge.parent == INERTIAL:
            return np.zeros(self.size), hinge.point[axis]
        if hinge.node is not None:
            return self.node(hinge.parent, hinge.node, axis), 0.0
        return self.origin(hinge.parent, axis) + self.direction(hinge.parent, hinge.point, axis), 0.0

    def _measure(self, k, i):
        """Displacements of a node along the axes of its body."""
        x = self.tree.bodies[k].elastic.positions[i]
        for a in range(3):
            apart = [self.node(k, i, axis) - self.origin(k, axis) for axis in range(3)]
            along = [self.direction(k, TRIPLE[a], axis) for axis in range(3)]
            self.strains.add(list(zip(along, apart, strict=True)), constant=-x[a])

    def accelerations(self, X, V):
        """X'' (size,)."""
        J = self.conditions.slope(X)
        force = self.F
        if self.nodes:
            force = force - self.strains.slope(X).T @ (self.K @ self.strains.value(X))
        bordered = np.block([[self.M, J.T], [J, np.zeros((len(J),) * 2)]])
        return np.linalg.solve(bordered, np.concatenate([force, -self.conditions.bend(V)]))[: self.size]

    def start(self):
        """X and V (size,) of the deck's coordinates and speeds, body by body."""
        X, V = np.zeros(self.size), np.zeros(self.size)
        for k, hinge in enumerate(self.tree.hinges):
            R, w = self._attitude(k, X, V)
            forms = [self._hinge_point(hinge, axis) for axis in range(3)]
            origin = slice(12 * k, 12 * k + 3)
            V[origin] = [form @ V for form, _ in forms]
            X[origin] = [form @ X + constant for form, constant in forms]
            self._place(X, V, 12 * k + 3, R.T, np.cross(w, R.T))
            for i in [i for body, i in self.nodes if body == k]:
                u, rate = (self._coordinates(values, k, ELASTIC, i) for values in (self.tree.q, self.tree.y))
                arm = R @ (self.tree.bodies[k].elastic.positions[i] + u)
                moving = V[origin] + np.cross(w, arm) + R @ rate
                self._place(X, V, self._node_place(k, i), X[origin] + arm, moving)
        return X, V

    @staticmethod
    def _place(X, V, first, places, speeds):
        here = slice(first, first + places.size)
        X[here], V[here] = places.ravel(), speeds.ravel()

    def _attitude(self, k, X, V):
        """Rotation matrix and angular velocity of a body at the start."""
        hinge, y = self.tree.hinges[k], self._coordinates(self.tree.y, k, ROTATION)
        if len(hinge.rotations) == 3:
            return rotation(hinge.attitude), y
        R, w = self.turning(hinge.parent, X, V)
        (axis,) = hinge.rotations
        P, e = R @ rotation(hinge.frame), TRIPLE[axis - 1]
        angle = self._coordinates(self.tree.q, k, ROTATION)
        return P @ Rotation.from_rotvec(angle * e).as_matrix(), w + P @ e * y

    def _coordinates(self, values, body, motion, node=None):
        """Entries of a body's coordinates, or of one of its nodes, out of a list of all."""
        kind = (body, motion, node)
        return values[[(c.body, c.motion, c.node) == kind for c in self.tree.coordinates]]

    def turning(self, k, X, V):
        """Rotation matrix, and angular velocity as half the sum of d x d'."""
        R, rate = (part[12 * k + 3 : 12 * k + 12].reshape(3, 3) for part in (X, V))
        return R.T, np.cross(R, rate).sum(axis=0) / 2

    def relative_turning(self, k, X, V):
        """Attitude of body k in its P_k axes, and its angular velocity against them."""
        R, w = self.turning(k, X, V)
        hinge = self.tree.hinges[k]
        if hinge.parent == INERTIAL:
            return R, w
        Rj, wj = self.turning(hinge.parent, X, V)
        P = Rj @ rotation(hinge.frame)
        return P.T @ R, P.T @ (w - wj)

    def run(self, times, rtol, atol):
        """The deck's coordinates and speeds (times, NS); those of a ball are integrals of its spin."""
        n, (X, V) = self.size, self.start()
        balls = [k for k, hinge in enumerate(self.tree.hinges) if len(hinge.rotations) == 3]
        spun = np.zeros(3 * len(balls))

        def slope(t, state):
            X, V = state[:n], state[n : 2 * n]
            spins = [self.relative_turning(k, X, V)[1] for k in balls]
            return np.concatenate([V, self.accelerations(X, V), *spins])

        state = np.concatenate([X, V, spun])
        done = solve_ivp(slope, times[[0, -1]], state, "DOP853", times, rtol=rtol, atol=atol)
        rows = [self._read(z[:n], z[n : 2 * n], iter(z[2 * n :].reshape(-1, 3))) for z in done.y.T]
        q, y = (np.array(part) for part in zip(*rows, strict=True))
        angles = [c.motion == ROTATION for c in self.tree.coordinates]
        q[:, angles] = np.unwrap(q[:, angles], axis=0)
        return q, y

    def _read(self, X, V, spun):
        """q and y of one row; angles within half a turn."""
        q, y = [], []
        for k, hinge in enumerate(self.tree.hinges):
            R, w = self.relative_turning(k, X, V)
            if len(hinge.rotations) == 3:
                q += list(next(spun))
                y += list(w)
            else:
                (axis,) = hinge.rotations
                q.append(np.arctan2(R[(axis + 1) % 3, axis % 3], R[axis % 3, axis % 3]))
                y.append(w[axis - 1])
        if self.nodes:
            q += list(self.strains.value(X))
            y += list(self.strains.slope(X) @ V)
        return q, y
