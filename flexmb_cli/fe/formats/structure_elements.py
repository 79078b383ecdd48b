"""Beams and shells, whose nodes turn, in the file of the node table: bulk data, Abaqus and CalculiX input."""

from pathlib import Path
from typing import NamedTuple

import numpy as np

from .abaqus_input import blocks
from .beam_elements import BEAM_CARDS, BeamTable, read_beams
from .bulk_data import BulkCard, bulk_cards, check_material
from .inp_structures import STRUCTURE_TYPES, inp_structures
from .matrix_file import FEFileFault
from .node_table import NodeTable

_SOLIDS = ("CHEXA", "CPENTA", "CTETRA", "CPYRAM")


class StructureTable(NamedTuple):
    """Beams, and shells: rows (m, 4) of their nodes, and thickness, m, and mass beside it, kg/m², (m, 2)."""

    beams: BeamTable | None  # None: there are none
    shells: np.ndarray  # (m, 4) places of the corners in the node table
    sections: np.ndarray  # (m, 2) m, kg/m²: see above


def has_structures(path: Path, form: str) -> bool:
    """Return whether the file has beams or shells, and no solid elements.  Raises FEFileFault."""
    if form == "BDF":
        names = {card.name for card in bulk_cards(path, (*BEAM_CARDS, "CQUAD4", *_SOLIDS))}
        return bool(names) and not names & set(_SOLIDS)
    if form != "INP":
        return False
    every = list(blocks(path))
    types = {block.options.get("TYPE", "") for block in every if block.keyword == "ELEMENT"}
    sections = any(block.keyword.endswith(("BEAM SECTION", "SHELL SECTION")) for block in every)
    return sections and bool(types & set(STRUCTURE_TYPES)) and not any(t.startswith("C3D") for t in types)


def read_structures(
    path: Path, form: str, table: NodeTable, elastic: tuple[float, float, float]
) -> StructureTable:
    """Return the beams and shells of the file, whose nodes are in `table`.

    `elastic`: Young's modulus, Pa, Poisson's ratio, density, kg/m³.  Raises FEFileFault, also if the file
    gives another material.
    """
    if form == "INP":
        beams, quads = inp_structures(path, table, elastic)
    else:
        has_beams = any(True for _ in bulk_cards(path, BEAM_CARDS))
        beams, quads = read_beams(path, table, elastic) if has_beams else None, _bulk_quads(path, elastic)
    place = {number: row for row, number in enumerate(table.numbers.tolist())}
    rows, sections = [], []
    for number, nodes, section in quads:
        missing = [node for node in nodes if node not in place]
        if missing:
            message = f"{path.name}: shell {number} has node {missing[0]}, which the node table lacks"
            raise FEFileFault(message, id="FE-310")
        rows.append([place[node] for node in nodes])
        sections.append(section)
    numbers = [number for number, *_ in quads]
    if len(set(numbers)) < len(numbers):
        raise FEFileFault(f"{path.name} has two shells of one number", id="FE-311")
    shells = np.array(rows, dtype=np.int64).reshape(-1, 4)
    _check_shapes(path.name, numbers, table.positions[shells])
    return StructureTable(beams, shells, np.array(sections, dtype=float).reshape(-1, 2))


def _check_shapes(name: str, numbers: list[int], corners: np.ndarray) -> None:
    """Refuse shells that are folded, or whose corners coincide or are not given around them."""
    diagonals = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
    for k in range(4):
        across = np.cross(corners[:, (k + 1) % 4] - corners[:, k], corners[:, k - 1] - corners[:, k])
        area = np.einsum("mi,mi->m", across, diagonals)
        flat = np.flatnonzero(~(area > 1e-6 * np.einsum("mi,mi->m", diagonals, diagonals)))
        if len(flat):
            message = (
                f"{name}: shell {numbers[flat[0]]} is folded at corner {k + 1}, or its corners are not "
                "given around it; triangles are not read"
            )
            raise FEFileFault(message, id="FE-312")


def _bulk_quads(
    path: Path, elastic: tuple[float, float, float]
) -> list[tuple[int, list[int], tuple[float, float]]]:
    """Number, corners and section of the cards CQUAD4 (MSC Nastran Quick Reference Guide)."""
    cards = list(bulk_cards(path, ("CQUAD4", "PSHELL", "MAT1", "CTRIA3", "CQUAD8", "CTRIA6")))
    properties = {}
    for card in cards:
        if card.name == "MAT1":
            check_material(card, elastic)
        elif card.name == "PSHELL":
            properties[card.field(0)] = card
        elif card.name != "CQUAD4":
            message = "no element of bodies; shells are CQUAD4: mesh with quadrilaterals of four nodes"
            raise card.card_fault(message, id="FE-313")
    return [_bulk_quad(card, properties) for card in cards if card.name == "CQUAD4"]


def _bulk_quad(card: BulkCard, properties: dict[str, BulkCard]) -> tuple[int, list[int], tuple[float, float]]:
    number = card.integer(0, "the number of the element")
    shell = properties.get(card.field(1) or card.field(0))
    if shell is None:
        raise card.card_fault(f"there is no PSHELL {card.field(1) or card.field(0)}", id="FE-314")
    if card.field(7).strip("0.") or any(card.fields[8:]):
        raise card.card_fault("offsets and thicknesses of corners are not read", id="FE-315")
    if not (shell.field(1) == shell.field(3) == shell.field(5) != ""):
        message = "MID1, MID2 and MID3 must be the material of MATL: membrane, bending and shear are computed"
        raise shell.card_fault(message, id="FE-316")
    for i, name, usual in ((4, "12I/T**3", 1.0), (6, "TS/T", 5 / 6)):
        if shell.field(i) and abs(shell.real(i, name) - usual) > 1e-3:
            raise shell.card_fault(
                f"{name} is {usual:.6g} of homogeneous shells; leave it empty", id="FE-317"
            )
    thickness = shell.real(2, "the thickness")
    if not thickness > 0.0:
        raise shell.card_fault(f"a thickness is above zero; read '{shell.field(2)}'", id="FE-318")
    nodes = [card.integer(i, "a grid point") for i in range(2, 6)]
    return number, nodes, (thickness, shell.real(7, "mass per area"))
