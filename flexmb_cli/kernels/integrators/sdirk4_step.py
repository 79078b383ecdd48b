"""One step of SDIRK4 for a tree: its matrix, the iterations of its stages, its error.

Hairer and Wanner, Solving Ordinary Differential Equations II, section IV.6.
"""

from typing import TYPE_CHECKING

import numpy as np

from .._jit import kernel
from ..linalg.profile_ldl import set_profile_times
from ..tree.implicit_matrix import factorise, renew, set_mass_times, solve_stiff
from ..tree.kane import SOLVED
from ..tree.motion import derivative
from .error_norm import CAUTION, ITERATED, tolerance

if TYPE_CHECKING:
    from ...model.arrays.tree import TreeArrays
    from .sdirk4 import Implicit

STAGES, DIAGONAL = 5, 0.25
TIMES = np.array([1 / 4, 3 / 4, 11 / 20, 1 / 2, 1.0])
WEIGHTS = np.array(
    [
        [1 / 4, 0.0, 0.0, 0.0, 0.0],
        [1 / 2, 1 / 4, 0.0, 0.0, 0.0],
        [17 / 50, -1 / 25, 1 / 4, 0.0, 0.0],
        [371 / 1360, -137 / 2720, 15 / 544, 1 / 4, 0.0],
        [25 / 24, -49 / 48, 125 / 16, -85 / 12, 1 / 4],
    ]
)
# Weights of the last stage, which is the step, less those of the embedded method.
ERROR = np.array([-3 / 16, -27 / 32, 25 / 32, 0.0, 1 / 4])

MOST_ITERATIONS = 8
LEAST = 1e-3  # contraction that is trusted: a smaller one may be round-off


@kernel
def prepare_matrix(
    tree: "TreeArrays", work: np.ndarray, coordinates: np.ndarray, z: np.ndarray, h: float, s: "Implicit"
):
    """Renew b where it is stale and the factors where b or the step length is another one."""
    memory = s.memory[0]
    if memory["stale"] != 0:
        renew(tree, work, coordinates, z, s.stiff)
        memory["stale"], memory["fresh"], memory["matrix_length"], memory["left"] = 0, 1, 0.0, 1.0
    if memory["matrix_length"] == h:
        return True
    memory["matrix_length"] = h
    return factorise(tree, DIAGONAL * h, s.stiff)


@kernel
def solve_stages(
    tree: "TreeArrays",
    work: np.ndarray,
    coordinates: np.ndarray,
    clock: np.void,
    z: np.ndarray,
    h: float,
    s: "Implicit",
):
    """Slopes of all stages; s.trial is the state of the last one.  False when an iteration fails."""
    n = z.shape[0]
    s.memory[0]["contraction"] = 0.0
    for stage in range(STAGES):
        for i in range(n):
            total = 0.0
            for j in range(stage):
                total += WEIGHTS[stage, j] * s.slopes[j, i]
            s.known[i] = z[i] + h * total
            s.slopes[stage, i] = s.before[i] if stage == 0 else s.slopes[stage - 1, i]
        if not _solve_stage(
            tree, work, coordinates, clock, clock["t"] + TIMES[stage] * h, h, s.slopes[stage], s
        ):
            return False
    return True


@kernel
def _solve_stage(
    tree: "TreeArrays",
    work: np.ndarray,
    coordinates: np.ndarray,
    clock: np.void,
    t: float,
    h: float,
    slope: np.ndarray,
    s: "Implicit",
):
    """Iterate the slope of one stage."""
    memory = s.memory[0]
    # A first iteration is trusted somewhat less than those before it were.
    left, last = memory["left"] ** CAUTION, 0.0
    for iteration in range(MOST_ITERATIONS):
        _place_trial(h, slope, s)
        clock["evaluations"] += 1
        clock["fault"] = derivative(tree, work, coordinates, t, s.trial, s.rate)
        if clock["fault"] != SOLVED:
            return False
        size = _correct(tree, clock, h, slope, s)
        if iteration > 0:
            contraction = size / last if last > 0.0 else 0.0
            if not contraction < 1.0:
                return False
            memory["contraction"] = max(memory["contraction"], contraction)
            left = memory["left"] = max(contraction / (1.0 - contraction), LEAST)
        if left * size < ITERATED:
            break
        last = size
        if iteration == MOST_ITERATIONS - 1:
            return False
    _place_trial(h, slope, s)
    return True


@kernel
def _place_trial(h: float, slope: np.ndarray, s: "Implicit") -> None:
    """Speeds from their slopes, coordinates from the speeds, the rest as it is."""
    speeds = s.change.shape[0]
    for i in range(slope.shape[0]):
        if speeds <= i < 2 * speeds:
            slope[i] = s.trial[i - speeds]
        s.trial[i] = s.known[i] + DIAGONAL * h * slope[i]


@kernel
def _correct(tree: "TreeArrays", clock: np.void, h: float, slope: np.ndarray, s: "Implicit"):
    """Newton's correction of the slopes, and its size against the tolerance."""
    speeds = s.change.shape[0]
    for m in range(speeds):
        s.product[m] = 0.0 if tree.given[m] else s.rate[m] - slope[m]
        if tree.given[m]:
            slope[m] = s.rate[m]
    set_mass_times(tree, s.product, s.stiff, s.change)
    solve_stiff(tree, s.product, s.change, s.stiff)
    total, g = 0.0, DIAGONAL * h
    for m in range(speeds):
        slope[m] += s.change[m]
        total += (g * s.change[m] / tolerance(clock, 1.0, abs(s.trial[m]))) ** 2
        total += (g * g * s.change[m] / tolerance(clock, 1.0, abs(s.trial[speeds + m]))) ** 2
    last = clock["counted"]
    for i in range(2 * speeds, slope.shape[0]):
        if i < last:
            total += (g * (s.rate[i] - slope[i]) / tolerance(clock, 1.0, abs(s.trial[i]))) ** 2
        slope[i] = s.rate[i]
    return (total / last) ** 0.5


@kernel
def step_error(tree: "TreeArrays", clock: np.void, z: np.ndarray, h: float, s: "Implicit"):
    """Error of the step against the tolerance, what the matrix calls stiff taken out."""
    speeds, last = s.change.shape[0], clock["counted"]
    for i in range(z.shape[0]):
        total = 0.0
        for j in range(STAGES):
            total += ERROR[j] * s.slopes[j, i]
        s.rate[i] = h * total
    set_profile_times(s.stiff.stiff, s.stiff.stiff_ends, s.rate[speeds : 2 * speeds], s.product)
    set_mass_times(tree, s.rate[:speeds], s.stiff, s.change)
    for m in range(speeds):
        s.change[m] -= DIAGONAL * h * s.product[m]
        if tree.given[m]:
            s.change[m] = 0.0
    solve_stiff(tree, s.rate[:speeds], s.change, s.stiff)
    for m in range(speeds):
        s.rate[m] = s.change[m]
        s.rate[speeds + m] += DIAGONAL * h * s.change[m]
    total = worst = 0.0
    for i in range(last):
        share = s.rate[i] / tolerance(clock, 1.0, max(abs(z[i]), abs(s.trial[i])))
        total += share * share
        # `not <=` lets a nan through as the worst place.
        if not abs(share) <= worst:
            worst = abs(share)
            clock["worst"] = i
    return (total / last) ** 0.5
