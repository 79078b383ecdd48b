"""States between two steps of Radau's method, by Hermite's quintic and cubic."""

import numpy as np

from .._jit import allocating, kernel
from ..constrained.speeds import coordinate_accelerations, coordinate_rates, speeds_of_rates
from .radau5_step import LAST, START


@allocating
def between(system, integration, x, point):
    """Fill point with the state at the fraction x of the last step."""
    clock, old, z, n = integration.clock[0], integration.old, integration.z, system.speed_scale.shape[0]
    bodies, h = system.masses.shape[0], clock["step_length"]
    nq = n + bodies
    rates = np.empty((5, nq))
    coordinate_rates(bodies, old[:nq], old[nq : nq + n], rates[0])
    coordinate_accelerations(bodies, old[:nq], old[nq : nq + n], integration.rates[LAST], rates[1])
    coordinate_rates(bodies, z[:nq], z[nq : nq + n], rates[2])
    coordinate_accelerations(bodies, z[:nq], z[nq : nq + n], integration.rates[START], rates[3])
    for i in range(nq):
        point[i], rates[4, i] = _quintic(
            x, old[i], z[i], h * rates[0, i], h * rates[2, i], h * h * rates[1, i], h * h * rates[3, i]
        )
        rates[4, i] /= h
    speeds_of_rates(bodies, point[:nq], rates[4], point[nq : nq + n])
    last = nq + n
    point[last] = _cubic(x, old[last], z[last], h * clock["old_power"], h * clock["power"])


@kernel
def _quintic(x, a, b, v, w, p, r):
    """Value and derivative at x; a, b, v, w, p, r: values, first and second derivatives at 0 and at 1."""
    rest, slope, bend = b - a - v - 0.5 * p, w - v - p, r - p
    c3 = 10.0 * rest - 4.0 * slope + 0.5 * bend
    c4 = -15.0 * rest + 7.0 * slope - bend
    c5 = 6.0 * rest - 3.0 * slope + 0.5 * bend
    value = a + x * (v + x * (0.5 * p + x * (c3 + x * (c4 + x * c5))))
    return value, v + x * (p + x * (3.0 * c3 + x * (4.0 * c4 + x * 5.0 * c5)))


@kernel
def _cubic(x, a, b, da, db):
    change = b - a
    return a + x * (da + x * (3.0 * change - 2.0 * da - db + x * (da + db - 2.0 * change)))
