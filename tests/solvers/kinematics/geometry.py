"""What the joints of a YOUNG deck demand, written down once more as plain geometry.

Liang Yong, YOUNG dissertation (1996), chapter 4, by vectors in global axes and without a choice of
two components of three.  Slow and obvious, independent of the kernels.  Every gap is analytic in the
coordinates and in time, so that complex steps give exact rates.
"""

import numpy as np

from flexmb_cli.model.mechanism import Joint, Mechanism


def axes(p):
    """Rotation matrix (…, 3, 3) of Euler parameters (…, 4): A = (2 e0² - 1) I + 2 e eᵀ + 2 e0 ẽ (3.16)."""
    e0, e1, e2, e3 = np.moveaxis(np.asarray(p), -1, 0)
    return np.stack(
        [
            np.stack([2 * (e0**2 + e1**2) - 1, 2 * (e1 * e2 - e0 * e3), 2 * (e1 * e3 + e0 * e2)], -1),
            np.stack([2 * (e1 * e2 + e0 * e3), 2 * (e0**2 + e2**2) - 1, 2 * (e2 * e3 - e0 * e1)], -1),
            np.stack([2 * (e1 * e3 - e0 * e2), 2 * (e2 * e3 + e0 * e1), 2 * (e0**2 + e3**2) - 1], -1),
        ],
        -2,
    )


def euler_parameters(u, angle):
    """(cos angle/2, u sin angle/2) of a turn about the unit vector u."""
    return np.array([np.cos(0.5 * angle), *(np.sin(0.5 * angle) * np.asarray(u))])


def product(p, r):
    """Euler parameters of A(p) A(r)."""
    return np.array([p[0] * r[0] - p[1:] @ r[1:], *(p[0] * r[1:] + r[0] * p[1:] + np.cross(p[1:], r[1:]))])


def unit(v):
    return np.asarray(v, dtype=float) / np.linalg.norm(v)


def cross(a, b):
    """numpy's cross, also for complex vectors."""
    a0, a1, a2 = np.moveaxis(a, -1, 0)
    b0, b1, b2 = np.moveaxis(b, -1, 0)
    return np.stack([a1 * b2 - a2 * b1, a2 * b0 - a0 * b2, a0 * b1 - a1 * b0], -1)


def dot(a, b):
    return np.sum(a * b, axis=-1)


class Gaps:
    """Gaps of all constraints of a mechanism, as functions of coordinates q (T, bodies, 7) and times (T,).

    Lengths are divided by the largest length of the mechanism, joint vectors by their own.
    """

    def __init__(self, mechanism: Mechanism):
        self.mechanism = mechanism
        points = [joint.P_i for joint in mechanism.joints] + [joint.P_j for joint in mechanism.joints]
        self.length = max([abs(x) for body in mechanism.bodies for x in body.r] + [0.0])
        self.length = max([self.length] + [abs(x) for P in points for x in P]) or 1.0
        self.screws = {j.name: self._thread(j) for j in mechanism.joints if j.kind == "screw"}

    def all(self, q, t) -> dict[str, np.ndarray]:
        """Gaps (T, n) by name."""
        gaps = {joint.name: self._joint(joint, q) for joint in self.mechanism.joints}
        for item in self.mechanism.simplified:
            gaps[item.name] = self._held(q[:, item.body], item.direction, item.value)[:, None]
        for item in self.mechanism.distances:
            k = item.direction - 1 + (item.direction > 3)
            scale = self.length if k < 3 else 1.0
            gaps[item.name] = ((q[:, item.i, k] - q[:, item.j, k] - item.value) / scale)[:, None]
        for driver in self.mechanism.drivers:
            gaps[driver.name] = self._driven(q[:, driver.body], driver, t)
        for ground in self.mechanism.grounds:
            held = [self._held(q[:, ground.body], k, v) for k, v in enumerate(ground.values, start=1)]
            gaps[ground.name] = np.stack(held, -1)
        gaps["|p| = 1"] = dot(q[:, :, 3:], q[:, :, 3:]) - 1.0
        return gaps

    def largest(self, q, t) -> float:
        return max(float(np.max(np.abs(gap))) for gap in self.all(q, t).values())

    def largest_rate(self, q, qd, t) -> float:
        """The largest time derivative of a gap, by a complex step."""
        step = 1e-30
        gaps = self.all(q + 1j * step * qd, t + 1j * step)
        return max(float(np.max(np.abs(gap.imag))) / step for gap in gaps.values())

    def _held(self, q, direction, value):
        if direction <= 3:
            return (q[:, direction - 1] - value) / self.length
        return q[:, direction] - np.sin(0.5 * value)

    def _driven(self, q, driver, t):
        function = driver.C + driver.B * t + 0.5 * driver.A * t * t
        if driver.direction <= 3:
            return ((q[:, driver.direction - 1] - function) / self.length)[:, None]
        wanted = [np.cos(0.5 * function)] + [0.0 * function] * 3
        wanted[driver.direction - 3] = np.sin(0.5 * function)
        return q[:, 3:] - np.stack(wanted, -1)

    def _joint(self, joint: Joint, q):
        at_i, at_j = (_Side(q[:, body]) for body in (joint.i, joint.j))
        d = (at_j.point(joint.P_j) - at_i.point(joint.P_i)) / self.length
        if joint.kind == "spherical":
            return d
        s_i, s_j = at_i.vector(unit(joint.s_i)), at_j.vector(unit(joint.s_j))
        if joint.kind == "universal":
            return np.concatenate([d, dot(s_i, s_j)[:, None]], 1)
        if joint.kind == "revolute":
            return np.concatenate([d, cross(s_i, s_j)], 1)
        gaps = [cross(s_i, s_j), cross(s_i, d)]
        if joint.kind == "translational":
            gaps.append(dot(at_i.vector(unit(joint.h_i)), at_j.vector(unit(joint.h_j)))[:, None])
        if joint.kind == "screw":
            gaps.append(self._slip(joint, at_i, at_j, dot(s_i, d) * self.length)[:, None])
        return np.concatenate(gaps, 1)

    def _thread(self, joint):
        """Sense of the slide, slide δ0 and turn θ0 of the deck's own estimates."""
        at_i, at_j = (
            _Side(np.array([[*body.r, *unit(body.p)]]))
            for body in (self.mechanism.bodies[joint.i], self.mechanism.bodies[joint.j])
        )
        d = at_j.point(joint.P_j) - at_i.point(joint.P_i)
        slide = float(dot(at_i.vector(unit(joint.s_i)), d)[0])
        x, y = self._clock(joint, at_i, at_j)
        return np.sign(slide) or 1.0, abs(slide), float(np.arctan2(y, x)[0])

    @staticmethod
    def _clock(joint, at_i, at_j):
        """Components of h_j along h_i and across it, both normal to the axis."""
        u = unit(joint.s_i)
        f = unit(np.asarray(joint.h_i) - (np.asarray(joint.h_i) @ u) * u)
        h_j = at_j.vector(unit(joint.h_j))
        return dot(at_i.vector(f), h_j), dot(at_i.vector(np.cross(u, f)), h_j)

    def _slip(self, joint, at_i, at_j, slide):
        """Where h_j points less where the slide says it should, across; zero pitch: the slide itself."""
        sense, slide0, angle0 = self.screws[joint.name]
        if joint.pitch == 0.0:
            return (sense * slide - slide0) / self.length
        turn = angle0 + (sense * slide - slide0) / joint.pitch
        x, y = self._clock(joint, at_i, at_j)
        return y * np.cos(turn) - x * np.sin(turn)


class _Side:
    """Points and vectors of one body, from q (T, 7) to global axes."""

    def __init__(self, q):
        self.r, self.A = q[:, :3], axes(q[:, 3:])

    def vector(self, s):
        return self.A @ np.asarray(s)

    def point(self, s):
        return self.r + self.vector(s)
