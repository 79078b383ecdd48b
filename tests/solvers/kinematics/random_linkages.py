"""Random linkages of ten types, built at a position known exactly, with estimates disturbed from it.

A linkage is points and axes in global axes at its exact position, given to bodies whose frames are placed and
turned at random.  Its deck is typed from them; `Judge` closes it by SciPy, sharing nothing with the program.
"""

from dataclasses import dataclass, field

import numpy as np
from scipy.optimize import least_squares

from tests.solvers.kinematics.geometry import euler_parameters, product, unit

X, Y, Z = np.eye(3)
LARGEST_TURN, LARGEST_SHIFT = np.radians(30.0), 0.3
ORDER = ("spherical", "universal", "revolute", "cylindrical", "translational")
TYPES = (
    "slider_crank",
    "four_bar",
    "rssr",
    "six_bar",
    "inverted_slider_crank",
    "double_wishbone",
    "scissor",
    "parallel",
    "quick_return",
    "two_loops",
)


def matrix(p):
    """A(p) of any p (4,), quadratic in it."""
    e0, e1, e2, e3 = p
    return np.array(
        [
            [e0 * e0 + e1 * e1 - e2 * e2 - e3 * e3, 2 * (e1 * e2 - e0 * e3), 2 * (e1 * e3 + e0 * e2)],
            [2 * (e1 * e2 + e0 * e3), e0 * e0 - e1 * e1 + e2 * e2 - e3 * e3, 2 * (e2 * e3 - e0 * e1)],
            [2 * (e1 * e3 - e0 * e2), 2 * (e2 * e3 + e0 * e1), e0 * e0 - e1 * e1 - e2 * e2 + e3 * e3],
        ]
    )


def turn_between(p, q):
    """The angle between two attitudes, rad."""
    return 2.0 * np.arctan2(np.linalg.norm((product(p * [1, -1, -1, -1], q))[1:]), abs(p @ q))


@dataclass
class Linkage:
    """Bodies (r, p) at the exact position, joints in their axes, and drivers (body, direction, value)."""

    random: np.random.Generator
    bodies: list = field(default_factory=lambda: [(np.zeros(3), np.array([1.0, 0, 0, 0]))])
    joints: list = field(default_factory=list)
    drivers: list = field(default_factory=list)
    points: list = field(default_factory=list)

    def body(self, origin, p=None):
        """A body, its frame turned at random unless p is given; its number from 0."""
        p = unit(self.random.standard_normal(4)) if p is None else p
        self.bodies.append((np.array(origin, float), p * (1.0 if p[0] >= 0.0 else -1.0)))
        return len(self.bodies) - 1

    def crank(self, pivot, angle, axis=Z, direction=6):
        """A body turned about a global axis, driven at the angle."""
        body = self.body(pivot, euler_parameters(axis, angle))
        self.drivers.append((body, direction, angle))
        return body

    def join(self, kind, i, j, P, s=None, s_j=None, P_j=None):
        """A joint at the global point P (of body j at P_j) along the global vectors s and s_j."""
        P_j = P if P_j is None else P_j
        vectors = [] if s is None else [s, s if s_j is None else s_j]
        if kind == "translational":
            h = unit(np.cross(s, self.random.standard_normal(3)))
            vectors += [h, unit(np.cross(s, h))]
        local = [matrix(self.bodies[b][1]).T @ v for b, v in zip((i, j) * 2, vectors, strict=False)]
        ends = [matrix(self.bodies[b][1]).T @ (Q - self.bodies[b][0]) for b, Q in ((i, P), (j, P_j))]
        self.joints.append((kind, i, j, ends, local))
        self.points += [P, P_j]

    @property
    def size(self):
        """The largest distance of two joints."""
        points = np.array(self.points)
        return max(np.linalg.norm(points[:, None] - points[None], axis=2).ravel())

    def estimates(self):
        """The exact position, every moving body shifted and turned at random."""
        found = [self.bodies[0]]
        for r, p in self.bodies[1:]:
            shift = LARGEST_SHIFT * self.size * self.random.uniform() * unit(self.random.standard_normal(3))
            turn = LARGEST_TURN * self.random.uniform()
            found.append(
                (r + shift, product(euler_parameters(unit(self.random.standard_normal(3)), turn), p))
            )
        return found

    def deck(self, estimates, cards=""):
        """The text of a YOUNG deck; `cards` stand after the time."""
        joints = [[joint for joint in self.joints if joint[0] == kind] for kind in ORDER]
        counts = [len(self.bodies), len(self.drivers), 0, *map(len, joints), 0, 0, 0, 1]
        lines = [counts, *([*r, *p] for r, p in estimates)]
        lines += [[body + 1, direction, value, 0, 0] for body, direction, value in self.drivers]
        for _, i, j, (P_i, P_j), v in (joint for kind in joints for joint in kind):
            ends = [P_i, P_j, *(P + s for P, s in zip((P_i, P_j) * 2, v, strict=False))]
            lines.append([i + 1, j + 1, *np.concatenate(ends)])
        lines += [[1, 0, 0, 0, 0, 0, 0], [0, 0.1, 0.1]]
        text = "\n".join(
            " ".join(str(float(x)) if isinstance(x, float) else str(x) for x in line) for line in lines
        )
        return f"{text}\n{cards}"


def linkage(kind, seed):
    """A random linkage of a type of TYPES."""
    made = Linkage(np.random.default_rng([TYPES.index(kind), seed]))
    globals()[f"_{kind}"](made, made.random.uniform(-1, 1, 3) if seed % 2 else np.zeros(3))
    return made


def _apart(random, near, low=0.3, high=1.0, plane=True):
    """A point at a random distance of `near`."""
    direction = random.standard_normal(3)
    direction[2] *= not plane
    return near + random.uniform(low, high) * unit(direction)


def _far_from_line(random, A, C, low=0.3, high=1.0, plane=True):
    """A point that makes a triangle with A and C whose angles are above some ten degrees."""
    while True:
        B = _apart(random, A, low, high, plane)
        b, c = B - A, B - C
        if np.linalg.norm(c) > low and np.linalg.norm(np.cross(unit(b), unit(c))) > 0.25:
            return B


def _dyad(m, A, link, B, follower, C, axes=(None, None), last="cylindrical"):
    """A link from body `A`'s point to the follower: spherical at its first end, `last` at its other."""
    body = m.body(B)
    m.join("spherical", follower[0], body, A)
    m.join(last, body, link, B, Z)
    return body


def _slider_crank(m, o):
    A = _apart(m.random, o)
    C = _far_from_line(m.random, A, o)
    way = unit(C - o) if m.random.uniform() < 0.5 else unit(m.random.standard_normal(3) * [1, 1, 0])
    crank, rod, slider = m.crank(o, m.random.uniform(-3, 3)), m.body(A), m.body(C)
    m.join("revolute", 0, crank, o, Z)
    m.join("spherical", crank, rod, A)
    m.join("cylindrical", rod, slider, C, Z)
    m.join("translational", 0, slider, C - way, way, P_j=C)


def _four_bar(m, o, crank=None, A=None):
    """A crank with end A, or a given body, a coupler and a rocker, which is returned with its end."""
    if crank is None:
        A = _apart(m.random, o)
        crank = m.crank(o, m.random.uniform(-3, 3))
        m.join("revolute", 0, crank, o, Z)
    D = _apart(m.random, A)
    B = _far_from_line(m.random, A, D)
    coupler, rocker = m.body(A), m.body(D)
    m.join("spherical", crank, coupler, A)
    m.join("cylindrical", coupler, rocker, B, Z)
    m.join("revolute", 0, rocker, D, Z)
    return rocker, D


def _rssr(m, o, crank=None, A=None):
    if crank is None:
        A = _apart(m.random, o)
        crank = m.crank(o, m.random.uniform(-3, 3))
        m.join("revolute", 0, crank, o, Z)
    D = _apart(m.random, A, plane=False)
    B = _far_from_line(m.random, A, D, plane=False)
    axis = unit(np.cross(B - D, m.random.standard_normal(3)))
    coupler, rocker = m.body(A), m.body(D)
    m.join("spherical", crank, coupler, A)
    across = unit(np.cross(B - A, m.random.standard_normal(3)))
    m.join("universal", coupler, rocker, B, across, unit(np.cross(across, B - A)))
    m.join("revolute", 0, rocker, D, axis)


def _six_bar(m, o):
    """Watt: a second loop from the rocker; Stephenson: from the coupler."""
    rocker, _ = _four_bar(m, o)
    start = rocker if m.random.uniform() < 0.5 else 2
    _four_bar(m, o, start, _apart(m.random, m.bodies[start][0]))


def _inverted_slider_crank(m, o):
    A = _apart(m.random, o)
    D = _far_from_line(m.random, A, o)
    crank, block, lever = m.crank(o, m.random.uniform(-3, 3)), m.body(A), m.body(D)
    m.join("revolute", 0, crank, o, Z)
    m.join("spherical", crank, block, A)
    m.join("translational", block, lever, A, unit(D - A), P_j=D)
    m.join("cylindrical", 0, lever, D, Z)


def _double_wishbone(m, o):
    """Two arms about nearly longitudinal axes, an upright and a tie rod; the lower ball is driven up."""
    near = lambda x, y, z: o + np.array([x, y, z]) + 0.05 * m.random.uniform(-1, 1, 3)  # noqa: E731
    low, high, lower, upper = near(0, 0.3, 0), near(0, 0.4, 0.3), near(0, 0.75, 0), near(0, 0.7, 0.35)
    tie_in, tie_out = near(0.15, 0.35, 0.1), near(0.15, 0.7, 0.12)
    arms = [m.body(lower), m.body(upper)]
    upright, tie = m.body(near(0, 0.8, 0.15)), m.body(tie_in)
    for arm, P, ball in zip(arms, (low, high), (lower, upper), strict=True):
        axis = unit(X + 0.1 * m.random.uniform(-1, 1, 3))
        m.join("revolute", 0, arm, P, axis)
        m.join("spherical", arm, upright, ball)
    across = unit(np.cross(tie_out - tie_in, Z))
    m.join("universal", 0, tie, tie_in, across, unit(np.cross(across, tie_out - tie_in)))
    m.join("spherical", tie, upright, tie_out)
    m.drivers.append((arms[0], 3, m.bodies[arms[0]][0][2]))


def _scissor(m, o):
    """Two bars pinned where they cross, one pinned to the ground, one on a slider that is driven along x."""
    end = o + np.array([m.random.uniform(0.5, 1.0), m.random.uniform(0.2, 0.8), 0.0])
    foot = o + np.array([m.random.uniform(0.5, 1.0), 0.0, 0.0])
    middle = o + m.random.uniform(0.3, 0.7) * (end - o)
    first, second, slider = m.body(o), m.body(middle), m.body(foot)
    m.join("revolute", 0, first, o, Z)
    m.join("cylindrical", first, second, middle, Z)
    m.join("spherical", second, slider, foot)
    m.join("translational", 0, slider, o, X, P_j=foot)
    m.drivers.append((slider, 1, foot[0]))


def _parallel(m, o):
    """3-RRS: three legs of two links, a platform; the knees are driven in height."""
    corners = [np.array([np.cos(a), np.sin(a), 0.0]) for a in 2 * np.pi / 3 * np.arange(3)]
    platform = m.body(o + np.array([0.0, 0.0, 1.0]))
    for corner in corners:
        axis = unit(np.cross(Z, corner))
        base = o + m.random.uniform(0.6, 0.8) * corner
        top = o + m.random.uniform(0.4, 0.7) * corner + np.array([0, 0, m.random.uniform(0.8, 1.1)])
        knee = o + m.random.uniform(0.8, 1.2) * corner + np.array([0, 0, m.random.uniform(0.35, 0.6)])
        lower, upper = m.body(knee), m.body(knee)
        m.join("revolute", 0, lower, base, axis)
        m.join("revolute", lower, upper, knee, axis)
        m.join("spherical", upper, platform, top)
        m.drivers.append((lower, 3, knee[2]))


def _quick_return(m, o):
    """Whitworth: crank, block on a slotted lever, link and ram."""
    A = _apart(m.random, o, 0.2, 0.4)
    D = o + np.array([m.random.uniform(-0.1, 0.1), -m.random.uniform(0.6, 0.9), 0.0])
    top = D + m.random.uniform(1.2, 1.5) * unit(A - D)
    ram = top + np.array([m.random.uniform(0.3, 0.6), m.random.uniform(-0.25, 0.25), 0.0])
    crank, block, lever = m.crank(o, m.random.uniform(-3, 3)), m.body(A), m.body(D)
    link, slide = m.body(top), m.body(ram)
    m.join("revolute", 0, crank, o, Z)
    m.join("spherical", crank, block, A)
    m.join("translational", block, lever, A, unit(D - A), P_j=D)
    m.join("cylindrical", 0, lever, D, Z)
    m.join("spherical", lever, link, top)
    m.join("cylindrical", link, slide, ram, Z)
    m.join("translational", 0, slide, ram + np.array([1.0, 0, 0]), X, P_j=ram)


def _two_loops(m, o):
    """A four-bar that drives an RSSR."""
    rocker, D = _four_bar(m, o)
    _rssr(m, o, rocker, _apart(m.random, D))


class Judge:
    """Closes a linkage by scipy.optimize.least_squares, from estimates and from places about them.

    Unknowns are seven coordinates of every moving body, lengths divided by the size of the linkage.
    """

    def __init__(self, made: Linkage, estimates):
        self.made, self.estimates, self.size = made, estimates, made.size
        self.start = self.packed(estimates)

    def packed(self, poses):
        return np.concatenate([np.append(r / self.size, p) for r, p in poses[1:]])

    def poses(self, x):
        q = x.reshape(-1, 7)
        return [self.made.bodies[0], *((self.size * r[:3], unit(r[3:])) for r in q)]

    def distance(self, poses):
        """Translations over the size and rotation angles, added over the bodies."""
        pairs = zip(poses[1:], self.estimates[1:], strict=True)
        return sum(np.linalg.norm(r - r0) / self.size + turn_between(p, p0) for (r, p), (r0, p0) in pairs)

    def residual(self, x):
        return self._evaluate(x)[0]

    def jacobian(self, x):
        return self._evaluate(x)[1]

    def closed(self, poses):
        return bool(np.max(np.abs(self.residual(self.packed(poses)))) < 1e-7)

    def _evaluate(self, x):
        """Residual (m,) and its derivative (m, n): every vector of a body is r + A(p) v."""
        n = x.size
        q = np.vstack([np.append(np.zeros(3), [1.0, 0, 0, 0]), x.reshape(-1, 7)])
        rows, slopes = [], []

        def placed(body, v, is_point):
            """A vector or point (3,) in global axes and its derivative (3, n)."""
            p, D = q[body, 3:], np.zeros((3, n))
            value = matrix(p) @ v + is_point * q[body, :3]
            if body:
                at = 7 * (body - 1)
                e = np.eye(4)
                D[:, at : at + 3] = is_point * np.eye(3)
                # A is quadratic: half the difference of A(p + e) and A(p - e) is its derivative.
                D[:, at + 3 : at + 7] = np.stack([0.5 * (matrix(p + k) - matrix(p - k)) @ v for k in e], 1)
            return value, D

        def add(value, slope):
            rows.append(np.atleast_1d(value))
            slopes.append(np.atleast_2d(slope))

        def add_cross(a, Da, b, Db):
            add(np.cross(a, b), np.cross(Da.T, b).T + np.cross(a, Db.T).T)

        for kind, i, j, (P_i, P_j), v in self.made.joints:
            (a, Da), (b, Db) = placed(i, P_i / self.size, True), placed(j, P_j / self.size, True)
            vectors = [placed(body, w, False) for body, w in zip((i, j) * 2, v, strict=False)]
            if kind in ("spherical", "universal", "revolute"):
                add(b - a, Db - Da)
            if kind == "universal":
                (s, Ds), (u, Du) = vectors
                add(s @ u, s @ Du + u @ Ds)
            if kind in ("revolute", "cylindrical", "translational"):
                add_cross(*vectors[0], *vectors[1])
            if kind in ("cylindrical", "translational"):
                add_cross(*vectors[0], b - a, Db - Da)
            if kind == "translational":
                (s, Ds), (u, Du) = vectors[2:]
                add(s @ u, s @ Du + u @ Ds)
        for body, direction, value in self.made.drivers:
            if direction <= 3:
                row = np.zeros((1, n))
                row[0, 7 * (body - 1) + direction - 1] = 1.0
                add(q[body, direction - 1] - value / self.size, row)
            else:
                e = np.zeros(3)
                e[(direction - 3) % 3] = 1.0  # the axis after the one of the driver
                wanted = matrix(euler_parameters(np.eye(3)[direction - 4], value)) @ e
                turned, slope = placed(body, e, False)
                add(turned - wanted, slope)
        for body in range(1, len(q)):
            row = np.zeros((1, n))
            row[0, 7 * body - 4 : 7 * body] = 2 * q[body, 3:]
            add(q[body, 3:] @ q[body, 3:] - 1.0, row)
        return np.concatenate(rows), np.vstack(slopes)

    def search(self, start, method="trf"):
        """The position that one search finds, None if it does not close."""
        found = least_squares(
            self.residual,
            start,
            self.jacobian,
            method=method,
            xtol=1e-12,
            ftol=1e-14,
            gtol=1e-14,
            max_nfev=100,
        )
        poses = self.poses(found.x)
        return poses if self.closed(poses) else None

    def nearest(self, restarts=10):
        """The least distance of a position that closes, from the estimates and from places about them."""
        random = np.random.default_rng(0)
        starts = [self.start]
        for k in range(restarts):
            starts.append(self.start + 0.15 * (1 + k % 2) * random.standard_normal(self.start.size))
        found = [self.search(self.start, "lm"), *map(self.search, starts)]
        return min([self.distance(self.made.bodies), *(self.distance(x) for x in found if x is not None)])
