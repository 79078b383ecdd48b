"""States between two steps of Radau's method, by Hermite's quintic and cubic."""

import numpy as np

from .._jit import kernel
from ..constrained.speeds import coordinate_accelerations, coordinate_rates, speeds_of_rates
from .hermite import cubic, quintic
from .radau5_step import LAST, START


@kernel
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
        point[i], rates[4, i] = quintic(
            x, old[i], z[i], h * rates[0, i], h * rates[2, i], h * h * rates[1, i], h * h * rates[3, i]
        )
        rates[4, i] /= h
    speeds_of_rates(bodies, point[:nq], rates[4], point[nq : nq + n])
    last = nq + n
    point[last] = cubic(
        x, old[last], z[last], h * integration.memory[0]["old_power"], h * integration.memory[0]["power"]
    )
