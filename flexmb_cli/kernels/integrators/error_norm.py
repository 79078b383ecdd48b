"""Tolerances and the norm in which all integrators measure errors: 1 is just allowed.

Hairer, Nørsett and Wanner, Solving Ordinary Differential Equations I (second edition), eq. (II.4.11).
"""

from typing import Any

import numpy as np

from .._jit import kernel

SLOWEST = 0.2  # least factor on the length of a step, by its error
MOST_MOVED = 10.0  # tolerances by which a projection may move the end of an accepted step
ITERATED = 0.02  # of the tolerance: what the iterations of a step of chosen length may leave
CAUTION = 0.8  # power of what an iteration left of its error: by it the first of the next step is trusted
TIME_ROUND_OFF = 2.3e-16  # of a time
PROJECTION_SHARE = 1e-10  # of a state that the projection may move at any tolerance: gaps of 1e-13 m


@kernel
def tolerance(clock: np.void, unit: float, size: int):
    """Return the error allowed in a component of this size, whose absolute tolerance is of `unit`."""
    return clock["atol"] * unit + clock["rtol"] * size


@kernel
def displacement_tolerance(clock: np.void, unit: float):
    """Return the error allowed in a displacement, or a rotation vector, of the size of its unit."""
    return (clock["atol"] + clock["rtol"]) * unit


@kernel
def scaled_norm(integration: Any, state: np.ndarray, change: np.ndarray):
    """Root mean square of a change (N,), works left out, against the tolerances at a state (N,)."""
    clock, total = integration.clock[0], 0.0
    counted = clock["counted"]
    for i in range(counted):
        total += (change[i] / tolerance(clock, integration.units[i], abs(state[i]))) ** 2
    return (total / counted) ** 0.5


@kernel
def moved_by_time(integration: Any, h: float):
    """Return by how many tolerances the round-off of the time moves the end of a step, which is in `trial`.

    It counts where a driver's rate rises within 1e-9 s: the rate at such an end is that of another time.
    """
    clock, total = integration.clock[0], 0.0
    for i in range(clock["counted"]):
        change = integration.trial[i] - integration.z[i]
        total += (change / tolerance(clock, integration.units[i], abs(integration.trial[i]))) ** 2
    return TIME_ROUND_OFF * abs(clock["t"] + h) / h * (total / clock["counted"]) ** 0.5


@kernel
def projection_too_large(open_end: np.ndarray, closed_end: np.ndarray, clock: np.void):
    """Return the place in the state that the projection onto the loops moved too far, or -1.

    open_end (N,), closed_end (N,): the state at the end of a step before and after the projection.
    A step that was good left the loops but for its error.  One across a singular position may land on
    the other motion that begins there: then the projection is what moves the tree, not the equations.
    """
    worst, place = 1.0, -1
    for i in range(open_end.shape[0] - 1):
        size = abs(closed_end[i])
        most = MOST_MOVED * tolerance(clock, 1.0, size) + PROJECTION_SHARE * (1.0 + size)
        share = abs(closed_end[i] - open_end[i]) / most
        # `not <=` lets a nan through as the worst place.
        if not share <= worst:
            worst, place = share, i
    return place
