"""Functions of time moved, scaled, and recognised, for conversion between dialects that know different
ones.
"""

import math
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np

from ..time_functions import (
    COMPOUND,
    HELD_TABLE,
    PERIODIC,
    PIECEWISE,
    POLYNOMIAL,
    SINE,
    SPIN_UP,
    TABLE,
    MotionFunction,
    piecewise,
    sum_of,
)

# Half the time in which a table without jumps passes one of another dialect: its impulse is the same.
JUMP = 1e-9  # s


def constant(value: float) -> MotionFunction:
    """The function that never changes."""
    return MotionFunction(POLYNOMIAL, (value, 0.0, 0.0, 0.0))


def transformed(
    function: MotionFunction,
    start: float = 0.0,
    value: float = 0.0,
    factor: float = 1.0,
    stretch: float = 1.0,
) -> MotionFunction:
    """Return the function t → factor function(t / stretch + start) - value; a spin-up begins at `start`."""
    if (start, value, factor, stretch) == (0.0, 0.0, 1.0, 1.0):
        return function
    if function.kind == POLYNOMIAL:
        return transformed(piecewise(((0.0, *function.c),)), start, value, factor, stretch)
    if function.kind == SINE:
        mean, size, omega, phase = function.c
        c = factor * mean - value, factor * size, omega / stretch, phase + omega * start
        return MotionFunction(SINE, c)
    if function.kind in (PIECEWISE, PERIODIC):
        pieces = tuple(
            (
                (t - start) * stretch,
                factor * c0 - value,
                *(factor * x / stretch**n for n, x in enumerate(c, 1)),
            )
            for t, c0, *c in function.pieces
        )
        return replace(function, c=(function.c[0] * stretch, *function.c[1:]), pieces=pieces)
    if function.kind in (TABLE, HELD_TABLE):
        times = tuple((t - start) * stretch for t in function.times)
        values = tuple(factor * v - value for v in function.values)
        curvature = tuple(factor * g / stretch**2 for g in function.curvature)
        return replace(function, times=times, values=values, curvature=curvature)
    if function.kind == SPIN_UP:
        w, T, c2, c3 = function.c
        terms: Any = ((replace(function, c=(factor * w / stretch, T * stretch, c2, c3)),),)
    else:
        terms = tuple(
            (
                transformed(first, start, 0.0, factor, stretch),
                *(transformed(other, start, stretch=stretch) for other in others),
            )
            for first, *others in function.terms
        )
    return MotionFunction(COMPOUND, terms=(*terms, *[(constant(-value),)] * bool(value)))


def simple(function: MotionFunction) -> MotionFunction:
    """The same function as one polynomial of a piece, or as one sine, where it is one; else itself."""
    if function.kind == POLYNOMIAL:
        return piecewise(((0.0, *function.c),))
    if function.kind != COMPOUND or any(len(factors) != 1 for factors in function.terms):
        return function
    parts = [simple(factors[0]) for factors in function.terms]
    sines = [part for part in parts if part.kind == SINE]
    others = [polynomial_of(part) for part in parts if part.kind != SINE]
    if len(sines) > 1 or None in others:
        return function
    total = _sum(others)
    if not sines:
        return piecewise(((0.0, *total),))
    mean, size, omega, phase = sines[0].c
    return function if any(total[1:]) else MotionFunction(SINE, (mean + total[0], size, omega, phase))


def _sum(polynomials: Any) -> tuple[Any, ...]:
    total = np.zeros(max(map(len, polynomials), default=1))
    for c in polynomials:
        total[: len(c)] += c
    return tuple(map(float, total))


def polynomial_of(function: MotionFunction) -> tuple[float, ...] | None:
    """Coefficients c0, c1, … of a function that is one polynomial, the last not 0; None for another
    function.
    """
    function = simple(function)
    if function.kind != PIECEWISE or len(function.pieces) != 1:
        return None
    start, *c = function.pieces[0]
    if start:
        c = list(np.polynomial.Polynomial(c)(np.polynomial.Polynomial([-start, 1.0])).coef)
    coefficients = [float(x) for x in c]
    while len(coefficients) > 1 and coefficients[-1] == 0.0:
        coefficients.pop()
    return tuple(coefficients)


def value_of(function: MotionFunction | None) -> float | None:
    """The value of a function that never changes (of no function: 1); None for another function."""
    coefficients = (1.0,) if function is None else polynomial_of(function)
    return coefficients[0] if coefficients and len(coefficients) == 1 else None


def points_of(function: MotionFunction) -> list[tuple[float, float]] | None:
    """Points (time, value) of straight lines whose end values hold outside; None for another function.

    Two points of the same time are a jump.
    """
    if function.kind == HELD_TABLE:
        return list(zip(map(float, function.times), map(float, function.values), strict=True))
    if (
        function.kind != PIECEWISE
        or len(function.pieces) < 2
        or any(any(piece[3:]) for piece in function.pieces)
    ):
        return None
    lines = [(piece[0], piece[1], piece[2] if len(piece) > 2 else 0.0) for piece in function.pieces]
    if lines[0][2] or lines[-1][2]:
        return None
    points = []
    for (t0, v0, slope), (t1, v1, _) in pairwise(lines):
        reached = v0 + slope * (t1 - t0)
        if abs(reached - v1) > 1e-12 * max(abs(reached), abs(v1)):
            points.append((t1, reached))
        points.append((t1, v1))
    return points


def rate_of(function: MotionFunction) -> MotionFunction | None:
    """The derivative of a function; None of a product, a spin-up or a natural spline."""
    function = simple(function)
    if function.kind == SINE:
        _, size, omega, phase = function.c
        return MotionFunction(SINE, (0.0, size * omega, omega, phase + math.pi / 2))
    if function.kind == PIECEWISE:
        return piecewise(tuple(_rate_of_piece(piece) for piece in function.pieces))
    if function.kind != COMPOUND or any(len(factors) != 1 for factors in function.terms):
        return None
    parts = [rate_of(factors[0]) for factors in function.terms]
    known = [part for part in parts if part is not None and polynomial_of(part) != (0.0,)]
    return None if None in parts else sum_of(known)


def _rate_of_piece(piece: tuple[float, ...]) -> tuple[float, ...]:
    start, _, *c = piece
    return start, *([n * x for n, x in enumerate(c, 1)] or [0.0])


def without_jumps(points: list[tuple[float, float]]) -> list[tuple[float, float]]:
    """Points whose times rise: a jump becomes a steep line about its time."""
    steep: list[tuple[float, float]] = []
    for k, (t, v) in enumerate(points):
        before = k > 0 and points[k - 1][0] == t
        after = k + 1 < len(points) and points[k + 1][0] == t
        steep.append((t + JUMP * (before - after), v))
    return steep
