"""Steps laid out around a singular position ahead, where two motions of a mechanism cross.

Near to it equations 1e-16 off move the speeds by more the nearer it is: by the inverse square of the
distance.  No step may end there.  The time at which a pivot of the elimination vanishes is foreseen along
the motion, and the steps in front of it are made equal and such that one of them leads over it with all its
stages at a distance.
"""

import math
from typing import Any

import numpy as np

from .._jit import allocating, kernel
from ..constrained.accelerations import evaluate_jacobian, factorise_order
from ..constrained.speeds import coordinate_rates, normalise
from ..constrained.system import System, Work
from ..linalg.number_rows import copy
from .clock import LOOK

MOST_SECANTS = 6
FOUND = 0.02  # of the way: how well the time is known
SPEED_ROUND_OFF = 1e-13  # of speeds, where pivots are 1: it grows by their inverse squares
NOISE = 0.01  # of that: what it commonly is
OVER = 4.0  # of the way to a position that is foreseen worse


@kernel
def look_ahead(system: System, work: Work, integration: Any, ud: np.ndarray, h: float):
    """Note in the clock when a pivot of the elimination vanishes, s, infinity: not in a few steps of h.

    ud (n,) are the accelerations at z, whose factors are at hand; jacobian and factors are not those of z
    afterwards.
    """
    clock, rank = integration.clock[0], work.rank[0]
    way = _expected(clock, work)
    copy(work.diagonal[:rank], work.pivots)
    clock["pivot_order"], clock["pivot_time"] = work.quality[0], clock["t"]
    clock["singular"] = math.inf
    if rank > 0 and way < LOOK * h:
        way = _way(system, work, integration, ud, way if way > 0.0 else h, LOOK * h)
        if way < LOOK * h:
            clock["singular"] = clock["t"] + way


@kernel
def _expected(clock: np.void, work: Work):
    """Time until a pivot vanishes as it has declined since it was looked at; 0 where that is not known."""
    since, least = clock["t"] - clock["pivot_time"], 1.0
    if clock["pivot_order"] != work.quality[0] or not since > 0.0:
        return 0.0
    for k in range(work.rank[0]):
        least = min(least, work.diagonal[k] / work.pivots[k])
    return since * max(least, 0.0) / (1.0 - least) if least < 1.0 else math.inf


@kernel
def _way(system: System, work: Work, integration: Any, ud: np.ndarray, first: float, longest: float):
    """Time from t until the pivot that declines most vanishes, by secants; infinity where none is found."""
    before, at_before, way, pivot = 0.0, 1.0, first, -1
    for _ in range(MOST_SECANTS):
        _factorise_ahead(system, work, integration, ud, way)
        if pivot < 0:
            pivot = most_declined(work)
        at_way = work.diagonal[pivot] / work.pivots[pivot]
        if at_way == at_before:
            return math.inf
        crossing = way - at_way * (way - before) / (at_way - at_before)
        if not 0.0 < crossing < OVER * longest:
            return math.inf
        if abs(crossing - way) < FOUND * crossing:
            return crossing
        before, at_before, way = way, at_way, crossing
    return math.inf


@kernel
def most_declined(work: Work):
    """The pivot that is least of what it was."""
    index, least = 0, math.inf
    for k in range(work.rank[0]):
        share = work.diagonal[k] / work.pivots[k]
        if share < least:
            index, least = k, share
    return index


@allocating
def _factorise_ahead(system: System, work: Work, integration: Any, ud: np.ndarray, way: float):
    """Factors where the motion leads in the time `way` with accelerations that stay."""
    z, bodies, n = integration.z, system.masses.shape[0], system.speed_scale.shape[0]
    q, u = z[: n + bodies], z[n + bodies : 2 * n + bodies]
    place, mean, rates = q.copy(), u.copy(), q.copy()
    for k in range(u.shape[0]):
        mean[k] += 0.5 * way * ud[k]
    coordinate_rates(bodies, q, mean, rates)
    for i in range(q.shape[0]):
        place[i] += way * rates[i]
    normalise(bodies, place)
    evaluate_jacobian(system, work, place)
    factorise_order(work)


@kernel
def blur(work: Work, tolerance: float):
    """Return how many times a tolerance round-off may be near the state, at least 1."""
    return max(1.0, round_off(work) / tolerance)


@kernel
def round_off(work: Work):
    """Return the round-off of speeds at the state, of their size; 0 where there are no constraints."""
    least = math.inf
    for k in range(work.rank[0]):
        least = min(least, abs(work.pivots[k]))
    return SPEED_ROUND_OFF / (least * least) if least > 0.0 else 0.0
