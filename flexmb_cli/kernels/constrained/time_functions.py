"""Functions of time with their first two derivatives; formulas and types as in `model.time_functions`."""

import math
from typing import Any

import numpy as np

from .._jit import kernel

# The codes of model.time_functions and model.arrays.records; a test compares them.
POLYNOMIAL, SPIN_UP, SINE, TABLE, HELD_TABLE, PIECEWISE, COMPOUND, PERIODIC = 1, 2, 3, 4, 5, 6, 7, 8
SIGNAL = 9


@kernel
def function_values(
    functions: np.ndarray, knots: np.ndarray, number: int, t: float
) -> tuple[float, float, float]:
    """Value, rate and second rate of function `number` at t.  knots (k, 3): time, value, second
    derivative.
    """
    if functions[number]["kind"] == COMPOUND:
        return _compound(functions, knots, number, t)
    return _simple(functions, knots, number, t)


@kernel
def _simple(functions: np.ndarray, knots: np.ndarray, number: int, t: float) -> tuple[float, float, float]:
    function = functions[number]
    kind, c = function["kind"], function["c"]
    if kind == POLYNOMIAL:
        value = c[0] + t * (c[1] + t * (c[2] + t * c[3]))
        return value, c[1] + t * (2.0 * c[2] + 3.0 * t * c[3]), 2.0 * c[2] + 6.0 * t * c[3]
    if kind == SPIN_UP:
        return _spin_up(c[0], c[1], t)
    if kind == SINE:
        phase = c[2] * t + c[3]
        swing = c[1] * math.sin(phase)
        return c[0] + swing, c[1] * c[2] * math.cos(phase), -c[2] * c[2] * swing
    if kind == SIGNAL:
        return knots[function["first"], 0], 0.0, 0.0
    if kind == PIECEWISE:
        return _piecewise(knots, function["first"], c, t)
    if kind == PERIODIC:
        begin = knots[function["first"], 0]
        period = knots[function["last"], 0] - begin
        return _piecewise(knots, function["first"], c, t - period * math.floor((t - begin) / period))
    return _table(knots, function["first"], function["last"], t, kind == HELD_TABLE)


@kernel
def _spin_up(w: float, T: float, t: float) -> tuple[float, float, float]:
    if t >= T:
        return w * (t - 0.5 * T), w, 0.0
    lap = T / (2.0 * math.pi)
    value = w / T * (0.5 * t * t + lap * lap * (math.cos(t / lap) - 1.0))
    return value, w / T * (t - lap * math.sin(t / lap)), w / T * (1.0 - math.cos(t / lap))


@kernel
def _table(knots: np.ndarray, first: int, last: int, t: float, held: bool) -> tuple[float, float, float]:
    """Evaluate the cubic through the knots first to last; outside straight, or constant where `held`."""
    inside = min(max(t, knots[first, 0]), knots[last, 0])
    while last - first > 1:
        middle = (first + last) // 2
        if knots[middle, 0] <= inside:
            first = middle
        else:
            last = middle
    h = knots[last, 0] - knots[first, 0]
    a, b = (knots[last, 0] - inside) / h, (inside - knots[first, 0]) / h
    bend_a, bend_b = knots[first, 2], knots[last, 2]
    value = a * knots[first, 1] + b * knots[last, 1]
    value += ((a * a * a - a) * bend_a + (b * b * b - b) * bend_b) * h * h / 6.0
    rate = (knots[last, 1] - knots[first, 1]) / h
    rate += ((3.0 * b * b - 1.0) * bend_b - (3.0 * a * a - 1.0) * bend_a) * h / 6.0
    if inside == t:
        return value, rate, a * bend_a + b * bend_b
    return (value, 0.0, 0.0) if held else (value + rate * (t - inside), rate, 0.0)


@kernel
def _piecewise(knots: np.ndarray, first: int, c: np.ndarray, t: float) -> tuple[float, float, float]:
    """The polynomial of the piece at t; c: number of pieces, of coefficients, of rows of knots a piece."""
    pieces, count, rows = int(c[0]), int(c[1]), int(c[2])
    low, high = 0, pieces
    while high - low > 1:
        middle = (low + high) // 2
        if knots[first + middle * rows, 0] <= t:
            low = middle
        else:
            high = middle
    at = first + low * rows
    x, value, rate, bend = t - knots[at, 0], 0.0, 0.0, 0.0
    for k in range(count, 0, -1):
        bend = bend * x + 2.0 * rate
        rate = rate * x + value
        value = value * x + knots[at + k // 3, k % 3]
    return value, rate, bend


@kernel
def _compound(functions: Any, knots: np.ndarray, number: int, t: float) -> tuple[float, float, float]:
    """A sum of products; its rows of knots: number of the term, of the function that is a factor."""
    value = rate = bend = 0.0
    f, fd, fdd = 1.0, 0.0, 0.0
    first, last = functions[number]["first"], functions[number]["last"]
    for row in range(first, last + 1):
        g, gd, gdd = _simple(functions, knots, int(knots[row, 1]), t)
        f, fd, fdd = f * g, fd * g + f * gd, fdd * g + 2.0 * fd * gd + f * gdd
        if row == last or knots[row + 1, 0] != knots[row, 0]:
            value += f
            rate += fd
            bend += fdd
            f, fd, fdd = 1.0, 0.0, 0.0
    return value, rate, bend
