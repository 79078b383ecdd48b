"""Measures between moving vectors, of which joints at deformable points, their drivers and springs are made.

    μ = α V · W + β θ - constant,   θ = atan2(G · H, F · H) and whole turns.

V and W are spans, F, G and H arms (`kernels.arms`), in layers 0 to 2: as they are, their rates, their
remainders.  Components of a gap, right angles, distances, strokes, angles and threads are all of this form;
the first measures are equations, Φ = μ - f(t).  The second derivative of a product is
2 V̇ · Ẇ + V · Ẅ + V̈ · W; that of θ with x = F · H and y = G · H is that of atan2, as in `joints.screw`.
"""

import math

from .._jit import kernel
from .body_vectors import ARM, RATE, REST, add_arm_row, geometry_of, vector
from .time_functions import law_values

TURN = 2.0 * math.pi


@kernel
def measure_value(geometry, k, near):
    """μ of measure k at placed arms; near: the angle expected, rad."""
    m, value = geometry.measures[k], -geometry.measures[k]["constant"]
    if m["alpha"] != 0.0:
        value += m["alpha"] * _span_product(geometry.spans, k, ARM, ARM)
    if m["beta"] != 0.0:
        value += m["beta"] * measure_angle(geometry.placed, m, near)
    return value


@kernel
def _span_product(spans, k, layer, layer_of_w):
    """V · W of measure k, each of one layer."""
    total = 0.0
    for i in range(3):
        total += spans[layer, k, 0, i] * spans[layer_of_w, k, 1, i]
    return total


@kernel
def measure_angle(placed, m, near):
    """θ, rad: the value nearest to `near`."""
    x, y = _products(placed, m, ARM, ARM)
    theta = math.atan2(y, x)
    return theta + TURN * math.floor((near - theta) / TURN + 0.5)


@kernel
def _products(placed, m, layer, layer_of_h):
    """F · H and G · H, F and G of one layer of the arms `placed`, H of another."""
    f, g, h = m["f"], m["g"], m["h"]
    x = y = 0.0
    for i in range(3):
        x += placed[layer, f, i] * placed[layer_of_h, h, i]
        y += placed[layer, g, i] * placed[layer_of_h, h, i]
    return x, y


@kernel
def angle_rates(placed, m):
    """Rate of θ, rad/s, and its second derivative without those of the coordinates, at moved arms."""
    x, y = _products(placed, m, ARM, ARM)
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
def measure_rates(geometry, k):
    """Rate of measure k, and its second derivative without those of the coordinates, at moved arms."""
    m, spans = geometry.measures[k], geometry.spans
    rate = rest = 0.0
    if m["alpha"] != 0.0:
        rate = _span_product(spans, k, ARM, RATE) + _span_product(spans, k, RATE, ARM)
        rest = _span_product(spans, k, ARM, REST) + _span_product(spans, k, REST, ARM)
        rest += 2.0 * _span_product(spans, k, RATE, RATE)
        rate, rest = m["alpha"] * rate, m["alpha"] * rest
    if m["beta"] != 0.0:
        turn, turn_rest = angle_rates(geometry.placed, m)
        rate += m["beta"] * turn
        rest += m["beta"] * turn_rest
    return rate, rest


@kernel
def add_measure_row(geometry, k, factor, row):
    """Add factor times the derivative of measure k by the speeds to row (n,)."""
    m, arms = geometry.measures[k], geometry.arms
    if m["alpha"] != 0.0:
        for side in range(2):
            head, tail = m["ends"][side, 0], m["ends"][side, 1]
            w, share = vector(geometry.spans[ARM, k], 1 - side), factor * m["alpha"]
            apart = tail >= 0 and arms[head]["body"] != arms[tail]["body"]
            add_arm_row(geometry, head, w, share, apart, row)
            if tail >= 0:
                add_arm_row(geometry, tail, w, -share, apart, row)
    if m["beta"] != 0.0:
        x, y = _products(geometry.placed, m, ARM, ARM)
        share = factor * m["beta"] / (x * x + y * y)
        for arm, other, part in (
            (m["f"], m["h"], -y),
            (m["g"], m["h"], x),
            (m["h"], m["g"], x),
            (m["h"], m["f"], -y),
        ):
            add_arm_row(geometry, arm, vector(geometry.placed[ARM], other), share * part, False, row)


@kernel
def equation_residuals(system, work, t, near, phi):
    """Fill the last rows of phi (m,), those of the measures that are equations."""
    first, geometry = system.bodies.shape[0], geometry_of(system, work)
    for row in range(first, phi.shape[0]):
        k, phi[row] = row - first, 0.0
        law = system.measures[k]["law"]
        while k >= 0:
            turn = system.measures[k]["turn"]
            phi[row] += measure_value(geometry, k, near[turn] if turn >= 0 else 0.0)
            k = system.measures[k]["next"]
        if law >= 0:
            phi[row] -= law_values(system.laws, system.knots, law, t)[0]


@kernel
def equation_rows(system, work, jacobian):
    """Fill the last rows of jacobian (m, n), not scaled."""
    first, geometry = system.bodies.shape[0], geometry_of(system, work)
    for row in range(first, jacobian.shape[0]):
        for p in range(1, 1 + work.columns[row, 0]):
            jacobian[row, work.columns[row, p]] = 0.0
        k = row - first
        while k >= 0:
            add_measure_row(geometry, k, 1.0, jacobian[row])
            k = system.measures[k]["next"]


@kernel
def equation_velocities(system, t, nu):
    """Fill the last rows of nu (m,), the rates that the laws ask for."""
    first = system.bodies.shape[0]
    for k in range(nu.shape[0] - first):
        law = system.measures[k]["law"]
        nu[first + k] = law_values(system.laws, system.knots, law, t)[1] if law >= 0 else 0.0


@kernel
def equation_accelerations(system, work, t, gamma):
    """Fill the last rows of gamma (m,), at moved arms."""
    first, geometry = system.bodies.shape[0], geometry_of(system, work)
    for row in range(first, gamma.shape[0]):
        k, gamma[row] = row - first, 0.0
        law = system.measures[k]["law"]
        while k >= 0:
            gamma[row] -= measure_rates(geometry, k)[1]
            k = system.measures[k]["next"]
        if law >= 0:
            gamma[row] += law_values(system.laws, system.knots, law, t)[2]
