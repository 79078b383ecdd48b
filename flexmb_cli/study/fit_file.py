"""Study files of `flexmb fit`: unknown numbers with bounds, and what the results of the deck shall meet."""

import csv
import os
import re
from collections.abc import Iterator
from dataclasses import dataclass, replace
from math import inf, isfinite
from typing import Any

from ..deck.expansion.expressions import Formula
from ..deck.record import DeckText
from ..errors import DeckError
from .reader import StudyReader, is_number, study_table
from .study import LATIN, SERIES, Kept, Study, Varied

LEAST_SQUARES, SLSQP, TRUST, EVOLUTION = "least-squares", "slsqp", "trust-constr", "differential-evolution"
METHODS = (LEAST_SQUARES, SLSQP, TRUST, EVOLUTION)
AT_MOST, AT_LEAST, EQUAL = "<=", ">=", "=="
_CONSTRAINT = re.compile(r"(.+?)(<=|>=|==)(.+)")
KEYS = (
    "deck", "dialect", "method", "restarts", "seed", "iterations", "population", "parameters", "results",
    "targets", "objective", "constraints",
)  # fmt: skip
TARGET_KEYS = (
    "quantity", "points", "times", "values", "file", "time", "column", "formula", "result", "value",
    "weight", "from", "to",
)  # fmt: skip
MOST_RESTARTS, MOST_ITERATIONS, MOST_TARGET_POINTS = 100_000, 1_000_000, 1_000_000
SAMPLES_A_START = 10  # points looked at for each start


@dataclass(frozen=True)
class Target:
    """Values that quantities shall meet: `points` (m, k) of k quantities at `times` (m,), s, or at any time.

    `formula`: of the time, met in every report row from `start` to `end`, s.  `result`: a number of the study
    that shall be `points[0][0]`.  Residuals are multiplied by `weight`.
    """

    name: str
    quantities: tuple[Formula, ...] = ()
    points: tuple[tuple[float, ...], ...] = ()
    times: tuple[float, ...] = ()
    weight: float = 1.0
    formula: Formula | None = None
    result: str = ""
    start: float = -inf
    end: float = inf


@dataclass(frozen=True)
class Constraint:
    """`excess`: left less right side of a relation, one of AT_MOST, AT_LEAST, EQUAL."""

    text: str
    excess: tuple[Formula, Formula]
    relation: str


@dataclass(frozen=True)
class Fit:
    """`study`: deck, parameters, a sample of the unknown ones, and all that is wanted of a variant.

    `starts`: the start of each unknown number, nan where the file has none.  Either `targets` are met by
    least squares, or `objective` is least.
    """

    study: Study
    method: str
    starts: tuple[float, ...]
    targets: tuple[Target, ...]
    objective: Formula | None
    constraints: tuple[Constraint, ...]
    restarts: int
    iterations: int
    population: int

    @property
    def unknown(self) -> list[Varied]:
        """Return the parameters that are sought, each with its bounds as values."""
        return [item for item in self.study.parameters if len(item.values) > 1]

    @property
    def numbers(self) -> list[Kept]:
        """Return the results that are one number, which targets and constraints may name."""
        return [item for item in self.study.results if item.take != SERIES]


def read_fit(source: DeckText, folder: str) -> Fit:
    """Return the fit of a TOML text; files of columns are in `folder`.  Raises DeckError with every fault."""
    reader = _FitReader(source, study_table(source))
    reader.folder = folder
    fit = reader.fit()
    if reader.faults or fit is None:
        raise DeckError(reader.faults)
    return fit


class _FitReader(StudyReader):
    """Walks the tables of a fit and collects faults."""

    folder = ""

    def fit(self) -> Fit | None:
        self._refuse_unknown(self.table, KEYS, "fit")
        self.starts: dict[str, float] = {}
        pairs = [self._parameter(name, item) for name, item in self._entries("parameters")]
        parameters = tuple(item for item in pairs if item)
        self._check_formulas(list(parameters))
        numbers = [self._kept(*item) for item in self._entries("results")] if "results" in self.table else []
        single = [item for item in numbers if item and item.take != SERIES]
        known = {item.name for item in parameters} | {item.name for item in single}
        targets = self._targets({item.name for item in single})
        objective = self._of_names("objective", self.table.get("objective"), known)
        constraints = tuple(self._constraints(known))
        self.within = ""
        if bool(targets) == bool(objective) and not self.faults:
            self._fault(
                "objective", "a fit has either [targets] or an objective that is least", id="STUDY-118"
            )
        unknown = [item for item in parameters if len(item.values) > 1]
        if not unknown and not self.faults:
            message = "none is unknown; an unknown number is { from = 1, to = 2, start = 1.5 }"
            self._fault("parameters", message, id="STUDY-119")
        restarts = self._whole("restarts", 0, MOST_RESTARTS, 0)
        study = Study(
            self._text("deck"), self._choice("dialect", self.dialects, self.dialects[0]), LATIN, parameters,
            (*single, *_series_of(targets)), SAMPLES_A_START * ((restarts or 0) + 1),
            self._whole("seed", 0, 2**32 - 1, 0),
        )  # fmt: skip
        default = SLSQP if objective or constraints else LEAST_SQUARES
        method = self._choice("method", METHODS, default)
        if method == LEAST_SQUARES and default != method and not self.faults:
            message = f"takes targets and no constraints; method is one of {', '.join(METHODS[1:])}"
            self._fault("method", message, id="STUDY-120")
        starts = tuple(self.starts.get(item.name, float("nan")) for item in unknown)
        iterations = self._whole("iterations", 1, MOST_ITERATIONS, 200)
        population = self._whole("population", 4, MOST_ITERATIONS, 15 * max(1, len(unknown)))
        return None if self.faults else Fit(
            study, method, starts, targets, objective, constraints, restarts, iterations, population
        )  # fmt: skip

    def _parameter(self, name: str, item: Any) -> Varied | None:
        if not isinstance(item, dict):
            if is_number(item) or isinstance(item, str):
                return self._varied(name, item, sampled=True)
            self._fault(
                name, "needs { from = 1, to = 2, start = 1.5 }, a number or a formula", id="STUDY-121"
            )
            return None
        start = item.get("start")
        varied = self._varied(name, {key: item[key] for key in item if key != "start"}, sampled=True)
        if varied and varied.tolerance:
            return self._wrong(name, "has bounds, from and to, in a fit, and no tolerance", "STUDY-141")
        if varied is None or start is None:
            return varied
        if not is_number(start) or not min(varied.values) <= start <= max(varied.values):
            self._fault(name, "its start lies between its ends", id="STUDY-122")
        else:
            self.starts[name] = float(start)
        return varied

    def _of_names(self, key: str, text: Any, known: set[str]) -> Formula | None:
        """Return a formula of parameters and results."""
        if text is None:
            return None
        parsed = self._formula(key, text if isinstance(text, str) else "")
        if parsed and (unknown := [name for name in parsed.names if name not in known]):
            message = f"names {unknown[0]}, which is in neither [parameters] nor [results]"
            self._fault(key, message, id="STUDY-123")
            return None
        return parsed

    def _constraints(self, known: set[str]) -> Iterator[Constraint]:
        texts = self.table.get("constraints", [])
        for text in texts if isinstance(texts, list) else [None]:
            parts = _CONSTRAINT.fullmatch(text) if isinstance(text, str) else None
            if parts is None:
                message = 'holds relations: constraints = ["crank + coupler <= 5", "top >= 1", "a == b"]'
                self._fault("constraints", message, id="STUDY-124")
                continue
            sides = [self._of_names("constraints", parts[k].strip(), known) for k in (1, 3)]
            if sides[0] and sides[1]:
                yield Constraint(parts[0], (sides[0], sides[1]), parts[2])

    def _targets(self, results: set[str]) -> tuple[Target, ...]:
        if "targets" not in self.table:
            return ()
        items = []
        for name, item in self._entries("targets"):
            if not isinstance(item, dict):
                self._fault(name, 'is a table: { quantity = "point.1.x", … }', id="STUDY-125")
                continue
            self._refuse_unknown(item, TARGET_KEYS, name)
            items.append(self._target(name, item, results))
        return tuple(item for item in items if item)

    def _target(self, name: str, item: dict[str, Any], results: set[str]) -> Any:
        ends = [item.get(key, default) for key, default in (("weight", 1.0), ("from", -inf), ("to", inf))]
        if not all(isinstance(end, int | float) for end in ends) or not (isfinite(ends[0]) and ends[0] > 0):
            return self._wrong(name, "weight is a positive number, from and to are times, s", "STUDY-126")
        target = Target(name, weight=float(ends[0]), start=float(ends[1]), end=float(ends[2]))
        if "result" in item:
            value = item.get("value")
            if item["result"] not in results or not is_number(value):
                form = '{ result = "top", value = 1.5 } with a number of [results]'
                return self._wrong(name, f"is written {form}", "STUDY-127")
            return replace(target, result=item["result"], points=((float(value),),))
        words = item.get("quantity")
        words = [words] if isinstance(words, str) else words
        if not isinstance(words, list) or not words or not all(isinstance(word, str) for word in words):
            return self._wrong(name, 'needs quantity = "point.1.x" or a list of quantities', "STUDY-128")
        formulas = tuple(one for word in words if (one := self._formula(name, word)))
        if len(formulas) < len(words):
            return None
        target = replace(target, quantities=formulas)
        if "formula" in item:
            parsed = self._formula(name, str(item["formula"]))
            if parsed is None or len(words) > 1 or set(parsed.names) - {"time"}:
                return self._wrong(name, "a formula gives one quantity by the time", "STUDY-129")
            return replace(target, formula=parsed)
        return self._with_points(target, item)

    def _with_points(self, target: Target, item: dict[str, Any]) -> Any:
        """Return a target with points of a file, or those in the study."""
        points = item.get("points", [[value] for value in item.get("values", ())])
        times = item.get("times", [])
        if "file" in item:
            try:
                times, *columns = self._columns(item)
                points = list(zip(*columns, strict=True))
            except (OSError, ValueError, KeyError) as fault:
                return self._wrong(target.name, f"its file cannot be read: {fault}", "STUDY-130")
        rows = [row for row in points if isinstance(row, list | tuple) and all(map(is_number, row))]
        wide = all(len(row) == len(target.quantities) for row in rows)
        if not rows or len(rows) < len(points) or not wide or len(rows) > MOST_TARGET_POINTS:
            count = len(target.quantities)
            return self._wrong(target.name, f"needs points, each of {count} numbers, or a file", "STUDY-131")
        if len(times) not in (0, len(rows)) or not all(map(is_number, times)):
            return self._wrong(target.name, f"needs {len(rows)} times or none", "STUDY-132")
        if not times and len(target.quantities) < 2:
            return self._wrong(target.name, "points without times need two quantities or more", "STUDY-133")
        values = tuple(tuple(map(float, row)) for row in rows)
        return replace(target, points=values, times=tuple(map(float, times)))

    def _columns(self, item: dict[str, Any]) -> list[tuple[float, ...]]:
        """Return the times and the columns of a CSV file; units in brackets are left out of their heads."""
        names = item.get("column", [])
        columns = [item.get("time", "time"), *([names] if isinstance(names, str) else names)]
        path = os.path.join(self.folder, item["file"])
        if not os.path.isfile(path):  # a pipe would be waited for
            raise ValueError(f"{item['file']} is not a regular file")
        with open(path, encoding="utf-8", newline="") as file:
            text = file.read(2**26)
        table = [row for row in csv.reader(text.splitlines()) if row and not row[0].startswith("#")]
        heads = [re.sub(r"\s*\[.*\]\s*$", "", head).strip() for head in table[0]] if table else []
        for name in columns:
            if name not in heads:
                raise ValueError(f"it has no column {name!r}; its columns are {', '.join(heads)}")
        places = [heads.index(name) for name in columns]
        return [tuple(float(row[place]) for row in table[1:]) for place in places]

    def _wrong(self, name: str, message: str, id: str) -> Any:
        return self._fault(name, message, id=id)


def _series_of(targets: tuple[Target, ...]) -> Iterator[Kept]:
    """Return the series that targets need, each once, and the times of the rows."""
    names = [name for target in targets for one in target.quantities for name in one.names]
    if names:
        for name in dict.fromkeys((*names, "time")):
            yield Kept(name, name, SERIES)
