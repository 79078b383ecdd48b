"""Implicit stepping of a tree in compiled code: SDIRK4 with the stiff part of the equations in its matrix.

Hairer and Wanner, Solving Ordinary Differential Equations II, section IV.6: the L-stable singly
diagonally implicit method of order 4 in five stages, gamma = 1/4, with an embedded one of order 3.
All stages share one matrix, b + gamma h D + (gamma h)² K; it is kept while the step length is, and b
as long as the iterations converge.  Closed loops are kept closed in the rates by the equations
themselves, and in the coordinates at the end of every step (`stiff_projection`).

The state is that of `tree_motion`: its speeds are iterated, coordinates follow from them, and Euler
parameters and the applied work are taken from the last evaluation.
"""

from typing import NamedTuple

import numpy as np

from .._jit import kernel
from ..linalg.profile_ldl import set_profile_times
from ..tree.implicit_matrix import Stiff, factorise, renew, set_mass_times, solve_stiff, stiff_work
from ..tree.kane import SOLVED
from ..tree.motion import derivative, normalise_attitudes
from ..tree.projection import strayed
from ..tree.stiff_projection import project_stiffly

STEPPED, PAUSED, VANISHED, FAULTED = 0, 1, 2, 3

STAGES, GAMMA = 5, 0.25
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
ITERATED = 0.02  # share of the tolerance at which an iteration ends
CAUTION = 0.8
LEAST = 1e-3  # contraction that is trusted: a smaller one may be round-off
SLOW = 0.2  # contraction at which b is renewed for the next step
KEPT = 1.3  # a growth up to this factor is not worth a new matrix
SAFETY, SLOWEST, FASTEST = 0.85, 0.2, 5.0

MEMORY = np.dtype(
    [
        ("length", np.float64),  # step length of the matrix, 0 for none
        ("fresh", np.int64),  # whether b is that of the present state
        ("stale", np.int64),  # whether b is to be renewed before the next step
        ("contraction", np.float64),  # worst of the present step
        ("left", np.float64),  # error that an iteration leaves, as a share of its size, seen last
    ]
)


class Implicit(NamedTuple):
    """Work space for states of n numbers, NS of them speeds."""

    memory: np.ndarray  # one record of MEMORY
    slopes: np.ndarray  # (5, n) of the stages
    before: np.ndarray  # (n,) slope at the start of the step
    known: np.ndarray  # (n,) state of a stage without its own slope
    trial: np.ndarray  # (n,)
    rate: np.ndarray  # (n,) evaluated at `trial`
    old: np.ndarray  # (n,) state at the start of the last step
    old_slope: np.ndarray  # (n,) and its slope
    change: np.ndarray  # (NS,) of the speeds' slopes by an iteration
    product: np.ndarray  # (NS,)
    stiff: Stiff  # the matrix of an iteration


def implicit_work(n: int, speeds: int, closures: np.ndarray) -> Implicit:
    """Blank work space for (R,) closures; the first step computes b."""
    memory = np.zeros(1, MEMORY)
    memory["stale"], memory["left"] = 1, 1.0
    states = [np.zeros(n) for _ in range(6)]
    return Implicit(
        memory,
        np.zeros((STAGES, n)),
        *states,
        np.zeros(speeds),
        np.zeros(speeds),
        stiff_work(closures, speeds),
    )


@kernel
def integrate_implicitly(until, budget, tree, work, coordinates, clocks, z, s):
    """Step the state z from clock["t"] to the first step's end at or after `until`, or to the stop.

    `s.before` holds the slope at z.  Pauses after `budget` evaluations.  The last step began at
    clock["step_start"] from `s.old` with the slope `s.old_slope`.
    """
    clock = clocks[0]
    spent = clock["evaluations"] + budget
    while clock["t"] < until and clock["t"] < clock["stop"]:
        if clock["evaluations"] >= spent:
            return PAUSED
        h = min(clock["step"], clock["stop"] - clock["t"])
        if not h > 1e-15 * max(abs(clock["t"]), 1e-3):
            return FAULTED if clock["fault"] != SOLVED else VANISHED
        if not _prepare_matrix(tree, work, coordinates, z, h, s):
            clock["step"] = h / 4.0
            continue
        if not _solve_stages(tree, work, coordinates, clock, z, h, s):
            _retreat(clock, h, s)
            continue
        error = _step_error(tree, clock, z, h, s)
        factor = SAFETY * error**-0.25 if error > 0.0 else FASTEST
        factor = min(FASTEST, max(SLOWEST, factor)) if error < 1e10 else SLOWEST
        if not error < 1.0:
            clock["rejections"] += 1
            clock["rejected"], clock["strayed"] = 1, 0
            clock["step"] = h * factor
            continue
        _accept(tree, clock, z, h, factor, s)
        if tree.closures.shape[0] > 0:
            _close_loops(tree, work, coordinates, clock, z, h, s)
    return STEPPED


@kernel
def _prepare_matrix(tree, work, coordinates, z, h, s):
    """Renew b where it is stale and the factors where b or the step length is another one."""
    memory = s.memory[0]
    if memory["stale"] != 0:
        renew(tree, work, coordinates, z, s.stiff)
        memory["stale"], memory["fresh"], memory["length"], memory["left"] = 0, 1, 0.0, 1.0
    if memory["length"] == h:
        return True
    memory["length"] = h
    return factorise(tree, GAMMA * h, s.stiff)


@kernel
def _retreat(clock, h, s):
    """After iterations that do not converge: a new matrix, or a shorter step when it is new already."""
    if s.memory[0]["fresh"] != 0:
        clock["step"] = h / 4.0
        clock["rejections"] += 1
        clock["rejected"] = 1
    s.memory[0]["stale"] = 1


@kernel
def _solve_stages(tree, work, coordinates, clock, z, h, s):
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
def _solve_stage(tree, work, coordinates, clock, t, h, slope, s):
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
def _place_trial(h, slope, s):
    """Speeds from their slopes, coordinates from the speeds, the rest as it is."""
    speeds = s.change.shape[0]
    for i in range(slope.shape[0]):
        if speeds <= i < 2 * speeds:
            slope[i] = s.trial[i - speeds]
        s.trial[i] = s.known[i] + GAMMA * h * slope[i]


@kernel
def _correct(tree, clock, h, slope, s):
    """Newton's correction of the slopes, and its size against the tolerance."""
    speeds = s.change.shape[0]
    for m in range(speeds):
        s.product[m] = 0.0 if tree.given[m] else s.rate[m] - slope[m]
        if tree.given[m]:
            slope[m] = s.rate[m]
    set_mass_times(tree, s.product, s.stiff, s.change)
    solve_stiff(tree, s.product, s.change, s.stiff)
    total, g = 0.0, GAMMA * h
    for m in range(speeds):
        slope[m] += s.change[m]
        total += (g * s.change[m] / _scale(clock, s.trial[m])) ** 2
        total += (g * g * s.change[m] / _scale(clock, s.trial[speeds + m])) ** 2
    last = slope.shape[0] - 1
    for i in range(2 * speeds, slope.shape[0]):
        if i < last:
            total += (g * (s.rate[i] - slope[i]) / _scale(clock, s.trial[i])) ** 2
        slope[i] = s.rate[i]
    return (total / last) ** 0.5


@kernel
def _scale(clock, value):
    return clock["atol"] + clock["rtol"] * abs(value)


@kernel
def _step_error(tree, clock, z, h, s):
    """Error of the step against the tolerance, what the matrix calls stiff taken out."""
    speeds, last = s.change.shape[0], z.shape[0] - 1
    for i in range(z.shape[0]):
        total = 0.0
        for j in range(STAGES):
            total += ERROR[j] * s.slopes[j, i]
        s.rate[i] = h * total
    set_profile_times(s.stiff.stiff, s.stiff.stiff_ends, s.rate[speeds : 2 * speeds], s.product)
    set_mass_times(tree, s.rate[:speeds], s.stiff, s.change)
    for m in range(speeds):
        s.change[m] -= GAMMA * h * s.product[m]
        if tree.given[m]:
            s.change[m] = 0.0
    solve_stiff(tree, s.rate[:speeds], s.change, s.stiff)
    for m in range(speeds):
        s.rate[m] = s.change[m]
        s.rate[speeds + m] += GAMMA * h * s.change[m]
    total = worst = 0.0
    for i in range(last):
        share = s.rate[i] / (clock["atol"] + clock["rtol"] * max(abs(z[i]), abs(s.trial[i])))
        total += share * share
        # `not <=` lets a nan through as the worst place.
        if not abs(share) <= worst:
            worst = abs(share)
            clock["worst"] = i
    return (total / last) ** 0.5


@kernel
def _accept(tree, clock, z, h, factor, s):
    clock["step_start"], clock["step_length"] = clock["t"], h
    last = h >= clock["stop"] - clock["t"]
    clock["t"] = clock["stop"] if last else clock["t"] + h
    normalise_attitudes(tree, s.trial)
    for i in range(z.shape[0]):
        s.old[i], s.old_slope[i] = z[i], s.before[i]
        z[i], s.before[i] = s.trial[i], s.slopes[STAGES - 1, i]
    if clock["rejected"] != 0:
        factor = min(1.0, factor)
    clock["rejected"] = 0
    memory = s.memory[0]
    memory["fresh"] = 0
    memory["stale"] = 1 if memory["contraction"] > SLOW else 0
    if not last and not 1.0 <= factor < KEPT:
        clock["step"] = h * factor


@kernel
def _close_loops(tree, work, coordinates, clock, z, h, s):
    """Close the loops at the end of a step; the step is taken back where that moves it too far."""
    _copy(z, s.trial)
    project_stiffly(tree, work, coordinates, z, s.stiff)
    place = strayed(s.trial, z, clock)
    if place < 0:
        return
    clock["t"], clock["step"] = clock["step_start"], h / 4.0
    clock["worst"], clock["rejected"], clock["strayed"] = place, 1, 1
    clock["rejections"] += 1
    _copy(s.old, z)
    _copy(s.old_slope, s.before)
    s.memory[0]["stale"] = 1


@kernel
def between(x, h, z, s, out):
    """State at the fraction x of the last step, which ended at z.

    Coordinates by Hermite's quintic through coordinates, speeds and accelerations at both ends, speeds
    as its derivative, the rest by Hermite's cubic.
    """
    speeds = s.change.shape[0]
    for i in range(2 * speeds, z.shape[0]):
        out[i] = _cubic(x, s.old[i], z[i], h * s.old_slope[i], h * s.before[i])
    for m in range(speeds):
        a, b = s.old[speeds + m], z[speeds + m]
        v, w = h * s.old[m], h * z[m]
        p, r = h * h * s.old_slope[m], h * h * s.before[m]
        rest = b - a - v - 0.5 * p
        slope, bend = w - v - p, r - p
        c3 = 10.0 * rest - 4.0 * slope + 0.5 * bend
        c4 = -15.0 * rest + 7.0 * slope - bend
        c5 = 6.0 * rest - 3.0 * slope + 0.5 * bend
        out[speeds + m] = a + x * (v + x * (0.5 * p + x * (c3 + x * (c4 + x * c5))))
        out[m] = (v + x * (p + x * (3.0 * c3 + x * (4.0 * c4 + x * 5.0 * c5)))) / h


@kernel
def _copy(a, b):
    """b = a."""
    for i in range(a.shape[0]):
        b[i] = a[i]


@kernel
def _cubic(x, a, b, da, db):
    change = b - a
    return a + x * (da + x * (3.0 * change - 2.0 * da - db + x * (da + db - 2.0 * change)))
