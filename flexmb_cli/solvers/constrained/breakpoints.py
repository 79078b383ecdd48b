"""Times at which steps of chosen length end: points of tables, and where accelerations of drivers jump."""

from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from ...errors import Fault
from ...model.arrays.function_table import break_times
from ...model.arrays.records import ELEMENT, FRICTION
from ...model.laws import MOTOR, SPRING
from ...model.signals import sampling_times
from ...model.time_functions import COMPOUND, PIECEWISE
from ..table_times import jump_at, times_between
from .state import ConstrainedState

if TYPE_CHECKING:
    from ...kernels.constrained.system import System

JUMP_OF_SECOND_RATE = 1e-6  # of the largest second rate of a function at its corners: more is no round-off


def breakpoints(motion: ConstrainedState, end: float) -> list[float]:
    """Return points of tables before `end`, s, at which steps end.

    What a table does between two steps of any length would be stepped over, and no method keeps its
    order across a bend.
    """
    samples = sampling_times(motion.elements.signals, motion.grid.start, end)
    if not motion.integrator.chosen:
        return times_between(samples, motion.grid.start, end)
    corners = {t for function in _tables(motion.system) for t in function.tolist()}
    corners.update(samples)
    return times_between(corners | set(_rows_of_work(motion)), motion.grid.start, end)


def _rows_of_work(motion: ConstrainedState) -> list[float]:
    """Report times, at which steps end where nothing is free to move and an effort bends or jumps.

    The motion has no error that would shorten the steps; the work of stops, cables and friction has.
    """
    loads = motion.arrays.loads
    bends = (loads["kind"] == ELEMENT) & ~np.isin(loads["shape"], (SPRING.code, MOTOR.code))
    if motion.mobility is None or motion.mobility.free or not np.any(bends | (loads["kind"] == FRICTION)):
        return []
    return [motion.grid.time(k) for k in range(motion.grid.rows)]


def jump_of_table(motion: ConstrainedState, t: float) -> str:
    """Return what `jump_at` says of the tables of a motion."""
    return jump_at((times.tolist() for times in _tables(motion.system)), t)


def _tables(system: "System") -> list[np.ndarray]:
    """The times of every table, s."""
    of_functions = [break_times(function, system.knots) for function in system.functions]
    return [times for times in of_functions if times.size]


def warn_of_fine_tables(motion: ConstrainedState) -> None:
    """Steps of given length end where they end, whatever a table does between."""
    apart = (float(np.diff(times).min()) for times in _tables(motion.system) if times.size > 1)
    finest = min(apart, default=np.inf)
    if not motion.integrator.chosen and finest < motion.integrator.length:
        message = (
            f"a table has points {finest:.3g} s apart, and steps of {motion.integrator.length:g} s "
            f"may pass "
            "over them: take a step below that, or 0 for steps that end at them"
        )
        motion.warnings.append(Fault("warning", message, id="SOLVE-003"))


def jumps_of_accelerations(motion: ConstrainedState) -> frozenset[float]:
    """Return the times, s, at which the second rate of a driver jumps, as where its rate is a ramp."""
    system, work = motion.system, motion.work
    rows = work.jacobian.shape[0] - system.bodies.shape[0]
    numbers = {int(number) for number in system.primitives["function"][:rows] if number >= 0}
    return frozenset(t for number in numbers for t in _jumps(system, number))


def _jumps(system: "System", number: int) -> list[float]:
    function = system.functions[number]
    if function["kind"] == COMPOUND:
        parts = system.knots[function["first"] : function["last"] + 1, 1].astype(int)
        return [t for part in parts for t in _jumps(system, int(part))]
    if function["kind"] != PIECEWISE:
        return []
    pieces, count, rows = (int(c) for c in function["c"][:3])
    first = int(function["first"])
    numbers = system.knots[first : first + pieces * rows].reshape(pieces, -1)[:, : count + 1]
    before = [_second_rate(one[1:], other[0] - one[0]) for one, other in pairwise(numbers)]
    after = [_second_rate(other[1:], 0.0) for other in numbers[1:]]
    size = JUMP_OF_SECOND_RATE * max(map(abs, [*before, *after]), default=0.0)
    times = numbers[1:, 0].tolist()
    return [t for t, one, other in zip(times, before, after, strict=True) if abs(other - one) > size]


def _second_rate(c: np.ndarray, x: float) -> float:
    return float(np.polynomial.polynomial.polyval(x, np.polynomial.polynomial.polyder(c, 2)))
