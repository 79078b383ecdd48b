"""The cards GEOM and STL: what bodies look like in pictures."""

from pathlib import Path
from typing import Any

from ...deck.record import Deck, Record
from ...model.diagnostics import Findings
from ...model.exchange.shapes import RigidShape
from ...model.shapes import KINDS, Shape
from ..body_shapes import Keys, primitive_of, rigid_shapes, shapes_of


def build_shapes(deck: Deck, bodies: int, folder: Path, findings: Findings) -> tuple[Shape, ...]:
    """Return the shapes in the order of the cards; file names are relative to `folder`."""
    return shapes_of(
        deck.section, lambda record: _primitive(record, Keys(), findings), [True] * bodies, folder, findings
    )


def exchanged_shapes(deck: Deck) -> tuple[RigidShape, ...]:
    """Return the shapes with the numbers of their cards, for other dialects."""
    return rigid_shapes(deck, Keys(), lambda record: KINDS[record["shape"] - 1])


def _primitive(record: Record, keys: Keys, findings: Findings) -> Any:
    number = record.at("shape")
    if not 1 <= number.value <= len(KINDS):
        message = f"shape must be within 1..{len(KINDS)}, {', '.join(KINDS)}; read {number.text}"
        findings.error(record.subject, message, number.place, id="YOUNG-155")
        return None
    return primitive_of(record, KINDS[number.value - 1], keys, findings)
