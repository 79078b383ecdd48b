"""A fit from its file to its table: a search whose variants are kept, each once.

A search that continues asks for the same variants again, in the same order, and takes those that are kept: it
ends with the same numbers.
"""

import os
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from ..errors import ANALYSIS_FAILED, DONE, AnalysisError, Fault, OutputError
from ..run.outcome import Stop
from ..solvers.linearisation.motion import differentiated
from ..version import __version__
from .checkpoints import Parts, RecordForm, StudyLock
from .fit_file import Fit, Target, read_fit
from .fit_search import Search, confidence
from .fit_variants import LEAST_SHARE, Variant, curve_of, reached
from .fit_workers import FitJob, Processes, Solve, Task, solver_of, solving_here
from .repeated_motion import DIFFERENCE
from .solver import CaseResult, CaseSolver
from .study import Cases
from .sweep import readable_deck, reported_at, study_text
from .table import Column, TableHead, write_table

MOST_VARIANTS = 10_000_000
AT_BOUND = 1e-9  # of the range of a number
AXES = "fit"  # group of the table


@dataclass(frozen=True)
class Number:
    """A number that a fit has determined: `low` and `high` of its 95 % interval, nan if it has none."""

    name: str
    unit: str
    value: float
    standard_error: float
    low: float
    high: float
    at_bound: bool


@dataclass
class FitRun:
    """A fit ready to be searched.  Raises DeckError if study or deck cannot be read.

    `advance` is called for each variant that is solved; `known`: variants by values of the unknown numbers;
    `columns`: their derivatives by one of these, those of the values of their cases.
    """

    job: FitJob
    text: Any
    parts: Parts
    lock: StudyLock
    advance: Callable[[int], None] = lambda count: None
    known: dict[bytes, Variant] = field(default_factory=dict)
    columns: dict[tuple[bytes, int], np.ndarray] = field(default_factory=dict)
    kept: int = 0
    solve: Solve | None = None
    search: Search = field(init=False)

    @classmethod
    def of(
        cls, path: str, parts_folder: str, fresh: bool = False, loop_tolerance: float | None = None
    ) -> "FitRun":
        """The fit in the file at `path`; begins its folder of parts or continues with it."""
        text = study_text(path)
        with reported_at(path, text.lines):
            fit = read_fit(text, os.path.dirname(path))
        deck_path = os.path.join(os.path.dirname(path), fit.study.deck)
        deck = readable_deck(deck_path, fit.study)
        job = FitJob(deck, os.path.dirname(os.path.abspath(deck_path)), fit, loop_tolerance)
        with reported_at(path, text.lines):
            solver = solver_of(job)
        # Columns of files are in it, and so is all that the study says.
        identity = {"version": __version__, "deck": deck.sha256, "study": text.sha256, "fit": repr(fit)}
        form = RecordForm(len(fit.study.parameters), len(fit.numbers) + solver.residuals, 0, 0)
        parts = Parts(os.path.abspath(parts_folder), identity, form)
        lock = parts.lock(path)
        try:
            restored = parts.begin(fresh)
        except BaseException:
            lock.leave()
            raise
        run = cls(job, text, parts, lock)
        for case in parts.stored(0, range(MOST_VARIANTS)) if restored else ():
            run._note(case)
        for case in parts.stored(1, range(MOST_VARIANTS)) if restored else ():
            run._note_derivatives(case)
        run.kept = len(run.known)
        return run

    def _note(self, case: CaseResult) -> Variant:
        variant = solver_of(self.job).variant(case)
        self.known[self._key(case.parameters)] = variant
        return variant

    def _key(self, row: np.ndarray) -> bytes:
        return np.array([row[k] for k in self._places], dtype=float).tobytes()

    @property
    def solver(self) -> CaseSolver:
        """Return what solves variants in this process."""
        return solver_of(self.job).cases

    @property
    def _places(self) -> list[int]:
        return [k for k, item in enumerate(self.job.fit.study.parameters) if len(item.values) > 1]

    def find(self, jobs: int = 1, solve: Solve | None = None) -> None:
        """Search here, in `jobs` processes, or by `solve`; raises AnalysisError if nothing can be solved."""
        processes = Processes(self.job, jobs) if jobs > 1 and not solve else None
        self.solve = solve or processes or solving_here(self.job)
        self.search = Search(self.job.fit, self.evaluate, self.jacobian)
        try:
            self.search.run(self._starts())
        finally:
            if processes:
                processes.end()
        if self.search.best is None or not np.isfinite(self.search.best[1].cost):
            variants = list(self.known.values())
            reasons = [variant.case.message for variant in variants if variant.case.message]
            first = f": the first ended with '{reasons[0]}'" if reasons else ""
            message = (
                f"none of {len(variants)} variants can be solved{first}; try other bounds, or more restarts"
            )
            raise AnalysisError(Fault("error", message, id="STUDY-136"), 0.0)

    def evaluate(self, places: np.ndarray) -> Sequence[Variant]:
        """Return the variants at places (k, n) of the unit cube; those that are new are kept."""
        rows = [self.row_at(place) for place in places]
        keys = [self._key(row) for row in rows]
        new = {key: row for key, row in zip(keys, rows, strict=True) if key not in self.known}
        if new:
            tasks: list[Task] = [(tuple(row.tolist()), None) for row in new.values()]
            self._solve(0, len(self.known), tasks, self._note)
        return [self.known[key] for key in keys]

    def _solve(self, block: int, first: int, tasks: list[Task], note: Callable[[CaseResult], Any]) -> None:
        assert self.solve is not None, "a search is under way"
        with self.parts.block(block, range(first)) as part:
            for case in self.solve(first, tasks):
                part.append([case])
                note(case)
                self.advance(1)
                Stop.raise_if_asked()

    def _note_derivatives(self, case: CaseResult) -> None:
        # Those of a variant come one after the other.
        self.columns[self._key(case.parameters), case.case % len(self._places)] = case.values

    def jacobian(self, place: np.ndarray) -> np.ndarray:
        """Return the derivatives of a variant's responses by the places (n,) of its unknown numbers."""
        [variant], row = self.evaluate(place[None]), self.row_at(place)
        key = self._key(row)
        missing = [k for k in range(len(place)) if (key, k) not in self.columns]
        if missing and variant.case.exit_code == DONE:
            tasks: list[Task] = [(tuple(row.tolist()), self._places[k]) for k in missing]
            self._solve(1, len(self.columns), tasks, self._note_derivatives)
        columns = [self._of_responses(variant, row, k) * self._rate(k, row) for k in range(len(place))]
        return np.column_stack(columns)

    def _of_responses(self, variant: Variant, row: np.ndarray, k: int) -> np.ndarray:
        """Return the derivatives by unknown number k, 0 if the variant could not be solved."""
        if variant.case.exit_code != DONE:
            return np.zeros(variant.responses.shape)
        slope, place, solver = self.columns[self._key(row), k], self._places[k], solver_of(self.job)

        def responses(change: float) -> np.ndarray:
            parameters = self.job.fit.study.complete([x + change * (j == place) for j, x in enumerate(row)])
            values = variant.case.values + change * slope
            case = replace(variant.case, parameters=np.array(parameters, dtype=float), values=values)
            return solver.variant(case).responses

        step = DIFFERENCE * max(abs(row[place]), abs(self._rate(k, row)) * LEAST_SHARE)
        derivatives: np.ndarray = differentiated(responses, step)
        return np.asarray(np.nan_to_num(derivatives))

    def _rate(self, k: int, row: np.ndarray) -> float:
        """Return the derivative of unknown number k by its place in the unit cube."""
        item = self.job.fit.unknown[k]
        low, high = item.values
        return float(row[self._places[k]] * np.log(high / low) if item.logarithmic else high - low)

    def row_at(self, place: np.ndarray) -> np.ndarray:
        """Return the values of all parameters at a place of the unit cube; those by formulas are nan."""
        row = [(*item.values, np.nan)[0] for item in self.job.fit.study.parameters]
        for k, u in zip(self._places, place, strict=True):
            item = self.job.fit.study.parameters[k]
            low, high = np.log(item.values) if item.logarithmic else item.values
            value = low + u * (high - low)
            row[k] = np.exp(value) if item.logarithmic else value
        return np.array(row, dtype=float)

    def place_of(self, values: Sequence[float]) -> np.ndarray:
        """Return the place in the unit cube of values of the unknown numbers."""
        places = []
        for item, value in zip(self.job.fit.unknown, values, strict=True):
            low, high = np.log(item.values) if item.logarithmic else item.values
            places.append(((np.log(value) if item.logarithmic else value) - low) / (high - low))
        return np.asarray(np.clip(np.array(places), 0.0, 1.0))

    def _starts(self) -> np.ndarray:
        """Return where to begin: the start of the file, the middle of what has none, and a sample."""
        fit = self.job.fit
        first = [
            self.place_of_one(k, start) if np.isfinite(start) else 0.5 for k, start in enumerate(fit.starts)
        ]
        count = fit.study.count if fit.restarts else 0
        cases = Cases(fit.study)
        sample = [self.place_of([cases.row(k)[p] for p in self._places]) for k in range(count)]
        return np.array([first, *sample])

    def place_of_one(self, k: int, value: float) -> float:
        """Return the place of a value of unknown number k."""
        values = [item.values[0] for item in self.job.fit.unknown]
        values[k] = value
        return float(self.place_of(values)[k])

    @property
    def best(self) -> Variant:
        """Return the best variant."""
        assert self.search.best is not None, "a search has ended"
        return self.search.best[1]

    def numbers(self) -> list[Number]:
        """Return the numbers that the search has determined, with their intervals."""
        assert self.search.best is not None, "a search has ended"
        place, variant = self.search.best
        free = (place > AT_BOUND) & (place < 1.0 - AT_BOUND)
        jacobian = self.jacobian(place) if self.job.fit.targets else np.zeros((0, len(place)))
        errors, factor = confidence(jacobian, variant.residuals, free)
        units = {name: unit for name, unit, _ in self.parameter_units()}
        numbers = []
        for k, item in enumerate(self.job.fit.unknown):
            value = float(variant.case.parameters[self._places[k]])
            error = errors[k] * abs(self._rate(k, variant.case.parameters))
            ends = value - factor * error, value + factor * error
            numbers.append(Number(item.name, units[item.name], value, error, *ends, not free[k]))
        return numbers

    def parameter_units(self) -> Iterator[tuple[str, str, str]]:
        """Yield the parameters with their units and meanings."""
        deck = self.solver.deck
        known = dict(deck.numbers()) | dict(deck.variables)
        for item in self.job.fit.study.parameters:
            number = known.get(item.name)
            meaning = number.meaning if number else "number of the study"
            yield item.name, (number and number.unit) or "1", meaning

    def write(self, path: str) -> None:
        """Write every variant to the table at `path`, and remove the parts.  Raises OutputError."""
        numbers = self.numbers()  # may solve variants more
        fit, solver = self.job.fit, solver_of(self.job)
        columns = [Column(f"parameter/{name}", unit, what) for name, unit, what in self.parameter_units()]
        quantities = dict(
            zip((item.name for item in fit.study.results), solver.cases.quantities, strict=True)
        )
        columns += [
            Column(f"result/{item.name}", quantities[item.name].unit, item.take) for item in fit.numbers
        ]
        columns += [Column("result/cost", "1", "half the sum of squares of the residuals, or the objective"),
                    Column("result/violation", "1", "sum of violated constraints")]  # fmt: skip
        deck = self.job.deck
        head = TableHead(self.text.text, deck.text, deck.name, deck.sha256, tuple(columns), len(self.known),
                         tuple(self._summary(numbers)))  # fmt: skip
        with Stop.later():
            write_table(path, head, map(self._row, self.known.values()))
        try:
            with Stop.later():
                self.end()
        except OutputError as error:
            message = f"{error}; the table {path} is complete, remove the folder of its parts"
            raise OutputError(message, ANALYSIS_FAILED, id="STUDY-137") from error

    def end(self) -> None:
        """Remove what was kept: the table has it."""
        try:
            self.parts.remove()
        finally:
            self.lock.leave()

    def _row(self, variant: Variant) -> Any:
        case, count = variant.case, len(self.job.fit.numbers)
        cells = [*case.parameters, *case.values[:count], variant.cost, variant.violation]
        return case.case + 1, case.exit_code, case.rows, case.message, cells

    def _summary(self, numbers: list[Number]) -> Iterator[tuple[Column, Any]]:
        """Yield what the group `fit` of the table has: the numbers, and what the best variant meets."""
        yield Column(f"{AXES}/number", "", "names of the unknown numbers"), [each.name for each in numbers]
        for name, what in (
            ("value", "the best"), ("standard_error", "of the best"),
            ("low", "end of the 95 % interval"), ("high", "end of the 95 % interval"),
        ):  # fmt: skip
            yield Column(f"{AXES}/{name}", "1", what), np.array([getattr(each, name) for each in numbers])
        best = self.best.case
        yield Column(f"{AXES}/best", "1", "number of the best case"), np.array([best.case + 1.0])
        solver = solver_of(self.job)
        full = solver.solve_in_full(best.case, best.parameters.tolist())
        series = solver.series_of(full)
        for target in self.job.fit.targets:
            if target.quantities:
                yield from _of_target(target, series)


def _of_target(target: Target, series: dict[str, np.ndarray]) -> Iterator[tuple[Column, Any]]:
    """Yield what a target wants, and what the quantities do."""
    times, curve = series["time"], curve_of(target, series)
    group, names = f"{AXES}/target/{target.name}", [one.text for one in target.quantities]
    yield Column(f"{group}/quantity", "", "names of the quantities"), names
    yield Column(f"{group}/time", "s", "report times"), times
    yield Column(f"{group}/curve", "1", "the quantities at the report times"), curve
    if target.formula:
        target_values = np.broadcast_to(target.formula.value({"time": times}.__getitem__), times.shape)
        yield Column(f"{group}/wanted", "1", target.formula.text), np.array(target_values)[:, None]
        yield Column(f"{group}/wanted_time", "s", "times of what is wanted"), times
        return
    at, _ = reached(target, times, curve)
    yield Column(f"{group}/wanted", "1", "points that are wanted"), np.array(target.points)
    yield Column(f"{group}/wanted_time", "s", "when the motion comes nearest"), at


def fit_of(run: FitRun) -> dict[str, Any]:
    """Return the end of a fit as a record: numbers, best case and what the search says of itself."""
    fit: Fit = run.job.fit
    names = [item.name for item in fit.study.parameters]
    best = run.best
    return {
        "cost": best.cost,
        "violation": best.violation,
        "case": best.case.case + 1,
        "variants": len(run.known),
        "converged": run.search.success,
        "message": run.search.message,
        "numbers": [vars(each) for each in run.numbers()],
        "parameters": dict(zip(names, best.case.parameters.tolist(), strict=True)),
        "results": {item.name: float(v) for item, v in zip(fit.numbers, best.case.values, strict=False)},
    }
