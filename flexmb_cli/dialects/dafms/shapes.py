"""The card GEOM: what rigid bodies and the inertial frame look like in pictures."""

from typing import Any

from ...deck.record import Deck, Record
from ...deck.records import DeckValues
from ...model.diagnostics import Findings
from ...model.exchange.shapes import RigidShape
from ...model.shapes import KINDS, Shape
from ..body_shapes import Keys, few_enough, on_rigid_body, primitive_of, rigid_shapes

_KEYS = Keys("K", ("SA", "SB", "SC"), ("SO1", "SO2", "SO3"), ("SW1", "SW2", "SW3"))


def build_shapes(values: DeckValues, findings: Findings) -> tuple[Shape, ...]:
    """Return the shapes in the order of their entries."""
    count = values.number("counts", 0, "N").value
    rigid = [values.number("counts", k, "NUMNP").value == 0 for k in range(1, count + 1)]
    found = (
        (record, _shape(record, findings))
        for record in values.section("shape")
        if on_rigid_body(record, _KEYS, rigid, findings)
    )
    return few_enough(found, findings)


def exchanged_shapes(deck: Deck) -> tuple[RigidShape, ...]:
    """Return the shapes with the numbers of their entries, for other dialects."""
    return rigid_shapes(DeckValues(deck), _KEYS, lambda record: KINDS[record["IS"] - 1])


def _shape(record: Record, findings: Findings) -> Any:
    number = record.at("IS")
    if not 1 <= number.value <= len(KINDS):
        message = f"IS must be within 1..{len(KINDS)}, {', '.join(KINDS)}; read {number.value}"
        findings.error(record.subject, message, number.place, id="DAFMS-076")
        return None
    return primitive_of(record, KINDS[number.value - 1], _KEYS, findings)
