"""Functions of time, of a stretch or of a rate, of the lines FUNCTION."""

import math
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from ...deck.record import Record
from ...model.diagnostics import Findings
from ...model.piecewise_polynomials import linear_table, polynomial, smooth_step, spline_table
from ...model.time_functions import (
    SIGNAL,
    SINE,
    MotionFunction,
    integral_of,
    is_signal,
    periodic,
    piecewise,
    product_of,
    smoothness,
    sum_of,
)
from .function_lines import GivenFunction, given_functions, name_of, numbers_of_file
from .line import ElementLine

_NO_NUMBER = re.compile(r"-+[0-9]+|0+")  # below 1: 0 means that there is no function
LARGEST_TABLES = 2_000_000  # numbers of the functions of a deck
MOST_FACTORS = 1000  # of a term, and terms, of what is multiplied out
CURVE_POINTS = 4  # of a curve
SHORTEST = 1e-50  # of the distance of two points, s: slopes of larger numbers would leave the doubles


class Functions:
    """The functions of a deck's lines by their numbers or names, as texts; faults go into `findings`.

    Files are relative to `folder`.  `tables`: functions of the cards TABL by their numbers, in dialects that
    have such, None for faulty ones.
    """

    def __init__(
        self,
        lines: Sequence[ElementLine],
        folder: Path,
        findings: Findings,
        tables: Mapping[int, MotionFunction | None] | None = None,
    ):
        self.findings, self.folder = findings, folder
        self._functions: dict[str, MotionFunction] = {}
        self._used: set[str] = set()
        self._records: dict[str, Record] = {}
        self._values = 0
        for function in given_functions(lines, folder, findings, tables):
            self._values += len(function.values)
            if self._values > LARGEST_TABLES:
                message = f"the functions of a deck have at most {LARGEST_TABLES} numbers together"
                findings.error(function.line.subject, message, function.line.place, id="ELEMENTS-025")
                break
            self._take(function)
        for k, line in enumerate(line for line in lines if line.word == "SIGNAL"):
            self._take_signal(line, k)

    def _take_signal(self, line: ElementLine, k: int) -> None:
        """Take signal k for a function: of its own number, if it has one, and its name."""
        names = [line.subject, *([name_of(line["number"])] if "number" in line else ())]
        for name in names:
            if name in self._records:
                message = f"function number {name} is already {self._records[name].subject}"
                self.findings.error(line.subject, message, line.place_of("number"), id="ELEMENTS-081")
                return
            self._records[name], self._functions[name] = (
                line,
                MotionFunction(SIGNAL, (float(k), 0.0, 0.0, 0.0)),
            )
        self._used.add(line.subject)

    def _take(self, given: GivenFunction) -> None:
        line = given.line
        for name, place in given.names:
            if _NO_NUMBER.fullmatch(name) or name in self._records:
                other = self._records.get(name)
                why = f"is already {other.subject}" if other else "must be 1 or more"
                self.findings.error(line.subject, f"function number {name} {why}", place, id="ELEMENTS-012")
                return
            self._records[name] = line
        if given.faulty:
            return
        kind = KINDS[line.kind]
        if not kind.fits(len(given.values)):
            message = f"{line.kind} takes {kind.wanted}; read {len(given.values)} numbers"
            self.findings.error(line.subject, message, line.place, id="ELEMENTS-013")
            return
        function = kind.make(self, given)
        if function is not None:
            self._functions.update((name, function) for name, _ in given.names)

    def __contains__(self, value: object) -> bool:
        """Return whether a name or number is that of a function."""
        return name_of(value) in self._records

    def function(self, record: Record, key: str) -> MotionFunction | None:
        """The function that `key` of a record names; None where there is none."""
        number = record.at(key)
        name = name_of(number.value)
        if name not in self._records:
            known = listed(self._records) or "none"
            message = f"there is no function {name}; the deck has {known}; define it, or name another"
            self.findings.error(record.subject, message, number.place, id="ELEMENTS-014")
        else:
            self._used.add(self._records[name].subject)
        return self._functions.get(name)

    def named(self, name: str) -> MotionFunction | None:
        """The function of a name that is known; None where it has a fault."""
        self._used.add(self._records[name].subject)
        return self._functions.get(name)

    def motion(self, record: Record, key: str) -> MotionFunction | None:
        """The function that a driver's coordinate follows."""
        function = self._of_time(record, key)
        if function is not None:
            self._refuse_rough(record, function, 1, "the rate of a coordinate cannot jump", key)
        return function

    def integrated(self, record: Record, key: str, start: float, given: float = 0.0) -> MotionFunction | None:
        """The integral of the function from `given` at the time `start` on."""
        function = self._of_time(record, key)
        if function is None:
            return None
        self._refuse_rough(record, function, 0, "a rate cannot jump", key)
        integral = integral_of(function, start)
        if integral is None:
            message = (
                "flexmb has no integral of a product or periodic function; give the coordinate itself, in "
                "place of its rate"
            )
            self.findings.error(record.subject, message, record.at(key).place, id="ELEMENTS-016")
            return None
        return sum_of([integral, piecewise(polynomial([given]))]) if given else integral

    def curve(self, record: Record, key: str) -> MotionFunction | None:
        """The characteristic of a spring or damper over its stretch or rate, which must have an integral."""
        function = self.function(record, key)
        if function is not None and not is_signal(function) and integral_of(function) is None:
            what = "a product or periodic function cannot be the characteristic of a spring"
            message = f"{what}; use table, spline or polynomial"
            self.findings.error(record.subject, message, record.at(key).place, id="ELEMENTS-017")
            return None
        return function

    def path(self, record: Record, key: str) -> MotionFunction | None:
        """A coordinate of a curve over its parameter; 0 without a function."""
        if key not in record:
            return piecewise(polynomial([0.0]))
        function = self.function(record, key)
        if function is not None:
            self._refuse_rough(record, function, 2, "the curvature of a curve cannot jump", key)
        return function

    def paths(self, line: ElementLine) -> tuple[list[MotionFunction], float, float] | None:
        """Splines through the points of a file over the length of their chords, and this at the last one."""
        numbers = numbers_of_file(line, self.folder, self.findings)
        if numbers is None:
            return None
        points = np.array(numbers[: len(numbers) // 3 * 3]).reshape(-1, 3)
        chords = np.linalg.norm(np.diff(points, axis=0), axis=1)
        if len(numbers) % 3 or len(points) < CURVE_POINTS or not np.all(chords > SHORTEST):
            message = (
                f"a curve takes {CURVE_POINTS} points x y z or more, each apart from the one before; "
                f"{line['file']} has {len(numbers)} numbers"
            )
            self.findings.error(line.subject, message, line.at("file").place, id="ELEMENTS-120")
            return None
        s = np.concatenate([[0.0], np.cumsum(chords)])
        make = periodic if np.array_equal(points[0], points[-1]) else _spline
        return [make(s.tolist(), values) for values in points.T.tolist()], 0.0, float(s[-1])

    def _of_time(self, record: Record, key: str) -> MotionFunction | None:
        """The function that `key` names, which must be no signal: its derivatives are needed."""
        function = self.function(record, key)
        if is_signal(function):
            message = (
                f"{name_of(record[key])} is a signal, which gives no rates; name it as the effort of a MOTOR"
            )
            self.findings.error(record.subject, message, record.at(key).place, id="ELEMENTS-082")
            return None
        return function

    def _refuse_rough(self, record: Record, function: MotionFunction, least: int, why: str, key: str) -> None:
        if smoothness(function) < least:
            remedy = "use spline or step" if least else "move its points apart"
            message = f"{why}, but that of function {name_of(record[key])} does; {remedy}"
            self.findings.error(record.subject, message, record.at(key).place, id="ELEMENTS-018")

    def note_unused(self) -> None:
        """Note functions that nothing follows; what is refused might have."""
        if any(fault.severity == "error" for fault in self.findings.faults):
            return
        for name, record in self._records.items():
            if record.subject not in self._used:
                self._used.add(record.subject)
                message = f"nothing uses function {name}"
                self.findings.note(record.subject, message, record.place, id="ELEMENTS-019")


def listed(names: Iterable[str]) -> str:
    """Return names in their order, numbers by their size."""
    return ", ".join(sorted(names, key=lambda name: (not name.isdigit(), name.zfill(9))))


def _points(functions: Functions, given: GivenFunction, make: Callable[..., Any]) -> Any:
    times, values = given.values[0::2], given.values[1::2]
    for k, (before, after) in enumerate(pairwise(times), 1):
        if not before < after:
            message = (
                f"times must rise; {after:g} follows {before:g} (for a jump take two times a little apart)"
            )
            functions.findings.error(given.line.subject, message, given.place(2 * k), id="ELEMENTS-020")
            return None
        if after - before < SHORTEST:
            message = f"{after:g} follows {before:g} by less than {SHORTEST:g}, too short to compute with"
            functions.findings.error(given.line.subject, message, given.place(2 * k), id="ELEMENTS-026")
            return None
    return make(times, values)


def _table(times: Sequence[float], values: Sequence[float]) -> MotionFunction:
    return piecewise(linear_table(times, values))


def _spline(times: Sequence[float], values: Sequence[float]) -> MotionFunction:
    return piecewise(spline_table(times, values))


def _periodic(functions: Functions, given: GivenFunction) -> Any:
    if given.values[1] != given.values[-1]:
        message = f"the last value of a period is the first, {given.values[1]:g}; read {given.values[-1]:g}"
        functions.findings.error(
            given.line.subject, message, given.place(len(given.values) - 1), id="ELEMENTS-121"
        )
        return None
    return _points(functions, given, periodic)


def _polynomial(_functions: Functions, given: GivenFunction) -> Any:
    return piecewise(polynomial(given.values))


def _sine(_functions: Functions, given: GivenFunction) -> MotionFunction:
    mean, size, omega, phase = (float(value) for value in (*given.values, 0.0)[:4])
    return MotionFunction(SINE, (mean, size, omega, phase))


def _between(functions: Functions, given: GivenFunction, make: Callable[..., Any]) -> Any:
    ends = [float(value) for value in given.values]
    if not ends[0] + SHORTEST < ends[2]:
        message = f"the end {ends[2]:g} s must be later than the start {ends[0]:g} s"
        functions.findings.error(given.line.subject, message, given.place(2), id="ELEMENTS-021")
        return None
    return piecewise(make(*ends))


def _ramp(t0: float, v0: float, t1: float, v1: float) -> Any:
    return linear_table((t0, t1), (v0, v1))


def _combined(known: Any, given: GivenFunction, combine: Callable[..., Any]) -> Any:
    parts = []
    own = {name for name, _ in given.names}
    for k, value in enumerate(map(name_of, given.values)):
        part = known._functions.get(value)
        if value in known._records:
            known._used.add(known._records[value].subject)
        if (part is None and value not in known._records) or value in own:
            message = f"function {value} must be given on a line above"
            known.findings.error(given.line.subject, message, given.place(k), id="ELEMENTS-022")
        parts.append(part)
    if None in parts:
        return None
    # Before they are multiplied out: forty functions that square the one above have 2^40 factors.
    terms, factors = _multiplied_out(parts, combine)
    if max(terms, factors) > MOST_FACTORS:
        many = f"multiplied out it has {terms} terms of {factors} factors, more than {MOST_FACTORS}"
        message = f"{many}; use fewer {'sums' if terms > factors else 'products'}"
        known.findings.error(given.line.subject, message, given.line.place, id="ELEMENTS-023")
        return None
    known._values += terms * factors
    return combine(parts)


def _multiplied_out(parts: Sequence[MotionFunction], combine: Callable[..., Any]) -> tuple[int, int]:
    """Return how many terms a sum or product of functions has, and factors its longest one."""
    terms = [len(part.terms) or 1 for part in parts]
    factors = [max(map(len, part.terms), default=1) for part in parts]
    return (sum(terms), max(factors)) if combine is sum_of else (math.prod(terms), sum(factors))


@dataclass(frozen=True)
class Kind:
    """A type of function: what makes it, and how many numbers define it.

    `least` numbers or more, by `step`, up to `most` (0: any).
    """

    make: Callable[..., Any]
    wanted: str
    least: int
    most: int = 0
    step: int = 1

    def fits(self, count: int) -> bool:
        """Return whether so many numbers can define one."""
        enough = self.least <= count <= (self.most or count)
        return enough and (count - self.least) % self.step == 0


_ENDS = "start from end to: from the first value at the start to the last at the end"
_PARTS = "one function above or more"
KINDS = {
    "table": Kind(lambda f, g: _points(f, g, _table), "two points t v or more", 4, step=2),
    "spline": Kind(lambda f, g: _points(f, g, _spline), "two points t v or more", 4, step=2),
    "periodic": Kind(_periodic, "four points t v or more of one period", 8, step=2),
    "polynomial": Kind(_polynomial, "one coefficient or more", 1),
    "sine": Kind(_sine, "mean amplitude omega and, if not 0, phase", 3, 4),
    "ramp": Kind(lambda f, g: _between(f, g, _ramp), _ENDS, 4, 4),
    "step": Kind(lambda f, g: _between(f, g, smooth_step), _ENDS, 4, 4),
    "sum": Kind(lambda f, g: _combined(f, g, sum_of), _PARTS, 1),
    "product": Kind(lambda f, g: _combined(f, g, product_of), _PARTS, 1),
}
