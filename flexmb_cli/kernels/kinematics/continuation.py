"""The continuation through time of a kinematic analysis: predict, correct, check, and report.

Young (1996), section 5.2 (procedure KINEM).  Between report times the continuation takes the steps it
needs: a step counts only if the positions, velocities and accelerations at its two ends belong to
one smooth curve, so that a mechanism is never carried over to another way of assembling it.

The factors of Φ_q are an argument: `follow` has dense ones, `follow_sparse` those of entries other than zero.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from .._jit import allocating, kernel
from . import constraints as equations
from .joints import driver
from .newton import (
    CONVERGED,
    DENSE,
    ITERATIONS,
    OF_COORDINATE,
    PHI,
    SPARSE,
    LinearSolver,
    SparseWork,
    System,
    Work,
    largest,
    make_work,
    newton_by,
    rates_by,
)

ROOM_TO_GROW = 1.0 / 64.0  # twice the step makes the defect 32 times as large
WHOLE = 1e-6  # the clock rounds the length of a step
SMALLEST_PART = 2.0**-26  # of the last step that went well: below, the way is barred
CLOCK_ROUND_OFF = 2e-15  # of the time: shorter steps do not move the clock
# Scaled way within which det Φ_q may change its sign: shorter ones come so near to the bifurcation that
# round-off hides which curve is smooth.
BIFURCATION_LENGTH = 1e-4
# Places in `clock`: time reached, step to try (0: assemble first), sign of det Φ_q, last step taken,
# attempts left before control returns to the caller, iterations spent on the row so far.
TIME, NEXT_LENGTH, SIGN, LAST_LENGTH, BUDGET, SPENT = 0, 1, 2, 3, 4, 5
CLOCK_SIZE = 6


@kernel
def step_to(clock: np.ndarray, target: float) -> float:
    """Return the end of the step to try next: the target, or a point at most halfway to it."""
    left = target - clock[TIME]
    return target if clock[NEXT_LENGTH] >= left else clock[TIME] + min(clock[NEXT_LENGTH], 0.5 * left)


@kernel
def acceptable(clock: np.ndarray, off: float, moved: float, sign: int) -> bool:
    """Return whether a step may be taken: on one smooth curve, and with det Φ_q of one sign.

    The ways of assembling a mechanism are separated by positions at which det Φ_q is zero.  Where two
    of them come close, the other can look smoother than the true one; the sign distinguishes them.  A
    sign that changes on a way too short for a narrow pass to hide in is a true bifurcation.
    """
    if clock[NEXT_LENGTH] == 0.0:
        return off < np.inf
    if off > 1.0:
        return False
    return sign == clock[SIGN] or moved <= BIFURCATION_LENGTH


@kernel
def after_success(clock: np.ndarray, t_new: float, off: float, sign: int) -> None:
    """Move the clock; a step taken whole and with room to spare may be doubled, the first one is free."""
    h = t_new - clock[TIME]
    if clock[NEXT_LENGTH] == 0.0:
        clock[NEXT_LENGTH] = np.inf
    elif h >= (1.0 - WHOLE) * clock[NEXT_LENGTH] and off <= ROOM_TO_GROW:
        clock[NEXT_LENGTH] = 2.0 * h
    if h > 0.0:
        clock[LAST_LENGTH] = h
    clock[TIME] = t_new
    clock[SIGN] = sign


@kernel
def is_barred(clock: np.ndarray, target: float) -> bool:
    """Return whether the next step is too short to be worth a try."""
    tick = CLOCK_ROUND_OFF * max(abs(clock[TIME]), abs(target))
    return clock[NEXT_LENGTH] <= max(SMALLEST_PART * clock[LAST_LENGTH], tick)


# Position defect allowed between the ends of a step, in the length scale or of Euler parameters, and
# as a part of the way moved.  Another branch is as far off as the way to it is long.
SMOOTH = 1e-2
SMOOTH_PART = 0.1
TINY_LENGTH = 1e-9
LARGEST_TURN = 1.1  # rad that a driver may turn in one step
NO_LIMIT = 1e3
STEP_ITERATIONS = 20
LARGEST_ASSEMBLY_CORRECTION = 0.5

# Rows of `state` and of `out`.
POSITION, VELOCITY, ACCELERATION = 0, 1, 2


@kernel
def screws_expected(motion: np.ndarray, h: float, expected: np.ndarray) -> None:
    """Angles of the screws a time h later, by their rates: they determine the whole revolutions."""
    for s in range(expected.size):
        expected[s] = motion[s, 0] + h * (motion[s, 1] + 0.5 * h * motion[s, 2])


@kernel
def angle_too_far(constraints: np.ndarray, t: float, t_new: float) -> bool:
    """Return whether a rotational driver would turn so far that the predictor is blind."""
    for k in range(constraints.size):
        c = constraints[k]
        if c["kind"] == equations.DRIVER and c["coordinate"] >= 3:
            here, there = driver.function(c, t), driver.function(c, t_new)
            # Through a reversal the way is longer than the difference of its ends.
            way = max(abs(here[1]), abs(there[1])) * (t_new - t)
            if max(abs(there[0] - here[0]), way) > LARGEST_TURN:
                return True
    return False


@kernel
def defect(system: System, state: np.ndarray, new: np.ndarray, h: float) -> tuple[float, float]:
    """Return how far new (3, n) is from the smooth curve through both ends, and the way moved.

    The distance is 1 where it is just allowed.

    q1 - q0 = h (v0 + v1)/2 - h² (a1 - a0)/12, exact to the fourth power of h.
    """
    off, moved = 0.0, 0.0
    for k in range(state.shape[1]):
        way = new[POSITION, k] - state[POSITION, k]
        mean = 0.5 * h * (state[VELOCITY, k] + new[VELOCITY, k])
        bend = h * h / 12.0 * (new[ACCELERATION, k] - state[ACCELERATION, k])
        part = abs(way - mean + bend) / system.units[OF_COORDINATE, k]
        if not part <= off:
            off = part if part > off else np.inf
        moved = max(moved, abs(way) / system.units[OF_COORDINATE, k])
    return off / min(SMOOTH, SMOOTH_PART * moved + TINY_LENGTH), moved


@kernel
def predict(state: np.ndarray, h: float, q: np.ndarray) -> None:
    """Fill q with the coordinates a time h after `state`, by velocity and acceleration."""
    for k in range(q.size):
        q[k] = state[POSITION, k] + h * (state[VELOCITY, k] + 0.5 * h * state[ACCELERATION, k])


@kernel
def accept(
    system: System, work: Work, new: np.ndarray, expected: np.ndarray, state: np.ndarray, motion: np.ndarray
) -> None:
    """Make new (3, n) the state, and note the angles of the screws in motion and expected."""
    copy(new, state)
    equations.screw_motion(system.constraints, new, work.rotations, expected, motion)


@kernel
def copy(source: np.ndarray, target: np.ndarray) -> Any:
    """Copy one state, source (3, n), over another, target (3, n)."""
    for row in range(3):
        for k in range(source.shape[1]):
            target[row, k] = source[row, k]


def _attempt_by(linear: LinearSolver):
    newton, rates = newton_by(linear), rates_by(linear)

    @kernel
    def attempt(
        system: System,
        work: Work,
        state: np.ndarray,
        motion: np.ndarray,
        t: float,
        t_new: float,
        limit: float,
        most: int,
        new: np.ndarray,
        expected: np.ndarray,
    ) -> tuple[float, float, int, int, float]:
        """Solve at t_new from what `state` at t predicts; returns (defect, way moved, sign of det Φ_q,
        iterations, largest |dΦ/dt|); the defect is infinite where it failed.

        limit and most bound Newton's corrections and their number.
        """
        h = t_new - t
        predict(state, h, new[POSITION])
        screws_expected(motion, h, expected)
        code, iterations, sign = newton(system, work, new[POSITION], t_new, expected, limit, most)
        if code != CONVERGED:
            return np.inf, 0.0, sign, iterations, np.inf
        gap = rates(system, work, new[POSITION], t_new, new[VELOCITY], new[ACCELERATION])
        off, moved = defect(system, state, new, h)
        return off, moved, sign, iterations, gap

    return attempt


@kernel
def bounds_of_newton(system: System, clock: np.ndarray) -> tuple[float, int]:
    """Largest scaled correction and most iterations: an assembly has a long way from its estimates."""
    if clock[NEXT_LENGTH] == 0.0:
        return LARGEST_ASSEMBLY_CORRECTION, int(system.limits[ITERATIONS])
    return NO_LIMIT, STEP_ITERATIONS


def _advance_by(linear: LinearSolver):
    """Return `advance`, which carries `state` from clock[TIME] to `target`: (arrived, largest |dΦ/dt|).

    Not arrived with clock[BUDGET] left: the way is barred.  A clock[NEXT_LENGTH] of 0 says that `state`
    holds estimates: they are assembled at clock[TIME] = target, where no curve can be asked for.
    """
    attempt = _attempt_by(linear)

    @kernel
    def advance(
        system: System,
        work: Work,
        state: np.ndarray,
        motion: np.ndarray,
        clock: np.ndarray,
        target: float,
        new: np.ndarray,
        expected: np.ndarray,
    ) -> tuple[bool, float]:
        limit, most = bounds_of_newton(system, clock)
        gap = 0.0
        while clock[TIME] < target or clock[NEXT_LENGTH] == 0.0:
            if clock[BUDGET] <= 0.0:
                return False, gap
            clock[BUDGET] -= 1.0
            t_new = step_to(clock, target)
            off, moved, sign = np.inf, 0.0, 0
            if not angle_too_far(system.constraints, clock[TIME], t_new):
                off, moved, sign, iterations, gap = attempt(
                    system, work, state, motion, clock[TIME], t_new, limit, most, new, expected
                )
                clock[SPENT] += iterations
            if acceptable(clock, off, moved, sign):
                accept(system, work, new, expected, state, motion)
                after_success(clock, t_new, off, sign)
            else:
                clock[NEXT_LENGTH] = 0.5 * (t_new - clock[TIME])
                if is_barred(clock, target):
                    return False, gap
        return True, gap

    return advance


def continuation(linear: LinearSolver) -> Callable[..., Any]:
    """Return `fill_rows` with these factors."""
    advance = _advance_by(linear)

    @kernel
    def fill_rows(
        system: System,
        work: Work,
        state: np.ndarray,
        motion: np.ndarray,
        clock: np.ndarray,
        times: np.ndarray,
        out: np.ndarray,
        audit: np.ndarray,
        new: np.ndarray,
        expected: np.ndarray,
    ) -> int:
        """As `follow`, with room for a new row (3, n) and for the angles of the screws."""
        for row in range(times.size):
            arrived, gap = advance(system, work, state, motion, clock, times[row], new, expected)
            if not arrived:
                return row
            copy(state, out[row])
            audit[row, 0] = largest(work.vectors[PHI])
            audit[row, 1] = gap
            audit[row, 2] = clock[SPENT]
            clock[SPENT] = 0.0
        return times.size

    return fill_rows


_fill_rows = continuation(DENSE)
_fill_rows_sparse = continuation(SPARSE)


@allocating
def follow(
    system: System,
    state: np.ndarray,
    motion: np.ndarray,
    clock: np.ndarray,
    times: np.ndarray,
    out: np.ndarray,
    audit: np.ndarray,
) -> int:
    """Report rows at `times` (rows,), from `state` (3, n) at clock[TIME] on; state and clock move along.

    motion (screws, 3) holds angles and rates of the screws.  out (rows, 3, n): positions,
    velocities, accelerations.  audit (rows, 3): largest |Φ|, largest |dΦ/dt|, Newton iterations.
    Returns the number of rows reached: fewer than asked for when the way is barred, or when
    clock[BUDGET] is used up and a further call continues.
    """
    work = make_work(state.shape[1], state.shape[1])
    new = np.empty((3, state.shape[1]))
    expected = np.empty(motion.shape[0])
    return _fill_rows(system, work, state, motion, clock, times, out, audit, new, expected)


@allocating
def follow_sparse(
    system: System,
    work: SparseWork,
    state: np.ndarray,
    motion: np.ndarray,
    clock: np.ndarray,
    times: np.ndarray,
    out: np.ndarray,
    audit: np.ndarray,
) -> int:
    """As `follow`, with the order of elimination kept in `work`.

    state (3, n), motion (screws, 3), times (rows,), out (rows, 3, n), audit (rows, 3).
    """
    new, expected = np.empty((3, state.shape[1])), np.empty(motion.shape[0])
    return _fill_rows_sparse(system, work, state, motion, clock, times, out, audit, new, expected)
