"""Cards of shapes, the same in all dialects: primitives by their sizes, and STL files, on rigid bodies."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np

from ..deck.record import Deck, Record
from ..deck.records import DeckValues
from ..fe.formats.matrix_file import FEFileFault
from ..fe.formats.stl import read_stl
from ..model.diagnostics import Findings
from ..model.exchange.shapes import RigidShape
from ..model.shapes import LARGEST_LENGTH, Shape, fault_of_sizes, moved, primitive

OFFSET = tuple(f"offset.{axis}" for axis in "xyz")
ANGLES = ("alpha", "beta", "gamma")


MOST_OF_ALL_SHAPES = 1_000_000  # of a deck: hundreds of its lines may name one large file


@dataclass(frozen=True)
class Keys:
    """Names of a dialect for the numbers of a shape: body, sizes, offset (m) and angles (rad)."""

    body: str = "body"
    sizes: tuple[str, ...] = ("a", "b", "c")
    offset: tuple[str, ...] = OFFSET
    angles: tuple[str, ...] = ANGLES


def on_rigid_body(record: Record, keys: Keys, rigid: Sequence[bool], findings: Findings) -> bool:
    """Return whether the body of a card exists and does not deform; else a fault.  `rigid`: of bodies 1, 2,
    ...
    """
    number = record.at(keys.body)
    if not 0 <= number.value <= len(rigid):
        message = f"body number {number.value} is outside 0..{len(rigid)}"
        findings.error(record.subject, message, number.place, id="DECK-021")
        return False
    if number.value and not rigid[number.value - 1]:
        message = (
            f"body {number.value} is flexible: its nodes and elements are drawn; shapes are for rigid ones"
        )
        findings.error(record.subject, message, number.place, id="DECK-018")
        return False
    return True


def shapes_of(
    section: Callable[[str], Sequence[Record]],
    primitive_of_card: Callable[[Record], Shape | None],
    rigid: Sequence[bool],
    folder: Path,
    findings: Findings,
) -> tuple[Shape, ...]:
    """Return the primitives, then the STL shapes, of the sections "shape" and "shape_file".

    `rigid`: of bodies 1, 2, ...; file names are relative to `folder`.
    """
    keys = Keys()
    primitives = (
        (record, primitive_of_card(record))
        for record in section("shape")
        if on_rigid_body(record, keys, rigid, findings)
    )
    surfaces = (
        (record, stl_shape_of(record, keys, folder, findings))
        for record in section("shape_file")
        if on_rigid_body(record, keys, rigid, findings)
    )
    return few_enough(chain(primitives, surfaces), findings)


def few_enough(found: Iterable[tuple[Record, Shape | None]], findings: Findings) -> tuple[Shape, ...]:
    """Return the shapes of records, and a fault where they have too many triangles together."""
    shapes: list[Shape] = []
    count = 0
    for record, shape in found:
        count += len(shape.triangles) if shape else 0
        if count > MOST_OF_ALL_SHAPES:
            message = f"the shapes of a deck have at most {MOST_OF_ALL_SHAPES} triangles together; draw fewer"
            findings.error(record.subject, message, record.place, id="DECK-041")
            break
        shapes += [shape] if shape else []
    return tuple(shapes)


def primitive_of(record: Record, kind: str, keys: Keys, findings: Findings) -> Shape | None:
    """Return the primitive of a card; None with a fault noted."""
    sizes = _three(record, keys.sizes)
    wrong = fault_of_sizes(kind, sizes)
    if wrong:
        number = record.at(keys.sizes[wrong[0]])
        message = f"{number.key} of a {kind} {wrong[1]}; read {number.text or 'an empty field'}"
        findings.error(record.subject, message, number.place, id="DECK-019")
        return None
    if _is_far(record, keys, findings):
        return None
    return primitive(record[keys.body], kind, sizes, *_placed(record, keys))


def stl_shape_of(record: Record, keys: Keys, folder: Path, findings: Findings) -> Shape | None:
    """Return the surface in the STL `file` of a card, in units of `unit` m; None with a fault noted."""
    unit, name = record.at("unit"), record.at("file")
    if not unit.value > 0:
        message = f"the unit must be above zero, 0.001 for a file in mm; read {unit.text}"
        findings.error(record.subject, message, unit.place, id="DECK-020")
        return None
    try:
        vertices, triangles = read_stl(folder / name.value.replace("\\", "/"))
    except FEFileFault as fault:
        findings.error(record.subject, str(fault), name.place, id=fault.id)
        return None
    if float(np.abs(vertices).max()) > LARGEST_LENGTH / float(unit.value):
        message = (
            f"the unit {unit.text} m puts corners of {name.value} farther than {LARGEST_LENGTH:g} m from "
            "their origin; give 0.001 for a file in mm"
        )
        findings.error(record.subject, message, unit.place, id="DECK-042")
        return None
    if _is_far(record, keys, findings):
        return None
    return Shape(record[keys.body], moved(unit.value * vertices, *_placed(record, keys)), triangles)


def _is_far(record: Record, keys: Keys, findings: Findings) -> bool:
    """Return whether the shape lies too far from its body to be drawn, with a fault noted."""
    for number in map(record.at, keys.offset):
        if abs(number.value) > LARGEST_LENGTH:
            message = f"{number.key} must be within {LARGEST_LENGTH:g} m of the body; read {number.text}"
            findings.error(record.subject, message, number.place, id="DECK-043")
            return True
    return False


def rigid_shapes(
    values: Deck | DeckValues, keys: Keys, kind_of: Callable[[Record], str]
) -> tuple[RigidShape, ...]:
    """Return the shapes of a deck's cards as they are, bodies counted from 0 and the ground -1."""
    found = []
    for record in values.section("shape"):
        sizes, (offset, angles) = _three(record, keys.sizes), _placed(record, keys)
        found.append(RigidShape(record[keys.body] - 1, kind_of(record), sizes, offset, angles))
    for record in values.section("shape_file"):
        offset, angles = _placed(record, keys)
        place = {"offset": offset, "angles": angles}
        found.append(
            RigidShape(record[keys.body] - 1, "", **place, file=str(record["file"]), unit=record["unit"])
        )
    return tuple(found)


def _placed(record: Record, keys: Keys) -> tuple[Any, Any]:
    return _three(record, keys.offset), _three(record, keys.angles)


def _three(record: Record, keys: Any) -> tuple[Any, Any, Any]:
    x, y, z = (float(record[key]) for key in keys)
    return x, y, z
