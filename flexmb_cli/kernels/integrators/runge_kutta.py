"""The parts of an explicit Runge-Kutta step that do not know what is integrated: DOP853.

Hairer, Nørsett and Wanner, Solving Ordinary Differential Equations I (second edition), sections
II.4-II.6.  The caller evaluates the stages: see `dop853`.
"""

from .._jit import kernel
from .dop853_table import ALL_STAGES, DENSE_TERMS, DENSE_WEIGHTS, STAGE_WEIGHTS, STAGES

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
