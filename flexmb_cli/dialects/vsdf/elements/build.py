"""Functions of time, and elements at joints and between nodes, of a VSDF deck."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ....deck.record import Record
from ....deck.records import DeckValues
from ....model.diagnostics import Findings
from ....model.fe_model import NodeJoint, Pin, VsdfBody
from ....model.joint_elements import JointElements
from ....model.mechanism import GROUND
from ...elements_block.build import joined
from ...elements_block.function_lines import given_functions
from ...joint_elements.build import JOINT_CARDS, sections_of
from ...joint_elements.build import build_elements as elements_of
from ...joint_elements.functions import Functions, GivenFunction
from ...joint_elements.maker import JointMaker
from ..block_elements import RUN_START, block_elements
from ..block_elements import moved_pins as pins_of_blocks
from ..joints import find_end
from .cards import FUNCTION_KINDS, OF_TABLES

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ....deck.record import Number
    from ....model.fe_model import End
    from ....model.time_functions import MotionFunction


def build_functions(
    values: DeckValues, tables: dict[int, Any], lines: Sequence[Any], folder: Path, findings: Findings
) -> Functions:
    """The functions of the cards FUNC and of blocks; `tables`: functions of the tables by their numbers."""
    given = [*_given(values, tables, findings), *given_functions(lines, folder, findings, tables)]
    return Functions(given, findings)


def _given(
    values: DeckValues, tables: "Mapping[int, MotionFunction]", findings: Findings
) -> Iterator[GivenFunction]:
    for record in values.section("function"):
        number, numbers = record.at("number"), record.numbers[2:]
        if number.value in tables:
            message = f"{number.value} is a table; functions and tables have numbers of their own"
            findings.error(record.subject, message, number.place, id="VSDF-100")
        found = [item.value for item in numbers]
        if record["kind"] in OF_TABLES:
            found = _points(record, numbers, tables, findings)
        if found is not None:
            yield GivenFunction(record, number, FUNCTION_KINDS[record["kind"]], found, _places(numbers))


def _places(numbers: "tuple[Number, ...]") -> Any:
    return lambda k: numbers[min(k, len(numbers) - 1)].place


def _points(
    record: Record, numbers: "tuple[Number, ...]", tables: "Mapping[int, MotionFunction]", findings: Findings
) -> Any:
    """Times and values that a function goes through, one after the other, on its card or of a table."""
    if len(numbers) > 1:
        return [item.value for item in numbers]
    if numbers[0].value not in tables:
        message = f"{record['kind']} wants the number of a table; cards TABL give some"
        findings.error(record.subject, message, numbers[0].place, id="VSDF-101")
        return None
    function = tables[numbers[0].value]  # None: it has a fault of its own
    return function and [x for point in zip(function.times, function.values, strict=True) for x in point]


def build_elements(
    values: DeckValues,
    bodies: Sequence[VsdfBody],
    ground: VsdfBody,
    joints: Sequence[NodeJoint],
    lines: Sequence[Any],
    functions: Functions,
    findings: Findings,
) -> JointElements:
    """All elements of the deck; faults go into `findings`."""
    maker = _Maker(bodies, ground, joints, functions, findings)
    outputs = values.section("joint_output")
    for output in outputs:
        if output["on"] in (0, 1):
            continue
        message = f"on is 0 or 1; read {output.at('on').text}"
        findings.error(output.subject, message, output.at("on").place, id="VSDF-102")
    reported = any(output["on"] == 1 for output in outputs)
    older = elements_of(maker, sections_of(values), JOINT_CARDS, reported=reported)
    return joined(older, block_elements(lines, (bodies, ground, joints), functions, findings))


class _Maker(JointMaker):
    """Makes elements of records; None where a fault was found."""

    def __init__(self, bodies: Any, ground: VsdfBody, joints: Any, functions: Functions, findings: Findings):
        super().__init__(joints, functions, findings, RUN_START)
        self.bodies, self.ground = bodies, ground

    def ends(self, record: Record) -> dict[Any, Any] | None:
        """Bodies (-1: ground) and nodes of an element between two bodies."""
        a, b = (
            find_end(
                self.bodies,
                self.ground,
                record.at(side),
                record.at(f"n{side}"),
                record.subject,
                self.findings,
            )
            for side in "ab"
        )
        if a is None or b is None:
            return None
        if a.body == b.body and (a.body == GROUND or self.bodies[a.body].flexible is None):
            what = "the ground" if a.body == GROUND else f"body {a.body + 1}, which is rigid"
            message = f"both ends are on {what}, so nothing changes between them"
            self.findings.error(record.subject, message, record.at("b").place, id="VSDF-103")
            return None
        if record.section == "bushing":
            self._refuse_rotations(record, a, b)
        return {"i": a.body, "j": b.body, "P_i": a, "P_j": b}

    def _refuse_rotations(self, record: Record, a: "End", b: "End") -> None:
        """Nodes of a flexible body have no attitude."""
        flexible = [e.body for e in (a, b) if e.body != GROUND and self.bodies[e.body].flexible is not None]
        turning = [
            record.at(f"{key}.{axis}") for key in ("kr", "cr") for axis in "xyz" if record[f"{key}.{axis}"]
        ]
        if flexible and turning:
            message = (
                f"body {flexible[0] + 1} is FLEX, its nodes do not turn; leave kr and cr out, and give "
                "several bushings at nodes apart"
            )
            self.findings.error(record.subject, message, turning[0].place, id="VSDF-104")


def moved_pins(
    values: DeckValues, pins: tuple[Pin, ...], lines: Sequence[Any], functions: Functions, findings: Findings
) -> tuple[Pin, ...]:
    """The pins, some of which the cards SUPP and lines SUPPORT move."""
    found = list(pins_of_blocks(lines, pins, len(values.section("pin")), functions, findings))
    seen: dict[int, str] = {}
    for record in values.section("support"):
        number = record.at("pin")
        if not 1 <= number.value <= len(values.section("pin")):
            count = len(values.section("pin"))
            message = f"pin number {number.value} is outside 1..{count}"
            message = message if count else "there are no pins; a card PINN holds a node, which SUPP can move"
            findings.error(record.subject, message, number.place, id="VSDF-105")
        elif number.value in seen:
            message = f"{seen[number.value]} already moves this pin; remove one of them"
            findings.error(record.subject, message, number.place, id="VSDF-106")
        elif len(found) == len(values.section("pin")):
            k = number.value - 1
            found[k] = replace(found[k], functions=_functions(record, found[k], functions, findings))
        seen.setdefault(number.value, record.subject)
    return tuple(found)


def _functions(record: Record, pin: Pin, functions: Functions, findings: Findings) -> tuple[Any, ...]:
    for held, axis in zip(pin.directions, "xyz", strict=True):
        number = record.at(f"function.{axis}")
        if number.value and not held:
            message = (
                f"{pin.name} does not hold {axis}; add it to the mask of PINN, or leave the function out"
            )
            findings.error(record.subject, message, number.place, id="VSDF-107")
    return tuple(functions.motion(record, RUN_START, key=f"function.{axis}") for axis in "xyz")
