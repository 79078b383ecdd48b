"""The parts of an explicit Runge-Kutta step that do not know what is integrated: DOP853.

Hairer, Nørsett and Wanner, Solving Ordinary Differential Equations I (second edition), sections
II.4-II.6.  The caller evaluates the stages and drives; see `tree_dop853`.
"""

import math

from .._jit import kernel
from .dop853_table import ALL_STAGES, DENSE_TERMS, DENSE_WEIGHTS, ERROR_3, ERROR_5, STAGE_WEIGHTS, STAGES

SAFETY, SLOWEST, FASTEST = 0.9, 0.2, 10.0
ERROR_EXPONENT = -1.0 / 8.0


@kernel
def set_stage(z, slopes, stage, h, out):
    """out = z + h (weights of `stage`) . slopes; slopes (16, n)."""
    for i in range(z.shape[0]):
        out[i] = z[i]
    for j in range(stage):
        weight = h * STAGE_WEIGHTS[stage, j]
        if weight != 0.0:
            for i in range(z.shape[0]):
                out[i] += weight * slopes[j, i]


@kernel
def step_error(z, new, slopes, h, rtol, atol, counted):
    """Error of a step against the tolerance over the first `counted` places: (norm, worst place)."""
    square_5 = square_3 = worst_share = 0.0
    worst = 0
    for i in range(counted):
        scale = atol + rtol * max(abs(z[i]), abs(new[i]))
        e5 = e3 = 0.0
        for j in range(STAGES):
            e5 += ERROR_5[j] * slopes[j, i]
            e3 += ERROR_3[j] * slopes[j, i]
        e5 /= scale
        e3 /= scale
        square_5 += e5 * e5
        square_3 += e3 * e3
        # `not <=` lets a nan through as the worst place.
        if not abs(e5) <= worst_share:
            worst_share = abs(e5)
            worst = i
    if square_5 == 0.0:
        return 0.0, worst
    return abs(h) * square_5 / math.sqrt((square_5 + 0.01 * square_3) * counted), worst


@kernel
def next_factor(error, rejected):
    """Factor on the step length after a step with this error; `rejected`: the step before failed."""
    if error == 0.0:
        return 1.0 if rejected else FASTEST
    factor = SAFETY * error**ERROR_EXPONENT
    highest = 1.0 if rejected or error >= 1.0 else FASTEST
    return min(highest, max(SLOWEST, factor))


@kernel
def set_dense(z, new, slopes, h, dense):
    """Fill dense (7, n), the terms of the interpolating polynomial of the step from z to new."""
    for i in range(z.shape[0]):
        change = new[i] - z[i]
        dense[0, i] = change
        dense[1, i] = h * slopes[0, i] - change
        dense[2, i] = 2.0 * change - h * (slopes[STAGES, i] + slopes[0, i])
        for term in range(3, DENSE_TERMS):
            total = 0.0
            for j in range(ALL_STAGES):
                total += DENSE_WEIGHTS[term - 3, j] * slopes[j, i]
            dense[term, i] = h * total


@kernel
def interpolate(z, dense, x, out):
    """State at the fraction x of the step that began at z."""
    for i in range(z.shape[0]):
        total = 0.0
        for term in range(DENSE_TERMS - 1, -1, -1):
            total = (total + dense[term, i]) * (x if term % 2 == 0 else 1.0 - x)
        out[i] = z[i] + total


@kernel
def scaled_norm(z, a, rtol, atol, counted):
    """Root mean square of the first `counted` places of a, place by place against the tolerance at z."""
    total = 0.0
    for i in range(counted):
        total += (a[i] / (atol + rtol * abs(z[i]))) ** 2
    return (total / counted) ** 0.5
