"""Laws of time moved, scaled, and recognised, for conversion between dialects that know different ones."""

from itertools import pairwise

import numpy as np

from ...quick_dataclass import replace
from ..time_functions import (
    COMPOUND,
    HELD_TABLE,
    PIECEWISE,
    POLYNOMIAL,
    SINE,
    SPIN_UP,
    TABLE,
    MotionLaw,
    piecewise,
)

# Half the time in which a table without jumps passes one of another dialect: its impulse is the same.
JUMP = 1e-9  # s


def constant(value: float) -> MotionLaw:
    """The law that never changes."""
    return MotionLaw(POLYNOMIAL, (value, 0.0, 0.0, 0.0))


def moved(law: MotionLaw, start: float, value: float = 0.0) -> MotionLaw:
    """The law t → law(t + start) - value."""
    if law.kind == POLYNOMIAL:
        return moved(piecewise(((0.0, *law.c),)), start, value)
    if law.kind == SINE:
        mean, size, omega, phase = law.c
        return MotionLaw(SINE, (mean - value, size, omega, phase + omega * start))
    if law.kind == PIECEWISE:
        return piecewise(tuple((t - start, c0 - value, *c) for t, c0, *c in law.pieces))
    if law.kind == COMPOUND:
        terms = tuple(tuple(moved(factor, start) for factor in factors) for factors in law.terms)
        return MotionLaw(COMPOUND, terms=(*terms, (constant(-value),)))
    if law.kind == SPIN_UP:
        return law if start == 0.0 == value else MotionLaw(COMPOUND, terms=((law,), (constant(-value),)))
    times, values = (
        [t - shift for t in column] for column, shift in ((law.times, start), (law.values, value))
    )
    return replace(law, times=tuple(times), values=tuple(values))


def scaled(law: MotionLaw, factor: float) -> MotionLaw:
    """The law t → factor law(t)."""
    if factor == 1.0:
        return law
    if law.kind == PIECEWISE:
        return piecewise(tuple((t, *(factor * c for c in cs)) for t, *cs in law.pieces))
    if law.kind == COMPOUND:
        terms = tuple((scaled(factors[0], factor), *factors[1:]) for factors in law.terms)
        return MotionLaw(COMPOUND, terms=terms)
    if law.kind in (TABLE, HELD_TABLE):
        columns = {name: tuple(factor * v for v in getattr(law, name)) for name in ("values", "curvature")}
        return replace(law, **columns)
    c0, c1, c2, c3 = law.c
    if law.kind == SINE:
        return MotionLaw(SINE, (factor * c0, factor * c1, c2, c3))
    if law.kind == SPIN_UP:
        return MotionLaw(SPIN_UP, (factor * c0, c1, c2, c3))
    return MotionLaw(POLYNOMIAL, (factor * c0, factor * c1, factor * c2, factor * c3))


def simple(law: MotionLaw) -> MotionLaw:
    """The same law as one polynomial of a piece, or as one sine, where it is one; else itself."""
    if law.kind == POLYNOMIAL:
        return piecewise(((0.0, *law.c),))
    if law.kind != COMPOUND or any(len(factors) != 1 for factors in law.terms):
        return law
    parts = [simple(factors[0]) for factors in law.terms]
    sines = [part for part in parts if part.kind == SINE]
    others = [polynomial_of(part) for part in parts if part.kind != SINE]
    if len(sines) > 1 or None in others:
        return law
    total = _sum(others)
    if not sines:
        return piecewise(((0.0, *total),))
    mean, size, omega, phase = sines[0].c
    return law if any(total[1:]) else MotionLaw(SINE, (mean + total[0], size, omega, phase))


def _sum(polynomials):
    total = np.zeros(max(map(len, polynomials), default=1))
    for c in polynomials:
        total[: len(c)] += c
    return tuple(map(float, total))


def polynomial_of(law: MotionLaw) -> tuple[float, ...] | None:
    """Coefficients c0, c1, … of a law that is one polynomial, the last not 0; None for another law."""
    law = simple(law)
    if law.kind != PIECEWISE or len(law.pieces) != 1:
        return None
    start, *c = law.pieces[0]
    if start:
        c = list(np.polynomial.Polynomial(c)(np.polynomial.Polynomial([-start, 1.0])).coef)
    found = [float(x) for x in c]
    while len(found) > 1 and found[-1] == 0.0:
        found.pop()
    return tuple(found)


def value_of(law: MotionLaw | None) -> float | None:
    """The value of a law that never changes (of no law: 1); None for another law."""
    found = (1.0,) if law is None else polynomial_of(law)
    return found[0] if found and len(found) == 1 else None


def points_of(law: MotionLaw) -> list[tuple[float, float]] | None:
    """Points (time, value) of straight lines whose end values hold outside; None for another law.

    Two points of the same time are a jump.
    """
    if law.kind == HELD_TABLE:
        return list(zip(map(float, law.times), map(float, law.values), strict=True))
    if law.kind != PIECEWISE or len(law.pieces) < 2 or any(any(piece[3:]) for piece in law.pieces):
        return None
    lines = [(piece[0], piece[1], piece[2] if len(piece) > 2 else 0.0) for piece in law.pieces]
    if lines[0][2] or lines[-1][2]:
        return None
    points = []
    for (t0, v0, slope), (t1, v1, _) in pairwise(lines):
        reached = v0 + slope * (t1 - t0)
        if abs(reached - v1) > 1e-12 * max(abs(reached), abs(v1)):
            points.append((t1, reached))
        points.append((t1, v1))
    return points


def without_jumps(points: list[tuple[float, float]]) -> list[tuple[float, float]]:
    """Points whose times rise: a jump becomes a steep line about its time."""
    found: list[tuple[float, float]] = []
    for k, (t, v) in enumerate(points):
        before = k > 0 and points[k - 1][0] == t
        after = k + 1 < len(points) and points[k + 1][0] == t
        found.append((t + JUMP * (before - after), v))
    return found
