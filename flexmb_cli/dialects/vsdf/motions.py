"""Motions of a VSDF deck, cards MOTN, and the tables that they follow."""

from array import array
from itertools import pairwise
from typing import Any

from ...deck.record import Number, Record
from ...deck.records import DeckValues
from ...errors import Place
from ...model.diagnostics import Findings
from ...model.fe_model import NodeJoint, VsdfBody
from ...model.time_functions import POLYNOMIAL, SINE, SPIN_UP, TABLE, Motion, MotionFunction, table_function
from ...quick_dataclass import dataclass, field
from ..elements.functions import Functions
from .joints import SLIDING, TURNING

Tables = dict[int, MotionFunction | None]  # by their numbers, None for those with faults

# Numbers of MOTN where the coordinate, or its rate, follows a function.
BY_FUNCTION, RATE_BY_FUNCTION = 5, 6
OF_FUNCTIONS = (BY_FUNCTION, RATE_BY_FUNCTION)


@dataclass
class _Table:
    """The points of one table so far; `first`: the place of its first card; `late`: a time out of order."""

    first: int
    times: "array[float]" = field(default_factory=lambda: array("d"))
    values: "array[float]" = field(default_factory=lambda: array("d"))
    late: tuple[float, Place | None] | None = None

    def add(self, record: Record) -> None:
        """Take the point of a card."""
        if self.times and self.late is None and not record["t"] > self.times[-1]:
            self.late = self.times[-1], record.at("t").place
        self.times.append(record["t"])
        self.values.append(record["f"])


def build_tables(values: DeckValues, findings: Findings) -> Tables:
    """The tables by their numbers, None for those with faults; times must ascend."""
    points: dict[int, _Table] = {}
    cards = values.section("table")
    for index, record in enumerate(cards):
        points.setdefault(record["table"], _Table(index)).add(record)
    return {
        number: _function_of(number, table, cards[table.first], findings) for number, table in points.items()
    }


def _function_of(number: int, table: _Table, first: Record, findings: Findings) -> MotionFunction | None:
    """The function of a table whose first card is `first`."""
    if number < 1:
        message = f"tables are numbered from 1; read {first.at('table').text}"
        findings.error(f"table {number}", message, first.place, id="VSDF-054")
    if len(table.times) < 2:
        findings.error(f"table {number}", "a table needs two points at least", first.place, id="VSDF-055")
        return None
    if table.late is not None:
        before, place = table.late
        message = f"times must ascend; {_late_time(table):g} s follows {before:g} s"
        findings.error(f"table {number}", message, place, id="VSDF-056")
        return None
    return table_function(table.times, table.values)


def _late_time(table: _Table) -> float:
    return next(after for before, after in pairwise(table.times) if not after > before)


def build_motions(
    values: DeckValues,
    bodies: tuple[VsdfBody, ...],
    joints: tuple[NodeJoint, ...],
    tables: Any,
    functions: Functions,
    findings: Findings,
) -> tuple[Motion, ...]:
    """The cards MOTN."""
    kinds = {joint.name: joint.kind for joint in joints}
    motions = []
    for record in values.section("motion"):
        if record["law"] in OF_FUNCTIONS:
            follow = functions.motion if record["law"] == BY_FUNCTION else functions.integrated
            function = follow(record, 0.0, key="c0")
        else:
            function = _function(record, tables, findings)
        if _target_exists(record, len(bodies), len(values.section("joint")), kinds, findings) and function:
            motions.append(
                Motion(record.subject, record["kind"], record["object"] - 1, function, record.place)
            )
    return tuple(motions)


def _target_exists(
    record: Record, bodies: int, joints: int, kinds: dict[str, str], findings: Findings
) -> bool:
    target, kind = record.at("object"), record["kind"]
    relative = kind in ("ANGL", "STRK")
    what, count = ("joint", joints) if relative else ("body", bodies)
    if not 1 <= target.value <= count:
        message = f"{what} number {target.value} is outside 1..{count}"
        findings.error(record.subject, message, target.place, id="VSDF-057")
        return False
    fitting = TURNING if kind == "ANGL" else SLIDING
    found = kinds.get(f"joint {target.value}")
    if relative and found and found not in fitting:
        what = "angle" if kind == "ANGL" else "stroke"
        message = f"joint {target.value} is {found} and has no {what}; {', '.join(fitting)} joints have one"
        findings.error(record.subject, message, target.place, id="VSDF-058")
        return False
    return True


def _function(record: Record, tables: Any, findings: Findings) -> MotionFunction | None:
    function = record.at("law")
    c0, c1, c2, c3 = (float(record[f"c{i}"]) for i in range(4))
    if not POLYNOMIAL <= function.value <= TABLE:
        message = (
            f"law {function.value} is outside 1..6 (1 polynomial, 2 spin-up, 3 sine, 4 table, 5 function, "
            "6 rate by function)"
        )
        findings.error(record.subject, message, function.place, id="VSDF-059")
        return None
    if function.value == TABLE:
        return find_table(record, record.at("c0"), tables, findings)
    if function.value == SINE and not record.at("c2").text:
        message = "the sine needs c2, rad/s; it stands still without"
        findings.error(record.subject, message, record.at("c2").place, id="VSDF-060")
        return None
    if function.value == SPIN_UP and not c1 > 0:
        message = "the spin-up time c1 must be above zero"
        findings.error(record.subject, message, record.at("c1").place, id="VSDF-061")
        return None
    return MotionFunction(function.value, (c0, c1, c2, c3))


def find_table(record: Record, number: Number, tables: Tables, findings: Findings) -> MotionFunction | None:
    """The table that a card names by `number`; None, and no further fault, for one that has faults."""
    found = tables.get(int(number.value))
    if number.value not in tables:
        message = f"there is no table {number.value:g}; cards TABL give some"
        findings.error(record.subject, message, number.place, id="VSDF-062")
    return found
