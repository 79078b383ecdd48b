"""One step of the generalised-α method for constrained mechanisms, on the group of positions and attitudes.

Arnold, Brüls and Cardona, Numerische Mathematik 129 (2015), section 2: with the accelerations ud and
their means a,

    (1 - α_m) a' + α_m a = (1 - α_f) ud' + α_f ud,
    q' = q exp(h (u + h ((1/2 - β) a + β a'))),   u' = u + h ((1 - γ) a + γ a'),

parameters after Chung and Hulbert (1993) for the spectral radius ρ at infinity.  Unlike there, ud' meets
the constraints on accelerations, and positions and speeds are brought onto theirs within the same
iteration, by the shortest way: no constraint force oscillates for ρ = 1 or when the step changes.

Every iteration takes constraints and forces as they are; the matrix Zᵀ (M + γ' h D + β' h² K) Z of the
free motions is that of the first.

Errors of a method of order two add up, so that a step of length h may err by the share h/T of the tolerance
in a run of length T.  Near a singular position round-off of speeds grows with the inverse square of the way
to it: the longest step that is exact enough leads over the position, and no other comes near.
"""

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from .._jit import kernel, part
from ..constrained.accelerations import (
    SMALLEST_INERTIA,
    factorise_for_forces,
    fill_column,
    missing_forces,
    solve_rows,
)
from ..constrained.angle_unwrapping import EXPECTED, expect_angles
from ..constrained.forces import tangent_times
from ..constrained.projection import fill_residual, rate_gap
from ..constrained.report import TRIED, coordinates_and_speeds, fill_load_powers
from ..constrained.speeds import move
from ..constrained.system import CORRECTION, GAMMA, NO_INERTIA, PHI, PRODUCT, SOLVED, UNKNOWN, System, Work
from ..linalg.cholesky import cholesky
from ..linalg.number_rows import copy
from ..linalg.rank_revealing_lu import smallest_pivot
from ..signals import take_states
from .clock import LOOK, crosses_singularity
from .constrained_equations import fastest_change, firm_pivot, first_speed
from .error_norm import CAUTION, ITERATED, SLOWEST, displacement_tolerance, tolerance
from .signal_states import correct_states, error_of_trapezoid, know_end, predict_states
from .singular_ahead import NOISE, SPEED_ROUND_OFF, blur, look_ahead, round_off

if TYPE_CHECKING:
    from .integrations import AlphaIntegration


SAFETY, FASTEST = 0.85, 3.0
SHARE_BEFORE = 0.5  # of the step over a singular position that lies in front of it
SHORTEST_BEFORE = 0.15  # of a step before that one: it is left out
# After a step over the singular position that was not good enough: so short that a step before it is not left
# out, for which it must be below 1 / (1 + SHORTEST_BEFORE / SHARE_BEFORE); else it would be tried for ever.
SHORTENED = 0.75
MOST_PASSING = 30.0  # steps, that the one over a singular position may be long
SAME_TIME_IN_STEP = 1e-9  # of a step: times this near to each other are one
OF_ERROR = 1e-6  # of the step's error: what the iterations may leave in a step of given length
ITERATED_BLURRED = 0.3  # of the tolerance: what the iterations may leave where that is all round-off
LEAST_PASSING = 0.1  # of a given step: way over a singular position on which none ends, 5 times what is FOUND
FAR_PIVOT = 5.0  # of one that is firm: where the smallest is above, given steps alone fix how far to look
PASSED_ON = 1.0  # error at the end of a run, in tolerances, if errors of steps only added up
PASSING = 0.005  # of the tolerance: error of a step over a singular position, of which a run has a few


@kernel
def share_of(clock: np.void, memory: np.void, work: Work, h: float, fastest: float) -> float:
    """The share of the tolerance that a step of length h may err by, all of it where lengths are given.

    The few steps over singular positions have a share of their own.  No share is below what the round-off
    of speeds makes of the accelerations, which change them at the rate `fastest`, 1/s.
    """
    if memory["fixed"] > 0.0:
        return 1.0
    share = min(1.0, PASSED_ON * h / memory["span"])
    if crosses_singularity(clock, h):
        share = max(share, PASSING)
    noise = NOISE * round_off(work)
    # Within the least pivot's way to zero, speeds change as much as that pivot does.
    change = h * fastest * (round_off(work) / SPEED_ROUND_OFF) ** 0.5
    return max(share, noise * min(1.0, change) / clock["rtol"])


@kernel
def left_over(clock: np.void, memory: np.void, work: Work, share: float) -> float:
    """Return what iterations may leave of a step's share: steps of given length have their own error."""
    if memory["fixed"] > 0.0:
        return OF_ERROR * clock["error"]
    blurred = blur(work, share * clock["rtol"])
    return share * (ITERATED if blurred == 1.0 else ITERATED_BLURRED * blurred)


@kernel
def next_length(clock: np.void, memory: np.void) -> float:
    """Length of the next step: steps of given length end at whole multiples."""
    left = clock["stop"] - clock["t"]
    if memory["fixed"] > 0.0:
        multiples = _given_steps(clock, memory)
        left = min(left, memory["start"] + (memory["whole"] + multiples) * memory["fixed"] - clock["t"])
        step = left if multiples > 1 and not clock["rejected"] else clock["step"]
    else:
        step = _laid_out(clock, memory)
    return step if abs(step - left) <= SAME_TIME_IN_STEP * left else min(step, left)


@kernel
def look_ahead_of_given(system: System, work: Work, integration: Any, ud: np.ndarray) -> None:
    """Note a singular position ahead of given steps, and the way over it on which round-off may rule a row.

    ud (n,): accelerations at the state, whose factors are at hand.
    """
    clock, memory = integration.clock[0], integration.memory[0]
    least, firm = smallest_pivot(work.diagonal, work.rank[0]), firm_pivot(clock)
    reach = memory["fixed"] if least > FAR_PIVOT * firm else math.inf
    look_ahead(system, work, integration, ud, reach)
    memory["passing"] = LEAST_PASSING * memory["fixed"]
    if math.isfinite(clock["singular"]):
        # Pivots vanish as the way does.
        memory["passing"] += 2.0 * (clock["singular"] - clock["t"]) * firm / least


@kernel
def _given_steps(clock: np.void, memory: np.void) -> int:
    """Return how many steps of given length are made in one: none ends near a singular position."""
    way = clock["singular"] - clock["t"]
    begin, end = way - 0.5 * memory["passing"], way + 0.5 * memory["passing"]
    rest = memory["start"] + (memory["whole"] + 1) * memory["fixed"] - clock["t"]
    if not (way > 0.0 and begin < rest < end):
        return 1
    return 1 + math.ceil((end - rest) / memory["fixed"])


@kernel
def _laid_out(clock: np.void, memory: np.void) -> float:
    """Length of a step so that one of the length `passing` leads over the singular position ahead.

    Round-off of speeds grows towards that position, so that the longest step that is exact enough leads
    over it; those before it are equal.
    """
    step, way = clock["step"], clock["singular"] - clock["t"]
    before = way - SHARE_BEFORE * memory["passing"]
    if not (0.0 < way < LOOK * memory["passing"] and before < LOOK * step):
        return step
    if before <= SHORTEST_BEFORE * step:
        return way / SHARE_BEFORE
    return before / math.ceil(before / step)


@kernel
def retreat(clock: np.void, memory: np.void, tried: float, h: float) -> None:
    """After a step of length `tried` that was not found, or not well enough: one of length h."""
    over = crosses_singularity(clock, tried)
    if over:
        h = min(h, SHORTENED * tried)
    clock["step"] = min(clock["step"], h)
    # A stop in front of the position cuts off the step over it, which would be laid out and cut off again.
    if over or not next_length(clock, memory) < tried:
        memory["passing"] = h
    clock["rejections"] += 1
    clock["rejected"] = 1
    memory["left"] = 1.0


@kernel
def factor_of(clock: np.void, memory: np.void) -> float:
    """Length of the next step by that of the one behind, whose error is known."""
    factor = SAFETY * clock["error"] ** -0.5 if clock["error"] > 0.0 else FASTEST
    if memory["turned"] > 0.0:
        factor = min(factor, SAFETY / memory["turned"])
    return min(1.0 if clock["rejected"] else FASTEST, max(SLOWEST, factor))


@kernel
def advance(clock: np.void, memory: np.void, h: float) -> None:
    """The time of the state, and the length of the next step."""
    clock["step_start"], clock["step_length"] = clock["t"], h
    t, same = clock["t"] + h, SAME_TIME_IN_STEP * h
    if memory["fixed"] > 0.0:
        multiple = round((t - memory["start"]) / memory["fixed"])
        whole = memory["start"] + multiple * memory["fixed"]
        if abs(whole - t) <= same:
            t = whole
            memory["whole"] = multiple
        clock["step"] = memory["fixed"]
    elif not crosses_singularity(clock, h):
        clock["step"] = h * factor_of(clock, memory)
        memory["passing"] = max(clock["step"], _passing_step(clock, memory, h))
    clock["t"] = clock["stop"] if abs(clock["stop"] - t) <= same else t
    clock["rejected"] = 0
    clock["steps"] += 1


@kernel
def _passing_step(clock: np.void, memory: np.void, h: float) -> float:
    """Length of a step whose error is what one over a singular position may have, after one of length h."""
    error = clock["error"] * memory["share"]
    longest = MOST_PASSING * clock["step"]
    return min(longest, SAFETY * h * (PASSING / error) ** (1.0 / 3.0)) if error > 0.0 else longest


# Rows of the accelerations kept (5, n): of the step's end as it is found, its start, the start of the step
# before; the means at both ends.
NEW, LAST, BEFORE, MEAN, NEW_MEAN = 0, 1, 2, 3, 4
# Rows of what is missing in the equations (3, m), and of the corrections that close these gaps (3, n).
ACCELERATION_GAP, SPEED_GAP, POSITION_GAP = 0, 1, 2


@part
def step_error(system: System, integration: "AlphaIntegration", h: float):
    """Error of the step in tolerances, from the growth of the accelerations.

    By Taylor's series, with s = α_m - α_f: (1/12 + s²/4) h³ d(ud)/dt in positions and
    (1/12 + s²/2) h³ d²(ud)/dt² in speeds, the means being ud + s h d(ud)/dt + 3/2 s² h² d²(ud)/dt² in equal
    steps.  For ρ = 0 this is the constant 7/12 of the two-step method that u then follows.
    """
    clock, rates, n = integration.clock[0], integration.rates, system.speed_scale.shape[0]
    first, rho = first_speed(system), integration.memory[0]["rho"]
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
    states = integration.state_rates
    total += error_of_trapezoid(system, integration, states[NEW], states[LAST], states[BEFORE], h)
    return (0.5 * total / n) ** 0.5


@part
def correction_size(system: System, integration: "AlphaIntegration", by_speed: float):
    """The change of the speeds by the correction of the accelerations, in tolerances."""
    clock, n, total = integration.clock[0], system.speed_scale.shape[0], 0.0
    first = first_speed(system)
    for k in range(n):
        scale = tolerance(clock, integration.units[first + k], abs(integration.trial[first + k]))
        total += (by_speed * integration.corrections[ACCELERATION_GAP, k] / scale) ** 2
    return (total / n) ** 0.5


MOST_ITERATIONS = 12
STILL_ITERATIONS = 3  # of a state: positions, speeds, and accelerations that belong to both
FLOOR = 1e-13  # of the speeds: round-off
LEAST = 1e-2  # contraction that is trusted: the first of a step is better than those that follow
CLOSED_BY_ONE_MORE = 1e-10  # scaled gap that one more correction brings to round-off


@kernel
def parameters(rho: float) -> tuple[float, float, float, float]:
    """α_m, α_f, β, γ for the spectral radius rho at infinity."""
    alpha_m, alpha_f = (2.0 * rho - 1.0) / (rho + 1.0), rho / (rho + 1.0)
    gamma = 0.5 + alpha_f - alpha_m
    return alpha_m, alpha_f, 0.25 * (gamma + 0.5) ** 2, gamma


@part
def solve_step(system: System, work: Work, integration: "AlphaIntegration", h: float) -> bool:
    """Find the state `trial` at the end of a step of length h from z; returns whether it was found."""
    clock = integration.clock[0]
    alpha_m, alpha_f, beta, gamma = parameters(integration.memory[0]["rho"])
    share = (1.0 - alpha_f) / (1.0 - alpha_m)
    _predict(system, work, integration, h)
    if not iterate(system, work, integration, clock["t"] + h, share * beta * h * h, share * gamma * h, h):
        return False
    _finish(integration, alpha_m, alpha_f)
    return True


@kernel
def iterate(
    system: System,
    work: Work,
    integration: "AlphaIntegration",
    t: float,
    by_position: float,
    by_speed: float,
    h: float,
) -> bool:
    """Bring `trial` and the accelerations NEW to the equations at t; returns whether they came there.

    An acceleration moves positions and speeds by so much.  With h = 0 by nothing: the state is the one at
    t, and is brought onto the constraints.
    """
    clock, memory, states = integration.clock[0], integration.memory[0], integration.state_rates
    # The first correction is trusted somewhat less than the last of the step before was.
    quality, left, before, gap_before = 0.0, memory["left"] ** CAUTION, 0.0, np.inf
    for iteration in range(MOST_ITERATIONS):
        clock["evaluations"] += 1
        know_end(system, integration, states[LAST], h)
        clock["fault"] = _evaluate(system, work, integration, t)
        system.signals.ahead[0] = 0.0
        if clock["fault"] == SOLVED and (iteration == 0 or work.quality[0] != quality):
            # Other speeds are free from now on where the quality has changed.
            clock["fault"] = _set_matrix(system, work, integration, by_position, by_speed)
        if clock["fault"] != SOLVED:
            return False
        quality = work.quality[0]
        size, gap = _correct(system, work, integration, by_position, by_speed)
        if h > 0.0:
            size = max(size, correct_states(system, integration, states[NEW], states[LAST], h))
        if h == 0.0:
            # A row from afar needs more of them; equations that repeat others never close better.
            if iteration >= STILL_ITERATIONS - 1 and (gap < CLOSED_BY_ONE_MORE or not gap < 0.5 * gap_before):
                return True
            gap_before = gap
            continue
        if iteration > 0:
            contraction = size / before if before > 0.0 else 0.0
            # The second correction answers to the gaps that the first one closed.
            if iteration > 1 and not (contraction < 1.0 or size < FLOOR / clock["rtol"]):
                return False
            left = memory["left"] = max(contraction / (1.0 - min(contraction, 0.5)), LEAST)
        fastest = (
            0.0 if memory["fixed"] > 0.0 else fastest_change(system, integration, integration.rates[LAST])
        )
        share = memory["share"] = share_of(clock, memory, work, h, fastest)
        clock["error"] = step_error(system, integration, h) / share
        enough = max(left_over(clock, memory, work, share), FLOOR / clock["rtol"])
        if left * size < enough and gap < CLOSED_BY_ONE_MORE:
            return True
        before = size
    return False


@part
def _predict(system: System, work: Work, integration: "AlphaIntegration", h: float) -> None:
    """The end of the step by accelerations that go on as before."""
    memory, n = integration.memory[0], system.speed_scale.shape[0]
    rates, length = integration.rates, integration.clock[0]["step_length"]
    alpha_m, alpha_f, beta, gamma = parameters(memory["rho"])
    step = work.vectors[CORRECTION, :n]
    copy(integration.z, integration.trial)
    q, u = coordinates_and_speeds(system, integration.trial)
    for k in range(n):
        last = rates[LAST, k]
        rates[NEW, k] = last
        if length > 0.0:
            ahead = (last - rates[BEFORE, k]) * h / length
            rates[NEW, k] += ahead
            if h == memory["mean_length"]:
                rates[MEAN, k] = last + (rates[MEAN, k] - last)
            else:
                # The mean belongs to a time that is a fixed part of a step away.  One that is carried over
                # would alternate, by more and more where steps grow.
                rates[MEAN, k] = last + (alpha_m - alpha_f) * ahead
        mean = rates[MEAN, k]
        new = ((1.0 - alpha_f) * rates[NEW, k] + alpha_f * last - alpha_m * mean) / (1.0 - alpha_m)
        step[k] = h * (u[k] + h * ((0.5 - beta) * mean + beta * new))
        u[k] += h * ((1.0 - gamma) * mean + gamma * new)
    memory["mean_length"] = h
    states = integration.state_rates
    predict_states(system, integration, states[NEW], states[LAST], states[BEFORE], h)
    turn_exactly(system.masses.shape[0], q, step)
    expect_angles(system, work, integration, h)
    copy(integration.angles[EXPECTED], work.angles)


@part
def turn_exactly(bodies: int, q: np.ndarray, step: np.ndarray) -> None:
    """Move q by the displacements and rotation vectors (body axes) `step` (n,), of any size."""
    for body in range(bodies):
        k, s = 7 * body, 6 * body
        for i in range(3):
            q[k + i] += step[s + i]
        x, y, z = step[s + 3], step[s + 4], step[s + 5]
        angle = (x * x + y * y + z * z) ** 0.5
        c = math.cos(0.5 * angle)
        f = math.sin(0.5 * angle) / angle if angle > 1e-8 else 0.5
        x, y, z = f * x, f * y, f * z
        e0, e1, e2, e3 = q[k + 3], q[k + 4], q[k + 5], q[k + 6]
        q[k + 3] = c * e0 - e1 * x - e2 * y - e3 * z
        q[k + 4] = c * e1 + e0 * x - e3 * y + e2 * z
        q[k + 5] = c * e2 + e3 * x + e0 * y - e1 * z
        q[k + 6] = c * e3 - e2 * x + e1 * y + e0 * z
    for k in range(6 * bodies, step.shape[0]):
        q[k + bodies] += step[k]


@part
def _evaluate(system: System, work: Work, integration: "AlphaIntegration", t: float) -> int:
    """Everything that the equations of motion say of `trial` at t: forces and gaps; a code."""
    q, u = coordinates_and_speeds(system, integration.trial)
    code = factorise_for_forces(system, work, q)
    if code != SOLVED:
        return code
    gaps, ud = integration.gaps, integration.rates[NEW]
    fill_residual(system, work, q, t, integration.angles[EXPECTED])
    rate_gap(system, work, u, t)
    for row in range(gaps.shape[1]):
        gaps[POSITION_GAP, row] = -work.rows[PHI, row]
        gaps[SPEED_GAP, row] = work.rows[GAMMA, row]
    take_states(system.signals, integration.trial, q.shape[0] + u.shape[0])
    integration.memory[0]["new_power"] = missing_forces(
        system, work, q, u, t, ud, gaps[ACCELERATION_GAP], integration.missing[ACCELERATION_GAP]
    )
    copy(system.signals.rates, integration.state_rates[NEW])
    fill_load_powers(work, integration.load_powers[TRIED])
    return code


@part
def _set_matrix(
    system: System, work: Work, integration: "AlphaIntegration", by_position: float, by_speed: float
) -> int:
    """Zᵀ (M + by_speed D + by_position K) Z where everything stands, and its Cholesky factor; a code."""
    n = system.speed_scale.shape[0]
    rank, matrix, Z = work.rank[0], integration.newton.reduced, work.motions
    column, product = work.vectors[UNKNOWN], work.vectors[PRODUCT]
    for f in range(n - rank):
        for k in range(n):
            column[k] = Z[k, f] * system.speed_scale[k]
        tangent_times(system, work, by_position, by_speed, column, product)
        fill_column(system, work, product, f, matrix)
    return NO_INERTIA if cholesky(matrix, n - rank, SMALLEST_INERTIA) else SOLVED


@part
def _correct(
    system: System, work: Work, integration: "AlphaIntegration", by_position: float, by_speed: float
) -> tuple[float, float]:
    """Newton's correction; returns its size in tolerances and the largest scaled gap before it."""
    n = system.speed_scale.shape[0]
    q, u = coordinates_and_speeds(system, integration.trial)
    gaps, corrections = integration.gaps, integration.corrections
    gap, kinds = _largest(system, work, gaps), 3 if gaps.shape[1] > 0 else 1
    for row in range(gaps.shape[1]):
        gaps[SPEED_GAP, row] -= by_speed * gaps[ACCELERATION_GAP, row]
        gaps[POSITION_GAP, row] -= by_position * gaps[ACCELERATION_GAP, row]
    solve_rows(
        system, integration.newton, integration.missing, gaps, corrections[:kinds], integration.free[:kinds]
    )
    step = corrections[ACCELERATION_GAP]
    for k in range(n):
        integration.rates[NEW, k] += step[k]
        u[k] += by_speed * step[k]
    size = correction_size(system, integration, by_speed)
    for k in range(n):
        step[k] *= by_position
        if kinds > 1:
            u[k] += corrections[SPEED_GAP, k]
            step[k] += corrections[POSITION_GAP, k]
    move(system.masses.shape[0], q, step)
    return size, gap


@part
def _largest(system: System, work: Work, gaps: np.ndarray) -> float:
    """The largest scaled gap of positions and speeds, of the independent equations."""
    largest = 0.0
    for kind in (SPEED_GAP, POSITION_GAP):
        for k in range(work.rank[0]):
            row = work.order[k]
            largest = max(largest, abs(gaps[kind, row]) / system.row_scale[row])
    return largest


@part
def _finish(integration: "AlphaIntegration", alpha_m: float, alpha_f: float) -> None:
    """The means that belong to the accelerations found."""
    rates = integration.rates
    for k in range(rates.shape[1]):
        new = (1.0 - alpha_f) * rates[NEW, k] + alpha_f * rates[LAST, k] - alpha_m * rates[MEAN, k]
        rates[NEW_MEAN, k] = new / (1.0 - alpha_m)
