"""One case of a study: the deck with other numbers, solved in memory; what is kept of it."""

import os
from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ..deck.record import Deck
from ..dialects.dialect import Dialect
from ..dialects.recognise import dialect_named
from ..dialects.settings import SettableDeck
from ..errors import ANALYSIS_FAILED, DONE, INTERNAL_FAULT, DeckError, Fault, FlexmbError
from ..memory import LACK_OF_MEMORY, lacks_memory
from ..results.hdf5.kinematic import kinematic_values
from ..results.hdf5.layout import Values
from ..results.hdf5.result_file import empty_result
from ..results.quantities.quantities import SHOWS_ALL, Quantity, ResultError, resolve
from ..run.model import model_of
from ..run.outcome import Listener, Outcome, Run, RunOptions, Stop
from ..run.solution import complete_solution
from ..run.solutions import Solution
from .continuous import highest
from .modal import modal_quantity, modal_values
from .study import FIRST, HIGHEST, LARGEST, LAST, LOWEST, MEAN, MODAL, SERIES, SMALLEST, Cases, Kept, Study

if TYPE_CHECKING:
    import h5py

    from ..solvers.kinematics.variants import Variants

MESSAGE_LENGTH = 2000
NO_SERIES = np.zeros((0, 0))


@dataclass(frozen=True)
class CaseResult:
    """Result of a case: its number from 0, exit code, rows solved, values and series by position."""

    case: int
    exit_code: int
    rows: int
    parameters: np.ndarray  # (parameters,)
    values: np.ndarray  # (results that are one number,)
    series: np.ndarray  # (results that are series, rows of the study)
    message: str = ""


@dataclass
class CaseSolver:
    """Solves cases of `study` on `deck`, which has been read already; files it names are in `folder`.

    `early`: what happened before somebody listened, such as that kernels have to be compiled.
    """

    deck: Deck
    study: Study
    folder: str
    options: RunOptions = field(default_factory=RunOptions)
    early: list[tuple[str, Any]] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.listener = Listener(
            notice=lambda fault: self.early.append(("notice", fault)),
            status=lambda doing: self.early.append(("status", doing)),
        )
        self.cases = Cases(self.study)
        self._settable = SettableDeck(self.deck)
        self._refuse_unknown_numbers()
        self.takes = [item.take for item in self.study.results]
        solution = self._solution(self._with_constants()) if set(self.takes) - set(MODAL) else None
        self.rows = solution.rows if solution else 0
        self.quantities = _quantities(self.study, self.deck, solution)
        names = [item.name for item in self.study.parameters]
        plain = solution and not set(self.takes) & set(MODAL)
        dialect = dialect_named(self.deck.dialect)
        self._together = CasesTogether.of(names, dialect, solution) if solution and plain else None

    def listened_by(self, listener: Listener) -> None:
        """Report to `listener` from now on, earlier notices first."""
        self.listener = listener
        for kind, said in self.early:
            getattr(listener, kind)(said)
        self.early.clear()

    @property
    def single(self) -> int:
        """Return how many of the results are one number."""
        return sum(take != SERIES for take in self.takes)

    def warnings(self) -> list[Fault]:
        """Return those about the deck with the numbers that all cases have, and about its assembly."""
        deck = self._with_constants()
        run, faults = self._run(deck), list(deck.warnings)
        with suppress(FlexmbError):  # cases may have other numbers, which can be solved
            solution = complete_solution(model_of(deck, run), deck, run)
            faults += [*run.outcome.faults, *solution.model_warnings()]
            analysis: Any = solution.analysis
            if hasattr(analysis, "start"):
                analysis.start()
            elif solution.variants():  # whose first block is the first row
                next(iter(solution.blocks()), None)
            faults += solution.warnings
        return [fault for fault in dict.fromkeys(faults) if fault.severity == "warning"]

    def _refuse_unknown_numbers(self) -> None:
        """Names that the deck lacks are a fault of the study; values may still be wrong case by case."""
        formulas = (item.formula for item in self.study.parameters if item.formula)
        of_formulas = {name for one in formulas for name in one.names}
        unknown = [
            item
            for item in self.study.parameters
            if item.name not in self._settable and item.name not in of_formulas
        ]
        if unknown:
            raise DeckError(
                [
                    Fault("error", self._settable.unknown(item.name), item.place, id="STUDY-014")
                    for item in unknown
                ]
            )

    def _with_constants(self) -> Deck:
        """Return the deck with the numbers that are the same in all cases."""
        parameters = self.study.parameters
        row = self.study.complete(
            [item.values[0] if len(item.values) == 1 else np.nan for item in parameters]
        )
        known = [item for item, value in zip(parameters, row, strict=True) if np.isfinite(value)]
        constant = replace(self.study, parameters=tuple(known))
        settings = constant.settings(
            [value for value in row if np.isfinite(value)], self._settable.__contains__
        )
        return self._settable.with_settings(settings) if settings else self.deck

    def _run(self, deck: Deck) -> Run:
        return Run(Outcome(os.path.join(self.folder, deck.source.name)), self.options, self.listener)

    def _solution(self, deck: Deck) -> Solution:
        run = self._run(deck)
        return complete_solution(model_of(deck, run), deck, run)

    @property
    def at_once(self) -> int:
        """Return how many cases are solved together."""
        return self._together.variants.at_once if self._together else 1

    def solve_several(self, cases: range) -> list[CaseResult]:
        """The results of cases; they are those of each solved alone."""
        if self._together is None:
            return [self.solve(case) for case in cases]
        try:
            parameters = np.array([self.cases.row(case) for case in cases], dtype=float)
            values, plain = self._together.solve(parameters)
        except (MemoryError, OverflowError):  # each of them alone may be spared it, or else reports it
            return [self.solve(case) for case in cases]
        columns = [self._values_of(quantity, values).reshape(len(cases), -1) for quantity in self.quantities]
        times = values["time"].reshape(len(cases), -1)
        return [
            self._plain_result(case, times[k], [rows[k] for rows in columns])
            if plain[k]
            else self.solve(case)
            for k, case in enumerate(cases)
        ]

    def _plain_result(self, case: int, times: np.ndarray, rows_of_quantities: list[np.ndarray]) -> CaseResult:
        """The result of a case by the rows of each quantity, in blocks as an analysis yields them."""
        taken = self._nothing_taken()
        for part, rows in zip(taken, rows_of_quantities, strict=True):
            for block in (slice(0, 1), slice(1, None)):
                part.add(times[block], rows[block])
        return self._result(case, self.cases.row(case), DONE, self.rows, taken, "")

    @staticmethod
    def _values_of(quantity: Quantity, values: Values) -> np.ndarray:
        rows_of: tuple[Any, ...] = (slice(None), *quantity.index)
        return values[quantity.dataset][rows_of]

    def solve(self, case: int) -> CaseResult:
        """The result of a case; what fails is reported in it."""
        return self.solve_row(case, self.cases.row(case))

    def solve_row(self, case: int, row: list[float | int]) -> CaseResult:
        """The result of the case with these values of the parameters; what fails is reported in it."""
        taken, rows, code, message = self._nothing_taken(), 0, DONE, ""
        pairs = zip(self.quantities, taken, strict=True)
        moving = [(quantity, part) for quantity, part in pairs if part.take not in MODAL]
        try:
            deck = self._deck(row)
            for values in self._blocks(deck) if moving else ():
                rows += len(values["time"])
                for quantity, part in moving:
                    part.add(values["time"], self._values_of(quantity, values))
            _take_modes(taken, self._modes(deck))
        except FlexmbError as failure:
            code, message = failure.exit_code, failure.faults[0].sentence
        except Exception as fault:
            # A stop that became another exception is none of the case's.
            Stop.raise_if_asked()
            code, message = _reported(fault)
        return self._result(case, row, code, rows, taken, message)

    def _blocks(self, deck: Deck) -> Iterator[Values]:
        solution = self._solution(deck)
        self._refuse_other_grid(solution)
        yield from solution.blocks()

    def _deck(self, row: list[float | int]) -> Deck:
        return self._settable.with_settings(self.study.settings(row, self._settable.__contains__))

    def _modes(self, deck: Deck) -> list[float]:
        return modal_values((i for i in self.study.results if i.take in MODAL), deck, self._run(deck))

    @property
    def moving(self) -> list[Quantity]:
        """Return the quantities that are taken of the motion."""
        return [one for one, take in zip(self.quantities, self.takes, strict=True) if take not in MODAL]

    def prepared(self, row: list[float | int]) -> Solution:
        """Return the run with these values of the parameters, ready to be solved.  Raises FlexmbError."""
        return self._solution(self._deck(row))

    def modes(self, row: list[float | int]) -> np.ndarray:
        """Return the results that are frequencies or damping.  Raises FlexmbError."""
        return np.array(self._modes(self._deck(row)))

    def taken_of(
        self, row: list[float | int], times: np.ndarray, columns: np.ndarray, modes: np.ndarray
    ) -> CaseResult:
        """Return the case of a motion whose `moving` quantities are `columns` (rows, k), and of its modes."""
        taken = self._nothing_taken()
        moving = [part for part in taken if part.take not in MODAL]
        for part, column in zip(moving, columns.T, strict=True):
            part.add(times, column)
        _take_modes(taken, modes)
        return self._result(0, row, DONE, len(times), taken, "")

    def unsolved(self, case: int, code: int, message: str) -> CaseResult:
        """The result of a case of which nothing is known but that it failed."""
        return self._result(case, self.cases.row(case), code, 0, self._nothing_taken(), message)

    def _nothing_taken(self) -> "list[_Taken]":
        return [_Taken(item, self.rows) for item in self.study.results]

    def _result(
        self, case: int, row: list[float | int], code: int, rows: int, taken: "list[_Taken]", message: str
    ) -> CaseResult:
        parameters = np.array(row, dtype=float)
        # The largest of the rows before a lock is no result; a series shows where it ends.
        single = [part.final() if code == DONE else np.nan for part in taken if part.take != SERIES]
        series = np.array([part.series for part in taken if part.take == SERIES], dtype=float)
        series = series.reshape(len(taken) - len(single), -1) if self.study.keeps_series else NO_SERIES
        return CaseResult(
            case, code, rows, parameters, np.array(single, dtype=float), series, message[:MESSAGE_LENGTH]
        )

    def _refuse_other_grid(self, solution: Solution) -> None:
        if self.study.keeps_series and solution.rows != self.rows:
            message = (
                f"the case has {solution.rows} report times, the study's deck {self.rows}; "
                "vary no times where series are kept"
            )
            raise DeckError([Fault("error", message, id="STUDY-015")])


def _reported(fault: Exception) -> tuple[int, str]:
    """Exit code and message of a case that ended of what no deck should bring about."""
    if lacks_memory(fault):
        return ANALYSIS_FAILED, f"{LACK_OF_MEMORY}; `sweep --fresh` solves the study again"
    # What the exception says may hold a path, and a result must not.
    remedy = "`flexmb --debug run` with these numbers shows where"
    return INTERNAL_FAULT, f"a fault of flexmb itself: {type(fault).__name__}; {remedy}"


def _quantities(study: Study, deck: Deck, solution: Solution | None) -> list[Quantity]:
    """Return what the study keeps, looked up in a result without rows.  Raises DeckError."""
    faults: list[Fault] = []
    quantities = [modal_quantity(item, faults) if item.take in MODAL else None for item in study.results]
    if solution:
        with empty_result(deck, solution.layout()) as result:
            named = zip(study.results, quantities, strict=True)
            quantities = [quantity or _one(result, item, faults) for item, quantity in named]
    if faults:
        raise DeckError(faults)
    return [quantity for quantity in quantities if quantity is not None]


def _one(result: "h5py.File", item: Kept, faults: list[Fault]) -> Quantity | None:
    if item.take in MODAL:
        return None  # which has its fault
    subject = f"result {item.name}"
    try:
        quantities = resolve(result, [item.quantity])
    except ResultError as failure:
        message = str(failure).removesuffix(SHOWS_ALL)
        faults.append(Fault("error", message, item.place, subject, id="STUDY-016"))
        return None
    if len(quantities) > 1:
        names = ", ".join(quantity.name for quantity in quantities[:6])
        message = f"{item.quantity} is more than one number: {names} …; name one"
        faults.append(Fault("error", message, item.place, subject, id="STUDY-054"))
        return None
    return quantities[0]


class _Taken:
    """The wanted values of one quantity, block by block; nan where there are none."""

    def __init__(self, item: Kept, rows: int):
        self.take, self.value, self.count = item.take, np.nan, 0
        self.start, self.end = item.start, item.end
        self.series = np.full(rows if self.take == SERIES else 0, np.nan)
        self.blocks: list[tuple[np.ndarray, np.ndarray]] = []

    def add(self, times: np.ndarray, values: np.ndarray) -> None:
        """Take what is wanted of the values at these times, s."""
        if self.take in (HIGHEST, LOWEST):
            self.blocks.append((times, values))
            return
        values = values[(times >= self.start) & (times <= self.end)]
        before, self.count = self.count, self.count + len(values)
        if not len(values):
            return
        if self.take == SERIES:
            self.series[before : self.count] = values
        elif self.take == LAST:
            self.value = values[-1]
        elif self.take == FIRST:
            self.value = values[0] if before == 0 else self.value
        elif self.take == LARGEST:
            self.value = np.fmax(self.value, values.max())
        elif self.take == SMALLEST:
            self.value = np.fmin(self.value, values.min())
        elif self.take == MEAN:
            total = values.sum() + (self.value * before if before else 0.0)
            self.value = total / self.count

    def final(self) -> float:
        """Return the value when all blocks are there."""
        if not self.blocks:
            return self.value
        times, values = (np.concatenate(parts) for parts in zip(*self.blocks, strict=True))
        sign = 1.0 if self.take == HIGHEST else -1.0
        return sign * highest(times, sign * values, self.start, self.end)


def _take_modes(taken: Sequence[_Taken], values: Iterable[float]) -> None:
    for part, value in zip((part for part in taken if part.take in MODAL), values, strict=True):
        part.value = value


@dataclass(frozen=True)
class CasesTogether:
    """`places`: section, index of the record and of the component of each parameter of the study."""

    variants: "Variants"
    places: tuple[tuple[str, int, int], ...]

    @classmethod
    def of(cls, names: list[str], dialect: Dialect, solution: Solution) -> "CasesTogether | None":
        """Return how cases of other numbers of these `names` are solved together, or None."""
        variants = solution.variants()
        if variants is None or not variants.at_once:
            return None
        places = [place for name in names if (place := _place(name, dialect))]
        return cls(variants, tuple(places)) if len(places) == len(names) else None

    def solve(self, values: np.ndarray) -> tuple[Values, np.ndarray]:
        """Return the values of the rows of all cases, one behind the other, and which cases count (cases,).

        values (cases, parameters): those of the study.
        """
        numbers = {
            section: np.repeat(given[None], len(values), axis=0)
            for section, given in (("driver", self.variants.functions), ("point", self.variants.points))
        }
        for (section, index, component), column in zip(self.places, values.T, strict=True):
            numbers[section][:, index, component] = column
        rows, plain = self.variants.solve(numbers["driver"], numbers["point"])
        return kinematic_values(rows), plain


def _place(name: str, dialect: Dialect) -> tuple[str, int, int] | None:
    section, _, rest = name.partition(".")
    number, _, key = rest.partition(".")
    keys = dialect.as_given.get(section, ())
    return (section, int(number) - 1, keys.index(key)) if key in keys else None
