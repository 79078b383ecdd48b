"""Stepping of a constrained mechanism through time by Radau's method of order 5 in compiled code.

Steps keep the error of a step within the tolerance; they do not depend on how the report rows are cut into
calls.  The end of every step is brought onto positions and speeds to round-off by the shortest way in the
metric of the matrix of the step, so that stiff motions stay at rest.  Rows inside a step come from Hermite's
quintic through coordinates, their rates and accelerations at both ends, and are brought there as well.

At a singular position two motions of a mechanism cross.
Accelerations are what the equations miss over a pivot that vanishes there.  Iterations of a step whose
stages lie near do not converge, and shorter steps only come nearer: each ends a part of the way in front of
it.  So a step ends as far behind as it begins in front, by accelerations that go on as before.  Whether
they do, the equations say at its end, where they are as firm as at its beginning: a motion with a corner,
or one that would come onto another branch, has other accelerations there.
"""

from typing import Any

import numpy as np

from ...memory import paged_zeros
from .._jit import allocating, kernel
from ..constrained.accelerations import factorise_for_forces, fill_forces
from ..constrained.angle_unwrapping import EXPECTED, MOST_TURNED, NEW, expect_angles, unwrap_angles
from ..constrained.dry_friction import has_elements
from ..constrained.report import NOW, TRIED, Report, complete, coordinates_and_speeds, fill_load_powers
from ..constrained.system import NO_INERTIA, SOLVED, System, Work
from ..laws import POWER
from ..linalg.number_rows import copy
from ..linalg.rank_revealing_lu import BRANCHING, smallest_pivot
from .clock import BEGIN, READY, STEP_VANISHED, new_clock, step_before_singularity
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
)
from .error_norm import MOST_MOVED, SLOWEST, moved_by_time, tolerance
from .integrations import RadauIntegration
from .radau5_step import (
    BEHIND_STEP,
    FASTEST,
    LAST_STEP,
    QUADRATURE,
    SAFETY,
    STAGES,
    START,
    TIMES,
    WEIGHTS,
    accelerations_between,
    close_trial,
    moved,
    next_factor,
    node_time,
    place_row,
    place_stages,
    place_trial,
    predict,
    prepare,
    project_state,
    renew_matrices,
    solve_step,
    step_error,
    steps_within_rotation_limit,
    work_error,
    work_scale,
)
from .singular_ahead import blur, look_ahead, most_declined
from .time_loop import Method, time_loop

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
    clock["error"], power, trial = 0.0, 0.0, integration.trial.copy()
    expected = rates[START + STAGES].copy()
    for again in range(2):
        if again:
            _bend(integration, expected, h)
            for _ in range(2):
                place_stages(system, integration, h)
        place_trial(system, integration, STAGES - 1)
        if not expect_angles(system, work, integration, h) < MOST_TURNED:
            return False
        copy(integration.trial, trial)
        copy(rates[START + STAGES], expected)
        clock["evaluations"] += 1
        code, power = project_state(system, work, integration, clock["t"] + h, rates[START + STAGES])
        if code != SOLVED or work.quality[0] != clock["pivot_order"]:
            return False
        clock["error"] = max(
            clock["error"],
            (AFTER_BENDING if again else BEFORE_BENDING) * h * _unexpected(system, integration, expected),
        )
    pivot = most_declined(work)
    behind = -work.diagonal[pivot] / work.pivots[pivot]
    if not 1.0 / UNEVEN < behind < UNEVEN:
        return False
    of_work = h * abs(_spread_power(integration, work, power)) / work_scale(integration)
    clock["error"] = max(clock["error"], moved(integration, trial), OF_POWER * of_work) / blur(
        work, clock["rtol"]
    )
    return clock["error"] < 1.0


@kernel
def _bend(integration: "RadauIntegration", expected: np.ndarray, h: float) -> None:
    """Let the accelerations of the stages go through those found at the end."""
    rates, ratio = integration.rates, h / integration.clock[0]["step_length"]
    for stage in range(STAGES):
        weight = 1.0
        for node in range(STAGES + 1):
            at = node_time(node)
            weight *= (1.0 + ratio * TIMES[stage] - at) / (1.0 + ratio - at)
        if stage < STAGES - 1:
            for k in range(expected.shape[0]):
                rates[START + 1 + stage, k] += weight * (rates[START + STAGES, k] - expected[k])


@kernel
def _unexpected(system: System, integration: "RadauIntegration", expected: np.ndarray) -> float:
    """By how many tolerances of the speeds, a second, the accelerations at the end are not those expected."""
    clock, n, total = integration.clock[0], expected.shape[0], 0.0
    first = first_speed(system)
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


WORN_MATRICES = 0.01  # what an iteration may leave before the matrices are renewed
BRANCHING_START = 0.1  # of the smallest pivot at the start, where that is tiny: smaller ones are singular
SHARE = 0.45  # of a step in front of a singular position
NO_ORDER = 0.0  # quality of matrices that are not those of the state

MEMORY = np.dtype(
    [
        ("last_error", np.float64),  # error of the last accepted step, in tolerances, 0 before the first
        ("left", np.float64),  # error that an iteration leaves, as a share of its size, seen last
        ("quality", np.float64),  # of the order of elimination that the matrices belong to, no unit
        ("power", np.float64),  # of drivers and loads that store no energy, at t, W
        ("old_power", np.float64),  # at the start of the last step, W
        ("branching", np.float64),  # scaled pivot below which a position is singular
    ]
)


def new_integration(work: Any, angles: Any, n_loads: int = 0, states: int = 0) -> RadauIntegration:
    """An integration at time 0 with an empty state, for the `work` of a mechanism and so many angles.

    The mechanical work of the first `n_loads` loads is integrated; `states`: those of signals.
    """
    n = work.motions.shape[0]
    size = (counted := 2 * n + work.mass.shape[0] + states) + 1 + n_loads
    return RadauIntegration(
        new_clock(counted), np.zeros(1, MEMORY),
        np.zeros(size), np.zeros(size), np.zeros(size), np.ones(size),
        np.zeros((3, angles)), np.zeros((2 * (STAGES + 1), n)),
        np.zeros((STAGES, n)), np.zeros((STAGES, n)), np.zeros((STAGES, n)), np.zeros((STAGES, n)),
        np.zeros((STAGES, n)), np.zeros(n), np.zeros(STAGES), np.zeros((STAGES + 2, n_loads)),
        np.zeros((STAGES, n)),
        paged_zeros((STAGES, n, n)), paged_zeros((3, n, n)), paged_zeros((n, n), complex),
        np.zeros(n), np.zeros(n, complex), work._replace(reduced=paged_zeros((n, n))),
        np.zeros((STAGES, states)), np.zeros((STAGES + 2, states)),
    )  # fmt: skip


@kernel
def _begin(integration: RadauIntegration, system: System, work: Work) -> int:
    clock, memory, rates = integration.clock[0], integration.memory[0], integration.rates
    clock["step_start"], memory["left"] = clock["t"], 1.0
    copy(integration.z, integration.trial)
    copy(integration.angles[NEW], integration.angles[EXPECTED])
    code = _renew(system, work, integration)
    if code == SOLVED and not prepare(integration, work.motions.shape[0] - work.rank[0], 0.0):
        code = NO_INERTIA
    if code == SOLVED:
        code, memory["power"] = project_state(system, work, integration, clock["t"], rates[START])
        copy(system.signals.rates, integration.state_rates[START])
    clock["fault"] = code
    if code != SOLVED:
        return STEP_VANISHED
    copy(integration.trial, integration.z)
    copy(integration.z, integration.old)
    fill_load_powers(work, integration.load_powers[NOW])
    memory["branching"] = min(BRANCHING, BRANCHING_START * smallest_pivot(work.diagonal, work.rank[0]))
    for node in range(STAGES + 1):
        copy(rates[START], rates[LAST_STEP + node])
    clock["step"] = first_step(system, integration, rates[START])
    return READY


@kernel
def _renew(system: System, work: Work, integration: RadauIntegration) -> int:
    """The matrices of the state z anew; a code."""
    q, u = coordinates_and_speeds(system, integration.z)
    code = factorise_for_forces(system, work, q)
    if code == SOLVED:
        if has_elements(system.loads):
            # Their slopes change by all within a step: those of a trial that failed may not be numbers.
            fill_forces(system, work, q, u, integration.clock[0]["t"])
        renew_matrices(system, work, integration.matrices)
        integration.memory[0]["quality"] = work.quality[0]
    return code


@kernel
def _length(integration: RadauIntegration, system: System, work: Work):
    """Return the length of the step to try, whose matrices are renewed where they are of another position."""
    clock = integration.clock[0]
    copy(integration.angles[NEW], work.angles)
    if not _is_current(integration, system, work):
        return 0.0
    return min(step_before_singularity(clock, clock["step"], SHARE), clock["stop"] - clock["t"])


@kernel
def _is_current(integration: RadauIntegration, system: System, work: Work):
    """Renew the matrices where another order of elimination holds; return whether they are those of z."""
    if work.quality[0] != integration.memory[0]["quality"]:
        integration.clock[0]["fault"] = _renew(system, work, integration)
        return integration.clock[0]["fault"] == SOLVED
    return True


@kernel
def _attempt(integration: RadauIntegration, h: float, system: System, work: Work):
    """`_try_step` or, in front of a singular position, a step over it; 0 where it begins at one."""
    clock, memory, factor = integration.clock[0], integration.memory[0], 0.0
    way, left = clock["singular"] - clock["t"], clock["stop"] - clock["t"]
    over = min(2.0 * way, left) if 0.0 < way < h and clock["step_length"] > 0.0 else 0.0
    if over > way and singular_step(system, work, integration, over):
        clock["length"], factor = over, 1.0
    else:
        if over > way:
            copy(integration.angles[NEW], work.angles)
            if not _is_current(integration, system, work):
                return -0.5
        factor = _try_step(system, work, integration, h)
    if factor > 0.0 and smallest_pivot(work.diagonal, work.rank[0]) < memory["branching"]:
        return 0.0 if _is_singular(work, clock, memory) else -0.5
    return factor


@kernel
def _reject(integration: RadauIntegration, h: float, factor: float, system: System, work: Work) -> None:
    clock, memory = integration.clock[0], integration.memory[0]
    clock["step"] = h * factor
    clock["rejections"] += 1
    clock["rejected"] += 1
    memory["left"], memory["quality"] = 1.0, NO_ORDER


@allocating
def _try_step(system: System, work: Work, integration: RadauIntegration, h: float) -> float:
    """Bring `trial` to the end of a step: the factor for the next one, or, negative, for another try."""
    clock = integration.clock[0]
    if not solve_step(system, work, integration, h):
        return -0.5
    blurred = blur(work, clock["rtol"])
    error = max(step_error(system, work, integration, h), work_error(integration, h)) / blurred
    clock["error"] = error
    angles = steps_within_rotation_limit(system, integration)
    factor = min(next_factor(clock, integration.memory[0], h, error), SAFETY * angles)
    if not (error < 1.0 and angles > 1.0):
        return -max(SLOWEST, factor) if error < 1e10 else -SLOWEST
    place_trial(system, integration, STAGES - 1)
    if not expect_angles(system, work, integration, h) < MOST_TURNED:
        return -0.5
    trial = integration.trial.copy()
    clock["fault"] = close_trial(system, work, integration, clock["t"] + h)
    if clock["fault"] != SOLVED:
        return -0.25
    if not moved(integration, trial) < MOST_MOVED * blurred + moved_by_time(integration, h):
        return -0.5
    return min(1.0 if clock["rejected"] else FASTEST, max(SLOWEST, factor))


@kernel
def _accept(integration: RadauIntegration, factor: float, system: System, work: Work):
    """Make the end of a step the state; a code."""
    clock, memory, rates, z = integration.clock[0], integration.memory[0], integration.rates, integration.z
    end, h = clock["counted"], clock["length"]
    copy(z, integration.old)
    copy(integration.trial, z)
    z[end] = integration.old[end]
    for stage in range(STAGES):
        z[end] += h * WEIGHTS[STAGES - 1, stage] * integration.powers[stage]
    memory["old_power"], memory["power"] = memory["power"], integration.powers[STAGES - 1]
    add_works(integration, QUADRATURE, h)
    for node in range(STAGES + 1):
        copy(rates[START + node], rates[LAST_STEP + node])
    copy(rates[LAST_STEP + STAGES], rates[START])
    copy(integration.state_rates[START], integration.state_rates[BEHIND_STEP])
    copy(integration.state_rates[START + STAGES], integration.state_rates[START])
    clock["step_start"], clock["step_length"] = clock["t"], h
    clock["t"] = clock["stop"] if h >= clock["stop"] - clock["t"] else clock["t"] + h
    clock["step"] = h * factor
    clock["rejected"], memory["last_error"] = 0, clock["error"]
    clock["steps"] += 1
    note_violation(integration, system, work)
    unwrap_angles(system, work, integration)
    if memory["left"] > WORN_MATRICES or work.quality[0] != memory["quality"]:
        renew_matrices(system, work, integration.matrices)
        memory["quality"] = work.quality[0]
    look_ahead(system, work, integration, rates[START], clock["step"])
    return code_of_violation(integration)


@kernel
def _is_singular(work: Work, clock: np.void, memory: np.void):
    """Return whether a pivot at the end of the last step was as good as zero."""
    for k in range(work.rank[0] if clock["steps"] > 0 else 0):
        if abs(work.pivots[k]) < 10.0 * memory["branching"]:
            return True
    return False


@kernel
def _fill_row(integration: RadauIntegration, t: float, report: Report, system: System, work: Work) -> Any:
    """Fill a report row at a time up to the present one; a code."""
    clock, angles, row = integration.clock[0], integration.angles, integration.clock[0]["row"]
    x = place_row(system, integration, t)
    interpolate_angles(integration, x)
    clock["fault"], power = project_state(system, work, integration, t, report.rates[row])
    if is_doubtful(clock, work):
        place_row(system, integration, t)
        accelerations_between(integration, x, report.rates[row])
        fill_near_singular(integration, t, x, report, system, work)
        return READY
    if clock["fault"] != SOLVED:
        return STEP_VANISHED
    copy(integration.trial, report.states[row])
    complete(system, work, integration.trial, t, angles[EXPECTED], power, report, row)
    clock["row"] += 1
    return READY


_advance = time_loop(Method(_length, _attempt, _accept, _reject, _fill_row, contacts_of))


@kernel
def integrate_rows(
    task: int, system: System, work: Work, integration: RadauIntegration, report: Report, budget: int
) -> int:
    """Begin at the state z, or fill the rows of `report`, at most `budget` evaluations; a code.

    clock["row"] counts the rows filled.  The order of elimination must have been chosen.
    """
    if task == BEGIN:
        return _begin(integration, system, work)
    return _advance(integration, report, budget, system, work)
