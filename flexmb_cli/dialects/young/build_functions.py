"""The function cards of a YOUNG deck to functions of time."""

from collections.abc import Callable
from itertools import pairwise

from ...deck.record import Deck, Record
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
from .element_cards import FUNCTION_CARDS

_SECTIONS = tuple(card.section for card in FUNCTION_CARDS)
MOST_FACTORS = 1000  # of a product that is multiplied out


class Functions:
    """The functions of a deck by their numbers; faults go into `findings`."""

    def __init__(self, deck: Deck, findings: Findings):
        self.findings = findings
        self._built: dict[int, MotionFunction] = {}
        self._used: set[int] = set()
        self._records: dict[int, Record] = {}
        for record in deck.records:
            if record.section in _SECTIONS:
                self._take(record)

    def _take(self, record):
        number = record.at("number")
        if number.value < 1 or number.value in self._records:
            other = self._records.get(number.value)
            why = f"is already {other.subject}" if other else "must be 1 or more"
            self.findings.error(
                record.subject, f"function number {number.value} {why}", number.place, id="YOUNG-105"
            )
            return
        self._records[number.value] = record
        function = _MAKERS[record.section](self, record)
        if function is not None:
            self._built[number.value] = function

    def function(self, record: Record, key: str = "function") -> MotionFunction | None:
        """The function that the number `key` of a record names; None for 0, and where there is none."""
        number = record.at(key)
        if number.value == 0 and key != "function":
            return None
        self._used.add(number.value)
        if number.value not in self._records:
            known = ", ".join(map(str, sorted(self._records))) or "none"
            message = f"there is no function {number.value}; the deck has {known}"
            self.findings.error(record.subject, message, number.place, id="YOUNG-106")
        return self._built.get(number.value)

    def motion(self, record: Record, start: float, given: float = 0.0) -> MotionFunction | None:
        """The function that a driver's coordinate follows: the function, or its integral from `given` on."""
        function, by_rate = self.function(record), record.at("rate") if "rate" in record else None
        if function is None:
            return None
        if by_rate is not None and by_rate.value not in (0, 1):
            message = f"rate must be 0 (the coordinate) or 1 (its rate); read {by_rate.value}"
            self.findings.error(record.subject, message, by_rate.place, id="YOUNG-107")
            return None
        if by_rate is None or by_rate.value == 0:
            self._refuse_rough(record, function, 1, "the rate of a coordinate cannot jump")
            return function
        self._refuse_rough(record, function, 0, "a rate cannot jump")
        found = integral_of(function, start)
        if found is None:
            message = "flexmb has no integral of a product; give the coordinate itself (rate 0)"
            self.findings.error(record.subject, message, record.at("function").place, id="YOUNG-108")
            return None
        return sum_of([found, piecewise(polynomial([given]))]) if given else found

    def curve(self, record: Record, key: str) -> MotionFunction | None:
        """The function of a spring or damper over its stretch or rate, which must have an integral."""
        function = self.function(record, key)
        if function is not None and integral_of(function) is None:
            message = "a product is no characteristic of a spring; use TABLE, SPLINE or POLYNOMIAL"
            self.findings.error(record.subject, message, record.at(key).place, id="YOUNG-109")
            return None
        return function

    def _refuse_rough(self, record, function, least, why):
        if smoothness(function) < least:
            remedy = "use SPLINE or STEP" if least else "move its points apart"
            message = f"{why}, but that of function {record['function']} does; {remedy}"
            self.findings.error(record.subject, message, record.at("function").place, id="YOUNG-110")

    def note_unused(self) -> None:
        """Note functions that nothing follows."""
        for number, record in self._records.items():
            if number not in self._used:
                self.findings.note(
                    record.subject, f"nothing uses function {number}", record.place, id="YOUNG-111"
                )


def _points(functions, record, make: Callable) -> MotionFunction | None:
    values = record.values[1:]
    times, found = values[0::2], values[1::2]
    for k, (before, after) in enumerate(pairwise(times), 2):
        if not before < after:
            message = (
                f"times must rise; {after:g} follows {before:g} (for a jump take two times a little apart)"
            )
            functions.findings.error(record.subject, message, record.at(f"t{k}").place, id="YOUNG-112")
            return None
    return piecewise(make(times, found))


def _polynomial(_functions, record):
    return piecewise(polynomial(record.values[1:]))


def _sine(_functions, record):
    keys = ("mean", "amplitude", "omega", "phase")
    return MotionFunction(SINE, tuple(float(record[key]) for key in keys))


def _between(functions, record, make):
    ends = [float(record[key]) for key in ("start", "from", "end", "to")]
    if not ends[0] < ends[2]:
        message = f"the end {ends[2]:g} s must be later than the start {ends[0]:g} s"
        functions.findings.error(record.subject, message, record.at("end").place, id="YOUNG-113")
        return None
    return piecewise(make(*ends))


def _ramp(t0, v0, t1, v1):
    return linear_table((t0, t1), (v0, v1))


def _combined(functions, record, combine):
    parts = []
    for number in record.numbers[1:]:
        functions._used.add(number.value)
        function = functions._built.get(number.value)
        if (function is None and number.value not in functions._records) or number.value == record["number"]:
            message = f"function {number.value} must be given in a card above"
            functions.findings.error(record.subject, message, number.place, id="YOUNG-114")
        parts.append(function)
    if None in parts:
        return None
    found = combine(parts)
    if len(found.terms) > MOST_FACTORS:
        many = f"multiplied out it has {len(found.terms)} terms, more than {MOST_FACTORS}; use fewer sums"
        functions.findings.error(record.subject, many, record.place, id="YOUNG-115")
        return None
    return found


_MAKERS = {
    "table": lambda functions, record: _points(functions, record, linear_table),
    "spline": lambda functions, record: _points(functions, record, spline_table),
    "polynomial": _polynomial,
    "sine": _sine,
    "ramp": lambda functions, record: _between(functions, record, _ramp),
    "step": lambda functions, record: _between(functions, record, smooth_step),
    "sum": lambda functions, record: _combined(functions, record, sum_of),
    "product": lambda functions, record: _combined(functions, record, product_of),
}
