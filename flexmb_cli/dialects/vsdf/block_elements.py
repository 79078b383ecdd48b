"""Blocks ELEMENTS of a VSDF deck: elements at joints and between nodes, and pins that move."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from ...deck.record import Number
from ...model.diagnostics import Findings
from ...model.fe_model import End, Pin, VsdfBody
from ...model.joint_elements import JointElements
from ...model.mechanism import GROUND
from ..elements_block.build import BlockBuilder
from ..elements_block.functions import Functions
from ..elements_block.line import ElementLine
from ..elements_block.measures import JointMeasures
from .joints import find_end

RUN_START = 0.0  # s, of every run
_TURNS = ("kr", "cr")  # parameters of bushings for nodes that turn


def block_elements(
    lines: Sequence[ElementLine], parts: tuple[Any, VsdfBody, Any], functions: Functions, findings: Findings
) -> JointElements:
    """The elements of the blocks; `parts`: bodies, ground and joints; faults go into `findings`."""
    builder = BlockBuilder(_Measures(*parts, findings), functions, RUN_START)
    return builder.elements(lines, {"SUPPORT": lambda _builder, _line: None})


class _Measures(JointMeasures):
    """Joints of the deck, and ends at nodes of its bodies."""

    def __init__(
        self, bodies: Sequence[VsdfBody], ground: VsdfBody, joints: Sequence[Any], findings: Findings
    ):
        super().__init__(joints, findings)
        self.bodies, self.ground = bodies, ground

    def ends(self, line: ElementLine) -> tuple[int, int, Any, Any] | None:
        """Bodies (-1: ground) and nodes."""
        a, b = (self._end(line, key) for key in ("from", "to"))
        if a is None or b is None:
            return None
        if a.body == b.body and (a.body == GROUND or self.bodies[a.body].flexible is None):
            what = "the ground" if a.body == GROUND else f"body {a.body + 1}, which is rigid"
            message = f"both ends are on {what}, so nothing changes between them"
            self.error(line, line.at("to.body"), message, id="VSDF-103")
            return None
        if line.word == "BUSHING":
            self._refuse_rotations(line, a, b)
        return a.body, b.body, a, b

    def _end(self, line: ElementLine, key: str) -> End | None:
        body = line.at(f"{key}.body")
        if f"{key}.node" in line:
            return find_end(
                self.bodies, self.ground, body, line.at(f"{key}.node"), line.subject, self.findings
            )
        if body.value == 0:
            return End(GROUND, 0, line.vector(key))
        message = f"points of bodies are their nodes; write {body.value}:node, cards NODE give some"
        self.error(line, body, message, id="VSDF-217")
        return None

    def _refuse_rotations(self, line: ElementLine, a: End, b: End) -> None:
        """Nodes of a flexible body have no attitude."""
        flexible = [e.body for e in (a, b) if e.body != GROUND and self.bodies[e.body].flexible is not None]
        turning = [f"{key}.{axis}" for key in _TURNS for axis in "xyz" if line[f"{key}.{axis}"]]
        if flexible and turning:
            message = (
                f"body {flexible[0] + 1} is FLEX, its nodes do not turn; leave kr and cr out, and give "
                "several bushings at nodes apart"
            )
            self.error(line, line.at(turning[0]), message, id="VSDF-104")


def moved_pins(
    lines: Sequence[ElementLine], pins: tuple[Pin, ...], count: int, functions: Functions, findings: Findings
) -> tuple[Pin, ...]:
    """The pins, some of which lines SUPPORT move; `count`: pins of the deck, some of which may be faulty."""
    found, seen = list(pins), dict[int, str]()
    for line in lines:
        if line.word == "SUPPORT" and (number := _pin_of(line, count, seen, findings)):
            if len(found) == count:
                k = number.value - 1
                found[k] = replace(found[k], functions=_functions(line, found[k], functions, findings))
            seen.setdefault(number.value, line.subject)
    return tuple(found)


def _pin_of(line: ElementLine, count: int, seen: dict[int, str], findings: Findings) -> Number | None:
    """The number of the pin that a line moves; None where a fault is found."""
    if "pin" not in line:
        message = "VSDF decks have no simplified constraints; name a pin by pin="
        findings.error(line.subject, message, line.at("simplified").place, id="VSDF-216")
        return None
    number = line.at("pin")
    if not 1 <= number.value <= count:
        message = f"pin number {number.value} is outside 1..{count}"
        message = message if count else "there are no pins; a card PINN holds a node, which SUPPORT can move"
        findings.error(line.subject, message, number.place, id="VSDF-215")
    elif number.value in seen:
        message = f"{seen[number.value]} already moves this pin; remove one of them"
        findings.error(line.subject, message, number.place, id="VSDF-106")
    else:
        return number
    return None


def _functions(line: ElementLine, pin: Pin, functions: Functions, findings: Findings) -> tuple[Any, ...]:
    for held, axis in zip(pin.directions, "xyz", strict=True):
        if axis in line and not held:
            message = (
                f"{pin.name} does not hold {axis}; add it to the mask of PINN, or leave the function out"
            )
            findings.error(line.subject, message, line.at(axis).place, id="VSDF-107")
    return tuple(functions.motion(line, axis) if axis in line else None for axis in "xyz")
