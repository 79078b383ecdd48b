"""Primitives between moving vectors, of which joints at deformable points, their drivers and springs are
made.

    μ = α V · W + β θ - constant,   θ = atan2(G · H, F · H) and whole turns.

V and W are relative vectors, F, G and H body vectors (`body_vectors`), in layers 0 to 2: as they are, their
rates, their remainders.  Components of a gap, right angles, distances, strokes, angles and threads are all of
this form; the first primitives are equations, Φ = μ - f(t), to which others of a chain add
μ or, of cams, -c(μ).  A chain of the three components of
a point is a track: its gap from a curve, see `curves`.  The second derivative of a product is
2 V̇ · Ẇ + V · Ẅ + V̈ · W; that of θ with x = F · H and y = G · H is that of atan2, as in `joints.screw`.
"""

import math

import numpy as np

from .._jit import kernel
from ..curves import curve_values, nearest_parameter, normal, stretch
from ..linalg.rotation import TURN
from ..linalg.vec3 import dot, minus
from .body_vectors import RATE, REMAINDER, VECTOR, Geometry, add_vector_row, geometry_of, vector
from .rolling_rows import add_rolling_row, rolling_gap, rolling_rates
from .system import PRODUCT, System, Work
from .time_functions import function_values

PARAMETER = 2  # `track` of the parameter of a point on a curve; 0 and 1 are its gaps along the normals


@kernel
def primitive_value(geometry: Geometry, k: int, expected: float) -> float:
    """μ of primitive k at placed body vectors; expected: the angle expected, rad."""
    m, value = geometry.primitives[k], -geometry.primitives[k]["constant"]
    if m["alpha"] != 0.0:
        value += m["alpha"] * _relative_product(geometry.relative_vectors, k, VECTOR, VECTOR)
    if m["beta"] != 0.0:
        value += m["beta"] * primitive_angle(geometry.placed, m, expected)
    return value


@kernel
def _relative_product(relative_vectors: np.ndarray, k: int, layer: int, layer_of_w: int) -> float:
    """V · W of primitive k, each of one layer."""
    total = 0.0
    for i in range(3):
        total += relative_vectors[layer, k, 0, i] * relative_vectors[layer_of_w, k, 1, i]
    return total


@kernel
def primitive_angle(placed: np.ndarray, m: np.void, expected: float) -> float:
    """Return θ, rad, of primitive m at placed (3, body vectors, 3): the value nearest to `expected`."""
    x, y = _products(placed, m, VECTOR, VECTOR)
    theta = math.atan2(y, x)
    return theta + TURN * math.floor((expected - theta) / TURN + 0.5)


@kernel
def _products(placed: np.ndarray, m: np.void, layer: int, layer_of_h: int) -> tuple[float, float]:
    """F · H and G · H, F and G of one layer of the body vectors `placed`, H of another."""
    f, g, h = m["f"], m["g"], m["h"]
    x = y = 0.0
    for i in range(3):
        x += placed[layer, f, i] * placed[layer_of_h, h, i]
        y += placed[layer, g, i] * placed[layer_of_h, h, i]
    return x, y


@kernel
def angle_rates(placed: np.ndarray, m: np.void) -> tuple[float, float]:
    """Return the rate of θ, rad/s, and its second derivative without those of the coordinates, rad/s².

    placed (3, body vectors, 3): body vectors that have been moved.
    """
    x, y = _products(placed, m, VECTOR, VECTOR)
    xd = yd = xr = yr = 0.0
    for a in range(3):
        for b in range(3 - a):
            share_x, share_y = _products(placed, m, a, b)
            if a + b == 1:
                xd += share_x
                yd += share_y
            elif a + b == 2:
                xr += share_x * (2.0 if a == b else 1.0)
                yr += share_y * (2.0 if a == b else 1.0)
    square, turned = x * x + y * y, x * yd - y * xd
    return turned / square, (x * yr - y * xr) / square - 2.0 * (x * xd + y * yd) * turned / (square * square)


@kernel
def primitive_rates(geometry: Geometry, k: int) -> tuple[float, float]:
    """Rate of primitive k, and its second derivative without those of the coordinates, at moved body
    vectors.
    """
    m, relative_vectors = geometry.primitives[k], geometry.relative_vectors
    rate = rest = 0.0
    if m["alpha"] != 0.0:
        rate = _relative_product(relative_vectors, k, VECTOR, RATE) + _relative_product(
            relative_vectors, k, RATE, VECTOR
        )
        rest = _relative_product(relative_vectors, k, VECTOR, REMAINDER) + _relative_product(
            relative_vectors, k, REMAINDER, VECTOR
        )
        rest += 2.0 * _relative_product(relative_vectors, k, RATE, RATE)
        rate, rest = m["alpha"] * rate, m["alpha"] * rest
    if m["beta"] != 0.0:
        turn, turn_rest = angle_rates(geometry.placed, m)
        rate += m["beta"] * turn
        rest += m["beta"] * turn_rest
    return rate, rest


@kernel
def add_primitive_row(geometry: Geometry, k: int, factor: float, row: np.ndarray) -> None:
    """Add factor times the derivative of primitive k by the speeds to row (n,)."""
    m, body_vectors = geometry.primitives[k], geometry.body_vectors
    if m["alpha"] != 0.0:
        for side in range(2):
            head, tail = m["ends"][side, 0], m["ends"][side, 1]
            w, share = vector(geometry.relative_vectors[VECTOR, k], 1 - side), factor * m["alpha"]
            apart = tail >= 0 and body_vectors[head]["body"] != body_vectors[tail]["body"]
            add_vector_row(geometry, head, w, share, apart, row)
            if tail >= 0:
                add_vector_row(geometry, tail, w, -share, apart, row)
    if m["beta"] != 0.0:
        x, y = _products(geometry.placed, m, VECTOR, VECTOR)
        share = factor * m["beta"] / (x * x + y * y)
        for body_vector, other, part in (
            (m["f"], m["h"], -y),
            (m["g"], m["h"], x),
            (m["h"], m["g"], x),
            (m["h"], m["f"], -y),
        ):
            add_vector_row(
                geometry, body_vector, vector(geometry.placed[VECTOR], other), share * part, False, row
            )


@kernel
def _in_chain(system: System, work: Work, k: int, expected: np.ndarray) -> tuple[float, float, float]:
    """Share of primitive k in its chain, and its first two derivatives by the primitive."""
    turn, curve = system.primitives[k]["turn"], system.primitives[k]["curve"]
    value = primitive_value(geometry_of(system, work), k, expected[turn] if turn >= 0 else 0.0)
    if curve < 0:
        return value, 1.0, 0.0
    f, slope, bend = function_values(system.functions, system.knots, curve, value)
    return -f, -slope, -bend


@kernel
def chain_value(system: System, work: Work, k: int, expected: np.ndarray) -> float:
    """Value of primitive k and of those that are added to it; expected: the angles expected, rad."""
    if system.primitives[k]["roll"] > 0:
        return rolling_gap(system, work, k)
    if system.primitives[k]["track"] >= 0:
        return _track_value(system, work, k, expected)
    value, k = _in_chain(system, work, k, expected)[0], system.primitives[k]["next"]
    while k >= 0:
        value += _in_chain(system, work, k, expected)[0]
        k = system.primitives[k]["next"]
    return value


@kernel
def chain_rates(system: System, work: Work, k: int) -> tuple[float, float]:
    """Rate of a chain, and its second derivative without those of the coordinates, at moved body vectors."""
    if system.primitives[k]["roll"] > 0:
        return rolling_rates(system, work, k)
    if system.primitives[k]["track"] >= 0:
        return track_rates(system, work, k, work.angles)
    rate, rest = _rates_in_chain(system, work, k)
    k = system.primitives[k]["next"]
    while k >= 0:
        more, more_rest = _rates_in_chain(system, work, k)
        rate, rest, k = rate + more, rest + more_rest, system.primitives[k]["next"]
    return rate, rest


@kernel
def _rates_in_chain(system: System, work: Work, k: int) -> tuple[float, float]:
    rate, rest = primitive_rates(geometry_of(system, work), k)
    if system.primitives[k]["curve"] < 0:
        return rate, rest
    _, slope, bend = _in_chain(system, work, k, work.angles)
    return slope * rate, slope * rest + bend * rate * rate


@kernel
def add_chain_row(system: System, work: Work, k: int, factor: float, row: np.ndarray) -> None:
    """Add factor times the derivative of a chain by the speeds to row (n,)."""
    if system.primitives[k]["roll"] > 0:
        add_rolling_row(system, work, k, factor, row)
        return
    if system.primitives[k]["track"] >= 0:
        _add_track_row(system, work, k, factor, row)
        return
    while k >= 0:
        share = factor
        if system.primitives[k]["curve"] >= 0:
            share *= _in_chain(system, work, k, work.angles)[1]
        add_primitive_row(geometry_of(system, work), k, share, row)
        k = system.primitives[k]["next"]


@kernel
def _components(system: System, work: Work, k: int) -> tuple[float, float, float]:
    """Place of the point of a track from the origin of its curve, axes of the curve's body, m."""
    relative_vectors, second = work.relative_vectors, system.primitives[k]["next"]
    third = system.primitives[second]["next"]
    return (
        _relative_product(relative_vectors, k, VECTOR, VECTOR),
        _relative_product(relative_vectors, second, VECTOR, VECTOR),
        _relative_product(relative_vectors, third, VECTOR, VECTOR),
    )


@kernel
def track_parameter(system: System, work: Work, k: int, expected: np.ndarray) -> float:
    """Parameter of the curve nearest to the point of track k, near the one expected."""
    m = system.primitives[k]
    p, s = _components(system, work, k), expected[m["turn"]]
    return nearest_parameter(system.functions, system.knots, m["curve"], p, s)


@kernel
def _track_value(system: System, work: Work, k: int, expected: np.ndarray) -> float:
    m, s = system.primitives[k], track_parameter(system, work, k, expected)
    if m["track"] == PARAMETER:
        return s
    c, d, _ = curve_values(system.functions, system.knots, m["curve"], s)
    return dot(_normal(system, m, d), minus(_components(system, work, k), c))


@kernel
def _normal(system: System, m: np.void, d: tuple[float, float, float]) -> tuple[float, float, float]:
    return normal(d, vector(system.body_vectors["c"], m["f"]), m["track"])


@kernel
def track_rates(system: System, work: Work, k: int, expected: np.ndarray) -> tuple[float, float]:
    """Rate of a track's gap or parameter, and its second derivative without those of the coordinates."""
    m, geometry, second = system.primitives[k], geometry_of(system, work), system.primitives[k]["next"]
    x, y = primitive_rates(geometry, k), primitive_rates(geometry, second)
    z = primitive_rates(geometry, system.primitives[second]["next"])
    v, rest = (x[0], y[0], z[0]), (x[1], y[1], z[1])
    s = track_parameter(system, work, k, expected)
    c, d, b = curve_values(system.functions, system.knots, m["curve"], s)
    advance = dot(d, v) / stretch(d, b, minus(_components(system, work, k), c))
    if m["track"] == PARAMETER:
        return advance, (dot(d, rest) - dot(d, b) * advance * advance) / dot(d, d)
    n = _normal(system, m, d)
    return dot(n, v), dot(n, rest) - dot(n, b) * advance * advance


@kernel
def _add_track_row(system: System, work: Work, k: int, factor: float, row: np.ndarray) -> None:
    m, s = system.primitives[k], track_parameter(system, work, k, work.angles)
    _, d, _ = curve_values(system.functions, system.knots, m["curve"], s)
    if m["track"] == PARAMETER:
        share = dot(d, d)
        n = (d[0] / share, d[1] / share, d[2] / share)
    else:
        n = _normal(system, m, d)
    for i in range(3):
        add_primitive_row(geometry_of(system, work), k, factor * n[i], row)
        k = system.primitives[k]["next"]


@kernel
def equation_residuals(system: System, work: Work, t: float, expected: np.ndarray, phi: np.ndarray) -> None:
    """Fill the last rows of phi (m,), those of the primitives that are equations."""
    first = system.bodies.shape[0]
    for row in range(first, phi.shape[0]):
        function = system.primitives[row - first]["function"]
        phi[row] = chain_value(system, work, row - first, expected)
        if function >= 0:
            phi[row] -= function_values(system.functions, system.knots, function, t)[0]


@kernel
def equation_rows(system: System, work: Work, jacobian: np.ndarray) -> None:
    """Fill the last rows of jacobian (m, c), not scaled."""
    first, whole = system.bodies.shape[0], work.vectors[PRODUCT]
    for row in range(first, jacobian.shape[0]):
        for p in range(1, 1 + work.columns[row, 0]):
            whole[work.columns[row, p]] = 0.0
        add_chain_row(system, work, row - first, 1.0, whole)
        for p in range(work.columns[row, 0]):
            jacobian[row, p] = whole[work.columns[row, 1 + p]]


@kernel
def equation_velocities(system: System, t: float, nu: np.ndarray) -> None:
    """Fill the last rows of nu (m,), the rates that the functions ask for."""
    first = system.bodies.shape[0]
    for k in range(nu.shape[0] - first):
        function = system.primitives[k]["function"]
        nu[first + k] = (
            function_values(system.functions, system.knots, function, t)[1] if function >= 0 else 0.0
        )


@kernel
def equation_accelerations(system: System, work: Work, t: float, gamma: np.ndarray) -> None:
    """Fill the last rows of gamma (m,), at moved body vectors."""
    first = system.bodies.shape[0]
    for row in range(first, gamma.shape[0]):
        function = system.primitives[row - first]["function"]
        gamma[row] = 0.0 - chain_rates(system, work, row - first)[1]
        if function >= 0:
            gamma[row] += function_values(system.functions, system.knots, function, t)[2]
