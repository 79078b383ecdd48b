"""Motions of a VSDF deck, cards MOTN, and the tables that they follow."""

from array import array
from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

from ...deck.many_records import DeckValues, column, places_by
from ...deck.record import Number, Record
from ...model.diagnostics import Findings, no_such
from ...model.fe_model import NodeJoint, VsdfBody
from ...model.joint_elements import JointDriver
from ...model.laws import is_angle
from ...model.time_functions import POLYNOMIAL, SINE, SPIN_UP, TABLE, Motion, MotionFunction, table_function
from ..elements_block.functions import Functions
from .joints import SLIDING, TURNING

if TYPE_CHECKING:
    import numpy as np

Tables = dict[int, MotionFunction | None]  # by their numbers, None for those with faults

# Numbers of MOTN where the coordinate, or its rate, follows a function.
BY_FUNCTION, RATE_BY_FUNCTION = 5, 6
OF_FUNCTIONS = (BY_FUNCTION, RATE_BY_FUNCTION)


def build_tables(values: DeckValues, findings: Findings) -> Tables:
    """The tables by their numbers, None for those with faults; times must ascend."""
    cards = values.section("table")
    times, ordinates = column(cards, "t"), column(cards, "f")
    tables: Tables = {}
    for number, places in places_by(cards, "table").items():
        tables[number] = _function_of(number, times[places], ordinates[places], findings, cards, places)
    return tables


def _function_of(
    number: int,
    times: "np.ndarray",
    ordinates: "np.ndarray",
    findings: Findings,
    cards: Sequence[Record],
    places: Sequence[int],
) -> MotionFunction | None:
    """The function of the table whose points are the `cards` at `places`; None, and a fault, without one."""
    first = cards[places[0]]
    if number < 1:
        message = f"tables are numbered from 1; read {first.at('table').text}"
        findings.error(f"table {number}", message, first.place, id="VSDF-054")
    if len(times) < 2:
        findings.error(f"table {number}", "a table needs two points at least", first.place, id="VSDF-055")
        return None
    late = (times[1:] <= times[:-1]).nonzero()[0]
    if late.size:
        k = late[0] + 1
        message = f"times must ascend; {times[k]:g} s follows {times[k - 1]:g} s"
        findings.error(f"table {number}", message, cards[places[k]].at("t").place, id="VSDF-056")
        return None
    # Lists of a large table would take four times its numbers.
    t = array("d", times.astype(float).tobytes())
    del times, late
    f = array("d", ordinates.astype(float).tobytes())
    del ordinates
    return table_function(t, f)


def build_motions(
    values: DeckValues,
    bodies: Sequence[VsdfBody],
    joints: Sequence[NodeJoint],
    tables: Any,
    functions: Functions,
    findings: Findings,
) -> tuple[Motion, ...]:
    """The cards MOTN."""
    records = values.section("motion")
    kinds = {joint.name: joint.kind for joint in joints} if len(records) else {}
    motions = []
    for record in records:
        if record["law"] in OF_FUNCTIONS:
            by_rate = record["law"] == RATE_BY_FUNCTION
            follow = partial(functions.integrated, start=0.0) if by_rate else functions.motion
            function = follow(record, "c0")
        else:
            function = _function(record, tables, findings)
        if _target_exists(record, len(bodies), len(values.section("joint")), kinds, findings) and function:
            motions.append(
                Motion(record.subject, record["kind"], record["object"] - 1, function, record.place)
            )
    return tuple(motions)


def motions_of(drivers: Sequence[JointDriver]) -> tuple[Motion, ...]:
    """The motions of lines DRIVE, which follow those of cards MOTN."""
    kinds = {True: "ANGL", False: "STRK"}
    return tuple(
        Motion(item.name, kinds[is_angle(item.coordinate)], item.joint, item.function, item.place)
        for item in drivers
    )


def motions_among(items: Sequence[Any]) -> tuple[Any, ...]:
    """Return joints as they are, and drivers as motions."""
    return tuple(motions_of([item])[0] if isinstance(item, JointDriver) else item for item in items)


def _target_exists(
    record: Record, bodies: int, joints: int, kinds: dict[str, str], findings: Findings
) -> bool:
    target, kind = record.at("object"), record["kind"]
    relative = kind in ("ANGL", "STRK")
    what, count = ("joint", joints) if relative else ("body", bodies)
    if not 1 <= target.value <= count:
        message = no_such(what, target.value, count)
        findings.error(record.subject, message, target.place, id="VSDF-057")
        return False
    fitting = TURNING if kind == "ANGL" else SLIDING
    target_kind = kinds.get(f"joint {target.value}")
    if relative and target_kind and target_kind not in fitting:
        what = "angle" if kind == "ANGL" else "stroke"
        message = (
            f"joint {target.value} is {target_kind} and has no {what}; {', '.join(fitting)} joints have one"
        )
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
        message = "the sine needs c2, rad/s; without it nothing moves"
        findings.error(record.subject, message, record.at("c2").place, id="VSDF-060")
        return None
    if function.value == SPIN_UP and not c1 > 0:
        message = "the spin-up time c1 must be above zero"
        findings.error(record.subject, message, record.at("c1").place, id="VSDF-061")
        return None
    return MotionFunction(function.value, (c0, c1, c2, c3))


def find_table(record: Record, number: Number, tables: Tables, findings: Findings) -> MotionFunction | None:
    """The table that a card names by `number`; None, and no further fault, for one that has faults."""
    table = tables.get(int(number.value))
    if number.value not in tables:
        message = f"there is no table {number.value:g}; cards TABL give some"
        findings.error(record.subject, message, number.place, id="VSDF-062")
    return table
