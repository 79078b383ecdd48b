"""Contact of two shapes: gap, normal and place by the pair of shapes, normal force, friction, and energy.

Normal force: Hunt and Crossley, Journal of Applied Mechanics 42 (1975), pages 440-445: at the depth d > 0
that grows at the rate d', N = k d^n max(0, 1 + b d').  Friction: that of `laws`, by this normal force and the
sliding speed at the place of contact.  Closest points: Ericson, Real-Time Collision Detection (2005), 5.1.

Record fields are those of `model.arrays.records.TOUCH`, numbers of the law those of `model.laws.CONTACT`.
"""

import math

import numpy as np

from ._jit import kernel
from .laws import COORDINATE, DAMPING, EFFORT, ENERGY, NO_LENGTH, NORMAL, POWER, SMALL, SPEED, STIFFNESS
from .linalg.vec3 import cross, dot, minus, plus, scaled, store, triple

Triple = tuple[float, float, float]
Axes = tuple[Triple, Triple, Triple]  # unit vectors of a body, in global axes
CONTACT = 6  # code of the law; a test compares it with model.laws
# Pairs of shapes: that of body i, and that of body j.
PLANE_BALL, PLANE_RIM, CORES, BOX_BALL, CYLINDER_BALL = 0, 1, 2, 3, 4
# Numbers of the law.
RIGIDITY, EXPONENT, LOSS, MU, MU_STATIC, MU_STRIBECK, MU_CREEP, ROLLING = 0, 1, 2, 3, 4, 5, 6, 7
# Columns of the answers of systems with contacts, besides those of `laws`: force on body j, N, and place, m,
# both in global axes; number of touches, time of the last change, s; state, and gap and rate at the start
# and at the end of the step.
PUSH, PLACE, TOUCHES, CHANGED, STATE, AT_START, START_RATE, END, END_RATE = 8, 11, 14, 15, 16, 17, 18, 19, 20
CONTACT_COLUMNS = 21
# States: the gap decides in each evaluation; apart or touching until an event.
BY_GAP, SEPARATE, TOUCHING = 0.0, 1.0, 2.0


@kernel
def answer_contact(
    c: np.void, d: Triple, v: Triple, axes_i: Axes, w_i: Triple, axes_j: Axes, w_j: Triple, answer: np.ndarray
) -> Triple:
    """Fill the answer (21,), and `normal` to `arm_j` of a contact; return the place less the point of i.

    d, v: point of j less that of i, m, and its rate; w: angular velocities; all in global axes.
    """
    offset = _outward(axes_j, triple(c["offset_j"], 0))
    gap, n, arm = _nearest(c, plus(d, offset), axes_i, axes_j)
    arm_j = plus(offset, plus(arm, scaled(-c["radius_j"] - 0.5 * gap, n)))
    arm_i = plus(d, arm_j)
    slip = minus(plus(v, cross(w_j, arm_j)), cross(w_i, arm_i))
    rate = dot(n, slip)
    answer[COORDINATE], answer[SPEED] = gap, rate
    N, kept = _normal_force(c["c"], answer)
    store(arm_i, c["arm_i"], 0)
    store(arm_j, c["arm_j"], 0)
    store(n, c["normal"], 0)
    lost = _resist(c, n, N, minus(slip, scaled(rate, n)), minus(w_j, w_i))
    answer[EFFORT], answer[POWER], answer[NORMAL] = N, (N - kept) * rate + lost, N
    store(scaled(N, triple(c["push"], 0)), answer, PUSH)
    return arm_i


@kernel
def _outward(axes: Axes, v: Triple) -> Triple:
    """Return v, in the axes of a body, in global axes."""
    return plus(plus(scaled(v[0], axes[0]), scaled(v[1], axes[1])), scaled(v[2], axes[2]))


@kernel
def _normal_force(c: np.ndarray, answer: np.ndarray):
    """Normal force by c (10,) and its part with a potential; fills slopes and energy of an answer (21,)."""
    depth, n, k = max(-answer[COORDINATE], 0.0), c[EXPONENT], c[RIGIDITY]
    if depth == 0.0 or answer[STATE] == SEPARATE:
        answer[STIFFNESS] = answer[DAMPING] = answer[ENERGY] = 0.0
        return 0.0, 0.0
    kept = k * depth**n
    share = max(0.0, 1.0 - c[LOSS] * answer[SPEED])
    answer[STIFFNESS], answer[DAMPING] = n * kept / depth * share, kept * c[LOSS] if share > 0.0 else 0.0
    answer[ENERGY] = kept * depth / (n + 1.0)
    return kept * share, kept


@kernel
def _resist(c: np.void, n: Triple, N: float, slip: Triple, w: Triple) -> float:
    """Fill what friction and rolling resistance add per unit of the normal force N; return their power."""
    law, v = c["c"], math.sqrt(dot(slip, slip))
    share, slope = contact_friction(law, v)
    store(minus(n, scaled(share, slip)), c["push"], 0)
    along = scaled(1.0 / v, slip) if v > SMALL * law[MU_CREEP] else _across(n)
    store(along, c["along"], 0)
    c["slope_along"], c["slope_across"] = N * max(slope, 0.0), N * share
    power = -N * share * v * v
    if law[ROLLING] > 0.0:
        rolling = minus(w, scaled(dot(n, w), n))
        speed = math.sqrt(dot(rolling, rolling))
        creep = law[MU_CREEP] / (c["radius_j"] if c["radius_j"] > 0.0 else 1.0)
        resists = law[ROLLING] * (math.tanh(speed / creep) / speed if speed > SMALL * creep else 1.0 / creep)
        store(scaled(-resists, rolling), c["roll"], 0)
        power -= N * resists * speed * speed
    return power


@kernel
def contact_friction(c: np.ndarray, v: float):
    """μ(v)/v and dμ/dv at the sliding speed v >= 0 by the numbers c (10,) of a contact law."""
    more = max(c[MU_STATIC] - c[MU], 0.0)
    fade, rise = math.exp(-((v / c[MU_STRIBECK]) ** 2)), math.tanh(v / c[MU_CREEP])
    mu = c[MU] + more * fade
    slope = mu * (1.0 - rise * rise) / c[MU_CREEP] - 2.0 * more * fade * v / c[MU_STRIBECK] ** 2 * rise
    return (mu * rise / v if v > SMALL * c[MU_CREEP] else mu / c[MU_CREEP]), slope


@kernel
def _across(n: Triple) -> Triple:
    """Return a unit vector across n."""
    a = (1.0, 0.0, 0.0) if abs(n[0]) < 0.7 else (0.0, 1.0, 0.0)
    b = cross(n, a)
    return scaled(1.0 / math.sqrt(dot(b, b)), b)


@kernel
def _nearest(c: np.void, d: Triple, axes_i: Axes, axes_j: Axes):
    """Gap, its unit normal from i to j, and the point of the core of j nearest to i less its point, m."""
    pair, radii, none = c["pair"], c["radius_i"] + c["radius_j"], (0.0, 0.0, 0.0)
    a = _outward(axes_i, triple(c["axis_i"], 0))
    if pair == PLANE_BALL:
        return dot(a, d) - radii, a, none
    if pair == PLANE_RIM:
        axis = _outward(axes_j, triple(c["axis_j"], 0))
        down = minus(scaled(dot(a, axis), axis), a)
        length = math.sqrt(dot(down, down))
        arm = scaled(c["size"][0] / length if length > NO_LENGTH else 0.0, down)
        return dot(a, plus(d, arm)), a, arm
    if pair == BOX_BALL:
        sd, n = _outside_box(c["size"], (dot(axes_i[0], d), dot(axes_i[1], d), dot(axes_i[2], d)))
        return sd - radii, _outward(axes_i, n), none
    if pair == CYLINDER_BALL:
        sd, n = _outside_cylinder(a, c["size"][0], d)
        return sd - radii, n, none
    b = _outward(axes_j, triple(c["axis_j"], 0))
    s, t = _closest(a, b, d)
    arm = scaled(t, b)
    apart = plus(minus(d, scaled(s, a)), arm)
    length = math.sqrt(dot(apart, apart))
    n = scaled(1.0 / length, apart) if length > NO_LENGTH else (0.0, 0.0, 1.0)
    return length - radii, n, arm


@kernel
def _closest(a: Triple, b: Triple, d: Triple):
    """Shares s and t, 0 to 1, of the nearest points s a and d + t b of two segments, or points."""
    aa, bb, ab, ad, bd = dot(a, a), dot(b, b), dot(a, b), dot(a, d), dot(b, d)
    square = aa * bb - ab * ab
    s = _share(ad * bb - ab * bd, square) if square > 1e-14 * aa * bb else 0.0
    t = _share(ab * s - bd, bb)
    return _share(ad + ab * t, aa), t


@kernel
def _share(x: float, y: float):
    return min(max(x / y, 0.0), 1.0) if y > 0.0 else 0.0


@kernel
def _outside_box(size: np.ndarray, p: Triple):
    """Distance of p from a box of half edges size (3,) about 0, negative inside, and the normal."""
    x = minus(p, _clamped(size, p))
    length = math.sqrt(dot(x, x))
    if length > NO_LENGTH:
        return length, scaled(1.0 / length, x)
    depths = (size[0] - abs(p[0]), size[1] - abs(p[1]), size[2] - abs(p[2]))
    least = min(depths[0], min(depths[1], depths[2]))
    if depths[0] == least:
        return -least, (math.copysign(1.0, p[0]), 0.0, 0.0)
    if depths[1] == least:
        return -least, (0.0, math.copysign(1.0, p[1]), 0.0)
    return -least, (0.0, 0.0, math.copysign(1.0, p[2]))


@kernel
def _clamped(size: np.ndarray, p: Triple) -> Triple:
    return (
        min(max(p[0], -size[0]), size[0]),
        min(max(p[1], -size[1]), size[1]),
        min(max(p[2], -size[2]), size[2]),
    )


@kernel
def _outside_cylinder(a: Triple, radius: float, d: Triple):
    """Distance of d from the solid cylinder about the segment from 0 to a, and the normal."""
    length = math.sqrt(dot(a, a))
    axis = scaled(1.0 / length, a)
    along = dot(axis, d) - 0.5 * length
    side = minus(d, scaled(dot(axis, d), axis))
    off = math.sqrt(dot(side, side))
    out = scaled(1.0 / off, side) if off > NO_LENGTH else _across(axis)
    end = scaled(math.copysign(1.0, along), axis)
    x, y = off - radius, abs(along) - 0.5 * length
    if x > 0.0 and y > 0.0:
        sd = math.sqrt(x * x + y * y)
        return sd, plus(scaled(x / sd, out), scaled(y / sd, end))
    return (x, out) if x > y else (y, end)
