"""Implicit stepping of a tree in compiled code: SDIRK4 with the stiff part of the equations in its matrix.

Hairer and Wanner, Solving Ordinary Differential Equations II, section IV.6: the L-stable singly
diagonally implicit method of order 4 in five stages, gamma = 1/4, with an embedded one of order 3.
All stages share one matrix, b + gamma h D + (gamma h)² K; it is kept while the step length is, and b
as long as the iterations converge.  Closed loops are kept closed in the rates by the equations
themselves, and in the coordinates at the end of every step (`stiff_projection`).

The state is that of `tree_motion`: its speeds are iterated, coordinates follow from them, and Euler
parameters and the applied work are those of the last evaluation.
"""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from .._jit import kernel
from ..linalg.number_rows import copy
from ..linalg.profile_ldl import set_profile_times
from ..signals import take_known
from ..tree.implicit_matrix import Stiff, factorise, renew, set_mass_times, solve_stiff, stiff_work
from ..tree.kane import SOLVED
from ..tree.motion import derivative, normalise_attitudes
from ..tree.report import Report as TreeReport
from ..tree.stiff_projection import project_stiffly
from .clock import READY
from .dop853 import reject
from .error_norm import CAUTION, ITERATED, SLOWEST, projection_too_large, tolerance
from .hermite import cubic, quintic
from .time_loop import Method, time_loop
from .tree_dop853 import contacts_of_tree, observe_trial

if TYPE_CHECKING:
    from ...model.arrays.tree import TreeArrays


SLOW_CONTRACTION = 0.2  # contraction at which b is renewed for the next step
KEPT = 1.3  # a growth up to this factor is not worth a new matrix
SAFETY, FASTEST = 0.85, 5.0

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

MEMORY = np.dtype(
    [
        ("matrix_length", np.float64),  # step length of the matrix, s, 0 for none
        ("fresh", np.int64),  # whether b is that of the present state
        ("stale", np.int64),  # whether b is to be renewed before the next step
        ("contraction", np.float64),  # ratio of two corrections, the worst of the present step
        ("left", np.float64),  # error that an iteration leaves, as a share of its size, seen last
    ]
)


class Implicit(NamedTuple):
    """State of an integration between calls, for states of n numbers, NS of them speeds.

    States are in m, rad, m/s, rad/s and, the work, J; slopes in these a second.
    """

    clock: np.ndarray  # one record of CLOCK
    z: np.ndarray  # (n,) state at the time t, units as above
    memory: np.ndarray  # one record of MEMORY
    slopes: np.ndarray  # (5, n) slopes of the stages, units a second
    before: np.ndarray  # (n,) slope at the start of the step, units a second
    known: np.ndarray  # (n,) state of a stage without its own slope, units as above
    trial: np.ndarray  # (n,) state whose slope is evaluated, units as above
    rate: np.ndarray  # (n,) slope at `trial`, units a second
    old: np.ndarray  # (n,) state at the start of the last step, units as above
    old_slope: np.ndarray  # (n,) and its slope, units a second
    change: np.ndarray  # (NS,) of the speeds' slopes by an iteration, units as above a second
    product: np.ndarray  # (NS,) slopes missing in an iteration, or efforts, units as above a second
    stiff: Stiff  # the matrix of an iteration


def implicit_work(
    clock: np.ndarray, z: np.ndarray, speeds: int, closures: np.ndarray, elements: int
) -> Implicit:
    """An integration of the state z for (R,) closures; the first step computes b."""
    n = z.size
    memory = np.zeros(1, MEMORY)
    memory["stale"], memory["left"] = 1, 1.0
    states = [np.zeros(n) for _ in range(6)]
    return Implicit(  # type: ignore[call-arg]
        clock,
        z,
        memory,
        np.zeros((STAGES, n)),
        *states,  # type: ignore[arg-type]
        np.zeros(speeds),
        np.zeros(speeds),
        stiff_work(closures, speeds, elements),
    )


@kernel
def _length(s: Implicit, tree: "TreeArrays", work: np.ndarray, coordinates: np.ndarray):
    return min(s.clock[0]["step"], s.clock[0]["stop"] - s.clock[0]["t"])


@kernel
def _attempt(s: Implicit, h: float, tree: "TreeArrays", work: np.ndarray, coordinates: np.ndarray):
    """Find the end of a step of length h; the factor on the next length, or minus that of another try."""
    clock = s.clock[0]
    if not _solve(s, h, tree, work, coordinates):
        return -0.25
    error = clock["error"] = step_error(tree, h, s)
    factor = SAFETY * error**-0.25 if error > 0.0 else FASTEST
    factor = min(FASTEST, max(SLOWEST, factor)) if error < 1e10 else SLOWEST
    return factor if error < 1.0 else -factor


@kernel
def _solve(s: Implicit, h: float, tree: "TreeArrays", work: np.ndarray, coordinates: np.ndarray) -> bool:
    """Solve the stages of a step of length h, anew with a new matrix where an older one does not serve."""
    memory = s.memory[0]
    for _ in range(2):
        if not prepare_matrix(tree, work, coordinates, h, s):
            return False
        if solve_stages(tree, work, coordinates, h, s):
            return True
        memory["stale"] = 1
        if memory["fresh"] != 0:
            break
    return False


@kernel
def _accept(s: Implicit, factor: float, tree: "TreeArrays", work: np.ndarray, coordinates: np.ndarray):
    """Make the end of a step the state, and close its loops; a code."""
    clock, z, h = s.clock[0], s.z, s.clock[0]["length"]
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
    clock["steps"] += 1
    memory = s.memory[0]
    memory["fresh"] = 0
    memory["stale"] = 1 if memory["contraction"] > SLOW_CONTRACTION else 0
    if not last and not 1.0 <= factor < KEPT:
        clock["step"] = h * factor
    if tree.closures.shape[0] > 0:
        _close_loops(tree, work, coordinates, h, s)
    return READY


@kernel
def _close_loops(
    tree: "TreeArrays", work: np.ndarray, coordinates: np.ndarray, h: float, s: Implicit
) -> None:
    """Close the loops at the end of a step; the step is taken back where that moves it too far."""
    clock, z = s.clock[0], s.z
    copy(z, s.trial)
    project_stiffly(tree, work, coordinates, z, s.stiff)
    place = projection_too_large(s.trial, z, clock)
    if place < 0:
        return
    clock["t"], clock["step"] = clock["step_start"], h / 4.0
    clock["worst"], clock["rejected"], clock["projection_too_large"] = place, 1, 1
    clock["rejections"] += 1
    clock["steps"] -= 1
    copy(s.old, z)
    copy(s.old_slope, s.before)
    s.memory[0]["stale"] = 1


@kernel
def _fill_row(
    s: Implicit, t: float, report: TreeReport, tree: "TreeArrays", work: np.ndarray, coordinates: np.ndarray
):
    """Fill a report row at a time up to the present one; a code."""
    clock = s.clock[0]
    copy(s.z, s.trial)
    if t > clock["step_start"]:
        h = clock["step_length"]
        between((t - clock["step_start"]) / h, h, s, s.trial)
    return observe_trial(s, s.rate, t, report, tree, work, coordinates)


_advance = time_loop(Method(_length, _attempt, _accept, reject, _fill_row, contacts_of_tree))


@kernel
def integrate_rows(
    tree: "TreeArrays",
    work: np.ndarray,
    coordinates: np.ndarray,
    integration: Implicit,
    report: TreeReport,
    budget: int,
):
    """Fill the rows of `report`, at most `budget` evaluations and the rest of a step; a code.

    `integration.before` holds the slope at z.
    """
    return _advance(integration, report, budget, tree, work, coordinates)


@kernel
def between(x: float, h: float, s: Implicit, out: np.ndarray) -> None:
    """State at the fraction x of the last step, which ended at z.

    Coordinates by Hermite's quintic through coordinates, speeds and accelerations at both ends, speeds
    as its derivative, the rest by Hermite's cubic.
    """
    z, speeds = s.z, s.change.shape[0]
    for i in range(2 * speeds, z.shape[0]):
        out[i] = cubic(x, s.old[i], z[i], h * s.old_slope[i], h * s.before[i])
    for m in range(speeds):
        out[speeds + m], out[m] = quintic(
            x,
            s.old[speeds + m],
            z[speeds + m],
            h * s.old[m],
            h * z[m],
            h * h * s.old_slope[m],
            h * h * s.before[m],
        )
        out[m] /= h


@kernel
def prepare_matrix(tree: "TreeArrays", work: np.ndarray, coordinates: np.ndarray, h: float, s: Implicit):
    """Renew b where it is stale and the factors where b or the step length is another one."""
    memory = s.memory[0]
    if memory["stale"] != 0:
        renew(tree, work, coordinates, s.z, s.stiff)
        memory["stale"], memory["fresh"], memory["matrix_length"], memory["left"] = 0, 1, 0.0, 1.0
    if memory["matrix_length"] == h:
        return True
    memory["matrix_length"] = h
    return factorise(tree, DIAGONAL * h, s.stiff)


@kernel
def solve_stages(tree: "TreeArrays", work: np.ndarray, coordinates: np.ndarray, h: float, s: Implicit):
    """Slopes of all stages; s.trial is the state of the last one.  False when an iteration fails."""
    s.memory[0]["contraction"] = 0.0
    for stage in range(STAGES):
        for i in range(s.z.shape[0]):
            total = 0.0
            for j in range(stage):
                total += WEIGHTS[stage, j] * s.slopes[j, i]
            s.known[i] = s.z[i] + h * total
            s.slopes[stage, i] = s.before[i] if stage == 0 else s.slopes[stage - 1, i]
        if not _solve_stage(tree, work, coordinates, stage, h, s):
            return False
    return True


@kernel
def _solve_stage(
    tree: "TreeArrays", work: np.ndarray, coordinates: np.ndarray, stage: int, h: float, s: Implicit
):
    """Iterate the slope of one stage."""
    clock, memory, slope = s.clock[0], s.memory[0], s.slopes[stage]
    t = clock["t"] + TIMES[stage] * h
    # A first iteration is trusted somewhat less than those before it were.
    left, last = memory["left"] ** CAUTION, 0.0
    for iteration in range(MOST_ITERATIONS):
        _place_trial(h, slope, s)
        clock["evaluations"] += 1
        take_known(tree.signals, s.known, 2 * s.change.shape[0] + 4 * tree.balls, DIAGONAL * h)
        clock["fault"] = derivative(tree, work, coordinates, t, s.trial, s.rate)
        tree.signals.ahead[0] = 0.0
        if clock["fault"] != SOLVED:
            return False
        size = _correct(tree, h, slope, s)
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
def _place_trial(h: float, slope: np.ndarray, s: Implicit) -> None:
    """Speeds from their slopes, coordinates from the speeds, the rest as it is."""
    speeds = s.change.shape[0]
    for i in range(slope.shape[0]):
        if speeds <= i < 2 * speeds:
            slope[i] = s.trial[i - speeds]
        s.trial[i] = s.known[i] + DIAGONAL * h * slope[i]


@kernel
def _correct(tree: "TreeArrays", h: float, slope: np.ndarray, s: Implicit):
    """Newton's correction of the slopes, and its size against the tolerance."""
    clock, speeds = s.clock[0], s.change.shape[0]
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
def step_error(tree: "TreeArrays", h: float, s: Implicit):
    """Error of the step against the tolerance, what the matrix calls stiff taken out."""
    clock, z, speeds = s.clock[0], s.z, s.change.shape[0]
    last = clock["counted"]
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
