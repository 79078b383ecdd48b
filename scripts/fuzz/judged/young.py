"""Judges the rows of a YOUNG deck by the deck's own numbers: joints, drivers, grounds, balances of forces."""

import math

import numpy as np

from .rows import Bodies, Verdict, small

AXIS = 1e-4  # drivers' axes are met to a thousandth of a radian: decks round theirs


def judge_young(result, text):
    """Raise Verdict where the rows contradict the deck."""
    _time(result, text.time)
    _young(result, text)
    _forces(result, text)


def _time(result, time):
    start, end, step = time
    rows = math.floor((end - start) / step + 1e-6) + 1
    found = result["time"]
    if result.complete and len(found) != rows:
        raise Verdict(f"{len(found)} rows, the deck has {rows}")
    small("times", found - (start + step * np.arange(len(found))), found)


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


def _allsmall(what, found, sizes):
    for order, gap, size in zip(ORDERS, found, sizes, strict=True):
        small(order + what, gap, size)


def _young(result, text):
    bodies = Bodies(result)
    for number, (kind, numbers) in enumerate(text.joints, 1):
        _joint(bodies, f"joint {number} ({kind})", kind, numbers)
    _joint_coordinates(result, bodies, text)
    _drivers(bodies, text, result["time"])
    for body, *held in text.sections["ground"]:
        _at_rest(bodies, int(body) - 1, held)
    for body, direction, value in text.sections["simplified"]:
        found = _coordinate(bodies, int(body) - 1, int(direction))
        wanted = value if direction <= 3 else math.sin(value / 2)
        small("simplified constraint", found - wanted, found)
    for i, j, direction, value in text.sections["distance"]:
        one, other = (_coordinate(bodies, int(body) - 1, int(direction)) for body in (i, j))
        small("distance constraint", one - other - value, np.abs(one) + np.abs(other))
    for k, (body, *s) in enumerate(text.sections["point"]):
        for name, values in zip(
            ("position", "velocity", "acceleration"), bodies.point(int(body), np.array(s)), strict=True
        ):
            small(f"point {k + 1}, {name}", result[f"point/{name}"][:, k] - values, values)


def _joint(bodies, name, kind, numbers):
    i, j = int(numbers[0]), int(numbers[1])
    P_i, P_j, *others = (np.array(numbers[2 + 3 * k : 5 + 3 * k]) for k in range((len(numbers) - 2) // 3))
    one, other = bodies.point(i, P_i), bodies.point(j, P_j)
    apart = tuple(b - a for a, b in zip(one, other, strict=True))
    arms = [bodies.vector(i, P_i), bodies.vector(j, P_j)]
    size = _sizes(one, other, *arms)
    if kind in ("spherical", "universal", "revolute"):
        _allsmall(f"gap of {name}", apart, size)
    if kind == "spherical":
        return
    s_i, s_j = (_unit(others[0] - P_i), _unit(others[1] - P_j))
    u, w = bodies.vector(i, s_i), bodies.vector(j, s_j)
    turning = _sizes(u, w)
    if kind == "universal":
        _allsmall(f"angle of {name}", _products(u, w, _dot), turning)
        return
    _allsmall(f"axes of {name}", _products(u, w, np.cross), turning)
    if kind in ("cylindrical", "translational", "screw"):
        _allsmall(f"line of {name}", _products(u, apart, np.cross), _sizes(u, apart, *arms, one, other))
    if kind == "screw":
        slide = _products(u, apart, _dot)[1][:, 0]
        turn = numbers[-1] * (u[0] * (bodies.spin(j) - bodies.spin(i))).sum(-1)
        small(f"advance of {name}", np.abs(slide) - np.abs(turn), _sizes(u, apart)[1] + np.abs(turn))
    if kind == "translational":
        h, g = (bodies.vector(b, _unit(o - P)) for b, o, P in ((i, others[2], P_i), (j, others[3], P_j)))
        _allsmall(f"turn of {name}", _products(h, g, _dot), turning)


def _joint_coordinates(result, bodies, text):
    """Angles and strokes move from the first row as the bodies do; whole turns are not seen."""
    names, counts = result.names.get("coordinate/name", []), {}
    for kind, numbers in text.joints:
        counts[kind] = counts.get(kind, 0) + 1
        for word, motion in (("angle", _turn), ("stroke", _stroke)):
            name = f"{kind} {counts[kind]} {word}"
            if name in names:
                k = names.index(name)
                motion(bodies, numbers, name, result["coordinate/q"][:, k], result["coordinate/u"][:, k])


def _ends(bodies, numbers):
    """Axis of a joint on body i and the way from P_i to P_j, each with two derivatives."""
    (i, j), (P_i, P_j, Q_i) = map(int, numbers[:2]), np.array(numbers[2:11]).reshape(3, 3)
    apart = tuple(b - a for a, b in zip(bodies.point(i, P_i), bodies.point(j, P_j), strict=True))
    return bodies.vector(i, _unit(Q_i - P_i)), apart


def _turn(bodies, numbers, name, q, u):
    i, j = map(int, numbers[:2])
    (s, *_), _apart = _ends(bodies, numbers)
    small(f"rate of {name}", u - (s * (bodies.spin(j) - bodies.spin(i))).sum(-1), u)
    across = np.cross(s[0], np.eye(3)[np.argmin(np.abs(s[0]))])
    f, h = (bodies.vector(b, _axes(bodies, b) @ _unit(across))[0] for b in (i, j))
    small(name, np.cos(q - q[0]) - (f * h).sum(-1), 0 * q)
    small(name, np.sin(q - q[0]) - (np.cross(f, h) * s).sum(-1), 0 * q)


def _stroke(bodies, numbers, name, q, u):
    way, rate, _ = (each[..., 0] for each in _products(*_ends(bodies, numbers), _dot))
    small(name, q - q[0] - (way - way[0]), way)
    small(f"rate of {name}", u - rate, rate)


def _axes(bodies, body):
    """Rows are the axes of a body in the first row: the matrix that turns global vectors into its own."""
    return np.array([bodies.vector(body, axis)[0][0] for axis in np.eye(3)])


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
            small(name, bodies.r[:, k, direction - 1] - f, f)
            small(f"rate of {name}", bodies.v[:, k, direction - 1] - rate, np.abs(f) + np.abs(rate))
            small(f"second rate of {name}", bodies.a[:, k, direction - 1] - second, np.abs(f) + second**2)
            continue
        # Angles beyond 1e6 rad have few digits left behind the point.
        p = bodies.p[:, k]
        small(name, p[:, direction - 3] - np.sin(f / 2), 1e-8 * f)
        small(name, p[:, 0] - np.cos(f / 2), 1e-8 * f)
        others = [m for m in range(3) if m != direction - 4]
        for order, turn, size in zip(ORDERS[1:], (bodies.omega, bodies.alpha), (rate, second), strict=True):
            off = AXIS * turn[:, k, others]
            small(f"{order}other axes than that of {name}", off, np.abs(size) + rate**2)
        small(f"rate of {name}", bodies.omega[:, k, direction - 4] - rate, rate)
        small(f"second rate of {name}", bodies.alpha[:, k, direction - 4] - second, rate**2 + np.abs(second))


def _at_rest(bodies, k, held):
    r, angles = np.array(held[:3]), np.array(held[3:])
    small("place of a ground", bodies.r[:, k] - r, bodies.r[:, k])
    small("attitude of a ground", bodies.p[:, k, 1:] - np.sin(angles / 2), bodies.p[:, k])
    small("motion of a ground", bodies.v[:, k], 0 * bodies.v[:, k])
    small("turning of a ground", bodies.omega[:, k], 0 * bodies.omega[:, k])


FORCELESS = {"MASS", "GRAVITY", "VELOCITY", "TOLERANCE", "GALF"}
# Cards of forces that are not computed here, by what they begin with: a body, or two.  Decks with a block
# ELEMENTS are not read at all.
OF_ONE = {"FORCE", "TORQUE"}
OF_TWO = {"SPRING", "DAMPER"}


def _forces(result, text):
    """Newton's and Euler's equations of every body, about its origin, with all that acts on it.

    Bodies on which other cards act are left out, and all where a card is not known.
    """
    known = FORCELESS | OF_ONE | OF_TWO
    if "reaction/force" not in result or {word for word, _ in text.cards} - known:
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
    judged = [k for k in range(forces.shape[1]) if k + 1 not in _pushed(text)]
    small("balance of forces", forces[:, judged], sizes[:, judged])
    small("balance of moments", moments[:, judged], sizes[:, judged])


def _pushed(text) -> set[int]:
    """Return the bodies that springs and loads act on."""
    found: set[int] = set()
    for word, numbers in text.cards:
        if word in OF_ONE | OF_TWO:
            found.update(map(int, numbers[: 1 + (word in OF_TWO)]))
    return found


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
