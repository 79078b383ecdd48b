"""Rolling without slip: the contact of a disc, sphere or wheel with a plane or another wheel.

Body a carries a disc or sphere of a radius about its centre, body b a plane of the unit normal u through its
own point, or a wheel about the unit axle u.  The disc touches in the point of its rim that is nearest to the
plane: with the axle x of the disc, its edge lies along e = (u - (u · x) x) / s, s² = 1 - (u · x)², and the
contact at centre - radius e; of a sphere x is 0.  Two wheels with parallel axles touch between their centres,
inside each other if `other` is negative.

The material points of both bodies at the contact have the same velocity, one equation along each of the
directions n, t, u × t: v_a(c) - v_b(c) = 0.  Its derivative has, besides the accelerations of these points,
the term (w_a - w_b) × m, m the velocity of the contact against the material of body a (Neimark and Fufaev,
Dynamics of Nonholonomic Systems, 1972, section I.3): it moves along the rim.  Only the equation along n has a
gap, its integral.
"""

import math

from ._jit import kernel
from .linalg.vec3 import cross, dot, minus, scaled

NO_ROLL, ON_PLANE, ON_WHEEL = 0, 1, 2


@kernel
def rolling_contact(
    kind: int,
    u: tuple[float, float, float],
    x: tuple[float, float, float],
    d: tuple[float, float, float],
    radius: float,
    other: float,
) -> tuple[tuple[float, float, float], tuple[float, float, float], float]:
    """Normal n, contact from the centre of a, m, and gap, m; d: centre of a from the point of b, m."""
    if kind == ON_WHEEL:
        n, size, side = _between(u, d, other)
        return n, scaled(-radius, n), side * size - radius - other
    edge, s = _edge(u, x)
    return u, scaled(-radius, edge), dot(u, d) - radius * s


@kernel
def contact_advance(
    kind: int,
    u: tuple[float, float, float],
    x: tuple[float, float, float],
    d: tuple[float, float, float],
    radius: float,
    other: float,
    w: tuple[float, float, float],
    v: tuple[float, float, float],
) -> tuple[float, float, float]:
    """Velocity of the contact against the material of body a, m/s.

    w: angular velocity of a against b, rad/s; v: velocity of the centre of a against the material of b, m/s.
    """
    if kind == ON_WHEEL:
        n, size, side = _between(u, d, other)
        across = minus(v, scaled(dot(u, v), u))
        turn = scaled(side / size, minus(across, scaled(dot(n, across), n)))
        return scaled(-radius, minus(turn, cross(w, n)))
    edge, s = _edge(u, x)
    turn = scaled(-1.0, cross(w, u))
    change = minus(turn, scaled(dot(turn, x), x))
    stretch = -dot(u, x) * dot(turn, x) / s
    return scaled(-radius / s, minus(change, scaled(stretch, edge)))


@kernel
def rolling_direction(
    kind: int,
    axis: int,
    u: tuple[float, float, float],
    across: tuple[float, float, float],
    n: tuple[float, float, float],
) -> tuple[float, float, float]:
    """Direction of equation `axis`: 0 along n, 1 and 2 across it; `across`: unit vector of b at right angles
    to u."""
    if axis == 0:
        return n
    if kind == ON_WHEEL:
        return cross(u, n)
    return across if axis == 1 else cross(u, across)


@kernel
def _edge(
    u: tuple[float, float, float], x: tuple[float, float, float]
) -> tuple[tuple[float, float, float], float]:
    """Direction away from the contact of a disc, and the sine of the angle between axle and normal."""
    along = dot(u, x)
    s = math.sqrt(1.0 - along * along)
    return scaled(1.0 / s, minus(u, scaled(along, x))), s


@kernel
def _between(
    u: tuple[float, float, float], d: tuple[float, float, float], other: float
) -> tuple[tuple[float, float, float], float, float]:
    """Normal of two wheels, distance of their axles, and the sign of the radius of the other one."""
    side = 1.0 if other > 0.0 else -1.0
    across = minus(d, scaled(dot(u, d), u))
    size = math.sqrt(dot(across, across))
    return scaled(side / size, across), size, side
