"""Piecewise polynomials: tables, ramps, smooth steps, and their integrals.

A piece is (start, c0, c1, …) with the value c0 + c1 x + c2 x² + … at x = t - start.  It holds up to the start
of the next piece; the first also before its start, the last without end.
"""

from bisect import bisect_right
from collections.abc import Sequence
from itertools import pairwise

import numpy as np

Piece = tuple[float, ...]
Pieces = tuple[Piece, ...]
NO_JUMP = 1e-9  # of the terms of a piece: a jump smaller than that is none


def value_and_rates(pieces: Pieces, t: float) -> tuple[float, float, float]:
    """Value and its first and second derivative at time `t`."""
    k = max(bisect_right([piece[0] for piece in pieces], t) - 1, 0)
    x, value, rate, bend = t - pieces[k][0], 0.0, 0.0, 0.0
    for c in reversed(pieces[k][1:]):
        bend = bend * x + 2.0 * rate
        rate = rate * x + value
        value = value * x + c
    return value, rate, bend


def polynomial(coefficients: Sequence[float]) -> Pieces:
    """c0 + c1 t + c2 t² + …, of any degree."""
    return ((0.0, *map(float, coefficients)),)


def linear_table(times: Sequence[float], values: Sequence[float]) -> Pieces:
    """Straight lines between the points, jumps at equal times; the first and the last value hold outside."""
    t, f = np.asarray(times, float), np.asarray(values, float)
    lasts = np.flatnonzero(np.diff(t) > 0.0)
    slopes = (f[lasts + 1] - f[lasts]) / (t[lasts + 1] - t[lasts])
    lines = zip(t[lasts].tolist(), f[lasts].tolist(), slopes.tolist(), strict=True)
    return ((times[0] - 1.0, float(values[0]), 0.0), *lines, (float(times[-1]), float(values[-1]), 0.0))


def spline_table(times: Sequence[float], values: Sequence[float]) -> Pieces:
    """The cubic spline through the points, whose third derivative does not jump at the second and the last
    but one; two points give a line, three a parabola.

    de Boor, A Practical Guide to Splines (1978), chapter IV, not-a-knot condition: its error falls with the
    fourth power of the distance of the points up to the ends.  Outside, the end pieces go on.
    """
    t, f = np.asarray(times, float), np.asarray(values, float)
    if len(t) < 4:
        c = np.polynomial.polynomial.polyfit(t - t[0], f, len(t) - 1)
        return ((float(t[0]), *map(float, c)),)
    h, slopes = np.diff(t), np.diff(f) / np.diff(t)
    return _cubics(t, f, slopes, _not_a_knot(h, slopes))


def periodic_spline(times: Sequence[float], values: Sequence[float]) -> Pieces:
    """The cubic spline through three points or more whose first two derivatives are the same at both ends."""
    t, f = np.asarray(times, float), np.asarray(values, float)
    h, slopes = np.diff(t), np.diff(f) / np.diff(t)
    before = np.roll(h, 1)
    matrix = np.diag(2.0 * (before + h))
    k = np.arange(len(h))
    np.add.at(matrix, (k, k - 1), before)
    np.add.at(matrix, (k, (k + 1) % len(h)), h)
    bends = np.linalg.solve(matrix, 6.0 * (slopes - np.roll(slopes, 1)))
    bends = np.append(bends, bends[0])
    return _cubics(t, f, slopes, bends)


def _cubics(t: np.ndarray, f: np.ndarray, slopes: np.ndarray, bends: np.ndarray) -> Pieces:
    """Pieces between points t, f (k,) with their second derivatives, `bends` (k,)."""
    h = np.diff(t)
    return tuple(
        (
            float(t[k]),
            float(f[k]),
            float(slopes[k] - h[k] * (2.0 * bends[k] + bends[k + 1]) / 6.0),
            float(bends[k] / 2.0),
            float((bends[k + 1] - bends[k]) / (6.0 * h[k])),
        )
        for k in range(len(h))
    )


def _not_a_knot(h: np.ndarray, slopes: np.ndarray) -> np.ndarray:
    """Second derivatives at the points; three diagonals, since the end conditions give the outer two.

    bends[0] = bends[1] (1 + h0/h1) - bends[2] h0/h1, and so at the end.
    """
    low, middle, high = h[:-1].copy(), 2.0 * (h[:-1] + h[1:]), h[1:].copy()
    right = 6.0 * np.diff(slopes)
    a, b = h[0] / h[1], h[-1] / h[-2]
    middle[0] += h[0] * (1.0 + a)
    high[0] -= h[0] * a
    middle[-1] += h[-1] * (1.0 + b)
    low[-1] -= h[-1] * b
    for k in range(1, len(right)):
        share = low[k] / middle[k - 1]
        middle[k] -= share * high[k - 1]
        right[k] -= share * right[k - 1]
    inner = np.zeros(len(right))
    for k in reversed(range(len(right))):
        rest = high[k] * inner[k + 1] if k + 1 < len(right) else 0.0
        inner[k] = (right[k] - rest) / middle[k]
    first = inner[0] * (1.0 + a) - inner[1] * a
    return np.concatenate([[first], inner, [inner[-1] * (1.0 + b) - inner[-2] * b]])


def smooth_step(t0: float, v0: float, t1: float, v1: float) -> Pieces:
    """From v0 at t0 to v1 at t1 by 10 s³ - 15 s⁴ + 6 s⁵: rate and second rate are 0 at both ends."""
    span, rise = t1 - t0, v1 - v0
    bend = (0.0, 0.0, 10.0 * rise / span**3, -15.0 * rise / span**4, 6.0 * rise / span**5)
    return ((t0 - 1.0, v0), (t0, v0, *bend), (t1, v1))


def integral(pieces: Pieces, start: float) -> Pieces:
    """The antiderivative that is 0 at `start`."""
    integrals, constant = [], 0.0
    for k, piece in enumerate(pieces):
        integrals.append((piece[0], constant, *(c / n for n, c in enumerate(piece[1:], 1))))
        if k + 1 < len(pieces):
            x = pieces[k + 1][0] - piece[0]
            constant = sum(c * x**n for n, c in enumerate(integrals[-1][1:]))
    offset = value_and_rates(tuple(integrals), start)[0]
    return tuple((piece[0], piece[1] - offset, *piece[2:]) for piece in integrals)


def continuous_rates(pieces: Pieces) -> int:
    """Return how many derivatives are continuous at all joints of pieces, at most 2; -1: the value jumps."""
    least = 2
    for before, after in pairwise(pieces):
        left = value_and_rates((before,), after[0])
        right = value_and_rates((after,), after[0])
        # What the terms of the piece add up to without their signs: the unit of round-off.
        sizes = value_and_rates(((before[0], *map(abs, before[1:])),), after[0])
        for n, (a, b, size) in enumerate(zip(left, right, sizes, strict=True)):
            if abs(a - b) > NO_JUMP * max(size, abs(b)):
                least = min(least, n - 1)
                break
    return least
