"""Functions of time, of a stretch or of a rate as Python expressions of an Exudyn script."""

from itertools import pairwise

from ...model.piecewise_polynomials import Pieces
from ...model.time_functions import (
    COMPOUND,
    HELD_TABLE,
    PERIODIC,
    PIECEWISE,
    POLYNOMIAL,
    SINE,
    SPIN_UP,
    TABLE,
    MotionFunction,
)

FUNCTIONS = '''

def pieces(rows, period=0.0):
    """A function of polynomials: each row is a start and coefficients from there on."""
    starts = [row[0] for row in rows]

    def value(t):
        t = starts[0] + (t - starts[0]) % period if period else t
        k = max(bisect_right(starts, t) - 1, 0)
        return sum(c * (t - starts[k]) ** n for n, c in enumerate(rows[k][1:]))

    return value


def sine(mean, amplitude, omega, phase):
    return lambda t: mean + amplitude * math.sin(omega * t + phase)


def spin_up(w, T):
    """Kane, Ryan and Banerjee (1987): from rest to the rate w over the time T."""
    turn = 2 * math.pi / T
    return lambda t: w * (t - T / 2) if t >= T else w / T * (t * t / 2 + (math.cos(turn * t) - 1) / turn**2)


def products(*terms):
    return lambda t: sum(math.prod(factor(t) for factor in term) for term in terms)

'''


def function_text(function: MotionFunction) -> str:
    """Return a Python expression for a function; raises ValueError for a signal."""
    c = list(map(float, function.c))
    if function.kind == POLYNOMIAL:
        return f"pieces({[[0.0, *c]]!r})"
    if function.kind == SPIN_UP:
        return f"spin_up({c[0]!r}, {c[1]!r})"
    if function.kind == SINE:
        return f"sine({', '.join(map(repr, c))})"
    if function.kind in (TABLE, HELD_TABLE):
        return f"pieces({_rows(table_pieces(function))!r})"
    if function.kind == PIECEWISE:
        return f"pieces({_rows(function.pieces)!r})"
    if function.kind == PERIODIC:
        return f"pieces({_rows(function.pieces)!r}, {c[0]!r})"
    if function.kind == COMPOUND:
        terms = (f"({', '.join(map(function_text, term))},)" for term in function.terms)
        return f"products({', '.join(terms)})"
    raise ValueError("signals of a model are not functions")


def table_pieces(function: MotionFunction) -> Pieces:
    """Return the cubics of a table by its values and curvatures at the points, and what it is beyond them."""
    times, f, g = (list(map(float, part)) for part in (function.times, function.values, function.curvature))
    pieces = []
    for k, (t, following) in enumerate(pairwise(times)):
        h = following - t
        rate = (f[k + 1] - f[k]) / h - (2 * g[k] + g[k + 1]) * h / 6
        pieces.append((t, f[k], rate, g[k] / 2, (g[k + 1] - g[k]) / (6 * h)))
    held = function.kind == HELD_TABLE
    h = times[-1] - times[-2]
    last = 0.0 if held else (f[-1] - f[-2]) / h + (g[-2] + 2 * g[-1]) * h / 6
    # The first piece holds before its start as well.
    before = (times[0] - 1.0, f[0], 0.0) if held else (times[0] - 1.0, f[0] - pieces[0][2], pieces[0][2])
    return (before, *pieces, (times[-1], f[-1], last))


def _rows(pieces: Pieces) -> list[list[float]]:
    return [list(map(float, piece)) for piece in pieces]
