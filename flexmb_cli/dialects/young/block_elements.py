"""Blocks ELEMENTS of a YOUNG deck: drivers, supports, composite joints and force elements."""

from collections.abc import Sequence
from typing import Any

from ...model.diagnostics import Findings, no_such
from ...model.joint_elements import CompositeJoint, DrivenItem, JointElements
from ...model.mechanism import Mechanism
from ..elements_block.build import BlockBuilder
from ..elements_block.functions import Functions
from ..elements_block.line import ElementLine
from ..elements_block.measures import JointMeasures
from ..elements_block.words import LINKS

_TYPES = {"revcyl": "revolute-cylindrical", "revsph": "revolute-spherical", "sphsph": "spherical-spherical"}
# The other end of a link needs a direction that no equation uses.
_ANY = (1.0, 0.0, 0.0)


def block_elements(
    lines: Sequence[ElementLine], mechanism: Mechanism, functions: Functions, findings: Findings
) -> JointElements:
    """The elements of the blocks; faults go into `findings`."""
    builder = BlockBuilder(_Measures(mechanism, findings), functions, mechanism.time.start)
    return builder.elements(lines, {"DRIVE": _drive, "SUPPORT": _support, "JOINT": _composite})


class _Measures(JointMeasures):
    """Joints of the mechanism, and ends at points of its bodies."""

    def __init__(self, mechanism: Mechanism, findings: Findings):
        super().__init__(mechanism.joints, findings)
        self.mechanism = mechanism

    def ends(self, line: ElementLine) -> tuple[int, int, Any, Any] | None:
        """Bodies (-1: ground) and points in their axes."""
        bodies = [self.body(line, key, len(self.mechanism.bodies)) for key in ("from", "to")]
        for key in ("from", "to"):
            if f"{key}.node" in line:
                message = "bodies have no nodes here; give the point in body axes, body(x,y,z)"
                self.error(line, line.at(f"{key}.node"), message, id="YOUNG-181")
                return None
        i, j = bodies
        if i is None or j is None or not self.two_bodies(line, i, j):
            return None
        return i, j, line.vector("from"), line.vector("to")


def _drive(builder: BlockBuilder, line: ElementLine) -> tuple[str, Any]:
    if "driver" not in line:
        return "drivers", builder.driver(line)
    measures: Any = builder.measures
    drivers, number = measures.mechanism.drivers, line.at("driver")
    if not 1 <= number.value <= len(drivers):
        measures.error(line, number, no_such("driver", number.value, len(drivers)), id="YOUNG-121")
        return "driven", None
    function = builder.motion(line, drivers[number.value - 1].C)
    return "driven", function and DrivenItem(line.subject, number.value - 1, function, line.place)


def _support(builder: BlockBuilder, line: ElementLine) -> tuple[str, Any]:
    measures: Any = builder.measures
    if "simplified" not in line:
        message = "YOUNG decks have no pins; name a simplified constraint by simplified="
        measures.error(line, line.at("pin"), message, id="YOUNG-182")
        return "supports", None
    held, number = measures.mechanism.simplified, line.at("simplified")
    if not 1 <= number.value <= len(held):
        message = "simplified constraint"
        measures.error(line, number, no_such(message, number.value, len(held)), id="YOUNG-122")
        return "supports", None
    if held[number.value - 1].direction > 3:
        message = (
            f"simplified constraint {number.value} holds an angle; x, y, z (directions 1 to 3) can be moved"
        )
        measures.error(line, number, message, id="YOUNG-123")
        return "supports", None
    function = builder.motion(line)
    return "supports", function and DrivenItem(line.subject, number.value - 1, function, line.place)


def _composite(builder: BlockBuilder, line: ElementLine) -> tuple[str, Any]:
    measures, keys = builder.measures, LINKS[line.kind]
    given = {key: key if key == "length" else f"{key}.x" for key in ("axis_from", "axis_to", "length")}
    wrong = [key for key, first in given.items() if (first in line) != (key in keys)]
    if wrong:
        message = (
            f"{line.kind} takes {' and '.join(f'{key}=' for key in keys)}, and no other of {', '.join(given)}"
        )
        builder.findings.error(line.subject, message, line.place, id="YOUNG-183")
        return "composites", None
    axes = {key: line.vector(key) for key in keys if key != "length"}
    for key, s in axes.items():
        if not any(s):
            measures.error(line, line.at(f"{key}.x"), f"{key} has no length", id="YOUNG-130")
            return "composites", None
    size = float(line["length"]) if "length" in line else 0.0
    if "length" in line and not size > 0.0:
        message = f"the link's length must be above 0; read {size:g}"
        measures.error(line, line.at("length"), message, id="YOUNG-131")
    ends = measures.ends(line)
    if ends is None:
        return "composites", None
    s_i, s_j = axes.get("axis_from", _ANY), axes.get("axis_to", _ANY)
    return "composites", CompositeJoint(
        line.subject, _TYPES[line.kind], *ends, s_i=s_i, s_j=s_j, size=size, place=line.place
    )
