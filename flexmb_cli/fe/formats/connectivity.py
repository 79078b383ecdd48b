"""Solid elements in the files of node tables: INP *ELEMENT, CDB EBLOCK, BDF CHEXA and CTETRA.

Tetrahedra have 4 or 10 nodes, hexahedra 8 or 20.
"""

import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from .abaqus_input import blocks, integers_of, words_of
from .ansys_cdb import commands
from .bulk_data import bulk_cards
from .file_text import Line
from .matrix_file import FEFileFault
from .node_table import check_twice

COUNTS = (4, 8, 10, 20)
_KNOWN = "tetrahedra of 4 or 10 and hexahedra of 8 or 20 nodes"
_INP_TYPE = re.compile(r"C3D(4|8|10|20)[A-Z]*")
# Lines and surfaces that mesh programs write beside the solid elements.
_INP_FLAT = re.compile(r"(T[23]D|B[23]|CPS|CPE|CAX|SFM3D|M3D|R[23]D|S(?=\d)|STRI)\d+[A-Z]*|DCOUP3D")
_CDB_FORMAT = re.compile(r"\(\s*\d+i(\d{1,3})(?!\d)", re.IGNORECASE)
# In EBLOCK eleven integers precede the nodes, the ninth of which counts them.
_CDB_HEAD, _CDB_COUNT = 11, 8
# Surface effect elements and elements of meshes only, which have no stiffness.
_CDB_FLAT = re.compile(r"(SURF)?15[1-4]|(MESH)?200")
_OF_ELEMENTS = "E EN EMOR EGEN ENGE ENSY ESYM EDEL EMOD /INP *USE *DO CDRE"
# Nastran numbers the edges along the third direction before those of the upper face.
_FROM_NASTRAN = [*range(12), *range(16, 20), *range(12, 16)]


@dataclass(frozen=True)
class _Element:
    """An element as its file gives it; `kind` is its type in an INP file, "" in others.

    No nodes: an element of another type, which has no part in the body.
    """

    number: int
    nodes: list[int]
    line: Line
    kind: str = ""


@dataclass(frozen=True)
class ElementTable:
    """Node numbers (m, k) of the elements, k 4, 8, 10 or 20, and the numbers of the elements (m,).

    `kind` is their type in an INP file, such as C3D20R; "" in other formats.  `left_out`: what else the
    file holds, in words.

    Hexahedra: corners of one face, of the opposite one, then the middles of edges as Abaqus and ANSYS have
    them.  Tetrahedra: corners, then the middles of the edges 1-2, 2-3, 3-1, 1-4, 2-4, 3-4.
    """

    numbers: np.ndarray
    nodes: np.ndarray
    kind: str = ""
    left_out: str = ""


def read_elements(path: Path, form: str) -> ElementTable:
    """Return the elements beside the nodes of `path`, in the format INP, CDB or BDF.

    Raises FEFileFault when there are none, others than tetrahedra or hexahedra of one type, or one twice.
    """
    readers = {"INP": _inp_elements, "CDB": _cdb_elements, "BDF": _bdf_elements}
    if form not in readers:
        message = f"{path.name}: a node table of format {form} has no elements; INP, CDB or BDF has"
        raise FEFileFault(message, id="FE-019")
    every = list(readers[form](path))
    elements = [element for element in every if element.nodes]
    counts = Counter(element.kind for element in every if not element.nodes)
    others = ", ".join(f"{count} {kind}" for kind, count in sorted(counts.items()))
    if not elements:
        but = f" but {others}; {_KNOWN} are used" if others else ""
        raise FEFileFault(f"{path.name} holds no elements in format {form}{but}", id="FE-020")
    _check_nodes(elements)
    _check_kinds(path.name, elements)
    check_twice(path.name, "element", ((element.number, element.line) for element in elements))
    return ElementTable(
        np.array([element.number for element in elements], dtype=np.int64),
        np.array([element.nodes for element in elements], dtype=np.int64),
        elements[0].kind,
        others,
    )


def _check_nodes(elements: list[_Element]) -> None:
    for element in elements:
        if len(element.nodes) not in COUNTS or len(set(element.nodes)) < len(element.nodes):
            message = f"element {element.number} has not the different nodes of one of the {_KNOWN}"
            raise element.line.fault(message, id="FE-097")


def _check_kinds(name: str, elements: list[_Element]) -> None:
    counts = {len(element.nodes) for element in elements}
    if len(counts) > 1:
        mixed = " and of ".join(map(str, sorted(counts)))
        raise FEFileFault(f"{name} mixes elements of {mixed} nodes; use one type", id="FE-021")
    kinds = sorted({element.kind for element in elements})
    if len(kinds) > 1:
        message = f"{name} mixes elements of types {' and '.join(kinds)}; use one type"
        raise FEFileFault(message, id="FE-084")


def _inp_elements(path: Path) -> Iterator[_Element]:
    """Data lines of *ELEMENT; a line that ends in a comma is continued."""
    flat: dict[str, Line] = {}  # sets of lines and surfaces
    for block in blocks(path):
        kind, named = block.options.get("TYPE", ""), block.options.get("ELSET", "")
        if block.keyword in ("ELGEN", "ELCOPY"):
            message = f"*{block.keyword} is not read; let a preprocessor write all elements by *ELEMENT"
            raise block.line.fault(message, id="FE-178")
        if block.keyword.endswith("SECTION") and named in flat:
            raise flat[named].fault(f"elements of a section; only {_KNOWN} are used", id="FE-179")
        if block.keyword != "ELEMENT":
            continue
        block.refuse_others("TYPE", "ELSET", "INPUT")
        type = _INP_TYPE.fullmatch(kind)
        if _INP_FLAT.fullmatch(kind):
            flat[named] = block.line
        elif type is None:
            message = f"stresses are computed for {_KNOWN} only, types C3D4, C3D10, C3D8, C3D20 and variants"
            raise block.line.fault(message, id="FE-099")
        words: list[str] = []
        first = block.line
        for line in block.data:
            first = first if words else line
            words += [word for word in words_of(line) if word]
            if (type and len(words) > int(type[1])) or not line.text.rstrip().endswith(","):
                values = integers_of(first, words)
                yield _Element(values[0], values[1:] if type else [], first, kind)
                words = []


def _cdb_elements(path: Path) -> Iterator[_Element]:
    """EBLOCKs, cut by the formats below them; nodes that do not fit stand on the next line."""
    flat = set()
    for line, command, words, below in commands(path, _OF_ELEMENTS):
        if command == "ET" and _CDB_FLAT.fullmatch(words[1]):
            flat.add(words[0])
        elif command == "EBLOCK":
            yield from _block(line, below, "SOLID" in words, flat)


def _block(heading: Line, lines: list[str], solid: bool, flat: set[str]) -> Iterator[_Element]:
    layout = _CDB_FORMAT.match(lines[0].strip()) if lines else None
    if layout is None:
        second = Line(heading.name, heading.number + 1, "")
        raise second.fault("a format such as (19i9) must follow EBLOCK", id="FE-101")
    words: list[int] = []
    width, first = max(1, int(layout[1])), heading
    for number, text in enumerate(lines[1:], start=heading.number + 2):
        if text.strip() == "-1":
            return
        line, text = Line(heading.name, number, text), text.rstrip()
        first = first if words else line
        words += integers_of(line, [text[i : i + width] for i in range(0, len(text), width)])
        if not solid or (len(words) > 1 and str(words[1]) in flat):
            yield _Element(0, [], first, "surface elements" if solid else "of EBLOCK without SOLID")
            words = []
        elif len(words) >= _CDB_HEAD and len(words) >= _CDB_HEAD + words[_CDB_COUNT]:
            nodes = words[_CDB_HEAD : _CDB_HEAD + words[_CDB_COUNT]]
            yield _Element(words[_CDB_HEAD - 1], nodes, first)
            words = []
    raise FEFileFault(f"{heading.name}: EBLOCK does not end with -1; is the file cut off?", id="FE-022")


_SOLIDS = ("CHEXA", "CPENTA", "CTETRA", "CPYRAM", "CHEXA1", "CHEXA2")
# Other elements, masses and rigid joints.
_BDF_OTHERS = (
    "CQUAD", "CQUAD4", "CQUAD8", "CQUADR", "CTRIA3", "CTRIA6", "CTRIAR", "CSHEAR", "CBAR", "CBEAM",
    "CBEND", "CROD", "CONROD", "CTUBE", "CBUSH", "CELAS1", "CELAS2", "CELAS3", "CELAS4", "CMASS1",
    "CMASS2", "CONM1", "CONM2", "RBE1", "RBE2", "RBE3", "RBAR", "RROD", "CTRIAX", "CTRIAX6",
    "CQUADX", "CBUSH1D", "CBUSH2D", "CFAST", "CGAP", "CSEAM", "CWELD", "CMASS3", "CMASS4", "RSPLINE",
    "RJOINT", "RTRPLT", "PLOTEL",
)  # fmt: skip
# Fields of grid points after the numbers of element and property.
_MOST_POINTS = {"CHEXA": 20, "CTETRA": 10}


def _bdf_elements(path: Path) -> Iterator[_Element]:
    for card in bulk_cards(path, (*_SOLIDS, *_BDF_OTHERS)):
        if card.name in _BDF_OTHERS:
            yield _Element(0, [], card.line, card.name)
            continue
        number = card.integer(0, "the number of the element")
        if card.name not in _MOST_POINTS:
            message = f"{card.name} {number}: stresses are computed for {_KNOWN} only, cards CHEXA and CTETRA"
            raise card.line.fault(message, id="FE-102")
        fields = range(2, 2 + _MOST_POINTS[card.name])
        given = [card.integer(i, "a grid point") for i in fields if card.field(i)]
        nodes = [given[i] for i in _FROM_NASTRAN] if len(given) == 20 else given
        yield _Element(number, nodes, card.line)
