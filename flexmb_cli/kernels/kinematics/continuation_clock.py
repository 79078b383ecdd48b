"""Clock of the continuation of a kinematic analysis: lengths of steps, and which are taken."""

import numpy as np

from .._jit import kernel

ROOM_TO_GROW = 1.0 / 64.0  # twice the step makes the defect 32 times as large
WHOLE = 1e-6  # the clock rounds the length of a step
SMALLEST_PART = 2.0**-26  # of the last step that went well: below, the way is barred
CLOCK_ROUND_OFF = 2e-15  # of the time: shorter steps do not move the clock
# Scaled way within which det Φ_q may change its sign: shorter ones come so near to the bifurcation that
# round-off hides which curve is smooth.
BIFURCATION_LENGTH = 1e-4
# Places in `clock`: time reached, step to try (0: assemble first), sign of det Φ_q, last step taken,
# attempts left before control returns to the caller, iterations spent on the row so far.
TIME, NEXT_LENGTH, SIGN, LAST_LENGTH, BUDGET, SPENT = 0, 1, 2, 3, 4, 5
CLOCK_SIZE = 6


@kernel
def step_to(clock: np.ndarray, target: float) -> float:
    """Return the end of the step to try next: the target, or a point at most halfway to it."""
    left = target - clock[TIME]
    return target if clock[NEXT_LENGTH] >= left else clock[TIME] + min(clock[NEXT_LENGTH], 0.5 * left)


@kernel
def acceptable(clock: np.ndarray, off: float, moved: float, sign: int) -> bool:
    """Return whether a step may be taken: on one smooth curve, and with det Φ_q of one sign.

    The ways of assembling a mechanism are separated by positions at which det Φ_q is zero.  Where two
    of them come close, the other can look smoother than the true one; the sign distinguishes them.  A
    sign that changes on a way too short for a narrow pass to hide in is a true bifurcation.
    """
    if clock[NEXT_LENGTH] == 0.0:
        return off < np.inf
    if off > 1.0:
        return False
    return sign == clock[SIGN] or moved <= BIFURCATION_LENGTH


@kernel
def after_success(clock: np.ndarray, t_new: float, off: float, sign: int) -> None:
    """Move the clock; a step taken whole and with room to spare may be doubled, the first one is free."""
    h = t_new - clock[TIME]
    if clock[NEXT_LENGTH] == 0.0:
        clock[NEXT_LENGTH] = np.inf
    elif h >= (1.0 - WHOLE) * clock[NEXT_LENGTH] and off <= ROOM_TO_GROW:
        clock[NEXT_LENGTH] = 2.0 * h
    if h > 0.0:
        clock[LAST_LENGTH] = h
    clock[TIME] = t_new
    clock[SIGN] = sign


@kernel
def is_barred(clock: np.ndarray, target: float) -> bool:
    """Return whether the next step is too short to be worth a try."""
    tick = CLOCK_ROUND_OFF * max(abs(clock[TIME]), abs(target))
    return clock[NEXT_LENGTH] <= max(SMALLEST_PART * clock[LAST_LENGTH], tick)
