"""The clock of an integration, the same for every method, and the codes that integrators return."""

import math

import numpy as np

from .._jit import kernel

# Tasks: start at the state z, or integrate on to the report times.
BEGIN, INTEGRATION = 0, 1
# Return codes: ready for steps; all rows filled; at the stop; evaluations of this call used up; no step of
# any length; steps so short that the caller must agree; equations that repeated others contradict them;
# coordinates without inertia.
READY, ROWS_FULL, AT_STOP, PAUSED, STEP_VANISHED, STEP_SHORT, CONTRADICTION, NO_INERTIA = range(8)

LOOK = 3.5  # steps: how far ahead of the state singular positions are sought
CLOSER = 1.15  # of the share of a step in front of the position: still far from its stages
SMALLEST_STEP = 1e-14  # of the time, or of a millisecond

REPEATED_GAP = 1e-7  # what equations that repeat others may be off, scaled

CLOCK = np.dtype(
    [
        ("t", np.float64),  # time of the state, s
        ("step", np.float64),  # length the next step will try, s
        ("length", np.float64),  # length of the step that is tried, s
        ("stop", np.float64),  # landing point: no step goes further, s
        ("next", np.float64),  # time of the next report row, s
        ("step_start", np.float64),  # start of the last accepted step, s
        ("step_length", np.float64),  # its length, s, 0 before the first
        ("step_tried", np.float64),  # its length before a contact cut it, s: a step made again begins with it
        ("step_rejected", np.int64),  # `rejected` when it was tried
        ("rejected", np.int64),  # failed attempts before the one that is tried; explicit methods: 0 or 1
        ("longest", np.float64),  # accepted step so far, s; 0: short steps need no agreement
        ("short_step_allowed", np.int64),  # whether the caller agrees to short steps
        ("row", np.int64),  # report rows filled in this call
        ("steps", np.int64),  # accepted steps since the start
        ("evaluations", np.int64),  # evaluations of the equations since the start
        ("rejections", np.int64),  # failed attempts since the start
        ("stiff", np.int64),  # accepted steps of those looked at that lie at the limit of stability
        ("rtol", np.float64),  # relative tolerance
        ("atol", np.float64),  # absolute tolerance, of units of the state
        ("counted", np.int64),  # components of the state whose errors count; works of loads follow
        ("error", np.float64),  # error of the step that is tried, in tolerances
        ("worst", np.int64),  # place in the state of its largest component
        ("projection_too_large", np.int64),  # whether the projection moved the last attempt too far
        ("fault", np.int64),  # code of the last failed evaluation, or that of a solved one
        ("gap", np.float64),  # largest gap of the equations at the state, scaled, or m
        ("equation", np.int64),  # equation with that gap
        ("repeated", np.float64),  # what equations that repeat others may be off, scaled
        ("pivot_order", np.float64),  # quality of the order of elimination at the last end of a step, no unit
        ("pivot_time", np.float64),  # time of that end, s
        ("firmest", np.float64),  # largest that the smallest scaled pivot was at the end of a step
        ("singular", np.float64),  # time of the singular position ahead, s, infinity: none near
    ]
)


def new_clock(counted: int = 0) -> np.ndarray:
    """Return a clock (1,) of CLOCK at time 0, without a stop and without a singular position ahead.

    `counted` components of the state have errors that count.
    """
    clock = np.zeros(1, CLOCK)
    clock["counted"], clock["repeated"] = counted, REPEATED_GAP
    clock["stop"] = clock["next"] = clock["singular"] = np.inf
    return clock


@kernel
def step_before_singularity(clock: np.void, h: float, share: float):
    """Length of the next step, at most a little longer than h, for a step over the position ahead that has
    it at this share of its length."""
    way = clock["singular"] - clock["t"]
    if not 0.0 < way < LOOK * h:
        return h
    if way <= share * h:
        return way / share
    if way <= CLOSER * share * h:
        return h
    return way / (math.ceil(way / h - share) + share)


@kernel
def crosses_singularity(clock: np.void, h: float):
    """Return whether a step of length h leads over the singular position ahead."""
    return 0.0 < clock["singular"] - clock["t"] < h
