"""Errors of a step of the generalised-α method, in tolerances, by the growth of the accelerations."""

from typing import TYPE_CHECKING

from .._jit import kernel, part
from .error_norm import displacement_tolerance, tolerance

if TYPE_CHECKING:
    from ..constrained.system import System
    from .generalised_alpha import AlphaIntegration

# Rows of the accelerations kept (5, n): of the step's end as it is found, its start, the start of the step
# before; the means at both ends.
NEW, LAST, BEFORE, MEAN, NEW_MEAN = 0, 1, 2, 3, 4
# Rows of what is missing in the equations (3, m), and of the corrections that close these gaps (3, n).
ACCELERATION_GAP, SPEED_GAP, POSITION_GAP = 0, 1, 2


@part
def step_error(system: "System", integration: "AlphaIntegration", h: float):
    """Error of the step in tolerances, from the growth of the accelerations.

    By Taylor's series, with s = α_m - α_f: (1/12 + s²/4) h³ d(ud)/dt in positions and
    (1/12 + s²/2) h³ d²(ud)/dt² in speeds, the means being ud + s h d(ud)/dt + 3/2 s² h² d²(ud)/dt² in equal
    steps.  For ρ = 0 this is the constant 7/12 of the two-step method that u then follows.
    """
    clock, rates, n = integration.clock[0], integration.rates, system.speed_scale.shape[0]
    first, rho = clock["counted"] - n, integration.memory[0]["rho"]
    s = (rho - 1.0) / (rho + 1.0)
    of_position, of_speed = (1.0 / 12.0 + 0.25 * s * s) * h * h, (1.0 / 12.0 + 0.5 * s * s) * h
    length, total = clock["step_length"], 0.0
    for k in range(n):
        growth = rates[NEW, k] - rates[LAST, k]
        bend = growth
        if length > 0.0:
            bend = 2.0 * h / (h + length) * (growth - (rates[LAST, k] - rates[BEFORE, k]) * h / length)
        total += (of_position * growth / displacement_tolerance(clock, system.speed_scale[k])) ** 2
        scale = tolerance(clock, integration.units[first + k], abs(integration.trial[first + k]))
        total += (of_speed * bend / scale) ** 2
    return (0.5 * total / n) ** 0.5


@part
def correction_size(system: "System", integration: "AlphaIntegration", by_speed: float):
    """The change of the speeds by the correction of the accelerations, in tolerances."""
    clock, n, total = integration.clock[0], system.speed_scale.shape[0], 0.0
    first = clock["counted"] - n
    for k in range(n):
        scale = tolerance(clock, integration.units[first + k], abs(integration.trial[first + k]))
        total += (by_speed * integration.corrections[ACCELERATION_GAP, k] / scale) ** 2
    return (total / n) ** 0.5


@kernel
def fastest_change(system: "System", integration: "AlphaIntegration"):
    """The largest rate at which accelerations change speeds, 1/s."""
    n = system.speed_scale.shape[0]
    first = integration.clock[0]["counted"] - n
    fastest = 0.0
    for k in range(n):
        size = system.speed_scale[k] + abs(integration.z[first + k])
        fastest = max(fastest, abs(integration.rates[LAST, k]) / size)
    return fastest
