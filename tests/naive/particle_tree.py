"""The equations of a tree from nothing but the positions of particles.

Every rigid body is replaced by ten weighted points with its mass, first moment and inertia, every
nodal mass is a point.  Positions are analytic functions of the coordinates, so partial velocities come
from a complex step and acceleration remainders from Cauchy's integral, both to round-off; d'Alembert's
principle for the points then gives the whole matrix b and the columns F and f*.  Nothing is shared
with the recursion: no spatial algebra, no angular velocities, no mass matrix of a body.
"""

import numpy as np

from flexmb_cli.model.arrays.tree_frames import rotation_matrix
from flexmb_cli.model.laws import SPRING
from flexmb_cli.model.tree import ELASTIC, INERTIAL, ROTATION, TRANSLATION

CIRCLE = 32


def about(axis, angle):
    """Rotation about axis 1, 2 or 3 by a complex angle."""
    a, b = axis % 3, (axis + 1) % 3
    R = np.eye(3, dtype=complex)
    R[a, a] = R[b, b] = np.cos(angle)
    R[a, b], R[b, a] = -np.sin(angle), np.sin(angle)
    return R


def turn(vector):
    """exp of the skew matrix of a complex vector of a length of one or so, by its series."""
    x, y, z = vector
    skew = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    total = term = np.eye(3, dtype=complex)
    for n in range(1, 40):
        term = term @ skew / n
        total = total + term
    return total


class Particles:
    """Points of a tree with their weights, in the order body by body: ten rigid ones, then nodes."""

    def __init__(self, tree, attitudes):
        self.tree = tree
        self.index = {(c.body, c.motion, c.axis, c.node): m for m, c in enumerate(tree.coordinates)}
        balls = [k for k, hinge in enumerate(tree.hinges) if len(hinge.rotations) == 3]
        self.attitudes = dict(zip(balls, attitudes, strict=True))
        self.stencils = [stencil(body) for body in tree.bodies]
        self.weights = np.concatenate([w for k in range(len(tree.bodies)) for w in self._weights(k)])

    def _weights(self, k):
        elastic = self.tree.bodies[k].elastic
        return self.stencils[k][1], elastic.masses if elastic is not None else np.zeros(0)

    def displacement(self, k, node, q):
        """Displacement of a node in the axes of its body."""
        u = np.zeros(3, q.dtype)
        for axis in self.tree.bodies[k].elastic.axes:
            u[axis - 1] = q[self.index[k, ELASTIC, axis, node]]
        return u

    def frames(self, q, turned):
        """Origins and attitudes of all bodies; balls turned from their attitude by q of `turned`."""
        out = []
        for k, hinge in enumerate(self.tree.hinges):
            p, S = (np.zeros(3), np.eye(3)) if hinge.parent == INERTIAL else out[hinge.parent]
            point = np.array(hinge.point, complex)
            if hinge.node is not None:
                point = point + self.displacement(hinge.parent, hinge.node, q)
            P = S @ self._tilt(k, q) @ rotation_matrix(hinge.frame)
            slide = np.zeros(3, complex)
            for axis in hinge.translations:
                slide[axis - 1] = q[self.index[k, TRANSLATION, axis, None]]
            out.append((p + S @ point + P @ slide, P @ self._turn(k, q, turned)))
        return out

    def _tilt(self, k, q):
        """Elastic rotation of the hinge node: successive rotations by C w."""
        hinge = self.tree.hinges[k]
        R = np.eye(3)
        if hinge.elastic_rotation is not None:
            first = self.index[hinge.parent, ELASTIC, self.tree.bodies[hinge.parent].elastic.axes[0], 0]
            angles = hinge.elastic_rotation @ q[first : first + hinge.elastic_rotation.shape[1]]
            for axis in range(3):
                R = R @ about(axis + 1, angles[axis])
        return R

    def _turn(self, k, q, turned):
        hinge = self.tree.hinges[k]
        angles = [q[self.index[k, ROTATION, axis, None]] for axis in hinge.rotations]
        if len(angles) == 3:
            first = self.index[k, ROTATION, 1, None]
            return turn(turned[first : first + 3]) @ rotation_matrix(self.attitudes[k])
        if not angles:
            return rotation_matrix(hinge.attitude)
        R = np.eye(3)
        for axis, angle in zip(hinge.rotations, angles, strict=True):
            R = R @ about(axis, angle)
        return R

    def positions(self, q, turned):
        """Positions (points, 3) of all particles."""
        out = []
        for k, (p, S) in enumerate(self.frames(q, turned)):
            out += [p + S @ x for x in self.stencils[k][0]]
            elastic = self.tree.bodies[k].elastic
            for i in range(len(elastic.masses) if elastic else 0):
                out.append(p + S @ (elastic.positions[i] + self.displacement(k, i, q)))
        return np.array(out)


def stencil(body):
    """Ten points with the mass, first moment and inertia of a body without its nodes."""
    e = np.eye(3)
    points = np.array([0 * e[0], *e, *-e, e[0] + e[1], e[0] + e[2], e[1] + e[2]])
    J, mass, moment = np.array(body.inertia, float), body.mass, body.mass * np.array(body.centre)
    if body.elastic is not None:
        mass, moment = mass - body.elastic.masses.sum(), np.zeros(3)
        for m, x in zip(body.elastic.masses, body.elastic.positions, strict=True):
            J = J - m * (x @ x * e - np.outer(x, x))
    E = np.trace(J) / 2 * e - J
    pairs = [(i, j) for i in range(3) for j in range(i, 3)]
    rows = [np.ones(10), *points.T, *(points[:, i] * points[:, j] for i, j in pairs)]
    return points, np.linalg.solve(np.array(rows), [mass, *moment, *(E[i, j] for i, j in pairs)])


def equations(tree, q, y, attitudes):
    """b (NS, NS), f* (NS,) and F (NS,) of a tree with constant loads, springs and elastic bodies."""
    particles = Particles(tree, attitudes)
    n = len(q)
    zero = np.zeros(n)
    J = np.zeros((n, len(particles.weights), 3))
    turns = np.zeros((n, len(tree.bodies), 3))
    S = [attitude for _, attitude in particles.frames(q + 0j, zero)]
    for m in range(n):
        step = 1e-30j * np.eye(n)[m]
        J[m] = particles.positions(q + step, step).imag * 1e30
        for k, (_, turned) in enumerate(particles.frames(q + step, step)):
            skew = (turned.imag * 1e30) @ S[k].real.T
            turns[m, k] = [skew[2, 1], skew[0, 2], skew[1, 0]]
    remainder = second_derivative(lambda t: particles.positions(q + t * y, t * y), y)
    weighted = J * particles.weights[:, None]
    b = np.einsum("mik,nik->mn", weighted, J)
    return b, np.einsum("mik,ik->m", weighted, remainder), applied(tree, particles, q, y, J, turns)


def second_derivative(f, y):
    """Second derivative at 0 of an analytic function of t that turns with speeds y, by Cauchy's integral.

    On a circle that turns nothing by much more than a radian 32 points are enough for round-off.
    """
    z = np.exp(2j * np.pi * np.arange(CIRCLE) / CIRCLE) / (1 + np.max(np.abs(y)))
    return 2 * sum(f(t) / t**2 for t in z).real / CIRCLE


def applied(tree, particles, q, y, J, turns):
    """F: gravity, body forces and torques, nodal forces, elastic forces, springs."""
    F = np.einsum("mik,i,k->m", J, particles.weights, np.array(tree.gravity, float))
    point = 0
    for k, body in enumerate(tree.bodies):
        F += J[:, point] @ np.array(body.force, float)  # the stencil's first point is O_k
        F += turns[:, k] @ np.array(body.torque, float)
        point += 10
        if body.elastic is not None:
            count = len(body.elastic.masses)
            F += np.einsum("mik,ik->m", J[:, point : point + count], body.elastic.forces)
            point += count
            first = particles.index[k, ELASTIC, body.elastic.axes[0], 0]
            here = slice(first, first + body.elastic.coordinates)
            F[here] -= body.elastic.stiffness @ q[here]
            if body.elastic.damping is not None:
                F[here] -= body.elastic.damping @ y[here]
    for s in tree.elements.of(SPRING):
        motion, axis = s.measure.coordinate.split()
        m = particles.index[s.measure.joint, motion, int(axis), None]
        F[m] -= s["stiffness"] * (q[m] - s["rest"]) + s["damping"] * y[m]
    return F
