"""The cards GEOM and STL: what bodies look like in pictures."""

from pathlib import Path
from typing import Any

from ...deck.record import Deck, Record
from ...errors import Fault
from ...model.diagnostics import Findings
from ...model.exchange.shapes import RigidShape
from ...model.shapes import KINDS, Shape
from ..body_shapes import Keys, on_rigid_body, primitive_of, rigid_shapes, shapes_of
from .card import Card, vector, whole
from .sections import Column


def build_shapes(deck: Deck, bodies: int, folder: Path, findings: Findings) -> tuple[Shape, ...]:
    """Return the shapes in the order of the cards; file names are relative to `folder`."""
    return shapes_of(
        deck.section, lambda record: _primitive(record, Keys(), findings), [True] * bodies, folder, findings
    )


def faults_of_shape(record: Record, bodies: int) -> list[Fault]:
    """Return what is wrong with the card of a primitive in a deck of so many bodies."""
    findings = Findings()
    if on_rigid_body(record, Keys(), [True] * bodies, findings):
        _primitive(record, Keys(), findings)
    return findings.in_order


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


_BODY = whole("body", "number of the body, 0: the ground")
_PLACED = (
    *vector("offset", "the middle of the shape, body axes", "m"),
    Column("alpha", "angle by which it is turned about x, then", "rad"),
    Column("beta", "about y, then", "rad"),
    Column("gamma", "about z, axes of the body", "rad"),
)
SHAPE_CARDS = (
    Card(
        "GEOM",
        "shape",
        (
            _BODY,
            whole("shape", "1 box, 2 cylinder, 3 tube, 4 cone, 5 sphere"),
            Column("a", "length along x; of all but a box the radius", "m"),
            Column("b", "length along y; of all but a box the length along z", "m"),
            Column("c", "length along z; inner radius of a tube, upper one of a cone", "m"),
            *_PLACED,
        ),
        optional=8,
    ),
    Card(
        "STL",
        "shape_file",
        (
            Column("file", "STL file", is_text=True),
            _BODY,
            Column("unit", "metres in a unit of the file", "m"),
            *_PLACED,
        ),
        optional=6,
    ),
)
