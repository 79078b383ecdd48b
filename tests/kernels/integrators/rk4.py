"""The classical method of order 4 in steps of given length, for constrained mechanisms.

Hairer, Nørsett and Wanner, Solving Ordinary Differential Equations I (second edition), section II.1,
table 1.2.  The file shows all that an integrator is made of: CONTRIBUTING.md refers to it.
"""

import math

import numpy as np

from flexmb_cli.kernels._jit import kernel
from flexmb_cli.kernels.constrained.angle_unwrapping import expect_angles, unwrap_angles
from flexmb_cli.kernels.integrators.clock import BEGIN, READY, STEP_VANISHED, new_clock
from flexmb_cli.kernels.integrators.constrained_equations import (
    NEAR_SINGULAR,
    code_of_violation,
    fill_near_singular,
    note_violation,
    projected_slope,
    report_trial,
    slope,
)
from flexmb_cli.kernels.integrators.hermite import cubic, cubic_slope
from flexmb_cli.kernels.integrators.integrations import Integration
from flexmb_cli.kernels.integrators.time_loop import Method, time_loop
from flexmb_cli.kernels.linalg.number_rows import copy

STEP = 0.0625  # s, where the deck gives none
SAME = 1e-9  # of a step: what is left to the stop is no step of its own
END = 4  # row of `slopes` of the slope at the end of a step


def new_integration(work, angles, works):
    """An integration at time 0 with an empty state, for the `work` of a mechanism and so many angles.

    The works of the first `works` loads are kept, after the work of all loads.
    """
    counted = 2 * work.motions.shape[0] + work.mass.shape[0]
    n = counted + 1 + works
    states = [np.zeros(n) for _ in range(3)]
    slopes, dense = np.zeros((END + 1, n)), np.zeros((2, n))
    return Integration(new_clock(counted), *states, slopes, dense, np.ones(n), np.zeros((3, angles)))


@kernel
def _length(integration, system, work):
    """Return the length of the next step: the last one takes what round-off left of those before."""
    clock = integration.clock[0]
    left = clock["stop"] - clock["t"]
    return left if left <= (1.0 + SAME) * clock["step"] else clock["step"]


@kernel
def _place(integration, weights, h):
    """Fill `trial`, the state moved by h times the slopes by weights."""
    copy(integration.z, integration.trial)
    for stage in range(4):
        for i in range(integration.z.shape[0]):
            integration.trial[i] += h * weights[stage] * integration.slopes[stage, i]


@kernel
def _attempt(integration, h, system, work):
    clock = integration.clock[0]
    for stage in range(1, 4):
        share = 1.0 if stage == 3 else 0.5
        copy(integration.z, integration.trial)
        for i in range(integration.z.shape[0]):
            integration.trial[i] += h * share * integration.slopes[stage - 1, i]
        if not slope(integration, stage, clock["t"] + share * h, system, work):
            return -0.5
    _place(integration, (1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0), h)
    expect_angles(system, work, integration, h)
    moved = projected_slope(integration, END, clock["t"] + h, system, work)
    return 1.0 if moved < math.inf else -0.5


@kernel
def _accept(integration, factor, system, work):
    clock = integration.clock[0]
    copy(integration.z, integration.old)
    copy(integration.trial, integration.z)
    clock["step_start"], clock["step_length"] = clock["t"], clock["length"]
    last = clock["length"] >= clock["stop"] - clock["t"]
    clock["t"] = clock["stop"] if last else clock["t"] + clock["length"]
    clock["rejected"] = 0
    clock["steps"] += 1
    # dense: slopes at both ends
    copy(integration.slopes[0], integration.dense[0])
    copy(integration.slopes[END], integration.dense[1])
    copy(integration.slopes[END], integration.slopes[0])
    unwrap_angles(system, work, integration)
    note_violation(integration, system, work)
    return code_of_violation(integration)


@kernel
def _reject(integration, h, factor, system, work):
    integration.clock[0]["step"] = h * factor
    integration.clock[0]["rejections"] += 1
    integration.clock[0]["rejected"] = 1


@kernel
def _place_row(integration, t):
    """Bring `trial` to a time up to the present one; return the fraction of the last step."""
    clock, x = integration.clock[0], 1.0
    copy(integration.z, integration.trial)
    if t < clock["t"]:
        h = clock["step_length"]
        x = (t - clock["step_start"]) / h
        for i in range(integration.z.shape[0]):
            ends = h * integration.dense[0, i], h * integration.dense[1, i]
            integration.trial[i] = cubic(x, integration.old[i], integration.z[i], ends[0], ends[1])
    return x


@kernel
def _fill_row(integration, t, report, system, work):
    x = _place_row(integration, t)
    code = report_trial(integration, t, x, report, system, work)
    if code != NEAR_SINGULAR:
        return code
    # Near a singular position the rates are those of the interpolation: round-off may rule the equations.
    _place_row(integration, t)
    clock, h = integration.clock[0], integration.clock[0]["step_length"]
    rates = report.rates[clock["row"]]
    first = clock["counted"] - rates.shape[0]
    for k in range(rates.shape[0]):
        i = first + k
        ends = h * integration.dense[0, i], h * integration.dense[1, i]
        rates[k] = cubic_slope(x, integration.old[i], integration.z[i], ends[0], ends[1]) / h
    fill_near_singular(integration, t, x, report, system, work)
    return READY


_advance = time_loop(Method(_length, _attempt, _accept, _reject, _fill_row))


@kernel
def integrate_rows(task, system, work, integration, report, budget):
    """Begin at the state z, or fill the rows of `report`, at most `budget` evaluations; a code."""
    if task != BEGIN:
        return _advance(integration, report, budget, system, work)
    clock = integration.clock[0]
    copy(integration.z, integration.old)
    copy(integration.z, integration.trial)
    clock["step_start"] = clock["t"]
    if clock["step"] == 0.0:
        clock["step"] = STEP
    return READY if slope(integration, 0, clock["t"], system, work) else STEP_VANISHED
