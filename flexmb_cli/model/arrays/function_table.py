"""Functions of time as the records and knots that kernels read."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from ..laws import FUNCTIONS, NUMBER, OF_COORDINATE, OF_TIME, SPRING, Element, Law
from ..time_functions import (
    COMPOUND,
    HELD_TABLE,
    PERIODIC,
    PIECEWISE,
    SIGNAL,
    TABLE,
    MotionFunction,
    integral_of,
    is_signal,
)
from .records import FUNCTION, NONE, function_record

OF_A_COORDINATE = 1.0  # in c[3] of a function of pieces whose argument is no time


def fill_law(record: Any, law: Law, values: tuple[Any, ...], table: "FunctionTable | None" = None) -> Any:
    """Fill the law of a record by values of its parameters; functions join those of the table."""
    record["shape"], record["f"], record["bristle"] = law.code, NONE, NONE
    functions_of = zip(law.parameters, values, strict=True)
    record["driven"] = any(p.kind in FUNCTIONS and is_signal(value) for p, value in functions_of)
    numbers = functions = 0
    for p, value in zip(law.parameters, values, strict=True):
        if p.kind == NUMBER:
            record["c"][..., numbers] = value
            numbers += 1
            continue
        if value is not None and table is not None:
            record["f"][..., functions] = table.function(value, of_time=p.kind == OF_TIME)
        functions += 1
        if p.kind == OF_COORDINATE:
            if value is not None and table is not None:
                energy = integral_of(value)
                # A signal has no potential.
                if energy is not None:
                    record["f"][..., functions] = table.function(energy, of_time=False)
            functions += 1
    return record


def fill_bushing(records: Any, item: Element) -> Any:
    """Fill the laws of six records, which are those of springs."""
    (k, kr, c, cr) = item.values
    records["shape"], records["f"] = SPRING.code, NONE
    records["c"][:, 0], records["c"][:, 2] = (*k, *kr), (*c, *cr)
    return records


class FunctionTable:
    """Collects functions and their knots."""

    def __init__(self) -> None:
        self.functions: list[np.ndarray] = []
        self.knots: list[np.ndarray] = [np.zeros((0, 3))]
        self._signals: dict[int, int] = {}  # numbers of functions by those of signals

    def function(self, function: MotionFunction, of_time: bool = True) -> int:
        """Number of a function; one that is not `of_time` has a coordinate or its rate as argument."""
        if function.kind in (TABLE, HELD_TABLE):
            return self.of_knots(
                function.kind, np.column_stack([function.times, function.values, function.curvature])
            )
        if function.kind == SIGNAL:
            signal = int(function.c[0])
            if signal not in self._signals:
                self._signals[signal] = self.of_knots(SIGNAL, np.zeros((1, 3)))
            return self._signals[signal]
        if function.kind == PIECEWISE:
            return self._pieces(function.pieces, of_time)
        if function.kind == PERIODIC:
            return self._pieces(function.pieces, of_time, function.c[0])
        if function.kind == COMPOUND:
            return self._compound(function.terms, of_time)
        return self._add(function_record(function.kind, function.c))

    def in_a_row(self, functions: Sequence[MotionFunction]) -> int:
        """Number of the first of functions of a coordinate whose numbers follow each other."""
        numbers = [self.function(function, of_time=False) for function in functions]
        self.functions += [self.functions[number] for number in numbers]
        return len(self.functions) - len(numbers)

    def factor(self, function: MotionFunction | None) -> int:
        """Number of the factor of a load, -1 where it has none."""
        return NONE if function is None else self.function(function)

    def of_knots(
        self, kind: int, knots: np.ndarray, c: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0)
    ) -> int:
        """Number of a function of `kind` with rows (k, 3) of knots."""
        first = sum(map(len, self.knots))
        self.knots.append(knots)
        return self._add(function_record(kind, c, first=first, last=first + len(knots) - 1))

    def knot_of_signal(self, signal: int) -> int:
        """Return the row of knots from which functions take the value of a signal, -1 if none does."""
        number = self._signals.get(signal)
        return NONE if number is None else int(self.functions[number]["first"])

    def _add(self, record: np.ndarray) -> int:
        self.functions.append(record)
        return len(self.functions) - 1

    def _pieces(self, pieces: tuple[tuple[Any, ...], ...], of_time: bool, period: float = 0.0) -> int:
        """Number of a function of pieces; one with a period has a last row of knots, its end."""
        count = max(len(piece) - 1 for piece in pieces)
        rows = -(-(count + 1) // 3)
        knots = np.zeros((len(pieces), 3 * rows))
        for k, piece in enumerate(pieces):
            knots[k, : len(piece)] = piece
        c = (len(pieces), count, rows, 0.0 if of_time else OF_A_COORDINATE)
        if not period:
            return self.of_knots(PIECEWISE, knots.reshape(-1, 3), c)
        end = [[pieces[0][0] + period, 0.0, 0.0]]
        return self.of_knots(PERIODIC, np.concatenate([knots.reshape(-1, 3), end]), c)

    def _compound(self, terms: tuple[tuple[Any, ...], ...], of_time: bool) -> int:
        rows = [
            (k, self.function(function, of_time), 0.0)
            for k, factors in enumerate(terms)
            for function in factors
        ]
        return self.of_knots(COMPOUND, np.array(rows))

    def function_arrays(self) -> dict[str, np.ndarray]:
        """The FUNCTION records and knots (k, 3)."""
        return {
            "functions": np.array(self.functions, dtype=FUNCTION).reshape(-1),
            "knots": np.concatenate(self.knots),
        }


def break_times(function: np.ndarray, knots: np.ndarray) -> np.ndarray:
    """Times at which a FUNCTION record changes its formula, s; none where its argument is no time."""
    if function["kind"] in (TABLE, HELD_TABLE):
        return knots[function["first"] : function["last"] + 1, 0]
    if function["kind"] == PIECEWISE and function["c"][3] != OF_A_COORDINATE:
        return knots[function["first"] : function["last"] + 1 : int(function["c"][2]), 0][1:]
    return np.zeros(0)
