"""A step of Radau's method over a singular position, where two motions of a mechanism cross.

Accelerations are what the equations miss over a pivot that vanishes there.  Iterations of a step whose
stages lie near do not converge, and shorter steps only come nearer: each ends a part of the way in front of
it.  So a step ends as far behind as it begins in front, by accelerations that go on as before.  Whether
they do, the equations say at its end, where they are as firm as at its beginning: a motion with a corner,
or one that would come onto another branch, has other accelerations there.
"""

from typing import TYPE_CHECKING

from .._jit import allocating, kernel
from ..constrained.angle_unwrapping import MOST_TURNED, expect_angles
from ..constrained.report import NOW, TRIED
from ..constrained.system import SOLVED, System, Work
from ..laws import POWER
from .error_norm import tolerance
from .radau5_error import work_scale
from .radau5_projection import moved, project_state
from .radau5_step import START, place_stages, place_trial, predict, prepare
from .radau5_table import STAGES, TIMES
from .singular_ahead import blur, most_declined

if TYPE_CHECKING:
    import numpy as np

    from .radau5 import RadauIntegration


UNEVEN = 3.0  # how much larger one of the pivots in front and behind may be
# How much of what is not as expected remains an error of the step: of the accelerations at its end in its
# speeds, before they are bent and after; of the change of the power, which is taken as linear, in its work.
BEFORE_BENDING, AFTER_BENDING, OF_POWER = 0.03, 0.2, 0.125


@allocating
def singular_step(system: System, work: Work, integration: "RadauIntegration", h: float) -> bool:
    """Bring `trial` to the end of a step of length h from z as one made by stages; whether it may be made."""
    clock, rates = integration.clock[0], integration.rates
    if not prepare(integration, work.motions.shape[0] - work.rank[0], h):
        return False
    predict(system, integration, h)
    clock["error"], power, found = 0.0, 0.0, integration.trial.copy()
    expected = rates[START + STAGES].copy()
    for again in range(2):
        if again:
            _bend(integration, expected, h)
            for _ in range(2):
                place_stages(system, integration, h)
        place_trial(system, integration, STAGES - 1)
        if not expect_angles(system, work, integration, h) < MOST_TURNED:
            return False
        for i in range(found.shape[0]):
            found[i] = integration.trial[i]
        for k in range(expected.shape[0]):
            expected[k] = rates[START + STAGES, k]
        clock["evaluations"] += 1
        code, power = project_state(system, work, integration, clock["t"] + h, rates[START + STAGES])
        if code != SOLVED or work.quality[0] != clock["pivot_order"]:
            return False
        clock["error"] = max(
            clock["error"],
            (AFTER_BENDING if again else BEFORE_BENDING) * h * _unexpected(integration, expected),
        )
    pivot = most_declined(work)
    behind = -work.diagonal[pivot] / work.pivots[pivot]
    if not 1.0 / UNEVEN < behind < UNEVEN:
        return False
    of_work = h * abs(_spread_power(integration, work, power)) / work_scale(integration)
    clock["error"] = max(clock["error"], moved(integration, found), OF_POWER * of_work) / blur(
        work, clock["rtol"]
    )
    return clock["error"] < 1.0


@kernel
def _bend(integration: "RadauIntegration", expected: "np.ndarray", h: float) -> None:
    """Let the accelerations of the stages go through those found at the end."""
    rates, ratio = integration.rates, h / integration.clock[0]["step_length"]
    for stage in range(STAGES):
        weight = 1.0
        for node in range(STAGES + 1):
            at = TIMES[node - 1] if node > 0 else 0.0
            weight *= (1.0 + ratio * TIMES[stage] - at) / (1.0 + ratio - at)
        if stage < STAGES - 1:
            for k in range(expected.shape[0]):
                rates[START + 1 + stage, k] += weight * (rates[START + STAGES, k] - expected[k])


@kernel
def _unexpected(integration: "RadauIntegration", expected: "np.ndarray") -> float:
    """By how many tolerances of the speeds, a second, the accelerations at the end are not those expected."""
    clock, n, total = integration.clock[0], expected.shape[0], 0.0
    first = clock["counted"] - n
    for k in range(n):
        scale = tolerance(clock, integration.units[first + k], abs(integration.trial[first + k]))
        total += ((integration.rates[START + STAGES, k] - expected[k]) / scale) ** 2
    return (total / n) ** 0.5


@kernel
def _spread_power(integration: "RadauIntegration", work: Work, power: float) -> float:
    """Powers of the stages between that at the start and that at the end; returns the change."""
    before, of_loads = integration.memory[0]["power"], integration.load_powers
    for stage in range(STAGES):
        integration.powers[stage] = before + TIMES[stage] * (power - before)
    for k in range(of_loads.shape[1]):
        first, change = of_loads[NOW, k], work.responses[k, POWER] - of_loads[NOW, k]
        for stage in range(STAGES):
            of_loads[TRIED + stage, k] = first + TIMES[stage] * change
    return power - before
