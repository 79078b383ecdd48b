"""The cards GEOM and GSTL: what rigid bodies and the ground look like in pictures."""

from collections.abc import Sequence
from pathlib import Path

from ...deck.record import Deck, Record
from ...deck.records import DeckValues
from ...model.diagnostics import Findings
from ...model.exchange.shapes import RigidShape
from ...model.fe_model import VsdfBody
from ...model.shapes import BOX, CONE, CYLINDER, SPHERE, TUBE, Shape
from ..body_shapes import Keys, primitive_of, rigid_shapes, shapes_of
from .cards import SHAPES

_KINDS = dict(zip(SHAPES, (BOX, CYLINDER, TUBE, CONE, SPHERE), strict=True))


def build_shapes(
    values: DeckValues, bodies: Sequence[VsdfBody], folder: Path, findings: Findings
) -> tuple[Shape, ...]:
    """Return the shapes in the order of the cards; file names are relative to `folder`."""
    rigid = [values.number("body", k, "kind").value == "RIGD" for k in range(1, len(bodies) + 1)]

    def primitive(record: Record) -> Shape | None:
        return primitive_of(record, _KINDS[record["shape"]], Keys(), findings)

    return shapes_of(values.section, primitive, rigid, folder, findings)


def exchanged_shapes(deck: Deck) -> tuple[RigidShape, ...]:
    """Return the shapes with the numbers of their cards, for other dialects."""
    return rigid_shapes(deck, Keys(), lambda record: _KINDS[str(record["shape"])])
