"""The cards GEOM and GSTL: what rigid bodies and the ground look like in pictures."""

from itertools import chain
from pathlib import Path

from ...deck.record import Deck
from ...deck.records import DeckValues
from ...model.diagnostics import Findings
from ...model.exchange.shapes import RigidShape
from ...model.fe_model import VsdfBody
from ...model.shapes import BOX, CONE, CYLINDER, SPHERE, TUBE, Shape
from ..body_shapes import Keys, few_enough, on_rigid_body, primitive_of, rigid_shapes, stl_shape_of
from .cards import SHAPES

_KINDS = dict(zip(SHAPES, (BOX, CYLINDER, TUBE, CONE, SPHERE), strict=True))


def build_shapes(
    values: DeckValues, bodies: tuple[VsdfBody, ...], folder: Path, findings: Findings
) -> tuple[Shape, ...]:
    """Return the shapes in the order of the cards; file names are relative to `folder`."""
    keys, rigid = Keys(), [values.record("body", k)["kind"] == "RIGD" for k in range(1, len(bodies) + 1)]  # type: ignore[index]
    primitives = (
        (record, primitive_of(record, _KINDS[record["shape"]], keys, findings))
        for record in values.section("shape")
        if on_rigid_body(record, keys, rigid, findings)
    )
    surfaces = (
        (record, stl_shape_of(record, keys, folder, findings))
        for record in values.section("shape_file")
        if on_rigid_body(record, keys, rigid, findings)
    )
    return few_enough(chain(primitives, surfaces), findings)


def exchanged_shapes(deck: Deck) -> tuple[RigidShape, ...]:
    """Return the shapes with the numbers of their cards, for other dialects."""
    return rigid_shapes(deck, Keys(), lambda record: _KINDS[str(record["shape"])])
