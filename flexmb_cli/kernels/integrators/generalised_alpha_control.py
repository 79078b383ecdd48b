"""Lengths of the steps of the generalised-α method that keep the tolerance at the end of a run.

Errors of a method of order two add up, so that a step of length h may err by the share h/T of the tolerance
in a run of length T.  Near a singular position round-off of speeds grows with the inverse square of the way
to it: the longest step that is exact enough leads over the position, and no other comes near.
"""

import math
from typing import TYPE_CHECKING, Any

from .._jit import kernel
from ..linalg.rank_revealing_lu import smallest_pivot
from .clock import LOOK, leads_over
from .constrained_equations import firm_pivot
from .error_norm import ITERATED, SLOWEST
from .singular_ahead import NOISE, SPEED_ROUND_OFF, blur, look_ahead, round_off

if TYPE_CHECKING:
    import numpy as np

    from ..constrained.system import System, Work


SAFETY, FASTEST = 0.85, 3.0
SHARE_BEFORE = 0.5  # of the step over a singular position that lies in front of it
SHORTEST_BEFORE = 0.15  # of a step before that one: it is left out
# After a step over the singular position that was not good enough: so short that a step before it is not left
# out, for which it must be below 1 / (1 + SHORTEST_BEFORE / SHARE_BEFORE); else it would be tried for ever.
SHORTENED = 0.75
MOST_PASSING = 30.0  # steps, that the one over a singular position may be long
SAME_TIME_IN_STEP = 1e-9  # of a step: times this near to each other are one
OF_ERROR = 1e-6  # of the step's error: what the iterations may leave in a step of given length
ITERATED_BLURRED = 0.3  # of the tolerance: what the iterations may leave where that is all round-off
LEAST_PASSING = 0.1  # of a given step: way over a singular position on which none ends, 5 times what is FOUND
FAR_PIVOT = 5.0  # of one that is firm: where the smallest is above, given steps alone fix how far to look
PASSED_ON = 1.0  # error at the end of a run, in tolerances, if errors of steps only added up
PASSING = 0.005  # of the tolerance: error of a step over a singular position, of which a run has a few


@kernel
def share_of(clock: "np.void", memory: "np.void", work: "Work", h: float, fastest: float) -> float:
    """The share of the tolerance that a step of length h may err by, all of it where lengths are given.

    The few steps over singular positions have a share of their own.  No share is below what the round-off
    of speeds makes of the accelerations, which change them at the rate `fastest`, 1/s.
    """
    if memory["fixed"] > 0.0:
        return 1.0
    share = min(1.0, PASSED_ON * h / memory["span"])
    if leads_over(clock, h):
        share = max(share, PASSING)
    noise = NOISE * round_off(work)
    # Within the least pivot's way to zero, speeds change as much as that pivot does.
    change = h * fastest * (round_off(work) / SPEED_ROUND_OFF) ** 0.5
    return max(share, noise * min(1.0, change) / clock["rtol"])


@kernel
def left_over(clock: "np.void", memory: "np.void", work: "Work", share: float) -> float:
    """Return what iterations may leave of a step's share: steps of given length have their own error."""
    if memory["fixed"] > 0.0:
        return OF_ERROR * clock["error"]
    blurred = blur(work, share * clock["rtol"])
    return share * (ITERATED if blurred == 1.0 else ITERATED_BLURRED * blurred)


@kernel
def next_length(clock: "np.void", memory: "np.void") -> float:
    """Length of the next step: steps of given length end at whole multiples."""
    left = clock["stop"] - clock["t"]
    if memory["fixed"] > 0.0:
        multiples = _given_steps(clock, memory)
        left = min(left, memory["start"] + (memory["whole"] + multiples) * memory["fixed"] - clock["t"])
        step = left if multiples > 1 and not clock["rejected"] else clock["step"]
    else:
        step = _laid_out(clock, memory)
    return step if abs(step - left) <= SAME_TIME_IN_STEP * left else min(step, left)


@kernel
def look_ahead_of_given(system: "System", work: "Work", integration: Any, ud: "np.ndarray") -> None:
    """Note a singular position ahead of given steps, and the way over it on which round-off may rule a row.

    ud (n,): accelerations at the state, whose factors are at hand.
    """
    clock, memory = integration.clock[0], integration.memory[0]
    least, firm = smallest_pivot(work.diagonal, work.rank[0]), firm_pivot(clock)
    reach = memory["fixed"] if least > FAR_PIVOT * firm else math.inf
    look_ahead(system, work, integration, ud, reach)
    memory["passing"] = LEAST_PASSING * memory["fixed"]
    if math.isfinite(clock["singular"]):
        # Pivots vanish as the way does.
        memory["passing"] += 2.0 * (clock["singular"] - clock["t"]) * firm / least


@kernel
def _given_steps(clock: "np.void", memory: "np.void") -> int:
    """Return how many steps of given length are made in one: none ends near a singular position."""
    way = clock["singular"] - clock["t"]
    begin, end = way - 0.5 * memory["passing"], way + 0.5 * memory["passing"]
    rest = memory["start"] + (memory["whole"] + 1) * memory["fixed"] - clock["t"]
    if not (way > 0.0 and begin < rest < end):
        return 1
    return 1 + math.ceil((end - rest) / memory["fixed"])


@kernel
def _laid_out(clock: "np.void", memory: "np.void") -> float:
    """Length of a step so that one of the length `passing` leads over the singular position ahead.

    Round-off of speeds grows towards that position, so that the longest step that is exact enough leads
    over it; those before it are equal.
    """
    step, way = clock["step"], clock["singular"] - clock["t"]
    before = way - SHARE_BEFORE * memory["passing"]
    if not (0.0 < way < LOOK * memory["passing"] and before < LOOK * step):
        return step
    if before <= SHORTEST_BEFORE * step:
        return way / SHARE_BEFORE
    return before / math.ceil(before / step)


@kernel
def retreat(clock: "np.void", memory: "np.void", tried: float, h: float) -> None:
    """After a step of length `tried` that was not found, or not well enough: one of length h."""
    over = leads_over(clock, tried)
    if over:
        h = min(h, SHORTENED * tried)
    clock["step"] = min(clock["step"], h)
    # A stop in front of the position cuts off the step over it, which would be laid out and cut off again.
    if over or not next_length(clock, memory) < tried:
        memory["passing"] = h
    clock["rejections"] += 1
    clock["rejected"] = 1
    memory["left"] = 1.0


@kernel
def factor_of(clock: "np.void", memory: "np.void") -> float:
    """Length of the next step by that of the one behind, whose error is known."""
    factor = SAFETY * clock["error"] ** -0.5 if clock["error"] > 0.0 else FASTEST
    if memory["turned"] > 0.0:
        factor = min(factor, SAFETY / memory["turned"])
    return min(1.0 if clock["rejected"] else FASTEST, max(SLOWEST, factor))


@kernel
def advance(clock: "np.void", memory: "np.void", h: float) -> None:
    """The time of the state, and the length of the next step."""
    clock["step_start"], clock["step_length"] = clock["t"], h
    t, same = clock["t"] + h, SAME_TIME_IN_STEP * h
    if memory["fixed"] > 0.0:
        multiple = round((t - memory["start"]) / memory["fixed"])
        whole = memory["start"] + multiple * memory["fixed"]
        if abs(whole - t) <= same:
            t = whole
            memory["whole"] = multiple
        clock["step"] = memory["fixed"]
    elif not leads_over(clock, h):
        clock["step"] = h * factor_of(clock, memory)
        memory["passing"] = max(clock["step"], _passing_step(clock, memory, h))
    clock["t"] = clock["stop"] if abs(clock["stop"] - t) <= same else t
    clock["rejected"] = 0
    clock["steps"] += 1


@kernel
def _passing_step(clock: "np.void", memory: "np.void", h: float) -> float:
    """Length of a step whose error is what one over a singular position may have, after one of length h."""
    error = clock["error"] * memory["share"]
    longest = MOST_PASSING * clock["step"]
    return min(longest, SAFETY * h * (PASSING / error) ** (1.0 / 3.0)) if error > 0.0 else longest
