"""Stepping of a constrained mechanism through time by the generalised-α method in compiled code.

Steps have a given length, or one that keeps the error of a step within the tolerance; they do not
depend on how the report rows are cut into calls.  Rows inside a step come from Hermite's cubic through
both ends; every row is brought onto the constraints to round-off, and its accelerations and forces are
those of the equations of motion there.
"""

from typing import Any

import numpy as np

from ...memory import paged_zeros
from .._jit import allocating, kernel
from ..constrained.angle_unwrapping import EXPECTED, unwrap_angles
from ..constrained.body_vectors import geometry_of, place_vectors
from ..constrained.report import NOW, TRIED, Report, complete, coordinates_and_speeds
from ..constrained.system import System, Work
from ..linalg.number_rows import copy
from ..linalg.rotation import A, rotation_matrices
from .clock import BEGIN, READY, STEP_VANISHED, new_clock
from .constrained_equations import (
    add_works,
    code_of_violation,
    contacts_of,
    fill_near_singular,
    first_speed,
    first_step,
    interpolate_angles,
    is_doubtful,
    note_violation,
    works_between,
)
from .generalised_alpha_step import (
    BEFORE,
    LAST,
    MEAN,
    NEW,
    NEW_MEAN,
    SAME_TIME_IN_STEP,
    SLOWEST,
    advance,
    factor_of,
    iterate,
    look_ahead_of_given,
    next_length,
    retreat,
    solve_step,
    turn_exactly,
)
from .hermite import cubic, cubic_slope
from .integrations import AlphaIntegration
from .rotation_increments import FAR_TURN, LONGEST_TURN, largest_turn, set_slope, shift_between
from .singular_ahead import look_ahead
from .time_loop import Method, time_loop

TRAPEZOID = np.array([0.5, 0.0, 0.5])  # weights of the powers of loads in the work of a step

MEMORY = np.dtype(
    [
        ("fixed", np.float64),  # length that all steps have, s, 0: chosen
        ("rho", np.float64),  # spectral radius at infinity, no unit
        ("start", np.float64),  # first time, s
        ("whole", np.int64),  # steps of given length that are behind
        ("mean_length", np.float64),  # step that the means of the accelerations belong to, s
        ("share", np.float64),  # share of the tolerance that the step may err by; `clock["error"]` is of it
        ("span", np.float64),  # of the whole run, s
        ("turned", np.float64),  # how far a body turns in the step, as a share of the longest turn
        ("left", np.float64),  # error that an iteration leaves, as a share of its size, seen last
        ("power", np.float64),  # of drivers and loads that store no energy, at t, W
        ("new_power", np.float64),  # at the end of the step that is tried, W
        ("old_power", np.float64),  # at the start of the last step, W
        # length of the step over the singular position ahead, s; of given steps: way on which none ends
        ("passing", np.float64),
    ]
)


def new_integration(work: Any, angles: Any, n_loads: int = 0, states: int = 0) -> AlphaIntegration:
    """An integration at time 0 with an empty state, for the `work` of a mechanism and so many angles.

    The mechanical work of the first `n_loads` loads is integrated; `states`: those of signals.
    """
    m, n = work.jacobian.shape[0], work.motions.shape[0]
    counted = 2 * n + work.mass.shape[0] + states
    size = counted + 1 + n_loads
    return AlphaIntegration(
        new_clock(counted), np.zeros(1, MEMORY),
        np.zeros(size), np.zeros(size), np.zeros(size), np.ones(size),
        np.zeros((3, angles)), np.zeros((5, n)), np.zeros((3, n)), np.zeros((3, n)), np.zeros((3, n)),
        np.zeros((3, m)), np.zeros((3, n_loads)), work._replace(reduced=paged_zeros(work.reduced.shape)),
        np.zeros((3, states)),
    )  # fmt: skip


@kernel
def _begin(integration: AlphaIntegration, system: System, work: Work) -> int:
    clock, memory, rates = integration.clock[0], integration.memory[0], integration.rates
    memory["start"] = clock["step_start"] = clock["t"]
    memory["fixed"] = clock["step"]
    memory["left"], memory["span"] = 1.0, clock["stop"] - clock["t"]
    copy(integration.z, integration.trial)
    if not iterate(system, work, integration, clock["t"], 0.0, 0.0, 0.0):
        return STEP_VANISHED
    memory["power"] = memory["new_power"]
    copy(integration.load_powers[TRIED], integration.load_powers[NOW])
    copy(integration.trial, integration.z)
    copy(integration.z, integration.old)
    for kind in (LAST, BEFORE, MEAN):
        copy(rates[NEW], rates[kind])
    for kind in (LAST, BEFORE):
        copy(integration.state_rates[NEW], integration.state_rates[kind])
    clock["step"] = memory["fixed"] if memory["fixed"] > 0.0 else first_step(system, integration, rates[LAST])
    memory["passing"] = clock["step"]
    return READY


@kernel
def _length(integration: AlphaIntegration, system: System, work: Work):
    return next_length(integration.clock[0], integration.memory[0])


@kernel
def _attempt(integration: AlphaIntegration, h: float, system: System, work: Work):
    """Find the end of a step of length h; 1, or minus the factor on the length for another try."""
    clock, memory = integration.clock[0], integration.memory[0]
    if not solve_step(system, work, integration, h):
        return -0.25
    if memory["fixed"] == 0.0 and not _holds(system, integration, h):
        return -(factor_of(clock, memory) if clock["error"] < 1e10 else SLOWEST)
    return 1.0


@kernel
def _reject(integration: AlphaIntegration, h: float, factor: float, system: System, work: Work) -> None:
    retreat(integration.clock[0], integration.memory[0], h, h * factor)


@kernel
def _holds(system: System, integration: AlphaIntegration, h: float) -> bool:
    """Return whether a step of length h is within the tolerance, and turns no body too far."""
    bodies, clock, memory = system.masses.shape[0], integration.clock[0], integration.memory[0]
    u = coordinates_and_speeds(system, integration.z)[1]
    new = coordinates_and_speeds(system, integration.trial)[1]
    fastest = max(largest_turn(bodies, u), largest_turn(bodies, new))
    memory["turned"] = h * fastest / LONGEST_TURN
    return clock["error"] < 1.0 and memory["turned"] < 1.0


@kernel
def _accept(integration: AlphaIntegration, factor: float, system: System, work: Work):
    """Make the end of a step the state; a code."""
    clock, memory, rates, z = integration.clock[0], integration.memory[0], integration.rates, integration.z
    last, h = clock["counted"], clock["length"]
    copy(z, integration.old)
    copy(integration.trial, z)
    z[last] = integration.old[last] + 0.5 * h * (memory["power"] + memory["new_power"])
    memory["old_power"], memory["power"] = memory["power"], memory["new_power"]
    add_works(integration, TRAPEZOID, h)
    copy(rates[LAST], rates[BEFORE])
    copy(rates[NEW], rates[LAST])
    copy(rates[NEW_MEAN], rates[MEAN])
    copy(integration.state_rates[LAST], integration.state_rates[BEFORE])
    copy(integration.state_rates[NEW], integration.state_rates[LAST])
    advance(clock, memory, h)
    note_violation(integration, system, work)
    if integration.angles.shape[1] > 0:
        q = coordinates_and_speeds(system, z)[0]
        rotation_matrices(q, work.rotations[A])
        place_vectors(geometry_of(system, work), q)
        unwrap_angles(system, work, integration)
    if memory["fixed"] > 0.0:
        look_ahead_of_given(system, work, integration, rates[LAST])
    else:
        look_ahead(system, work, integration, rates[LAST], memory["passing"])
    return code_of_violation(integration)


@kernel
def _fill_row(integration: AlphaIntegration, t: float, report: Report, system: System, work: Work) -> Any:
    """Fill a report row at a time up to the present one; a code."""
    clock, angles, row = integration.clock[0], integration.angles, integration.clock[0]["row"]
    x = _place_row(system, integration, t)
    interpolate_angles(integration, x)
    copy(angles[EXPECTED], work.angles)
    converged = iterate(system, work, integration, t, 0.0, 0.0, 0.0)
    if is_doubtful(clock, work):
        _place_row(system, integration, t)
        _accelerations_between(system, integration, x, report.rates[row])
        fill_near_singular(integration, t, x, report, system, work)
        return READY
    if not converged:
        return STEP_VANISHED
    copy(integration.trial, report.states[row])
    copy(integration.rates[NEW], report.rates[row])
    complete(
        system, work, integration.trial, t, angles[EXPECTED], integration.memory[0]["new_power"], report, row
    )
    clock["row"] += 1
    return READY


@kernel
def _place_row(system: System, integration: AlphaIntegration, t: float) -> float:
    """Bring `trial` to a time up to the present one; return the fraction of the last step."""
    clock, x = integration.clock[0], 1.0
    copy(integration.z, integration.trial)
    if t < clock["t"] - SAME_TIME_IN_STEP * clock["step_length"]:
        x = (t - clock["step_start"]) / clock["step_length"]
        _between(system, integration, x, integration.trial)
    return x


@kernel
def _accelerations_between(system: System, integration: AlphaIntegration, x: float, ud: np.ndarray) -> None:
    """Fill ud (n,) with the slope of the speeds of `_between`."""
    old, z, rates, h = integration.old, integration.z, integration.rates, integration.clock[0]["step_length"]
    first = first_speed(system)
    for k in range(ud.shape[0]):
        i = first + k
        ud[k] = cubic_slope(x, old[i], z[i], h * rates[BEFORE, k], h * rates[LAST, k]) / h


_advance = time_loop(Method(_length, _attempt, _accept, _reject, _fill_row, contacts_of), SAME_TIME_IN_STEP)


@kernel
def integrate_rows(
    task: int, system: System, work: Work, integration: AlphaIntegration, report: Report, budget: int
) -> int:
    """Begin at the state z, or fill the rows of `report`, at most `budget` evaluations; a code.

    clock["row"] counts the rows filled.  The order of elimination must have been chosen.
    """
    if task == BEGIN:
        return _begin(integration, system, work)
    return _advance(integration, report, budget, system, work)


@allocating
def _between(system: System, integration: AlphaIntegration, x: float, point: np.ndarray) -> Any:
    """Fill point with the state at the fraction x of the last step."""
    clock, memory, old, z, n = (
        integration.clock[0],
        integration.memory[0],
        integration.old,
        integration.z,
        system.speed_scale.shape[0],
    )
    nq, h, bodies = first_speed(system), clock["step_length"], system.masses.shape[0]
    shift, before, after, mean = np.empty(n), np.empty(n), np.empty(n), np.empty(n)
    for k in range(n):
        before[k] = old[nq + k]
        mean[k] = 0.5 * h * (old[nq + k] + z[nq + k])
    shift_between(bodies, old[:nq], z[:nq], mean, shift)
    set_slope(bodies, shift, z[nq : nq + n], after)
    for body in range(bodies if largest_turn(bodies, shift) > FAR_TURN else 0):
        for k in range(6 * body + 3, 6 * body + 6):
            before[k] = after[k] = shift[k] / h
    for k in range(n):
        shift[k] = cubic(x, 0.0, shift[k], h * before[k], h * after[k])
    for i in range(nq):
        point[i] = old[i]
    turn_exactly(bodies, point[:nq], shift)
    for k in range(n):
        i = nq + k
        point[i] = cubic(x, old[i], z[i], h * integration.rates[BEFORE, k], h * integration.rates[LAST, k])
    for k in range(integration.state_rates.shape[1]):
        i, rates = nq + n + k, integration.state_rates
        point[i] = cubic(x, old[i], z[i], h * rates[BEFORE, k], h * rates[LAST, k])
    last = clock["counted"]
    point[last] = cubic(x, old[last], z[last], h * memory["old_power"], h * memory["power"])
    works_between(integration, x, h, point)
