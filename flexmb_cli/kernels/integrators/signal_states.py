"""States of signals in implicit methods: first-order equations beside those of the motion.

They are iterated by substitution; those of bristles follow from the speeds of a stage.
Rates (s,) are those of the s states, 1/s.
"""

from typing import TYPE_CHECKING

import numpy as np

from .._jit import kernel
from ..constrained.system import System
from .error_norm import tolerance

if TYPE_CHECKING:
    from .integrations import AlphaIntegration, RadauIntegration


@kernel
def first_state(system: System) -> int:
    """Return the place of the first state of signals in the state of the motion."""
    return int(2 * system.speed_scale.shape[0] + system.masses.shape[0])


@kernel
def place_states(
    system: System, integration: "RadauIntegration", rates: np.ndarray, weights: np.ndarray, h: float
) -> float:
    """Fill the states at the stages (3,) by their rates (3, s) and weights (3, 3).

    Returns the sum of the squares of their changes, in tolerances.
    """
    clock, states, first, total = integration.clock[0], integration.states, first_state(system), 0.0
    for stage in range(states.shape[0]):
        for k in range(states.shape[1]):
            change = integration.z[first + k] - states[stage, k]
            for j in range(states.shape[0]):
                change += h * weights[stage, j] * rates[j, k]
            states[stage, k] += change
            total += (change / tolerance(clock, integration.units[first + k], abs(states[stage, k]))) ** 2
    return total


@kernel
def know_stage(
    system: System,
    integration: "RadauIntegration",
    rates: np.ndarray,
    weights: np.ndarray,
    stage: int,
    h: float,
) -> None:
    """Have the states of bristles at a stage follow from rates (3, s) of the others, and weights (3, 3)."""
    signals, first = system.signals, first_state(system)
    for k in range(signals.known.shape[0]):
        known = integration.z[first + k]
        for j in range(rates.shape[0]):
            if j != stage:
                known += h * weights[stage, j] * rates[j, k]
        signals.known[k] = known
    signals.ahead[0] = h * weights[stage, stage]


@kernel
def know_end(system: System, integration: "AlphaIntegration", last: np.ndarray, h: float) -> None:
    """Have the states of bristles at the end of a step follow from the rates last (s,) at its start."""
    signals, first = system.signals, first_state(system)
    for k in range(signals.known.shape[0]):
        signals.known[k] = integration.z[first + k] + 0.5 * h * last[k]
    signals.ahead[0] = 0.5 * h


@kernel
def error_of_stages(
    system: System, integration: "RadauIntegration", rates: np.ndarray, weights: np.ndarray, h: float
) -> float:
    """Sum of the squares of errors, in tolerances: h times rates (s,), and weights (3,) of the stages."""
    clock, states, first, total = integration.clock[0], integration.states, first_state(system), 0.0
    for k in range(states.shape[1]):
        z, error = integration.z[first + k], h * rates[k]
        for stage in range(states.shape[0]):
            error += weights[stage] * (states[stage, k] - z)
        total += (error / tolerance(clock, integration.units[first + k], abs(z))) ** 2
    return total


@kernel
def predict_states(
    system: System,
    integration: "AlphaIntegration",
    new: np.ndarray,
    last: np.ndarray,
    before: np.ndarray,
    h: float,
) -> None:
    """Fill the rates new (s,), and `trial`, at the end of a step by earlier rates: last (s,), before (s,)."""
    first, length = first_state(system), integration.clock[0]["step_length"]
    for k in range(new.shape[0]):
        new[k] = last[k]
        if length > 0.0:
            new[k] += (last[k] - before[k]) * h / length
        integration.trial[first + k] += 0.5 * h * (last[k] + new[k])


@kernel
def correct_states(
    system: System, integration: "AlphaIntegration", new: np.ndarray, last: np.ndarray, h: float
) -> float:
    """Bring `trial` to the trapezoidal rule of rates new, last (s,); return the largest change."""
    clock, z, first, largest = integration.clock[0], integration.z, first_state(system), 0.0
    for k in range(new.shape[0]):
        i = first + k
        state = z[i] + 0.5 * h * (last[k] + new[k])
        scale = tolerance(clock, integration.units[i], abs(state))
        largest = max(largest, abs(state - integration.trial[i]) / scale)
        integration.trial[i] = state
    return largest


@kernel
def error_of_trapezoid(
    system: System,
    integration: "AlphaIntegration",
    new: np.ndarray,
    last: np.ndarray,
    before: np.ndarray,
    h: float,
) -> float:
    """Sum of the squares of the errors h³/12 d³x/dt³, by rates new (s,), last (s,) and before (s,)."""
    clock, first, total = integration.clock[0], first_state(system), 0.0
    length = clock["step_length"]
    for k in range(new.shape[0]):
        bend = new[k] - last[k]
        if length > 0.0:
            bend = 2.0 * h / (h + length) * (bend - (last[k] - before[k]) * h / length)
        i = first + k
        total += (h / 12.0 * bend / tolerance(clock, integration.units[i], abs(integration.trial[i]))) ** 2
    return total
