"""Functions of time as cards that YOUNG, VSDF and DAFMS decks have alike: types, and the numbers of each."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from ..piecewise_polynomials import Pieces, continuous_rates, smooth_step, spline_table
from ..time_functions import COMPOUND, PERIODIC, PIECEWISE, SINE, SPIN_UP, TABLE, MotionFunction
from .functions import points_of, polynomial_of, rate_of, simple, without_jumps

Card = tuple[int, str, tuple[float, ...]]  # number of the function, its type, the numbers that define it
_NAMES = {SPIN_UP: "a spin-up", TABLE: "a natural cubic spline"}
SAME = 1e-9  # of the largest value: coefficients that two cards have in common


class FunctionCards:
    """Numbers the functions of a deck, from `first` on."""

    def __init__(self, first: int = 1) -> None:
        self.first = first
        self.cards: list[Card] = []

    def driver(self, function: MotionFunction) -> tuple[int, bool]:
        """Return the number of a function that a coordinate follows, and whether it is that of its rate.

        The integral of a table or ramp, alone or in a sum, has no card; its rate has.  0: neither has.
        """
        before = len(self.cards)
        if number := self.number(function):
            return number, False
        del self.cards[before:]
        rate = rate_of(function)
        return (self.number(rate), True) if rate else (0, False)

    def number(self, function: MotionFunction) -> int:
        """Return the number of a function, whose cards are added; 0 for one that has no card."""
        function = simple(function)
        if function.kind == COMPOUND:
            return self._sum(function.terms)
        card = _card_of(function)
        return self._add(*card) if card else 0

    def _add(self, kind: str, numbers: Sequence[float]) -> int:
        self.cards.append((self.first + len(self.cards), kind, tuple(numbers)))
        return self.cards[-1][0]

    def _sum(self, terms: tuple[tuple[MotionFunction, ...], ...]) -> int:
        parts = [self._product(factors) for factors in terms]
        if 0 in parts:
            return 0
        return parts[0] if len(parts) == 1 else self._add("sum", parts)

    def _product(self, factors: tuple[MotionFunction, ...]) -> int:
        parts = [self.number(factor) for factor in factors]
        if 0 in parts:
            return 0
        return parts[0] if len(parts) == 1 else self._add("product", parts)


def without_card(function: MotionFunction, dialect: str) -> str:
    """Return why a function is refused, and what to give in its place."""
    return (
        f"its function of time is not converted: {dialect} has no card of {_described(function)}; "
        "give it as a table, a spline, a polynomial or a sine"
    )


def _described(function: MotionFunction) -> str:
    """Return the name of what a function without a card is or holds."""
    if function.kind == COMPOUND:
        parts = [factor for factors in function.terms for factor in factors if not _card_of(simple(factor))]
        return f"a sum or product with {_described(parts[0])}"
    return _NAMES.get(function.kind, "polynomials in pieces that are neither table, spline, ramp nor step")


def _card_of(function: MotionFunction) -> tuple[str, tuple[float, ...]] | None:
    """Type and numbers of a function that is no sum or product; None where no card says the same."""
    if c := polynomial_of(function):
        return "polynomial", c
    if function.kind == SINE:
        return "sine", function.c
    if points := points_of(function):
        return "table", tuple(x for point in without_jumps(points) for x in point)
    if function.kind == PERIODIC:
        points = [(piece[0], piece[1]) for piece in function.pieces]
        points.append((points[0][0] + function.c[0], points[0][1]))
        return "periodic", tuple(x for point in points for x in point)
    if function.kind != PIECEWISE:
        return None
    return _step(function.pieces) or _spline(function.pieces)


def _step(pieces: Pieces) -> tuple[str, tuple[float, ...]] | None:
    """A smooth step between two values that hold outside."""
    if len(pieces) != 3:
        return None
    (_, v0, *_), (t0, *_), (t1, v1, *_) = pieces
    pieces_of_step = smooth_step(t0, v0, t1, v1)
    return (
        ("step", (t0, v0, t1, v1))
        if _alike(pieces[1:], pieces_of_step[1:]) and not any(pieces[0][2:])
        else None
    )


def _spline(pieces: Pieces) -> tuple[str, tuple[float, ...]] | None:
    """A cubic spline, whose last piece continues: any point of it is the last."""
    if len(pieces) < 3 or continuous_rates(pieces) < 2:
        return None
    times = [piece[0] for piece in pieces]
    times.append(2.0 * times[-1] - times[-2])
    values = [piece[1] for piece in pieces]
    values.append(_value(pieces[-1], times[-1]))
    if not _alike(pieces, spline_table(times, values)):
        return None
    return "spline", tuple(x for point in zip(times, values, strict=True) for x in point)


def _value(piece: tuple[float, ...], t: float) -> float:
    return float(np.polynomial.polynomial.polyval(t - piece[0], piece[1:]))


def _alike(one: Pieces, other: Pieces) -> bool:
    """Return whether pieces have the same starts and the same values within and at the ends of each."""
    if [piece[0] for piece in one] != [piece[0] for piece in other]:
        return False
    starts = [piece[0] for piece in one]
    spans = [b - a for a, b in pairwise(starts)] or [1.0]
    spans.append(spans[-1])
    size = max(
        abs(c) * span**n for piece, span in zip(one, spans, strict=True) for n, c in enumerate(piece[1:])
    )
    return all(
        abs(_value(a, a[0] + x * span) - _value(b, b[0] + x * span)) <= SAME * size
        for a, b, span in zip(one, other, spans, strict=True)
        for x in (0.0, 0.25, 0.5, 0.75, 1.0)
    )
