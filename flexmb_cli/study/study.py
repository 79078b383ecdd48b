"""A study: one deck, the numbers of it that vary, how they are combined, and what is kept of every case."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from math import inf, isfinite, nan, prod

import numpy as np

from ..deck.expansion.expressions import Formula, evaluated
from ..errors import DeckError, Fault, Place

GRID, TOGETHER, LATIN = "grid", "together", "latin-hypercube"
SAMPLINGS = (GRID, TOGETHER, LATIN)
LAST, FIRST, LARGEST, SMALLEST, MEAN, SERIES = "last", "first", "max", "min", "mean", "series"
# Of the continuous motion, and of a mode: its number and the state that it is linearised about.
HIGHEST, LOWEST, FREQUENCY, DAMPING = "highest", "lowest", "frequency", "damping"
MODAL = (FREQUENCY, DAMPING)
TAKES = (LAST, FIRST, LARGEST, SMALLEST, MEAN, SERIES, HIGHEST, LOWEST, *MODAL)


@dataclass(frozen=True)
class Varied:
    """A number of the deck by its readable name, and its values; of a sampled one, the ends of its range.

    A single value is that of all cases.  `logarithmic`: a sample is even in the logarithm of the number.
    `place`: in the study's file.  `formula`: its value by those of other parameters, in place of values.
    `tolerance`: the ends are so far from its value; 0 of a range.
    """

    name: str
    values: tuple[float | int, ...] = ()
    logarithmic: bool = False
    place: Place | None = None
    formula: Formula | None = None
    tolerance: float = 0.0


@dataclass(frozen=True)
class Kept:
    """A result of every case: its name in the table, the quantity, and which of its values is taken.

    `place`: in the study's file.  `start`, `end`: of the time in which it is taken, s.
    """

    name: str
    quantity: str
    take: str
    place: Place | None = None
    start: float = -inf
    end: float = inf


@dataclass(frozen=True)
class Study:
    """`deck`: path beside the study's own; `sampling` one of SAMPLINGS; `count` and `seed` of a sample.

    `together`: groups of parameters of a grid whose values go together.
    """

    deck: str
    dialect: str
    sampling: str
    parameters: tuple[Varied, ...]
    results: tuple[Kept, ...]
    count: int = 0
    seed: int = 0
    together: tuple[tuple[str, ...], ...] = ()

    @cached_property
    def axes(self) -> list[list[int]]:
        """Return the numbers of the parameters along each axis of a grid, those that go together in one."""
        groups = self.together
        if self.sampling == TOGETHER:
            groups = (tuple(item.name for item in self.parameters),)
        group_of = {name: k for k, group in enumerate(groups) for name in group}
        axes: dict[int | str, list[int]] = {}
        for number, item in enumerate(self.parameters):
            if len(item.values) > 1:
                axes.setdefault(group_of.get(item.name, item.name), []).append(number)
        return list(axes.values())

    @cached_property
    def cases(self) -> int:
        """Return how many variants there are."""
        if self.sampling == LATIN:
            return self.count
        return prod(len(self.parameters[axis[0]].values) for axis in self.axes)

    @property
    def keeps_series(self) -> bool:
        """Return whether any result is kept row by row."""
        return any(item.take == SERIES for item in self.results)

    def row_of(self, case: int) -> list[float | int]:
        """Values of the parameters of a case that needs no sample; in a grid the last one varies fastest."""
        row = [item.values[0] if item.values else nan for item in self.parameters]
        for axis in reversed(self.axes):
            case, k = divmod(case, len(self.parameters[axis[0]].values))
            for number in axis:
                row[number] = self.parameters[number].values[k]
        return self.complete(row)

    def complete(self, row: list[float | int]) -> list[float | int]:
        """Return the values of the parameters with those by formulas, nan where these have none."""
        formulas = {item.name: item.formula for item in self.parameters if item.formula}
        if not formulas:
            return row
        named = zip(self.parameters, row, strict=True)
        chosen = {item.name: value for item, value in named if not item.formula}
        values: dict[str, float | str] = {**chosen, **dict(evaluated(formulas, chosen))}
        return [nan if isinstance(value := values[item.name], str) else value for item in self.parameters]

    def settings(self, row: list[float | int], is_of_deck: Callable[[str], bool]) -> list[str]:
        """Return the values of parameters that the deck has as `--set` takes them; raises DeckError."""
        for item, value in zip(self.parameters, row, strict=True):
            if not isfinite(value):
                message = f"has no value in this case: {item.formula.text if item.formula else value}"
                raise DeckError([Fault("error", message, item.place, item.name, id="STUDY-110")])
        named = zip(self.parameters, row, strict=True)
        return [f"{item.name}={_word(item, value)}" for item, value in named if is_of_deck(item.name)]


def _word(item: Varied, value: float | int) -> str:
    """Return a number as `--set` takes it: a formula has whole numbers for whole values."""
    whole = item.formula is not None and isinstance(value, float) and value.is_integer()
    return repr(int(value) if whole and abs(value) < 1e15 else value)


class Cases:
    """Parameter values of every case of a study, made when they are requested.

    A sample is that of SciPy's Latin hypercube with the study's seed: any process has the same.
    """

    def __init__(self, study: Study):
        self.study = study
        self._sample: np.ndarray | None = None

    def row(self, case: int) -> list[float | int]:
        """Values of the parameters of case number `case`, counted from 0."""
        if self.study.sampling != LATIN:
            return self.study.row_of(case)
        if self._sample is None:
            self._sample = _sample(self.study)
        return self.study.complete(self._sample[case].tolist())


def _sample(study: Study) -> np.ndarray:
    """Values (cases, parameters); those by formulas are nan."""
    from scipy.stats import qmc

    sampled = [item for item in study.parameters if len(item.values) > 1]
    unit: np.ndarray = qmc.LatinHypercube(max(1, len(sampled)), seed=study.seed).random(study.count)
    columns = {item.name: _stretched(item, unit[:, k]) for k, item in enumerate(sampled)}
    single = {item.name: np.full(study.count, (*item.values, nan)[0]) for item in study.parameters}
    return np.column_stack([columns.get(item.name, single[item.name]) for item in study.parameters])


def _stretched(item: Varied, unit: np.ndarray) -> np.ndarray:
    """Return the values of a number between its ends by places from 0 to 1."""
    low, high = np.log(item.values) if item.logarithmic else item.values
    column: np.ndarray = low + unit * (high - low)
    return np.exp(column) if item.logarithmic else column
