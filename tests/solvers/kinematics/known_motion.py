"""Random mechanisms built from a motion that is known before they are solved.

A body is hung on an earlier one by a joint and by as many held coordinates, drivers or distance
constraints as leave it six equations, chosen so that its motion follows from the earlier body's in
closed form.  Motions are series over the times of a fine grid: Euler parameters p (T, 4), r (T, 3).
"""

from dataclasses import dataclass, field

import numpy as np

from flexmb_cli.model.mechanism import Body, Distance, Driver, Ground, Joint, Mechanism, Simplified, TimeGrid
from tests.solvers.kinematics.geometry import axes, unit

FINE, EVERY, END = 1281, 64, 4.0
TIMES = np.linspace(0.0, END, FINE)
CLEAR = 0.9  # of the reach within which an angle is determined: beyond lies a dead centre


def products(p, r):
    """Euler parameters of A(p) A(r), for series (T, 4)."""
    p, r = np.broadcast_arrays(p, r)
    e0 = p[:, 0] * r[:, 0] - np.sum(p[:, 1:] * r[:, 1:], axis=1)
    e = p[:, :1] * r[:, 1:] + r[:, :1] * p[:, 1:] + np.cross(p[:, 1:], r[:, 1:])
    return np.column_stack([e0, e])


def turns(u, angle):
    """Euler parameters (T, 4) of turns about one unit vector."""
    return np.column_stack([np.cos(0.5 * angle), np.sin(0.5 * angle)[:, None] * u])


def angle_where(a, b, c, first):
    """The continuous x (T,) with a cos x + b sin x = c that is `first` at first; None near a dead centre."""
    reach = np.hypot(a, b)
    if np.any(np.abs(c) > CLEAR * reach) or np.any(reach < 0.1):
        return None
    base, side = np.unwrap(np.arctan2(b, a)), np.arccos(c / reach)
    x = min((base + side, base - side), key=lambda x: abs(np.sin(0.5 * (x[0] - first))))
    return x + 2.0 * np.pi * np.round((first - x[0]) / (2.0 * np.pi))


def tuples(*vectors):
    return [tuple(map(float, v)) for v in vectors]


@dataclass
class Motions:
    """The mechanism so far, and the motion of every body."""

    random: np.random.Generator
    p: list = field(default_factory=lambda: [np.tile([1.0, 0.0, 0.0, 0.0], (FINE, 1))])
    r: list = field(default_factory=lambda: [np.zeros((FINE, 3))])
    joints: list = field(default_factory=list)
    held: list = field(default_factory=list)
    distances: list = field(default_factory=list)
    drivers: list = field(default_factory=list)

    def vector(self):
        return unit(self.random.standard_normal(3)) * self.random.uniform(0.4, 1.5)

    def function(self, start, largest):
        """(C, B, A) and its values."""
        B, A = self.random.uniform(-1.0, 1.0, 2) * [largest, 0.3 * largest]
        return (float(start), float(B), float(A)), start + B * TIMES + 0.5 * A * TIMES**2

    def hold(self, direction, value):
        self.held.append(Simplified(f"simplified {len(self.held) + 1}", len(self.p), direction, float(value)))

    def drive(self, direction, function):
        self.drivers.append(Driver(f"driver {len(self.drivers) + 1}", len(self.p), direction, *function))

    def join(self, kind, parent, P_i, P_j, **vectors):
        """A joint between the parent and the next body, either of them as its body i."""
        P_i, P_j = tuples(P_i, P_j)
        pitch = vectors.pop("pitch", 0.0)
        v = dict(zip(vectors, tuples(*vectors.values()), strict=True))
        name = f"{kind} {sum(j.kind == kind for j in self.joints) + 1}"
        i, j = parent, len(self.p)
        if kind != "screw" and self.random.random() < 0.5:
            i, j, P_i, P_j = j, i, P_j, P_i
            v = {other(key): value for key, value in v.items()}
        self.joints.append(Joint(kind, name, i, j, P_i, P_j, **v, pitch=pitch))

    def add(self, p, r):
        self.p.append(p)
        self.r.append(r)
        return True

    def mechanism(self) -> Mechanism:
        bodies = tuple(
            Body(f"body {k + 1}", *tuples(r[0], p[0]))
            for k, (p, r) in enumerate(zip(self.p, self.r, strict=True))
        )
        return Mechanism(
            bodies,
            TimeGrid(0.0, END, END * EVERY / (FINE - 1)),
            tuple(self.joints),
            tuple(self.held),
            tuple(self.distances),
            tuple(self.drivers),
            (Ground("ground 1", 0, (0.0,) * 6),),
        )


def other(name):
    """The same vector of the other body."""
    return name[:-1] + ("j" if name[-1] == "i" else "i")


def crank(m: Motions, _parent):
    """Turned about a global axis through a fixed point."""
    k = int(m.random.integers(3))
    function, angle = m.function(m.random.uniform(-4.0, 4.0), 3.0)
    m.drive(4 + k, function)
    place = m.vector()
    for direction in range(3):
        m.hold(1 + direction, place[direction])
        if direction != k:
            m.hold(4 + direction, 0.0)
    return m.add(turns(np.eye(3)[k], angle), np.tile(place, (FINE, 1)))


def carried_upright(m: Motions, parent):
    """A ball at the parent, all three angles held."""
    p = unit([1.0, *m.random.uniform(-0.8, 0.8, 3)])
    P_i, P_j = m.vector(), m.vector()
    m.join("spherical", parent, P_i, P_j)
    for k in range(3):
        m.hold(4 + k, 2.0 * np.arcsin(p[1 + k]))
    p = np.tile(p, (FINE, 1))
    return m.add(p, m.r[parent] + axes(m.p[parent]) @ P_i - axes(p) @ P_j)


def carried_and_turned(m: Motions, parent):
    """A ball at the parent, turned about a global axis."""
    k = int(m.random.integers(3))
    function, angle = m.function(m.random.uniform(-4.0, 4.0), 3.0)
    P_i, P_j = m.vector(), m.vector()
    m.join("spherical", parent, P_i, P_j)
    m.drive(4 + k, function)
    for direction in {0, 1, 2} - {k}:
        m.hold(4 + direction, 0.0)
    p = turns(np.eye(3)[k], angle)
    return m.add(p, m.r[parent] + axes(m.p[parent]) @ P_i - axes(p) @ P_j)


def crossed(m: Motions, parent):
    """A universal joint whose body may only turn about a global axis: s_i · A(θ) s_j = 0 settles θ."""
    k = int(m.random.integers(3))
    axis, s_i, s_j = np.eye(3)[k], m.vector(), m.vector()
    arm = axes(m.p[parent]) @ s_i
    along = (s_j @ axis) * axis
    angle = angle_where(
        arm @ (s_j - along), arm @ np.cross(axis, s_j), -arm @ along, m.random.uniform(-3.0, 3.0)
    )
    if angle is None:
        return False
    P_i, P_j = m.vector(), m.vector()
    m.join("universal", parent, P_i, P_j, s_i=s_i, s_j=s_j)
    for direction in {0, 1, 2} - {k}:
        m.hold(4 + direction, 0.0)
    p = turns(axis, angle)
    return m.add(p, m.r[parent] + axes(m.p[parent]) @ P_i - axes(p) @ P_j)


def hinge_angle(m: Motions, parent, s, relative):
    """Turn about s that holds one Euler parameter of the next body: (direction, value, p), or None."""
    k = int(m.random.integers(3))
    first = m.random.uniform(-2.0, 2.0)
    a = products(m.p[parent], relative[None])[:, 1 + k]
    b = products(products(m.p[parent], np.array([[0.0, *s]])), relative[None])[:, 1 + k]
    value = a[0] * np.cos(first) + b[0] * np.sin(first)
    half = angle_where(a, b, value, first)
    if half is None or abs(value) > 0.98:
        return None
    return (
        4 + k,
        2.0 * np.arcsin(value),
        products(products(m.p[parent], turns(s, 2.0 * half)), relative[None]),
    )


def hinged(m: Motions, parent):
    """A revolute joint, its turn settled by one held Euler parameter."""
    s, relative = unit(m.vector()), unit(m.random.standard_normal(4))
    found = hinge_angle(m, parent, s, relative)
    if found is None:
        return False
    direction, value, p = found
    P_i, P_j = m.vector(), m.vector()
    m.join("revolute", parent, P_i, P_j, s_i=2.0 * s, s_j=-0.7 * axes(relative).T @ s)
    m.hold(direction, value)
    return m.add(p, m.r[parent] + axes(m.p[parent]) @ P_i - axes(p) @ P_j)


def slid(m: Motions, parent, p, s, P_i, P_j):
    """Slide δ along s and position r of a body of attitude p whose coordinate is driven; None: no slide."""
    A = axes(m.p[parent])
    r = m.r[parent] + A @ P_i - axes(p) @ P_j
    k = int(np.argmax(np.min(np.abs(A @ s), axis=0)))
    if np.min(np.abs((A @ s)[:, k])) < 0.3:
        return None
    slide = m.random.uniform(-1.0, 1.0)
    function, values = m.function(r[0, k] + slide * (A @ s)[0, k], 0.7)
    delta = (values - r[:, k]) / (A @ s)[:, k]
    return 1 + k, function, delta, r + delta[:, None] * (A @ s)


def pushed(m: Motions, parent):
    """A translational joint with a driven coordinate."""
    s, relative = unit(m.vector()), unit(m.random.standard_normal(4))
    p = products(m.p[parent], relative[None])
    h_i, P_i, P_j = m.vector(), m.vector(), m.vector()
    h_j = np.cross(h_i, s) + m.random.uniform(-0.3, 0.3) * np.cross(h_i, np.cross(h_i, s))
    found = slid(m, parent, p, s, P_i, P_j)
    if found is None or np.linalg.norm(np.cross(s, unit(h_i))) < 0.4:
        return False
    direction, function, _, r = found
    back = axes(relative).T
    m.join("translational", parent, P_i, P_j, s_i=1.3 * s, s_j=-back @ s, h_i=h_i, h_j=back @ h_j)
    m.drive(direction, function)
    return m.add(p, r)


def slid_and_hinged(m: Motions, parent):
    """A cylindrical joint with a driven coordinate and a held Euler parameter."""
    s, relative = unit(m.vector()), unit(m.random.standard_normal(4))
    found = hinge_angle(m, parent, s, relative)
    if found is None:
        return False
    held, value, p = found
    P_i, P_j = m.vector(), m.vector()
    found = slid(m, parent, p, s, P_i, P_j)
    if found is None:
        return False
    direction, function, _, r = found
    m.join("cylindrical", parent, P_i, P_j, s_i=s, s_j=1.7 * axes(relative).T @ s)
    m.drive(direction, function)
    m.hold(held, value)
    return m.add(p, r)


def screwed(m: Motions, parent):
    """A screw with a driven coordinate; its P_j lies on the axis, so that the turn does not move it."""
    s, relative = unit(m.vector()), unit(m.random.standard_normal(4))
    P_i, h_i, h_j = m.vector(), m.vector(), m.vector()
    P_j = 0.4 * axes(relative).T @ s
    across = [np.linalg.norm(np.cross(s, unit(h))) for h in (h_i, h_j)]
    found = slid(m, parent, products(m.p[parent], relative[None]), s, P_i, P_j)
    if found is None or min(across) < 0.3 or abs(found[2][0]) < 0.05:
        return False
    direction, function, slide, r = found
    pitch = m.random.choice([-1.0, 1.0]) * m.random.uniform(0.1, 1.0)
    turn = np.sign(slide[0]) * (slide - slide[0]) / pitch
    back = axes(relative).T
    m.join("screw", parent, P_i, P_j, s_i=s, s_j=back @ s, h_i=h_i, h_j=back @ h_j, pitch=float(pitch))
    m.drive(direction, function)
    return m.add(products(products(m.p[parent], turns(s, turn)), relative[None]), r)


def following(m: Motions, parent):
    """All six coordinates at given distances from the parent's, e1, e2 and e3 among them."""
    shift, change = m.vector(), m.random.uniform(-0.2, 0.2, 3)
    e = m.p[parent][:, 1:] + change
    rest = 1.0 - np.sum(e * e, axis=1)
    if np.min(rest) < 0.1:
        return False
    for k in range(3):
        for direction, value in ((1 + k, shift[k]), (4 + k, change[k])):
            name = f"distance {len(m.distances) + 1}"
            m.distances.append(Distance(name, len(m.p), parent, direction, float(value)))
    return m.add(np.column_stack([np.sqrt(rest), e]), m.r[parent] + shift)


WAYS = (
    carried_upright,
    carried_and_turned,
    crossed,
    hinged,
    pushed,
    slid_and_hinged,
    screwed,
    following,
    crank,
)


def random_motions(seed: int, bodies: int) -> Motions:
    """A mechanism with `bodies` moving bodies; the first is a crank, the second hangs in way `seed`."""
    m = Motions(np.random.default_rng([seed, 1996]))
    crank(m, 0)
    ways = [WAYS[seed % len(WAYS)]]
    while len(m.p) <= bodies:
        way = ways.pop() if ways else WAYS[m.random.integers(len(WAYS))]
        for _ in range(30):
            if way(m, int(m.random.integers(1, len(m.p)))):
                break
    return m
