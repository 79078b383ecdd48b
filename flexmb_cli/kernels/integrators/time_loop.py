"""The loop through time of every integrator: report rows where they are due, and steps between them.

A method gives its parts as kernels; numba has no cheap functions as arguments, so the loop is compiled
once for each method.  Steps do not depend on how the report rows are cut into calls.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

from .._jit import kernel
from .clock import AT_STOP, PAUSED, READY, ROWS_FULL, SMALLEST_STEP, STEP_SHORT, STEP_VANISHED
from .contact_events import contact_events

# Of the longest step.  Where two motions cross, equations that are 1e-16 off lead from one to the other in
# some 1e-8 s: steps so short follow that blow, and the speeds jump.
SHORT = 1e-6


class Method(NamedTuple):
    """The parts of an integrator: kernels of (integration, ..., *arrays).

    `arrays` are those of the system and of the work on it; `integration.clock` is of CLOCK.
    """

    # (integration, *arrays): length of the step to try, s, 0 where there is none
    length: Callable
    # (integration, h, *arrays): factor on the next length; minus that of another try; 0: no step can be made
    attempt: Callable
    # (integration, factor, *arrays): make the end of the step the state; READY or another code
    accept: Callable
    # (integration, h, factor, *arrays): prepare another try, of factor times h, and count it as `rejected`
    reject: Callable
    # (integration, t, report, *arrays): fill a report row at a time up to the state; a code
    fill_row: Callable
    # (*arrays): the contacts that end steps; None: no step ends there
    contacts: Callable | None = None


def time_loop(method: Method, same: float = 0.0) -> Callable:
    """Return the kernel (integration, report, budget, *arrays) that fills the rows of a report.

    It makes at most `budget` evaluations and those of one try, and returns a code of `clock`; clock["row"]
    counts the rows filled.  A row that is `same` steps ahead of the state is that of the state.
    """
    take_step, fill_row = _steps(method), method.fill_row

    @kernel
    def advance(integration: Any, report: Any, budget: int, *arrays: Any):
        clock = integration.clock[0]
        clock["row"], code = 0, READY
        spent = clock["evaluations"] + budget
        while code == READY and clock["row"] < report.times.shape[0]:
            t = clock["next"] = report.times[clock["row"]]
            if t <= clock["t"] + same * clock["step"]:
                code = fill_row(integration, t, report, *arrays)
            elif clock["t"] >= clock["stop"]:
                return AT_STOP
            elif clock["evaluations"] >= spent:
                return PAUSED
            elif clock["step"] < SHORT * clock["longest"] and clock["short_step_allowed"] == 0:
                return STEP_SHORT
            else:
                code = take_step(integration, spent, *arrays)
        return ROWS_FULL if code == READY else code

    return advance


def _steps(method: Method):
    length, attempt, accept, reject, _, contacts = method
    begin, land = contact_events(attempt, contacts)

    @kernel
    def take_step(integration: Any, spent: int, *arrays: Any):
        """Make one step; a code.

        The tries pause when the evaluations of the clock reach `spent`, and the next call continues.
        """
        clock = integration.clock[0]
        begin(integration, *arrays)
        while True:
            h = length(integration, *arrays)
            # `not >` refuses a nan.
            if not h > SMALLEST_STEP * max(abs(clock["t"]), 1e-3):
                return STEP_VANISHED
            # The same step fails again, for ever.
            if clock["rejected"] > 0 and not h < clock["length"]:
                return STEP_VANISHED
            clock["length"] = h
            factor = attempt(integration, h, *arrays)
            if factor > 0.0:
                factor = land(integration, factor, *arrays)
                # Where the shorter attempt failed, that one is what the next must be shorter than.
                if factor <= 0.0:
                    h = clock["length"]
            if factor > 0.0:
                clock["step_tried"] = h
                landed, code = clock["length"] < h, accept(integration, factor, *arrays)
                if landed and clock["rejected"] == 0:
                    clock["step"] = max(clock["step"], h)
                return code
            if factor == 0.0:
                return STEP_VANISHED
            reject(integration, h, -factor, *arrays)
            if clock["evaluations"] >= spent:
                return PAUSED

    return take_step
