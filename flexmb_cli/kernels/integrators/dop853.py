"""DOP853 for any equations: the stages, the error and the dense output of a step, and its acceptance.

Hairer, Nørsett and Wanner, Solving Ordinary Differential Equations I (second edition), sections II.4-II.6.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from .._jit import allocating, kernel
from ..linalg.number_rows import copy
from .clock import READY, crosses_singularity, step_before_singularity
from .dop853_table import (
    ALL_STAGES,
    DENSE_TERMS,
    DENSE_WEIGHTS,
    ERROR_3,
    ERROR_5,
    STAGE_TIMES,
    STAGE_WEIGHTS,
    STAGES,
)
from .error_norm import SLOWEST, TIME_ROUND_OFF, scaled_norm, tolerance
from .time_loop import Method, time_loop

SHARE = 0.46  # of a step in front of a singular position: no stage is nearer than an eighth of the step
# Of a step over such a position: its error before it is projected, in tolerances or of the speeds, whichever
# is more; on another branch it would be off by its turn.
BLURRED, BLURRED_SPEEDS = 1e4, 1e-6
SAFETY, FASTEST = 0.9, 10.0
ERROR_EXPONENT = -1.0 / 8.0
LOOKED_AT = 4  # each so many-th step is, whether it lies at the limit of stability
AT_LIMIT = 4.5  # step length times largest eigenvalue: undamped vibrations are unstable above 5.9
IMPOSSIBLE_ERROR = 1e10  # error of a step that cannot be made


class Equations(NamedTuple):
    """Interface of DOP853 to a system: kernels of (integration, ..., *arrays).

    The integration has clock, z, old, trial (N,), slopes (16, N), dense (7, N) and units (N,).
    """

    slope: Callable  # (integration, stage, t, *arrays): fill slopes[stage] at `trial`; whether there is one
    normalise: Callable  # (integration, *arrays): bring the Euler parameters of `trial` to length one
    finish: (
        Callable  # (integration, h, *arrays): project the end of a step, fill its slope; see `Method.attempt`
    )
    watch: Callable  # (integration, *arrays): look at the accepted step, for events; a code
    close: Callable  # (integration, *arrays): bring its end onto loops, fill slopes[0] of the next; a code
    fill_row: Callable  # (integration, t, report, *arrays): see `Method`
    elements: Callable | None = None  # (*arrays): see `Method`


def dop853(equations: Equations) -> Callable:
    """Return the kernel of `time_loop` that integrates such equations."""
    slope, normalise, finish, watch, close, fill_row, elements = equations
    attempt, accept = _attempts(slope, normalise, finish), _acceptance(slope, watch, close)
    return time_loop(Method(_length, attempt, accept, reject, fill_row, elements))


def _attempts(slope: Callable[..., Any], normalise: Callable[..., Any], finish: Callable[..., Any]):
    @kernel
    def attempt(integration: Any, h: float, *arrays: Any):
        clock, trial = integration.clock[0], integration.trial
        for stage in range(1, STAGES):
            set_stage(integration.z, integration.slopes, stage, h, trial)
            t = min(clock["t"] + h * STAGE_TIMES[stage], _before(clock["stop"]))
            if not slope(integration, stage, t, *arrays):
                return -SLOWEST
        set_stage(integration.z, integration.slopes, STAGES, h, trial)
        normalise(integration, *arrays)
        error, clock["worst"] = step_error(integration, h)
        clock["error"] = error
        # `not <` rejects a nan as well.
        if not error < _largest_error(clock, h):
            return -next_factor(error, 1) if error < IMPOSSIBLE_ERROR else -SLOWEST
        return finish(integration, h, *arrays)

    return attempt


def _acceptance(slope: Callable[..., Any], watch: Callable[..., Any], close: Callable[..., Any]):
    @allocating
    def fill_dense(integration: Any, *arrays: Any) -> None:
        clock, old, slopes = integration.clock[0], integration.old, integration.slopes
        start, h = clock["step_start"], clock["step_length"]
        behind = slopes[STAGES].copy()
        if clock["t"] >= clock["stop"]:
            copy(integration.z, integration.trial)
            slope(integration, STAGES, _before(clock["stop"]), *arrays)
        for stage in range(STAGES + 1, ALL_STAGES):
            set_stage(old, slopes, stage, h, integration.trial)
            fault = clock["fault"]
            slope(integration, stage, start + h * STAGE_TIMES[stage], *arrays)
            # Both ends were solved; where a point between them is not, its slope stays as it is.
            clock["fault"] = fault
        set_dense(old, integration.z, slopes, h, integration.dense)
        copy(behind, slopes[STAGES])

    @kernel
    def accept(integration: Any, factor: float, *arrays: Any):
        clock = integration.clock[0]
        _end_step(integration, factor)
        code = watch(integration, *arrays)
        if clock["steps"] % LOOKED_AT == 0:
            clock["stiff"] += is_at_limit(integration, clock["step_length"])
        if code == READY and clock["next"] < clock["t"]:
            fill_dense(integration, *arrays)
        return close(integration, *arrays) if code == READY else code

    return accept


@kernel
def _length(integration: Any, *arrays: Any):
    clock = integration.clock[0]
    return min(step_before_singularity(clock, clock["step"], SHARE), clock["stop"] - clock["t"])


@kernel
def _largest_error(clock: np.void, h: float):
    """Error of a step of length h, in tolerances, that its projection may take away."""
    return max(BLURRED, BLURRED_SPEEDS / clock["rtol"]) if crosses_singularity(clock, h) else 1.0


@kernel
def _end_step(integration: Any, factor: float) -> None:
    """Make the end of a step, which is in `trial`, the state."""
    clock, h = integration.clock[0], integration.clock[0]["length"]
    copy(integration.z, integration.old)
    copy(integration.trial, integration.z)
    clock["step"] = h * factor
    clock["step_start"], clock["step_length"], clock["step_rejected"] = clock["t"], h, clock["rejected"]
    last = h >= clock["stop"] - clock["t"]
    clock["t"] = clock["stop"] if last else clock["t"] + h
    clock["rejected"] = 0
    clock["steps"] += 1


@kernel
def reject(integration: Any, h: float, factor: float, *arrays: Any) -> None:
    """Prepare another try, of factor times h; see `Method`."""
    clock = integration.clock[0]
    clock["step"] = h * factor
    clock["rejections"] += 1
    clock["rejected"], clock["projection_too_large"] = 1, 0


@kernel
def _before(stop: float) -> float:
    """Return the last time before a stop, at which the accelerations of drivers may jump: those before it
    belong to the step that ends there."""
    return stop - TIME_ROUND_OFF * abs(stop)


@kernel
def is_at_limit(integration: Any, h: float):
    """Return whether the last step, of length h, was about as long as stability allows; overwrites `trial`.

    Hairer and Wanner, volume II, section IV.2: the slopes at the end of the step and at the last stage, which
    is at the same time, differ by the largest eigenvalue times what their states do.
    """
    slopes, apart, steep = integration.slopes, 0.0, 0.0
    set_stage(integration.old, slopes, STAGES - 1, h, integration.trial)
    for i in range(integration.clock[0]["counted"]):
        apart += (integration.z[i] - integration.trial[i]) ** 2
        steep += (slopes[STAGES, i] - slopes[STAGES - 1, i]) ** 2
    return h * h * steep > AT_LIMIT * AT_LIMIT * apart


@kernel
def first_step(integration: Any, slope: Callable[..., Any]):
    """Length of the first step by the state z and its slope (N,) alone, s."""
    z = integration.z
    size, speed = scaled_norm(integration, z, z), scaled_norm(integration, z, slope)
    return 0.01 * size / speed if size > 1e-5 and speed > 1e-5 else 1e-6


@kernel
def set_stage(z: np.ndarray, slopes: np.ndarray, stage: int, h: float, out: np.ndarray) -> None:
    """Fill out (N,) with z + h (weights of `stage`) · slopes; slopes (16, N)."""
    copy(z, out)
    for j in range(stage):
        weight = h * STAGE_WEIGHTS[stage, j]
        if weight != 0.0:
            for i in range(z.shape[0]):
                out[i] += weight * slopes[j, i]


@kernel
def next_factor(error: float, rejected: int):
    """Factor on the step length after a step with this error; `rejected`: the step before failed."""
    if error == 0.0:
        return 1.0 if rejected else FASTEST
    factor = SAFETY * error**ERROR_EXPONENT
    highest = 1.0 if rejected or error >= 1.0 else FASTEST
    return min(highest, max(SLOWEST, factor))


@kernel
def set_dense(z: np.ndarray, new: np.ndarray, slopes: np.ndarray, h: float, dense: np.ndarray) -> None:
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
def interpolate(z: np.ndarray, dense: np.ndarray, x: float, out: np.ndarray) -> None:
    """Fill out (N,) with the state at the fraction x of the step that began at z."""
    for i in range(z.shape[0]):
        total = 0.0
        for term in range(DENSE_TERMS - 1, -1, -1):
            total = (total + dense[term, i]) * (x if term % 2 == 0 else 1.0 - x)
        out[i] = z[i] + total


@kernel
def interpolate_slopes(dense: np.ndarray, x: float, h: float, first: int, out: np.ndarray) -> None:
    """Fill out with the rates of `interpolate`, from place `first` on, in a step of length h."""
    for i in range(out.shape[0]):
        total = slope = 0.0
        for term in range(DENSE_TERMS - 1, -1, -1):
            total += dense[term, first + i]
            if term % 2 == 0:
                slope, total = slope * x + total, total * x
            else:
                slope, total = slope * (1.0 - x) - total, total * (1.0 - x)
        out[i] = slope / h


@kernel
def step_error(integration: Any, h: float):
    """Error of the step from z to trial, and the place in z of its largest component."""
    clock, z, new = integration.clock[0], integration.z, integration.trial
    counted, worst, largest = clock["counted"], 0, 0.0
    square_5 = square_3 = 0.0
    for i in range(counted):
        scale = tolerance(clock, integration.units[i], max(abs(z[i]), abs(new[i])))
        error_5 = weighted(ERROR_5, integration.slopes, i) / scale
        square_5 += error_5**2
        square_3 += (weighted(ERROR_3, integration.slopes, i) / scale) ** 2
        # `not <=` lets a nan through as the worst place.
        if not abs(error_5) <= largest:
            worst, largest = i, abs(error_5)
    return combined(h, square_5, square_3, counted), worst


@kernel
def weighted(weights: np.ndarray, slopes: np.ndarray, i: int):
    """Return the sum of slopes (16, N) of component i with weights (16,)."""
    total = 0.0
    for j in range(STAGES):
        total += weights[j] * slopes[j, i]
    return total


@kernel
def combined(h: float, square_5: float, square_3: float, counted: int):
    """Error by the squares of the estimates of orders 5 and 3 over so many components."""
    if square_5 == 0.0:
        return 0.0
    return abs(h) * square_5 / ((square_5 + 0.01 * square_3) * counted) ** 0.5
