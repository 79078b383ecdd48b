"""Forces, torques, springs and output nodes of a VSDF deck."""

import math
from collections.abc import Sequence

from ...deck.many_records import DeckValues
from ...deck.record import Record
from ...model.diagnostics import Findings, no_such
from ...model.fe_model import BodyTorque, End, NodeForce, NodeJoint, VsdfBody
from ...model.joints import BY_NAME
from ...model.laws import At, Element, Line, spring
from ...model.mechanism import GROUND
from ...model.time_functions import MotionFunction
from ..elements_block.functions import Functions
from ..elements_block.line import MOST_ELEMENTS
from .bodies import end_of_body
from .joints import SLIDING, TURNING, find_end
from .motions import Tables, find_table


class Factors:
    """Factors of loads by the numbers of their tables, or of their functions."""

    def __init__(self, tables: Tables, functions: Functions, findings: Findings):
        self.tables, self.functions, self.findings = tables, functions, findings

    def of(self, record: Record) -> MotionFunction | None:
        """The factor of a load; None for 0, and where there is none."""
        number = record.at("table")
        if number.value and (isinstance(number.value, str) or number.value in self.functions):
            return self.functions.function(record, "table")
        table = find_table(record, number, self.tables, self.findings) if number.value else None
        return table and table.of_factor


def build_forces(
    values: DeckValues, bodies: Sequence[VsdfBody], ground: VsdfBody, factors: Factors, findings: Findings
) -> tuple[NodeForce, ...]:
    """The cards FORC."""
    forces = []
    for record in values.section("force"):
        end = find_end(bodies, ground, record.at("body"), record.at("node"), record.subject, findings)
        follows = _follows(record, findings)
        factor = factors.of(record)
        if end and end.body == GROUND:
            findings.error(
                record.subject, "a force on the ground moves nothing", record.at("body").place, id="VSDF-063"
            )
        elif end:
            force = record.vector("F")
            forces.append(NodeForce(record.subject, end, force, follows, factor, record.place))
    return tuple(forces)


def _follows(record: Record, findings: Findings) -> bool:
    number = record.at("follows")
    if number.value not in (0, 1):
        message = f"the last flag is 0 (global axes) or 1 (body axes); read {number.text}"
        findings.error(record.subject, message, number.place, id="VSDF-064")
    return bool(number.value == 1)


def build_torques(
    values: DeckValues, bodies: Sequence[VsdfBody], factors: Factors, findings: Findings
) -> tuple[BodyTorque, ...]:
    """The cards TORQ, on rigid bodies and nodes with rotations."""
    torques = []
    for record in values.section("torque"):
        body, node = record.at("body"), record.at("node")
        follows, factor, at = _follows(record, findings), factors.of(record), None
        if not 1 <= body.value <= len(bodies):
            message = no_such("body", body.value, len(bodies))
            findings.error(record.subject, message, body.place, id="VSDF-065")
        elif bodies[body.value - 1].rigid is None and not node.value:
            message = f"body {body.value} is FLEX: name a node with rotations, or give a pair of forces"
            findings.error(record.subject, message, body.place, id="VSDF-066")
        elif bodies[body.value - 1].rigid is not None and node.value:
            message = f"node is {node.text} and is not read: body {body.value} is RIGD; leave the field empty"
            findings.error(record.subject, message, node.place, id="VSDF-224")
        else:
            if node.value:
                at = find_end(bodies, bodies[0], body, node, record.subject, findings)
            torque = record.vector("M")
            index = end_of_body(body.value)
            torques.append(BodyTorque(record.subject, index, torque, follows, factor, record.place, at))
    return tuple(torques)


def build_springs(
    values: DeckValues, bodies: Sequence[VsdfBody], ground: VsdfBody, findings: Findings
) -> tuple[Element, ...]:
    """The cards SPRI."""
    springs = []
    for record in _bounded(values.section("spring"), findings):
        _check_not_negative(record, ("k", "c", "length"), findings)
        a, b = (
            find_end(bodies, ground, record.at(side), record.at(f"n{side}"), record.subject, findings)
            for side in "ab"
        )
        if a is None or b is None:
            continue
        if a == b:
            message = "both ends are the same node"
            findings.error(record.subject, message, record.at("nb").place, id="VSDF-067")
        elif _in_one_solid(a, b, bodies):
            what = "the ground" if a.body == GROUND else f"body {a.body + 1}, which is rigid"
            message = f"both ends are on {what}, so their distance never changes"
            findings.error(record.subject, message, record.at("b").place, id="VSDF-068")
        else:
            given = record.at("length")
            length = float(given.value) if given.text else math.nan
            ends = Line(a.body, b.body, a, b)
            springs.append(spring(record.subject, ends, record["k"], length, record["c"], record.place))
    return tuple(springs)


def _bounded(records: Sequence[Record], findings: Findings) -> Sequence[Record]:
    """Return the records, none where they are more than fit into the memory that a deck may take."""
    if len(records) <= MOST_ELEMENTS:
        return records
    last = records[MOST_ELEMENTS]
    message = f"the deck has {len(records)} springs of this card; at most {MOST_ELEMENTS} are taken"
    findings.error(last.subject, message, last.place, id="VSDF-110")
    return ()


def _in_one_solid(a: End, b: End, bodies: Sequence[VsdfBody]) -> bool:
    return a.body == b.body and (a.body == GROUND or bodies[a.body].flexible is None)


def _check_not_negative(record: Record, keys: tuple[str, ...], findings: Findings) -> None:
    for key in keys:
        if record[key] < 0:
            message = f"{key} must not be negative; read {record.at(key).text}"
            findings.error(record.subject, message, record.at(key).place, id="VSDF-069")


def build_joint_springs(
    values: DeckValues, joints: Sequence[NodeJoint], findings: Findings
) -> tuple[Element, ...]:
    """The cards JSPR."""
    springs = []
    records = _bounded(values.section("joint_spring"), findings)
    kinds = {joint.name: joint.kind for joint in joints} if len(records) else {}
    count = len(values.section("joint"))
    for record in records:
        _check_not_negative(record, ("k", "c"), findings)
        number = record.at("joint")
        if not 1 <= number.value <= count:
            message = no_such("joint", number.value, count)
            findings.error(record.subject, message, number.place, id="VSDF-070")
            continue
        kind = kinds.get(f"joint {number.value}", "revolute")
        if kind not in (*TURNING, *SLIDING):
            message = f"joint {number.value} is {kind} and has neither angle nor stroke"
            findings.error(record.subject, message, number.place, id="VSDF-071")
            continue
        where = At(number.value - 1, BY_NAME[kind].sprung)
        springs.append(spring(record.subject, where, record["k"], record["q0"], record["c"], record.place))
    return tuple(springs)


def build_outputs(
    values: DeckValues, bodies: Sequence[VsdfBody], ground: VsdfBody, findings: Findings
) -> tuple[End, ...]:
    """The cards OUTN: nodes and node sets, in the deck's order, each once."""
    ends: dict[End, None] = {}
    for record in values.section("output"):
        for number in record.numbers[1:]:
            end = find_end(bodies, ground, record.at("body"), number, record.subject, findings)
            if end:
                ends.setdefault(end)
    return tuple(ends)
