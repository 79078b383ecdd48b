"""Functions of time: polynomials, spin-up, sines, tables, sums and products, with their first two
derivatives.

The spin-up is that of Kane, Ryan and Banerjee (1987): from rest to the rate w over the time T.
"""

import math
from array import array
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..errors import Place
from .piecewise_polynomials import (
    Pieces,
    continuous_rates,
    integral,
    linear_table,
    periodic_spline,
    value_and_rates,
)

POLYNOMIAL, SPIN_UP, SINE, TABLE, HELD_TABLE, PIECEWISE, COMPOUND, PERIODIC = 1, 2, 3, 4, 5, 6, 7, 8
SIGNAL = 9


@dataclass(frozen=True, slots=True)  # a deck may have thousands
class MotionFunction:
    """A function of `kind` with constants `c` (4,); SI units.

    1: c0 + c1 t + c2 t² + c3 t³.  2: (w/T) (t²/2 + (T/2 pi)² (cos(2 pi t/T) - 1)) up to T = c1, then
    w (t - T/2), with w = c0.  3: c0 + c1 sin(c2 t + c3).  4: the natural cubic spline through the points
    (`times`, `values`), whose `curvature` (k,) is known at each; outside it continues straight.  5: the same,
    which keeps its first and last value outside.  6: `pieces`, see `piecewise_polynomials`.  7: the sum of
    `terms`, each a product of functions of the other types.  8: `pieces` that repeat with the period c0.
    9: the signal number c0 of the model, at any argument.
    The points of a table may be a million: arrays of doubles.
    """

    kind: int
    c: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0)
    times: Sequence[float] = ()
    values: Sequence[float] = ()
    curvature: Sequence[float] = ()
    pieces: Pieces = ()
    terms: tuple[tuple["MotionFunction", ...], ...] = ()

    def at(self, t: float) -> tuple[float, float, float]:
        """Value and its first and second derivative at time `t`, s."""
        return _VALUES[self.kind](self, t)

    @property
    def of_factor(self) -> "MotionFunction":
        """A table as the factor of a load: linear between its points, constant outside.

        A spline would swing beyond the values given, and pull before a pulse begins.
        """
        flat = array("d", bytes(8 * len(self.times)))
        return MotionFunction(HELD_TABLE, self.c, self.times, self.values, flat)


def table_function(times: Sequence[float], values: Sequence[float]) -> MotionFunction:
    """The function through at least two points, times ascending."""
    t, f = (given if isinstance(given, array) else array("d", given) for given in (times, values))
    return MotionFunction(TABLE, times=t, values=f, curvature=_natural_curvature(t, f))


def _natural_curvature(t: Any, f: Any) -> Any:
    """Second derivatives at the points, 0 at the ends.

    Three diagonals, the middle one larger than the others together: eliminated without pivots.  A full
    matrix would take 8 k² bytes.
    """
    count = len(t)
    ahead, reduced = array("d", bytes(8 * count)), array("d", bytes(8 * count))
    length, slope = t[1] - t[0], (f[1] - f[0]) / (t[1] - t[0])
    for i in range(1, count - 1):
        before, slope_before = length, slope
        length = t[i + 1] - t[i]
        slope = (f[i + 1] - f[i]) / length
        pivot = 2 * (before + length) - before * ahead[i - 1]
        ahead[i] = length / pivot
        reduced[i] = (6 * (slope - slope_before) - before * reduced[i - 1]) / pivot
    for i in reversed(range(1, count - 1)):
        reduced[i] -= ahead[i] * reduced[i + 1]
    return reduced


def _polynomial(function: MotionFunction, t: float) -> tuple[float, float, float]:
    c0, c1, c2, c3 = function.c
    return c0 + t * (c1 + t * (c2 + t * c3)), c1 + t * (2 * c2 + 3 * t * c3), 2 * c2 + 6 * t * c3


def _spin_up(function: MotionFunction, t: float) -> tuple[float, float, float]:
    w, T = function.c[:2]
    if t >= T:
        return w * (t - T / 2), w, 0.0
    turn = math.tau * t / T
    value = w / T * (t * t / 2 + (T / math.tau) ** 2 * (math.cos(turn) - 1))
    return value, w / T * (t - T / math.tau * math.sin(turn)), w / T * (1 - math.cos(turn))


def _sine(function: MotionFunction, t: float) -> tuple[float, float, float]:
    c0, c1, c2, c3 = function.c
    phase = c2 * t + c3
    return c0 + c1 * math.sin(phase), c1 * c2 * math.cos(phase), -c1 * c2 * c2 * math.sin(phase)


def _spline(function: MotionFunction, t: float) -> tuple[float, float, float]:
    times, f, g = function.times, function.values, function.curvature
    inside = min(max(t, times[0]), times[-1])
    k = min(max(int(np.searchsorted(times, inside, side="right")) - 1, 0), len(times) - 2)
    h = times[k + 1] - times[k]
    a, b = (times[k + 1] - inside) / h, (inside - times[k]) / h
    value = a * f[k] + b * f[k + 1] + ((a**3 - a) * g[k] + (b**3 - b) * g[k + 1]) * h * h / 6
    rate = (f[k + 1] - f[k]) / h + ((3 * b * b - 1) * g[k + 1] - (3 * a * a - 1) * g[k]) * h / 6
    if inside != t:
        return value + rate * (t - inside), rate, 0.0
    return value, rate, a * g[k] + b * g[k + 1]


def _held(function: MotionFunction, t: float) -> tuple[float, float, float]:
    if function.times[0] <= t <= function.times[-1]:
        return _spline(function, t)
    return function.values[0 if t < function.times[0] else -1], 0.0, 0.0


def _pieces(function: MotionFunction, t: float) -> tuple[float, float, float]:
    return value_and_rates(function.pieces, t)


def _periodic(function: MotionFunction, t: float) -> tuple[float, float, float]:
    begin = function.pieces[0][0]
    return value_and_rates(function.pieces, begin + (t - begin) % function.c[0])


def _compound(function: MotionFunction, t: float) -> tuple[float, float, float]:
    total = (0.0, 0.0, 0.0)
    for factors in function.terms:
        f, fd, fdd = 1.0, 0.0, 0.0
        for g, gd, gdd in (factor.at(t) for factor in factors):
            f, fd, fdd = f * g, fd * g + f * gd, fdd * g + 2.0 * fd * gd + f * gdd
        total = (total[0] + f, total[1] + fd, total[2] + fdd)
    return total


_VALUES = {
    POLYNOMIAL: _polynomial,
    SPIN_UP: _spin_up,
    SINE: _sine,
    TABLE: _spline,
    HELD_TABLE: _held,
    PIECEWISE: _pieces,
    COMPOUND: _compound,
    PERIODIC: _periodic,
}


def values_at(function: MotionFunction, t: np.ndarray) -> np.ndarray:
    """Values (3, n) of a function and its first two derivatives at t (n,)."""
    if function.kind not in (PIECEWISE, PERIODIC):
        return np.array([function.at(x) for x in t.tolist()]).reshape(-1, 3).T
    starts = np.array([piece[0] for piece in function.pieces])
    if function.kind == PERIODIC:
        t = starts[0] + (t - starts[0]) % function.c[0]
    k = np.maximum(np.searchsorted(starts, t, side="right") - 1, 0)
    c = np.zeros((len(starts), max(map(len, function.pieces)) - 1))
    for row, piece in zip(c, function.pieces, strict=True):
        row[: len(piece) - 1] = piece[1:]
    x, values = t - starts[k], np.zeros((3, len(t)))
    for column in c.T[::-1]:
        values[2] = values[2] * x + 2.0 * values[1]
        values[1] = values[1] * x + values[0]
        values[0] = values[0] * x + column[k]
    return values


def piecewise(pieces: Pieces) -> MotionFunction:
    """The function of these pieces."""
    return MotionFunction(PIECEWISE, pieces=pieces)


def periodic(times: Sequence[float], values: Sequence[float]) -> MotionFunction:
    """The cubic spline through the points that repeats after the last, whose value is the first one."""
    pieces = periodic_spline(times, values)
    return MotionFunction(PERIODIC, (float(times[-1]) - float(times[0]), 0.0, 0.0, 0.0), pieces=pieces)


def pulse(value: float, duration: float) -> MotionFunction:
    """The law of the card DESN: +value, nothing, -value for `duration` each, then nothing."""
    t, f = duration, value
    return piecewise(linear_table((0.0, t, t, 2 * t, 2 * t, 3 * t, 3 * t), (f, f, 0.0, 0.0, -f, -f, 0.0)))


def _terms(function: MotionFunction) -> Any:
    return function.terms if function.kind == COMPOUND else ((function,),)


def sum_of(functions: Iterable[MotionFunction]) -> MotionFunction:
    """The sum of functions."""
    return MotionFunction(COMPOUND, terms=tuple(term for function in functions for term in _terms(function)))


def product_of(functions: Iterable[MotionFunction]) -> MotionFunction:
    """The product of functions, multiplied out."""
    products: list[tuple[MotionFunction, ...]] = [()]
    for function in functions:
        products = [(*before, *term) for before in products for term in _terms(function)]
    return MotionFunction(COMPOUND, terms=tuple(products))


def integral_of(function: MotionFunction, start: float = 0.0) -> MotionFunction | None:
    """The antiderivative that is 0 at `start`; None where flexmb has none: of a product."""
    if function.kind == PIECEWISE:
        return piecewise(integral(function.pieces, start))
    if function.kind == POLYNOMIAL:
        return piecewise(integral(((0.0, *function.c),), start))
    if function.kind == SINE and function.c[2] != 0.0:
        mean, size, omega, phase = function.c
        turning = MotionFunction(SINE, (0.0, -size / omega, omega, phase + math.pi / 2))
        return sum_of([piecewise(((start, -turning.at(start)[0], mean),)), turning])
    if function.kind == COMPOUND and all(len(factors) == 1 for factors in function.terms):
        parts = [integral_of(factors[0], start) for factors in function.terms]
        known = [part for part in parts if part is not None]
        return sum_of(known) if len(known) == len(parts) else None
    return None


def is_signal(function: MotionFunction | None) -> bool:
    """Return whether a function is the value of a signal."""
    return function is not None and function.kind == SIGNAL


def smoothness(function: MotionFunction) -> int:
    """Return how many derivatives of a function are continuous, at most 2; -1: its value jumps."""
    if function.kind == PIECEWISE:
        return continuous_rates(function.pieces)
    if function.kind == COMPOUND:
        return min((smoothness(factor) for factors in function.terms for factor in factors), default=2)
    return {HELD_TABLE: 0}.get(function.kind, 2)


# Types of motions: of a body along and about the global axes, and of a joint.
TRANSLATIONS, ROTATIONS = ("TRAX", "TRAY", "TRAZ"), ("ROTX", "ROTY", "ROTZ")
JOINT_TURN, JOINT_STROKE = "ANGL", "STRK"


@dataclass(frozen=True)
class Motion:
    """Prescribed motion of a coordinate of a body (`kind` TRAX ... ROTZ), or of a joint (ANGL, STRK)."""

    name: str
    kind: str
    target: int
    function: MotionFunction
    place: Place | None = None

    @property
    def of_joint(self) -> bool:
        """Return whether it prescribes a joint coordinate, 0 at the deck's positions, not one of a body."""
        return self.kind in (JOINT_TURN, JOINT_STROKE)

    @property
    def is_length(self) -> bool:
        """Return whether it prescribes a length, m, rather than an angle, rad."""
        return self.kind in (*TRANSLATIONS, JOINT_STROKE)


def corners(function: MotionFunction) -> Iterator[float]:
    """Times at which a function changes its formula."""
    yield from function.times
    yield from (piece[0] for piece in function.pieces)
    for factors in function.terms:
        for factor in factors:
            yield from corners(factor)
