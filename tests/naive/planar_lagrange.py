"""Trees and loops that move in the plane of axes 2 and 3: Lagrange's equations in complex numbers.

A point of the plane is z = x2 + i x3, and a turn by phi about axis 1 is a factor exp(i phi).  Every
point of such a tree, nodes included, is

    z = sum_j exp(i phi_j) (c_j + D_j q),    phi = A q + phi0,    phi_0 = 0: the inertial frame,

with constant c, D, A, because displacements and slides enter linearly.  With masses m at points and
spin inertias I of bodies, 2 T = sum m |z'|^2 + sum I phi'^2, and Lagrange's equations become

    M q'' + h = Q + G' lambda,    M = Re(J* m J) + A' I A,    h = Re(J* m r),    J = dz/dq,

r being what z'' keeps without q''.  Loops are closed by multipliers, G q'' = -(r of the gap).  There is
no recursion, no relative motion and no choice of independent speeds.  numba only makes the loops fast.
"""

import itertools

import numpy as np
from numba import njit
from scipy.integrate import solve_ivp

from flexmb_cli.model.tree import ELASTIC, INERTIAL, ROTATION, TRANSLATION

UNIT = {2: 1, 3: 1j}


def plane(vector):
    """Complex number of a vector (3,) without component 1."""
    assert vector[0] == 0
    return vector[1] + 1j * vector[2]


def angle(attitude):
    """Angle about axis 1 of Euler parameters e0..e3."""
    assert attitude[2] == attitude[3] == 0
    return 2 * np.arctan2(attitude[1], attitude[0])


class Frames:
    """A, phi0 and the origins O_k of all bodies as pairs c (bodies + 1,), D (bodies + 1, NS).

    Frame 0 is the inertial one, frame k + 1 that of body k.
    """

    def __init__(self, tree):
        self.tree = tree
        self.index = {(c.body, c.motion, c.axis, c.node): m for m, c in enumerate(tree.coordinates)}
        count = len(tree.bodies) + 1
        self.A = np.zeros((count, len(tree.coordinates)))
        self.phi0 = np.zeros(count)
        self.origins = [(np.zeros(count, complex), np.zeros((count, len(tree.coordinates)), complex))]
        for k in range(len(tree.bodies)):
            self._hang(k)

    def _hang(self, k):
        hinge, j = self.tree.hinges[k], self.tree.hinges[k].parent + 1
        c, D = self.point(hinge.parent, hinge.point, None)
        tilt = angle(hinge.frame)
        if hinge.node is not None:
            self._displace(D, hinge.parent, hinge.node)
        for axis in hinge.translations:
            D[j, self.index[k, TRANSLATION, axis, None]] += UNIT[axis] * np.exp(1j * tilt)
        self.origins.append((c, D))
        self.A[k + 1], self.phi0[k + 1] = self.A[j], self.phi0[j] + tilt
        if hinge.rotations:
            self.A[k + 1, self.index[k, ROTATION, 1, None]] += 1
        else:
            self.phi0[k + 1] += angle(hinge.attitude)

    def point(self, body, place, node):
        """c and D of a point of a body, at `place` in its axes or at a displaced node."""
        c, D = (part.copy() for part in self.origins[body + 1])
        if node is not None:
            place = self.tree.bodies[body].elastic.positions[node]
            self._displace(D, body, node)
        c[body + 1] += plane(place)
        return c, D

    def _displace(self, D, body, node):
        for axis in self.tree.bodies[body].elastic.axes:
            D[body + 1, self.index[body, ELASTIC, axis, node]] += UNIT[axis]


class Points:
    """Several points: c (points, frames) and D (points, frames, NS) of all."""

    def __init__(self, frames, pairs):
        count, size = frames.A.shape
        self.c = np.array([c for c, _ in pairs], complex).reshape(-1, count)
        self.D = np.array([D for _, D in pairs], complex).reshape(-1, count, size)


@njit
def derivatives(A, phi0, c, D, q, y):
    """z (points,), J = dz/dq (points, NS) and r (points,), what z'' keeps without q''."""
    points, frames, size = D.shape
    z, r, J = np.zeros(points, c.dtype), np.zeros(points, c.dtype), np.zeros((points, size), c.dtype)
    phi, spin = A @ q + phi0, A @ y
    for p in range(points):
        for j in range(frames):
            w = np.exp(1j * phi[j])
            arm, rate = c[p, j], 0j
            for m in range(size):
                arm += D[p, j, m] * q[m]
                rate += D[p, j, m] * y[m]
            for m in range(size):
                J[p, m] += w * (D[p, j, m] + 1j * arm * A[j, m])
            z[p] += w * arm
            r[p] += w * (2j * spin[j] * rate - spin[j] ** 2 * arm)
    return z, J, r


@njit
def components(values):
    """Components 2 above components 3."""
    return np.concatenate((values.real, values.imag))


@njit
def accelerations(
    A, phi0, c, D, weight, force, inertia, stiffness, kept, closed_c, closed_D, rows, q, y, turning
):
    """q'' (NS,) of M q'' - G' lambda = Q - h, G q'' = -r; `turning` (NS,): generalized torques."""
    n, loops = len(q), len(rows)
    _, J, r = derivatives(A, phi0, c, D, q, y)
    slopes, weights = components(J), np.concatenate((weight, weight))
    pushed = components(force) - weights * components(r)
    bordered, right = np.zeros((n + loops, n + loops)), np.zeros(n + loops)
    bordered[:n, :n] = (slopes.T @ (weights.reshape(-1, 1) * slopes) + inertia) * kept
    right[:n] = slopes.T @ pushed - stiffness @ q + turning
    if loops:
        _, J, r = derivatives(A, phi0, closed_c, closed_D, q, y)
        G = components(J)[rows]
        bordered[:n, n:], bordered[n:, :n], right[n:] = G.T, G, -components(r)[rows]
    return np.linalg.solve(bordered, right)[:n]


class PlanarTree:
    """The equations of one deck, of what the cards of 1992, GRAV, UNCO and LOOP can say."""

    def __init__(self, tree):
        assert not (tree.elements or tree.prescribed)
        assert all(hinge.elastic_rotation is None for hinge in tree.hinges)
        self.tree, self.frames = tree, Frames(tree)
        masses, forces, places = [], [], []
        for k, body in enumerate(tree.bodies):
            assert not np.any(body.force)
            nodes = body.elastic.masses if body.elastic is not None else np.zeros(0)
            masses += [body.mass - nodes.sum(), *nodes]
            forces += [0.0, *map(plane, body.elastic.forces if len(nodes) else ())]
            places += [self.frames.point(k, body.centre, None)]
            places += [self.frames.point(k, None, node) for node in range(len(nodes))]
        points, (closed, self.rows) = Points(self.frames, places), self._closures()
        self.closed = self.frames.A, self.frames.phi0, closed.c, closed.D
        self.numbers = (
            *(self.frames.A, self.frames.phi0, points.c, points.D, np.array(masses)),
            np.array(masses) * plane(tree.gravity) + np.array(forces, complex),
            *(self._spin_inertia(), self._stiffness(), self._kept(), closed.c, closed.D, self.rows),
        )

    def _spin_inertia(self):
        """A' I A: what the mass points leave of the moments of inertia about the origins O_k."""
        own = [b.inertia[0, 0] - self._about_origin(k) for k, b in enumerate(self.tree.bodies)]
        return self.frames.A[1:].T @ (np.array(own)[:, None] * self.frames.A[1:])

    def _kept(self):
        """Which elements of M stay: all but, one-way, the columns of elastic in the rows of rigid ones.

        That is the assumption of thesis 4.3: elastic accelerations do not act on the rigid motion.
        Forces, and inertia forces by displacements and their rates, stay where they are.
        """
        elastic = np.array([c.motion == ELASTIC for c in self.tree.coordinates])
        return np.where(self.tree.one_way & np.outer(~elastic, elastic), 0.0, 1.0)

    def _about_origin(self, k):
        """What the mass points of a body have of its moment of inertia about O_k."""
        body = self.tree.bodies[k]
        if body.elastic is None:
            return body.mass * abs(plane(body.centre)) ** 2
        return sum(
            m * abs(plane(x)) ** 2 for m, x in zip(body.elastic.masses, body.elastic.positions, strict=True)
        )

    def _stiffness(self):
        K = np.zeros((len(self.tree.coordinates),) * 2)
        for k, body in enumerate(self.tree.bodies):
            if body.elastic is not None:
                assert body.elastic.damping is None and body.elastic.stiffened_from is None
                first = self.frames.index[k, ELASTIC, body.elastic.axes[0], 0]
                own = slice(first, first + body.elastic.coordinates)
                K[own, own] = body.elastic.stiffness
        return K

    def _closures(self):
        """Points of all closures less those that they keep to, and their rows in `components`."""
        pairs, rows = [], []
        for i, closure in enumerate(self.tree.closures):
            assert closure.b == INERTIAL and closure.b_node is None  # the closed directions do not turn
            c, D = self.frames.point(closure.a, closure.a_point, closure.a_node)
            c[0] -= plane(closure.b_point)
            pairs.append((c, D))
            rows += [i + len(self.tree.closures) * (axis - 2) for axis in closure.directions]
        return Points(self.frames, pairs), np.array(rows, int)

    def start(self):
        """q and y of the deck, the loops closed by all rotations but the first (decks have nine digits)."""
        q, y = np.array(self.tree.q, float), np.array(self.tree.y, float)
        if len(self.rows) == 0:
            return q, y
        turned = [m for m, c in enumerate(self.tree.coordinates) if c.motion == ROTATION][1:]
        for _ in range(10):
            gap, G = self._gaps(q, y)
            q[turned] -= np.linalg.solve(G[:, turned], gap)
        _, G = self._gaps(q, y)
        y[turned] -= np.linalg.solve(G[:, turned], G @ y)
        return q, y

    def _gaps(self, q, y):
        gap, G, _ = derivatives(*self.closed, q, y)
        return components(gap)[self.rows], components(G)[self.rows]

    def run(self, times, rtol, atol):
        """q and y (times, NS) at ascending report times; steps end where a torque jumps or bends."""
        n, state = len(self.tree.q), np.concatenate(self.start())
        blocks = [state[None]]
        bends = sorted(
            {
                line[0]
                for torque in self.tree.torques
                for line in torque.function.pieces
                if 0 < line[0] < times[-1]
            }
        )
        for begin, end in itertools.pairwise([times[0], *bends, times[-1]]):
            due = times[(times > begin) & (times <= end)]
            slope = self._slope((begin + end) / 2)
            done = solve_ivp(
                slope, (begin, end), state, "DOP853", np.union1d(due, end), rtol=rtol, atol=atol
            ).y
            state = done[:, -1]
            blocks.append(done[:, : len(due)].T)
        rows = np.concatenate(blocks)
        return rows[:, :n], rows[:, n:]

    def _slope(self, inside):
        """Right-hand side for the pieces of the torque laws that hold at time `inside`."""
        n, torques = len(self.tree.q), self._torques(inside)
        turns = self.frames.A[1:].T

        def slope(t, state):
            q, y = np.ascontiguousarray(state[:n]), np.ascontiguousarray(state[n:])
            return np.concatenate([y, accelerations(*self.numbers, q, y, turns @ torques(t))])

        return slope

    def _torques(self, inside):
        """Torques on all bodies as a function of time, by the pieces of the laws that hold at `inside`."""
        constant = np.array([body.torque[0] for body in self.tree.bodies], float)
        rise = np.zeros(len(constant))
        for torque in self.tree.torques:
            assert torque.axis == 1
            value, slope = piece(torque.function, inside)
            constant[torque.body] += value
            rise[torque.body] += slope
        return lambda t: constant + rise * t


def piece(function, inside):
    """Constant and slope of the line that a law follows around a time that is none of its points."""
    start, value, slope = [line for line in function.pieces if line[0] < inside][-1]
    return value - slope * start, slope
