"""Judges a result by its deck and rows alone: nothing of flexmb computes here, only numpy.

What a body does at a point is put together from its origin, Euler parameters, angular velocity and
acceleration; joints, drivers and grounds are those of the deck's own numbers where it can be read plainly
(young_text.py), else those that the result keeps.
"""

import math

import h5py
import numpy as np

ROUND_OFF = 1e-7  # of the size of what is compared: the solver's own limit is 1e-10 or less
ENERGY = 2e-3  # of the largest energy: flexmb warns of a thousandth


class Verdict(Exception):
    """A result that contradicts its deck or itself."""


class Result:
    """The rows of an HDF5 file."""

    def __init__(self, path):
        with h5py.File(path) as file:
            self.attributes = dict(file.attrs)
            self.data, self.names = {}, {}
            file.visititems(self._take)

    def _take(self, name, item):
        if isinstance(item, h5py.Dataset) and item.dtype.kind in "fi":
            self.data[name] = item[()]
        elif isinstance(item, h5py.Dataset) and name.endswith("/name"):
            self.names[name] = list(item.asstr()[()])

    def __getitem__(self, name):
        return self.data[name]

    def __contains__(self, name):
        return name in self.data

    @property
    def complete(self) -> bool:
        """Whether the run came to its end."""
        return self.attributes["status"] == "complete"


def judge(path, text, warned: bool) -> str:
    """What is wrong with the result at `path`, "" for nothing; `text`: a YoungText, or None.

    `warned`: the run itself warned of its energy.
    """
    result = Result(path)
    try:
        _finite(result)
        # Rows of a run that failed are marked; what made it fail may begin in the last of them.
        if result.complete and len(result["time"]):
            with np.errstate(all="ignore"):
                _attitudes(result)
                if text is not None:
                    _time(result, text.time)
                    _young(result, text)
                    _forces(result, text)
                _kept_joints(result)
                _energies(result, warned)
                _tree_closures(result)
    except Verdict as wrong:
        return str(wrong)
    return ""


def _finite(result):
    for name, values in result.data.items():
        if values.dtype.kind == "f" and not np.isfinite(values).all():
            raise Verdict(f"{name} is not finite")
    if (np.diff(result["time"]) <= 0).any():
        raise Verdict("times do not ascend")


def _small(what, gap, size):
    """Refuse a gap beyond round-off of `size`, both along time first."""
    gap = np.abs(np.asarray(gap, float)).reshape(len(gap), -1).max(axis=1, initial=0.0)
    size = np.abs(np.asarray(size, float)).reshape(len(gap), -1).max(axis=1, initial=0.0)
    bad = gap > ROUND_OFF * (1.0 + size)
    if bad.any():
        k = int(np.argmax(bad))
        raise Verdict(f"{what}: {gap[k]:.3g} at row {k}, size {size[k]:.3g}")


def _time(result, time):
    start, end, step = time
    rows = math.floor((end - start) / step + 1e-6) + 1
    found = result["time"]
    if result.complete and len(found) != rows:
        raise Verdict(f"{len(found)} rows, the deck has {rows}")
    _small("times", found - (start + step * np.arange(len(found))), found)


def _attitudes(result):
    """Euler parameters are of length one, and their rates those of the angular velocity."""
    if "body/euler_parameters" not in result:
        return
    p, pd = result["body/euler_parameters"], result["body/euler_parameter_rates"]
    pdd, omega = result["body/euler_parameter_accelerations"], result["body/angular_velocity"]
    alpha = result["body/angular_acceleration"]
    _small("length of the Euler parameters", (p * p).sum(-1) - 1, p[..., 0] * 0)
    _small("rate of the Euler parameters' length", (p * pd).sum(-1), omega)
    _small("second rate of that length", (p * pdd + pd * pd).sum(-1), np.concatenate([alpha, omega**2], -1))
    e0, e, e0d, ed = p[..., :1], p[..., 1:], pd[..., :1], pd[..., 1:]
    spin = 2 * (e0 * ed - e * e0d + np.cross(e, ed))
    _small("angular velocity against the rates", spin - omega, omega)
    e0dd, edd = pdd[..., :1], pdd[..., 1:]
    spin = 2 * (e0 * edd - e * e0dd + np.cross(e, edd))
    _small("angular acceleration against the rates", spin - alpha, np.concatenate([alpha, omega**2], -1))


class Bodies:
    """Vectors and points of the bodies over time; body 0 is the ground."""

    def __init__(self, result):
        self.r, self.v, self.a = (result[f"body/{name}"] for name in ("position", "velocity", "acceleration"))
        self.p = result["body/euler_parameters"]
        self.omega, self.alpha = result["body/angular_velocity"], result["body/angular_acceleration"]

    def vector(self, body, s):
        """A vector of the body and its two derivatives, (time, 3) each."""
        if body == 0:
            fixed = np.broadcast_to(np.asarray(s, float), self.r[:, 0].shape)
            return fixed, 0 * fixed, 0 * fixed
        k = body - 1
        e0, e = self.p[:, k, :1], self.p[:, k, 1:]
        u = s + 2 * np.cross(e, np.cross(e, s) + e0 * s)
        ud = np.cross(self.omega[:, k], u)
        return u, ud, np.cross(self.alpha[:, k], u) + np.cross(self.omega[:, k], ud)

    def spin(self, body):
        """The angular velocity of a body, (time, 3)."""
        return self.omega[:, body - 1] if body else 0 * self.r[:, 0]

    def point(self, body, s):
        """A point of the body, its velocity and acceleration."""
        found = self.vector(body, s)
        if body == 0:
            return found
        origin = self.r[:, body - 1], self.v[:, body - 1], self.a[:, body - 1]
        return tuple(one + other for one, other in zip(origin, found, strict=True))


def _products(one, other, product):
    """The product of two vectors over time and its two derivatives."""
    (u, ud, udd), (w, wd, wdd) = one, other
    return (
        product(u, w),
        product(ud, w) + product(u, wd),
        product(udd, w) + 2 * product(ud, wd) + product(u, wdd),
    )


def _dot(u, w):
    return (u * w).sum(-1, keepdims=True)


def _sizes(*vectors):
    """What the three derivatives of products of these are made of."""
    lengths = [[np.linalg.norm(x, axis=-1) for x in vector] for vector in vectors]
    u, ud, udd = (np.max([length[k] for length in lengths], axis=0) for k in range(3))
    largest = np.maximum(u, 1.0)
    return largest**2, largest * (u + ud), largest * (u + ud + udd) + ud**2


ORDERS = ("", "rate of ", "second rate of ")


def _all_small(what, found, sizes):
    for order, gap, size in zip(ORDERS, found, sizes, strict=True):
        _small(order + what, gap, size)


def _young(result, text):
    bodies = Bodies(result)
    for number, (kind, numbers) in enumerate(text.joints, 1):
        _joint(bodies, f"joint {number} ({kind})", kind, numbers)
    _drivers(bodies, text, result["time"])
    for body, *held in text.sections["ground"]:
        _at_rest(bodies, int(body) - 1, held)
    for body, direction, value in text.sections["simplified"]:
        found = _coordinate(bodies, int(body) - 1, int(direction))
        wanted = value if direction <= 3 else math.sin(value / 2)
        _small("simplified constraint", found - wanted, found)
    for i, j, direction, value in text.sections["distance"]:
        one, other = (_coordinate(bodies, int(body) - 1, int(direction)) for body in (i, j))
        _small("distance constraint", one - other - value, np.abs(one) + np.abs(other))
    for k, (body, *s) in enumerate(text.sections["point"]):
        for name, values in zip(
            ("position", "velocity", "acceleration"), bodies.point(int(body), np.array(s)), strict=True
        ):
            _small(f"point {k + 1}, {name}", result[f"point/{name}"][:, k] - values, values)


def _joint(bodies, name, kind, numbers):
    i, j = int(numbers[0]), int(numbers[1])
    P_i, P_j, *others = (np.array(numbers[2 + 3 * k : 5 + 3 * k]) for k in range((len(numbers) - 2) // 3))
    one, other = bodies.point(i, P_i), bodies.point(j, P_j)
    apart = tuple(b - a for a, b in zip(one, other, strict=True))
    arms = [bodies.vector(i, P_i), bodies.vector(j, P_j)]
    size = _sizes(one, other, *arms)
    if kind in ("spherical", "universal", "revolute"):
        _all_small(f"gap of {name}", apart, size)
    if kind == "spherical":
        return
    s_i, s_j = (_unit(others[0] - P_i), _unit(others[1] - P_j))
    u, w = bodies.vector(i, s_i), bodies.vector(j, s_j)
    turning = _sizes(u, w)
    if kind == "universal":
        _all_small(f"angle of {name}", _products(u, w, _dot), turning)
        return
    _all_small(f"axes of {name}", _products(u, w, np.cross), turning)
    if kind in ("cylindrical", "translational", "screw"):
        _all_small(f"line of {name}", _products(u, apart, np.cross), _sizes(u, apart, *arms, one, other))
    if kind == "screw":
        slide = _products(u, apart, _dot)[1][:, 0]
        turn = numbers[-1] * (u[0] * (bodies.spin(j) - bodies.spin(i))).sum(-1)
        _small(f"advance of {name}", np.abs(slide) - np.abs(turn), _sizes(u, apart)[1] + np.abs(turn))
    if kind == "translational":
        h, g = (bodies.vector(b, _unit(o - P)) for b, o, P in ((i, others[2], P_i), (j, others[3], P_j)))
        _all_small(f"turn of {name}", _products(h, g, _dot), turning)


def _unit(vector):
    return vector / np.linalg.norm(vector)


def _coordinate(bodies, body, direction):
    return bodies.r[:, body, direction - 1] if direction <= 3 else bodies.p[:, body, direction - 3]


def _drivers(bodies, text, t):
    for number, (body, direction, C, B, A) in enumerate(text.sections["driver"], 1):
        k, direction = int(body) - 1, int(direction)
        f, rate, second = C + B * t + A * t * t / 2, B + A * t, A + 0 * t
        name = f"driver {number}"
        if direction <= 3:
            _small(name, bodies.r[:, k, direction - 1] - f, f)
            _small(f"rate of {name}", bodies.v[:, k, direction - 1] - rate, np.abs(f) + np.abs(rate))
            _small(f"second rate of {name}", bodies.a[:, k, direction - 1] - second, np.abs(f) + second**2)
            continue
        # Angles beyond 1e6 rad have few digits left behind the point.
        p = bodies.p[:, k]
        _small(name, p[:, direction - 3] - np.sin(f / 2), 1e-8 * f)
        _small(name, p[:, 0] - np.cos(f / 2), 1e-8 * f)
        _small(f"rate of {name}", bodies.omega[:, k, direction - 4] - rate, rate)
        _small(f"second rate of {name}", bodies.alpha[:, k, direction - 4] - second, rate**2 + np.abs(second))


def _at_rest(bodies, k, held):
    r, angles = np.array(held[:3]), np.array(held[3:])
    _small("place of a ground", bodies.r[:, k] - r, bodies.r[:, k])
    _small("attitude of a ground", bodies.p[:, k, 1:] - np.sin(angles / 2), bodies.p[:, k])
    _small("motion of a ground", bodies.v[:, k], 0 * bodies.v[:, k])
    _small("turning of a ground", bodies.omega[:, k], 0 * bodies.omega[:, k])


FORCELESS = {"MASS", "GRAVITY", "VELOCITY", "TOLERANCE", "GALF"}


def _forces(result, text):
    """Newton's and Euler's equations of every body, about its origin, with all that acts on it."""
    if "reaction/force" not in result or {word for word, _ in text.cards} - FORCELESS:
        return
    bodies = Bodies(result)
    gravity = np.sum([numbers for word, numbers in text.cards if word == "GRAVITY"] or [np.zeros(3)], axis=0)
    forces, moments = np.zeros((2, *bodies.a.shape))
    sizes = np.zeros_like(bodies.a)
    for body, force, place, torque in (*_acting(result, text, bodies), *_inertial(text, bodies, gravity)):
        if body:
            moment = np.cross(place - bodies.r[:, body - 1], force) + torque
            forces[:, body - 1] += force
            moments[:, body - 1] += moment
            sizes[:, body - 1] += np.linalg.norm(force, axis=-1, keepdims=True)
            sizes[:, body - 1] += np.linalg.norm(moment, axis=-1, keepdims=True)
    _small("balance of forces", forces, sizes)
    _small("balance of moments", moments, sizes)


def _acting(result, text, bodies):
    """(body, force, where it acts, torque) of joints, holders and drivers, along time."""
    for k, (_, numbers) in enumerate(text.joints):
        force, torque = result["reaction/force"][:, k], result["reaction/torque"][:, k]
        place = bodies.point(int(numbers[1]), np.array(numbers[5:8]))[0]
        yield int(numbers[1]), force, place, torque
        yield int(numbers[0]), -force, place, -torque
    for k, name in enumerate(result.names.get("held/name", ())):
        kind, *_, number = name.split()  # "ground 1", "simplified constraint 1"
        if kind in text.sections:
            body = int(text.sections[kind][int(number) - 1][0])
            yield body, result["held/force"][:, k], bodies.r[:, body - 1], result["held/torque"][:, k]
    for k, (body, direction, *_) in enumerate(text.sections["driver"]):
        effort = np.zeros((2, len(result["time"]), 3))
        effort[int(direction > 3), :, int(direction - 1) % 3] = result["driver/effort"][:, k]
        yield int(body), effort[0], bodies.r[:, int(body) - 1], effort[1]


def _inertial(text, bodies, gravity):
    """The same of what masses ask for, with the opposite sign."""
    for word, numbers in text.cards:
        if word != "MASS":
            continue
        body, mass = int(numbers[0]), numbers[1]
        xx, yy, zz, xy, yz, zx = (*numbers[5:], 0.0, 0.0, 0.0)[:6]
        axes = [bodies.vector(body, unit)[0] for unit in np.eye(3)]
        turning = np.stack(axes, -1)  # (time, 3, 3): body axes to global ones
        inertia = turning @ np.array([[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]]) @ turning.transpose(0, 2, 1)
        omega, alpha = bodies.omega[:, body - 1], bodies.alpha[:, body - 1]
        spin = np.einsum("tij,tj->ti", inertia, omega)
        place, _, acceleration = bodies.point(body, np.array(numbers[2:5]))
        moment = np.einsum("tij,tj->ti", inertia, alpha) + np.cross(omega, spin)
        yield body, -mass * (acceleration - gravity), place, -moment


def _kept_joints(result):
    """A complete result does not state itself that its joints are open."""
    if "audit/constraint_residual" not in result:
        return
    largest = result["audit/constraint_residual"]
    if largest.max() > 1e-3:
        raise Verdict(f"the result states a residual of {largest.max():.3g}")


def _tree_closures(result):
    """Closures of trees of rigid bodies stay closed."""
    if "coordinate/q" not in result or "joint/point" not in result or "elastic" in " ".join(result.data):
        return
    bodies = Bodies(result)
    for k, ((a, b), (s, w)) in enumerate(zip(result["joint/body"], result["joint/point"], strict=True), 1):
        one, other = bodies.point(int(a), s), bodies.point(int(b), w)
        gap, stated = other[0] - one[0], result["audit/constraint_residual"]
        if (np.abs(gap).max(axis=1) > stated + ROUND_OFF * (1 + np.abs(one[0]).max())).any():
            raise Verdict(f"closure {k} is open by {np.abs(gap).max():.3g}, beyond what is stated")


def _energies(result, warned):
    """The parts make the total, which stays, unless the run warned."""
    if "energy/total" not in result:
        return
    parts = {name: result[f"energy/{name}"] for name in ("kinetic", "potential", "applied_work")}
    strain = result.data.get("energy/strain", 0.0)
    total = result["energy/total"]
    made = parts["kinetic"] + parts["potential"] + strain - parts["applied_work"]
    size = sum(np.abs(values) for values in parts.values()) + np.abs(strain)
    _small("sum of the energies", made - total, size)
    if (parts["kinetic"] < -ROUND_OFF * size).any():
        raise Verdict("the kinetic energy is negative")
    scale = (
        max(np.abs(values - values[0]).max() for values in parts.values()) + np.abs(parts["kinetic"]).max()
    )
    drift = np.abs(total - total[0]).max()
    if not warned and result.complete and drift > ENERGY * scale + 1e-9 * size.max():
        raise Verdict(f"the total energy strays by {drift:.3g} of {scale:.3g} without a warning")
