"""The cards OUTS: at which nodes and elements of a body stresses are reported."""

from collections.abc import Sequence
from typing import Any

from ...deck.many_records import DeckValues
from ...deck.record import Record
from ...errors import Place
from ...model.diagnostics import Findings, no_such
from ...model.fe_model import StressSelection, VsdfBody


def build_stresses(
    values: DeckValues, bodies: Sequence[VsdfBody], findings: Findings
) -> tuple[StressSelection, ...]:
    """Return one selection a body that has cards, nodes and elements each once in the deck's order."""
    records = [record for record in values.section("stress_output") if _usable(record, bodies, findings)]
    chosen = sorted({record["body"] for record in records})
    return tuple(
        _selection(k, bodies[k - 1], [record for record in records if record["body"] == k], findings)
        for k in chosen
    )


def _usable(record: Record, bodies: Sequence[VsdfBody], findings: Findings) -> bool:
    """Return whether the body exists and has a material; else a fault."""
    number = record.at("body")
    if not 1 <= number.value <= len(bodies):
        message = no_such("body", number.value, len(bodies))
        findings.error(record.subject, message, number.place, id="VSDF-089")
        return False
    body = bodies[number.value - 1]
    if body.rigid is not None:
        findings.error(
            record.subject, f"{body.name} is RIGD and has no stresses", number.place, id="VSDF-090"
        )
        return False
    if body.flexible is not None and body.flexible.material is None:
        message = f"stresses of {body.name} need its material; give E and nu on a card MATL"
        findings.error(record.subject, message, number.place, id="VSDF-091")
        return False
    return body.flexible is not None


def _selection(k: int, body: VsdfBody, records: list[Record], findings: Findings) -> StressSelection:
    nodes: dict[int, None] = {}
    elements: dict[int, Place | None] = {}
    every = False
    for record in records:
        numbers = record.numbers[2:]
        if record["what"] == "NODE":
            nodes |= dict.fromkeys(_nodes(record, numbers, body, findings))
        elif record["what"] == "ELEM":
            elements |= {one.value: one.place for one in numbers if one.value not in elements}
            every = every or not numbers
        elif numbers:
            message = f"MAX is of all nodes; read {numbers[0].text}: leave the field empty"
            findings.error(record.subject, message, numbers[0].place, id="VSDF-092")
    largest = any(record["what"] == "MAX" for record in records)
    places = tuple(elements.values())
    return StressSelection(k - 1, tuple(nodes), tuple(elements), every, largest, places)


def _nodes(record: Record, numbers: Any, body: Any, findings: Findings) -> list[int]:
    if not numbers:
        return list(body.nodes)
    nodes = []
    for number in numbers:
        members = body.members(number.value)
        if not members:
            message = f"{body.name} has no node {number.value}"
            findings.error(record.subject, message, number.place, id="VSDF-093")
        nodes += members
    return nodes
