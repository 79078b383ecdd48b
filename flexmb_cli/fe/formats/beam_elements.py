"""Straight beams in a bulk data file: CBAR with PBAR, CBEAM with PBEAM of one section.

MSC Nastran Quick Reference Guide, CBAR, CBEAM, PBAR, PBEAM: x from GA to GB, y in the plane of the vector
X1 X2 X3 (in the displacement axes of GA) or of the point G0; I1 for bending in the plane of x and y.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple

import numpy as np

from .bulk_data import BulkCard, bulk_cards, check_material
from .matrix_file import FEFileFault
from .node_table import NodeTable

_PROPERTY = {"CBAR": "PBAR", "CBEAM": "PBEAM"}
# Fields of area, I1, I2, I12, torsion constant, mass per length; PBEAM has sixteen fields a station.
_FIELDS = {"PBAR": (2, 3, 4, 18, 5, 6), "PBEAM": (2, 3, 4, 5, 6, 7)}
_SHEAR = {"PBAR": (16, 17), "PBEAM": (24, 25)}
BEAM_CARDS = tuple(_PROPERTY)
# Sine of the least angle between a beam and the vector of its section.
_LEAST_ANGLE = 1e-9


class BeamTable(NamedTuple):
    """Beams: numbers (m,), rows (m, 2) of their nodes in the node table, axes y (m, 3) and sections (m, 7).

    A section: area, m², second moments for bending in the planes xy and xz, torsion constant, m⁴, mass per
    length beside that of the material, kg/m, and the shear areas of both planes, m², 0 for none: no shear.
    """

    numbers: np.ndarray  # (m, 1) or flat: numbers of the elements
    rows: np.ndarray  # (m, 2) places of their nodes in the node table
    upwards: np.ndarray  # (m, 3) axes y, unit vectors in axes of the body
    sections: np.ndarray  # (m, 7) m², m⁴, m⁴, m⁴, kg/m, m², m²: see above


def read_beams(path: Path, table: NodeTable, elastic: tuple[float, float, float]) -> BeamTable:
    """Return the beams of the file, whose nodes are in `table`.

    `elastic`: Young's modulus, Pa, Poisson's ratio, density, kg/m³.  Raises FEFileFault, also where a card
    MAT1 has another material.
    """
    cards = list(bulk_cards(path, (*_PROPERTY, *_PROPERTY.values(), "MAT1")))
    for card in cards:
        if card.name == "MAT1":
            check_material(card, elastic)
    properties = [card for card in cards if card.name in _PROPERTY.values()]
    sections = {(card.name, card.field(0)): _section(card) for card in properties}
    place = {number: row for row, number in enumerate(table.numbers.tolist())}
    beams = [_beam(card, sections, place, table) for card in cards if card.name in _PROPERTY]
    numbers, rows, upwards, values = zip(*beams, strict=True)
    if len(set(numbers)) < len(numbers):
        raise FEFileFault(f"{path.name} has two beams of one number", id="FE-271")
    return BeamTable(np.array(numbers), np.array(rows), np.array(upwards), np.array(values))


def _section(card: BulkCard) -> list[float]:
    """Return the section (7,) of a property."""
    area, I1, I2, I12, J, mass = (card.real(i, "a property of the section") for i in _FIELDS[card.name])
    if card.name == "PBEAM" and any(card.fields[8:24]):
        raise card.card_fault("stresses and further stations are not read; give one section", id="FE-272")
    if I12 or not min(area, I1, I2, J) > 0.0:
        message = "area, I1, I2 and J must be above zero, and I12 zero: turn the axes to the principal ones"
        raise card.card_fault(message, id="FE-273")
    shear = [card.field(i) for i in _SHEAR[card.name]]
    default = 0.0 if card.name == "PBAR" else 1.0
    factors = [
        card.real(i, "a shear factor") if text else default
        for i, text in zip(_SHEAR[card.name], shear, strict=True)
    ]
    return [area, I1, I2, J, mass, *(factor * area for factor in factors)]


def _beam(
    card: BulkCard,
    sections: Mapping[tuple[str, str], list[float]],
    place: Mapping[int, int],
    table: NodeTable,
) -> tuple[int, list[int], np.ndarray, list[float]]:
    """Return number, rows of the nodes, a vector in the plane of x and y, and the section."""
    section = sections.get((_PROPERTY[card.name], card.field(1)))
    if section is None:
        raise card.card_fault(f"there is no {_PROPERTY[card.name]} {card.field(1)}", id="FE-274")
    if any(card.field(i).strip("0.") for i in range(8, 16)) or card.field(7) not in ("", "GGG"):
        raise card.card_fault("pins and offsets of a beam's ends are not read", id="FE-275")
    numbers = [card.integer(i, "a grid point") for i in (2, 3)]
    if card.field(4).isdecimal():
        numbers.append(card.integer(4, "a grid point"))
    missing = [number for number in numbers if number not in place]
    if missing:
        raise card.card_fault(f"there is no GRID {missing[0]}", id="FE-276")
    rows = [place[number] for number in numbers]
    if len(rows) == 3:
        upward = table.positions[rows[2]] - table.positions[rows[0]]
    else:
        upward = np.array([card.real(i, "a component of a vector") for i in (4, 5, 6)])
        upward = upward if table.axes is None else table.axes[rows[0]] @ upward
    along = table.positions[rows[1]] - table.positions[rows[0]]
    if not upright(along, upward):
        raise card.card_fault("the ends coincide, or the vector lies along the beam", id="FE-277")
    return card.integer(0, "a number"), rows[:2], upward, section


def upright(along: np.ndarray, upward: np.ndarray) -> bool:
    """Return whether a beam along `along` (3,) has a length, and `upward` (3,) another direction.

    False for numbers that are too large for products.
    """
    with np.errstate(all="ignore"):
        sine = np.linalg.norm(np.cross(along, upward))
        return bool(sine > _LEAST_ANGLE * np.linalg.norm(along) * np.linalg.norm(upward))
