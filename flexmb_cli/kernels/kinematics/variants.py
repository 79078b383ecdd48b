"""Kinematics of mechanisms that differ in the functions of their drivers only, one after the other.

One call solves them all: for a small mechanism it takes as long to call a kernel as to solve a report row.
"""

import numpy as np

from .._jit import allocating
from .continuation import BUDGET, CLOCK_SIZE, POSITION, SIGN, TIME, follow
from .newton import System


@allocating
def follow_variants(
    system: System,
    driven: np.ndarray,
    functions: np.ndarray,
    q: np.ndarray,
    screw_angles: np.ndarray,
    attempts: float,
    times: np.ndarray,
    out: np.ndarray,
    audit: np.ndarray,
    smooth: np.ndarray,
) -> None:
    """Report rows at `times` (rows,) for each of `functions` (cases, drivers, 3), which go into `system`.

    They are C, B, A of the constraints numbered `driven` (drivers,).  Every case is assembled from the
    estimates q (n,) and screw_angles (screws,), rad, and carried on in at most `attempts` steps, by `follow`.
    out (cases, rows, 3, n) and audit (cases, rows, 3): as those of `follow`.  smooth (cases,): whether all
    rows were reached, and det Φ_q had the sign of the first row at the last.
    """
    state, motion = np.zeros((3, q.size)), np.zeros((screw_angles.size, 3))
    clock = np.zeros(CLOCK_SIZE)
    for case in range(functions.shape[0]):
        for k in range(driven.size):
            driver = system.constraints[driven[k]]
            function = functions[case, k]
            driver["C"], driver["B"], driver["A"] = function[0], function[1], function[2]
        state[:], motion[:], clock[:] = 0.0, 0.0, 0.0
        for k in range(q.size):
            state[POSITION, k] = q[k]
        for k in range(screw_angles.size):
            motion[k, 0] = screw_angles[k]
        clock[TIME], clock[BUDGET] = times[0], attempts
        reached = follow(system, state, motion, clock, times[:1], out[case, :1], audit[case, :1])
        sign = clock[SIGN]
        if reached == 1:
            clock[BUDGET] = attempts
            reached += follow(system, state, motion, clock, times[1:], out[case, 1:], audit[case, 1:])
        smooth[case] = reached == times.size and clock[SIGN] == sign
