"""Cards of functions of time, for every dialect."""

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

from ...deck.record import Number, Record
from ...errors import Place
from ...model.diagnostics import Findings
from ...model.piecewise_polynomials import linear_table, polynomial, smooth_step, spline_table
from ...model.time_functions import (
    SINE,
    MotionFunction,
    integral_of,
    piecewise,
    product_of,
    smoothness,
    sum_of,
)

MOST_FUNCTIONS, LARGEST_TABLES = 20_000, 2_000_000  # of a deck
MOST_FACTORS = 1000  # of a term, and terms, of what is multiplied out
SHORTEST = 1e-50  # of the distance of two points, s: slopes of larger numbers would leave the doubles


@dataclass(frozen=True)
class GivenFunction:
    """A function as a deck gives it: its card, its number or name, what it is, and what defines it.

    `place(k)`: where the k-th value stands; `also`: its number, where it has a name, too.
    """

    record: Record
    number: Number
    kind: str  # of `KINDS`
    values: Sequence[Any]  # numbers, of sums and products names
    place: Callable[[int], Place | None]
    also: Number | None = None


class Functions:
    """The functions of a deck by their numbers or names, as texts; faults go into `findings`."""

    def __init__(self, given: Iterable[GivenFunction], findings: Findings):
        self.findings = findings
        self._functions: dict[str, MotionFunction] = {}
        self._used: set[str] = set()
        self._records: dict[str, Record] = {}
        self._values = 0
        for function in given:
            self._values += len(function.values)
            if len(self._records) >= MOST_FUNCTIONS or self._values > LARGEST_TABLES:
                message = (
                    f"a deck has at most {MOST_FUNCTIONS} functions, of {LARGEST_TABLES} numbers together"
                )
                findings.error(function.record.subject, message, function.record.place, id="ELEMENTS-025")
                break
            self._take(function)

    def _take(self, given: Any) -> None:
        record, names = given.record, []
        for number in (given.number, given.also):
            if number is None:
                continue
            name = name_of(number.value)
            if (name.lstrip("-").isdigit() and int(name) < 1) or name in self._records:
                other = self._records.get(name)
                why = f"is already {other.subject}" if other else "must be 1 or more"
                self.findings.error(
                    record.subject, f"function number {name} {why}", number.place, id="ELEMENTS-012"
                )
                return
            self._records[name] = record
            names.append(name)
        kind = KINDS[given.kind]
        if not kind.fits(len(given.values)):
            message = f"{kind.name} takes {kind.wanted}; read {len(given.values)} numbers"
            self.findings.error(record.subject, message, record.place, id="ELEMENTS-013")
            return
        function = kind.make(self, given)
        if function is not None:
            self._functions.update(dict.fromkeys(names, function))

    def __contains__(self, value: object) -> bool:
        """Return whether a name or number is that of a function."""
        return name_of(value) in self._records

    def function(self, record: Record, key: str = "function") -> MotionFunction | None:
        """The function that `key` of a record names; None for 0, and where there is none."""
        number = record.at(key)
        if number.value == 0 and key != "function":
            return None
        name = name_of(number.value)
        if name not in self._records:
            known = listed(self._records) or "none"
            message = f"there is no function {name}; the deck has {known}; define it, or name another"
            self.findings.error(record.subject, message, number.place, id="ELEMENTS-014")
        else:
            self._used.add(self._records[name].subject)
        return self._functions.get(name)

    def motion(
        self, record: Record, start: float, given: float = 0.0, key: str = "function"
    ) -> MotionFunction | None:
        """The function that a driver's coordinate follows: the function, or its integral from `given` on."""
        by_rate = record.at("rate") if "rate" in record else None
        if by_rate is not None and by_rate.value not in (0, 1):
            message = f"rate must be 0 (the coordinate) or 1 (its rate); read {by_rate.value}"
            self.findings.error(record.subject, message, by_rate.place, id="ELEMENTS-015")
            return None
        if by_rate is not None and by_rate.value == 1:
            return self.integrated(record, start, given, key)
        function = self.function(record, key)
        if function is not None:
            self._refuse_rough(record, function, 1, "the rate of a coordinate cannot jump", key)
        return function

    def integrated(
        self, record: Record, start: float, given: float = 0.0, key: str = "function"
    ) -> MotionFunction | None:
        """The integral of the function from `given` at the time `start` on."""
        function = self.function(record, key)
        if function is None:
            return None
        self._refuse_rough(record, function, 0, "a rate cannot jump", key)
        found = integral_of(function, start)
        if found is None:
            message = "flexmb has no integral of a product; give the coordinate itself (rate 0)"
            self.findings.error(record.subject, message, record.at(key).place, id="ELEMENTS-016")
            return None
        return sum_of([found, piecewise(polynomial([given]))]) if given else found

    def curve(self, record: Record, key: str) -> MotionFunction | None:
        """The characteristic of a spring or damper over its stretch or rate, which must have an integral."""
        function = self.function(record, key)
        if function is not None and integral_of(function) is None:
            message = "a product is no characteristic of a spring; use TABLE, SPLINE or POLYNOMIAL"
            self.findings.error(record.subject, message, record.at(key).place, id="ELEMENTS-017")
            return None
        return function

    def _refuse_rough(self, record: Record, function: MotionFunction, least: int, why: str, key: str) -> None:
        if smoothness(function) < least:
            remedy = "use SPLINE or STEP" if least else "move its points apart"
            message = f"{why}, but that of function {name_of(record[key])} does; {remedy}"
            self.findings.error(record.subject, message, record.at(key).place, id="ELEMENTS-018")

    def note_unused(self) -> None:
        """Note functions that nothing follows; what is refused might have."""
        if any(fault.severity == "error" for fault in self.findings.faults):
            return
        for name, record in self._records.items():
            if record.subject not in self._used:
                self._used.add(record.subject)
                self.findings.note(
                    record.subject, f"nothing uses function {name}", record.place, id="ELEMENTS-019"
                )


def name_of(value: Any) -> str:
    """Return the name of a function, which may be a number."""
    return value if isinstance(value, str) else f"{value:g}"


def listed(names: Iterable[str]) -> str:
    """Return names in their order, numbers by their size."""
    return ", ".join(sorted(names, key=lambda name: (not name.isdigit(), name.zfill(9))))


def _points(functions: Functions, given: GivenFunction, make: Callable[..., Any]) -> MotionFunction | None:
    times, found = given.values[0::2], given.values[1::2]
    for k, (before, after) in enumerate(pairwise(times), 1):
        if not before < after:
            message = (
                f"times must rise; {after:g} follows {before:g} (for a jump take two times a little apart)"
            )
            functions.findings.error(given.record.subject, message, given.place(2 * k), id="ELEMENTS-020")
            return None
        if after - before < SHORTEST:
            message = f"{after:g} follows {before:g} by less than {SHORTEST:g}, too short to compute with"
            functions.findings.error(given.record.subject, message, given.place(2 * k), id="ELEMENTS-026")
            return None
    return piecewise(make(times, found))


def _polynomial(_functions: Functions, given: GivenFunction) -> Any:
    return piecewise(polynomial(given.values))


def _sine(_functions: Functions, given: GivenFunction) -> MotionFunction:
    mean, size, omega, phase = (float(value) for value in (*given.values, 0.0)[:4])
    return MotionFunction(SINE, (mean, size, omega, phase))


def _between(functions: Functions, given: GivenFunction, make: Callable[..., Any]) -> Any:
    ends = [float(value) for value in given.values]
    if not ends[0] + SHORTEST < ends[2]:
        message = f"the end {ends[2]:g} s must be later than the start {ends[0]:g} s"
        functions.findings.error(given.record.subject, message, given.place(2), id="ELEMENTS-021")
        return None
    return piecewise(make(*ends))


def _ramp(t0: float, v0: float, t1: float, v1: float) -> Any:
    return linear_table((t0, t1), (v0, v1))


def _combined(known: Any, given: GivenFunction, combine: Callable[..., Any]) -> Any:
    parts = []
    own = {name_of(number.value) for number in (given.number, given.also) if number}
    for k, value in enumerate(map(name_of, given.values)):
        part = known._functions.get(value)
        if value in known._records:
            known._used.add(known._records[value].subject)
        if (part is None and value not in known._records) or value in own:
            message = f"function {value} must be given in a card above"
            known.findings.error(given.record.subject, message, given.place(k), id="ELEMENTS-022")
        parts.append(part)
    if None in parts:
        return None
    # Before they are multiplied out: forty cards that square the one above have 2^40 factors.
    terms, factors = _multiplied_out(parts, combine)
    if max(terms, factors) > MOST_FACTORS:
        many = f"multiplied out it has {terms} terms of {factors} factors, more than {MOST_FACTORS}"
        message = f"{many}; use fewer {'sums' if terms > factors else 'products'}"
        known.findings.error(given.record.subject, message, given.record.place, id="ELEMENTS-023")
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
    """A type of function: its name, what makes it, and how many numbers define it.

    `least` numbers or more, by `step`, up to `most` (0: any).
    """

    name: str
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
    "table": Kind("TABLE", lambda f, g: _points(f, g, linear_table), "two points t v or more", 4, step=2),
    "spline": Kind("SPLINE", lambda f, g: _points(f, g, spline_table), "two points t v or more", 4, step=2),
    "polynomial": Kind("POLYNOMIAL", _polynomial, "one coefficient or more", 1),
    "sine": Kind("SINE", _sine, "mean amplitude omega and, if not 0, phase", 3, 4),
    "ramp": Kind("RAMP", lambda f, g: _between(f, g, _ramp), _ENDS, 4, 4),
    "step": Kind("STEP", lambda f, g: _between(f, g, smooth_step), _ENDS, 4, 4),
    "sum": Kind("SUM", lambda f, g: _combined(f, g, sum_of), _PARTS, 1),
    "product": Kind("PRODUCT", lambda f, g: _combined(f, g, product_of), _PARTS, 1),
}
