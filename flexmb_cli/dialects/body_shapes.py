"""Cards of shapes, the same in all dialects: primitives by their sizes, and STL files, on rigid bodies."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from ..deck.many_records import DeckValues
from ..deck.record import Deck, Record
from ..fe.formats.matrix_file import FEFileFault
from ..fe.formats.stl import read_stl
from ..model.diagnostics import Findings
from ..model.shapes import KINDS, LARGEST_LENGTH, Shape, ShapeCard, fault_of_sizes, moved, primitive

MOST_OF_ALL_SHAPES = 1_000_000  # triangles of a deck: hundreds of its lines may name one large file


@dataclass(frozen=True)
class Keys:
    """Names of a dialect for the numbers of a shape: body, shape, sizes, offset (m) and angles (rad).

    `words`: those of a dialect that names the shapes of `KINDS` by words, and not from 1 on.
    """

    body: str = "body"
    shape: str = "shape"
    sizes: tuple[str, ...] = ("a", "b", "c")
    offset: tuple[str, ...] = ("offset.x", "offset.y", "offset.z")
    angles: tuple[str, ...] = ("alpha", "beta", "gamma")
    words: tuple[str, ...] = ()


def build_shapes(
    deck: Deck | DeckValues, rigid: Sequence[bool], folder: Path, findings: Findings, keys: Keys = Keys()
) -> tuple[Shape, ...]:
    """Return the primitives, then the STL shapes, of the sections "shape" and "shape_file".

    `rigid`: of bodies 1, 2, ...; file names are relative to `folder`.
    """
    shapes: list[Shape] = []
    count = 0
    makers = ("shape", _primitive), ("shape_file", partial(_stl_shape, folder))
    for record, make in ((record, make) for section, make in makers for record in deck.section(section)):
        shape = make(record, keys, findings) if _on_rigid_body(record, keys, rigid, findings) else None
        if shape is None:
            continue
        shapes.append(shape)
        count += len(shape.triangles)
        if count > MOST_OF_ALL_SHAPES:
            message = f"the shapes of a deck have at most {MOST_OF_ALL_SHAPES} triangles together; draw fewer"
            findings.error(record.subject, message, record.place, id="DECK-041")
            break
    return tuple(shapes)


def _on_rigid_body(record: Record, keys: Keys, rigid: Sequence[bool], findings: Findings) -> bool:
    """Return whether the body of a card exists and does not deform, with a fault noted if not."""
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


def _primitive(record: Record, keys: Keys, findings: Findings) -> Shape | None:
    """Return the primitive of a card; None with a fault noted."""
    number = record.at(keys.shape)
    code = keys.words.index(number.value) if keys.words else number.value - 1
    if not 0 <= code < len(KINDS):
        message = f"{keys.shape} must be within 1..{len(KINDS)}, {', '.join(KINDS)}; read {number.value}"
        findings.error(record.subject, message, number.place, id="DECK-066")
        return None
    kind = KINDS[code]
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


def _stl_shape(folder: Path, record: Record, keys: Keys, findings: Findings) -> Shape | None:
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
    offset, angles = _placed(record, keys)
    body, sizes = record[keys.body], (0.0, 0.0, 0.0)
    card = ShapeCard(body - 1, "", sizes, offset, angles, name.value, unit.value)
    return Shape(body, moved(unit.value * vertices, offset, angles), triangles, card)


def _is_far(record: Record, keys: Keys, findings: Findings) -> bool:
    """Return whether the shape lies too far from its body to be drawn, with a fault noted."""
    for number in map(record.at, keys.offset):
        if abs(number.value) > LARGEST_LENGTH:
            message = f"{number.key} must be within {LARGEST_LENGTH:g} m of the body; read {number.text}"
            findings.error(record.subject, message, number.place, id="DECK-043")
            return True
    return False


def _placed(record: Record, keys: Keys) -> tuple[Any, Any]:
    return _three(record, keys.offset), _three(record, keys.angles)


def _three(record: Record, keys: Any) -> tuple[Any, Any, Any]:
    x, y, z = (float(record[key]) for key in keys)
    return x, y, z
