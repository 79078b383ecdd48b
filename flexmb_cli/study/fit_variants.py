"""A variant of a fit: what its results lack to meet the targets, and by how much it violates constraints."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..deck.record import Deck
from ..errors import ANALYSIS_FAILED, DONE, FlexmbError
from ..run.outcome import RunOptions
from .continuous import nearest, spline
from .fit_file import AT_LEAST, EQUAL, Fit, Target
from .repeated_motion import DIFFERENCE, RepeatedMotion
from .solver import NO_SERIES, CaseResult, CaseSolver

SAMPLES_A_ROW = 4  # of a path between two report rows
LEAST_SHARE = 0.01  # of the range of a number: its size if its value is less


@dataclass(frozen=True)
class Variant:
    """`residuals` (m,): of the targets, weighted; `excess` (k,): of the constraints, above 0 if violated.

    `cost`: half the sum of squares, or the objective; nan of a variant that cannot be solved.  `violation`:
    sum of what is violated; 1 to 2 of one that cannot be solved, less the farther its motion goes.
    """

    case: CaseResult
    residuals: np.ndarray
    excess: np.ndarray
    cost: float
    violation: float

    @property
    def responses(self) -> np.ndarray:
        """Return residuals, or the objective, and then the excess of the constraints."""
        head = self.residuals if self.residuals.size else np.array([self.cost])
        return np.concatenate([head, self.excess])


class VariantSolver:
    """Solves variants of a deck, and reduces their series to residuals."""

    def __init__(self, deck: Deck, fit: Fit, folder: str, options: RunOptions):
        self.fit = fit
        self.cases = CaseSolver(deck, fit.study, folder, options)
        self._motion: RepeatedMotion | None = None
        self.names = [item.name for item in fit.study.results if item not in fit.numbers]

    @property
    def residuals(self) -> int:
        """Return how many residuals there are."""
        return sum(self._count(target) for target in self.fit.targets)

    def _count(self, target: Target) -> int:
        if target.formula:
            return self.cases.rows
        return len(target.points) * max(1, len(target.quantities))

    def solve(self, number: int, row: list[float]) -> CaseResult:
        """Return the case of these parameters; its values are the numbers, then the residuals."""
        full = self.solve_in_full(number, row)
        residuals = np.full(self.residuals, np.nan)
        code, message = full.exit_code, full.message
        if code == DONE:
            try:
                residuals = self._residuals(full)
            except (ValueError, np.linalg.LinAlgError) as fault:
                code, message = ANALYSIS_FAILED, f"the targets cannot be compared: {fault}"
        values = np.concatenate([full.values, residuals])
        return CaseResult(number, code, full.rows, full.parameters, values, NO_SERIES, message)

    def derivative(self, number: int, row: list[float], k: int) -> CaseResult:
        """Return the derivatives of the values that `solve` returns, by parameter k, an unknown number.

        They are those of `sensitivity`, or if the run cannot be repeated (a number that changes the report
        times, a bound beyond which there is no motion), differences of two variants.
        """
        low, high = sorted(self.fit.study.parameters[k].values)
        scale = max(abs(row[k]), LEAST_SHARE * (high - low))
        try:
            # A number by a formula is nan.
            if self._motion is None or not np.array_equal(self._motion.row, row, equal_nan=True):
                self._motion = None  # whose memory is free before
                self._motion = RepeatedMotion(self.cases, row, one_neighbour=True)
            derivatives = self._motion.derivatives(k, scale, self._values)
        except (FlexmbError, ValueError, np.linalg.LinAlgError):
            derivatives = self._difference(row, k, DIFFERENCE * scale)
        parameters = np.array(self.fit.study.complete(list(row)), dtype=float)
        return CaseResult(number, DONE, 0, parameters, derivatives, NO_SERIES)

    def _difference(self, row: list[float], k: int, step: float) -> np.ndarray:
        """Return the difference of variants on both sides, or of one and the place itself.

        They are 0 if fewer than two can be solved: the search turns to other numbers then.
        """
        low, high = sorted(self.fit.study.parameters[k].values)
        solved: list[tuple[float, np.ndarray]] = []
        for value in (min(row[k] + step, high), max(row[k] - step, low), row[k]):
            case = self.solve(0, [value if j == k else each for j, each in enumerate(row)])
            if case.exit_code == DONE and value not in (each for each, _ in solved):
                solved.append((value, case.values))
            if len(solved) == 2:
                (first, upper), (last, lower) = solved
                return (upper - lower) / (first - last)
        return np.zeros(len(self.fit.numbers) + self.residuals)

    def solve_in_full(self, number: int, row: list[float]) -> CaseResult:
        """Return the case of these parameters with its series."""
        return self.cases.solve_row(number, self.fit.study.complete(list(row)))

    def series_of(self, case: CaseResult) -> dict[str, np.ndarray]:
        """Return the series of a case by the names of their quantities."""
        return dict(zip(self.names, case.series, strict=True))

    def _values(self, case: CaseResult) -> np.ndarray:
        return np.concatenate([case.values, self._residuals(case)])

    def _residuals(self, case: CaseResult) -> np.ndarray:
        return np.concatenate([*(self._residuals_of(target, case) for target in self.fit.targets), ()])

    def _residuals_of(self, target: Target, case: CaseResult) -> np.ndarray:
        """Return the residuals of a target, (points, quantities) one after the other, weighted."""
        if target.result:
            numbers = [item.name for item in self.fit.numbers]
            value = case.values[numbers.index(target.result)]
            return target.weight * np.array([value - target.points[0][0]])
        series = self.series_of(case)
        times, curve = series["time"], curve_of(target, series)
        if target.formula:
            inside = (times >= target.start) & (times <= target.end)
            target_values = np.broadcast_to(target.formula.value({"time": times}.__getitem__), times.shape)
            return target.weight * np.where(inside, curve[:, 0] - target_values, 0.0)
        residuals: np.ndarray = reached(target, times, curve)[1] - np.array(target.points)
        return target.weight * residuals.ravel()

    def variant(self, case: CaseResult) -> Variant:
        """Return cost and violation of a case."""
        numbers = self.fit.numbers
        residuals = case.values[len(numbers) :]
        values = {item.name: value for item, value in zip(numbers, case.values, strict=False)}
        names = (item.name for item in self.fit.study.parameters)
        values |= dict(zip(names, case.parameters, strict=True))
        excess = np.array(list(self._excess(values)), dtype=float)
        objective = self.fit.objective
        cost = float(objective.value(values.__getitem__)) if objective else 0.5 * float(residuals @ residuals)
        if case.exit_code != DONE or not np.isfinite(cost) or not np.all(np.isfinite(excess)):
            unsolved = 2.0 - min(1.0, case.rows / max(1, self.cases.rows))
            return Variant(case, residuals, excess, float("nan"), unsolved)
        equal = np.array([each.relation == EQUAL for each in self.fit.constraints], dtype=bool)
        violated = np.where(equal, np.abs(excess), np.maximum(excess, 0.0))
        return Variant(case, residuals, excess, cost, float(violated.sum()))

    def _excess(self, values: dict[str, Any]) -> Iterator[float]:
        for each in self.fit.constraints:
            left, right = (float(side.value(values.__getitem__)) for side in each.excess)
            yield right - left if each.relation == AT_LEAST else left - right


def curve_of(target: Target, series: dict[str, np.ndarray]) -> np.ndarray:
    """Return the quantities of a target (rows, k)."""
    times = series["time"]
    columns = [one.value(series.__getitem__) for one in target.quantities]
    return np.column_stack([np.broadcast_to(column, times.shape) for column in columns])


def reached(target: Target, times: np.ndarray, curve: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return when the quantities meet the points of a target best (m,), s, and their values then (m, k)."""
    motion = spline(times, curve)
    if target.times:
        at = np.array(target.times)
        if at.min() < times[0] - 1e-9 or at.max() > times[-1] + 1e-9:
            raise ValueError(f"{target.name} has times outside the motion, {times[0]:g} to {times[-1]:g} s")
    else:
        start, end = max(target.start, times[0]), min(target.end, times[-1])
        at = nearest(motion, np.array(target.points), start, end, SAMPLES_A_ROW * len(times))
    return at, np.asarray(motion(at))
