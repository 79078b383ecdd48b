"""Beams B31 and B32 and shells S4 with their sections in input files of Abaqus and CalculiX.

Abaqus Keywords Reference Guide, *BEAM SECTION, *BEAM GENERAL SECTION, *SHELL SECTION; Abaqus Analysis User's
Guide, "Beam element cross-section orientation": n1 in the plane of the first axis, n2 = t x n1, t from the
first node to the last; "Choosing a beam element": shear factors 0.85 of rectangles and 0.89 of circles.
"""

import math
from itertools import pairwise
from pathlib import Path

import numpy as np

from .abaqus_input import Block, blocks, integers_of, reals_of, words_of
from .beam_elements import BeamTable, upright
from .file_text import Line
from .node_table import NodeTable, check_twice

# Nodes of an element by its type.
STRUCTURE_TYPES = {"B31": 2, "B32": 3, "B32R": 3, "S4": 4, "S4R": 4}
_BEAM_SECTIONS, _SHELL_SECTION = ("BEAM SECTION", "BEAM GENERAL SECTION"), "SHELL SECTION"
_SHEAR_SHARES = {"RECT": 0.85, "CIRC": 0.89, "GENERAL": 1.0}
_AXIS = (0.0, 0.0, -1.0)  # n1 if the section gives none

Quad = tuple[int, list[int], tuple[float, float]]


def inp_structures(
    path: Path, table: NodeTable, elastic: tuple[float, float, float]
) -> tuple[BeamTable | None, list[Quad]]:
    """Return beams, and number, corners and section (thickness, 0) of shells.  Raises FEFileFault.

    `elastic`: Young's modulus, Pa, Poisson's ratio, density, kg/m³.
    """
    sections: dict[str, Block] = {}
    elements: list[Block] = []
    for block in blocks(path):
        if block.keyword in (*_BEAM_SECTIONS, _SHELL_SECTION):
            sections[block.options.get("ELSET", "")] = block
        elif block.keyword == "ELEMENT":
            block.refuse_others("TYPE", "ELSET", "INPUT")
            elements.append(block)
        _check_block(block, elastic)
    beams, quads = [], []
    place = {number: row for row, number in enumerate(table.numbers.tolist())}
    lines: list[tuple[int, Line]] = []
    for block in elements:
        section = _section_of(block, sections)
        for line, numbers in _numbers(block):
            lines.append((numbers[0], line))
            if section.keyword == _SHELL_SECTION:
                quads.append((numbers[0], numbers[1:], _thickness(section)))
            else:
                beams += _beams(block, numbers, section, place, table)
    check_twice(path.name, "element", lines)
    if not beams:
        return None, quads
    own, rows, upwards, values = zip(*beams, strict=True)
    return BeamTable(np.array(own), np.array(rows), np.array(upwards), np.array(values)), quads


def _check_block(block: Block, elastic: tuple[float, float, float]) -> None:
    """Refuse another material than that of the deck, and what would change sections."""
    if block.keyword in ("TRANSVERSE SHEAR STIFFNESS", "BEAM SECTION OFFSET", "ELSET", "NODAL THICKNESS"):
        message = (
            f"*{block.keyword} is not read beside beams and shells; name element sets by ELSET= of *ELEMENT, "
            "and leave shear factors and offsets out"
        )
        raise block.line.fault(message, id="FE-319")
    known = {"ELASTIC": elastic[:2], "DENSITY": elastic[2:]}.get(block.keyword, ())
    values = reals_of(block.data[0], 8) if known and block.data else []
    for name, value, expected in zip(
        ("E", "nu") if len(known) > 1 else ("density",), values, known, strict=False
    ):
        if abs(value - expected) > 1e-6 * abs(expected):
            message = f"{name} is {value:g}, and {expected:g} on MATL: the deck's material is meant"
            raise block.data[0].fault(message, id="FE-320")


def _section_of(block: Block, sections: dict[str, Block]) -> Block:
    """Return the section of a set of elements, of their type."""
    kind, named = block.options.get("TYPE", ""), block.options.get("ELSET", "")
    if kind not in STRUCTURE_TYPES:
        message = f"elements {kind} do not go with beams and shells; read are {', '.join(STRUCTURE_TYPES)}"
        raise block.line.fault(message, id="FE-321")
    section = sections.get(named)
    if section is None or (section.keyword == _SHELL_SECTION) != kind.startswith("S"):
        what = "*SHELL SECTION" if kind.startswith("S") else "*BEAM SECTION"
        raise block.line.fault(f"there is no {what} of the set '{named}' of these {kind}", id="FE-322")
    return section


def _numbers(block: Block) -> list[tuple[Line, list[int]]]:
    """Return line, and number and nodes, of every element."""
    count = STRUCTURE_TYPES[block.options["TYPE"]]
    lines_of_numbers = []
    for line in block.data:
        numbers = integers_of(line, words_of(line))
        if len(numbers) != count + 1 or len(set(numbers[1:])) != count:
            message = (
                f"expected the number and {count} different nodes of an element; read '{line.text.strip()}'"
            )
            raise line.fault(message, id="FE-323")
        lines_of_numbers.append((line, numbers))
    return lines_of_numbers


def _thickness(section: Block) -> tuple[float, float]:
    section.refuse_others("ELSET", "MATERIAL", "ORIENTATION", "SECTION INTEGRATION", "CONTROLS")
    values = reals_of(section.data[0], 2) if section.data else [0.0]
    if not values[0] > 0.0:
        raise section.line.fault("a thickness above zero must stand below *SHELL SECTION", id="FE-324")
    return values[0], 0.0


def _beams(
    block: Block, numbers: list[int], section: Block, place: dict[int, int], table: NodeTable
) -> list[tuple[int, list[int], np.ndarray, list[float]]]:
    """Return a beam from each node of an element to the next: a B32 counts as two."""
    missing = [number for number in numbers[1:] if number not in place]
    if missing:
        message = f"element {numbers[0]} has node {missing[0]}, which the node table lacks"
        raise block.line.fault(message, id="FE-325")
    rows = [place[number] for number in numbers[1:]]
    values, axis = beam_section(section)
    beams = []
    for one, other in pairwise(rows):
        along = table.positions[other] - table.positions[one]
        if not upright(along, axis):
            message = f"ends of element {numbers[0]} coincide, or n1 of its section lies along it"
            raise block.line.fault(message, id="FE-326")
        beams.append((numbers[0], [one, other], axis, values))
    return beams


def beam_section(section: Block) -> tuple[list[float], np.ndarray]:
    """Return the section (7,) as `BeamTable` has it, with y along n1, and n1 (3,).  Raises FEFileFault."""
    section.refuse_others("ELSET", "MATERIAL", "SECTION", "ROTARY INERTIA", "POISSON", "TEMPERATURE")
    shape, lines = section.options.get("SECTION", "GENERAL"), section.data
    numbers = reals_of(lines[0], 5) if lines else [0.0] * 5
    if shape == "RECT":
        a, b = numbers[:2]
        sizes = [a * b, b * a**3 / 12, a * b**3 / 12, _torsion(a, b)] if min(a, b) > 0.0 else [0.0]
    elif shape == "CIRC":
        # Abaqus gives the radius, CalculiX both diameters.
        r = numbers[1] / 2 if numbers[1] else numbers[0]
        is_round = not numbers[1] or numbers[0] == numbers[1]
        sizes = (
            [math.pi * r**2, math.pi * r**4 / 4, math.pi * r**4 / 4, math.pi * r**4 / 2]
            if is_round
            else [0.0]
        )
    elif shape == "GENERAL" and section.keyword == "BEAM GENERAL SECTION":
        area, I11, I12, I22, J = numbers
        sizes = [area, I22, I11, J] if not I12 else [0.0]
    else:
        message = f"a section {shape} is not read; RECT and CIRC of *BEAM SECTION, or *BEAM GENERAL SECTION"
        raise section.line.fault(message, id="FE-327")
    if not min(sizes) > 0.0:
        message = "sizes of a section must be above zero, ellipses are not read, and I12 must be zero"
        raise section.line.fault(message, id="FE-328")
    shear = _SHEAR_SHARES[shape] * sizes[0]
    axis = np.array(reals_of(lines[1], 3) if len(lines) > 1 else _AXIS)
    return [*sizes, 0.0, shear, shear], axis


def _torsion(a: float, b: float) -> float:
    """Return Saint-Venant's torsion constant of a rectangle (Timoshenko and Goodier, section 109)."""
    long, short = max(a, b), min(a, b)
    odd = np.arange(1, 2000, 2)
    series = (np.tanh(odd * math.pi * long / (2 * short)) / odd**5.0).sum()
    return float(long * short**3 / 3 * (1 - 192 / math.pi**5 * short / long * series))
