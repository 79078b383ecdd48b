"""DOP853 for any equations: the stages, the error and the dense output of a step, and its acceptance.

Hairer, Nørsett and Wanner, Solving Ordinary Differential Equations I (second edition), sections II.4-II.6.
"""

from collections.abc import Callable
from typing import NamedTuple

from .._jit import kernel
from .clock import READY
from .dop853_table import ALL_STAGES, STAGE_TIMES, STAGES
from .explicit_error import scaled_norm, step_error
from .runge_kutta import SLOWEST, next_factor, set_dense, set_stage
from .singular_ahead import laid_out, leads_over
from .time_loop import Method, time_loop

SHARE = 0.46  # of a step in front of a singular position: no stage is nearer than an eighth of the step
# Of a step over such a position: its error before it is projected, in tolerances or of the speeds, whichever
# is more; on another branch it would be off by its turn.
BLURRED, BLURRED_SPEEDS = 1e4, 1e-6
HOPELESS = 1e10  # error of a step that cannot be made


class Equations(NamedTuple):
    """What DOP853 asks of a system: kernels of (integration, ..., *arrays).

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


def dop853(equations: Equations) -> Callable:
    """Return the kernel of `time_loop` that integrates such equations."""
    slope, normalise, finish, watch, close, fill_row = equations

    @kernel
    def length(integration, *arrays):
        clock = integration.clock[0]
        return min(laid_out(clock, clock["step"], SHARE), clock["stop"] - clock["t"])

    @kernel
    def attempt(integration, h, *arrays):
        clock = integration.clock[0]
        for stage in range(1, STAGES):
            set_stage(integration.z, integration.slopes, stage, h, integration.trial)
            if not slope(integration, stage, clock["t"] + h * STAGE_TIMES[stage], *arrays):
                return -SLOWEST
        set_stage(integration.z, integration.slopes, STAGES, h, integration.trial)
        normalise(integration, *arrays)
        error, clock["worst"] = step_error(integration, h)
        clock["error"] = error
        # `not <` rejects a nan as well.
        if not error < _largest_error(clock, h):
            return -next_factor(error, 1) if error < HOPELESS else -SLOWEST
        return finish(integration, h, *arrays)

    @kernel
    def accept(integration, factor, *arrays):
        clock = integration.clock[0]
        _end_step(integration, factor)
        code = watch(integration, *arrays)
        if code == READY and clock["next"] < clock["t"]:
            for stage in range(STAGES + 1, ALL_STAGES):
                set_stage(integration.old, integration.slopes, stage, clock["step_length"], integration.trial)
                fault = clock["fault"]
                slope(
                    integration,
                    stage,
                    clock["step_start"] + clock["step_length"] * STAGE_TIMES[stage],
                    *arrays,
                )
                # Both ends were solved; where a point between them is not, its slope stays as it is.
                clock["fault"] = fault
            set_dense(
                integration.old, integration.z, integration.slopes, clock["step_length"], integration.dense
            )
        return close(integration, *arrays) if code == READY else code

    return time_loop(Method(length, attempt, accept, _reject, fill_row))


@kernel
def _largest_error(clock, h):
    """Error of a step of length h, in tolerances, that its projection may take away."""
    return max(BLURRED, BLURRED_SPEEDS / clock["rtol"]) if leads_over(clock, h) else 1.0


@kernel
def _end_step(integration, factor):
    """Make the end of a step, which is in `trial`, the state."""
    clock, h = integration.clock[0], integration.clock[0]["length"]
    for i in range(integration.z.shape[0]):
        integration.old[i] = integration.z[i]
        integration.z[i] = integration.trial[i]
    clock["step"] = h * factor
    clock["step_start"], clock["step_length"], clock["step_rejected"] = clock["t"], h, clock["rejected"]
    last = h >= clock["stop"] - clock["t"]
    clock["t"] = clock["stop"] if last else clock["t"] + h
    clock["rejected"] = 0
    clock["steps"] += 1


@kernel
def _reject(integration, h, factor, *arrays):
    clock = integration.clock[0]
    clock["step"] = h * factor
    clock["rejections"] += 1
    clock["rejected"], clock["strayed"] = 1, 0


@kernel
def first_step(integration, slope):
    """Length of the first step by the state z and its slope (N,) alone, s."""
    size, speed = scaled_norm(integration, integration.z), scaled_norm(integration, slope)
    return 0.01 * size / speed if size > 1e-5 and speed > 1e-5 else 1e-6
